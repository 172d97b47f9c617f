"""Proofs that two patches meet smoothly along an edge, or do not."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise

from rsym.codegen.builder import Builder
from rsym.surfaces.functions.entries import exact
from rsym.surfaces.joints.edge_matching import Stretch
from rsym.surfaces.joints.edges import Edge
from rsym.surfaces.proofs.deflation import regular_end
from rsym.surfaces.proofs.edge_formulas import PatchFormula, Walk
from rsym.surfaces.proofs.edge_proof import DIFFERENT, EQUAL, LEVELS, NUMERICAL, WITHIN, EdgeProof, Level, nothing
from rsym.surfaces.proofs.enclosures import Bounds, Pair, look, survey
from rsym.surfaces.proofs.exact_values import exact_values
from rsym.surfaces.proofs.sides import difference, dot, linkage, sides
from rsym.surfaces.proofs.specialised import PARAMETER, NoProof, Part
from rsym.verify.report import CERTIFIED, DEGENERATE, REFUTED, UNDECIDED

# An end of a stretch that samples found is tried as a fraction so simple: knots and halves are, roots are not.
SIMPLE = 10_000
SNAP = 1e-9
# The arcsine of a float and its degrees are right to three units in the last place.
ROUNDING = 1e-14


@dataclass(frozen=True)
class Task:
    """A stretch, the formulas of its patches, what counts as none, and where the samples were worst.

    rooms: a gap (length), the sine of an angle, a jump of curvature. worst: parameters of the first edge.
    """

    stretch: Stretch
    formulas: tuple[PatchFormula, PatchFormula]
    rooms: tuple[float, float, float]
    worst: Sequence[float]

    @property
    def edges(self) -> tuple[Edge, Edge]:
        """Both edges."""
        first, second = self.stretch.borders
        return first.edge, second.edge


def prove(task: Task) -> EdgeProof:
    """What is proved of a common edge."""
    try:
        return _proved(task)
    except NoProof as error:
        return nothing(error.message)


def _proved(task: Task) -> EdgeProof:
    walks, whole = _walks(task.stretch)
    pairs = _pairs(task, walks, whole)
    vanishing = _vanishing(pairs)
    if vanishing is None:
        return _without_normal()
    rooms = [None if known else room for known, room in zip(vanishing, task.rooms, strict=True)]
    bounds = Bounds()
    for t in task.worst:
        place = Fraction(t)
        for pair in pairs:
            if pair.part[0] <= place <= pair.part[1]:
                look(pair, place, rooms, bounds)
    for pair in pairs:
        survey(pair, rooms, bounds)
    removed = _remove_poles(pairs, whole, vanishing, bounds)
    return _answer(task, vanishing, bounds, removed)


def _walks(stretch: Stretch) -> tuple[tuple[Walk, Walk], Part]:
    """Both parameters by that of the first edge, and the interval of it."""
    first, second = stretch.borders
    low, high = (_simple(t, first.edge.interval) for t in stretch.interval)
    start, stop = (_simple(float(s), second.edge.interval) for s in (stretch.s[0], stretch.s[-1]))
    speed = (stop - start) / (high - low)
    return (Walk(Fraction(0), Fraction(1)), Walk(start - speed * low, speed)), (low, high)


def _simple(value: float, interval: tuple[float, float]) -> Fraction:
    """An end of a stretch: an end of the edge, or a simple number next to it."""
    if value in interval:
        return Fraction(str(exact(value)))
    near = Fraction(value).limit_denominator(SIMPLE)
    return near if abs(float(near) - value) <= SNAP * (interval[1] - interval[0]) else Fraction(value)


def _pairs(task: Task, walks: tuple[Walk, Walk], whole: Part) -> list[Pair]:
    """Both patches on each part between the borders of their pieces."""
    waiting, found = [whole], []
    while waiting:
        part = waiting.pop()
        target = Builder((PARAMETER,), ())
        both = zip(task.formulas, task.edges, walks, strict=True)
        jets = [formula.jet(edge, target, part, walk) for formula, edge, walk in both]
        borders = sorted({one for jet in jets for one in jet.borders if part[0] < one < part[1]})
        if borders:
            places = [part[0], *borders, part[1]]
            waiting += [*pairwise(places)][::-1]
        else:
            found.append(Pair(target.nodes, [number for jet in jets for number in jet.nodes], part))
    return found


def _vanishing(pairs: Sequence[Pair]) -> list[bool] | None:
    """Whether gap, angle and jump are identically zero, by exact arithmetic; None if there is no normal."""
    held = [True] * 3
    for pair in pairs:
        try:
            found = _vanishing_on(pair)
        except NoProof:
            found = [False] * 3
        if found is None:
            return None
        held = [a and b for a, b in zip(held, found, strict=True)]
    return held


def _vanishing_on(pair: Pair) -> list[bool] | None:
    first, second = sides(exact_values(pair.nodes, pair.outputs))
    normals = first.normal, second.normal
    if any(all(one.is_zero for one in normal) for normal in normals):
        return None
    met = all(one.is_zero for one in difference(first.point, second.point))
    flat = met and dot(normals[0], second.out).is_zero
    axis = min((len(one.above), k) for k, one in enumerate(normals[0]) if not one.is_zero)[1]
    return [met, flat, flat and linkage(first, second, axis).is_zero]


def _remove_poles(pairs: Sequence[Pair], whole: Part, vanishing: Sequence[bool], bounds: Bounds) -> list[Fraction]:
    """Ends at which the normals vanish, but not over the distance to them: what is known to vanish, does there too."""
    if not all(vanishing):
        return []
    removed = []
    for end, pair in ((whole[0], pairs[0]), (whole[1], pairs[-1])):
        beside = [part for part in bounds.open if end in part]
        if beside and regular_end(pair, end, beside[0]):
            bounds.open.remove(beside[0])
            removed.append(end)
    return removed


def _answer(task: Task, vanishing: Sequence[bool], bounds: Bounds, removed: Sequence[Fraction]) -> EdgeProof:
    """The levels and the verdict."""
    low, high = task.edges[0].interval
    inner = [part for part in bounds.open if not (float(part[0]) <= low or float(part[1]) >= high)]
    reason = ""
    levels = [_level(k, task.rooms[k], vanishing[k], bounds, not inner) for k in range(3)]
    if levels[0].status == DIFFERENT:
        levels[0], reason = Level(LEVELS[0]), "the edges run at different speeds, or apart"
    if not levels[0].holds:
        levels[1:] = [Level(name) for name in LEVELS[1:]]
    if levels[1].status == DIFFERENT:
        levels[2] = Level(LEVELS[2])
    beside = tuple((float(a), float(b)) for a, b in bounds.open)
    if any(one.status == DIFFERENT for one in levels):
        verdict = REFUTED
    else:
        verdict = CERTIFIED if all(one.holds for one in levels) and not beside else UNDECIDED
    if not reason and verdict == UNDECIDED:
        reason = "the normals are not enclosed away from zero" if inner else "nothing is said beside a pole"
    return EdgeProof(verdict, (levels[0], levels[1], levels[2]), beside, tuple(map(float, removed)), reason)


def _level(number: int, room: float, vanishes: bool, bounds: Bounds, covered: bool) -> Level:
    """One level; what fades inside the edge leaves only the gap proved."""
    least, most = bounds.least[number], bounds.most[number]
    if number == 1:
        least, most, room = _angle(least, down=True), _angle(most), math.degrees(room)
        if bounds.folded is not None:
            return Level(LEVELS[1], DIFFERENT, least=90.0, place=float(bounds.folded), room=room)
    if vanishes:
        return Level(LEVELS[number], EQUAL if covered or number == 0 else NUMERICAL, most=0.0, room=room)
    if least > room:
        return Level(LEVELS[number], DIFFERENT, least=least, place=float(bounds.places[number]), room=room)
    return Level(LEVELS[number], WITHIN if covered and most <= room else NUMERICAL, most, least, room=room)


def _angle(sine: float, *, down: bool = False) -> float:
    """An angle in degrees from its sine, rounded up or down."""
    return math.degrees(math.asin(min(sine, 1.0))) * (1 - ROUNDING if down else 1 + ROUNDING)


def _without_normal() -> EdgeProof:
    return EdgeProof(DEGENERATE, nothing("").levels, reason="a patch has no normal along the edge")
