"""Proofs about poles: points to which whole edges shrink.

With d the distance from the pole in the parameter across, p = P + d A(t) + d**2 B(t)/2 + ..., the normals tend to those
of A'(t) x A(t). If they all have one direction n, the surface is a graph over the plane there, and its curvatures tend
to those of one quadratic form K, in all directions, if n . B(t) = K(A(t), A(t)): what is left is d**3 times something
smooth, whose second derivatives on the plane vanish with d. K is known from three directions a_i of one patch,

    K(A, A) = sum of K(a_i, a_i) [A, a_j] [A, a_k]/([a_i, a_j] [a_i, a_k]),    [x, y] = (x x y) . n.

If at some A the difference F = n . B - K(A, A) is not zero, no one form holds: were the limits of the curvature all
within e of one another, n . B(a) would be that of one form up to e |a|**2 for each of the four directions, so that

    |F| <= e (|A|**2 + sum of |a_i|**2 |[A, a_j] [A, a_k]/([a_i, a_j] [a_i, a_k])|).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import combinations
from typing import Any, NamedTuple, TypeAlias

from rsym.bounds.ball_series import SeriesFunction, arb, truncated
from rsym.bounds.balls import ball, exact
from rsym.errors import RsymError
from rsym.model.vectors import cross
from rsym.program.builder import Builder
from rsym.program.program import Node
from rsym.reports.document import CERTIFIED, REFUTED, UNDECIDED
from rsym.surfaces.functions.formulas import exact as decimal
from rsym.surfaces.joints.edges import PatchEdge
from rsym.surfaces.proofs.algebra import exact_values
from rsym.surfaces.proofs.edge_formulas import ALONG, ORDERS, EdgeWalk, PatchFormula
from rsym.surfaces.proofs.edge_proof import DIFFERENT, EQUAL, LEVELS, EdgeProof, Level, nothing
from rsym.surfaces.proofs.enclosures import BITS
from rsym.surfaces.proofs.sides import COUNT, Side, Vector, dot
from rsym.surfaces.proofs.specialised import PARAMETER, NoProof, Part
from rsym.surfaces.proofs.stretches import check_unbroken

Shares: TypeAlias = tuple[Fraction, ...]

# Of a known direction: point, A and B.
DIRECTIONS = ((0, 0), (0, 1), (0, 2))
# Shares of the first patch, where sines of the angle may be simple numbers and no two directions are opposite.
KNOWN = tuple(
    (Fraction(0), Fraction(*middle), Fraction(*last))
    for middle, last in (((1, 3), (1, 1)), ((1, 2), (1, 1)), ((1, 3), (2, 3)), ((1, 6), (1, 3)), ((1, 4), (3, 8)))
)
# Where a difference of the curvatures is looked for: places on each patch.
LOOKED_AT = tuple(Fraction(k, 16) for k in range(17))
# Intervals on which the directions are enclosed, each half of one before.
DEEPEST = 8
# The arcsine of a float and its degrees are right to three units in the last place.
ROUNDING = 1e-14


class Ray(NamedTuple):
    """Point, direction A, its derivative A' and B at a pole."""

    point: Vector
    way: Vector
    turning: Vector
    bend: Vector

    @classmethod
    def of(cls, values: Sequence[Any]) -> Ray:
        """From the eighteen values of a jet."""
        side = Side(*(values[k : k + 3] for k in range(0, COUNT, 3)))
        return cls(side.point, side.out, side.along_out, side.out_out)

    @property
    def normal(self) -> Vector:
        """A' x A."""
        return cross(self.turning, self.way)


@dataclass(frozen=True)
class Spoke:
    """An edge that is a pole, and the formula of its patch."""

    edge: PatchEdge
    formula: PatchFormula

    @property
    def part(self) -> Part:
        """The interval of its parameter, as fractions."""
        low, high = (Fraction(str(decimal(end))) for end in self.edge.interval)
        return low, high


