"""Proofs about patches: what holds all along the edges in which they meet, and between them.

In come stretches of common edges with the formulas of both patches; out goes an `EdgeProof`: of the gap, the angle and
the jump of curvature each is equal to zero, within a bound, different at a place, or numerical.

edge_formulas.py  the derivatives of a patch on an edge as a program of one parameter; splines span by span
specialised.py    programs on a line, their pieces chosen
stretches.py      a common edge as both formulas of one parameter, on parts without pieces, which pass into each other
uneven.py         parameters that run at different speeds
sides.py          what both patches are there, and what says that one passes into the other
algebra.py        fields of polynomials, in which what vanishes vanishes exactly; programs in that arithmetic
enclosures.py     both patches in balls on intervals that cover the edge
apart.py          points of one edge that are away from the other
proving.py        the proof of an edge
pole_proofs.py    the proof of a pole
insides.py        whether a patch is twice differentiable between its edges
edge_proof.py     what is proved
"""
