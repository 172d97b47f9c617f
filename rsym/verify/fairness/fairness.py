"""How fair is a boundary? Its curvature, how fast it varies, where it is extreme: proved where that is possible."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from rsym.bounds.enclosures import ranges_of
from rsym.errors import RsymError
from rsym.model.equation import with_exact_letters
from rsym.model.requirements import require_count, require_positive, require_shape
from rsym.model.shape import Shape
from rsym.reports.words import plural
from rsym.sampling.combs import combs
from rsym.sampling.progress import Effort, Progress, Stages
from rsym.sampling.windows import bounds_or_extent
from rsym.verify.answers.body_report import BodyReport
from rsym.verify.answers.report import SmoothnessReport
from rsym.verify.boxes.local import Box, Interval, Model
from rsym.verify.cleaning import cleaned
from rsym.verify.fairness.bending import Arcs
from rsym.verify.fairness.bodies import body_fairness
from rsym.verify.fairness.measuring import Sampler, measures
from rsym.verify.fairness.pieces import outward
from rsym.verify.fairness.report import Bands, CurvatureBounds, Extremum, FairnessReport, Measure, Profile
from rsym.verify.fairness.search import CurvatureZero, Found, distinct, peaks, search
from rsym.verify.revolution import meridian
from rsym.verify.smoothness import verify_smoothness

BUDGET = 6_000  # pieces: an ellipse takes 150, the body of Fig. 11 at a2 = 6 takes 2 800
TEETH = 600  # places at which the curvature is sampled along the boundary, and more where it bends
NAMES = {"curve": ("curvature",), "body of revolution": ("curvature of the meridian", "curvature across the meridian")}


def fairness(
    shape: Shape,
    *,
    bounds: Any = None,
    letters: Mapping[Any, Any] | None = None,
    method: str = "auto",
    tolerance: float = 0.01,
    budget: int = BUDGET,
    timeout: float | None = None,
    progress: Progress | None = None,
) -> FairnessReport:
    """Bounds on the curvature of a boundary and on its variation, proved, and where the curvature is extreme.

    The boxes in which `verify_smoothness` proves the boundary regular are cut along it. On each piece the curvature
    k and dk/ds are enclosed in balls; a piece is divided as long as its bounds exceed what is attained at some point
    of the boundary. Zeros of dk/ds, the vertices of the curve, and of k, its inflections, are excluded or proved to
    be one and located by Krawczyk's operator. Measures are numerical, with an estimate of their error.

    Parameters
    ----------
    shape : Shape
        In the plane, or a body; one of revolution is judged by its meridian. Of a general body the bounds of the
        principal curvatures are proved, while the variation, extrema and measures are numerical.
    bounds : sequence of pairs, optional
        All is said of the boundary within these; by default the bounds of the shape.
    letters : mapping, optional
        Numbers by name.
    method : {"auto", "meridian", "space"}
        As for `verify_smoothness`.
    tolerance : float
        How far a proved bound may exceed what is attained, as a share of the largest curvature or variation.
    budget : int
        The greatest number of pieces to examine.
    timeout : float, optional
        Seconds after which no piece is divided further: bounds are wider then, and a statement says so.
    progress : callable, optional
        ``progress(done, total)``, now and then, first of the verdict, then of the curvatures, as for
        `verify_smoothness`; an answer of False cancels.

    Returns
    -------
    FairnessReport
        ``.curvatures``, ``.extrema``, ``.inflections``, ``.complete``, ``.measures``, ``.smoothness``.

    Raises
    ------
    RsymError
        As `verify_smoothness`, for a letter that ranges, a tolerance or budget that is not positive, and where there
        is no regular boundary, or none was found in the time allowed.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> report = fairness(rsym.Shape(1 - x**2 / 4 - y**2, (x, y), bounds=((-3, 3), (-2, 2))))
    >>> [(one.kind, one.curvature) for one in report.extrema if one.point[0] >= 0 and one.point[1] >= 0]
    [('minimum', 0.25), ('maximum', 2.0)]
    >>> len(report.extrema), report.complete, 2 <= report.curvatures[0].greatest.bound < 2.03
    (4, True, True)
    """
    require_shape(shape)
    require_positive("tolerance", tolerance, "for example 0.01")
    require_count("budget", budget, f"for example {BUDGET}")
    shape, letters = with_exact_letters(shape, letters)
    values = ranges_of(shape.letters, letters)
    ranging = [name for name, (low, high) in values.items() if low != high]
    if ranging:
        raise RsymError(
            f"fairness is that of one design, but {', '.join(ranging)} ranges", code="letters", remedy="give numbers"
        )
    effort = Effort(progress, timeout)
    smoothness = verify_smoothness(
        shape, bounds=bounds, letters=letters, method=method, timeout=effort.left, progress=progress
    )
    if isinstance(smoothness, BodyReport):
        return body_fairness(shape, smoothness, values)
    return _of_a_curve(shape, bounds, smoothness, values, tolerance, budget, effort)


def _of_a_curve(
    shape: Shape,
    bounds: Any,
    smoothness: SmoothnessReport,
    values: Mapping[str, Interval],
    tolerance: float,
    budget: int,
    effort: Effort,
) -> FairnessReport:
    """The report on a plane shape, or on a body of revolution by its meridian."""
    body = shape.dimension == 3
    plane = meridian(shape if bounds is None else shape.replace(bounds=bounds))[0] if body else shape
    region: Box = tuple((float(low), float(high)) for low, high in smoothness.cover.bounds)
    model = Model(plane.replace(expression=cleaned(plane.expression)), values, body=body, bounds=region)
    arcs = Arcs(model)
    covered = np.concatenate([smoothness.cover.certified, smoothness.cover.joined])
    boxes: list[Box] = [tuple((float(low), float(high)) for low, high in box) for box in covered]
    effort.begin("curvatures", Stages.TOTAL)
    found = search(arcs, boxes, region, tolerance=tolerance, budget=budget, effort=effort)
    if not found.done and effort.is_over:
        raise RsymError("no regular boundary was found in the time allowed", code="timeout", remedy="allow more time")
    if not found.done:
        raise RsymError(
            "no regular boundary was found within the bounds", code="no-boundary", remedy="give wider bounds"
        )
    sampler = Sampler(arcs, [bent.piece for bent, _ in found.done])
    single = {name: float(low) for name, (low, _) in values.items()}
    box = bounds_or_extent(plane, None if body else bounds, single)
    lines = combs(plane, teeth=TEETH, bounds=box, letters=single)
    joints = [joint.point for joint in (*smoothness.defects, *smoothness.joints)]
    kind = "body of revolution" if body else "curve"
    names = (model.builder.coordinates[0], "radius") if body else model.builder.coordinates
    report = _report(kind, names, smoothness, found, arcs, *measures(sampler, lines, joints))
    return replace(report, statements=(*report.statements, *effort.statements))


def _report(
    kind: str,
    coordinates: tuple[str, ...],
    smoothness: SmoothnessReport,
    found: Found,
    arcs: Arcs,
    sizes: Mapping[str, Measure],
    profiles: tuple[Profile, ...],
) -> FairnessReport:
    zeros = [_extremum(NAMES[kind], zero) for zero in distinct(z for _, settled in found.done for z in settled.zeros)]
    zeros.sort(key=lambda one: (NAMES[kind].index(one.quantity), *_place_along(profiles, one.point)))
    undecided = sum(settled.open for _, settled in found.done)
    alike = sum(settled.alike for _, settled in found.done)
    flags = [arcs.constant(bent.piece.arc.function) for bent, _ in found.done]
    constant = tuple(map(all, zip(*flags, strict=True)))
    boxes = np.array([bent.piece.box for bent, _ in found.done])
    return FairnessReport(
        kind=kind,
        coordinates=coordinates,
        smoothness=smoothness,
        curvatures=tuple(CurvatureBounds(name, *peaks(found.done, k)) for k, name in enumerate(NAMES[kind])),
        extrema=tuple(one for one in zeros if one.kind != "inflection"),
        inflections=tuple(one for one in zeros if one.kind == "inflection"),
        complete=all(one.proved for one in zeros)
        and not (undecided or alike or found.lost or len(smoothness.undecided)),
        constant=constant,
        measures=sizes,
        profiles=profiles,
        bands=Bands(boxes, np.array([[outward(one.value) for one in bent.curvatures] for bent, _ in found.done])),
        statements=_statements(found, smoothness, undecided, alike),
    )


def _extremum(names: Sequence[str], zero: CurvatureZero) -> Extremum:
    radius = max(float(ball.rad()) for ball in zero.place)
    point = tuple(float(ball.mid()) for ball in zero.place)
    rounding = max(math.ulp(value) for value in point)
    value = float(zero.value.mid())
    return Extremum(
        kind=zero.kind,
        quantity=names[zero.number],
        point=point,
        radius=2 * radius + rounding,
        curvature=value,
        error=float(zero.value.rad()) + math.ulp(value),
        proved=zero.proved,
        flat=zero.flat,
    )


def _place_along(profiles: Sequence[Profile], point: Sequence[float]) -> tuple[int, float]:
    """The line on which a point is, and the arc length up to it."""
    nearest = [int(np.hypot(*(profile.points - point).T).argmin()) for profile in profiles]
    away = [math.dist(profile.points[k], point) for profile, k in zip(profiles, nearest, strict=True)]
    line = away.index(min(away))
    return line, float(profiles[line].length[nearest[line]])


def _statements(found: Found, smoothness: SmoothnessReport, undecided: int, alike: int) -> tuple[tuple[str, bool], ...]:
    count = plural(len(found.done), "piece")
    result = [(f"the bounds hold on the {count} into which the regular boundary is cut", True)]
    outside = len(found.lost) + len(smoothness.undecided)
    if outside:
        result.append((f"nothing is bounded on {plural(outside, 'box', 'boxes')}", False))
    if undecided:
        result.append((f"whether there are more extrema or inflections on {plural(undecided, 'piece')}", False))
    if alike:
        result.append((f"on {plural(alike, 'piece')} the curvature is constant to {DIGITS} digits", False))
    return tuple(result)


DIGITS = 24  # of `zeros.ZERO`
