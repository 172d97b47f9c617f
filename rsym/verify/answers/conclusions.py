"""Conclusions: what follows from boxes and places, in the plane and in space: the verdict, an order, sentences."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from rsym.reports.document import CERTIFIED, DEGENERATE, REFUTED, UNDECIDED
from rsym.reports.words import plural
from rsym.verify.answers.report import continuity_of, is_defect, level_of

# Kinds for which there is no curve or surface whose curvature could be continuous.
DEGENERATIONS = frozenset({"node", "isolated point", "no sign change", "end"})

# What the boxes of a kind say, by the number of coordinates, in the order in which it is said.
SENTENCES: Mapping[int, Mapping[str, str]] = {
    2: {
        "double": "omega is zero on a curve without changing its sign",
        "analytic": "on {boxes} the boundary is a regular analytic arc",
        "regular": "on {boxes} the boundary is a regular arc of class C^{order}",
        "joined": "on {boxes} it consists of two analytic arcs that meet in one point",
        "leap": "on {boxes} omega jumps over zero",
        "broken": "on {boxes} it is no curve",
        "open": "on {boxes} nothing is proved of the boundary as a whole",
    },
    3: {
        "double": "in {boxes} omega is zero without changing its sign",
        "analytic": "in {boxes} the boundary is a regular analytic surface",
        "regular": "in {boxes} the boundary is a regular C^{order} surface",
        "joined": "in {boxes} it consists of two analytic sheets that meet in a curve, if at all",
        "corner": "in {boxes} it has a corner of three analytic sheets",
        "leap": "in {boxes} omega jumps over zero",
        "broken": "in or beside {boxes} it is no surface where omega jumps",
        "open": "in {boxes} nothing is proved of the boundary as a whole",
    },
}


@dataclass(frozen=True)
class Tally:
    """How many boxes of each kind a subdivision left, of which nothing is proved on those that are "open".

    The boundary on the "regular" ones is of class C^j for all j < order. `exists` says whether there is a point of the
    boundary: True and False are proved, None is neither.
    """

    counts: Mapping[str, int]
    order: float
    exists: bool | None

    def __getitem__(self, kind: str) -> int:
        return self.counts.get(kind, 0)


def is_degenerate(place: Any) -> bool:
    """Whether there is no curve or surface at a place, if what is said of it holds."""
    return place.kind in DEGENERATIONS or (place.kind == "tangency" and place.continuity == "broken")


def verdict_from(tally: Tally, places: Sequence[Any]) -> str:
    """The strongest word that the evidence bears.

    Examples
    --------
    >>> verdict_from(Tally({"regular": 8}, math.inf, True), []), verdict_from(Tally({"open": 1}, math.inf, None), [])
    ('CERTIFIED', 'UNDECIDED')
    """
    proved = [place for place in places if place.proved]
    if any(is_defect(place) and not is_degenerate(place) for place in proved):
        return REFUTED
    if any(map(is_degenerate, proved)) or tally["double"] or tally.exists is False:
        return DEGENERATE
    if tally["open"] or tally["leap"] or len(proved) < len(places):
        return UNDECIDED
    return CERTIFIED if tally.exists else UNDECIDED


@dataclass(frozen=True)
class Conclusion:
    """What is said of the whole boundary: a verdict, a continuity, sentences with whether they are proved."""

    verdict: str
    continuity: str
    statements: tuple[tuple[str, bool], ...]


def conclude(
    tally: Tally, places: Sequence[Any], dimension: int, further: Iterable[tuple[str, bool]], *, ranging: bool = False
) -> Conclusion:
    """What follows from boxes and places; `further` sentences are said last."""
    verdict = verdict_from(tally, places)
    counted = [place for place in places if place.proved or verdict != REFUTED]
    said = (*sentences(tally, dimension, ranging=ranging), *further)
    return Conclusion(verdict, continuity_of(verdict, map(level_of, counted), tally.order), said)


def badness(place: Any) -> tuple[float, ...]:
    """What places are sorted by: the proved ones first, of these the worst."""
    jumps = (place.tangent_jump, getattr(place, "curvature_jump", math.nan))
    where = place.points[0].tolist() if hasattr(place, "points") else place.point
    return (not place.proved, level_of(place), *(0.0 if math.isnan(jump) else -jump for jump in jumps), *where)


def sentences(tally: Tally, dimension: int, *, ranging: bool = False) -> list[tuple[str, bool]]:
    """Sentences about the whole boundary, each with whether it is proved; single places speak for themselves.

    Examples
    --------
    >>> sentences(Tally({"regular": 1, "open": 2}, 3.0, True), 2)[0]
    ('on 1 box the boundary is a regular arc of class C^2', True)
    """
    result = []
    if not tally.exists:
        none = tally.exists is False
        where = "within the bounds for every value of the letters" if ranging and not none else "within the bounds"
        result.append((f"no point of the boundary {'lies' if none else 'was found'} {where}", none))
    smooth = "analytic" if math.isinf(tally.order) else "regular"
    for kind, text in SENTENCES[dimension].items():
        count = tally[kind]
        if kind in {"analytic", "regular"}:
            count = tally["regular"] if kind == smooth and tally.exists else 0
        if count:
            order = math.ceil(tally.order) - 1 if kind == "regular" else None
            result.append((text.format(boxes=plural(count, "box", "boxes"), order=order), kind != "open"))
    return result
