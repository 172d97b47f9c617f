"""Terms that saturate: far from their zero set they are nearly constant, whatever is added to or joined with them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
import sympy as sp

from rsym.arrays import Floats
from rsym.model.functions import FUNCTIONS
from rsym.model.symbols import postorder

# u/sqrt(1 + u**2) has a twelfth of its greatest slope where it has reached nine tenths of its greatest value;
# a strip that the bounds just hold is as high in a third of them, but as flat only in a tenth.
HIGH = 0.9
FLAT = 0.1
MUCH = 1 / 3  # of the bounds
MOST_TERMS = 40

_BOUNDED = tuple(row.kind for row in FUNCTIONS.values() if row.levels)


def level(values: Floats, slopes: Floats, slope: float) -> tuple[float, float]:
    """The greatest size of a function at points, and the share of them where it is near it and flat.

    slopes: the lengths of its gradient at the points; slope: that on its zero set.

    Examples
    --------
    >>> import numpy as np
    >>> t = np.linspace(-10, 10, 101)
    >>> greatest, share = level(np.tanh(t), 1 / np.cosh(t) ** 2, 1.0)
    >>> round(greatest, 3), share > 0.8
    (1.0, True)
    >>> level(t, np.ones(101), 1.0)[1]
    0.0
    """
    known = np.isfinite(values) & np.isfinite(slopes)
    sizes = np.abs(values[known])
    if not len(sizes):
        return 0.0, 0.0
    return float(sizes.max()), float(((sizes > HIGH * sizes.max()) & (slopes[known] < FLAT * slope)).mean())


def terms_of(leaves: Sequence[sp.Expr], coordinates: Sequence[sp.Symbol]) -> list[sp.Expr]:
    """Terms inside leaves that may be bounded, each added to another one that depends on the coordinates.

    Examples
    --------
    >>> import sympy as sp
    >>> from rsym import x, y
    >>> terms_of([y + x / sp.sqrt(1 + x**2), 1 - sp.tanh(x)], (x, y))
    [x/sqrt(x**2 + 1)]
    """
    found: dict[sp.Expr, None] = {}
    for leaf in leaves:
        for total in _sums(leaf):
            varying = [term for term in total.args if term.free_symbols.intersection(coordinates)]
            if len(varying) > 1:
                found |= dict.fromkeys(term for term in varying if _may_be_bounded(term, coordinates))
    return list(found)[:MOST_TERMS]


def _sums(leaf: sp.Expr) -> Iterator[sp.Expr]:
    """The sums in a leaf, but for those under roots."""
    parts = postorder(leaf)
    under = {id(part.base) for part in parts if part.is_Pow and not part.exp.is_Integer}
    return (part for part in parts if part.is_Add and id(part) not in under)


def _may_be_bounded(term: sp.Expr, coordinates: Sequence[sp.Symbol]) -> bool:
    """Whether it is a quotient by a root in the coordinates, or made with a function that levels off."""
    pieces = [term, *(factor for factor in sp.Mul.make_args(term))]
    quotient = any(
        piece.is_Pow and piece.exp.is_negative and piece.base.free_symbols.intersection(coordinates) for piece in pieces
    )
    return quotient or any(isinstance(part, _BOUNDED) for part in postorder(term))
