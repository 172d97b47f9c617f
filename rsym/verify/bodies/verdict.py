"""The verdict on a body: boxes, curves and points put together."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from rsym.model.shape import Bounds, Shape
from rsym.sampling.progress import Progress
from rsym.verify.bodies.bending import Bending, bending
from rsym.verify.bodies.forming import formation
from rsym.verify.bodies.images import Images
from rsym.verify.bodies.inspection import Inspection
from rsym.verify.bodies.naming import Naming
from rsym.verify.bodies.octree import Octree, Subdivision, joined_boxes
from rsym.verify.bodies.points import classify_points, is_degenerate
from rsym.verify.bodies.report import Array, BodyCover, BodyReport, Defect, SingularCurve, SingularPoint, is_defect
from rsym.verify.bodies.tracing import trace
from rsym.verify.cleaning import cleaned
from rsym.verify.domains import is_legal
from rsym.verify.local import Box, Interval, Model
from rsym.verify.report import CERTIFIED, CONTINUITIES, DEGENERATE, REFUTED, UNDECIDED
from rsym.verify.wording import plural

BUDGET = 1_000_000  # boxes: a ball takes 8 000, the car 120 000
INSPECTIONS = 20_000  # boxes that balls look at, a millisecond or a few each; the car takes 1 300
SMALLEST = 2.0**-22  # of the extent: what is smaller is located, not divided
SAME = 1e-12  # of the extent: points that are nearer than their accuracies and this are one
TRIED = 2_000  # boxes at whose corners a change of sign is sought


@dataclass(frozen=True)
class Study:
    """A body and what was found on its boxes."""

    images: Images
    region: Box
    found: Subdivision
    naming: Naming

    @property
    def extent(self) -> float:
        """The longest side of the region."""
        return max(high - low for low, high in self.region)


def study_body(
    shape: Shape,
    bounds: Bounds,
    letters: Mapping[str, Interval],
    *,
    smallest: float = SMALLEST,
    budget: int = BUDGET,
    progress: Progress | None = None,
) -> Study:
    """Subdivide the bounds of a body."""
    model = Model(shape.replace(expression=cleaned(shape.expression)), letters)
    region: Box = tuple((float(low), float(high)) for low, high in bounds)
    whole = model.over(region)
    formed = formation(model, lambda number: is_legal(whole, number))
    images = Images(model, formed, letters)
    width = max(high - low for low, high in region)
    octree = Octree(
        images, region, smallest=smallest * width, budget=budget, inspections=INSPECTIONS, progress=progress
    )
    naming = Naming(shape, model.builder, formed.definitions, formed.origins)
    return Study(images, region, octree.run(), naming)


def report_body(study: Study, *, sharpened: bool = True) -> BodyReport:
    """The report on a body that was studied; `sharpened`: with bounds of the curvatures, which take longest."""
    model, found = study.images.model, study.found
    corners = [
        (box, replace(one.point, names=tuple(dict.fromkeys(map(study.naming, one.sheets)))))
        for box, one in found.corners
        if one.point is not None
    ]
    curves, open_boxes = _curves(study, corners)
    found = replace(found, left=[*found.left, *((box, Inspection("open")) for box in open_boxes)])
    classified = classify_points(model, found.left, study.extent, study.naming, curves)
    points = _distinct([*(point for _, point in corners), *classified.points], SAME * study.extent)
    curves = [*curves, *classified.curves]
    found = found.with_late(classified.regular, classified.corners)
    exists = _exists(study.images, found)
    verdict = _verdict(found, [*curves, *points], exists)
    bent = bending(study.images, found) if sharpened and exists else Bending((-math.inf, math.inf), (math.nan,) * 2)
    return BodyReport(
        verdict=verdict,
        continuity=_continuity(found, curves, points, verdict, exists),
        curves=tuple(sorted(curves, key=_badness)),
        points=tuple(sorted(points, key=_badness)),
        curvatures=(-math.inf, math.inf) if found.left or found.late or found.double else bent.enclosure,
        attained=bent.attained,
        cover=_cover(study.region, found),
        letters={name: (float(low), float(high)) for name, (low, high) in model.letters.items()},
        statements=_statements(found, exists),
    )


def _curves(study: Study, corners: Sequence[tuple[Box, SingularPoint]]) -> tuple[list[SingularCurve], list[Box]]:
    """The curves of each pair of sheets, by the boxes in which these meet; and boxes that may hold more of one."""
    curves: list[SingularCurve] = []
    open_boxes: list[Box] = []
    for meeting, groups in study.found.joined.items():
        names = tuple(study.naming(arc.function) for arc in meeting.arcs)
        boxes = [_box(box) for group in groups for box in group.tolist()]
        found = trace(study.images.model, meeting, (names[0], names[1]), boxes, extent=study.extent, corners=corners)
        for curve in found:
            if curve.kind == "unresolved" and len(curve.points) == 1:
                open_boxes += [box for box in boxes if _holds(box, curve.points[0])][:1]
            else:
                curves.append(curve)
    return curves, open_boxes


def _holds(box: Box, point: Array) -> bool:
    return all(low <= value <= high for value, (low, high) in zip(point, box, strict=False))


def _box(sides: Sequence[Sequence[float]]) -> Box:
    return tuple((low, high) for low, high in sides)


def _distinct(points: Sequence[SingularPoint], near: float) -> list[SingularPoint]:
    """Neighbouring boxes find the same corner; the proved one is kept."""
    result: list[SingularPoint] = []
    for point in sorted(points, key=_badness):
        gaps = (math.dist(point.point, other.point) - point.radius - other.radius for other in result)
        if not any(gap <= near for gap in gaps):
            result.append(point)
    return result


def _exists(images: Images, found: Subdivision) -> bool | None:
    """Whether there is a point of the boundary: True and False are proved, None is neither."""
    boxes = [part for parts in found.regular.values() for part in parts] + list(joined_boxes(found))
    if boxes:
        settled = np.concatenate(boxes)[:TRIED]
        corners = np.stack([settled[:, range(3), list(ends)] for ends in product((0, 1), repeat=3)])
        signs = np.array([images.sign(np.stack([points, points], axis=-1)) for points in corners])
        if ((signs > 0).any(axis=0) & (signs < 0).any(axis=0)).any():
            return True
    return None if boxes or found.left or found.double else False


def _verdict(found: Subdivision, everything: Sequence[Defect], exists: bool | None) -> str:
    """The strongest word that the evidence bears."""
    proved = [one for one in everything if one.proved and is_defect(one)]
    degenerate = [one for one in proved if isinstance(one, SingularPoint) and is_degenerate(one)]
    if len(proved) > len(degenerate):
        return REFUTED
    if degenerate or found.double or exists is False:
        return DEGENERATE
    if found.left or any(not one.proved for one in everything):
        return UNDECIDED
    return CERTIFIED if exists else UNDECIDED


def _continuity(
    found: Subdivision,
    curves: Sequence[SingularCurve],
    points: Sequence[SingularPoint],
    verdict: str,
    exists: bool | None,
) -> str:
    everything: list[Defect] = [*curves, *points]
    counted = [one for one in everything if one.proved or verdict != REFUTED]
    levels = [CONTINUITIES.index(one.continuity) for one in counted]
    levels.append(len(CONTINUITIES) - 1 if math.isinf(found.order) else min(math.ceil(found.order), 4))
    if found.double or not exists or (found.left and verdict != REFUTED):
        levels.append(0)
    return CONTINUITIES[min(levels)]


def _badness(one: Defect) -> tuple[float, ...]:
    sizes = [one.tangent_jump, getattr(one, "curvature_jump", math.nan)]
    place = one.points[0].tolist() if isinstance(one, SingularCurve) else one.point
    size = [0.0 if math.isnan(value) else -value for value in sizes]
    return (not one.proved, CONTINUITIES.index(one.continuity), *size, *place)


def _cover(region: Box, found: Subdivision) -> BodyCover:
    none = np.empty((0, 3, 2))
    late: Array = np.array([box[:3] for box in found.late], dtype=np.float64).reshape(-1, 3, 2)
    left: Array = np.array([box[:3] for box, _ in found.left] + found.double, dtype=np.float64).reshape(-1, 3, 2)
    return BodyCover(
        bounds=region,
        certified=np.concatenate([none, late, *(part for parts in found.regular.values() for part in parts)]),
        joined=np.concatenate([none, *joined_boxes(found)]),
        undecided=left,
        examined=found.examined,
    )


def _statements(found: Subdivision, exists: bool | None) -> tuple[tuple[str, bool], ...]:
    """Sentences about the whole boundary, each with whether it is proved; curves and points speak for themselves."""
    result = []
    if not exists:
        none = exists is False
        result.append((f"no point of the boundary {'lies' if none else 'was found'} within the bounds", none))
    regular = sum(len(part) for parts in found.regular.values() for part in parts)
    joined = sum(len(part) for parts in found.joined.values() for part in parts)
    if found.double:
        result.append((f"in {_boxes(len(found.double))} omega is zero without changing its sign", True))
    if regular and exists:
        smooth = "analytic" if math.isinf(found.order) else f"C^{math.ceil(found.order) - 1}"
        result.append((f"in {_boxes(regular)} the boundary is a regular {smooth} surface", True))
    if joined:
        result.append((f"in {_boxes(joined)} it consists of two analytic sheets that meet in a curve, if at all", True))
    if found.corners:
        result.append((f"in {_boxes(len(found.corners))} it has a corner of three analytic sheets", True))
    if found.left:
        result.append((f"in {_boxes(len(found.left))} nothing is proved of the boundary as a whole", False))
    return tuple(result)


def _boxes(count: int) -> str:
    return plural(count, "box", "boxes")
