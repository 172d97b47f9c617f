"""Proofs that two patches meet smoothly along an edge, or do not."""

from __future__ import annotations

import math
from collections.abc import Sequence
from fractions import Fraction
from itertools import pairwise

from rsym.errors import RsymError
from rsym.surfaces.proofs.apart import distance_from
from rsym.surfaces.proofs.deflation import regular_end
from rsym.surfaces.proofs.edge_formulas import ORDERS, Walk
from rsym.surfaces.proofs.edge_proof import DIFFERENT, EQUAL, LEVELS, NUMERICAL, WITHIN, EdgeProof, Level, nothing
from rsym.surfaces.proofs.enclosures import Bounds, Pair, look, survey
from rsym.surfaces.proofs.exactly import Facts, facts
from rsym.surfaces.proofs.specialised import NoProof, Part
from rsym.surfaces.proofs.stretches import Task, pairs, walks
from rsym.verify.report import CERTIFIED, DEGENERATE, REFUTED, UNDECIDED

# The share of a measured gap that is to be proved.
NEARLY = 0.99
# The arcsine of a float and its degrees are right to three units in the last place.
ROUNDING = 1e-14
# A neighbourhood of an end that is left out is no longer than this share of the edge.
BESIDE = 2.0**-9
# Neighbourhoods of poles that are tried: a quarter does for spheres and ellipsoids.
NEIGHBOURHOODS = (Fraction(1, 4), Fraction(1, 16), Fraction(1, 256))


def prove(task: Task) -> EdgeProof:
    """What is proved of a common edge.

    First the places where samples were worst are looked at: what is refuted there need not be proved elsewhere. Then
    exact arithmetic is asked what vanishes identically, and balls enclose the normals and what is left.
    """
    try:
        both, whole = walks(task.stretch)
        bounds = Bounds(task.rooms)
        _look_at_worst(task, both, bounds)
    except RsymError as error:  # of a formula that no program can hold, too
        return nothing(error.message)
    try:
        return _proved(task, both, whole, bounds)
    except NoProof as error:
        return _answer(Facts(), bounds, (whole,), (), whole, error.message)


def _look_at_worst(task: Task, both: tuple[Walk, Walk], bounds: Bounds) -> None:
    for t in sorted(set(task.worst)):
        place = Fraction(t)
        for pair in pairs(task, both, (place, place)):
            look(pair, place, bounds)


def _proved(task: Task, both: tuple[Walk, Walk], whole: Part, bounds: Bounds) -> EdgeProof:
    alive = bounds.alive
    if alive == 0:
        return _apart(task)
    parts = pairs(task, both, whole, ORDERS[:1] if alive == 1 else ORDERS)
    found = [facts(pair, alive) for pair in parts]
    if not all(one.regular for one in found):
        return EdgeProof(DEGENERATE, nothing("").levels, reason="a patch has no normal along the edge")
    first, *rest = ([one.vanishing[level] for one in found] for level in range(3))
    vanishing = (all(first), all(rest[0]), all(rest[1]))
    small = max((one.linkage for one in found if one.linkage is not None), default=0.0)
    linked = vanishing[1] and all(one.linkage is not None or one.vanishing[2] for one in found)
    bounds.flat = vanishing[1]
    parts, removed = _without_poles(task, parts, whole) if all(vanishing) else (parts, [])
    wanted = [not one for one in vanishing]
    _cover(parts, [*wanted[:2], not linked], bounds)
    if linked and not vanishing[2]:
        bounds.most[2] = _jump(small, bounds)
        if bounds.most[2] > bounds.rooms[2]:
            bounds.most[2] = 0.0
            bounds.open.clear()
            _cover(parts, wanted, bounds)
    if bounds.alive == 0:
        return _apart(task)
    return _answer(Facts(vanishing), bounds, bounds.open, removed, whole, "")


