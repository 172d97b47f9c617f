"""Elastic bodies in the plane: two displacements on one grid, and what they do to each other.

- `supports`: what holds or loads a part of the boundary, as data
- `bodies`: a body with its supports and loads; `equilibrium`: its system, and the forces in it
- `result`: displacements, stresses, reactions; `solving`: what is asked
"""
