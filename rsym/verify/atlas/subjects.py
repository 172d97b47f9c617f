"""What an atlas is about: a boundary in the plane, that of a body of revolution, or that of any body.

Refuted for every value of letters is a shape with one joint that moves with them and jumps all the way. Krawczyk's
operator with the letters as intervals is, for each of their values, one with a value in place of each interval: where
its image of a box B lies inside B, the two equations of a joint have exactly one common zero in B for every value.
Tangents, curvatures and the turn of one arc into the other are enclosed over the box and all values at once, so that a
jump whose enclosure excludes zero is a jump for every value.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any, Generic, TypeVar

import sympy as sp

from rsym.bounds.balls import arb, ball, ctx, exact
from rsym.bounds.enclosures import Range, ranges_of
from rsym.model.constructions import section
from rsym.model.shape import Bounds, Shape
from rsym.reports.document import CERTIFIED, DEGENERATE, UNDECIDED
from rsym.sampling.windows import outer_bounds
from rsym.verify.answers.body_report import BodyReport
from rsym.verify.answers.report import Joint, SmoothnessReport, is_defect
from rsym.verify.answers.singular import SingularCurve
from rsym.verify.bodies import report_body, study_body
from rsym.verify.boxes.generators import generators
from rsym.verify.boxes.joints import BoundaryArc, Meeting, is_transversal, joint, meeting
from rsym.verify.boxes.krawczyk import Point, common_zero, image, inverse, narrowed_zero
from rsym.verify.boxes.local import PRECISION, Interval, Model
from rsym.verify.boxes.locus import reduce
from rsym.verify.cleaning import cleaned
from rsym.verify.plane import Question
from rsym.verify.revolution import find_meridian, meridian

# A box that holds its image is found by growing it to a little more than its image, as often as it is worth trying.
INFLATION, GROWTHS = 1.1, 10
NEAREST = 2.0**-20  # a box is no narrower than this, as a share of the extent: the point is known to fewer digits
TRIED = 3  # defects that are followed, the worst first
POINT_BUDGET = 4_000  # boxes for the verdict in the middle: the body of Fig. 11 takes 130
# A rectangle takes at most so many times the boxes of its middle: those of the body of Fig. 11 that are proved take a
# third to 5 times as many, and a budget that is exceeded costs no more than the cut that follows.
WIDER, MORE, MORE_IN_SPACE = 4, 200, 20_000
# Boxes in which two sheets may meet, of a body whose middle has no such curve: where there are more there is one for
# some of the values, which takes long to trace and certifies nothing.
FEW = 30
CUT = 3  # points of a curve at which a plane cuts it, evenly spaced
R = TypeVar("R", SmoothnessReport, BodyReport)


@dataclass(frozen=True)
class AnswerOverRanges:
    """What is proved for all values in ranges: CERTIFIED, DEGENERATE, which is without a boundary, or UNDECIDED.

    No curvature is larger in size than `bound`; `greatest` was found somewhere, NaN where none was sought.
    """

    verdict: str
    bound: float = math.inf
    greatest: float = math.nan


class AtlasSubject(ABC, Generic[R]):
    """A shape whose letters take single values and ranges; its `model` has those that range as axes."""

    def __init__(self, shape: Shape, values: Mapping[str, Range], *, body: bool = False) -> None:
        self.shape = shape
        self.bounds = outer_bounds(shape, None, values)
        self.model = Model(shape.replace(expression=cleaned(shape.expression)), values, body=body)

    @abstractmethod
    def at(self, values: Mapping[str, Any]) -> R:
        """The report at single values."""

    def followed(self, values: Mapping[str, Any], report: R) -> R | None:
        """What the report at other values holds of defects of this one: REFUTED, if there are any that are proved."""
        return None

    @abstractmethod
    def spread(self, ranges: Mapping[str, Range], report: R, sharpening: int) -> AnswerOverRanges:
        """What is proved for every value in ranges, at a cost that the report on one of them, or beside them, tells."""

    @abstractmethod
    def is_refuted(self, ranges: Mapping[str, Range], report: R) -> bool:
        """Whether the boundary is proved to be no curve or surface of continuous curvature for every value."""


class PlaneSubject(AtlasSubject[SmoothnessReport]):
    """A shape in the plane, or a body of revolution by its meridian."""

    def __init__(self, shape: Shape, values: Mapping[str, Range]) -> None:
        found = find_meridian(shape) if shape.dimension == 3 else None
        super().__init__(found[0] if found else shape, values, body=found is not None)
        self._question = Question(shape, letters=values)
        self._refuter = Refuter(self.model, self.bounds)

    def at(self, values: Mapping[str, Any]) -> SmoothnessReport:
        """The report at single values."""
        return self._report(values, POINT_BUDGET, 0)

    def followed(self, values: Mapping[str, Any], report: SmoothnessReport) -> SmoothnessReport | None:
        """By joints that are followed to these values, which takes a tenth of the time of a search."""
        at = ranges_of(self.shape.letters, values)
        defects = self._refuter.joints(at, report.defects, report.letters)
        letters = {name: (float(low), float(high)) for name, (low, high) in at.items()}
        return replace(report, defects=tuple(defects), letters=letters) if defects else None

    def spread(self, ranges: Mapping[str, Range], report: SmoothnessReport, sharpening: int) -> AnswerOverRanges:
        """By `verify_smoothness` with letters as intervals."""
        found = self._report(ranges, WIDER * report.cover.examined + MORE, sharpening)
        if found.verdict == CERTIFIED:
            return AnswerOverRanges(CERTIFIED, found.curvature_bound)
        boxes = (found.cover.certified, found.cover.joined, found.cover.undecided)
        return AnswerOverRanges(DEGENERATE if found.verdict == DEGENERATE and not any(map(len, boxes)) else UNDECIDED)

    def is_refuted(self, ranges: Mapping[str, Range], report: SmoothnessReport) -> bool:
        """By a joint that is followed over the ranges."""
        return self._refuter.joint(ranges, report.defects) is not None

    def _report(self, letters: Mapping[str, Any], budget: int, sharpening: int) -> SmoothnessReport:
        return self._question.report(letters, budget=budget, sharpening=sharpening)


class BodySubject(AtlasSubject[BodyReport]):
    """Any body in space.

    It is refuted by a plane that cuts it: where one joint of the section jumps for every value, and the plane touches
    neither sheet, the section of a surface of continuous curvature would have none.
    """

    def at(self, values: Mapping[str, Any]) -> BodyReport:
        """The report at single values, without bounds of the curvature."""
        points = {name: (Fraction(value), Fraction(value)) for name, value in values.items()}
        return report_body(study_body(self.shape, self.bounds, points), sharpened=False)

    def spread(self, ranges: Mapping[str, Range], report: BodyReport, sharpening: int) -> AnswerOverRanges:
        """By boxes in space with letters as intervals."""
        study = study_body(self.shape, self.bounds, ranges, budget=WIDER * report.cover.examined + MORE_IN_SPACE)
        met = sum(len(boxes) for groups in study.found.joined.values() for boxes in groups)
        if study.found.left or study.found.corners or (met > FEW and not report.curves):
            return AnswerOverRanges(UNDECIDED)
        found = report_body(study, sharpened=sharpening > 0)
        if found.verdict == CERTIFIED:
            return AnswerOverRanges(CERTIFIED, found.curvature_bound, max(map(abs, found.attained)))
        boxes = (found.cover.certified, found.cover.joined, found.cover.undecided)
        return AnswerOverRanges(DEGENERATE if found.verdict == DEGENERATE and not any(map(len, boxes)) else UNDECIDED)

    def is_refuted(self, ranges: Mapping[str, Range], report: BodyReport) -> bool:
        """By a section across the worst curve."""
        curves = [one for one in report.defects if isinstance(one, SingularCurve) and one.proved]
        return any(
            self._is_cut(ranges, curve, at)
            for curve in curves[:1]
            for at in sorted({(2 * k + 1) * len(curve.points) // (2 * CUT) for k in range(CUT)})
        )

    def _is_cut(self, ranges: Mapping[str, Range], curve: SingularCurve, number: int) -> bool:
        """Whether the section across a curve, near one of its points, has a joint that jumps for every value."""
        along = curve.points[min(number + 1, len(curve.points) - 1)] - curve.points[max(number - 1, 0)]
        point, axis = curve.points[number], int(abs(along).argmax())
        flat = section(self.shape, self.shape.coordinates[axis], sp.Rational(Fraction(point[axis])))
        near = [float(value) for k, value in enumerate(point) if k != axis]
        model = Model(flat.replace(expression=cleaned(flat.expression)), ranges)
        joint = Joint((near[0], near[1]), curve.radius, curve.kind, curve.continuity, proved=True)
        return Refuter(model, outer_bounds(flat, None, ranges)).joint(ranges, [joint]) is not None


def subject_of(shape: Shape, values: Mapping[str, Range]) -> AtlasSubject[Any]:
    """The subject of a shape; `values` tells which letters range at all."""
    general = shape.dimension == 3 and find_meridian(shape) is None
    return BodySubject(shape, values) if general else PlaneSubject(shape, values)


def refuted_throughout(
    shape: Shape,
    letters: Mapping[Any, Any],
    defects: Sequence[Joint],
    *,
    bounds: Any = None,
) -> Joint | None:
    """A defect that the boundary has for every value of the letters, proved; None if none is found.

    Parameters
    ----------
    shape : Shape
        In the plane, or a body of revolution.
    letters : mapping
        Numbers and pairs (low, high) by name.
    defects : sequence of Joint
        Defects at the middle of the ranges, as `verify_smoothness` finds them: where to look.
    bounds : sequence of pairs, optional
        The defect lies within these for every value.

    Returns
    -------
    Joint or None
        Its radius covers the motion, its errors all values.

    Source: Neumaier, Interval Methods for Systems of Equations (1990), section 5.1, on zeros that depend on parameters.

    Examples
    --------
    >>> import rsym
    >>> body = rsym.paper.skeleton_body()
    >>> defects = rsym.verify_smoothness(body, letters={"a2": 5.2}).defects
    >>> found = refuted_throughout(body, {"a2": (5.15, 5.25)}, defects)
    >>> found.kind, found.proved
    ('corner', True)
    >>> refuted_throughout(body, {"a2": (5.15, 5.35)}, defects) is None
    True
    """
    shape = shape if bounds is None else shape.replace(bounds=bounds)
    body = shape.dimension == 3
    plane = meridian(shape)[0] if body else shape
    ranges = ranges_of(shape.letters, letters)
    model = Model(plane.replace(expression=cleaned(plane.expression)), ranges, body=body)
    return Refuter(model, outer_bounds(plane, None, ranges)).joint(ranges, defects)


class Refuter:
    """Follows joints of a model in the plane over ranges of its letters; they must stay inside the bounds."""

    def __init__(self, model: Model, bounds: Bounds) -> None:
        self.model, self.bounds = model, bounds

    def joint(self, ranges: Mapping[str, Interval], defects: Sequence[Joint]) -> Joint | None:
        """A defect for every value in the ranges, from those at their middle."""
        return next(self._each(ranges, defects), None)

    def joints(
        self, ranges: Mapping[str, Interval], defects: Sequence[Joint], start: Mapping[str, tuple[float, float]]
    ) -> list[Joint]:
        """Those of defects at the letters `start` that are ones for every value in the ranges too."""
        return list(self._each(ranges, defects, [arb(sum(start[name]) / 2) for name in self.model.axes[2:]]))

    def _each(
        self, ranges: Mapping[str, Interval], defects: Sequence[Joint], start: Sequence[arb] | None = None
    ) -> Iterator[Joint]:
        for defect in defects[:TRIED]:
            with ctx.workprec(PRECISION):
                found = self._followed(ranges, defect, start) if defect.proved else None
            if found is not None:
                yield found

    def _followed(self, ranges: Mapping[str, Interval], defect: Joint, start: Sequence[arb] | None) -> Joint | None:
        """The joint in a box that grows until it holds its own image, at most so many times."""
        sides = [ball(exact(ranges[name][0]), exact(ranges[name][1])) for name in self.model.axes[2:]]
        extent = max(float(high) - float(low) for low, high in self.bounds)
        least = max(2 * defect.radius, NEAREST * extent)
        box = [arb(value, least) for value in defect.point]
        arcs = self._meeting([*box, *([side.mid() for side in sides] if start is None else start)])
        if arcs is None:
            return None
        for _ in range(GROWTHS):
            moved = self._image(arcs.arcs[0], box, sides)
            if moved is None:
                return None
            if all(old.contains_interior(new) for old, new in zip(box, moved, strict=True)):
                return self._proved([*box, *sides])
            box = [arb(side.mid(), max(least, INFLATION * float(arb(side.rad())))) for side in moved]
        return None

    def _meeting(self, sides: Sequence[arb]) -> Meeting | None:
        local = self.model.on(sides)
        locus = reduce(local, self.model.root)
        found = generators(local, locus.nodes[0]) if locus.kind == "leaf" else None
        return None if found is not None and found.analytic else meeting(local, locus, found)

    def _image(self, arc: BoundaryArc, box: Sequence[arb], sides: Sequence[arb]) -> Point | None:
        """The image of a box under Krawczyk's operator; None where there is none, or one wider than the bounds."""
        pair, middle = (arc.function, arc.side), [side.mid() for side in box]
        centre = self.model.on([*middle, *(side.mid() for side in sides)])
        here, whole = self.model.on([*middle, *sides]), self.model.on([*box, *sides])
        near = inverse([centre.gradient(number) for number in pair])
        values = [value for value in map(here.value, pair) if value is not None]
        if near is None or len(values) < len(pair):
            return None
        found = image(near, values, [whole.gradient(number) for number in pair], tuple(box))
        reach = max(high - low for low, high in self.bounds)
        return None if found is None or any(float(side.rad()) > reach for side in found) else found

    def _proved(self, sides: Sequence[arb]) -> Joint | None:
        """The joint in a box for all letters in their ranges, if it is one, inside the bounds, and a defect."""
        local, arcs = self.model.on(sides), self._meeting(sides)
        if arcs is None or not is_transversal(local, arcs):
            return None
        zero = common_zero(local, arcs.arcs[0].ends)
        if zero is None or not zero.exists:
            return None
        inside = all(low < value and value < high for value, (low, high) in zip(zero.box, self.bounds, strict=True))
        found = joint(local, arcs, narrowed_zero(local, arcs.arcs[0].ends, zero)) if inside else None
        return found if found is not None and found.proved and is_defect(found) else None
