"""What a check of smoothness answers: a verdict, the places that decide it, and what is proved."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rsym.reports.document import CERTIFIED, DEGENERATE, REFUTED, UNDECIDED, Document, Entry, Sentence
from rsym.reports.numbers import about, at_most, measured, number, point
from rsym.reports.render import Report, as_json
from rsym.reports.words import letters_text, plural, within

# From the weakest to the strongest: what can be said of a boundary at a point; "unknown" claims nothing at all.
CONTINUITIES: tuple[str, ...] = ("unknown", "broken", "G0", "G1", "G2", "G3", "analytic")
UNKNOWN, BROKEN = CONTINUITIES[:2]
G2 = CONTINUITIES.index("G2")
COLUMNS = ("place", "kind", "continuity", "turn", "curvatures", "proved")
PLAIN: Mapping[str, str] = {
    "cusp": "the boundary runs back on itself",
    "unbounded curvature": "the curvature grows without bound",
    "isolated point": "the boundary is a single point",
    "end": "the boundary ends",
    "no sign change": "omega is zero but does not change its sign",
    "unresolved": "what happens here is not resolved",
}


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


def level_of(place: Any) -> int:
    """The rank of a continuity: 0 for "unknown", 1 for "broken", 4 for "G2"."""
    return CONTINUITIES.index(place.continuity)


def is_defect(place: Any) -> bool:
    """Whether the boundary is below G2 at a place, if what is said of it holds."""
    return level_of(place) < G2


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
        reason = f"; {self.reason.rstrip('.')}" if self.reason else ""
        status = "proved" if self.proved else "not proved"
        where = about(self.point, self.radius)
        return f"{self.kind} at {where}: {self.effect}; {self.continuity}, {status}{reason}"

    @property
    def effect(self) -> str:
        """What one sees, walking through the place along the boundary."""
        if self.kind == "node":
            return f"{self.branches} branches of the boundary meet"
        if self.kind in PLAIN:
            return PLAIN[self.kind]
        if self.kind == "corner":
            turn = f"the tangent turns by {measured(self.tangent_jump, self.tangent_jump_error)} degrees"
            return f"{turn}, {self._sides}" if all(map(math.isfinite, self.curvatures)) else turn
        if self.kind == "curvature jump":
            jump = f"the curvature jumps by {measured(self.curvature_jump, self.curvature_jump_error)}"
            return f"{jump}, from {number(self.curvatures[0])} to {number(self.curvatures[1])}"
        if self.derivative_jump > 0:
            jump = measured(self.derivative_jump, self.derivative_jump_error)
            return f"the curvature is continuous, its derivative jumps by {jump}"
        return "two arcs meet, the curvature is continuous"

    @property
    def _sides(self) -> str:
        first, second = map(number, self.curvatures)
        return f"the curvature is {first} on both sides" if first == second else f"curvatures {first} and {second}"

    def entry(self, *, defect: bool, label: str | None) -> Entry:
        """The place in a report, with a number or a label."""
        turn = f"{measured(self.tangent_jump, self.tangent_jump_error)}°" if self.tangent_jump > 0 else ""
        sides = [number(value) for value in self.curvatures if not math.isnan(value)]
        seen = (point(self.point), self.kind, self.continuity, turn, " | ".join(sides), yes_or_no(self.proved))
        return Entry(str(self), self.proved, seen, defect, label)


@dataclass(frozen=True, eq=False)
class Cover:
    """The boxes that a proof is made of, each (n, dim, 2) as ((xmin, xmax), (ymin, ymax), ...).

    The boundary within `bounds` lies in `certified` (a regular curve or surface of the class proved), in `joined` (two
    pieces that meet in a joint or along a curve of the report), and in `undecided`.
    """

    bounds: tuple[tuple[float, float], ...]
    certified: NDArray[np.float64]
    joined: NDArray[np.float64]
    undecided: NDArray[np.float64]
    examined: int

    @property
    def boxes(self) -> dict[str, NDArray[np.float64]]:
        """The boxes by what is proved in them."""
        return {"certified": self.certified, "joined": self.joined, "undecided": self.undecided}

    @property
    def told(self) -> str:
        """How many boxes were examined."""
        return f"{plural(self.examined, 'box was', 'boxes were')} examined"

    @property
    def data(self) -> dict[str, Any]:
        """What programs read of the boxes: how many there are, and those in which nothing is proved."""
        return {
            "bounds": self.bounds,
            "boxes_examined": self.examined,
            "boxes_counted": {name: len(found) for name, found in self.boxes.items()},
            "boxes": {"undecided": self.undecided},
        }


class Verdict(Report):
    """What a check of smoothness answers, in the plane or in space."""

    verdict: str
    continuity: str
    cover: Cover
    letters: Mapping[str, tuple[float, float]]

    @property
    def undecided(self) -> NDArray[np.float64]:
        """The boxes in which nothing is proved."""
        return self.cover.undecided

    def to_json(self, *, boxes: bool = False) -> str:
        """The report for programs, null where a number is unknown or has no bound; `boxes` lists all of the proof."""
        return as_json(self.document(), **({"boxes": self.cover.boxes} if boxes else {}))

    def headline(self, what: str, expected: str, *, doubt: bool) -> Sentence:
        """The verdict on what should be such a curve or surface, with which letters, and whether it is proved."""
        letters = letters_text(self.letters, "some" if self.verdict in {REFUTED, DEGENERATE} else "every")
        subject = within(what, self.cover.bounds, letters)
        best = "at best " if doubt or len(self.undecided) else ""
        answers = {
            CERTIFIED: f"{subject} is {self.continuity}; this is proved",
            REFUTED: f"{subject} is not G2 but {best}{self.continuity}; this is proved",
            DEGENERATE: f"{subject} is no {expected}, or not everywhere",
        }
        undecided = f"whether {subject} is G2 is neither proved nor refuted"
        return Sentence(
            f"{self.verdict}: {answers.get(self.verdict, undecided)}.", self.verdict in {CERTIFIED, REFUTED}
        )


@dataclass(frozen=True, eq=False, repr=False)
class SmoothnessReport(Verdict):
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

    def __repr__(self) -> str:
        return f"<SmoothnessReport {self.verdict}, {self.continuity}, {len(self.defects)} defects>"

    def document(self) -> Document:
        """All that the report says."""
        what = "the surface of revolution with the meridian" if self.body else "the boundary"
        entries = [joint.entry(defect=True, label=None) for joint in self.defects]
        entries += [joint.entry(defect=False, label="also") for joint in self.joints]
        data = {
            "body_of_revolution": self.body,
            "letters": self.letters,
            "curvature_bound": self.curvature_bound,
            "defects": self.defects,
            "joints": self.joints,
            **self.cover.data,
        }
        return Document(
            "smoothness-report",
            self.headline(what, "curve", doubt=not all(defect.proved for defect in self.defects)),
            self.verdict,
            self.continuity,
            sentences=(Sentence(self._cover_text(), True),),
            statements=tuple(Sentence(*statement) for statement in self.statements),
            entries=tuple(entries),
            columns=COLUMNS,
            data=data,
        )

    def _cover_text(self) -> str:
        """How many boxes were examined, and what they say of the curvature."""
        if not (math.isfinite(self.curvature_bound) and len(self.cover.certified)):
            return f"{self.cover.told}."
        bound = at_most(self.curvature_bound)
        return f"{self.cover.told}; where they prove the boundary regular, no curvature exceeds {bound}."


def yes_or_no(proved: bool) -> str:
    """A cell of a table."""
    return "✓ yes" if proved else "✗ no"
