"""Proofs that two patches meet smoothly along an edge, or do not.

Exact arithmetic tells what vanishes all along the edge, balls enclose the rest on intervals that cover it.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import pairwise
from typing import Any

import sympy as sp

from rsym.bounds.ball_series import SeriesFunction, arb, truncated
from rsym.bounds.balls import ball, exact
from rsym.errors import RsymError
from rsym.model.vectors import cross
from rsym.program.builder import Builder
from rsym.reports.document import CERTIFIED, DEGENERATE, REFUTED, UNDECIDED
from rsym.surfaces.proofs.algebra import Polynomial, Quotient, exact_values
from rsym.surfaces.proofs.apart import distance_from
from rsym.surfaces.proofs.edge_formulas import ORDERS, EdgeWalk
from rsym.surfaces.proofs.edge_proof import DIFFERENT, EQUAL, LEVELS, NUMERICAL, WITHIN, EdgeProof, Level, nothing
from rsym.surfaces.proofs.enclosures import BITS, ORDER, DifferenceBounds, Pair, look, survey
from rsym.surfaces.proofs.sides import COUNT, Side, Vector, difference, dot, linkage, sides
from rsym.surfaces.proofs.specialised import PARAMETER, NoProof, Part
from rsym.surfaces.proofs.stretches import ProofTask, pairs, walks
from rsym.surfaces.proofs.uneven import evened, place_of

# The share of a measured gap that is to be proved.
NEARLY = 0.99
# The arcsine of a float and its degrees are right to three units in the last place.
ROUNDING = 1e-14
# A neighbourhood of an end that is left out is no longer than this share of the edge.
BESIDE = 2.0**-9
SPEEDS = "the edges run at different speeds"
# Neighbourhoods of poles that are tried: a quarter does for spheres and ellipsoids.
NEIGHBOURHOODS = (Fraction(1, 4), Fraction(1, 16), Fraction(1, 256))
# Normals beside a pole: they vanish there exactly, and over the distance to it they do not.
AXES = 3


def prove(task: ProofTask) -> EdgeProof:
    """What is proved of a common edge.

    First the places where samples were worst are looked at: what is refuted there need not be proved elsewhere. Then
    exact arithmetic is asked what vanishes identically, and balls enclose the normals and what is left. Where edges do
    not run at one speed, one parameter is sought as a function of the other.
    """
    found = _prove(task)
    if found.reason != SPEEDS:
        return found
    try:
        for even, swapped, function in evened(task):
            other = _prove(even)
            if other.verdict != UNDECIDED or other.proved is not None:
                return _by_first(other, function) if swapped else other
    except NoProof:
        return found
    return found


def _by_first(proof: EdgeProof, function: sp.Expr) -> EdgeProof:
    """A proof by the parameter of the second edge, by that of the first."""
    first, second, third = (replace(one, place=place_of(function, one.place)) for one in proof.levels)
    ends = [sorted(place_of(function, one) for one in part) for part in proof.open]
    removed = tuple(place_of(function, one) for one in proof.removed)
    return replace(proof, levels=(first, second, third), open=tuple((a, b) for a, b in ends), removed=removed)


def _prove(task: ProofTask) -> EdgeProof:
    try:
        both, whole = walks(task)
        bounds = DifferenceBounds(task.rooms)
        _look_at_worst(task, both, bounds)
    except RsymError as error:  # of a formula that no program can hold, too
        return nothing(error.message)
    try:
        return _proved(task, both, whole, bounds)
    except NoProof as error:
        return _answer(Facts(), bounds, (whole,), (), whole, error.message)


def _look_at_worst(task: ProofTask, both: tuple[EdgeWalk, EdgeWalk], bounds: DifferenceBounds) -> None:
    for t in sorted(set(task.worst)):
        place = Fraction(t)
        for pair in pairs(task, both, (place, place)):
            look(pair, place, bounds)


def _proved(task: ProofTask, both: tuple[EdgeWalk, EdgeWalk], whole: Part, bounds: DifferenceBounds) -> EdgeProof:
    alive = bounds.alive
    if alive == 0:
        return _apart(task)
    parts = pairs(task, both, whole, ORDERS[:1] if alive == 1 else ORDERS)
    found = [facts(pair, alive) for pair in parts]
    if not all(one.regular for one in found):
        return _without_normals(task, both, parts, found)
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


def _without_normals(
    task: ProofTask, both: tuple[EdgeWalk, EdgeWalk], parts: Sequence[Pair], found: Sequence[Facts]
) -> EdgeProof:
    """What is said of patches whose parameters leave no normal: only an edge of regression is proved to be degenerate.

    Of others the surface may be smooth, and another parameter show it, as v of (u, v**2, 0) does not.
    """
    verdict = UNDECIDED
    for pair, known in zip(parts, found, strict=True):
        for place in known.standing:
            target = Builder((PARAMETER,), ())
            formula, edge, walk = task.formulas[place], task.edges[place], both[place]
            nodes = [*formula.jet(edge, target, pair.part, walk).nodes, *formula.third(edge, target, pair.part, walk)]
            with truncated(0, BITS):
                middle = exact((pair.part[0] + pair.part[1]) / 2)
                values = [one[0] for one in SeriesFunction(target.nodes, nodes)(middle) if one is not None]
            if len(values) == len(nodes) and is_cuspidal(values[:COUNT], values[COUNT:]):
                verdict = DEGENERATE
    return EdgeProof(verdict, nothing("").levels, reason="a patch has no normal along the edge")


def _apart(task: ProofTask) -> EdgeProof:
    """What is proved where points with equal parameters differ: that one is away from all of the other edge."""
    least, place = 0.0, math.nan
    # Edges written with one parameter are not there beyond their stretch.
    if task.gap > task.rooms[0] and task.even is None:
        sides, place = [*zip(task.edges, task.formulas, strict=True)], task.worst[0]
        wanted = max(task.rooms[0], NEARLY * task.gap)
        least = distance_from(sides[0], Fraction(place), sides[1], wanted)
    if least == 0:
        return nothing(SPEEDS)
    gap = Level(LEVELS[0], DIFFERENT, least=least, place=place, room=task.rooms[0])
    return EdgeProof(REFUTED, (gap, Level(LEVELS[1]), Level(LEVELS[2])))


def _cover(parts: Sequence[Pair], wanted: Sequence[bool], bounds: DifferenceBounds) -> None:
    """Enclose all parts; of an edge with a kink there is nothing to enclose if its points agree exactly."""
    for pair in parts:
        if bounds.alive > 1 or wanted[0]:
            survey(pair, wanted, bounds)


def _jump(linkage: float, bounds: DifferenceBounds) -> float:
    """The jump of curvature where tangent planes agree: linkage |T|**2/(|N1|**3 |N2|**2), rounded up."""
    first, second = bounds.squares
    below = first * math.sqrt(first) * second
    return linkage * bounds.speed / below * (1 + ROUNDING) if 0 < below < math.inf else math.inf


def _without_poles(task: ProofTask, parts: Sequence[Pair], whole: Part) -> tuple[list[Pair], list[Fraction]]:
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
    known: Facts, bounds: DifferenceBounds, left: Sequence[Part], removed: Sequence[Fraction], whole: Part, reason: str
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


def _level(number: int, vanishes: bool, bounds: DifferenceBounds, covered: bool) -> Level:
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


def regular_end(pair: Pair, end: Fraction, part: Part) -> bool:
    """Whether both normals on a part that begins or stops at a pole are their distance to it times what is not zero.

    N(end + h) = h (c_1 + c_2 h + ... + R_n h**(n-1)) if N(end) = 0 exactly, by the arithmetic of `algebra`.
    """
    try:
        values = sides(exact_values(pair.nodes, pair.outputs, end))
    except NoProof:
        return False
    gone = [all(one.is_zero for one in side.normal) for side in values]
    sign = 1 if end == part[0] else -1
    with truncated(ORDER, BITS):
        here, all_over = pair.sides(exact(end)), pair.sides(ball(exact(part[0]), exact(part[1])))
        if here is None or all_over is None:
            return False
        ways = _powers(exact(part[1] - part[0]), sign)
        normals = [(one.normal, other.normal) for one, other in zip(here, all_over, strict=True)]
        return all(dot(*[_over(*pairs, ways, int(zero))] * 2) > 0 for pairs, zero in zip(normals, gone, strict=True))


def is_cuspidal(values: Sequence[Any], third: Sequence[Any]) -> bool:
    """Whether a patch ends in an edge of regression, of which curvatures are unbounded, by balls at one place.

    values: the eighteen of a jet, of which the derivative D across the edge vanishes all along, by exact arithmetic;
    third: the third derivative across. With d the distance to the edge in the parameter p = P(t) + d**2 B/2 + d**3
    C/6 + ...; in the plane across the edge the sheet is a curve with the tangent B, and C across it: like y = x**(3/2).
    """
    side = Side(*(values[k : k + AXES] for k in range(0, len(values), AXES)))
    volume = dot(cross(side.along, side.out_out), third)
    return bool(volume > 0 or volume < 0)


def _powers(step: Any, sign: int) -> list[Any]:
    """Balls for the powers of all numbers from 0 to a step, or to minus it."""
    powers = [arb(1)]
    for _ in range(ORDER):
        powers.append(powers[-1] * step * sign)
    return [powers[0], *(ball(arb(0), one) if one > 0 else ball(one, arb(0)) for one in powers[1:])]


def _over(middle: Vector, whole: Vector, ways: Sequence[Any], order: int) -> Sequence[Any]:
    """Balls for a vector over a power of the distance to where its series begin."""
    pairs = zip(middle, whole, strict=True)
    return [
        sum((one[k] * ways[k - order] for k in range(order, ORDER)), rest[ORDER] * ways[ORDER - order])
        for one, rest in pairs
    ]


@dataclass(frozen=True)
class Facts:
    """Which of gap, angle and jump vanish identically, and whether both patches have normals.

    `standing` are the patches, 0 and 1, whose derivative across the edge vanishes identically.
    `linkage` bounds the difference II1(D2, D2) - II2(D2, D2) times |N1|**3, where the angle vanishes; None if unknown.
    """

    vanishing: tuple[bool, bool, bool] = (False, False, False)
    regular: bool = True
    linkage: float | None = None
    standing: tuple[int, ...] = ()


def facts(pair: Pair, levels: int) -> Facts:
    """What exact arithmetic says of the first so many levels on a part of an edge."""
    try:
        first, second = sides(exact_values(pair.nodes, pair.outputs))
        met = all(one.is_zero for one in difference(first.point, second.point))
        if levels < 2:
            return Facts((met, False, False))
        normals = first.normal, second.normal
        if any(all(one.is_zero for one in normal) for normal in normals):
            still = tuple(k for k, side in enumerate((first, second)) if all(one.is_zero for one in side.out))
            return Facts(regular=False, standing=still)
        flat = met and dot(normals[0], second.out).is_zero
        return _of_curvature(pair, first, second) if flat and levels > 2 else Facts((met, flat, False))
    except NoProof:
        return Facts()


def _of_curvature(pair: Pair, first: Side, second: Side) -> Facts:
    """The third level, where the first two vanish: by one axis if it vanishes, bounded by all three if not."""
    axes = [k for _, k in sorted((len(one.above), k) for k, one in enumerate(first.normal) if not one.is_zero)]
    try:
        if linkage(first, second, axes[:1]).is_zero:
            return Facts((True, True, True))
        return Facts((True, True, False), linkage=greatest(linkage(first, second), pair.part))
    except NoProof:
        return Facts((True, True, False))


# How great the values of the field of `algebra` are: sums of sizes of coefficients, over an interval of t.
def greatest(value: Quotient, part: Part) -> float | None:
    """No |value| on a part of the edge is greater; None where a generator or a denominator is not bounded.

    Numbers, pi and roots among them, are summed first: what they leave of a difference may be small.

    Examples
    --------
    >>> from fractions import Fraction
    >>> from rsym.surfaces.proofs.algebra import EdgeField, T
    >>> field = EdgeField()
    >>> round(greatest(field.generator(T) * field.rational(Fraction(3)), (Fraction(-2), Fraction(1))), 6)
    6.0
    """
    with truncated(0, BITS):
        known = value.field.balls(ball(exact(part[0]), exact(part[1])))
        above = _size(value.above, known, value.field.varying)
        for one, exponent in value.below.items():
            below = _constant(one, known, value.field.varying)
            if below is None or below.contains(arb(0)) or above is None:
                return None
            for _ in range(exponent):
                above = above / abs(below)
        if above is None or not above.is_finite():
            return None
        return math.nextafter(float(above.upper()), math.inf)


def _size(polynomial: Polynomial, known: dict[int, Any], varying: frozenset[int]) -> Any | None:
    """The sum of the sizes of the coefficients of products of varying generators, times those of the products."""
    rows: dict[tuple[tuple[int, int], ...], Any] = {}
    for monomial, coefficient in polynomial.items():
        powers = [(k, exponent) for k, exponent in enumerate(monomial) if exponent]
        moving = tuple(pair for pair in powers if pair[0] in varying)
        if any(k not in known for k, _ in powers):
            return None
        term = _product([pair for pair in powers if pair[0] not in varying], known)
        term = term * arb(int(coefficient.numerator)) / arb(int(coefficient.denominator))
        rows[moving] = rows.get(moving, arb(0)) + term
    return sum((abs(total) * abs(_product(moving, known)) for moving, total in rows.items()), arb(0))


def _constant(polynomial: Polynomial, known: dict[int, Any], varying: frozenset[int]) -> Any | None:
    """The ball of a polynomial of constant generators."""
    total = arb(0)
    for monomial, coefficient in polynomial.items():
        powers = [(k, exponent) for k, exponent in enumerate(monomial) if exponent]
        if any(k in varying or k not in known for k, _ in powers):
            return None
        total = total + _product(powers, known) * arb(int(coefficient.numerator)) / arb(int(coefficient.denominator))
    return total


def _product(powers: Any, known: dict[int, Any]) -> Any:
    total = arb(1)
    for k, exponent in powers:
        for _ in range(exponent):
            total = total * known[k]
    return total
