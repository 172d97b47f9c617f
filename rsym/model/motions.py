"""Shapes from shapes by substitution into the coordinates."""

from __future__ import annotations

from typing import Any

import sympy as sp

from rsym.errors import RsymError
from rsym.model.shape import Shape
from rsym.model.symbols import real_symbol, x
from rsym.model.traversal import substitute


def revolve(shape: Shape, axis: Any = x) -> Shape:
    """The body swept by a plane shape turning about one of its coordinate axes.

    About x: omega(x, sqrt(y**2 + z**2)). The substitution comes before any
    derivative, and sqrt(y**2 + z**2)**2 becomes y**2 + z**2, so a profile that
    is smooth in y**2 has a smooth body on the axis too.

    Parameters
    ----------
    shape : Shape
        A shape in the plane.
    axis : symbol
        The coordinate that stays.

    Raises
    ------
    RsymError
        For a shape in space, or an axis that is not one of its coordinates.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> rsym.revolve(rsym.Shape(1 - x**2 - y**2, (x, y))).expression
    -x**2 - y**2 - z**2 + 1
    """
    names = [symbol.name for symbol in shape.coordinates]
    if shape.dimension != 2 or str(axis) not in names:
        raise RsymError(
            f"revolve needs a plane shape and one of its coordinates as axis, got {names} and {axis}",
            code="revolve",
            remedy="revolve(shape, axis=x) with a shape in (x, y)",
        )
    third = real_symbol("z" if "z" not in names else "y")
    if third.name in shape.letters:
        raise RsymError(f"the letter {third.name!r} would become a coordinate", code="revolve", remedy="rename it")
    turning = shape.coordinates[1 - names.index(str(axis))]
    radius = sp.sqrt(turning**2 + third**2)
    bounds = None
    if shape.bounds is not None:
        reach = max(abs(end) for end in shape.bounds[1 - names.index(str(axis))])
        around = (-reach, reach)
        kept = shape.bounds[names.index(str(axis))]
        bounds = (kept, around, around) if names.index(str(axis)) == 0 else (around, kept, around)
    return Shape(
        substitute(shape.expression, {turning: radius}),
        (*shape.coordinates, third),
        letters=shape.letters,
        bounds=bounds,
        parts=tuple((name, substitute(part, {turning: radius})) for name, part in shape.parts),
    )
