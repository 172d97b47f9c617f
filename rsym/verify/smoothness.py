"""Is the curvature of a boundary continuous? Proved, refuted, or honestly left open."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rsym.codegen.enclosures import ranges_of
from rsym.errors import RsymError
from rsym.model.shape import Shape
from rsym.sampling.extent import bounds_or_extent
from rsym.sampling.lattice import bounds_of
from rsym.sampling.progress import Progress
from rsym.verify.arguments import require_count, require_positive, require_shape
from rsym.verify.bodies.report import BodyReport
from rsym.verify.bodies.verdict import BUDGET as BODY_BUDGET
from rsym.verify.bodies.verdict import Study, report_body, study_body
from rsym.verify.cleaning import cleaned
from rsym.verify.covering import Covering, cover, extent_of
from rsym.verify.evidence import has_boundary, statements
from rsym.verify.local import Box, Interval, Model
from rsym.verify.pruning import pruner
from rsym.verify.report import (
    CERTIFIED,
    CONTINUITIES,
    DEGENERATE,
    REFUTED,
    UNDECIDED,
    Cover,
    Joint,
    SmoothnessReport,
)
from rsym.verify.revolution import find_meridian, meridian
from rsym.verify.sharpening import sharpened_bound
from rsym.verify.suspects import DEGENERATIONS, classify_suspects

BUDGET = 20_000  # boxes: the body of Fig. 11 takes 130, a lemniscate with its node 240, the car 200 to 900
METHODS = ("auto", "meridian", "space")
SMALLEST = 2.0**-22  # of the extent: a suspect of this size is located, not divided
SHARPENING = 3_000  # boxes spent on the bound of the curvature: 5 to 12 % above the largest, a third on a hard one
BELOW_AXIS = 0.02  # the share of the radius on the far side of the axis of a body


def verify_smoothness(
    shape: Shape,
    *,
    bounds: Any = None,
    letters: Mapping[Any, Any] | None = None,
    method: str = "auto",
    smallest: float = SMALLEST,
    budget: int | None = None,
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
        value in it, REFUTED for at least one.
    method : {"auto", "meridian", "space"}
        How a body is judged. "meridian": a body of revolution by its meridian; points of the report are (axis, radius).
        "space": any body, by boxes in space. "auto": by the meridian where the equation shows that there is one.
    smallest : float
        Boxes are divided down to this share of the extent.
    budget : int, optional
        The greatest number of boxes to examine.
    progress : callable, optional
        ``progress(examined, budget)``, now and then; an answer of False cancels.

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
    if _in_space(shape, method):
        return report_body(studied_in_space(shape, bounds, letters, smallest, budget, progress))
    return _report(_study(shape, bounds, letters, smallest, budget or BUDGET, progress))


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
    progress: Progress | None = None,
) -> Study:
    """What boxes in space say of a body; `rsym.verify.bodies.verdict.report_body` makes a report of it."""
    values = ranges_of(shape.letters, letters)
    middles = {name: float((low + high) / 2) for name, (low, high) in values.items()}
    box = bounds_or_extent(shape, bounds, middles)
    return study_body(shape, box, values, smallest=smallest, budget=budget or BODY_BUDGET, progress=progress)


def verdict_of(shape: Shape, *, bounds: Any, letters: Mapping[Any, Any] | None, budget: int) -> str:
    """The verdict alone, without a sharp bound of the curvature."""
    return quick_report(shape, bounds=bounds, letters=letters, budget=budget).verdict


def quick_report(
    shape: Shape, *, bounds: Any, letters: Mapping[Any, Any] | None, budget: int, sharpening: int = 0
) -> SmoothnessReport | BodyReport:
    """The report with a bound of the curvature on which only so many boxes are spent, in the plane."""
    if _in_space(shape, "auto"):
        study = studied_in_space(shape, bounds, letters, SMALLEST, budget * BODY_BUDGET // BUDGET)
        return report_body(study, sharpened=sharpening > 0)
    return _report(_study(shape, bounds, letters, SMALLEST, budget, None), sharpening=sharpening)


@dataclass(frozen=True)
class _Study:
    """A model and what was found on its boxes."""

    model: Model
    region: Box
    found: Covering
    values: Mapping[str, Interval]


def _study(
    shape: Shape,
    bounds: Any,
    letters: Mapping[Any, Any] | None,
    smallest: float,
    budget: int,
    progress: Progress | None,
) -> _Study:
    body = shape.dimension == 3
    plane = _meridian_within(shape, bounds) if body else shape
    plane = plane.replace(expression=cleaned(plane.expression))
    box = bounds_of(plane, None if body else bounds)
    values = ranges_of(shape.letters, letters)
    model = Model(plane, values, body=body)
    ranges = tuple(_around(*values[name]) for name in model.axes[2:])
    region: Box = (_below_axis(box) if body else tuple((float(a), float(b)) for a, b in box)) + ranges
    prune = pruner(plane, model.axes, values)
    found = cover(model, region, smallest=smallest * extent_of(region), budget=budget, prune=prune, progress=progress)
    return _Study(model, region, found, values)


def _around(low: Fraction, high: Fraction) -> tuple[float, float]:
    """The narrowest interval of floats known to hold the exact one."""
    return math.nextafter(float(low), -math.inf), math.nextafter(float(high), math.inf)


def _meridian_within(shape: Shape, bounds: Any) -> Shape:
    return meridian(shape if bounds is None else shape.replace(bounds=bounds))[0]


def _below_axis(box: Any) -> Box:
    """The upper half of the meridian and a little of its mirror image, so that the axis lies inside."""
    (low, high), (_, radius) = box
    return ((float(low), float(high)), (-BELOW_AXIS * float(radius), float(radius)))


def _report(study: _Study, *, sharpening: int = SHARPENING) -> SmoothnessReport:
    model, region, found, values = study.model, study.region, study.found, study.values
    joints = _distinct([f.joint for _, f in found.settled if f.joint is not None])
    suspects = classify_suspects(model, found, extent_of(region))
    if model.body:
        joints = [joint for joint in joints if joint.point[1] > -joint.radius]
    everything = joints + suspects
    exists = has_boundary(model, found, joints, extent_of(region))
    verdict = _verdict(found, everything, exists)
    order = min((f.order for _, f in found.settled if f.kind == "regular"), default=math.inf)
    counted = [joint for joint in everything if joint.proved or verdict != REFUTED]
    levels = [CONTINUITIES.index(joint.continuity) for joint in counted]
    levels.append(len(CONTINUITIES) - 1 if order == math.inf else min(math.ceil(order), 4))
    nothing_known = found.left and not suspects and verdict != REFUTED
    if any(f.kind == "double" for _, f in found.settled) or not exists or nothing_known:
        levels.append(0)
    bound = math.inf if found.left or not exists else sharpened_bound(model, found.settled, region, sharpening)
    defects = [joint for joint in everything if _is_defect(joint)]
    return SmoothnessReport(
        verdict=verdict,
        continuity=CONTINUITIES[min(levels)],
        defects=tuple(sorted(defects, key=_badness)),
        joints=tuple(joint for joint in everything if joint not in defects),
        curvature_bound=bound,
        cover=_cover(region, found),
        letters={name: (float(low), float(high)) for name, (low, high) in values.items()},
        statements=statements(found, exists),
        body=model.body,
    )


def _verdict(found: Covering, joints: Sequence[Joint], exists: bool | None) -> str:
    """The strongest word that the evidence bears."""
    if any(joint.proved and _is_defect(joint) and joint.kind not in DEGENERATIONS for joint in joints):
        return REFUTED
    degenerate = any(joint.proved and joint.kind in DEGENERATIONS for joint in joints)
    if degenerate or any(f.kind == "double" for _, f in found.settled) or exists is False:
        return DEGENERATE
    if found.left or any(not joint.proved for joint in joints):
        return UNDECIDED
    return CERTIFIED if exists else UNDECIDED


def _is_defect(joint: Joint) -> bool:
    return CONTINUITIES.index(joint.continuity) < CONTINUITIES.index("G2")


def _distinct(joints: Sequence[Joint]) -> list[Joint]:
    """Neighbouring boxes find the same joint; over a range of letters the worst one of those that overlap is kept."""
    result: list[Joint] = []
    for joint in sorted(joints, key=_badness):
        if not any(math.dist(joint.point, other.point) <= joint.radius + other.radius for other in result):
            result.append(joint)
    return result


def _badness(joint: Joint) -> tuple[float, ...]:
    size = [0.0 if math.isnan(value) else -value for value in (joint.tangent_jump, joint.curvature_jump)]
    return (not joint.proved, CONTINUITIES.index(joint.continuity), *size, *joint.point)


def _cover(region: Box, found: Covering) -> Cover:
    settled = [(box, finding.kind) for box, finding in found.settled]
    return Cover(
        bounds=region[:2],
        certified=_boxes([box for box, kind in settled if kind == "regular"]),
        joined=_boxes([box for box, kind in settled if kind == "joined"]),
        undecided=_boxes([box for box, _ in found.left] + [box for box, kind in settled if kind == "double"]),
        examined=found.examined,
    )


def _boxes(boxes: Sequence[Box]) -> NDArray[np.float64]:
    return np.array([box[:2] for box in boxes], dtype=np.float64).reshape(-1, 2, 2)