def prove_pole(spokes: Sequence[Spoke], rooms: tuple[float, float], worst: Sequence[tuple[int, float]]) -> EdgeProof:
    """What is proved of a pole.

    rooms: the sine of an angle and a jump of curvature that count as none. worst: two spokes, by their places, and the
    parameters on them between which samples of the normals differ most.
    """
    try:
        least = _sine(spokes, worst)
        if least > rooms[0]:
            return _refuted(least, rooms[0], worst[0][1])
        held = [_vanishing_by_either(spoke, spokes[0]) for spoke in spokes]
        smooth = all(met and flat for met, flat, _ in held) and all(map(_turns, spokes))
        if not smooth:
            return nothing("the normals at the pole are not proved to agree")
        found = [Level(name, EQUAL, most=0.0) for name in LEVELS]
        if all(same for _, _, same in held):
            return EdgeProof(CERTIFIED, (found[0], found[1], found[2]))
        jump, place = _jump(spokes)
    except RsymError as error:
        return nothing(error.message)
    if jump > rooms[1]:
        differing = Level("G2", DIFFERENT, least=jump, place=place, room=rooms[1])
        return EdgeProof(REFUTED, (found[0], found[1], differing))
    return EdgeProof(UNDECIDED, (found[0], found[1], Level("G2")), reason="the curvatures at the pole may differ")


def _refuted(sine: float, room: float, place: float) -> EdgeProof:
    least = math.degrees(math.asin(min(sine, 1.0))) * (1 - ROUNDING)
    differing = Level("G1", DIFFERENT, least=least, place=place, room=math.degrees(room))
    return EdgeProof(REFUTED, (Level("G0"), differing, Level("G2")))


def _program(asked: Sequence[tuple[Spoke, Fraction | None]]) -> tuple[Sequence[Node], list[int]]:
    """Nodes and outputs of the jets of spokes, at a place or all along."""
    target = Builder((PARAMETER,), ())
    outputs: list[int] = []
    for spoke, place in asked:
        walk, part = (ALONG, spoke.part) if place is None else (EdgeWalk(place, Fraction(0)), (place, place))
        jet = spoke.formula.jet(spoke.edge, target, part, walk, DIRECTIONS if place is not None else ORDERS)
        if jet.borders:
            raise NoProof("the formulas have pieces round the pole")
        check_unbroken(spoke.formula, spoke.edge, part, walk, jet)
        outputs += jet.nodes
    return target.nodes, outputs


def _vanishing_by_either(spoke: Spoke, first: Spoke) -> tuple[bool, bool, bool]:
    """Whether point, normals and curvatures of a patch at the pole are those of the first one, in all directions."""
    found, reason = None, None
    for shares in KNOWN:
        try:
            found = _vanishing(spoke, first, shares)
        except NoProof as error:
            reason = error
            continue
        if all(found):
            break
    if found is None:
        raise reason or NoProof("no directions are known at the pole")
    return found


def _vanishing(spoke: Spoke, first: Spoke, shares: Shares) -> tuple[bool, bool, bool]:
    """The same, by three known directions of the first one."""
    nodes, outputs = _program([(spoke, None), *((first, place) for place in _places(first, shares))])
    ray, *known = _rays(exact_values(nodes, outputs))
    normal = cross(known[0].way, known[1].way)
    met = all((a - b).is_zero for a, b in zip(ray.point, known[0].point, strict=True))
    flat = dot(normal, ray.way).is_zero and all(dot(normal, one.way).is_zero for one in known)
    with truncated(0, BITS):
        balls = _rays([one[0] for one in SeriesFunction(nodes, outputs)(arb(0)) if one is not None])[1:]
        normal_ball = cross(balls[0].way, balls[1].way)
        brackets = [dot(cross(a.way, b.way), normal_ball) for a, b in combinations(balls, 2)]
    if not all(one > 0 or one < 0 for one in brackets):
        raise NoProof("directions at the pole are parallel")
    return met, flat, met and flat and _form(ray, known, normal).is_zero


def _places(spoke: Spoke, shares: Shares) -> list[Fraction]:
    low, high = spoke.part
    return [low + share * (high - low) for share in shares]


