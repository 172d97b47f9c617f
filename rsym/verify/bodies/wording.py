"""A verdict on a body in words: one paragraph, then a line for all curves or points of one kind, the worst first."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from rsym.verify.bodies.groups import Group, groups
from rsym.verify.bodies.phrases import SHORT, between, counted, extents, interval, of, place, share_text, short
from rsym.verify.wording import PLAIN as PLAIN_KINDS
from rsym.verify.wording import measured, plural, rounded_up, significant, statement_sentences, verdict_text

if TYPE_CHECKING:
    from rsym.verify.bodies.report import BodyReport, SingularCurve, SingularPoint

PLACES = 8  # points that a line lists
REASONS = 2  # that a line gives
PLAIN: Mapping[str, str] = {
    **PLAIN_KINDS,
    "edge": "the tangent plane turns",
    "smooth joint": "the curvature is continuous",
    "isolated point": "the boundary is a single point",
    "node": "several sheets pass through one point",
    "tangency": "two sheets touch",
}


def body_text(report: BodyReport) -> str:
    """The whole report.

    Examples
    --------
    >>> from rsym.verify.bodies.report import BodyCover, BodyReport
    >>> none = np.empty((0, 3, 2))
    >>> cover = BodyCover(((-2, 2),) * 3, np.ones((7, 3, 2)), none, none, 40)
    >>> print(body_text(BodyReport("CERTIFIED", "analytic", (), (), (0.75, 1.25), (1.0, 1.0), cover, {})))
    CERTIFIED: the boundary within [-2, 2] x [-2, 2] x [-2, 2] is analytic; this is proved. 40 boxes were examined; \
where they prove the boundary regular, all principal curvatures lie in [0.75, 1.25]; all found are 1.
    """
    defects, joints = groups(report)
    lines = [" ".join(_sentences(report))]
    lines += [f"  {place}. {group_text(group)}" for place, group in enumerate(defects, 1)]
    lines += [f"  also {group_text(group)}" for group in joints]
    return "\n".join(lines)


def _sentences(report: BodyReport) -> Iterator[str]:
    yield f"{body_headline(report)}."
    yield curvatures_text(report)
    if len(report.undecided):
        yield undecided_text(report)
    yield from statement_sentences(report.statements)


def undecided_text(report: BodyReport) -> str:
    """In how much of the boundary nothing is proved."""
    boxes = plural(len(report.undecided), "box", "boxes")
    return f"Of the boundary {share_text(report.undecided_share)}, in {boxes}, is undecided."


def body_headline(report: BodyReport) -> str:
    """The verdict, of which body with which letters, and whether it is proved."""
    return verdict_text(report, "the boundary", "surface")


def curvatures_text(report: BodyReport) -> str:
    """How many boxes were examined, and what they say of the curvatures."""
    examined = f"{plural(report.cover.examined, 'box was', 'boxes were')} examined"
    if not (math.isfinite(report.curvature_bound) and len(report.cover.certified)):
        return f"{examined}."
    scale = max(report.curvature_bound, 2 / max(high - low for low, high in report.cover.bounds))
    proved = interval(*report.curvatures, scale)
    told = f"{examined}; where they prove the boundary regular, all principal curvatures lie in {proved}"
    if not all(map(math.isfinite, report.attained)):
        return f"{told}."
    low, high = (short(value, scale) for value in report.attained)
    found = f"all found are {low}" if low == high else f"those found go from {low} to {high}"
    return f"{told}; {found}."


def group_text(group: Group) -> str:
    """One line of a report."""
    return curves_text(group.curves) if group.curves else points_text(group.points)


def curves_text(curves: Sequence[SingularCurve]) -> str:
    """Curves of one kind, between the same definitions, in a line.

    Examples
    --------
    >>> from rsym.verify.bodies.report import SingularCurve
    >>> points, normals = np.array([[0, 0, 0], [0, 2.0, 0]]), np.array([[[0, 0, 1], [1, 0, 0.0]]] * 2)
    >>> flat = np.full(2, np.nan)
    >>> print(curves_text([SingularCurve(points, 0.0, "edge", "G0", ("top", "side"), normals, np.full(2, 90.0), flat, \
90.0, 0.0, traced=True, proved=True)]))
    edge between top and side from (0, 0, 0) to (0, 2, 0), length 2: the tangent plane turns by 90 degrees, the angle \
