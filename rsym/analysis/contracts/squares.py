"""Sums of squares: where they vanish, and whether they can."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import sympy as sp

from rsym.model.symbols import postorder

_PARTS = 60  # of what is expanded when a variable is eliminated: the fenders of a car take 25


def squares_of(expression: sp.Expr) -> tuple[sp.Expr, ...] | None:
    """The bases b of a sum of terms c*b**n, c > 0 and n even, which vanishes where all b do; None for other sums.

    A term in positive numbers alone means that the sum is never zero: its base is 1.

    Examples
    --------
    >>> from rsym import x, y
    >>> squares_of(x**2 + 4 * (y - 1)**2), squares_of(x**2 + y)
    ((x, y - 1), None)
    """
    bases: dict[sp.Expr, None] = {}
    for term in sp.Add.make_args(expression):
        inner = _bases(term)
        if inner is None:
            return None
        bases.update(dict.fromkeys(inner))
    return tuple(bases)


def _bases(term: sp.Expr) -> tuple[sp.Expr, ...] | None:
    """What a term is the sum of squares of, up to positive factors."""
    result: tuple[sp.Expr, ...] = (sp.S.One,)
    for factor in sp.Mul.make_args(term):
        inner: tuple[sp.Expr, ...] | None = None
        if factor.is_Pow and factor.exp.is_Integer and factor.exp % 2 == 0:
            inner = (factor.base if factor.exp > 0 else sp.S.One,)
        elif factor.is_number and factor.is_positive:
            inner = (sp.S.One,)
        elif factor.is_Add:
            inner = squares_of(factor)
        if inner is None:
            return None
        result = tuple(u * v for u in result for v in inner)
    return result


def never_zero_together(
    equations: Sequence[sp.Expr],
    coordinates: Sequence[sp.Symbol],
    nonzero: Callable[[sp.Expr], bool] = lambda value: bool(value != 0),
) -> bool:
    """Whether linear elimination shows that no point makes all equations zero.

    nonzero: whether an expression without coordinates is known not to be zero, by default if it is not so by form.

    Examples
    --------
    >>> from rsym import x, y
    >>> never_zero_together((1 - x**2 - y**2, x, y), (x, y))
    True
    """
    left = [part for equation in equations for part in squares_of(equation) or (equation,)]
    while True:
        if any(not equation.free_symbols & set(coordinates) and nonzero(equation) for equation in left):
            return True
        if any(len(postorder(equation)) > _PARTS or not equation.is_polynomial(*coordinates) for equation in left):
            return False
        solved = _solved(left, coordinates, nonzero)
        if solved is None:
            return False
        position, symbol, value = solved
        left = [sp.expand(other.subs(symbol, value)) for k, other in enumerate(left) if k != position]


def _solved(
    equations: Sequence[sp.Expr], coordinates: Sequence[sp.Symbol], nonzero: Callable[[sp.Expr], bool]
) -> tuple[int, sp.Symbol, sp.Expr] | None:
    """An equation that is linear in a coordinate, with that coordinate's value."""
    for position, equation in enumerate(equations):
        for symbol in coordinates:
            if not equation.has(symbol) or not equation.is_polynomial(symbol):
                continue
            slope = sp.expand(equation.diff(symbol))
            if not slope.free_symbols & set(coordinates) and nonzero(slope):
                return position, symbol, sp.expand(symbol - equation / slope)
    return None
