"""Where a shape is looked at: the window that somebody states, else a box that is proved to hold its boundary."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress
from dataclasses import replace
from fractions import Fraction
from typing import Any

import numpy as np

from rsym.errors import RsymError, warn
from rsym.logic.sign_form import SignForm, surface_form
from rsym.model.bounding import BoundingBox, checked_bounds, hull, outwards
from rsym.model.recent import recently, written
from rsym.model.requirements import require_shape
from rsym.model.shape import Bounds, Shape
from rsym.sampling.extent import extent, extent_of, holds_boundary, opened_form, proved_signs
from rsym.sampling.form_signs import Boxes, FormBounds, FormSigns, check_parameters, grid, points

SURROUNDINGS = 1 / 8  # of a side, shown around a zero set whose bounds were found
SHARES = Fraction(1, 2), Fraction(0), Fraction(1)  # of ranges of letters
AROUND, LOOKED_AT = (0.03, 0.3, 3.0), 24  # times a side beyond a window, and points along each axis there


def bounds_or_extent(
    shape: Shape, bounds: Any, letters: Mapping[Any, float] | None = None, *, room: float = 0.0
) -> Bounds:
    """Where a shape is looked at: the bounds given, else those that it states, else a box that holds its boundary.

    That is the box that it was built with, if letters have their defaults and it is known, or else is proved, to hold
    the boundary; else the extent, with room around it as a share of its sides.

    Raises
    ------
    RsymError
        ``unbounded`` where the boundary goes on without end and no window is stated; ``parameter`` for letters with
        which an R-operation has no value.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> bounds_or_extent(rsym.Shape(1 - x**2 - y**2, (x, y), bounds=((-2, 2), (-2, 2))), None)
    ((-2.0, 2.0), (-2.0, 2.0))
    >>> bounds_or_extent(rsym.disc(1), None)
    ((-1.2, 1.2), (-1.2, 1.2))
    """
    check_letters(shape, letters)
    if bounds is not None:
        return checked_bounds(bounds, shape.dimension)
    if shape.bounds is not None:
        return shape.bounds
    found, how = _all_of_it(shape, letters)
    if how == "unproved":
        ends = ", ".join(f"[{low:.6g}, {high:.6g}]" for low, high in found)
        warn(
            f"it is not proved that the boundary lies within {ends}, where it is sought; bounds=... says where to look"
        )
    return surrounded(found, room) if how == "found" else found


def check_letters(shape: Shape, *places: Mapping[Any, float] | None) -> None:
    """Refuse letters with which an R-operation of a shape has no value: there is nothing to be looked at."""
    require_shape(shape)
    for place in places if shape.letters else ():
        check_parameters(_form(shape), shape.letters.values_with(place))


@recently(16, written)
def _form(shape: Shape) -> SignForm:
    """Its sign form, of which nothing but parameters is asked."""
    return surface_form(shape)


def outer_bounds(shape: Shape, bounds: Any, letters: Mapping[str, tuple[Any, Any]]) -> Bounds:
    """As `bounds_or_extent`, for proofs at ranges of letters: floats that hold the exact numbers of a window.

    Over ranges the box is that around both ends and the middle, if it is proved to hold the boundary at all letters
    between, else around what does; where nothing is proved it is a window (`holds_at_all`).

    Raises
    ------
    RsymError
        ``parameter`` for letters with which an R-operation has no value: where nothing is known there is no proof.

    Examples
    --------
    >>> import rsym
    >>> outer_bounds(rsym.loads("bounds x [-1, 0.6] y [-1, 1]; omega = 0.6 - x"), None, {})
    ((-1.0, 0.6000000000000001), (-1.0, 1.0))
    """
    shares = {0 if low == high else share for low, high in letters.values() for share in SHARES} or {0}
    places = [{name: float(low + share * (high - low)) for name, (low, high) in letters.items()} for share in shares]
    check_letters(shape, *places)
    stated = bounds if bounds is not None or shape.bounds is None or shape.box is None else shape.box.exact
    if stated is not None:
        return outwards(stated, shape.dimension)
    boxes = [bounds_or_extent(shape, None, place) for place in places]
    found = hull(boxes)
    assert found is not None
    if len(places) > 1 and not holds_at_all(shape, found, letters):
        with suppress(RsymError):
            found = hull([found, extent_of(FormSigns(FormBounds(opened_form(shape)), letters))]) or found
    return found


def holds_at_all(shape: Shape, bounds: Bounds, letters: Mapping[str, tuple[Any, Any]]) -> bool:
    """Whether it is proved that bounds hold the boundary at all letters between ends.

    Examples
    --------
    >>> import rsym
    >>> import sympy as sp
    >>> from rsym import x, y
    >>> a = sp.Symbol("a", real=True)
    >>> disc = rsym.disc(sp.Rational(1, 2), (4 * a * (1 - a), 0), letters={a: 0})
    >>> [holds_at_all(disc, ((-1, right), (-1, 1)), {"a": (0, 1)}) for right in (1, 5)]
    [False, True]
    """
    return holds_boundary(FormSigns(FormBounds(opened_form(shape)), letters), bounds)


def surrounded(bounds: Bounds, room: float) -> Bounds:
    """Bounds with some room around them, a share of their sides.

    Examples
    --------
    >>> surrounded(((0.0, 8.0), (0.0, 4.0)), 1 / 8)
    ((-1.0, 9.0), (-0.5, 4.5))
    """
    return tuple((low - room * (high - low), high + room * (high - low)) for low, high in bounds)


def relettered(shape: Shape, values: Mapping[Any, Any]) -> Shape:
    """The shape at other letters, within bounds about it there where it has any: those of before may cut it."""
    changed = shape.with_letters(values)
    if shape.box is None or changed.letters == shape.letters:
        return changed
    with suppress(RsymError):
        box = surrounded(extent(changed), SURROUNDINGS)
        return changed.replace(bounds=box) if changed.bounds else replace(changed, box=BoundingBox(box))
    return changed


def _all_of_it(shape: Shape, letters: Mapping[Any, float] | None) -> tuple[Bounds, str]:
    """A box that holds the boundary, and how that is known."""
    values = shape.letters.values_with(letters)
    box = shape.box if values == shape.letters.values_with(None) else None
    if box is not None and box.known:
        return box.ends, "known"
    try:
        return _whole(shape, tuple(values.items()), None if box is None else box.ends)
    except RsymError as error:
        if shape.box is None or error.code != "empty":
            raise
        return shape.box.ends, "known"  # there is nothing in it either


@recently(16, written)
def _whole(shape: Shape, values: tuple[tuple[str, float], ...], likely: Bounds | None) -> tuple[Bounds, str]:
    """A box that holds the boundary, "found" or "likely", or the likely one of which that is "unproved"."""
    if likely is not None and holds_boundary(proved_signs(shape, dict(values)), likely):
        return likely, "likely"
    try:
        found = extent(shape, dict(values))
    except RsymError as error:
        if likely is None or error.code != "unproved":
            raise
        return likely, "unproved"
    inside = likely is not None and all(a <= c and d <= b for (a, b), (c, d) in zip(likely, found, strict=True))
    return (likely, "likely") if likely is not None and inside else (found, "found")


def goes_beyond(shape: Shape, bounds: Any = None, letters: Mapping[Any, float] | None = None) -> bool | None:
    """Whether the boundary goes on outside of the window given, or stated; None where neither is proved.

    All of it lies within where one sign is proved outside; it goes on where two are, for the outside is connected.

    Examples
    --------
    >>> import rsym
    >>> disc = rsym.disc(2)
    >>> [goes_beyond(disc, ((-reach, reach),) * 2) for reach in (1, 3)], goes_beyond(disc)
    ([True, False], False)
    """
    window = bounds if bounds is not None else shape.bounds
    if window is None:
        return None if _all_of_it(shape, letters)[1] == "unproved" else False
    values = shape.letters.values_with(letters)
    box = outwards(window, shape.dimension)
    signs = proved_signs(shape, values)
    if holds_boundary(signs, box):
        return False
    lower, upper = np.array(box)[:, :1], np.array(box)[:, 1:]
    outer = [grid(Boxes(lower - by * (upper - lower), upper + by * (upper - lower)), LOOKED_AT) for by in AROUND]
    places = np.hstack([part.centres for part in outer])
    places = places[:, ((places < lower) | (places > upper)).any(axis=0)]
    if {-1, 1} <= set(signs.over(points(places)).tolist()):
        return True
    with suppress(RsymError):
        found = extent(shape, values)
        return None if any(c < a or b < d for (a, b), (c, d) in zip(box, found, strict=True)) else False
    return None