through the inside is 90; G0, proved; traced with proof
    """
    first = curves[0]
    status = f"{first.continuity}, {'proved' if first.proved else 'not proved'}"
    length = sum(curve.length for curve in curves)
    parts = [f"{counted(first.kind, len(curves))}{between(first.names)}{_extent(curves)}"]
    parts += [f"{'total length' if len(curves) > 1 else 'length'} {short(length)}"] if length else []
    told = [curves_effect(curves), status, *([_traced(curves)] if length else []), *_reasons(curves)]
    return f"{', '.join(parts)}: {'; '.join(told)}"


def _reasons(found: Sequence[SingularCurve | SingularPoint]) -> list[str]:
    """Why what is not proved, or not traced, is not; of several the first of each."""
    open_ = [one for one in found if not (one.proved and getattr(one, "traced", True))]
    return list(dict.fromkeys(one.reason.strip("; .") for one in open_ if one.reason))[:REASONS]


def curves_effect(curves: Sequence[SingularCurve]) -> str:
    """What one sees, walking across the curves along the boundary."""
    kind = curves[0].kind
    if kind == "edge" and any(np.isfinite(curve.tangent_jumps).any() for curve in curves):
        worst = _worst(curves, "tangent_jump")
        turn = _spread([curve.tangent_jumps for curve in curves], worst.tangent_jump, worst.tangent_jump_error)
        return f"the tangent plane turns by {turn} degrees, {_inner_angle(curves, worst)}"
    if kind == "curvature jump":
        worst = _worst(curves, "curvature_jump")
        jump = _spread([curve.curvature_jumps for curve in curves], worst.curvature_jump, worst.curvature_jump_error)
        return f"the normal curvature jumps by {jump}"
    return PLAIN.get(kind, "")


def _worst(curves: Sequence[SingularCurve], name: str) -> SingularCurve:
    return max(curves, key=lambda curve: -math.inf if math.isnan(getattr(curve, name)) else getattr(curve, name))


def _inner_angle(curves: Sequence[SingularCurve], worst: SingularCurve) -> str:
    """The dihedral angles; that at the worst place as exactly as the turn is known."""
    sharpest = int(np.argmax(np.nan_to_num(worst.tangent_jumps, nan=-math.inf)))
    turn = worst.tangent_jumps[sharpest] if math.isnan(worst.tangent_jump) else worst.tangent_jump
    angle = 180 - turn if worst.convex[sharpest] else 180 + turn
    known = np.concatenate([curve.dihedral_angles for curve in curves])
    known = known[np.isfinite(known)]
    if not len(known) or _is_constant(known, worst.tangent_jump_error):
        return f"the angle through the inside is {measured(angle, worst.tangent_jump_error)}"
    return f"the angle through the inside is between {short(known.min())} and {short(known.max())}"


def _spread(samples: Sequence[NDArray[np.float64]], worst: float, error: float) -> str:
    """The least and the greatest of values along curves, or the one that all are."""
    known = np.concatenate([np.empty(0), *samples])
    known = known[np.isfinite(known)]
    if math.isnan(worst):
        worst = float(known.max()) if len(known) else math.nan
    if not len(known) or _is_constant(np.append(known, worst), error):
        return measured(worst, error)
    # The largest of samples need not be the largest along a curve: many digits would say more than is known.
    return f"{short(known.min())} to {short(worst)}"


def _is_constant(values: NDArray[np.float64], error: float) -> bool:
    largest = float(np.abs(values).max())
    return float(np.ptp(values)) <= max(2 * (0.0 if math.isnan(error) else error), 10.0**-SHORT * largest)


def _extent(curves: Sequence[SingularCurve]) -> str:
    """From where to where one open curve goes; of others the box about them."""
    if len(curves) == 1 and len(curves[0].points) == 1:
        return f" at {place(curves[0].points[0])} within {rounded_up(curves[0].radius, 2)}"
    if len(curves) == 1 and not curves[0].closed:
        first, last = (place(point) for point in (curves[0].points[0], curves[0].points[-1]))
        return f" from {first} to {last}"
    box = extents(np.concatenate([curve.points for curve in curves]))
    closed = sum(curve.closed for curve in curves)
    if closed in (0, len(curves)):
        return f", {'closed, ' if closed else ''}within {box}"
    return f", {closed} of them closed, within {box}"


def _traced(curves: Sequence[SingularCurve]) -> str:
    traced = sum(curve.traced for curve in curves)
    if traced in (0, len(curves)):
        return "traced with proof" if traced else "traced numerically"
    return f"{traced} of them traced with proof"


def points_text(points: Sequence[SingularPoint]) -> str:
    """Points of one kind, of the same definitions, in a line.

    Examples
    --------
    >>> from rsym.verify.bodies.report import SingularPoint
    >>> points_text([SingularPoint((0.0, 0.0, 1.0), 0.0, "cone tip", "G0", ("cone",), 90.0, 0.0, proved=True)])
    'cone tip of cone at (0, 0, 1): the normals differ by up to 90 degrees; G0, proved'
    """
    first = points[0]
    radius = max(point.radius for point in points)
    near = f" within {rounded_up(radius, 2)}" if radius > significant(*np.ravel([one.point for one in points])) else ""
    where = ", ".join(place(point.point) for point in points[:PLACES])
    where += f" and {len(points) - PLACES} other places" if len(points) > PLACES else ""
    status = f"{first.continuity}, {'proved' if first.proved else 'not proved'}"
    told = "; ".join(filter(None, [points_effect(points), status, *_reasons(points)]))
    return f"{counted(first.kind, len(points))}{of(first.names)} at {where}{near}: {told}"


def points_effect(points: Sequence[SingularPoint]) -> str:
    """What the boundary is at the points."""
    worst = max(points, key=lambda one: -math.inf if math.isnan(one.tangent_jump) else one.tangent_jump)
    told = [PLAIN[worst.kind]] if worst.kind in PLAIN else []
    if worst.tangent_jump > 0:
        told.append(f"the normals differ by up to {measured(worst.tangent_jump, worst.tangent_jump_error)} degrees")
    return ", ".join(told)
