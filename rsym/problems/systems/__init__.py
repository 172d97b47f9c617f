"""Linear systems of forms on weighted splines: a rule comes in, sparse matrices and their answers go out.

- `axis_sums`: what whole cells have in common; `cell_code`: compiled loops over cells
- `forms`: a form at the points of a rule, and its matrix
- `borders`: functions beside splines in the system, such as those of corners; `families`: splines with kinks
- `iterations`: answers by steps; `factors`: by factors; `linear`: linear systems and eigenvalues
"""
