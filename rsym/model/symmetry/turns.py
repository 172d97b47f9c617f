"""Turns about a point of the plane or an axis in space: the coordinates they change, the box they need."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import sympy as sp

from rsym.errors import RsymError
from rsym.model.arguments import coordinate
from rsym.model.shape import Bounds, Shape


def turned_coordinates(shape: Shape, axis: Any) -> tuple[sp.Symbol, sp.Symbol]:
    """The two coordinates that a turn about the axis changes, the angle from the first to the second.

    Examples
    --------
    >>> import rsym
    >>> turned_coordinates(rsym.sphere(), "y")
    (z, x)
    """
    if shape.dimension == 2 and axis is None:
        return shape.coordinates
    if shape.dimension == 2:
        raise RsymError("a turn in the plane has no axis", code="axis", remedy="leave it out")
    position = 2 if axis is None else coordinate(axis, shape.coordinates)
    return shape.coordinates[(position + 1) % 3], shape.coordinates[(position + 2) % 3]


def turned_bounds(shape: Shape, turning: Sequence[sp.Symbol], radius: float = 0.0) -> Bounds | None:
    """The box that holds the old one, moved out by a radius along the first of these coordinates, however it turns.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> turned_bounds(rsym.Shape(x, (x, y), bounds=((-1, 2), (-4, 0))), (x, y), 1)
    ((-5.0, 5.0), (-5.0, 5.0))
    """
    if shape.bounds is None:
        return None
    box: Mapping[sp.Symbol, tuple[float, float]] = dict(zip(shape.coordinates, shape.bounds, strict=True))
    (low, high), *others = (box[symbol] for symbol in turning)
    moved = ((low + radius, high + radius), *others)
    reach = math.hypot(*(max(map(abs, ends)) for ends in moved))
    return tuple((-reach, reach) if symbol in turning else box[symbol] for symbol in shape.coordinates)
