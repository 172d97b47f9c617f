"""Functions of one parameter: curves, ribbons, cardinal functions, and what evaluates them.

In comes what a user means by a curve: expressions, points, a function of Python; out go values and derivatives.

formulas.py                   SymPy expressions as compiled functions, derivatives to any order; entry by entry
univariate.py                 the classes: formulas, constants, samples, other intervals, sums and stacks of others
polynomials.py, cardinals.py  piecewise polynomials; functions that are 1 at one knot and 0 at the others
nurbs.py                      rational B-spline curves
curves.py                     whatever a user means by a curve, as one of these; functions of Python
"""
