"""Normalisation: from any equation of a boundary to one that measures distance near it."""

from __future__ import annotations

from typing import Any

import sympy as sp

from rsym.analysis.differential import gradient
from rsym.errors import RsymError
from rsym.model.shape import Shape
from rsym.model.symbols import as_expression


def normalise(shape: Shape, order: int = 1, length: Any = 1) -> Shape:
    """omega_n = omega/sqrt(omega**2/L**2 + |grad omega|**2), normalised to order 1.

    On the boundary omega_n = 0 and its inner normal derivative is 1, wherever
    grad omega exists and is not zero. Far away omega_n tends to the length L in
    absolute value; L = 1 is the form of the source.

    Parameters
    ----------
    shape : Shape
        A shape whose gradient does not vanish on its boundary.
    order : int
        1; higher orders need derivatives of the same order.
    length : number or expression
        L > 0, in the unit of the coordinates.

    Raises
    ------
    RsymError
        For another order, or a length that is not positive.

    Source: Rvachev (1982); Lisin, Maksimenko-Sheiko and Sheiko (2013).

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> rsym.normalise(rsym.Shape(3 * x, (x, y))).expression
    3*x/sqrt(9*x**2 + 9)
    """
    if order != 1:
        raise RsymError(f"normalise supports order 1, got {order!r}", code="order", remedy="use order=1")
    unit = as_expression(length)
    if unit.is_number and not unit.is_positive:
        raise RsymError(f"the length must be positive, got {length}", code="length")
    squared = sp.Add(*(component**2 for component in gradient(shape)))
    return shape.replace(expression=shape.expression / sp.sqrt(shape.expression**2 / unit**2 + squared))
