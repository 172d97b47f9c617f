"""Corners, nodes and isolated points proved by the one-sided derivative of omega in all directions (blow-up).

At a point p where several operations that are not smooth vanish together no arc is analytic up to p. But
omega(p + r d) = r H(d) + o(r), uniformly in the direction d (`slopes`). Where H is not 0, omega has the sign of H
near p. So all zeros near p lie in cones about the directions in which H may vanish, and where H changes its sign
across such a cone, every small circle around p has a zero in it, by continuity. Hence, if omega(p) = 0:
- no such direction: p is an isolated point of the boundary;
- two, each with a change of sign, not opposite: the boundary leaves p in both and in no other direction, and a
  curve with a tangent leaves in opposite ones: a corner. It is a curve (G0) if omega is strictly monotone across
  each cone: if no limit of its gradient in the cone is at right angles to the way across, which is asked for too;
- four or more with a change of sign: more directions than a curve has, a node.
Anything else proves nothing here: opposite directions, a zero of H without a change of sign, H = 0 on an arc.

Only the sign of omega matters. So first it is replaced by a function of the same sign near p, whose H says more:
conjunctions become min, products (u v of order 2) u v/sqrt(u**2 + v**2), sums of squares their roots.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from typing import TypeAlias

from rsym.bounds.balls import arb, ctx, exact, hypotenuse
from rsym.program.operations import CONJUNCTIONS, LOGICAL
from rsym.verify.answers.report import Joint
from rsym.verify.boxes.domains import is_defined, is_legal
from rsym.verify.boxes.local import PRECISE, Local, Model
from rsym.verify.boxes.vanishing import Exact, exact_at
from rsym.verify.boxes.vectors import sign_of
from rsym.verify.points.slopes import Slopes, slopes_of, squares

Number: TypeAlias = Fraction | arb

FINEST = 2.0**-48  # of the eight units around the square of directions; float64 holds all ends exactly
NARROW = 2.0**-38  # a cone that stays wider than this is taken for an arc on which H vanishes
CROWD = 64  # undecided arcs at once: a simple zero of H leaves two or three


def classify_by_directions(model: Model, point: tuple[Number, Number], zeros: frozenset[int]) -> Joint | None:
    """The corner, node or isolated point of the boundary at a point, proved; None where nothing is.

    Parameters
    ----------
    model : Model
        Without ranges of letters.
    point : pair of Fraction or arb
        The point itself: exact rational numbers, or a box in which it is known to lie.
    zeros : frozenset of int
        Nodes known to vanish at the point; of a box, those of which it is the only common zero.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> model = Model(rsym.Shape(rsym.conjunction(x, y) + x**3, (x, y)), {})
    >>> joint = classify_by_directions(model, (Fraction(0), Fraction(0)), frozenset())
    >>> joint.kind, joint.tangent_jump, joint.proved
    ('corner', 90.0, True)
    """
    if len(model.axes) > 2:
        return None
    with ctx.workprec(PRECISE):
        balls = [exact(part) if isinstance(part, Fraction) else part for part in point]
        coordinates = dict(zip(model.builder.coordinates, (_rational(part) for part in point), strict=True))
        known = exact_at(model, balls, coordinates, zeros)
        node = same_sign(known.local, known, model.root)
        if not known.vanishes(node):
            return None
        slopes = slopes_of(known.local, known, node)
        cones = None if slopes is None else _cones(slopes)
        if slopes is None or cones is None or any(cone.before == cone.after for cone in cones):
            return None
        if len(cones) == 2 and not all(_is_crossed(slopes, cone) for cone in cones):
            return None
        return _judged((balls[0], balls[1]), cones)


def _rational(part: Number) -> Fraction | None:
    if isinstance(part, Fraction):
        return part
    if not part.is_exact():
        return None
    mantissa, exponent = part.man_exp()
    return Fraction(int(mantissa)) * Fraction(2) ** int(exponent)


def same_sign(local: Local, known: Exact, number: int) -> int:
    """A node that has the sign of the given one on the box, wherever that is defined, of order 1 where this can be."""
    done: dict[int, int] = {}
    for part in sorted(_positions(local, known, number)):
        done[part] = _same_sign(local, known, part, done)
    return done[number]


def _positions(local: Local, known: Exact, number: int) -> set[int]:
    """The nodes of which only the sign matters."""
    found: set[int] = set()
    stack = [number]
    while stack:
        part = stack.pop()
        if part not in found:
            found.add(part)
            stack.extend(_operands(local, known, part))
    return found


def _operands(local: Local, known: Exact, part: int) -> tuple[int, ...]:
    """The arguments whose signs make the sign of an operation."""
    operation, arguments, data = local.model.builder.nodes[part]
    if operation in LOGICAL | {"equivalence"}:
        return arguments[:2] if is_legal(local, part) else ()
    if operation == "mul":
        return arguments
    if operation == "normalised":
        return arguments[:1] if is_defined(local, arguments[1], but_for_thin_sets=True) else ()
    if operation in {"neg", "abs"} or (operation == "powi" and isinstance(data, int) and data > 0):
        return arguments[:1]
    if operation == "div":
        return arguments[:1] if _is_factor(local, arguments[1]) else ()
    return ()


def _is_factor(local: Local, part: int) -> bool:
    return local.nonzero(part) and is_defined(local, part)


def _same_sign(local: Local, known: Exact, part: int, done: dict[int, int]) -> int:
    builder = local.model.builder
    operation, arguments, data = builder.nodes[part]
    operands = [done[argument] for argument in _operands(local, known, part)]
    if not operands:
        is_sum_of_squares = operation == "add" and squares(local, known, part) is not None
        return builder.sqrt(part) if is_sum_of_squares else part
    first, last = operands[0], operands[-1]
    if operation in LOGICAL:
        return first if first == last else builder.make("min" if operation in CONJUNCTIONS else "max", first, last)
    if operation in {"neg", "abs"}:
        return builder.neg(first) if operation == "neg" else builder.abs(first)
    if operation == "normalised":
        return first
    if operation == "powi":
        return first if int(str(data)) % 2 else builder.abs(first)
    if operation == "div":
        return first if local.sign(arguments[1]) > 0 else builder.neg(first)
    for factor, other in ((arguments[0], last), (arguments[1], first)):
        if _is_factor(local, factor):
            return other if local.sign(factor) > 0 else builder.neg(other)
    return builder.abs(first) if first == last else builder.make("equivalence", first, last, builder.const(2))


@dataclass(frozen=True)
class Cone:
    """An arc of directions in which H may vanish, by its ends along the square, and the signs of H on either side."""

    low: float
    high: float
    before: int
    after: int

    @property
    def angle(self) -> arb:
        """The angles of its directions."""
        return _angle(self.low).union(_angle(self.high))


def _angle(along: float) -> arb:
    side = int(along // 2)
    return side * arb.pi() / 2 + arb(along - 2 * side - 1).atan()


def _direction(low: float, high: float) -> tuple[arb, arb]:
    """The directions of an arc: side k of the square [-1, 1]**2 belongs to 2 k <= along <= 2 k + 2."""
    side = int(low // 2)
    t = arb(low - 2 * side - 1).union(arb(high - 2 * side - 1))
    return ((arb(1), t), (-t, arb(1)), (arb(-1), -t), (t, arb(-1)))[side % 4]


def _is_crossed(slopes: Slopes, cone: Cone) -> bool:
    """Whether omega is strictly monotone across the cone near p, so that it holds one branch, a Lipschitz curve."""
    corner = 2.0 * math.ceil(cone.low / 2)
    ends = [cone.low, *([corner] if cone.low < corner < cone.high else []), cone.high]
    x, y = _direction(cone.low, cone.low)
    for low, high in pairwise(ends):
        found = slopes.gradient(_direction(low, high))
        across = None if found is None else found[1] * x - found[0] * y
        if across is None or not (across > 0 if cone.after > 0 else across < 0):
            return False
    return True


def _cones(slopes: Slopes) -> list[Cone] | None:
    """The arcs around the circle on which the sign of H is not proved; None if they do not become narrow."""

    def sign(low: float, high: float) -> int:
        return sign_of(slopes.at(_direction(low, high))[slopes.number])

    pieces = [(k / 2, k / 2 + 0.5, sign(k / 2, k / 2 + 0.5)) for k in range(16)]
    while max((high - low for low, high, own in pieces if own == 0), default=0) > FINEST:
        if sum(own == 0 for _, _, own in pieces) > CROWD:
            return None
        halves: list[tuple[float, float, int]] = []
        for low, high, own in pieces:
            middle = (low + high) / 2
            halves += [(low, high, own)] if own else [(a, b, sign(a, b)) for a, b in ((low, middle), (middle, high))]
        pieces = halves
    return _clusters(pieces)


def _clusters(pieces: list[tuple[float, float, int]]) -> list[Cone] | None:
    """The undecided pieces in groups of neighbours, around the circle."""
    start = next((n for n, (_, _, own) in enumerate(pieces) if own), None)
    if start is None:
        return None
    around = pieces[start:] + [(low + 8, high + 8, own) for low, high, own in pieces[: start + 1]]
    cones: list[Cone] = []
    before, open_from = around[0][2], math.nan
    for low, _, own in around[1:]:
        if own == 0:
            open_from = low if math.isnan(open_from) else open_from
            continue
        if not math.isnan(open_from):
            cones.append(Cone(open_from, low, before, own))
        elif own != before:
            return None  # two signs at a common end: impossible for closed arcs
        before, open_from = own, math.nan
    return None if any(cone.high - cone.low > NARROW for cone in cones) else cones


def _judged(point: tuple[arb, arb], cones: Sequence[Cone]) -> Joint | None:
    place = (float(point[0].mid()), float(point[1].mid()))
    radius = float(hypotenuse(arb(point[0].rad()), arb(point[1].rad())).upper())
    radius += 1e-15 * (abs(place[0]) + abs(place[1]))
    start = "the one-sided derivative of omega"
    if not cones:
        reason = f"{start} is zero in no direction"
        return Joint(place, radius, "isolated point", "broken", branches=0, proved=True, reason=reason)
    if len(cones) > 2:
        reason = f"{start} changes its sign in {len(cones)} directions"
        return Joint(place, radius, "node", "broken", branches=len(cones), proved=True, reason=reason)
    between = cones[1].angle - cones[0].angle
    turn = abs(arb.pi() - between)
    if not turn > 0:
        return None
    degrees = turn * 180 / arb.pi()
    angles = [float((cone.angle * 180 / arb.pi()).mid()) % 360 for cone in cones]
    return Joint(
        place,
        radius,
        "corner",
        "G0",
        tangent_jump=float(degrees.mid()),
        tangent_jump_error=float(arb(degrees.rad()).upper()) + 2.0**-52 * float(degrees.upper()),
        proved=True,
        reason=f"{start} is zero in two directions only, at {angles[0]:.10g} and {angles[1]:.10g} degrees, "
        "and changes its sign there",
    )
