"""Division: a rectangle of letters in parts, until what is undecided is a strip narrow enough."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction

import numpy as np

from rsym.arrays import Floats
from rsym.errors import warn
from rsym.reports.document import CERTIFIED, REFUTED, UNDECIDED
from rsym.sampling.progress import Effort, Progress, report
from rsym.verify.atlas.grid import KINDS, grid_of, run_through, too_wide
from rsym.verify.atlas.judging import Point, Rectangle, RectangleJudge, RectangleJudgement, middle_of

LABELS = {CERTIFIED: 1.0, REFUTED: -1.0}
# Off the middle, so that no line of rectangles follows a threshold that is as simple as the ranges, such as a = b.
CUTS = (15 / 32, 17 / 32)
HOPELESS = 4  # levels without a verdict even in the middle, from a rectangle to its part, after which it is left
NEIGHBOURS = 4  # values of either verdict from which the direction of a threshold is told
NEAREST = 1e-6  # those nearer than this share of the ranges count alike
STEEPEST = 8.0  # a side is cut at the latest when it is so many times the other, in shares of the ranges


@dataclass(frozen=True)
class _Rectangle:
    judgement: RectangleJudgement
    silent: int  # how many of its ancestors, without a gap, had no verdict in their middle


@dataclass
class _Known:
    """The verdicts at single values: 1 certified, -1 refuted; distances are shares of the region."""

    judge: RectangleJudge
    region: Rectangle
    labels: dict[Point, float] = field(default_factory=dict)

    def add(self, point: Point, verdict: str) -> None:
        """Note a verdict, if it is one of the two."""
        if verdict in LABELS:
            self.labels[point] = LABELS[verdict]

    def is_mixed(self, rectangle: Rectangle) -> bool:
        """Whether a rectangle holds values of both kinds."""
        return len({label for (u, v), label in self.labels.items() if _holds(rectangle, u, v)}) == len(LABELS)

    def is_certified_somewhere(self, rectangle: Rectangle) -> bool:
        """Whether a rectangle holds a value that is certified."""
        return any(label == LABELS[CERTIFIED] and _holds(rectangle, u, v) for (u, v), label in self.labels.items())

    def axis_to_cut(self, rectangle: Rectangle) -> int:
        """The letter along which a rectangle spans more of the change from refuted to certified."""
        slope = np.abs(self._slope(rectangle))
        steepness = np.maximum(slope, slope.max() / STEEPEST) if slope.max() > 0 else np.ones(2)
        return int(np.argmax(steepness * [high - low for low, high in rectangle] / self._widths))

    def is_refuted_at_a_corner(self, rectangle: Rectangle) -> bool:
        """Whether the corner that is most likely to be refuted is known to be, or a known defect is found there."""
        corner = self.worst_corner(rectangle)
        if corner is not None and corner not in self.labels and self.judge.is_refuted_at(corner):
            self.add(corner, REFUTED)
        return corner is not None and self.labels.get(corner) == LABELS[REFUTED]

    def add_corner(self, judgement: RectangleJudgement) -> None:
        """Note the verdict at the corner that tells most of where to cut; that of a certified rectangle is known."""
        corner = self.worst_corner(judgement.rectangle)
        if corner is not None and corner not in self.labels:
            self.add(corner, CERTIFIED if judgement.verdict == CERTIFIED else self.judge.at(corner))

    def worst_corner(self, rectangle: Rectangle) -> Point | None:
        """The corner that is most likely to be refuted, if one is more likely than the others."""
        slope = self._slope(rectangle)
        a, b = (ends[int(down < 0)] for ends, down in zip(rectangle, slope, strict=True))
        return (a, b) if slope.any() else None

    @property
    def _widths(self) -> Floats:
        return np.array([high - low for low, high in self.region])

    def _slope(self, rectangle: Rectangle) -> Floats:
        """How the label grows along each letter, by the plane nearest to the labels around; 0 if all are equal."""
        labels = np.array([*self.labels.values()])
        away = (np.array([*self.labels]).reshape(-1, 2) - middle_of(rectangle)) / self._widths
        distance = np.hypot(*away.T)
        nearest = [np.flatnonzero(labels == label) for label in LABELS.values()]
        nearest = [found[np.argsort(distance[found], kind="stable")[:NEIGHBOURS]] for found in nearest]
        if not all(map(len, nearest)):
            return np.zeros(2)
        chosen = np.concatenate(nearest)
        weights = 1 / np.maximum(distance[chosen], NEAREST)
        system = np.column_stack([np.ones(len(chosen)), away[chosen]]) * weights[:, None]
        slope: Floats = np.linalg.lstsq(system, labels[chosen] * weights, rcond=1e-6)[0][1:]
        return slope


def divide(
    judge: RectangleJudge,
    region: Rectangle,
    *,
    tolerance: float,
    budget: int,
    progress: Progress | None = None,
    effort: Effort | None = None,
) -> list[RectangleJudgement]:
    """Rectangles that tile the region, each with its verdict, breadth first.

    Undecided ones are cut until through each of their points a line along one of the letters crosses no more than the
    share `tolerance` of that letter's range that is undecided, until `budget` rectangles were judged or the time is
    over, or where even single values have no verdict.
    """
    known, effort = _Known(judge, region), effort or Effort()
    parts = [_judged(judge, region, 0, known)]
    count = 1
    while coarse := _coarse(parts, tolerance):
        following: list[_Rectangle] = []
        for number, part in enumerate(parts):
            if number not in coarse or count + 2 > budget or effort.is_over:
                following.append(part)
                continue
            for half in _halves(part.judgement.rectangle, known):
                following.append(_judged(judge, half, part.silent, known))
                count += 1
                report(progress, count, budget)
        if len(following) == len(parts):
            break
        parts = following
    report(progress, budget, budget)
    return accounted([part.judgement for part in parts], known.labels, region)


def accounted(
    found: Sequence[RectangleJudgement], labels: Mapping[Point, float], region: Rectangle
) -> list[RectangleJudgement]:
    """The rectangles, if they make up the region and contradict none of the single values judged on the way.

    Those that do contradict one are undecided, all of them where the rectangles do not make up the region: a verdict
    then is wrong or lost, which is a defect, and a warning says so.
    """
    wrong = {
        number
        for number, one in enumerate(found)
        for (u, v), label in labels.items()
        if one.verdict in LABELS and LABELS[one.verdict] != label and _holds(one.rectangle, u, v)
    }
    if sum(_area(one.rectangle) for one in found) != _area(region):
        wrong = set(range(len(found)))
    if wrong:
        warn(
            f"the account of the atlas does not balance in {len(wrong)} of {len(found)} rectangles, which are "
            "undecided now: this is a defect of rsym to report"
        )
    return [
        RectangleJudgement(one.rectangle, UNDECIDED, one.middle) if number in wrong else one
        for number, one in enumerate(found)
    ]


def _holds(rectangle: Rectangle, u: float, v: float) -> bool:
    (a, b), (c, d) = rectangle
    return a <= u <= b and c <= v <= d


def _area(rectangle: Rectangle) -> Fraction:
    """The exact area: the sides are floats."""
    (a, b), (c, d) = rectangle
    return (Fraction(b) - Fraction(a)) * (Fraction(d) - Fraction(c))


def _judged(judge: RectangleJudge, rectangle: Rectangle, silent: int, known: _Known) -> _Rectangle:
    if known.is_mixed(rectangle):
        return _Rectangle(RectangleJudgement(rectangle, UNDECIDED, UNDECIDED), 0)
    judgement = judge.judged(
        rectangle, lambda: known.is_refuted_at_a_corner(rectangle), lambda: known.is_certified_somewhere(rectangle)
    )
    if judgement.middle == CERTIFIED:
        known.add_corner(judgement)
    known.add(middle_of(rectangle), judgement.middle)
    return _Rectangle(judgement, silent + 1 if judgement.middle == UNDECIDED else 0)


def _halves(rectangle: Rectangle, known: _Known) -> list[Rectangle]:
    axis = known.axis_to_cut(rectangle)
    low, high = rectangle[axis]
    at = low + CUTS[axis] * (high - low)
    other = rectangle[1 - axis]
    return [((low, at), other), ((at, high), other)] if axis == 0 else [(other, (low, at)), (other, (at, high))]


def _coarse(parts: Sequence[_Rectangle], tolerance: float) -> set[int]:
    """Which of the rectangles to divide: the widest ones on the narrower of two runs that is too wide yet.

    Not the one in which the runs cross: where a strip turns it may be as small as it likes.
    """
    rectangles = np.array([part.judgement.rectangle for part in parts])
    hopeful = np.array([part.silent < HOPELESS and _is_splittable(part.judgement.rectangle) for part in parts])
    kinds = np.array([KINDS[part.judgement.verdict] for part in parts])
    grid = grid_of(rectangles)
    result: set[int] = set()
    for axis, wide in enumerate(too_wide(kinds[grid.owner], grid.shares, tolerance)):
        owner, width = np.moveaxis(grid.owner, axis, 0), np.ptp(rectangles[:, axis], axis=1)
        for row, column in np.argwhere(np.moveaxis(wide, axis, 0)):
            line = owner[:, column]
            run = [number for number in run_through(kinds[line] == 0, line, row) if hopeful[number]]
            result.update(number for number in run if width[number] == max(width[run]))
    return result


def _is_splittable(rectangle: Rectangle) -> bool:
    return all(high > math.nextafter(math.nextafter(low, math.inf), math.inf) for low, high in rectangle)
