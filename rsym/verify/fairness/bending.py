"""Curvatures and their first two derivatives along an arc F = 0: as nodes of a program, and in balls over a piece.

With the unit tangent T (the inside on the left), the unit normal N = grad F/g that points inwards, g = |grad F|, and
F_TN and the like for derivatives of F in these directions held fixed, gamma' = T, T' = k N, N' = -k T give

    k   = -F_TT/g
    k'  = -(F_TTT + 3 k F_TN)/g
    k'' = -3 k**3 - (F_TTTT + 6 k F_TTN + 3 k**2 F_NN + 4 k' F_TN)/g

by differentiating F(gamma(s)) = 0 up to four times. Each component of T and N is one operation of the program, so
that balls around these are several times narrower than those of the gradient of the quotient k. A function of the
square of a coordinate, F(x, r) = G(x, r**2), has F_r/r = 2 G', which is analytic at r = 0 too.

Between two points of an arc, k(p) is in k(q) + k'(box) (s(p) - s(q)), where the arc length s grows along the free axis
x as dx/ds, a component of the unit tangent, says: the mean value theorem.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import reduce
from itertools import pairwise
from typing import NamedTuple

import sympy as sp

from rsym.bounds.balls import arb, ctx
from rsym.program.builder import Builder
from rsym.program.calculus import Calculus
from rsym.program.differentiation import derivative
from rsym.program.expansion import SIMPLE
from rsym.program.program import live
from rsym.verify.boxes.local import Local, Model, side
from rsym.verify.boxes.polynomials import polynomial_of
from rsym.verify.fairness.pieces import POINT_BITS, ArcPiece, lies_within, point_above

SQUARE = "the square of the radius"  # an input that no program keeps
# Arcs of constant curvature, lines and circles: proved where the arc is that of a polynomial.
HIGHEST = 12  # degree of F, beyond which dividing takes longer than it is worth


@dataclass(frozen=True)
class BendingBalls:
    """Balls around a curvature and its first two derivatives along the arc."""

    value: arb
    first: arb
    second: arb


@dataclass(frozen=True)
class ArcBending:
    """A piece with its curvatures: all over it and at one point of it, if one was found.

    `own` says that the point is proved to be one of the boundary: that of a joined arc may lie on its continuation.
    """

    piece: ArcPiece
    curvatures: tuple[BendingBalls, ...]
    place: tuple[arb, ...] | None = None
    at: tuple[BendingBalls, ...] = ()
    own: bool = False


class Arcs:
    """The quantities of the arcs of a model, made once: of a body of revolution two, along the meridian and across."""

    def __init__(self, model: Model) -> None:
        self.model = model
        self._quantities: dict[int, tuple[Quantity, ...]] = {}
        self._constant: dict[int, tuple[bool, ...]] = {}
        self._tangents: dict[int, list[int]] = {}

    def quantities(self, function: int) -> tuple[Quantity, ...]:
        """The curvatures of the arc function = 0 with their derivatives, as nodes."""
        if function not in self._quantities:
            frame = CurveFrame(self.model, function)
            bending = frame.bending()
            self._tangents[function] = frame.tangent
            self._quantities[function] = (bending, frame.latitude()) if self.model.body else (bending,)
        return self._quantities[function]

    def constant(self, function: int) -> tuple[bool, ...]:
        """Which of them are proved to be constant."""
        if function not in self._constant:
            self._constant[function] = constant_curvatures(self.model, function)
        return self._constant[function]

    def enclosed(self, local: Local, function: int, orders: int = 2) -> tuple[BendingBalls, ...]:
        """Balls around the quantities on a box, and around so many derivatives: the second is the dearest."""
        found = []
        for quantity, constant in zip(self.quantities(function), self.constant(function), strict=True):
            nodes = (quantity.first, quantity.second)
            slopes = [
                arb(0) if constant else _whole(local.value(node) if order < orders else None)
                for order, node in enumerate(nodes)
            ]
            found.append(BendingBalls(_whole(local.value(quantity.value)), *slopes))
        return tuple(found)

    def bent(self, piece: ArcPiece) -> ArcBending:
        """The curvatures of a piece."""
        function, local = piece.arc.function, self.model.over(piece.box)
        natural = self.enclosed(local, function)
        if not piece.crosses or piece.free is None:
            return ArcBending(piece, natural)
        axis = side(*piece.box[piece.free])
        place = point_above(self.model, piece, axis.mid())
        if place is None:
            return ArcBending(piece, natural)
        with ctx.workprec(POINT_BITS):
            there = self.model.on(place)
            at = self.enclosed(there, function, 1)
            own = lies_within(place, piece, there)
        speed = _whole(local.value(self._tangents[function][piece.free]))
        arc = (axis - axis.mid()) / speed
        sharper = tuple(_sharper(whole, point, arc) for whole, point in zip(natural, at, strict=True))
        return ArcBending(piece, sharper, tuple(place), at, own)


def _sharper(whole: BendingBalls, at: BendingBalls, arc: arb) -> BendingBalls:
    first = _both(whole.first, at.first + whole.second * arc)
    return BendingBalls(_both(whole.value, at.value + first * arc), first, whole.second)


def _both(one: arb, other: arb) -> arb:
    """Both hold; where one says nothing the other does."""
    if not other.is_finite():
        return one
    return one.intersection(other) if one.is_finite() else other


def _whole(value: arb | None) -> arb:
    return arb(0, math.inf) if value is None or not value.is_finite() else value


def constant_curvatures(model: Model, function: int) -> tuple[bool, ...]:
    """Which curvatures of an arc are proved to be constant: along it and, for a body of revolution, across."""
    count = 2 if model.body else 1
    expression = polynomial_of(model, function)
    symbols = [sp.Symbol(name, real=True) for name in model.builder.coordinates]
    if expression is None or sp.Poly(expression, *symbols).total_degree() > HIGHEST:
        return (False,) * count
    f = sp.Poly(expression, *symbols, domain=sp.QQ)
    fx, fy = f.diff(symbols[0]), f.diff(symbols[1])
    square = fx**2 + fy**2
    bent = fx.diff(symbols[0]) * fy**2 - 2 * fx.diff(symbols[1]) * fx * fy + fy.diff(symbols[1]) * fx**2
    forms = [(bent, 3)]
    if model.body:
        ratio, rest = sp.div(fy, sp.Poly(symbols[1], *symbols, domain=sp.QQ))
        forms.append((ratio, 1) if rest.is_zero else (sp.Poly(symbols[0], *symbols, domain=sp.QQ), 0))

    def along(p: sp.Poly) -> sp.Poly:
        return fy * p.diff(symbols[0]) - fx * p.diff(symbols[1])

    changes = [2 * square * along(top) - power * top * along(square) for top, power in forms]
    return tuple(bool(sp.div(change, f)[1].is_zero) for change in changes)


class Quantity(NamedTuple):
    """A curvature and its first and second derivatives with respect to arc length, as nodes."""

    value: int
    first: int
    second: int


class CurveFrame:
    """Tangent, normal and directional derivatives of one function as nodes."""

    def __init__(self, model: Model, function: int) -> None:
        self.model, self.function = model, function
        curvatures = Calculus(model.builder, function).curvatures
        self.normal = curvatures.normal
        self.slope = curvatures.slope
        self.tangent = [self.normal[1], model.builder.neg(self.normal[0])]

    def form(self, *directions: Sequence[int]) -> int:
        """The derivative of the function in these directions, each held fixed."""
        b, order = self.model.builder, len(directions)
        partials = [self.function]
        for _ in range(order):
            gradients = [self.model.gradient(node) for node in partials]
            partials = [first for first, _ in gradients] + [gradients[-1][1]]
        for x, y in directions:
            partials = [b.add(b.mul(x, p), b.mul(y, q)) for p, q in pairwise(partials)]
        return partials[0]

    def bending(self) -> Quantity:
        """The curvature of the arc."""
        b, t, n = self.model.builder, self.tangent, self.normal
        value = self.model.curvature(self.function)
        mixed = self.form(t, n)
        first = self._over_slope(self.form(t, t, t), self._times(3, value, mixed))
        inner = [
            self.form(t, t, t, t),
            self._times(6, value, self.form(t, t, n)),
            self._times(3, b.square(value), self.form(n, n)),
            self._times(4, first, mixed),
        ]
        return Quantity(value, first, b.add(self._times(-3, b.powi(value, 3)), self._over_slope(*inner)))

    def latitude(self) -> Quantity:
        """The curvature -F_r/(r g) of the circle of latitude; F_r/r is 2 G' where F = G(r**2)."""
        b = self.model.builder
        radius = b.coordinates[1]
        ratio = derivative_in_square(b, self.function, radius)
        if ratio is None:
            ratio = b.div(self.model.gradient(self.function)[1], b.input(radius))
        value = b.neg(b.div(ratio, self.slope))
        first = self.along(value)
        return Quantity(value, first, self.along(first))

    def along(self, node: int) -> int:
        """The derivative of a node along the arc."""
        b, (x, y) = self.model.builder, self.model.gradient(node)
        return b.add(b.mul(self.tangent[0], x), b.mul(self.tangent[1], y))

    def _times(self, factor: int, *nodes: int) -> int:
        b = self.model.builder
        return b.mul(b.const(factor), reduce(b.mul, nodes))

    def _over_slope(self, *terms: int) -> int:
        b = self.model.builder
        return b.neg(b.div(reduce(b.add, terms), self.slope))


