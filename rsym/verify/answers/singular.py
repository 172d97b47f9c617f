"""What is singular on a boundary in space: curves along which sheets meet, and points; each in a line of words."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from rsym.arrays import Floats
from rsym.reports.numbers import SHORT, about, extents, measured, nearness, point, short
from rsym.reports.words import first_of, listed
from rsym.verify.answers.report import PLAIN as PLAIN_KINDS

PLACES = 8  # points that a line lists
REASONS = 2  # that a line gives
LONGEST = 48  # characters of a definition: one without a name goes by its formula
SINGLE: Mapping[str, str] = {"unresolved": "unresolved place"}
SEVERAL: Mapping[str, str] = {
    "tangency": "tangencies",
    "no sign change": "places without a change of sign",
    "unresolved": "unresolved places",
    "unbounded curvature": "places of unbounded curvature",
}
PLAIN: Mapping[str, str] = {
    **PLAIN_KINDS,
    "edge": "the tangent plane turns",
    "smooth joint": "the curvature is continuous",
    "isolated point": "the boundary is a single point",
    "node": "several sheets pass through one point",
    "tangency": "two sheets touch",
}


@dataclass(frozen=True, eq=False)
class SingularCurve:
    """A curve on a boundary along which two analytic sheets meet.

    Attributes
    ----------
    points : (n, 3) float64
        Points of the curve in their order, each within `radius` of it; a closed curve repeats its first point.
    kind : str
        "edge" (the tangent plane turns), "curvature jump", "smooth joint", "unbounded curvature" or "unresolved".
    continuity : str
        What the boundary is across the curve where it is worst, a word of ``CONTINUITIES``.
    names : pair of str
        The definitions that meet.
    normals : (n, 2, 3) float64
        The outward unit normals of both sheets at the points.
    tangent_jumps : (n,) float64
        The angles between both normals, in degrees.
    curvature_jumps : (n,) float64
        How much the normal curvature across the curve jumps; NaN where the tangent planes differ.
    tangent_jump, curvature_jump : float
        The largest of them, each known to within its error.
    traced : bool
        Whether the whole curve was followed by certified continuation: there is one curve, and it passes these points.
    proved : bool
        Whether the continuity is proved: that it is no more at a point of the curve, for one below G2; that it is no
        less all along it, else.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y, z
    >>> bounds = ((-1.2, 1.3), (-1.3, 1.2), (-0.5, 1.3))
    >>> half = rsym.Shape(rsym.conjunction(1 - x**2 - y**2 - z**2, z), (x, y, z), bounds=bounds)
    >>> (rim,) = rsym.verify_smoothness(half, method="space").curves
    >>> rim.kind, rim.closed, rim.traced, rim.names, round(float(rim.dihedral_angles.max()), 9)
    ('edge', True, True, ('-x**2 - y**2 - z**2 + 1', 'z'), 90.0)
    """

    points: Floats
    radius: float
    kind: str
    continuity: str
    names: tuple[str, str]
    normals: Floats
    tangent_jumps: Floats
    curvature_jumps: Floats
    tangent_jump: float = math.nan
    tangent_jump_error: float = math.nan
    curvature_jump: float = math.nan
    curvature_jump_error: float = math.nan
    traced: bool = False
    proved: bool = False
    reason: str = ""

    @property
    def closed(self) -> bool:
        """Whether the curve ends where it begins."""
        return len(self.points) > 2 and bool((self.points[0] == self.points[-1]).all())

    @property
    def length(self) -> float:
        """The length of the polyline through the points."""
        return float(np.linalg.norm(np.diff(self.points, axis=0), axis=1).sum())

    @property
    def dihedral_angles(self) -> Floats:
        """The angles between the two sheets at the points, measured through the inside, in degrees: 180 is flat."""
        angles: Floats = np.where(self.convex, 180 - self.tangent_jumps, 180 + self.tangent_jumps)
        return angles

    @property
    def convex(self) -> NDArray[np.bool_]:
        """Whether the edge is convex at each point; the first sheet lies to the left, seen from outside."""
        along = np.gradient(self.points, axis=0) if len(self.points) > 1 else np.zeros_like(self.points)
        turn = np.cross(self.normals[:, 0], self.normals[:, 1])
        inner: NDArray[np.bool_] = np.einsum("ij,ij->i", turn, along) >= 0
        return inner

    def __str__(self) -> str:
        return curves_text((self,))

    def __repr__(self) -> str:
        shape = "closed" if self.closed else "open"
        between = " | ".join(map(repr, self.names))
        return f"SingularCurve({self.kind}, {between}, {self.continuity}, {shape}, {len(self.points)} points)"


@dataclass(frozen=True)
class SingularPoint:
    """A point where a boundary is less than two sheets that meet along a curve.

    `point` is within `radius` of the truth. kind: "corner" (three or more sheets meet), "cone tip", "cusp", "node",
    "tangency", "isolated point", "end", "no sign change", "curvature jump" or "unresolved". `tangent_jump` is the
    largest angle between normals at the point in degrees, NaN where it is not known; names: the definitions that meet.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y, z
    >>> corner = rsym.Shape(rsym.conjunction(x, y, z), (x, y, z), bounds=((-1, 1.1),) * 3)
    >>> (point,) = rsym.verify_smoothness(corner).points
    >>> point.kind, point.point, point.names
    ('corner', (0.0, 0.0, 0.0), ('x', 'y', 'z'))
    """

    point: tuple[float, ...]
    radius: float
    kind: str
    continuity: str
    names: tuple[str, ...] = ()
    tangent_jump: float = math.nan
    tangent_jump_error: float = math.nan
    proved: bool = False
    reason: str = ""

    def __str__(self) -> str:
        return points_text((self,))


Defect: TypeAlias = SingularCurve | SingularPoint


def curves_text(curves: Sequence[SingularCurve]) -> str:
    """Curves of one kind, between the same definitions, in a line.

    Examples
    --------
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
        return f" at {about(curves[0].points[0], curves[0].radius)}"
    if len(curves) == 1 and not curves[0].closed:
        return f" from {point(curves[0].points[0])} to {point(curves[0].points[-1])}"
    points = np.concatenate([curve.points for curve in curves])
    box = extents(points.min(axis=0), points.max(axis=0))
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
    >>> points_text([SingularPoint((0.0, 0.0, 1.0), 0.0, "cone tip", "G0", ("cone",), 90.0, 0.0, proved=True)])
    'cone tip of cone at (0, 0, 1): the normals differ by up to 90 degrees; G0, proved'
    """
    first = points[0]
    where = first_of([point(one.point) for one in points], PLACES, "other places")
    where += nearness(max(one.radius for one in points), *np.ravel([one.point for one in points]))
    status = f"{first.continuity}, {'proved' if first.proved else 'not proved'}"
    told = "; ".join(filter(None, [points_effect(points), status, *_reasons(points)]))
    return f"{counted(first.kind, len(points))}{of(first.names)} at {where}: {told}"


def points_effect(points: Sequence[SingularPoint]) -> str:
    """What the boundary is at the points."""
    worst = max(points, key=lambda one: -math.inf if math.isnan(one.tangent_jump) else one.tangent_jump)
    told = [PLAIN[worst.kind]] if worst.kind in PLAIN else []
    if worst.tangent_jump > 0:
        told.append(f"the normals differ by up to {measured(worst.tangent_jump, worst.tangent_jump_error)} degrees")
    return ", ".join(told)


def between(names: Sequence[str]) -> str:
    """The two definitions that meet.

    Examples
    --------
    >>> between(("roof", "boot")), between(("roof", "roof")), between(("", ""))
    (' between roof and boot', ' within roof', '')
    """
    known = list(dict.fromkeys(cut(name) for name in names if name))
    return f" between {' and '.join(known)}" if len(known) > 1 else f" within {known[0]}" if known else ""


def of(names: Sequence[str]) -> str:
    """The definitions that meet in a point.

    Examples
    --------
    >>> of(("roof", "boot", "side")), of(())
    (' of roof, boot and side', '')
    """
    known = list(dict.fromkeys(cut(name) for name in names if name))
    return f" of {listed(known)}" if known else ""


def cut(name: str) -> str:
    """A definition's name, or its formula as far as a line has room.

    Examples
    --------
    >>> cut("bonnet"), cut("x**2 + y**2 + z**2 - 2*x*y - 2*y*z - 2*z*x - x - y - z")
    ('bonnet', 'x**2 + y**2 + z**2 - 2*x*y - 2*y*z - 2*z*x -...')
    """
    return name if len(name) <= LONGEST else f"{name[: LONGEST - 3].rstrip()}..."


def counted(kind: str, count: int) -> str:
    """A kind of curve or point, with the count if there are several.

    Examples
    --------
    >>> counted("edge", 1), counted("edge", 12), counted("tangency", 2)
    ('edge', '12 edges', '2 tangencies')
    """
    return noun(kind, count) if count == 1 else f"{count} {noun(kind, count)}"


def noun(kind: str, count: int) -> str:
    """What one or several of a kind are called.

    Examples
    --------
    >>> noun("node", 1), noun("node", 2), noun("unresolved", 1)
    ('node', 'nodes', 'unresolved place')
    """
    return SINGLE.get(kind, kind) if count == 1 else SEVERAL.get(kind, f"{kind}s")


def kinds_text(found: Iterable[Any]) -> str:
    """How many curves or points there are of each kind.

    Examples
    --------
    >>> kinds_text([SingularPoint((0.0, 0.0, k), 0.0, kind, "G0") for k, kind in enumerate(("corner", "node", "node"))])
    '1 corner, 2 nodes'
    """
    counts = Counter(one.kind for one in found)
    return ", ".join(f"{count} {noun(kind, count)}" for kind, count in counts.items())
