"""The verdict of one rectangle of letters: for every value in it, or none."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, TypeAlias

import numpy as np

from rsym.backends.kernel import compile
from rsym.bounds.balls import arb, ball, ctx, exact
from rsym.bounds.enclosures import Range, ranges_of
from rsym.model.shape import Shape
from rsym.reports.document import CERTIFIED, DEGENERATE, REFUTED, UNDECIDED
from rsym.verify.atlas.subjects import AnswerOverRanges, AtlasSubject, subject_of
from rsym.verify.boxes.local import PRECISION

Point: TypeAlias = tuple[float, float]
Rectangle: TypeAlias = tuple[Point, Point]

SAMPLES = 65  # along each side of the bounds, for a point well inside and one well outside


def middle_of(rectangle: Rectangle) -> Point:
    """The middle, to the last place of a float."""
    (a, b), (c, d) = rectangle
    return a + (b - a) / 2, c + (d - c) / 2


@dataclass(frozen=True)
class RectangleJudgement:
    """What is proved of every value in a rectangle, and the verdict in its middle.

    `verdict` is CERTIFIED, REFUTED, DEGENERATE (no boundary within the bounds) or UNDECIDED; no curvature on the
    boundary is larger in size than `bound`; `greatest` is what was found of it, NaN where it was not sought.
    """

    rectangle: Rectangle
    verdict: str
    middle: str
    bound: float = math.inf
    greatest: float = math.nan


class RectangleJudge:
    """Judges rectangles of two letters of one shape.

    Examples
    --------
    >>> import rsym
    >>> judge = RectangleJudge(rsym.paper.skeleton_body(), ("a2", "p1"), ((5, 6), (20, 80)))
    >>> [judge.judged(((a, a + 0.05), (40, 41))).verdict for a in (5.2, 5.28, 5.4)]
    ['REFUTED', 'UNDECIDED', 'CERTIFIED']
    """

    def __init__(
        self,
        shape: Shape,
        names: tuple[str, str],
        region: Rectangle,
        *,
        bounds: Any = None,
        letters: Mapping[Any, Any] | None = None,
        sharpening: int = 0,
    ) -> None:
        self.shape = shape if bounds is None else shape.replace(bounds=bounds)
        self.names, self.sharpening = names, sharpening
        self.letters = {str(name): value for name, value in (letters or {}).items()}
        self.subject = subject_of(self.shape, self._ranges(region))
        self.samples = _Samples(self.subject)
        self._widths = [high - low for low, high in region]
        self._refuted: dict[Point, Any] = {}  # reports by place
        self._certified: Any = None  # the last report that is

    def at(self, point: Point) -> str:
        """The verdict at one pair of values."""
        verdict: str = (self._followed(*self._values(point)) or self._searched(*self._values(point))).verdict
        return verdict

    def is_refuted_at(self, point: Point) -> bool:
        """Whether a defect that is known elsewhere is found at one pair of values; nothing is searched there."""
        return self._followed(*self._values(point)) is not None

    def _values(self, point: Point) -> tuple[Point, dict[str, Fraction]]:
        return point, _middles(self._ranges(((point[0],) * 2, (point[1],) * 2)))

    def _searched(self, point: Point, values: Mapping[str, Fraction]) -> Any:
        report = self.subject.at(values)
        if report.verdict == REFUTED:
            self._refuted[point] = report
        elif report.verdict == CERTIFIED:
            self._certified = report
        return report

    def _followed(self, point: Point, values: Mapping[str, Fraction]) -> Any:
        """The report that a defect at the nearest refuted values makes here; None where it is not found any more."""
        (u, v), (width, height) = point, self._widths
        near = min(self._refuted, key=lambda at: math.hypot((at[0] - u) / width, (at[1] - v) / height), default=None)
        report = None if near is None else self.subject.followed(values, self._refuted[near])
        if report is not None:
            self._refuted[point] = report
        return report

    def judged(
        self,
        rectangle: Rectangle,
        suspect: Callable[[], bool] = lambda: False,
        certified: Callable[[], bool] = lambda: False,
    ) -> RectangleJudgement:
        """The verdict for every value in a rectangle, and that of its middle, which need not be searched if it spreads.

        `suspect` is asked before the costly proof that a rectangle is smooth throughout, and `certified`, whether one
        of its values is, before the proof that none is; where they answer True that is not tried.
        """
        ranges = self._ranges(rectangle)
        middle = _middles(ranges)
        report, tried = self._followed(middle_of(rectangle), middle), False
        if report is not None:
            if certified():
                return RectangleJudgement(rectangle, UNDECIDED, REFUTED)
            if self.subject.is_refuted(ranges, report):
                return RectangleJudgement(rectangle, REFUTED, REFUTED)
        elif self._certified is not None and (tried := not suspect()):
            # No known defect is here: what was certified last tells how much the proof may cost.
            found = self._spread(ranges, self._certified)
            if found.verdict != UNDECIDED:
                return RectangleJudgement(rectangle, found.verdict, found.verdict, found.bound, found.greatest)
        report = self._searched(middle_of(rectangle), middle)
        found = AnswerOverRanges(UNDECIDED)
        if report.verdict == REFUTED and not certified() and self.subject.is_refuted(ranges, report):
            found = AnswerOverRanges(REFUTED)
        elif report.verdict in {CERTIFIED, DEGENERATE} and not (tried or suspect()):
            found = self._spread(ranges, report)
        return RectangleJudgement(rectangle, found.verdict, report.verdict, found.bound, found.greatest)

    def _spread(self, ranges: Mapping[str, Range], report: Any) -> AnswerOverRanges:
        found = self.subject.spread(ranges, report, self.sharpening)
        lost = found.verdict == CERTIFIED and not self.samples.has_boundary(_middles(ranges), ranges)
        return AnswerOverRanges(UNDECIDED) if lost else found

    def _ranges(self, rectangle: Rectangle) -> dict[str, Range]:
        return ranges_of(self.shape.letters, {**self.letters, **dict(zip(self.names, rectangle, strict=True))})


def _middles(ranges: Mapping[str, Range]) -> dict[str, Fraction]:
    return {name: (low + high) / 2 for name, (low, high) in ranges.items()}


class _Samples:
    """Proves that there is a boundary for every value of letters: one point always inside, another always outside."""

    def __init__(self, subject: AtlasSubject[Any]) -> None:
        self.model = subject.model
        self.grid = np.meshgrid(*(np.linspace(low, high, SAMPLES) for low, high in subject.bounds), indexing="ij")
        self.kernel = compile(subject.shape, threads=1)

    def has_boundary(self, middle: Mapping[str, Fraction], ranges: Mapping[str, Range]) -> bool:
        """Whether omega has both signs for every value in the ranges; the points are sought at their middle."""
        values = self.kernel(*self.grid, letters={name: float(value) for name, value in middle.items()})["value"]
        if np.isnan(values).all():
            return False
        with ctx.workprec(PRECISION):
            names = self.model.axes[self.model.dimension :]
            sides = [ball(exact(ranges[name][0]), exact(ranges[name][1])) for name in names]
            places = [np.unravel_index(find(values), values.shape) for find in (np.nanargmin, np.nanargmax)]
            points = [[arb(float(axis[place])) for axis in self.grid] for place in places]
            return [self.model.on([*point, *sides]).sign(self.model.root) for point in points] == [-1, 1]