def _jump(spokes: Sequence[Spoke]) -> tuple[float, float]:
    """A lower bound of the greatest difference between limits of the curvature, where normals agree, and where."""
    best, where = 0.0, math.nan
    for shares in KNOWN:
        asked = [(spokes[0], place) for place in _places(spokes[0], shares)]
        asked += [(spoke, place) for spoke in spokes for place in _places(spoke, LOOKED_AT)]
        nodes, outputs = _program(asked)
        with truncated(0, BITS):
            values = [one[0] for one in SeriesFunction(nodes, outputs)(arb(0)) if one is not None]
            if len(values) < len(outputs):
                continue
            a, b, c, *others = _rays(values)
            for ray, (_, place) in zip(others, asked[3:], strict=True):
                found = _least_jump(ray, (a, b, c))
                if found > best:
                    best, where = found, float(place)
        if best > 0:
            break
    return best, where


def _least_jump(ray: Ray, known: tuple[Ray, Ray, Ray]) -> float:
    """The lower bound e of the docstring of this module, from balls of four directions; 0 if nothing is known."""
    across = cross(known[0].way, known[1].way)
    size = dot(across, across)
    if not size > 0:
        return 0.0
    normal = [one / size.sqrt() for one in across]

    def bracket(x: Ray, y: Ray) -> Any:
        return dot(cross(x.way, y.way), normal)

    difference, room = dot(normal, ray.bend), dot(ray.way, ray.way)
    for i, one in enumerate(known):
        x, y = known[i - 1], known[i - 2]
        below = bracket(one, x) * bracket(one, y)
        if not (below > 0 or below < 0):
            return 0.0
        share = bracket(ray, x) * bracket(ray, y) / below
        difference = difference - share * dot(normal, one.bend)
        room = room + abs(share) * dot(one.way, one.way)
    least = abs(difference) / room
    low = float(least.lower()) if least.is_finite() else 0.0
    return max(0.0, math.nextafter(low, -math.inf))


def _form(ray: Ray, known: Sequence[Ray], normal: Vector) -> Any:
    """N . B - K(A, A), times the products of brackets of the three known directions."""

    def bracket(x: Ray, y: Ray) -> Any:
        return dot(cross(x.way, y.way), normal)

    a, b, c = known
    ab, bc, ca = bracket(a, b), bracket(b, c), bracket(c, a)
    # [a, b] [a, c] = -ab ca, and so on round.
    turns = ((a, b, c, bc), (b, c, a, ca), (c, a, b, ab))
    shares = [dot(normal, x.bend) * bracket(ray, y) * bracket(ray, z) * opposite for x, y, z, opposite in turns]
    return dot(normal, ray.bend) * ab * bc * ca + shares[0] + shares[1] + shares[2]


def _sine(spokes: Sequence[Spoke], worst: Sequence[tuple[int, float]]) -> float:
    """A lower bound of the sine of the angle between two limits of the normal."""
    asked = [(spokes[number], Fraction(t)) for number, t in worst]
    normals = []
    with truncated(0, BITS):
        for spoke, place in asked:
            nodes, outputs = _program([(spoke, None)])
            values = [one[0] for one in SeriesFunction(nodes, outputs)(exact(place)) if one is not None]
            if len(values) < COUNT:
                return 0.0
            normals.append(Ray.of(values).normal)
        squares = [dot(one, one) for one in normals]
        if not all(one > 0 for one in squares):
            return 0.0
        crossed = cross(*normals)
        sine = dot(crossed, crossed).nonnegative_part().sqrt() / (squares[0].sqrt() * squares[1].sqrt())
        return max(0.0, math.nextafter(float(sine.lower()), -math.inf))


def _turns(spoke: Spoke) -> bool:
    """Whether A' x A is nowhere zero: the directions turn one way, and the patch is a graph over its tangent plane."""
    nodes, outputs = _program([(spoke, None)])
    function = SeriesFunction(nodes, outputs)
    waiting = [(*spoke.part, 0)]
    with truncated(0, BITS):
        while waiting:
            low, high, depth = waiting.pop()
            values = [one[0] for one in function(ball(exact(low), exact(high))) if one is not None]
            normal = Ray.of(values).normal if len(values) == COUNT else [arb(0)] * 3
            if not dot(normal, normal) > 0:
                if depth == DEEPEST:
                    return False
                middle = (low + high) / 2
                waiting += [(low, middle, depth + 1), (middle, high, depth + 1)]
    return True


def _rays(values: Sequence[Any]) -> list[Ray]:
    return [Ray.of(values[k : k + COUNT]) for k in range(0, len(values), COUNT)]
