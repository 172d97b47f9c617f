"""Functions of one parameter: curves, ribbons, cardinal functions, and what evaluates them.

In comes what a user means by a curve: expressions, points, a function of Python; out go values and derivatives.

entries.py                    arrays of expressions, entry by entry
formulas.py                   SymPy expressions as compiled functions, derivatives to any order included
univariate.py                 the classes: formulas, constants, stacks, samples, other intervals
polynomials.py, cardinals.py  piecewise polynomials; functions that are 1 at one knot and 0 at the others
callables.py, nurbs.py        functions of Python; rational B-spline curves
curves.py                     whatever a user means by a curve, as one of these
"""
