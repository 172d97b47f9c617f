"""Linear systems of forms on weighted splines: a rule comes in, sparse matrices and their answers go out.

- `cell_code`: compiled loops over cells
- `forms`: a form at the points of a rule, and its matrix
- `linear`: linear systems and eigenvalues
"""
