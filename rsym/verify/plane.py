"""The verdict on a curve in the plane, or on the meridian of a body: boxes and points put together."""

from __future__ import annotations

import heapq
import math
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import islice, product
from typing import Any

import numpy as np

from rsym.arrays import Floats
from rsym.bounds.balls import arb, ctx
from rsym.bounds.enclosures import ranges_of
from rsym.bounds.intervals import IntervalFunction
from rsym.model.blends.gates import without_rounded_levels
from rsym.model.shape import Shape
from rsym.reports.document import CERTIFIED
from rsym.sampling.progress import Effort
from rsym.sampling.windows import outer_bounds
from rsym.verify.answers.account import audited, distinct, missing
from rsym.verify.answers.conclusions import Tally, badness, conclude, verdict_from
from rsym.verify.answers.report import Cover, Joint, SmoothnessReport, is_defect
from rsym.verify.boxes.holes import holes
from rsym.verify.boxes.lacking import lacking
from rsym.verify.boxes.local import PRECISION, Box, Interval, Model, side
from rsym.verify.cells import within_cells
from rsym.verify.cleaning import cleaned, without_scale
from rsym.verify.cover.arcs import ArcInspector
from rsym.verify.cover.covering import Covering, bounds_of_omega, cover, extent_of, halves, pruner, settled_finely
from rsym.verify.cover.inspection import Inspection
from rsym.verify.points.clusters import Cluster
from rsym.verify.points.plane import classify_joints
from rsym.verify.revolution import meridian

BUDGET = 20_000  # boxes: the body of Fig. 11 takes 130, a lemniscate with its node 240, the car 200 to 900
SMALLEST = 2.0**-22  # of the extent: a suspect of this size is located, not divided
SHARES = 600, 200, 200  # of what is reported: boxes, points, curvatures
SHARPENING = 3_000  # boxes spent on the bound of the curvature: 5 to 12 % above the largest, a third on a hard one
TIGHT = 0.05  # the share of the largest bound that may be due to its enclosure
PARTS, LOOKED_AT = 256, 64  # of the ranges of letters, and boxes over each, in search of a boundary for all of them
DIVIDED, MOST_DIVIDED = 8, 500  # times that boxes are divided in search of a point of the boundary, and how many
# What a box may hold that is no curve with an inside and an outside.
NO_CURVE = frozenset({"double", "broken", "leap"})
BELOW_AXIS = 0.02  # the share of the radius on the far side of the axis of a body


@dataclass(frozen=True)
class CurveStudy:
    """A model and what was found on its boxes."""

    model: Model
    region: Box
    found: Covering
    values: Mapping[str, Interval]
    effort: Effort


class Question:
    """Is the boundary smooth, of a shape in the plane or of a meridian? Asked for many letters, it is prepared once.

    Where no window is stated, the one is taken that fits at the letters that are given here.
    """

    def __init__(self, shape: Shape, bounds: Any = None, letters: Mapping[Any, Any] | None = None) -> None:
        self._letters, self._body = shape.letters, shape.dimension == 3
        plane, axis = meridian(shape) if self._body else (shape, 0)
        box = outer_bounds(shape, bounds, ranges_of(shape.letters, letters))
        self._within: Box = _half_plane(box, axis) if self._body else tuple((float(a), float(b)) for a, b in box)
        expression = within_cells(cleaned(without_rounded_levels(plane.expression)), plane.coordinates, self._within)
        self._plane = plane.replace(expression=without_scale(expression))
        self._over_boxes: dict[tuple[str, ...], IntervalFunction] = {}
        self._model: Model | None = None

    def study(self, letters: Mapping[Any, Any] | None, smallest: float, budget: int, effort: Effort) -> CurveStudy:
        """The boxes of the boundary for some letters."""
        values = ranges_of(self._letters, letters)
        self._model = model = Model(self._plane, values, body=self._body, bounds=self._within, like=self._model)
        region = self._within + tuple(_around(*values[name]) for name in model.axes[2:])
        if model.axes not in self._over_boxes:
            self._over_boxes[model.axes] = bounds_of_omega(self._plane, model.axes, values)
        prune = pruner(self._over_boxes[model.axes], model.axes, values)
        effort.begin("boxes", SHARES[0])
        found = cover(model, region, smallest=smallest * extent_of(region), budget=budget, prune=prune, effort=effort)
        return CurveStudy(model, region, found, values, effort)

    def report(
        self, letters: Mapping[Any, Any] | None, *, budget: int, sharpening: int = 0, effort: Effort | None = None
    ) -> SmoothnessReport:
        """The report with a bound of the curvature on which only so many boxes are spent."""
        return report_curve(self.study(letters, SMALLEST, budget, effort or Effort()), sharpening=sharpening)


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


