"""What is found where patches meet: common edges, poles, free edges, and how smooth they are."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from rsym.arrays import Floats
from rsym.reports.document import CERTIFIED, DEGENERATE, REFUTED, UNDECIDED, Document, Entry, Sentence
from rsym.reports.numbers import at_most, measured, number, point
from rsym.reports.render import Report, plain
from rsym.reports.words import first_of, plural
from rsym.surfaces.proofs.edge_proof import EdgeProof

# From the weakest to the strongest; the words are those of `verify_smoothness`.
CONTINUITIES: tuple[str, ...] = ("broken", "G0", "G1", "G2")
SMOOTH_INSIDE = "Inside, all patches are twice differentiable; their normals are not examined."
NUMERICAL = "Numerical: decided by samples, not proved"
COLUMNS = ("patches", "class", "gap", "angle", "curvature jump", "worst at", "parameters")
# Lines and names beyond these are counted, not shown: the report has them all.
LINES, NAMES = 20, 12
# Digits of a place that a reader looks up; the report has them all.
DIGITS = 6


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

    def told(self, room: float) -> str:
        """The value with its error; in two digits where it is far below what counts."""
        if math.isnan(self.value):
            return "unknown"
        if self.at_most < 1e-2 * room:
            return f"{self.value:.1e}" if self.value else "0"
        exact = self.error < 10.0**-DIGITS * self.value
        return number(self.value, DIGITS) if exact else measured(self.value, self.error)

    @property
    def where(self) -> str:
        """The parameters on all patches."""
        return f"(u, v) = {' and '.join(point(pair, DIGITS) for pair in self.parameters)}"


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
class PatchMeeting:
    """A place where patches meet; `patches` are their places in the list given, `edges` the names of their edges.

    gap (length), angle (degrees, between the normals) and curvature_jump (one over length) are the greatest found.
    continuity: "broken" (apart), "G0", "G1" or "G2" within the tolerances, or what is refuted leaves. undefined:
    samples without a normal. proof: what is proved of it, if a proof was asked for.
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
        """The class within the tolerances, or what a proof leaves of it, if that is less."""
        found = self.tolerances.continuity(self.gap, self.angle, self.curvature_jump)
        most = None if self.proof is None else self.proof.at_most
        return found if most is None else min(found, most, key=CONTINUITIES.index)

    @property
    def worst(self) -> Extreme:
        """That which keeps the place from being smoother; the jump of curvature of what is G2."""
        return (self.gap, self.angle, self.curvature_jump, self.curvature_jump)[CONTINUITIES.index(self.continuity)]

    @property
    def title(self) -> str:
        """Which edges meet."""
        return " - ".join(self._sides)

    @property
    def _sides(self) -> list[str]:
        return [f"{index} {edge}" for index, edge in zip(self.patches, self.edges, strict=True)]

    @property
    def remarks(self) -> list[str]:
        """What else there is to say."""
        flipped = ["normals to different sides"] if getattr(self, "flipped", False) else []
        undefined = [f"{plural(self.undefined, 'sample')} without a normal"] if self.undefined else []
        return [*undefined, *flipped, *([str(self.proof)] if self.proof else [])]

    def __str__(self) -> str:
        jump = self.curvature_jump.told(self.tolerances.curvature)
        effect = {
            "broken": f"gap {self.gap.told(self.tolerances.gap)}",
            "G0": f"the normals differ by {self.angle.told(self.tolerances.angle)} degrees",
            "G1": f"the curvature across jumps by {jump}",
            "G2": f"curvature continuous within {jump}",
        }[self.continuity]
        if math.isnan(self.worst.value):
            effect = f"nothing is known of the {'normals' if self.continuity == 'G0' else 'curvatures'}"
        at = f"worst at {point(self.worst.point, DIGITS)}, {self.worst.where}"
        return "; ".join([f"{self.title}: {self.continuity}", effect, at, *self.remarks])

    def entry(self, *, asked: bool) -> Entry:
        """The place in a report; asked: whether proofs were asked for."""
        amounts = (
            self.gap.told(self.tolerances.gap),
            f"{self.angle.told(self.tolerances.angle)}°",
            self.curvature_jump.told(self.tolerances.curvature),
        )
        row = self.title, self.continuity, *amounts, point(self.worst.point, DIGITS), self.worst.where
        proof = (f"{self.verdict}: {self.proof}" if self.proof else "",) if asked else ()
        defect = self.continuity != "G2"
        return Entry(str(self), is_settled(self), (*row, *proof), defect, told=defect)

    @property
    def data(self) -> dict[str, Any]:
        """What programs read of it."""
        greatest = {name: plain(getattr(self, name)) for name in ("gap", "angle", "curvature_jump", "tolerances")}
        known = {"patches": self.patches, "edges": self.edges, "continuity": self.continuity, **greatest}
        return {**known, "verdict": self.verdict, "proved": self.proved, "proof": self.proof}


