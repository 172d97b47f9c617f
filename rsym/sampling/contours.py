"""Level lines: found on a lattice, moved onto the level, then cut at the bounds, which the lattice reaches beyond."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import asdict, dataclass, replace
from html import escape
from typing import Any, TypeAlias, overload

import numpy as np
from numpy.typing import NDArray

from rsym.arrays import Flags, Floats
from rsym.errors import RsymError, warn
from rsym.model.requirements import optional_package
from rsym.model.shape import Bounds
from rsym.reports.document import Document, Sentence, numerical
from rsym.reports.render import Report
from rsym.reports.words import first_of, plural
from rsym.sampling.plane import PlaneSampler
from rsym.sampling.stills import line_picture

NEWTON_STEPS = 12
# A vertex is on the level when one more Newton step would move it by less than this share of a cell.
ON_LEVEL = 1e-9
TOLD = 5  # places, in a warning

_Moved: TypeAlias = tuple[Floats, Flags]  # vertices (n, 2), and which of them arrived


@dataclass(frozen=True)
class LevelLinesStatus(Report):
    """How many vertices reached the level, how many kept their place, how many samples were undefined.

    `unresolved_corners` counts neighbours on different leaves without a corner between them: the
    lattice is too coarse there, and a line may jump over a gap thinner than a cell. `unseen` counts cells, of the size
    `finer`, where something may be thinner than they are, near each of `places`; what a lattice does not show is drawn
    on finer ones before. Only if `examined`: what is not the value of a
    shape is not, nor where intervals leave too many cells.
    """

    vertices: int
    kept: int
    undefined_samples: int
    closed: int
    open: int
    unresolved_corners: int = 0
    unseen: int = 0
    places: tuple[tuple[float, float], ...] = ()
    finer: float = 0.0
    examined: bool = True

    @property
    def remark(self) -> str:
        """Where something is thinner than the finest cells that were looked at, or that they were not."""
        if not self.examined:
            return "What is thinner than a cell was not looked for."
        if not self.places:
            return ""
        where = first_of([f"({across:.4g}, {up:.4g})" for across, up in self.places], TOLD)
        cells = f"{plural(self.unseen, 'cell')} of {self.finer:.2g}"
        return f"Unresolved in {cells}: lines may be missing or joined near {where}."

    def document(self) -> Document:
        """All that the status says; nothing of it is proved."""
        lines = f"{self.closed} closed and {self.open} open lines with {self.vertices} vertices on the level."
        troubles = {
            f"Vertices unresolved, kept where linear interpolation put them: {self.kept}.": self.kept,
            f"Corners unresolved, where a cell holds too much: {self.unresolved_corners}.": self.unresolved_corners,
            f"The field is undefined at {self.undefined_samples} samples.": self.undefined_samples,
            self.remark: self.unseen or not self.examined,
        }
        told = numerical(text for text, count in troubles.items() if count)
        return Document("level-lines", Sentence(lines, False), sentences=told, data=asdict(self))


@dataclass(frozen=True, repr=False)
class LevelLines(Sequence[Floats]):
    """A sequence of polylines, each (n, 2); a closed line repeats its first vertex.

    The region where the field exceeds the level, the inside of a shape at level 0, is **to the left** of every line as
    one walks along it, the first coordinate to the right and the second up: closed lines run counter-clockwise round
    material and clockwise round holes.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> lines = rsym.level_lines(rsym.Shape(x**2 - y**2 - 1, (x, y), bounds=((-2, 2), (-2, 2))), resolution=16)
    >>> len(lines), lines[0].shape[1]
    (2, 2)
    >>> print(lines.status)
    0 closed and 2 open lines with 48 vertices on the level.
    """

    lines: tuple[Floats, ...]
    level: float
    field: str
    status: LevelLinesStatus

    @overload
    def __getitem__(self, index: int) -> Floats: ...
    @overload
    def __getitem__(self, index: slice) -> Sequence[Floats]: ...
    def __getitem__(self, index: int | slice) -> Floats | Sequence[Floats]:
        return self.lines[index]

    def __len__(self) -> int:
        return len(self.lines)

    def __iter__(self) -> Iterator[Floats]:
        return iter(self.lines)

    @property
    def length(self) -> float:
        """The length of all lines together, of the polylines."""
        return float(sum(np.hypot(*np.diff(line, axis=0).T).sum() for line in self.lines))

    @property
    def area(self) -> float:
        """The area of the region that the lines surround, holes taken off: the sum of x dy - y dx over 2, of polygons.

        That of a region outside of its lines, all but a disc say, is the negative of what is left out; without any
        line it is 0. Raises RsymError where lines end, at the bounds as a rule.
        """
        self._require_closed("an area")
        return float(sum(map(_signed_area, self.lines)))

    def to_shapely(self) -> Any:
        """The region as a ``shapely.MultiPolygon``, valid, each polygon with its holes.

        Lines that cross themselves, beside a corner that the lattice does not resolve, are cut there.
        Needs the package shapely. Raises RsymError without it, where lines end, and for a region outside of its lines.

        Examples
        --------
        >>> import rsym
        >>> ring = rsym.disc(1.5) - rsym.disc(0.5)
        >>> lines = rsym.level_lines(ring, resolution=64, bounds=((-2, 2), (-2, 2)))
        >>> round(lines.area, 1), round(lines.length, 1)
        (6.3, 12.6)
        >>> [len(polygon.interiors) for polygon in lines.to_shapely().geoms]  # doctest: +SKIP
        [1]
        """
        self._require_closed("a region")
        shapely = optional_package("shapely", "to_shapely")

        def valid(region: Any) -> Any:
            return shapely.make_valid(region, method="structure", keep_collapsed=False)

        sizes = [_signed_area(line) for line in self.lines]
        order = np.argsort(np.abs(sizes), kind="stable").tolist()
        shells: list[tuple[float, Any, Any, list[Any]]] = [
            (sizes[k], valid(shapely.Polygon(self.lines[k])), self.lines[k], []) for k in order if sizes[k] > 0
        ]
        for k in order:
            if sizes[k] < 0:
                place = valid(shapely.Polygon(self.lines[k])).representative_point()
                around = (holes for size, shell, _, holes in shells if size > -sizes[k] and shell.contains(place))
                owner = next(around, None)
                if owner is None:
                    raise RsymError(
                        "the region lies outside of its lines, and no polygon holds it",
                        code="unbounded",
                        remedy="take the lines of its complement, ~shape",
                    )
                owner.append(self.lines[k])
        region = shapely.MultiPolygon([(line, holes) for _, _, line, holes in shells])
        if region.is_valid:
            return region
        parts = shapely.get_parts(valid(region))
        return shapely.MultiPolygon([part for part in parts if isinstance(part, shapely.Polygon)])

    def _require_closed(self, what: str) -> None:
        loose = sum(not (line[0] == line[-1]).all() for line in self.lines)
        if loose:
            raise RsymError(
                f"{what} needs closed lines, {loose} of {len(self)} lines end",
                code="open-lines",
                remedy="widen the bounds until they hold the region; length needs no inside",
            )

    def __repr__(self) -> str:
        return f"LevelLines({self.field} = {self.level:g}: {self.status})"

    def _repr_html_(self) -> str:
        words = escape(f"{self.field} = {self.level:g}: {self.status}")
        return f"<div>{line_picture(self.lines)}<br>{words}</div>"


def told(lines: LevelLines) -> LevelLines:
    """The same lines; a warning where something may be thinner than the finest cells, or than cells if none are."""
    if remark := lines.status.remark:
        warn(remark if lines.status.examined else f"{remark} Remedy: narrower bounds, which leave fewer cells.")
    return lines


def _signed_area(line: Floats) -> float:
    """The area of a closed polygon, positive where it runs counter-clockwise."""
    (u, v) = (line - line[0]).T
    return float(u[:-1] @ v[1:] - u[1:] @ v[:-1]) / 2


def turned_like(moved: _Moved, before: Floats) -> _Moved:
    """A line that was moved; a closed one smaller than a cell may have been turned over, and is turned back."""
    line, good = moved
    closed = (before[0] == before[-1]).all()
    return (line[::-1], good[::-1]) if closed and _signed_area(line) * _signed_area(before) < 0 else moved


def within(sampler: PlaneSampler, moved: Sequence[_Moved], level: float, bounds: Bounds) -> list[_Moved]:
    """Lines cut off at the bounds; their new ends slide along the border onto the level."""
    lines, ends = cropped([np.column_stack(one) for one in moved], bounds)
    if ends:
        places = np.array([lines[line][vertex, :2] for line, vertex, _ in ends])
        placed, good = move_onto_level(sampler, places, level, fixed=np.array([axis for _, _, axis in ends]))
        low, high = np.array(bounds, float).T
        good &= ((placed >= low) & (placed <= high)).all(axis=1)
        for (line, vertex, _), place, arrived in zip(ends, np.where(good[:, None], placed, places), good, strict=True):
            lines[line][vertex] = (*place, arrived)
    return [(line[:, :2], line[:, 2] == 1) for line in lines]


def move_onto_level(
    sampler: PlaneSampler, line: Floats, level: float, *, fixed: NDArray[np.intp] | None = None
) -> _Moved:
    """Newton along the gradient; a vertex that does not arrive within a cell keeps its place, and its flag is False.

    `fixed` names a coordinate of each vertex that must not change.
    """
    cell = min(sampler.lattice.spacing)
    points = line.copy()
    arrived = np.zeros(len(line), bool)
    with np.errstate(all="ignore"):
        for _ in range(NEWTON_STEPS):
            open_ = np.flatnonzero(~arrived)
            value, gradient = sampler.value_and_gradient(points[open_])
            if fixed is not None:
                gradient[np.arange(len(open_)), fixed[open_]] = 0
            squared = np.einsum("ij,ij->i", gradient, gradient)
            step = ((value - level) / squared)[:, None] * gradient
            length = np.hypot(*step.T)
            step *= np.minimum(1, cell / np.maximum(length, 1e-300))[:, None]
            points[open_] -= step
            arrived[open_] = length <= ON_LEVEL * cell
            if arrived.all():
                break
        good = arrived & (np.hypot(*(points - line).T) <= 1.5 * cell)
    return np.where(good[:, None], points, line), good


# A vertex this near to the chord between others, as a share of the size of all lines, is on it: rounding.
ON_CHORD = 1e-13


def sparse(lines: LevelLines) -> LevelLines:
    """The same lines without vertices on straight parts; a closed one begins at a vertex that stays.

    Examples
    --------
    >>> import rsym
    >>> square = np.array([[0.5, 0], [1, 0], [1, 0.7], [1, 1], [0, 1], [0, 0], [0.5, 0]])
    >>> status = LevelLinesStatus(7, 0, 0, 1, 0)
    >>> sparse(LevelLines((square,), 0.0, "value", status)).lines[0].tolist()
    [[1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.0, 0.0], [1.0, 0.0]]
    """
    slack = ON_CHORD * max((float(np.abs(line).max()) for line in lines if len(line)), default=0.0)
    kept = tuple(_without_straight(line, slack) for line in lines)
    return replace(lines, lines=kept, status=replace(lines.status, vertices=sum(map(len, kept))))


def _without_straight(line: Floats, slack: float) -> Floats:
    closed = len(line) > 3 and bool((line[0] == line[-1]).all())
    corners = ~_straight(line, slack)
    if closed:
        corners[0] = not _straight(np.concatenate([line[-2:-1], line[:2]]), slack)[1]
        first = int(np.argmax(corners))
        line, corners = (np.concatenate([rows[first:-1], rows[: first + 1]]) for rows in (line, corners))
    corners[[0, -1]] = True
    # A slow bend has no corner either: all of a part must lie on its chord.
    ends = np.flatnonzero(corners)
    part = np.repeat(np.arange(len(ends) - 1), np.diff(ends))
    start, along = line[ends[part]], np.diff(line[ends], axis=0)[part]
    away = line[:-1] - start
    with np.errstate(all="ignore"):
        off = np.abs(along[:, 0] * away[:, 1] - along[:, 1] * away[:, 0]) / np.hypot(*along.T)
    bent = np.zeros(len(ends), np.bool_)
    np.logical_or.at(bent, part, ~(off <= slack))
    return np.asarray(line[corners | np.append(bent[part], False)])


def _straight(line: Floats, slack: float) -> Flags:
    """Which vertices lie on the chord between their neighbours."""
    straight = np.zeros(len(line), np.bool_)
    if len(line) > 2:
        (a, b), (c, d) = (line[1:-1] - line[:-2]).T, (line[2:] - line[1:-1]).T
        with np.errstate(all="ignore"):
            off = np.abs(a * d - b * c) / np.hypot(a + c, b + d)
        straight[1:-1] = (off <= slack) & (a * c + b * d > 0)
    return straight


# Two neighbours whose normals differ by more, in radians, have a corner between them, or a bend of two cells.
TURN = 0.5


def turns(sampler: PlaneSampler, lines: Sequence[Floats]) -> int:
    """How many neighbours along lines have a corner of the field between them, which the chord cuts off."""
    every = np.concatenate([*lines, np.empty((0, 2))])
    turned = bends(sampler.value_and_gradient(every)[1])
    line = np.repeat(np.arange(len(lines)), [len(line) for line in lines])
    return int(np.count_nonzero(turned & (line[:-1] == line[1:])))


def bends(gradients: Floats) -> Flags:
    """Between which neighbours of gradients (n, 2) there is a corner."""
    (u, v) = gradients.T
    with np.errstate(invalid="ignore"):
        angle = np.abs(np.arctan2(u[:-1] * v[1:] - v[:-1] * u[1:], u[:-1] * u[1:] + v[:-1] * v[1:]))
    return np.asarray(angle > TURN)


# What is beyond the bounds by no more than this share of their size touches them.
TOUCHING = 1e-9


def cropped(lines: Iterable[Floats], bounds: Bounds) -> tuple[list[Floats], list[tuple[int, int, int]]]:
    """What of lines (n, 2 and more columns) lies within the bounds, and the ends that this made.

    New ends are put where chords cross the border, their other columns in proportion; each is named by its line,
    its vertex, and the coordinate that the border fixes. A line that only touches the bounds stays as it is.

    Examples
    --------
    >>> lines, ends = cropped([np.array([[-1.0, 0.0], [1.0, 0.0], [1.0, 4.0]])], ((0, 2), (-1, 1)))
    >>> lines[0].tolist(), ends
    ([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]], [(0, 0, 0), (0, 2, 1)])
    """
    low, high = np.array(bounds, float).T
    slack = TOUCHING * float((high - low).max())
    low, high = low - slack, high + slack
    found: list[Floats] = []
    ends: list[tuple[int, int, int]] = []
    for line in lines:
        outside = ((line[:, :2] < low) | (line[:, :2] > high)).any(axis=1)
        if not outside.any():
            found.append(line)
            continue
        if (line[0] == line[-1]).all():  # closed: begin outside, so that no piece goes round
            first = int(np.argmax(outside))
            line = np.concatenate([line[first:-1], line[: first + 1]])
        for piece, borders in _pieces(line, low, high):
            for vertex, axis in borders:
                piece[vertex, axis] = min(bounds[axis], key=lambda border: abs(border - piece[vertex, axis]))
                ends.append((len(found), vertex, axis))
            found.append(piece)
    return found, ends


def _pieces(line: Floats, low: Floats, high: Floats) -> Iterator[tuple[Floats, list[tuple[int, int]]]]:
    """The pieces of one line within a box, with the vertices on its border and the coordinate that is fixed there."""
    start, step = line[:-1], np.diff(line, axis=0)
    with np.errstate(divide="ignore", invalid="ignore"):
        places = np.stack([(end - start[:, :2]) / step[:, :2] for end in (low, high)])
    # Along an axis without a step a chord is within the box or not: infinite places of both signs, or of one.
    first, last = places.min(axis=0), places.max(axis=0)
    entry, exit = first.max(axis=1), last.min(axis=1)
    begin, end = np.maximum(entry, 0), np.minimum(exit, 1)
    inside = begin < end
    begins = np.flatnonzero(inside & ~(np.r_[False, inside[:-1]] & (entry <= 0)))
    stops = np.flatnonzero(inside & ~(np.r_[inside[1:], False] & (exit >= 1)))
    for i, j in zip(begins, stops, strict=True):
        head, tail = start[i] + begin[i] * step[i], start[j] + end[j] * step[j]
        piece = np.concatenate([head[None], line[i + 1 : j + 1], tail[None]])
        borders = [(0, int(first[i].argmax()))] if entry[i] > 0 else []
        yield piece, borders + ([(len(piece) - 1, int(last[j].argmin()))] if exit[j] < 1 else [])
