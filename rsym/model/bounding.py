"""Boxes about shapes: the window that somebody states, or the box that a construction brings.

`Shape.bounds` is what was stated; a box that is not known to hold the boundary is proved before anything is looked at
in it (`rsym.sampling.windows`). The box of a solid shape holds its inside, that of the complement the outside. So a
conjunction lies where the boxes of its solid operands meet, whatever is cut off from it; a disjunction is dual.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any, TypeAlias

import sympy as sp

from rsym.errors import RsymError

Bounds: TypeAlias = tuple[tuple[float, float], ...]
Exact: TypeAlias = tuple[tuple[Any, Any], ...]


@dataclass(frozen=True)
class BoundingBox:
    """The ends as floats, the nearest; as they were stated, if they were.

    `solid` tells that the inside lies within, else the outside does; `known` that this holds by construction, so that
    nothing is to be proved of it where letters have their defaults.

    Examples
    --------
    >>> stated_box(((-1, sp.Rational(3, 5)), (0, 1)), 2).exact
    ((-1.0, Fraction(3, 5)), (0.0, 1.0))
    """

    ends: Bounds
    exact: Exact | None = None
    solid: bool = True
    known: bool = False

    @property
    def likely(self) -> BoundingBox:
        """The same box, about something that is nearly what it was made for; a statement stays one."""
        return replace(self, known=False)

    def mapped(self, change: Callable[[Any], Any], *, stated: bool = True) -> BoundingBox:
        """The box that is made of the ends; a stated one stays stated, unless letters move it."""
        if self.exact is not None and stated:
            ends = change(self.exact)
            return replace(stated_box(ends, len(ends)), solid=self.solid)
        return replace(self, ends=change(self.ends), exact=None)


def stated_box(bounds: Any, dimension: int) -> BoundingBox:
    """The box that somebody states: finite, increasing pairs."""
    try:
        exact = tuple((_exact(low), _exact(high)) for low, high in bounds)
        ends = tuple((float(low), float(high)) for low, high in exact)
    except (TypeError, ValueError) as error:
        raise RsymError(f"bounds must be pairs (low, high), got {bounds!r}", code="bounds") from error
    if len(ends) != dimension or not all(math.isfinite(a) and math.isfinite(b) and a < b for a, b in ends):
        raise RsymError(
            f"bounds must be {dimension} finite pairs with low < high, got {bounds!r}",
            code="bounds",
            remedy="for example ((-1, 1), (-1, 1))",
        )
    return BoundingBox(ends, exact)


def checked_bounds(bounds: Any, dimension: int) -> Bounds:
    """Bounds as pairs of floats; what is not so many finite, increasing pairs is refused.

    Examples
    --------
    >>> checked_bounds([[0, 1], [-2, 2]], 2)
    ((0.0, 1.0), (-2.0, 2.0))
    """
    return stated_box(bounds, dimension).ends


def outwards(bounds: Any, dimension: int) -> Bounds:
    """Bounds as pairs of floats that hold them: a proof over these is one over the exact numbers.

    Examples
    --------
    >>> outwards(((-1, sp.Rational(3, 5)), (0, 1)), 2)
    ((-1.0, 0.6000000000000001), (0.0, 1.0))
    """
    box = stated_box(bounds, dimension)
    assert box.exact is not None
    return tuple((_beyond(low, -math.inf), _beyond(high, math.inf)) for low, high in box.exact)


def hull(boxes: Sequence[Bounds]) -> Bounds | None:
    """The box around boxes; None around none.

    Examples
    --------
    >>> hull([((0, 1), (0, 1)), ((-1, 0), (0, 2))])
    ((-1, 1), (0, 2))
    """
    if not boxes:
        return None
    return tuple((min(low for low, _ in axis), max(high for _, high in axis)) for axis in zip(*boxes, strict=True))


def around(boxes: Sequence[BoundingBox | None]) -> BoundingBox | None:
    """The box of what has a boundary where one of some shapes has; unknown if one is."""
    every = [box for box in boxes if box is not None]
    if len(every) < len(boxes) or not every:
        return None
    solid = sum(not box.solid for box in every) % 2 == 0
    if every[0].exact is not None and all(box.exact == every[0].exact for box in every):
        return replace(every[0], solid=solid)
    ends = hull([box.ends for box in every])
    assert ends is not None
    return BoundingBox(ends, solid=solid, known=all(box.known for box in every))


def met(boxes: Sequence[BoundingBox | None]) -> BoundingBox | None:
    """The box of a conjunction: where those of its solid operands meet.

    Examples
    --------
    >>> wide, high = BoundingBox(((0.0, 4.0), (0.0, 1.0))), BoundingBox(((0.0, 1.0), (0.0, 4.0)))
    >>> met([wide, high]).ends, joined([wide, high]).ends, without([wide, high]).ends
    (((0.0, 1.0), (0.0, 1.0)), ((0.0, 4.0), (0.0, 4.0)), ((0.0, 4.0), (0.0, 1.0)))
    """
    solid = [box for box in boxes if box is not None and box.solid]
    if not solid:
        return lines(boxes)
    if solid[0].exact is not None and all(box.exact == solid[0].exact for box in solid):
        return solid[0]
    surest = [box for box in solid if box.known] or solid
    axes = zip(*(box.ends for box in surest), strict=True)
    ends = tuple((max(low for low, _ in axis), min(high for _, high in axis)) for axis in axes)
    if any(low >= high for low, high in ends):
        return around(surest)
    return BoundingBox(ends, known=surest[0].known)


def joined(boxes: Sequence[BoundingBox | None]) -> BoundingBox | None:
    """The box of a disjunction."""
    return opposite([met(opposite(boxes))])[0]


def lines(boxes: Sequence[BoundingBox | None]) -> BoundingBox | None:
    """The box of a function that is zero on lines and nowhere negative: only the outside of a complement holds it."""
    every = around(boxes)
    return None if every is None else replace(every, solid=False)


def combined(operation: str, *, exactly: bool = True) -> Callable[[Sequence[BoundingBox | None]], BoundingBox | None]:
    """The rule of a set operation; an operation that is only nearly that makes no box that is known."""
    rule = {"union": joined, "intersection": met, "difference": without}[operation]

    def box(boxes: Sequence[BoundingBox | None]) -> BoundingBox | None:
        found = rule(boxes)
        return found if exactly or found is None else found.likely

    return box


def opposite(boxes: Sequence[BoundingBox | None]) -> list[BoundingBox | None]:
    """The boxes of the complements."""
    return [None if box is None else replace(box, solid=not box.solid) for box in boxes]


def without(boxes: Sequence[BoundingBox | None]) -> BoundingBox | None:
    """The box of a difference, of the first and none of the others."""
    return met([*boxes[:1], *opposite(boxes[1:])])


def _exact(end: Any) -> Any:
    """A float where that is the number, else a fraction or what SymPy has."""
    if isinstance(end, sp.Basic) and not end.is_Rational:
        return end if not end.is_Float else float(end)
    nearest = float(end)
    if not math.isfinite(nearest) or isinstance(end, float):
        return nearest
    try:
        exact = Fraction(int(end.p), int(end.q)) if isinstance(end, sp.Rational) else Fraction(end)
    except TypeError:  # a short float of NumPy
        return nearest
    return nearest if Fraction(nearest) == exact else exact


def _beyond(end: Any, direction: float) -> float:
    """The float itself, else the next one in a direction from the nearest that is not beyond."""
    nearest = float(end)
    if isinstance(end, float):
        return nearest
    if isinstance(end, Fraction) and (Fraction(nearest) - end) * (1 if direction > 0 else -1) >= 0:
        return nearest
    return math.nextafter(nearest, direction)
