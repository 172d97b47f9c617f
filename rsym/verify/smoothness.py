"""Is the curvature of a boundary continuous? Proved, refuted, or honestly left open."""

from __future__ import annotations

import heapq
import math
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rsym.bounds.balls import ctx
from rsym.bounds.enclosures import ranges_of
from rsym.bounds.intervals import IntervalFunction
from rsym.errors import RsymError
from rsym.model.blends.gates import without_rounded_levels
from rsym.model.requirements import require_count, require_positive, require_shape
from rsym.model.shape import Bounds, Shape
from rsym.reports.document import CERTIFIED, REFUTED, UNDECIDED
from rsym.sampling.extent import bounds_or_extent
from rsym.sampling.lattice import bounds_of
from rsym.sampling.progress import Effort, Progress
from rsym.verify.answers.account import complaint, distinct, missing
from rsym.verify.answers.body_report import BodyReport
from rsym.verify.answers.conclusions import Tally, badness, sentences, verdict_from
from rsym.verify.answers.report import UNKNOWN, Cover, Joint, SmoothnessReport, continuity_of, is_defect, level_of
from rsym.verify.bodies import BUDGET as BODY_BUDGET
from rsym.verify.bodies import Study, report_body, study_body
from rsym.verify.boxes.local import PRECISION, Box, Interval, Model
from rsym.verify.cells import within_cells
from rsym.verify.cleaning import cleaned, without_scale
from rsym.verify.cover.arcs import ArcInspector
from rsym.verify.cover.covering import Covering, cover, extent_of, halves
from rsym.verify.cover.inspection import Inspection
from rsym.verify.cover.pruning import bounds_of_omega, pruner
from rsym.verify.evidence import NOWHERE, has_boundary, has_boundary_for_every_value
from rsym.verify.fibres import report_over_ranges
from rsym.verify.holes import holes
from rsym.verify.points.plane import classify_joints
from rsym.verify.revolution import find_meridian, meridian

BUDGET = 20_000  # boxes: the body of Fig. 11 takes 130, a lemniscate with its node 240, the car 200 to 900
METHODS = ("auto", "meridian", "space")
SMALLEST = 2.0**-22  # of the extent: a suspect of this size is located, not divided
SHARES = 600, 200, 200  # of what is reported: boxes, points, curvatures
SHARPENING = 3_000  # boxes spent on the bound of the curvature: 5 to 12 % above the largest, a third on a hard one
# What a box may hold that is no curve with an inside and an outside.
NO_CURVE = frozenset({"double", "broken", "leap"})
BELOW_AXIS = 0.02  # the share of the radius on the far side of the axis of a body


