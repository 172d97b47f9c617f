"""Arrays of expressions, entry by entry."""

from __future__ import annotations

from typing import Any

import numpy as np
import sympy as sp

from rsym.errors import RsymError
from rsym.model.symbols import as_expression


def exact(value: float) -> sp.Expr:
    """The shortest decimal that is this float64, as a fraction.

    Examples
    --------
    >>> exact(0.1), exact(3.0)
    (1/10, 3)
    """
    if not np.isfinite(value):
        raise RsymError(f"a finite number is expected, got {value!r}", code="number", remedy="mend the number")
    return sp.Rational(repr(float(value)))


def entries_of(array: sp.NDimArray) -> list[sp.Expr]:
    """The entries of an array in their order; of one without axes its only entry."""
    return list(sp.flatten(array.tolist())) if array.shape else [array[()]]


def entries_and_shape(given: Any) -> tuple[list[sp.Expr], tuple[int, ...]]:
    """A nested sequence, matrix or array of expressions as a list and its shape."""
    if isinstance(given, sp.MatrixBase) and 1 in given.shape:
        given = list(given)
    if isinstance(given, sp.Expr):
        return [given], ()
    if isinstance(given, sp.NDimArray) and not given.shape:
        return [as_expression(given[()])], ()
    array = np.array(given.tolist() if isinstance(given, sp.MatrixBase | sp.NDimArray) else given, dtype=object)
    return [as_expression(entry) for entry in array.flat], array.shape
