"""What a check of a body answers: a verdict, the curves and points that decide it, and what is proved."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from rsym.verify.account import is_defect
from rsym.verify.bodies.markup import body_html
from rsym.verify.bodies.records import body_json
from rsym.verify.bodies.wording import body_text, curves_text, points_text

Array: TypeAlias = NDArray[np.float64]


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

    points: Array
    radius: float
    kind: str
    continuity: str
    names: tuple[str, str]
    normals: Array
    tangent_jumps: Array
    curvature_jumps: Array
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
    def dihedral_angles(self) -> Array:
        """The angles between the two sheets at the points, measured through the inside, in degrees: 180 is flat."""
        angles: Array = np.where(self.convex, 180 - self.tangent_jumps, 180 + self.tangent_jumps)
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

    point: tuple[float, float, float]
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


@dataclass(frozen=True, eq=False)
class BodyCover:
    """The boxes that a proof is made of, each (n, 3, 2): the boundary within `bounds` lies in them.

    certified: a regular surface of the class proved; joined: two analytic sheets that meet along a curve of the
    report, or three in a corner; undecided: nothing is proved.

    Examples
    --------
    >>> import rsym
    >>> cover = rsym.verify_smoothness(rsym.sphere(), method="space").cover
    >>> cover.certified.shape[1:], len(cover.undecided), cover.undecided_share
    ((3, 2), 0, 0.0)
    """

    bounds: tuple[tuple[float, float], ...]
    certified: Array
    joined: Array
    undecided: Array
    examined: int

    @property
    def undecided_share(self) -> float:
        """The share of the boundary that is undecided, each box counted by the area of its side."""
        areas = [float(np.square(_widths(boxes)).sum()) for boxes in (self.undecided, self.certified, self.joined)]
        return areas[0] / sum(areas) if areas[0] else 0.0


def _widths(boxes: Array) -> Array:
    widths: Array = (boxes[..., 1] - boxes[..., 0]).max(axis=1, initial=0)
    return widths


@dataclass(frozen=True, eq=False, repr=False)
class BodyReport:
    """The answer to the question whether the curvature of the boundary of a body is continuous (G2).

    Attributes
    ----------
    verdict : str
        "CERTIFIED", proved; "REFUTED", the contrary is proved at `defects`; "DEGENERATE", there is no surface to speak
        of at some point (a node, no change of sign, no boundary); "UNDECIDED", neither proved.
    continuity : str
        What the boundary is everywhere, a word of ``CONTINUITIES``; proved to be no less if CERTIFIED, no more if
        REFUTED. "broken" if DEGENERATE, "unknown" if UNDECIDED.
    curves, points
        All that is singular: the proved ones first, of these the worst.
    curvatures : (low, high)
        No principal curvature on the certified boxes lies outside; infinite where there is no bound.
    attained : (low, high)
        The least and the largest principal curvature found at points of the boundary, which `curvatures` encloses;
        NaN where none was sought.
    statements : pairs
        Sentences, each with whether it is proved.

    Examples
    --------
    >>> import rsym
    >>> report = rsym.verify_smoothness(rsym.box(1, 1, 1))
    >>> report.verdict, report.continuity, len(report.curves), len(report.points)
    ('REFUTED', 'G0', 12, 8)
    """

    verdict: str
    continuity: str
    curves: tuple[SingularCurve, ...]
    points: tuple[SingularPoint, ...]
    curvatures: tuple[float, float]
    attained: tuple[float, float]
    cover: BodyCover
    letters: Mapping[str, tuple[float, float]]
    statements: tuple[tuple[str, bool], ...] = field(default=())

    @property
    def defects(self) -> tuple[Defect, ...]:
        """The curves and points below G2."""
        everything: tuple[Defect, ...] = (*self.curves, *self.points)
        return tuple(one for one in everything if is_defect(one))

    @property
    def curvature_bound(self) -> float:
        """No principal curvature on the certified boxes is larger in size."""
        return max(abs(end) for end in self.curvatures)

    @property
    def undecided(self) -> Array:
        """The boxes in which nothing is proved."""
        return self.cover.undecided

    @property
    def undecided_share(self) -> float:
        """The share of the boundary that is undecided, by area."""
        return self.cover.undecided_share

    def __str__(self) -> str:
        return body_text(self)

    def __repr__(self) -> str:
        found = f"{len(self.curves)} curves, {len(self.points)} points"
        return f"<BodyReport {self.verdict}, {self.continuity}, {found}>"

    def to_json(self, *, boxes: bool = False) -> str:
        """The report for programs: JSON with stable keys, null where a number is unknown or has no bound."""
        return body_json(self, boxes=boxes)

    def _repr_html_(self) -> str:
        return body_html(self)
