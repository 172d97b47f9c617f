"""What a check of smoothness answers: a verdict, the places that decide it, and what is proved."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from rsym.verify.markup import report_html
from rsym.verify.records import report_json
from rsym.verify.wording import joint_text, report_text

CERTIFIED, REFUTED, DEGENERATE, UNDECIDED = "CERTIFIED", "REFUTED", "DEGENERATE", "UNDECIDED"

# From the weakest to the strongest: what can be said of a boundary at a point; "unknown" claims nothing at all.
CONTINUITIES: tuple[str, ...] = ("unknown", "broken", "G0", "G1", "G2", "G3", "analytic")
UNKNOWN, BROKEN = CONTINUITIES[:2]


def continuity_of(verdict: str, levels: Iterable[int], order: float) -> str:
    """What a report says of the whole boundary: nothing if undecided, else the least of what was found.

    `levels` are the ranks of the places that count. `order` is the least order of contact on the pieces between them:
    they are of class C^j for all j < order, and no more than G3 is claimed of one that is finite.

    Examples
    --------
    >>> continuity_of(CERTIFIED, [CONTINUITIES.index("G3")], 2.5), continuity_of(UNDECIDED, [], math.inf)
    ('G2', 'unknown')
    """
    if verdict in {UNDECIDED, DEGENERATE}:
        return UNKNOWN if verdict == UNDECIDED else BROKEN
    best = CONTINUITIES.index("analytic" if math.isinf(order) else "G3")
    own = best if math.isinf(order) else min(CONTINUITIES.index(BROKEN) + math.ceil(order), best)
    return CONTINUITIES[min([own, *levels])]


@dataclass(frozen=True)
class Joint:
    """A place where the boundary is less than analytic: two arcs meet, or it is no curve at all.

    point is within `radius` of the truth. kind: "corner", "cusp", "curvature jump", "smooth joint",
    "unbounded curvature", "node", "isolated point", "end", "no sign change" or "unresolved".
    tangent_jump is the turn of the tangent in degrees, curvatures the one-sided values along the boundary with
    the inside on the left, curvature_jump the size of their difference, derivative_jump that of their derivatives
    with respect to arc length; errors bound or, where `proved` is false, estimate what may be wrong with them.
    What is not known is NaN.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> box = ((-2, 2), (-2, 2))
    >>> (joint,) = rsym.verify_smoothness(rsym.Shape(y - x * abs(x), (x, y), bounds=box)).defects
    >>> joint.kind, joint.continuity, round(joint.curvature_jump, 9), joint.proved
    ('curvature jump', 'G1', 4.0, True)
    """

    point: tuple[float, ...]
    radius: float
    kind: str
    continuity: str
    branches: int = 2
    tangent_jump: float = math.nan
    tangent_jump_error: float = math.nan
    curvatures: tuple[float, float] = (math.nan, math.nan)
    curvature_jump: float = math.nan
    curvature_jump_error: float = math.nan
    derivative_jump: float = math.nan
    derivative_jump_error: float = math.nan
    proved: bool = False
    reason: str = ""

    def __str__(self) -> str:
        return joint_text(self)


@dataclass(frozen=True, eq=False)
class Cover:
    """The boxes that a proof is made of, each (n, 2, 2) as ((xmin, xmax), (ymin, ymax)).

    The boundary within `bounds` lies in `certified` (a regular curve of the class proved), in `joined` (two arcs
    that meet in one point of `SmoothnessReport.joints`), and in `undecided`.
    """

    bounds: tuple[tuple[float, float], ...]
    certified: NDArray[np.float64]
    joined: NDArray[np.float64]
    undecided: NDArray[np.float64]
    examined: int


@dataclass(frozen=True, eq=False, repr=False)
class SmoothnessReport:
    """The answer to the question whether the curvature of the boundary is continuous (G2).

    verdict : "CERTIFIED", proved; "REFUTED", the contrary is proved at `defects`; "DEGENERATE", there is no curve to
        speak of (no boundary, no sign change, a node, an isolated point); "UNDECIDED", neither proved.
    continuity : what the boundary is everywhere: "G0", "G1", "G2", "G3" or "analytic". It is proved to be no less if
        the verdict is CERTIFIED, and no more if it is REFUTED. "broken" if DEGENERATE, "unknown" if UNDECIDED.
    defects : joints below G2, the proved ones first, of these the worst; joints: those that are G2 or better.
    curvature_bound : no curvature on the certified boxes is larger in size; infinite where there is no bound.
    statements : sentences, each with whether it is proved.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> report = rsym.verify_smoothness(rsym.Shape(1 - abs(x) - y, (x, y), bounds=((-2, 2), (-2, 2))))
    >>> report.verdict, report.defects[0].kind, report.defects[0].point
    ('REFUTED', 'corner', (0.0, 1.0))
    """

    verdict: str
    continuity: str
    defects: tuple[Joint, ...]
    joints: tuple[Joint, ...]
    curvature_bound: float
    cover: Cover
    letters: Mapping[str, tuple[float, float]]
    statements: tuple[tuple[str, bool], ...] = field(default=())
    body: bool = False

    @property
    def undecided(self) -> NDArray[np.float64]:
        """The boxes in which nothing is proved."""
        return self.cover.undecided

    def __str__(self) -> str:
        return report_text(self)

    def __repr__(self) -> str:
        return f"<SmoothnessReport {self.verdict}, {self.continuity}, {len(self.defects)} defects>"

    def to_json(self, *, boxes: bool = False) -> str:
        """The report for programs: JSON with stable keys, null where a number is unknown or has no bound."""
        return report_json(self, boxes=boxes)

    def _repr_html_(self) -> str:
        return report_html(self)
