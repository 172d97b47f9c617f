"""Bodies grown, shrunk and hollowed out by means of the distance that omega measures."""

from __future__ import annotations

from typing import Any

from rsym.model.arguments import LetterMapping, default, number, positive
from rsym.model.requirements import require_shape
from rsym.model.shape import Shape
from rsym.model.systems import R0, RSystem


def offset(shape: Shape, distance: Any, *, letters: LetterMapping = None) -> Shape:
    """The body grown by a distance, shrunk by a negative one: omega + distance.

    It is the true offset as far as omega measures distance: near the boundary if omega is normalised, everywhere
    if it is exact.

    Raises
    ------
    RsymError
        For a distance that is no number.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> rsym.offset(rsym.Shape(x, (x, y)), 2).expression
    x + 2
    """
    require_shape(shape)
    grown, known = number(distance, "a distance"), shape.letters.merge(letters)
    room = max(default(grown, known), 0.0)
    bounds = None if shape.bounds is None else tuple((low - room, high + room) for low, high in shape.bounds)
    return Shape(shape.expression + grown, shape.coordinates, letters=known, bounds=bounds)


def shell(shape: Shape, thickness: Any, *, system: RSystem = R0, letters: LetterMapping = None) -> Shape:
    """The wall inside a body, from its boundary to the depth `thickness`: omega and thickness - omega.

    The two never vanish together, so nothing is lost in smoothness; normalised to order 1 where omega is 0, and
    on the inner side as far as |grad omega| = 1 there.

    Raises
    ------
    RsymError
        For a thickness that is not positive.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> rsym.shell(rsym.Shape(x, (x, y)), 2).expression
    conjunction(x, 2 - x)
    """
    require_shape(shape)
    known = shape.letters.merge(letters)
    depth = positive(thickness, "the thickness", known)
    wall = system.conjunction(shape.expression, depth - shape.expression)
    return Shape(wall, shape.coordinates, letters=known, bounds=shape.bounds, parts=shape.parts)
