"""Balls around the curvatures and their derivatives on a piece, by the mean value theorem along the arc.

Between two points of an arc, k(p) is in k(q) + k'(box) (s(p) - s(q)), where the arc length s grows along the free axis
x as dx/ds, a component of the unit tangent, says.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from rsym.bounds.balls import arb, ctx
from rsym.verify.fairness.constancy import constant_curvatures
from rsym.verify.fairness.pieces import POINT_BITS, ArcPiece, lies_within, point_above
from rsym.verify.fairness.quantities import Frame, Quantity
from rsym.verify.local import Local, Model, side


@dataclass(frozen=True)
class Enclosed:
    """Balls around a curvature and its first two derivatives along the arc."""

    value: arb
    first: arb
    second: arb


@dataclass(frozen=True)
class Bent:
    """A piece with its curvatures: all over it and at one point of it, if one was found.

    `own` says that the point is proved to be one of the boundary: that of a joined arc may lie on its continuation.
    """

    piece: ArcPiece
    curvatures: tuple[Enclosed, ...]
    place: tuple[arb, ...] | None = None
    at: tuple[Enclosed, ...] = ()
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
            frame = Frame(self.model, function)
            bending = frame.bending()
            self._tangents[function] = frame.tangent
            self._quantities[function] = (bending, frame.latitude()) if self.model.body else (bending,)
        return self._quantities[function]

    def constant(self, function: int) -> tuple[bool, ...]:
        """Which of them are proved to be constant."""
        if function not in self._constant:
            self._constant[function] = constant_curvatures(self.model, function)
        return self._constant[function]

    def enclosed(self, local: Local, function: int, orders: int = 2) -> tuple[Enclosed, ...]:
        """Balls around the quantities on a box, and around so many derivatives: the second is the dearest."""
        found = []
        for quantity, constant in zip(self.quantities(function), self.constant(function), strict=True):
            nodes = (quantity.first, quantity.second)
            slopes = [
                arb(0) if constant else _whole(local.value(node) if order < orders else None)
                for order, node in enumerate(nodes)
            ]
            found.append(Enclosed(_whole(local.value(quantity.value)), *slopes))
        return tuple(found)

    def bent(self, piece: ArcPiece) -> Bent:
        """The curvatures of a piece."""
        function, local = piece.arc.function, self.model.over(piece.box)
        natural = self.enclosed(local, function)
        if not piece.crosses or piece.free is None:
            return Bent(piece, natural)
        axis = side(*piece.box[piece.free])
        place = point_above(self.model, piece, axis.mid())
        if place is None:
            return Bent(piece, natural)
        with ctx.workprec(POINT_BITS):
            there = self.model.on(place)
            at = self.enclosed(there, function, 1)
            own = lies_within(place, piece, there)
        speed = _whole(local.value(self._tangents[function][piece.free]))
        arc = (axis - axis.mid()) / speed
        sharper = tuple(_sharper(whole, point, arc) for whole, point in zip(natural, at, strict=True))
        return Bent(piece, sharper, tuple(place), at, own)


def _sharper(whole: Enclosed, at: Enclosed, arc: arb) -> Enclosed:
    first = _both(whole.first, at.first + whole.second * arc)
    return Enclosed(_both(whole.value, at.value + first * arc), first, whole.second)


def _both(one: arb, other: arb) -> arb:
    """Both hold; where one says nothing the other does."""
    if not other.is_finite():
        return one
    return one.intersection(other) if one.is_finite() else other


def _whole(value: arb | None) -> arb:
    return arb(0, math.inf) if value is None or not value.is_finite() else value
