"""A shape with something else in the place of its coordinates: what every motion and construction is."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import sympy as sp

from rsym.errors import RsymError
from rsym.model.arguments import LetterMapping
from rsym.model.shape import Shape
from rsym.model.traversal import substitute


def substituted(
    shape: Shape,
    places: Mapping[sp.Symbol, sp.Expr],
    *,
    coordinates: tuple[sp.Symbol, ...] | None = None,
    factor: Any = 1,
    letters: LetterMapping = None,
    bounds: Any = None,
) -> Shape:
    """Factor * omega(places), parts alike; letters are added to those of the shape, bounds are the new ones.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> substituted(rsym.Shape(x + y, (x, y)), {x: y, y: x - 1}).expression
    x + y - 1
    """
    coordinates = shape.coordinates if coordinates is None else coordinates
    taken = shape.letters.keys() & {symbol.name for symbol in coordinates}
    if taken:
        raise RsymError(
            f"the letter {min(taken)!r} would become a coordinate", code="coordinates", remedy="rename the letter"
        )
    factor = sp.sympify(factor)
    return Shape(
        factor * substitute(shape.expression, places),
        coordinates,
        letters=shape.letters.merge(letters),
        bounds=bounds,
        parts=tuple((name, factor * substitute(part, places)) for name, part in shape.parts),
    )
