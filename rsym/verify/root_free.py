"""Leaves with square roots as polynomials: (A + B r)(A - B r) = A**2 - B**2 s, with r = sqrt(s), has no root left.

Where the conjugate A - B r has one sign the leaf has the sign of that polynomial, or the opposite one: the zeros of
R - sqrt(x**2 + y**2) are those of R**2 - x**2 - y**2, as R + sqrt(x**2 + y**2) is positive.
"""

from __future__ import annotations

from dataclasses import dataclass

import sympy as sp

from rsym.program.lowering import lower
from rsym.verify.local import Local, Model
from rsym.verify.polynomials import polynomial_of

HIGHEST, MOST = 12, 200  # degree and number of terms of a polynomial that is worth its divisions
ROOTS = 3  # each doubles the degree


@dataclass(frozen=True)
class RootFree:
    """A polynomial that is the product of a leaf and the conjugates: nodes, each with the sign that is asked of it."""

    polynomial: sp.Poly
    conjugates: tuple[int, ...]

    def sign(self, local: Local) -> int:
        """What the sign of the polynomial is to be multiplied by on a box to be that of the leaf; 0 if not known."""
        sign = 1
        for conjugate in self.conjugates:
            local.value(conjugate)
            sign *= local.sign(conjugate)
        return sign


def root_free(model: Model, leaf: int) -> RootFree | None:
    """The polynomial of a leaf that is one in the coordinates and in square roots; None if it is no such leaf.

    Examples
    --------
    >>> import rsym, sympy as sp
    >>> from rsym import x, y
    >>> model = Model(rsym.Shape(2 - sp.sqrt(x**2 + y**2), (x, y)), {})
    >>> root_free(model, model.root).polynomial.as_expr()
    -x**2 - y**2 + 4
    """
    symbols = [sp.Symbol(name, real=True) for name in model.builder.coordinates]
    roots: dict[sp.Symbol, sp.Expr] = {}
    expression = polynomial_of(model, leaf, roots)
    if expression is None or len(roots) > ROOTS:
        return None
    written: dict[sp.Symbol, sp.Expr] = {}
    for root, radicand in roots.items():
        written[root] = sp.sqrt(radicand.xreplace(written))
    conjugates = []
    for root in reversed(roots):  # an inner root stands before those around it
        even, odd = _halves(expression, root, roots[root])
        if odd != 0:
            conjugates.append((even - odd * root).xreplace(written))
        expression = sp.expand(even**2 - odd**2 * roots[root]) if odd != 0 else even
    polynomial = sp.Poly(expression, *symbols, domain=sp.QQ)
    if not 0 < polynomial.total_degree() <= HIGHEST or len(polynomial.terms()) > MOST:
        return None
    return RootFree(polynomial, tuple(lower(model.builder, conjugate) for conjugate in conjugates))


def _halves(expression: sp.Expr, root: sp.Symbol, radicand: sp.Expr) -> tuple[sp.Expr, sp.Expr]:
    """A and B of an expression A + B r, with r**2 replaced by its radicand."""
    halves = [sp.Integer(0), sp.Integer(0)]
    for (power,), coefficient in sp.Poly(expression, root).terms():
        halves[power % 2] += coefficient * radicand ** (power // 2)
    return sp.expand(halves[0]), sp.expand(halves[1])
