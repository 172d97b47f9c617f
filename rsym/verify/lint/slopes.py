"""Leaves that are not normalised: the gradient on their zero set, and what to divide by."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import sympy as sp

from rsym.model.traversal import postorder
from rsym.verify.lint.functions import Array
from rsym.verify.lint.places import written_out

MOST_PIECES = 60  # of a formula whose divisor is sought
CONSTANT = 1e-6  # relative: lengths of the gradient that differ by less are one
VANISHING = 1e-3  # of the greatest length of a gradient, which at random points comes that near to a zero


def message_of(slopes: Array) -> str:
    """What is wrong with a leaf.

    Examples
    --------
    >>> import numpy as np
    >>> message_of(np.array([0.5, 2.0])), message_of(np.array([2.5, 2.5]))
    ('|grad| on its zero set is 0.5 .. 2, not 1', '|grad| on its zero set is 2.5, not 1')
    """
    low, high = float(slopes.min()), float(slopes.max())
    size = f"{high:.4g}" if _constant(slopes) else f"{low:.4g} .. {high:.4g}"
    return f"|grad| on its zero set is {size}, not 1"


def remedy_of(leaf: sp.Expr, slopes: Array, coordinates: Sequence[sp.Symbol]) -> str:
    """What to do about it: the divisor where the leaf has a constant one, else a normalisation."""
    if slopes.max() < CONSTANT:
        return "the gradient vanishes on the zero set: take the function itself, not its power"
    if _constant(slopes):
        found = divisor(leaf, coordinates)
        return f"divide by {written_out(found) if found is not None else f'{slopes.mean():.6g}'}"
    if slopes.min() < VANISHING * slopes.max():
        return "take a primitive; rsym.normalise does not help where the gradient vanishes on the zero set"
    return "take a primitive, or rsym.normalise: f/sqrt(f^2/L^2 + |grad f|^2), L the size of the model"


def _constant(slopes: Array) -> bool:
    return bool(np.ptp(slopes) <= CONSTANT * slopes.max())


def divisor(leaf: sp.Expr, coordinates: Sequence[sp.Symbol]) -> sp.Expr | None:
    """The length of the gradient on the zero set: of a linear function, of a quadratic one in one coordinate.

    Examples
    --------
    >>> import sympy as sp
    >>> from rsym import x, y
    >>> a, b = sp.symbols("a b", real=True)
    >>> divisor(a * x - b * y + 1, (x, y)), divisor((b - x) * (x - a), (x, y)), divisor(x * y, (x, y))
    (sqrt(a**2 + b**2), Abs(a - b), None)
    """
    used = [symbol for symbol in coordinates if symbol in leaf.free_symbols]
    if not used or len(postorder(leaf)) > MOST_PIECES or not leaf.is_polynomial(*used):
        return None
    polynomial = sp.Poly(leaf, *used)
    if polynomial.total_degree() == 1:
        return sp.sqrt(sp.Add(*(polynomial.coeff_monomial(symbol) ** 2 for symbol in used)))
    if polynomial.total_degree() == 2 and len(used) == 1:
        return sp.sqrt(sp.factor(polynomial.discriminant()))
    return None
