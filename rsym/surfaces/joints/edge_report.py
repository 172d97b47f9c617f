"""What is found where patches meet: common edges, poles, free edges, and how smooth they are."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from rsym.reports.document import CERTIFIED, DEGENERATE, REFUTED, UNDECIDED
from rsym.surfaces.joints.edge_wording import report_html, report_text
from rsym.surfaces.proofs.edge_proof import EdgeProof

Array = NDArray[np.float64]

# From the weakest to the strongest; the words are those of `verify_smoothness`.
CONTINUITIES: tuple[str, ...] = ("broken", "G0", "G1", "G2")


@dataclass(frozen=True)
class Extreme:
    """The greatest value found, how much it still moved with more samples, and where it is.

    parameters: (u, v) on each of the patches that are compared. NaN where nothing is known.

    Examples
    --------
    >>> Extreme(0.5, 0.0, (1.0, 0.0, 0.0), ((1.0, 0.5), (0.0, 0.5))).at_most
    0.5
    """

    value: float
    error: float
    point: tuple[float, ...]
    parameters: tuple[tuple[float, float], ...]

    @property
    def at_most(self) -> float:
        """The value and its error."""
        return self.value + self.error


@dataclass(frozen=True)
class Tolerances:
    """What counts as none: a gap (length), a kink (degrees), a jump of the curvature (one over length).

    Examples
    --------
    >>> place = ((1.0, 0.0, 0.0), ((1.0, 0.5), (0.0, 0.5)))
    >>> none, kink = Extreme(0.0, 0.0, *place), Extreme(1e-3, 0.0, *place)
    >>> Tolerances(1e-7, 1e-4, 1e-4).continuity(none, kink, none)
    'G0'
    """

    gap: float
    angle: float
    curvature: float

    def continuity(self, gap: Extreme, angle: Extreme, curvature_jump: Extreme) -> str:
        """The class that these greatest values leave; what is not known counts against it."""
        measured = (gap.at_most, angle.at_most, curvature_jump.at_most)
        held = [value <= room for value, room in zip(measured, (self.gap, self.angle, self.curvature), strict=True)]
        return CONTINUITIES[[*held, False].index(False)]


@dataclass(frozen=True)
class Greatest:
    """The greatest gap, angle and jump of curvature, and what of each counts as none."""

    gap: Extreme
    angle: Extreme
    curvature_jump: Extreme
    tolerances: Tolerances


@dataclass(frozen=True)
class Meeting:
    """A place where patches meet; `patches` are their places in the list given, `edges` the names of their edges.

    gap (length), angle (degrees, between the normals) and curvature_jump (one over length) are the greatest found.
    continuity: "broken" (apart), "G0", "G1" or "G2" within the tolerances. undefined: samples without a normal.
    proof: what is proved of it, if a proof was asked for.
    """

    patches: tuple[int, ...]
    edges: tuple[str, ...]
    greatest: Greatest
    undefined: int
    proof: EdgeProof | None = field(default=None, kw_only=True)

    @property
    def verdict(self) -> str:
        """CERTIFIED, REFUTED, DEGENERATE or UNDECIDED: whether it is proved to be G2."""
        return UNDECIDED if self.proof is None else self.proof.verdict

    @property
    def proved(self) -> str | None:
        """The highest class that is proved."""
        return None if self.proof is None else self.proof.proved

    @property
    def gap(self) -> Extreme:
        """The greatest distance."""
        return self.greatest.gap

    @property
    def angle(self) -> Extreme:
        """The greatest angle between the normals, in degrees."""
        return self.greatest.angle

    @property
    def curvature_jump(self) -> Extreme:
        """The greatest difference of normal curvatures."""
        return self.greatest.curvature_jump

    @property
    def tolerances(self) -> Tolerances:
        """What counts as none."""
        return self.greatest.tolerances

    @property
    def continuity(self) -> str:
        """The class within the tolerances."""
        return self.tolerances.continuity(self.gap, self.angle, self.curvature_jump)

    @property
    def worst(self) -> Extreme:
        """That which keeps the place from being smoother; the jump of curvature of what is G2."""
        return (self.gap, self.angle, self.curvature_jump, self.curvature_jump)[CONTINUITIES.index(self.continuity)]


@dataclass(frozen=True, eq=False)
class CommonEdge(Meeting):
    """A stretch on which two edges run together.

    intervals : of the parameter along each edge; the second is (high, low) if it runs against the first.
    flipped : the normals of the two patches point to different sides.
    points (n, 3), gaps, angles, curvature_jumps (n,), parameters (n, 2, 2) as (u, v) on both : along the stretch.
    """

    intervals: tuple[tuple[float, float], tuple[float, float]]
    flipped: bool
    points: Array = field(repr=False)
    gaps: Array = field(repr=False)
    angles: Array = field(repr=False)
    curvature_jumps: Array = field(repr=False)
    parameters: Array = field(repr=False)

    @property
    def classes(self) -> tuple[str, ...]:
        """The class at each of the points; where the curvatures are unknown no more than G1."""
        room = self.tolerances
        pairs = ((self.gaps, room.gap), (self.angles, room.angle), (self.curvature_jumps, room.curvature))
        held = np.cumprod([values <= tolerated for values, tolerated in pairs], axis=0).sum(axis=0)
        return tuple(CONTINUITIES[count] for count in held)


@dataclass(frozen=True, eq=False)
class Pole(Meeting):
    """A point to which whole edges shrink; the curvatures of all patches are compared in all directions."""

    point: tuple[float, ...]


@dataclass(frozen=True, eq=False)
class FreeEdge:
    """A stretch of an edge that joins nothing: points (n, 3) along it."""

    patch: int
    edge: str
    interval: tuple[float, float]
    points: Array = field(repr=False)


@dataclass(frozen=True, eq=False, repr=False)
class EdgeReport:
    """Where patches meet and how smoothly: common edges and poles, the worst first, then what is free.

    `continuity` is numerical, decided by samples with the errors told; `verdict` is proved, if proofs were asked for.

    Examples
    --------
    >>> from rsym.surfaces import continuity_report, sphere
    >>> report = continuity_report(sphere(1)[:2])
    >>> report.continuity, len(report.edges), len(report.poles), len(report.free)
    ('G2', 1, 2, 4)
    """

    edges: tuple[CommonEdge, ...]
    poles: tuple[Pole, ...]
    free: tuple[FreeEdge, ...]
    patches: int
    size: float

    @property
    def meetings(self) -> tuple[Meeting, ...]:
        """Edges and poles, the worst first."""
        return tuple(sorted((*self.edges, *self.poles), key=badness))

    @property
    def continuity(self) -> str | None:
        """The lowest class of all; None if nothing meets."""
        return min((one.continuity for one in self.meetings), key=CONTINUITIES.index, default=None)

    @property
    def verdict(self) -> str | None:
        """CERTIFIED, every edge and pole is proved G2; REFUTED, one is proved not to be; DEGENERATE; or UNDECIDED.

        None if nothing meets, or no proof was asked for.
        """
        found = {one.verdict for one in self.meetings}
        asked = any(one.proof is not None for one in self.meetings)
        return (
            next((one for one in (REFUTED, DEGENERATE, UNDECIDED, CERTIFIED) if one in found), None) if asked else None
        )

    @property
    def proved(self) -> str | None:
        """The highest class that is proved of every edge and pole; None if there is none."""
        held = [one.proved for one in self.meetings]
        return None if None in held else min((one for one in held if one), key=CONTINUITIES.index, default=None)

    @property
    def defects(self) -> tuple[Meeting, ...]:
        """What is less smooth than G2, the worst first."""
        return tuple(one for one in self.meetings if one.continuity != "G2")

    def __str__(self) -> str:
        return report_text(self)

    def __repr__(self) -> str:
        counts = f"{len(self.edges)} edges, {len(self.poles)} poles, {len(self.free)} free"
        return f"<EdgeReport {self.continuity}: {counts}>"

    def _repr_html_(self) -> str:
        return report_html(self)


def is_settled(meeting: Meeting) -> bool:
    """Whether the class that samples show is proved: all of it, and that it is no more if it is less than G2."""
    held = meeting.proved or "broken"
    return held == meeting.continuity and meeting.verdict == (CERTIFIED if held == "G2" else REFUTED)


def badness(meeting: Meeting) -> tuple[int, float]:
    """A key that sorts the worst first: the class, then by how many tolerances it is missed."""
    place = CONTINUITIES.index(meeting.continuity)
    room = (meeting.tolerances.gap, meeting.tolerances.angle, meeting.tolerances.curvature)[min(place, 2)]
    value = meeting.worst.value
    return place, -math.inf if math.isnan(value) else -value / room


def extreme(values: Array, errors: float, points: Array, parameters: Sequence[Sequence[Array]]) -> Extreme:
    """The greatest of some values; parameters: for each patch its u and its v, one for each value."""
    known = np.where(np.isfinite(values), values, -1.0)
    place = int(np.argmax(known))
    pairs = tuple((float(u[place]), float(v[place])) for u, v in parameters)
    value = float(known[place]) if known[place] >= 0 else math.nan
    return Extreme(value, float(errors), tuple(map(float, points[place])), pairs)
