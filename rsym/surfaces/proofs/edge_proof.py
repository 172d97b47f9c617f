"""What is proved of a common edge: equal, equal within a bound, different, or nothing."""

from __future__ import annotations

import math
from dataclasses import dataclass

from rsym.reports.document import DEGENERATE
from rsym.reports.numbers import at_least, at_most, number
from rsym.reports.words import box_text

# What may be proved of each of G0, G1, G2, from the strongest.
EQUAL, WITHIN, DIFFERENT, NUMERICAL = "equal", "within", "different", "numerical"
LEVELS = ("G0", "G1", "G2")
# What each level is about, and its unit.
AMOUNTS = {"G0": ("the gap", ""), "G1": ("the angle", " degrees"), "G2": ("the jump of curvature", "")}


@dataclass(frozen=True)
class Level:
    """What is proved of the gap (G0), the angle in degrees (G1) or the jump of the normal curvature (G2).

    status : "equal", the difference vanishes identically, by exact arithmetic; "within", it is at most `most` all along
    the edge, and `room` is not exceeded; "different", it is at least `least`, more than `room`, at the parameter
    `place` of the first edge; "numerical", nothing is proved.

    Examples
    --------
    >>> Level("G1", "within", most=2e-13, room=1e-9).holds
    True
    """

    name: str
    status: str = NUMERICAL
    most: float = math.inf
    least: float = 0.0
    place: float = math.nan
    room: float = 0.0

    @property
    def holds(self) -> bool:
        """Whether it is proved."""
        return self.status in (EQUAL, WITHIN)

    def __str__(self) -> str:
        what, unit = AMOUNTS[self.name]
        if self.status == EQUAL:
            return f"{what} is 0"
        if self.status == WITHIN:
            return f"{what} is at most {at_most(self.most)}{unit}"
        return f"{what} is at least {at_least(self.least)}{unit} at t = {number(self.place)}"


@dataclass(frozen=True)
class EdgeProof:
    """What is proved of a common edge: `levels` of the gap, the angle and the jump of curvature.

    verdict : "CERTIFIED", it is G2, each level equal or within its room; "REFUTED", it is not, at a place;
    "DEGENERATE", a patch ends there in an edge of regression, with unbounded curvature; "UNDECIDED".
    open : intervals of the parameter of the first edge of which nothing is said, as beside a pole where the normals
    fade. removed : ends, poles of a patch, where the proof is one of the normals over their distance to it.
    reason : what kept it from being proved.

    Examples
    --------
    >>> within = [Level(name, "equal", most=0.0) for name in ("G0", "G1", "G2")]
    >>> EdgeProof("CERTIFIED", tuple(within)).proved
    'G2'
    >>> equal, within = Level("G0", EQUAL, most=0.0), Level("G1", WITHIN, most=2.1e-13)
    >>> print(EdgeProof("REFUTED", (equal, within, Level("G2", DIFFERENT, least=2.0, place=0.5))))
    proved: the gap is 0; the angle is at most 2.1e-13 degrees; the jump of curvature is at least 2 at t = 0.5
    """

    verdict: str
    levels: tuple[Level, Level, Level]
    open: tuple[tuple[float, float], ...] = ()
    removed: tuple[float, ...] = ()
    reason: str = ""

    @property
    def proved(self) -> str | None:
        """The highest class that is proved all along the edge, up to `open`."""
        held = [one.holds for one in self.levels]
        return ([None, *LEVELS])[[*held, False].index(False)]

    @property
    def at_most(self) -> str | None:
        """The highest class that what is refuted leaves, "broken" without any; None where nothing is refuted.

        An edge of regression has unbounded curvature, though a tangent plane all along.
        """
        if self.verdict == DEGENERATE:
            return LEVELS[1]
        wrong = [place for place, one in enumerate(self.levels) if one.status == DIFFERENT]
        return ("broken", *LEVELS)[wrong[0]] if wrong else None

    @property
    def place(self) -> float:
        """The parameter of the first edge where the lowest level is refuted; NaN where none is."""
        return next((one.place for one in self.levels if one.status == DIFFERENT), math.nan)

    @property
    def exact(self) -> bool:
        """Whether all differences vanish identically."""
        return all(one.status == EQUAL for one in self.levels)

    def __str__(self) -> str:
        said = [str(one) for one in self.levels if one.holds or one.status == DIFFERENT]
        text = f"proved: {'; '.join(said)}" if said else "not proved"
        if self.open:
            text += f", but for t in {' and '.join(box_text([part]) for part in self.open)}"
        if self.removed:
            text += f", at t = {' and '.join(map(number, self.removed))} of the normals over the distance to the pole"
        return f"{text}; {self.reason}" if self.reason else text


def nothing(reason: str) -> EdgeProof:
    """No proof, and why.

    Examples
    --------
    >>> nothing("a function of Python").levels[0].status
    'numerical'
    """
    levels = Level("G0"), Level("G1"), Level("G2")
    return EdgeProof("UNDECIDED", levels, reason=reason)
