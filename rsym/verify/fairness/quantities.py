"""Curvatures and their first two derivatives along an arc F = 0 as nodes of a program.

With the unit tangent T (the inside on the left), the unit normal N = grad F/g that points inwards, g = |grad F|, and
F_TN and the like for derivatives of F in these directions held fixed, gamma' = T, T' = k N, N' = -k T give

    k   = -F_TT/g
    k'  = -(F_TTT + 3 k F_TN)/g
    k'' = -3 k**3 - (F_TTTT + 6 k F_TTN + 3 k**2 F_NN + 4 k' F_TN)/g

by differentiating F(gamma(s)) = 0 up to four times. Each component of T and N is one operation of the program, so
that balls around these are several times narrower than those of the gradient of the quotient k.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import reduce
from itertools import pairwise
from typing import NamedTuple

from rsym.program.calculus import Calculus
from rsym.verify.boxes.local import Model
from rsym.verify.fairness.even import derivative_in_square


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
