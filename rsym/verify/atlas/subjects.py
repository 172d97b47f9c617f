"""What an atlas is about: a boundary in the plane, that of a body of revolution, or that of any body."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, Generic, TypeVar

import sympy as sp

from rsym.bounds.enclosures import Range
from rsym.model.constructions import section
from rsym.model.shape import Shape
from rsym.reports.document import CERTIFIED, DEGENERATE, UNDECIDED
from rsym.sampling.lattice import bounds_of
from rsym.verify.answers.body_report import BodyReport
from rsym.verify.answers.report import Joint, SmoothnessReport
from rsym.verify.answers.singular import SingularCurve
from rsym.verify.atlas.refutation import Refuter
from rsym.verify.bodies import report_body, study_body
from rsym.verify.boxes.local import Model
from rsym.verify.cleaning import cleaned
from rsym.verify.revolution import find_meridian
from rsym.verify.smoothness import Question

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
        self.bounds = bounds_of(shape, None)
        self.model = Model(shape.replace(expression=cleaned(shape.expression)), values, body=body)

    @abstractmethod
    def at(self, values: Mapping[str, Any]) -> R:
        """The report at single values."""

    @abstractmethod
    def spread(self, ranges: Mapping[str, Range], report: R, sharpening: int) -> AnswerOverRanges:
        """What is proved for every value in ranges, from the report on the middle."""

    @abstractmethod
    def is_refuted(self, ranges: Mapping[str, Range], report: R) -> bool:
        """Whether the boundary is proved to be no curve or surface of continuous curvature for every value."""


class PlaneSubject(AtlasSubject[SmoothnessReport]):
    """A shape in the plane, or a body of revolution by its meridian."""

    def __init__(self, shape: Shape, values: Mapping[str, Range]) -> None:
        found = find_meridian(shape) if shape.dimension == 3 else None
        super().__init__(found[0] if found else shape, values, body=found is not None)
        self._question = Question(shape)
        self._refuter = Refuter(self.model, self.bounds)

    def at(self, values: Mapping[str, Any]) -> SmoothnessReport:
        """The report at single values."""
        return self._report(values, POINT_BUDGET, 0)

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
        return any(self._is_cut(ranges, curve, at) for curve in curves[:1] for at in _evenly(len(curve.points)))

    def _is_cut(self, ranges: Mapping[str, Range], curve: SingularCurve, number: int) -> bool:
        """Whether the section across a curve, near one of its points, has a joint that jumps for every value."""
        along = curve.points[min(number + 1, len(curve.points) - 1)] - curve.points[max(number - 1, 0)]
        point, axis = curve.points[number], int(abs(along).argmax())
        flat = section(self.shape, self.shape.coordinates[axis], sp.Rational(Fraction(point[axis])))
        near = [float(value) for k, value in enumerate(point) if k != axis]
        model = Model(flat.replace(expression=cleaned(flat.expression)), ranges)
        joint = Joint((near[0], near[1]), curve.radius, curve.kind, curve.continuity, proved=True)
        return Refuter(model, bounds_of(flat, None)).joint(ranges, [joint]) is not None


def _evenly(count: int) -> list[int]:
    return sorted({(2 * k + 1) * count // (2 * CUT) for k in range(CUT)})


def subject_of(shape: Shape, values: Mapping[str, Range]) -> AtlasSubject[Any]:
    """The subject of a shape; `values` tells which letters range at all."""
    general = shape.dimension == 3 and find_meridian(shape) is None
    return BodySubject(shape, values) if general else PlaneSubject(shape, values)
