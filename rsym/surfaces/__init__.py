"""Parametric surfaces: patches over a rectangle of parameters, and their joining.

Edges, curves or data become functions of one parameter, these the Boolean sum
p = P_u + P_v - P_u P_v, and that points, normals, curvatures and meshes.

The order of a spline is one more than its degree, and either may be given; that of a Coons patch, a transition or a
blend is its class, the number of derivatives given across an edge, the position among them: degree 2 order - 1.
"""

from lazy_loader import attach_stub

__getattr__, __dir__, __all__ = attach_stub(__name__, __file__)
