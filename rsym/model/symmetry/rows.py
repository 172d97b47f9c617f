"""Rows and grids: a motif repeated along one, two or three coordinates."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import sympy as sp

from rsym.errors import RsymError
from rsym.model.arguments import LetterMapping, coordinate, default, positive, whole
from rsym.model.bounding import BoundingBox, Bounds
from rsym.model.equation import substituted
from rsym.model.requirements import require_shape
from rsym.model.shape import Shape
from rsym.model.symbols import x
from rsym.model.symmetry.copies import apart
from rsym.model.symmetry.cyclic import checked_motif
from rsym.model.symmetry.evenness import check_even
from rsym.model.symmetry.waves import SawtoothRow, SawtoothWave, TriangleRow, triangle_wave


def row(
    shape: Shape,
    period: Any,
    *,
    axis: Any = x,
    count: Any = None,
    centred: bool = False,
    terms: Any = None,
    motif: str = "even",
    letters: LetterMapping = None,
) -> Shape:
    """A motif again and again along a coordinate: omega0(mu(x), y, ...), one copy every h.

    infinite: mu(x) = (h/pi) asin(sin(pi x/h)), copies at k h for every integer k
    n copies: the same on the cells of the copies 0, h, ..., (n - 1) h, straight on outside, so the ends are exact;
    centred they are -(n - 1) h/2, ..., (n - 1) h/2

    What of the motif lies within the cell |x| <= h/2 counts, at the ends of
    a finite row also what sticks out. Exact inside the cells: every order of normalisation
    is kept; on the borders x = (k + 1/2) h there is a kink unless the boundary
    meets them at a right angle. With N terms the field is analytic, but the boundary moves.
    Any motif: mu = x - h round(x/h), and the field jumps on the borders; in a finite row one without letters that
    provably lies within its cell is copied, omega the largest of the copies, the same near the boundary.

    Parameters
    ----------
    shape : Shape
        The motif, even in the coordinate along which it is repeated.
    period : number or expression
        h > 0, in the unit of the coordinates.
    axis : symbol
        The coordinate along which to repeat.
    count : integer, optional
        n; the first copy is the motif itself. Without it the row is infinite.
    centred : bool
        Whether the middle of a finite row is where the motif is.
    terms : integer, optional
        N, for the series instead of the exact wave; for infinite rows.
    motif : "even" or "any"
        Whether the motif must be even.
    letters : mapping, optional
        Values of the letters in the period.

    Raises
    ------
    RsymError
        For a motif that is not even where it must be, a period that is not positive, a wrong axis or count.

    Source: Maksimenko-Sheiko and Sheiko (2008).

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> discs = row(rsym.Shape((1 - x**2 - y**2) / 2, (x, y)), 3, count=4)
    >>> rsym.compile(discs)([0.0, 3.0, 9.0, 12.0], 0.0)["value"].round(6)
    array([ 0.5,  0.5,  0.5, -4. ])
    """
    require_shape(shape)
    known = shape.letters.merge(letters)
    period, along = positive(period, "the period", known), shape.coordinates[coordinate(axis, shape.coordinates)]
    even = checked_motif(motif, terms)
    if even:
        check_even(shape, along)
    if count is None:
        if centred:
            raise RsymError("an infinite row has no middle", code="centred", remedy="give count, or leave centred out")
        wave = triangle_wave(along, period, terms) if even else SawtoothWave(along, period)
        return substituted(shape, {along: wave}, letters=letters)
    number = whole(count, "the count", 1)
    first = -period * (number - 1) / 2 if centred else sp.S.Zero
    box = _lengthened(shape, along, default(first, known), (number - 1) * default(period, known))
    if not even and (made := _apart(shape, along, period, number, first, box)) is not None:
        return made
    wave = _finite(along, period, number, terms, even).xreplace({along: along - first})
    return substituted(shape, {along: wave}, letters=letters, box=box)


def _apart(
    shape: Shape, along: sp.Symbol, period: sp.Expr, count: int, first: sp.Expr, box: BoundingBox | None
) -> Shape | None:
    """The copies, if the motif lies between the borders of its cell."""
    copies = [{along: along - first - k * period} for k in range(count)]
    return apart(shape, copies, [{along: way * (along - period / 2)} for way in (1, -1)], along, box)


def grid(
    shape: Shape,
    periods: Sequence[Any],
    *,
    counts: Sequence[Any] | None = None,
    centred: bool = False,
    terms: Any = None,
    motif: str = "even",
    letters: LetterMapping = None,
) -> Shape:
    """Rows of rows: a motif repeated along the first two or all three coordinates.

    omega0(mu_1(x), mu_2(y)[, mu_3(z)]), the waves those of `row`, with its order and its borders.

    Parameters
    ----------
    shape : Shape
        The motif, even in every coordinate along which it is repeated.
    periods : sequence of numbers or expressions
        One for each coordinate in turn; fewer than coordinates leave the last ones alone.
    counts : sequence of integers, optional
        How many copies along each; without them the grid is infinite.
    centred, terms, motif, letters
        As for `row`.

    Raises
    ------
    RsymError
        As `row` does, and for a wrong number of periods or counts.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> discs = grid(rsym.Shape((1 - x**2 - y**2) / 2, (x, y)), (3, 4), counts=(2, 3))
    >>> rsym.compile(discs)([3.0, 3.0], [8.0, 12.0])["value"].round(6)
    array([ 0.5, -7.5])
    """
    require_shape(shape)
    if not isinstance(periods, Sequence) or isinstance(periods, str):
        remedy = f"({', '.join([str(periods)] * shape.dimension)})"
        raise RsymError(f"a grid needs a period for each coordinate, got {periods!r}", code="grid", remedy=remedy)
    numbers = (None,) * len(periods) if counts is None else tuple(counts)
    if not 1 <= len(periods) <= shape.dimension or len(numbers) != len(periods):
        raise RsymError(
            f"a grid needs 1 to {shape.dimension} periods and as many counts, got {len(periods)} and {len(numbers)}",
            code="grid",
        )
    for axis, period, count in zip(shape.coordinates, periods, numbers, strict=False):
        shape = row(shape, period, axis=axis, count=count, centred=centred, terms=terms, motif=motif, letters=letters)
    return shape


def _finite(place: sp.Symbol, period: sp.Expr, cells: int, terms: Any, even: bool) -> sp.Expr:
    if terms is not None:
        raise RsymError(
            "a finite row has no series",
            code="terms",
            remedy="intersect the infinite row with a strip, or leave terms out",
        )
    if cells == 1:
        return place
    return (TriangleRow if even else SawtoothRow)(place, period, sp.Integer(cells))


def _lengthened(shape: Shape, along: sp.Symbol, first: float, length: float) -> BoundingBox | None:
    def longer(ends: Bounds) -> Bounds:
        pairs = zip(shape.coordinates, ends, strict=True)
        return tuple(
            (low + first, high + first + length) if symbol == along else (low, high) for symbol, (low, high) in pairs
        )

    return shape.box and shape.box.mapped(longer)