def derivative_in_square(builder: Builder, number: int, name: str) -> int | None:
    """The node 2 dG/d(r**2) of a node that is G(r**2), r the input of this name; None if it is not seen to be."""
    radius, square = builder.input(name), builder.input(SQUARE)
    inner = {radius: None, builder.square(radius): square}
    powers = {
        part: builder.powi(square, node.data // 2)
        for part in live(builder.nodes, [number])
        if (node := builder.nodes[part]).operation == "powi"
        and node.arguments == (radius,)
        and isinstance(node.data, int)
        and node.data % 2 == 0
    }
    outer = substituted(builder, number, {**inner, **powers})
    if outer is None:
        return None
    slope = derivative(builder, outer, SQUARE)
    half = substituted(builder, slope, {square: builder.square(radius)})
    return None if half is None else builder.mul(builder.const(2), half)


def substituted(builder: Builder, number: int, given: dict[int, int | None]) -> int | None:
    """The node with other nodes in the place of some; None where it needs one that is given as None."""
    done: dict[int, int | None] = {}
    for part in live(builder.nodes, [number]):
        if part in given:
            done[part] = given[part]
            continue
        operation, arguments, data = builder.nodes[part]
        inner = [done[argument] for argument in arguments]
        known = [argument for argument in inner if argument is not None]
        if len(known) < len(inner):
            done[part] = None
        else:
            done[part] = part if tuple(known) == arguments else _made(builder, operation, known, data)
    return done[number]


def _made(builder: Builder, operation: str, arguments: list[int], data: object) -> int:
    if operation in SIMPLE:
        return SIMPLE[operation](builder, *arguments)
    if operation == "powi":
        return builder.powi(arguments[0], int(str(data)))
    if operation == "div":
        return builder.div(*arguments)
    return builder.make(operation, *arguments, data=data)  # type: ignore[arg-type]