def verify_smoothness(
    shape: Shape,
    *,
    bounds: Any = None,
    letters: Mapping[Any, Any] | None = None,
    method: str = "auto",
    smallest: float = SMALLEST,
    budget: int | None = None,
    timeout: float | None = None,
    progress: Progress | None = None,
) -> SmoothnessReport | BodyReport:
    """Prove or refute that the boundary omega = 0 is a curve or a surface of continuous curvature (G2).

    The bounds are subdivided. A box is discarded where omega has no zero; it is certified where every generator of
    non-smoothness that is alive (the zero of a root, |.|, a tie, a denominator) and one component of grad omega
    exclude zero, so that the boundary there is a regular analytic arc; where exactly two analytic arcs meet, the
    point is enclosed by Krawczyk's operator and the jumps of tangent and curvature by evaluation in balls. What is
    left is classified numerically and called so.

    Parameters
    ----------
    shape : Shape
        In the plane or in space.
    bounds : sequence of pairs, optional
        The statement is about the boundary within these; by default the bounds of the shape.
    letters : mapping, optional
        Values by name, each taken at its exact value. A pair (low, high) is a range: CERTIFIED then holds for every
        value in it, ends included, REFUTED and DEGENERATE for at least one. Of a body in space a statement names that
        value, and the curves and points are those at it.
    method : {"auto", "meridian", "space"}
        How a body is judged. "meridian": a body of revolution by its meridian; points of the report are (axis, radius).
        "space": any body, by boxes in space. "auto": by the meridian where the equation shows that there is one.
    smallest : float
        Boxes are divided down to this share of the extent.
    budget : int, optional
        The greatest number of boxes to examine.
    timeout : float, optional
        Seconds after which the search ends, a little later where a step is long: what is not settled by then counts as
        undecided, a statement says so, and the report holds what is proved. That much depends on the machine.
    progress : callable, optional
        ``progress(done, total)``, now and then; an answer of False cancels. One with a method ``describe(stage,
        undecided)`` is told before each call what is at work and which share of the boundary is undecided so far.

    Returns
    -------
    SmoothnessReport or BodyReport
        ``.verdict`` is "CERTIFIED", "REFUTED", "DEGENERATE" or "UNDECIDED"; the second for a body judged in space: its
        defects are curves and points, and ``.curvatures`` encloses both principal curvatures.

    Raises
    ------
    RsymError
        For an unknown letter or method, a size or budget that is not positive, without bounds in the plane, or by the
        meridian where there is none.

    Source: the criterion of curvature continuity; interval methods after Moore and Krawczyk.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> box = ((-2, 2), (-2, 2))
    >>> report = rsym.verify_smoothness(rsym.Shape(1 - x**2 - y**2, (x, y), bounds=box))
    >>> report.verdict, report.continuity, 1 <= report.curvature_bound < 1.1
    ('CERTIFIED', 'analytic', True)
    >>> report = rsym.verify_smoothness(rsym.Shape(rsym.conjunction(x, y), (x, y), bounds=box))
    >>> report.verdict, report.continuity, round(report.defects[0].tangent_jump, 9)
    ('REFUTED', 'G0', 90.0)
    """
    require_positive("smallest", smallest, f"for example {SMALLEST}")
    if budget is not None:
        require_count("budget", budget, f"leave it out, or for example {BUDGET}")
    effort = Effort(progress, timeout)
    if _in_space(shape, method):
        values = ranges_of(shape.letters, letters)
        if any(low != high for low, high in values.values()):
            box = _bounds_in_space(shape, bounds, values)
            return report_over_ranges(shape, box, values, effort, smallest=smallest, budget=budget or BODY_BUDGET)
        return report_body(studied_in_space(shape, bounds, letters, smallest, budget, effort))
    return _report(Question(shape, bounds).study(letters, smallest, budget or BUDGET, effort))


def _in_space(shape: Any, method: str) -> bool:
    """Whether a shape is to be judged by boxes in space."""
    require_shape(shape)
    if method not in METHODS:
        raise RsymError(f"no method {method!r}", code="unknown-method", remedy=f"choose from {', '.join(METHODS)}")
    if shape.dimension == 2:
        if method == "auto":
            return False
        raise RsymError(
            f"method {method!r} is for bodies, this shape is plane", code="dimension", remedy="leave out the method"
        )
    return method == "space" or (method == "auto" and find_meridian(shape) is None)


def studied_in_space(
    shape: Shape,
    bounds: Any = None,
    letters: Mapping[Any, Any] | None = None,
    smallest: float = SMALLEST,
    budget: int | None = None,
    effort: Effort | None = None,
) -> Study:
    """What boxes in space say of a body; `rsym.verify.bodies.report_body` makes a report of it."""
    values = ranges_of(shape.letters, letters)
    box = _bounds_in_space(shape, bounds, values)
    return study_body(shape, box, values, smallest=smallest, budget=budget or BODY_BUDGET, effort=effort)


def _bounds_in_space(shape: Shape, bounds: Any, values: Mapping[str, Interval]) -> Bounds:
    return bounds_or_extent(shape, bounds, {name: float((low + high) / 2) for name, (low, high) in values.items()})


def verdict_of(
    shape: Shape, *, bounds: Any, letters: Mapping[Any, Any] | None, budget: int, effort: Effort | None = None
) -> str:
    """The verdict alone, without a sharp bound of the curvature."""
    return quick_report(shape, bounds=bounds, letters=letters, budget=budget, effort=effort).verdict