@dataclass(frozen=True, eq=False)
class CommonEdge(PatchMeeting):
    """A stretch on which two edges run together.

    intervals : of the parameter along each edge; the second is (high, low) if it runs against the first.
    flipped : the normals of the two patches point to different sides.
    points (n, 3), gaps, angles, curvature_jumps (n,), parameters (n, 2, 2) as (u, v) on both : along the stretch.
    """

    intervals: tuple[tuple[float, float], tuple[float, float]]
    flipped: bool
    points: Floats = field(repr=False)
    gaps: Floats = field(repr=False)
    angles: Floats = field(repr=False)
    curvature_jumps: Floats = field(repr=False)
    parameters: Floats = field(repr=False)

    @property
    def classes(self) -> tuple[str, ...]:
        """The class at each point: G1 at most where curvatures are unknown; what is refuted counts at one."""
        room = self.tolerances
        pairs = ((self.gaps, room.gap), (self.angles, room.angle), (self.curvature_jumps, room.curvature))
        held = np.cumprod([values <= tolerated for values, tolerated in pairs], axis=0).sum(axis=0)
        classes = [CONTINUITIES[count] for count in held]
        if self.proof is not None and (most := self.proof.at_most) is not None and not math.isnan(self.proof.place):
            along = self.parameters[:, 0, 1 if self.edges[0][0] == "u" else 0]
            nearest = int(np.argmin(np.abs(along - self.proof.place)))
            classes[nearest] = min(classes[nearest], most, key=CONTINUITIES.index)
        return tuple(classes)


@dataclass(frozen=True, eq=False)
class Pole(PatchMeeting):
    """A point to which whole edges shrink; the curvatures of all patches are compared in all directions."""

    point: tuple[float, ...]

    @property
    def title(self) -> str:
        """Which edges shrink to it."""
        return f"pole of {', '.join(self._sides)}"


@dataclass(frozen=True, eq=False)
class FreeEdge:
    """A stretch of an edge that joins nothing: points (n, 3) along it."""

    patch: int
    edge: str
    interval: tuple[float, float]
    points: Floats = field(repr=False)