def _apart(task: Task) -> EdgeProof:
    """What is proved where points with equal parameters differ: that one is away from all of the other edge."""
    least, place = 0.0, math.nan
    if task.gap > task.rooms[0]:
        sides, place = [*zip(task.edges, task.formulas, strict=True)], task.worst[0]
        wanted = max(task.rooms[0], NEARLY * task.gap)
        least = distance_from(sides[0], Fraction(place), sides[1], wanted)
    if least == 0:
        return nothing("the edges run at different speeds")
    gap = Level(LEVELS[0], DIFFERENT, least=least, place=place, room=task.rooms[0])
    return EdgeProof(REFUTED, (gap, Level(LEVELS[1]), Level(LEVELS[2])))


def _cover(parts: Sequence[Pair], wanted: Sequence[bool], bounds: Bounds) -> None:
    """Enclose all parts; of an edge with a kink there is nothing to enclose if its points agree exactly."""
    for pair in parts:
        if bounds.alive > 1 or wanted[0]:
            survey(pair, wanted, bounds)


def _jump(linkage: float, bounds: Bounds) -> float:
    """The jump of curvature where tangent planes agree: linkage |T|**2/(|N1|**3 |N2|**2), rounded up."""
    first, second = bounds.squares
    below = first * math.sqrt(first) * second
    return linkage * bounds.speed / below * (1 + ROUNDING) if 0 < below < math.inf else math.inf


def _without_poles(task: Task, parts: Sequence[Pair], whole: Part) -> tuple[list[Pair], list[Fraction]]:
    """The parts without neighbourhoods of the ends at which normals vanish, but not over the distance to them.

    What is known to vanish elsewhere does at such an end too, of the limits of the normals.
    """
    left, removed = list(parts), []
    for place in task.stretch.poles:
        pair, end = left[place], whole[place]
        low, high = pair.part
        for share in NEIGHBOURHOODS:
            cut = high - (high - low) * share if place else low + (high - low) * share
            halves = sorted([low, cut, high])
            beside, rest = [*pairwise(halves)][:: -1 if place else 1]
            if regular_end(pair, end, beside):
                left[place] = Pair(pair.nodes, pair.outputs, rest)
                removed.append(end)
                break
    return left, removed


def _answer(
    known: Facts, bounds: Bounds, left: Sequence[Part], removed: Sequence[Fraction], whole: Part, reason: str
) -> EdgeProof:
    """The levels and the verdict; `left` are intervals of which nothing is said."""
    narrow = BESIDE * (whole[1] - whole[0])
    inner = [part for part in left if not set(part) & set(whole) or part[1] - part[0] > narrow]
    levels = [_level(level, known.vanishing[level], bounds, not inner) for level in range(3)]
    beside = () if inner else tuple((float(a), float(b)) for a, b in left)
    held = all(one.holds for one in levels) and not beside
    verdict = REFUTED if any(one.status == DIFFERENT for one in levels) else CERTIFIED if held else UNDECIDED
    if verdict == UNDECIDED and not reason:
        reason = "not all is enclosed" if inner else "nothing is said beside a pole"
    return EdgeProof(verdict, (levels[0], levels[1], levels[2]), beside, tuple(map(float, removed)), reason)


def _level(number: int, vanishes: bool, bounds: Bounds, covered: bool) -> Level:
    """One level; where normals fade inside the edge only the gap is proved."""
    least, most, room = bounds.least[number], bounds.most[number], bounds.rooms[number]
    place = float(bounds.places[number])
    refuted = least > room
    if number == 1:
        least, most, room = _angle(least, down=True), _angle(most), math.degrees(room)
        if bounds.folded is not None:
            least, place, refuted = 90.0, float(bounds.folded), True
    if refuted:
        return Level(LEVELS[number], DIFFERENT, least=least, place=place, room=room)
    if number >= bounds.alive:
        return Level(LEVELS[number], room=room)
    if vanishes:
        return Level(LEVELS[number], EQUAL if covered or number == 0 else NUMERICAL, most=0.0, room=room)
    proved = covered and most <= room
    return Level(LEVELS[number], WITHIN if proved else NUMERICAL, most if proved else math.inf, least, room=room)


def _angle(sine: float, *, down: bool = False) -> float:
    """An angle in degrees from its sine, rounded up or down."""
    return math.degrees(math.asin(min(sine, 1.0))) * (1 - ROUNDING if down else 1 + ROUNDING)