def report_curve(study: CurveStudy, *, sharpening: int = SHARPENING) -> SmoothnessReport:
    """The report on a curve that was studied, with a bound of the curvature on which only so many boxes are spent.

    It says UNDECIDED where something that was found is not in it.
    """
    effort, extent = study.effort, extent_of(study.region)
    effort.begin("points", SHARES[1])
    left = [(box, finding.locus) for box, finding in study.found.left]
    covers: dict[Box, Covering] = {}

    def settles(cluster: Cluster) -> bool:
        found = settled_finely(study.model, cluster.boxes, effort)
        covers.update(found)
        return bool(found)

    suspects = classify_joints(study.model, left, extent, effort, settles)
    study = replace(study, found=study.found.finer(covers))
    places = [*distinct(_located(study), badness), *suspects]
    tally = _tally(study, places)
    effort.begin("curvatures", SHARES[2])
    bound = (
        sharpened_bound(study.model, study.found.settled, extent, sharpening, effort) if _is_curve(tally) else math.inf
    )
    effort.finish()
    open_boxes = [box for box, _ in study.found.left]
    gaps = (*holes(study.model, open_boxes), *lacking(study.model, open_boxes))
    said = conclude(tally, places, 2, (*gaps, *effort.statements), ranging=len(study.region) > 2)
    defects = [joint for joint in places if is_defect(joint)]
    draft = SmoothnessReport(
        verdict=said.verdict,
        continuity=said.continuity,
        defects=tuple(sorted(defects, key=badness)),
        joints=tuple(joint for joint in places if joint not in defects),
        curvature_bound=bound,
        cover=_cover(study),
        letters={name: (float(low), float(high)) for name, (low, high) in study.values.items()},
        statements=said.statements,
        body=study.model.body,
    )
    return audited(draft, _unaccounted(study, suspects, draft))


def _tally(study: CurveStudy, places: Sequence[Joint]) -> Tally:
    """What the boxes hold; where letters range a boundary counts for a certificate if there is one for every value."""
    model, found, region = study.model, study.found, study.region
    order = min((f.order for _, f in found.settled if f.kind == "regular"), default=math.inf)
    kinds = Counter(finding.kind for _, finding in found.settled)
    exists = has_boundary(model, found, _located(study), extent_of(region))
    tally = Tally({**kinds, "open": len(found.left)}, order, exists)
    if len(region) > 2 and verdict_from(tally, places) == CERTIFIED:
        return tally if has_boundary_for_every_value(model, found, region[2:]) else replace(tally, exists=None)
    return tally


def _is_curve(tally: Tally) -> bool:
    """Whether there is a boundary, a curve with an inside and an outside all along."""
    return bool(tally.exists) and not any(tally[kind] for kind in ("open", *NO_CURVE))


def _found(study: CurveStudy) -> list[Joint]:
    """The joints of all boxes."""
    return [finding.place for _, finding in study.found.settled if isinstance(finding.place, Joint)]


def _located(study: CurveStudy) -> list[Joint]:
    """The joints of all boxes; of a body those at negative radii are the images of others, which have their boxes."""
    return [joint for joint in _found(study) if not study.model.body or joint.point[1] >= -joint.radius]


def _unaccounted(study: CurveStudy, suspects: Sequence[Joint], draft: SmoothnessReport) -> list[str]:
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