@dataclass(frozen=True, eq=False, repr=False)
class EdgeReport(Report):
    """Where patches meet and how smoothly: common edges and poles, the worst first, then what is free.

    `continuity` is numerical, decided by samples with the errors told, unless a proof leaves less; `verdict` is proved,
    if proofs were asked for. `doubts`: of each patch why it is not proved smooth between its edges, empty where it is.

    Examples
    --------
    >>> from rsym.surfaces import continuity_report, sphere
    >>> report = continuity_report(sphere(1)[:2])
    >>> report.continuity, len(report.edges), len(report.poles), len(report.free)
    ('G2', 1, 2, 4)
    >>> from rsym.surfaces import torus
    >>> continuity_report(torus(3, 1)[:2], prove=True).document().sentences[-1].text
    'Proofs: CERTIFIED (1 of 1 edge CERTIFIED, 1 exactly).'
    """

    edges: tuple[CommonEdge, ...]
    poles: tuple[Pole, ...]
    free: tuple[FreeEdge, ...]
    patches: int
    size: float
    doubts: tuple[str, ...] = ()

    @property
    def meetings(self) -> tuple[PatchMeeting, ...]:
        """Edges and poles, the worst first."""
        return tuple(sorted((*self.edges, *self.poles), key=badness))

    @property
    def continuity(self) -> str | None:
        """The lowest class of all; None if nothing meets."""
        return min((one.continuity for one in self.meetings), key=CONTINUITIES.index, default=None)

    @property
    def verdict(self) -> str | None:
        """CERTIFIED: all is proved G2, and inside no pieces meet; REFUTED: a place is not; DEGENERATE; or UNDECIDED.

        None if nothing meets, or no proof was asked for.
        """
        found = {one.verdict for one in self.meetings} | ({UNDECIDED} if any(self.doubts) else set())
        asked = any(one.proof is not None for one in self.meetings)
        return next((one for one in (REFUTED, DEGENERATE, UNDECIDED, CERTIFIED) if asked and one in found), None)

    @property
    def proved(self) -> str | None:
        """The highest class that is proved of every edge and pole; None if there is none."""
        held = [one.proved for one in self.meetings]
        return None if None in held else min((one for one in held if one), key=CONTINUITIES.index, default=None)

    @property
    def defects(self) -> tuple[PatchMeeting, ...]:
        """What is less smooth than G2, the worst first."""
        return tuple(one for one in self.meetings if one.continuity != "G2")

    def __repr__(self) -> str:
        counts = f"{len(self.edges)} edges, {len(self.poles)} poles, {len(self.free)} free"
        return f"<EdgeReport {self.continuity}: {counts}>"

    def document(self) -> Document:
        """All that the report says."""
        asked = self.verdict is not None
        headline, *sentences = self._sentences()
        free = [{"patch": one.patch, "edge": one.edge, "interval": one.interval} for one in self.free]
        return Document(
            "edge-report",
            headline,
            self.verdict,
            self.continuity,
            sentences=tuple(sentences),
            entries=tuple(one.entry(asked=asked) for one in self.meetings),
            columns=(*COLUMNS, *(["proof"] if asked else [])),
            most=LINES,
            data={
                "patches": self.patches,
                "size": self.size,
                "proved": self.proved,
                "doubts": self.doubts,
                "edges": [one.data for one in self.edges],
                "poles": [one.data for one in self.poles],
                "free": free,
            },
        )

    def _sentences(self) -> Iterator[Sentence]:
        patches = plural(self.patches, "patch", "patches")
        if self.continuity is None:
            yield Sentence(f"{patches}: nothing meets.", False)
        else:
            kinds = Counter(one.continuity for one in self.meetings)
            classes = ", ".join(f"{kinds[name]} {name}" for name in CONTINUITIES if kinds[name])
            poles = f" and {plural(len(self.poles), 'pole')}" if self.poles else ""
            edges = plural(len(self.edges), "common edge")
            yield Sentence(f"{patches}, {edges}{poles}: {self.continuity} ({classes}).", False)
            smooth = [one for one in self.meetings if one.continuity == "G2"]
            if smooth:
                names = ("gap", "angle", "curvature_jump")
                gap, angle, jump = (at_most(max(getattr(one, name).at_most for one in smooth), 2) for name in names)
                most = f"gaps are at most {gap}, angles {angle} degrees, jumps of curvature {jump}"
                yield Sentence(f"Where G2, {most}.", False)
        free = [f"{one.patch} {one.edge}" for one in self.free]
        yield Sentence(f"Free: {first_of(free, NAMES)}." if free else "No edge is free.", False)
        yield Sentence(f"{NUMERICAL}; size {number(self.size, 4)}.", False)
        if self.verdict:
            told = [f"Inside patch {k} nothing is proved: {doubt}" for k, doubt in enumerate(self.doubts) if doubt]
            yield Sentence(f"{first_of(told, NAMES)}; split_patch cuts it." if told else SMOOTH_INSIDE, False)
            yield Sentence(self._proofs(), self.verdict in {CERTIFIED, REFUTED})

    def _proofs(self) -> str:
        """The verdict on all meetings, and how many of each are proved."""
        parts = []
        for meetings, noun in ((self.edges, "edge"), (self.poles, "pole")):
            counts = Counter(one.verdict for one in meetings)
            parts += [f"{counts[word]} of {plural(len(meetings), noun)} {word}" for word in sorted(counts)]
        exactly = sum(one.proof.exact for one in self.meetings if one.proof)
        parts += [f"{exactly} exactly"] if exactly else []
        return f"Proofs: {self.verdict} ({', '.join(parts)})."


def is_settled(meeting: PatchMeeting) -> bool:
    """Whether the class that samples show is proved: all of it, and that it is no more if it is less than G2."""
    held = meeting.proved or "broken"
    return held == meeting.continuity and meeting.verdict == (CERTIFIED if held == "G2" else REFUTED)


def badness(meeting: PatchMeeting) -> tuple[int, float]:
    """A key that sorts the worst first: the class, then by how many tolerances it is missed."""
    place = CONTINUITIES.index(meeting.continuity)
    room = (meeting.tolerances.gap, meeting.tolerances.angle, meeting.tolerances.curvature)[min(place, 2)]
    value = meeting.worst.value
    return place, -math.inf if math.isnan(value) else -value / room


def extreme(values: Floats, errors: float, points: Floats, parameters: Sequence[Sequence[Floats]]) -> Extreme:
    """The greatest of some values; parameters: for each patch its u and its v, one for each value."""
    known = np.where(np.isfinite(values), values, -1.0)
    place = int(np.argmax(known))
    pairs = tuple((float(u[place]), float(v[place])) for u, v in parameters)
    value = float(known[place]) if known[place] >= 0 else math.nan
    return Extreme(value, float(errors), tuple(map(float, points[place])), pairs)
