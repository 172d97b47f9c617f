"""Parametric surfaces: patches over a rectangle of parameters, how they are joined, proved and meshed.

In come edges, curves, points or formulas. Edges, curves or data become functions of one parameter, these the Boolean
sum p = P_u + P_v - P_u P_v, and that points, normals, curvatures and meshes. The way of `CoonsPatch(...).grid(u, v)`, a
module each: curves become functions of one parameter (functions/curves.py, functions/univariate.py); edges and what
follows from them across are stacked (coons/coons_patches.py); corners agree (coons/corners.py); the Boolean sum is one
formula or keeps its factors (transfinite.py); parameters are placed in its domain (patch.py, parameters.py); a kernel
of the formula gives the points (functions/formulas.py).

The order of a spline is one more than its degree, and either may be given; that of a Coons patch, a transition or a
blend is its class, the number of derivatives given across an edge, the position among them: degree 2 order - 1.

symbols.py, parameters.py                          the parameters u, v, t; arrays of them in an interval
functions/, blends/                                functions of one parameter; what weighs edges and ribbons
corrections.py                                     what is meant to meet, and how far it may miss
patch.py, forms.py                                 what every patch has; normals and curvatures, at poles too
transfinite.py, parametric.py                      the Boolean sum; formulas in u and v
coons/, networks/, bsplines/                       patches of edges, of networks of curves, of data
splitting.py, joints/, proofs/, meshes.py          cut, joined, compared, proved; as triangles
chords/, projections.py                            lines over a domain; operators that keep means along them
"""

from rsym.facade import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
