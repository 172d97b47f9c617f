"""When a polynomial is positive on an interval: a condition on its coefficients.

With the coefficients b_k of Bernstein's form, p = sum_k C(n, k) b_k (1 - u)**(n - k) u**k
for u from 0 to 1, the substitution w = u/(1 - u) makes it a question about
sum_k C(n, k) b_k w**k for w > 0, whose roots a discriminant counts:

- degree 1: b_0 > 0 and b_1 > 0;
- degree 2: besides, at the ends, b_1 >= 0 or b_1**2 < b_0 b_2;
- degree 3: besides, at the ends, b_1 >= 0 and b_2 >= 0, or a negative discriminant; for the product of the roots is
  negative, so that one is, and the others are negative too, or complex, or else positive. Schmidt and Hess (1988).

Without letters any degree is decided by halving the interval: coefficients that
are all positive prove it, an end that is not positive refutes it.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from itertools import pairwise

import sympy as sp
from sympy.logic.boolalg import Boolean

from rsym.errors import RsymError
from rsym.model.letters import Letter
from rsym.model.symbols import rebuild, substitute, symbols_of

HALVINGS = 60  # what is undecided then comes within 2**-120 of its size to zero: a halving quarters what is in doubt
DIGITS = 60  # to which numbers that are not rational are taken there


def positive_polynomial(
    polynomial: sp.Poly,
    low: sp.Expr,
    high: sp.Expr,
    letters: Mapping[str, Letter] | None = None,
    ends: tuple[sp.Expr, sp.Expr] | None = None,
) -> Boolean:
    """The condition under which a polynomial is positive from low to high.

    Parameters
    ----------
    letters : mapping, optional
        Those in the coefficients: what their ranges settle is left out of the condition.
    ends : pair of expressions, optional
        What has the signs of the polynomial at low and high, to be written instead of its values.

    Raises
    ------
    RsymError
        Above degree 3 with letters in the coefficients.

    Examples
    --------
    >>> import sympy as sp
    >>> s, c = sp.symbols("s c", real=True)
    >>> positive_polynomial(sp.Poly(c - s**2, s), sp.Integer(0), sp.Integer(1))
    (c > 0) & (c - 1 > 0)
    """
    (variable,) = polynomial.gens
    first, last = ends or (polynomial.eval(low), polynomial.eval(high))
    even = polynomial.degree() > 0 and all(degree % 2 == 0 for (degree,) in polynomial.monoms())
    if low == -high and even:
        squares = sp.Poly(polynomial.all_coeffs()[::2], variable)
        return positive_polynomial(squares, sp.S.Zero, high**2, letters, (polynomial.eval(0), last))
    coefficients = bernstein(polynomial, low, high)
    if not symbols_of(*coefficients):
        return sp.true if _is_positive([_fraction(item) for item in coefficients]) else sp.false
    return sp.And(first > 0, last > 0, _between(polynomial, coefficients, letters or {}))


def bernstein(polynomial: sp.Poly, low: sp.Expr, high: sp.Expr) -> list[sp.Expr]:
    """The coefficients b_k of sum_k C(n, k) b_k (1 - u)**(n - k) u**k with u = (s - low)/(high - low).

    Examples
    --------
    >>> import sympy as sp
    >>> s = sp.Symbol("s")
    >>> bernstein(sp.Poly(s**2, s), sp.Integer(0), sp.Integer(2))
    [0, 0, 4]
    """
    (variable,) = polynomial.gens
    exact = rebuild(polynomial.as_expr(), lambda part: sp.Rational(part) if part.is_Float else None)
    moved = sp.Poly(substitute(exact, {variable: low + (high - low) * variable}), variable)
    powers = moved.all_coeffs()[::-1]
    n = len(powers) - 1
    shares = [[sp.binomial(k, j) / sp.binomial(n, j) for j in range(k + 1)] for k in range(n + 1)]
    return [sp.cancel(sp.Add(*(a * b for a, b in zip(row, powers, strict=False)))) for row in shares]


def _between(polynomial: sp.Poly, b: list[sp.Expr], letters: Mapping[str, Letter]) -> Boolean:
    """That there is no root between two ends where the polynomial is positive."""
    if len(b) <= 2:
        return sp.true
    if len(b) == 3:
        if _in_range(polynomial.LC(), letters).is_nonpositive:
            return sp.true  # a concave one is above its chord
        return sp.Or(b[1] >= 0, b[1] ** 2 < b[0] * b[2])
    if len(b) == 4:
        cubic = sp.Poly([b[3], 3 * b[2], 3 * b[1], b[0]], *polynomial.gens)
        return sp.Or(sp.And(b[1] >= 0, b[2] >= 0), cubic.discriminant() < 0)
    raise RsymError(
        f"on this curve the profile is a polynomial of degree {len(b) - 1} with letters: no short condition is known",
        code="no-condition",
        remedy="give it numbers for letters or a lower degree, or ask verify_smoothness and smoothness_threshold",
    )


def _in_range(expression: sp.Expr, letters: Mapping[str, Letter]) -> sp.Expr:
    """The expression in symbols that know the signs of letters, for SymPy to tell its own."""
    signed: dict[sp.Basic, sp.Basic] = {}
    for symbol in symbols_of(expression):
        item = letters.get(symbol.name)
        if item is not None and item.minimum is not None and item.minimum >= 0:
            signed[symbol] = sp.Dummy(positive=True) if item.minimum > 0 else sp.Dummy(nonnegative=True)
    return substitute(expression, signed)


def _is_positive(coefficients: list[Fraction]) -> bool:
    pieces = [(coefficients, HALVINGS)]
    while pieces:
        piece, left = pieces.pop()
        if piece[0] <= 0 or piece[-1] <= 0:
            return False
        if min(piece) <= 0:
            if not left:
                return False
            pieces.extend((half, left - 1) for half in _halves(piece))
    return True


def _halves(coefficients: list[Fraction]) -> tuple[list[Fraction], list[Fraction]]:
    """De Casteljau: both halves of the interval."""
    lower, upper, row = [], [], coefficients
    while row:
        lower.append(row[0])
        upper.append(row[-1])
        row = [(a + b) / 2 for a, b in pairwise(row)]
    return lower, upper[::-1]


def _fraction(number: sp.Expr) -> Fraction:
    exact = number if number.is_Rational else sp.Rational(sp.N(number, DIGITS))
    return Fraction(int(exact.p), int(exact.q))
