"""Terms that saturate: far from their zero set they are nearly constant, whatever is added to or joined with them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
import sympy as sp

from rsym.model.traversal import postorder
from rsym.verify.lint.functions import Array

HIGH = 0.9  # of the greatest size
MUCH = 1 / 3  # of the bounds; of a linear function a tenth is as high, of a fourth root a third
MOST_TERMS = 40

_BOUNDED = (sp.exp, sp.tanh, sp.atan, sp.acot, sp.erf)


def level(values: Array) -> tuple[float, float]:
    """The greatest size of a function at points, and the share of them where it is near it.

    Examples
    --------
    >>> import numpy as np
    >>> t = np.linspace(-10, 10, 101)
    >>> greatest, share = level(np.tanh(t))
    >>> round(greatest, 3), share > 0.8
    (1.0, True)
    >>> level(t)[1] < 0.12
    True
    """
    sizes = np.abs(values[np.isfinite(values)])
    if not len(sizes):
        return 0.0, 0.0
    return float(sizes.max()), float((sizes > HIGH * sizes.max()).mean())


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