def _cover(study: CurveStudy) -> Cover:
    def boxes(*kinds: str) -> Floats:
        held = [box[:2] for box, finding in (*study.found.settled, *study.found.left) if finding.kind in kinds]
        return np.array(held, dtype=np.float64).reshape(-1, 2, 2)

    return Cover(
        bounds=study.region[:2],
        certified=boxes("regular"),
        joined=boxes("joined"),
        undecided=boxes("open", *NO_CURVE),
        examined=study.found.examined,
    )


def sharpened_bound(
    model: Model, settled: Sequence[tuple[Box, Inspection]], extent: float, budget: int, effort: Effort
) -> float:
    """The largest curvature on the settled boxes, proved: those with the largest bounds are divided until it is tight.

    At most `budget` further boxes are looked at.
    """
    inspector, allowed = ArcInspector(extent), budget
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


def has_boundary(model: Model, found: Covering, joints: Sequence[Joint], extent: float) -> bool | None:
    """Whether there is a point of the boundary: True and False are proved, None is neither.

    Where omega has both signs on a settled box it has a zero there, as it has the sign of a continuous function; of
    a double zero the inner function counts. Settled boxes without a change of sign are divided a few times: either
    one appears, or all are discarded. A leap over zero is no zero.
    """
    if joints:
        return True
    boxes = [pair for pair in found.settled if pair[1].kind != "leap"]
    inspector = ArcInspector(extent)
    with ctx.workprec(PRECISION):
        for _ in range(DIVIDED):
            if any(_changes_sign(model, box, finding) for box, finding in boxes) or len(boxes) > MOST_DIVIDED:
                break
            halved = [half for box, _ in boxes for half in halves(model, box)]
            findings = [inspector.inspect(model.over(half)) for half in halved]
            boxes = [pair for pair in zip(halved, findings, strict=True) if pair[1].kind not in {"empty", "leap"}]
        if any(_changes_sign(model, box, finding) for box, finding in boxes):
            return True
    leaps = any(finding.kind == "leap" for _, finding in found.settled)
    return None if boxes or leaps or found.left else False


def has_boundary_for_every_value(model: Model, found: Covering, ranges: Box) -> bool:
    """Whether it is proved that there is a point of the boundary whatever the letters are in their ranges.

    Where omega has both signs at points of a settled box, for all letters in a part of the ranges of the box, it has a
    zero in the box for each of them. The ranges are halved until there is such a box for every part.
    """
    cells, tried = [ranges], 0
    with ctx.workprec(PRECISION):
        while cells and tried < PARTS:
            cell = cells.pop()
            tried += 1
            if not any(_changes_sign(model, box, finding, _sides(cell)) for box, finding in _over(found, cell)):
                widths = [(high - low) / (b - a) for (low, high), (a, b) in zip(cell, ranges, strict=True)]
                axis = widths.index(max(widths))
                low, high = cell[axis]
                middle = low + (high - low) / 2
                cells += [(*cell[:axis], half, *cell[axis + 1 :]) for half in ((low, middle), (middle, high))]
    return not cells


def _over(found: Covering, cell: Box) -> Iterator[tuple[Box, Inspection]]:
    """Some of the settled boxes that hold a part of the ranges, evenly chosen."""
    own = [
        (box, finding)
        for box, finding in found.settled
        if all(low <= a and b <= high for (low, high), (a, b) in zip(box[2:], cell, strict=True))
    ]
    return islice(own, 0, None, max(1, len(own) // LOOKED_AT))


def _sides(cell: Box) -> list[arb]:
    return [side(*ends) for ends in cell]


def _changes_sign(model: Model, box: Box, finding: Inspection, ranges: Sequence[arb] | None = None) -> bool:
    number = finding.locus.nodes[0] if finding.locus.kind in {"leaf", "double"} else model.root
    ranges = [one.mid() for one in _sides(box[2:])] if ranges is None else ranges
    points = product(*((low, low + (high - low) / 2, high) for low, high in box[:2]))
    return {1, -1} <= {model.on([arb(x), arb(y), *ranges]).sign(number) for x, y in points}
