"""Parametric surfaces: patches over a rectangle of parameters, and their joining.

Edges, curves or data become functions of one parameter, these the Boolean sum
p = P_u + P_v - P_u P_v, and that points, normals, curvatures and meshes.
"""

from lazy_loader import attach_stub

__getattr__, __dir__, __all__ = attach_stub(__name__, __file__)