def quick_report(
    shape: Shape,
    *,
    bounds: Any,
    letters: Mapping[Any, Any] | None,
    budget: int,
    sharpening: int = 0,
    effort: Effort | None = None,
) -> SmoothnessReport | BodyReport:
    """The report with a bound of the curvature on which only so many boxes are spent, in the plane."""
    if _in_space(shape, "auto"):
        study = studied_in_space(shape, bounds, letters, SMALLEST, budget * BODY_BUDGET // BUDGET, effort)
        return report_body(study, sharpened=sharpening > 0)
    return Question(shape, bounds).report(letters, budget=budget, sharpening=sharpening, effort=effort)


@dataclass(frozen=True)
class _Study:
    """A model and what was found on its boxes."""

    model: Model
    region: Box
    found: Covering
    values: Mapping[str, Interval]
    effort: Effort


class Question:
    """Is the boundary smooth, of a shape in the plane or of a meridian? Asked for many letters, it is prepared once."""

    def __init__(self, shape: Shape, bounds: Any = None) -> None:
        self._letters, self._body = shape.letters, shape.dimension == 3
        plane, axis = meridian(shape) if self._body else (shape, 0)
        box = bounds_of(shape, bounds)
        self._within: Box = _half_plane(box, axis) if self._body else tuple((float(a), float(b)) for a, b in box)
        expression = within_cells(cleaned(without_rounded_levels(plane.expression)), plane.coordinates, self._within)
        self._plane = plane.replace(expression=without_scale(expression))
        self._over_boxes: dict[tuple[str, ...], IntervalFunction] = {}
        self._model: Model | None = None

    def study(self, letters: Mapping[Any, Any] | None, smallest: float, budget: int, effort: Effort) -> _Study:
        """The boxes of the boundary for some letters."""
        values = ranges_of(self._letters, letters)
        self._model = model = Model(self._plane, values, body=self._body, bounds=self._within, like=self._model)
        region = self._within + tuple(_around(*values[name]) for name in model.axes[2:])
        if model.axes not in self._over_boxes:
            self._over_boxes[model.axes] = bounds_of_omega(self._plane, model.axes, values)
        prune = pruner(self._over_boxes[model.axes], model.axes, values)
        effort.begin("boxes", SHARES[0])
        found = cover(model, region, smallest=smallest * extent_of(region), budget=budget, prune=prune, effort=effort)
        return _Study(model, region, found, values, effort)

    def report(
        self, letters: Mapping[Any, Any] | None, *, budget: int, sharpening: int = 0, effort: Effort | None = None
    ) -> SmoothnessReport:
        """The report with a bound of the curvature on which only so many boxes are spent."""
        return _report(self.study(letters, SMALLEST, budget, effort or Effort()), sharpening=sharpening)


def _around(low: Fraction, high: Fraction) -> tuple[float, float]:
    """The narrowest interval of floats known to hold the exact one."""
    return math.nextafter(float(low), -math.inf), math.nextafter(float(high), math.inf)


def _half_plane(box: Any, axis: int) -> Box:
    """What a box in space meets of the meridian, with a little of its mirror image where it holds the axis."""
    along, *across = [tuple(map(float, box[k])) for k in (axis, *(k for k in range(3) if k != axis))]
    far = math.hypot(*(max(-low, high) for low, high in across))
    near = math.hypot(*(max(low, -high, 0.0) for low, high in across))
    far, near = math.nextafter(far, math.inf), math.nextafter(near, 0.0)
    return ((along[0], along[1]), (near or -BELOW_AXIS * far, far))


def _report(study: _Study, *, sharpening: int = SHARPENING) -> SmoothnessReport:
    """What follows from the findings, if all of them are in it."""
    study.effort.begin("points", SHARES[1])
    left = [(box, finding.locus) for box, finding in study.found.left]
    suspects = classify_joints(study.model, left, extent_of(study.region), study.effort)
    draft = _drafted(study, suspects, sharpening)
    wrong = _unaccounted(study, suspects, draft)
    if not wrong:
        return draft
    return replace(draft, verdict=UNDECIDED, continuity=UNKNOWN, statements=(*draft.statements, complaint(wrong)))


def _found(study: _Study) -> list[Joint]:
    """The joints of all boxes."""
    return [finding.place for _, finding in study.found.settled if isinstance(finding.place, Joint)]


def _located(study: _Study) -> list[Joint]:
    """The joints of all boxes; of a body those at negative radii are the images of others, which have their boxes."""
    return [joint for joint in _found(study) if not study.model.body or joint.point[1] >= -joint.radius]


def _unaccounted(study: _Study, suspects: Sequence[Joint], draft: SmoothnessReport) -> list[str]:
    """What the boxes hold and the report does not list."""
    found = _found(study)
    said = [*draft.defects, *draft.joints]
    if study.model.body:  # the meridian is even in the radius: the image of a joint is one too
        away = [joint for joint in found if joint.point[1] >= 0 or is_defect(joint) or not joint.proved]
        found = [replace(joint, point=(joint.point[0], abs(joint.point[1]))) for joint in away]
        said += [replace(joint, point=(joint.point[0], -joint.point[1])) for joint in said]
    listed = sum(map(len, (draft.cover.certified, draft.cover.joined, draft.cover.undecided)))
    boxes = len(study.found.settled) + len(study.found.left) - listed
    return missing([*found, *suspects], said, study.found.balance, boxes=boxes)


def _drafted(study: _Study, suspects: Sequence[Joint], sharpening: int) -> SmoothnessReport:
    model, region, found, values = study.model, study.region, study.found, study.values
    joints = distinct(_located(study), badness)
    everything = [*joints, *suspects]
    exists = has_boundary(model, found, joints, extent_of(region))
    order = min((f.order for _, f in found.settled if f.kind == "regular"), default=math.inf)
    kinds = Counter(finding.kind for _, finding in found.settled)
    tally = Tally({**kinds, "open": len(found.left)}, order, exists)
    verdict = verdict_from(tally, everything)
    everywhere = verdict != CERTIFIED or len(region) == 2 or has_boundary_for_every_value(model, found, region[2:])
    verdict = verdict if everywhere else UNDECIDED
    counted = [joint for joint in everything if joint.proved or verdict != REFUTED]
    bound, effort = math.inf, study.effort
    effort.begin("curvatures", SHARES[2])
    if exists and not found.left and not any(f.kind in NO_CURVE for _, f in found.settled):
        bound = sharpened_bound(model, found.settled, region, sharpening, effort)
    effort.finish()
    defects = [joint for joint in everything if is_defect(joint)]
    gaps = holes(model, [box for box, _ in found.left])
    return SmoothnessReport(
        verdict=verdict,
        continuity=continuity_of(verdict, map(level_of, counted), order),
        defects=tuple(sorted(defects, key=badness)),
        joints=tuple(joint for joint in everything if joint not in defects),
        curvature_bound=bound,
        cover=_cover(region, found),
        letters={name: (float(low), float(high)) for name, (low, high) in values.items()},
        statements=(*sentences(tally, 2), *gaps, *([] if everywhere else [NOWHERE]), *effort.statements),
        body=model.body,
    )


def _cover(region: Box, found: Covering) -> Cover:
    settled = [(box, finding.kind) for box, finding in found.settled]
    return Cover(
        bounds=region[:2],
        certified=_boxes([box for box, kind in settled if kind == "regular"]),
        joined=_boxes([box for box, kind in settled if kind == "joined"]),
        undecided=_boxes([box for box, _ in found.left] + [box for box, kind in settled if kind in NO_CURVE]),
        examined=found.examined,
    )


def _boxes(boxes: Sequence[Box]) -> NDArray[np.float64]:
    return np.array([box[:2] for box in boxes], dtype=np.float64).reshape(-1, 2, 2)


# A sharper bound of the curvature: the boxes with the largest bounds are divided until theirs is tight.
TIGHT = 0.05  # the share of the largest bound that may be due to its enclosure


def sharpened_bound(
    model: Model, settled: Sequence[tuple[Box, Inspection]], bounds: Box, budget: int, effort: Effort | None = None
) -> float:
    """The largest curvature on the settled boxes, proved, from at most `budget` further boxes."""
    inspector, effort, allowed = ArcInspector(extent_of(bounds)), effort or Effort(), budget
    heap = [(-f.curvature, n, box, f.slack) for n, (box, f) in enumerate(settled) if f.kind in {"regular", "joined"}]
    heapq.heapify(heap)
    count = len(settled)
    with ctx.workprec(PRECISION):
        while heap and heap[0][3] > TIGHT and budget > 0 and not effort.is_over:
            effort.reach(1 - budget / allowed)
            bound, _, box, _ = heapq.heappop(heap)
            for half in halves(model, box):
                finding = inspector.inspect(model.over(half))
                budget, count = budget - 1, count + 1
                if finding.kind == "open":
                    heapq.heappush(heap, (bound, count, half, 0.0))
                elif finding.kind != "empty":
                    heapq.heappush(heap, (max(bound, -finding.curvature), count, half, finding.slack))
    return -heap[0][0] if heap else 0.0
