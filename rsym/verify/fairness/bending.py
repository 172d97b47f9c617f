"""Balls around the curvatures and their derivatives on a piece, by the mean value theorem along the arc.

Between two points of an arc, k(p) is in k(q) + k'(box) (s(p) - s(q)), where the arc length s grows along the free axis
x as dx/ds, a component of the unit tangent, says.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import sympy as sp

from rsym.bounds.balls import arb, ctx
from rsym.verify.boxes.local import Local, Model, side
from rsym.verify.boxes.polynomials import polynomial_of
from rsym.verify.fairness.pieces import POINT_BITS, ArcPiece, lies_within, point_above
from rsym.verify.fairness.quantities import CurveFrame, Quantity


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


# Arcs of constant curvature, lines and circles: proved where the arc is that of a polynomial.
HIGHEST = 12  # degree of F, beyond which dividing takes longer than it is worth


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
