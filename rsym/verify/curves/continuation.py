"""Certified continuation: tubes in space, each of which holds one arc of a curve {F = 0, G = 0} and nothing else of it.

A tube follows a chord x(t), t one coordinate of space. Krawczyk's operator in the other two coordinates, with t in an
interval, proves that for every t there is exactly one point of the curve within `reach` of the chord. A point of the
curve in two tubes belongs to both arcs, so tubes are linked where the end of one lies in the next, and a curve is
closed when a tube holds its first point again, ahead of the last.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from operator import mul

import numpy as np

from rsym.arrays import Floats
from rsym.bounds.balls import arb, ball
from rsym.model.vectors import cross
from rsym.verify.boxes.generators import generators
from rsym.verify.boxes.krawczyk import Point, image, inverse, refined, unique_zero
from rsym.verify.boxes.local import Local, Model
from rsym.verify.boxes.vectors import sign_of

# A tube is longer than its chord by this share at either end, so that tubes overlap.
OVERLAP = 0.125
# Newton's method ends with a step below this share of the extent, and fails after so many steps.
_SETTLED, _STEPS = 2.0**-46, 12
# A point known to this share of the extent is known well enough: narrower than floats tell.
_NARROW = 2.0**-64
# Half widths, in shares of the extent, of the boxes in which a point is proved to be the only one.
_ROOMS = (2.0**-40, 2.0**-28, 2.0**-16, 2.0**-8, 2.0**-5)


@dataclass(frozen=True)
class Knot:
    """A point of the curve: the only one in its box, of which the side along `axis` is a number.

    `tangent` is near the unit vector along grad F x grad G. A corner has no axis: it was given.
    """

    sides: Point
    axis: int | None
    tangent: Floats

    @cached_property
    def middle(self) -> Floats:
        """The point, rounded."""
        return np.array([float(side.mid()) for side in self.sides])

    @property
    def radius(self) -> float:
        """How far the point may lie from its middle."""
        radii = [float(arb(side.rad()).upper()) for side in self.sides]
        return float(np.linalg.norm(radii) + 2.0**-51 * np.linalg.norm(self.middle))


@dataclass(frozen=True)
class Tube:
    """For every value in `span` of one coordinate, one point of the curve lies within `reach` of a chord.

    The chord passes `middle` with dx/dt = `slope`; the other two coordinates of the point are even within `width`.
    Along grad F x grad G the coordinate grows if `sense` is 1, and falls if it is -1.
    """

    axis: int
    span: tuple[float, float]
    middle: Floats
    slope: Floats
    reach: float
    width: float
    sense: int

    def over(self, low: float, high: float, radius: float) -> Point:
        """The box around the part of the tube over an interval."""
        t = ball(arb(low), arb(high))
        return tuple(t if axis == self.axis else self._chord(axis, t) + arb(0, radius) for axis in range(3))

    def _chord(self, axis: int, t: arb) -> arb:
        return arb(self.middle[axis]) + arb(self.slope[axis]) * (t - arb(self.middle[self.axis]))

    def contains(self, sides: Sequence[arb]) -> bool:
        """Whether a box lies in the tube, where the curve is one arc."""
        t = sides[self.axis]
        if not (t > self.span[0] and t < self.span[1]):
            return False
        return all(abs(sides[axis] - self._chord(axis, t)) < self.reach for axis in others(self.axis))

    def is_near(self, knot: Knot) -> bool:
        """Whether a point seems to lie on the arc; no proof."""
        t = float(knot.middle[self.axis])
        gap = np.abs(self.middle + self.slope * (t - self.middle[self.axis]) - knot.middle).max()
        return self.span[0] <= t <= self.span[1] and bool(gap <= self.width + knot.radius)


def others(axis: int) -> list[int]:
    """The other two axes."""
    return [other for other in range(3) if other != axis]


class ZeroCurve:
    """The common zeros of two nodes in space, for all letters in their ranges."""

    def __init__(self, model: Model, pair: tuple[int, int], rest: Sequence[arb], extent: float) -> None:
        self.model, self.pair, self.rest, self.extent = model, pair, list(rest), extent
        self._slopes = (*model.gradient(pair[0]), *model.gradient(pair[1]))

    def on(self, sides: Sequence[arb]) -> Local:
        """What is known on a box in space."""
        return self.model.on([*sides, *self.rest])

    def values(self, local: Local) -> list[arb]:
        """Both values on a box."""
        return local.balls(self.pair)

    def slopes(self, local: Local) -> list[list[arb]]:
        """Both gradients on a box."""
        found = local.balls(self._slopes)
        return [found[:3], found[3:]]

    def is_analytic(self, local: Local) -> bool:
        """Whether both nodes are analytic on a box."""
        return all(generators(local, number).analytic for number in self.pair)

    def is_unique(self, sides: Sequence[arb], axis: int) -> bool:
        """Whether a box has at most one point of the curve for every value along an axis: regular slopes across it."""
        local = self.on(sides)
        if not self.is_analytic(local):
            return False
        across = [[row[other] for other in others(axis)] for row in self.slopes(local)]
        near = inverse(across)
        if near is None:
            return False
        unit = (arb(0, 1), arb(0, 1))
        moved = image(near, [arb(0), arb(0)], across, unit)
        return moved is not None and all(abs(one) < 1 for one in moved)

    def newton(self, point: Floats, axis: int | None = None) -> Floats | None:
        """The point of the curve that Newton's method finds, without moving along `axis`; no proof."""
        free = [0, 1, 2] if axis is None else others(axis)
        found = point.tolist()
        for _ in range(_STEPS):
            local = self.on([arb(value) for value in found])
            f, g = (float(one.mid()) for one in self.values(local))
            rows = [[float(row[one].mid()) for one in free] for row in self.slopes(local)]
            a, b, c = (sum(map(mul, rows[i], rows[j])) for i, j in ((0, 0), (0, 1), (1, 1)))
            determinant = a * c - b * b
            if not (determinant > 0 and math.isfinite(f) and math.isfinite(g)):  # NaN too
                return None
            u, v = (c * f - b * g) / determinant, (a * g - b * f) / determinant
            steps = [u * one + v * other for one, other in zip(*rows, strict=True)]
            for other, step in zip(free, steps, strict=True):
                found[other] -= step
            if max(map(abs, steps)) <= _SETTLED * self.extent:
                return np.array(found)
        return None

    def tangent(self, sides: Sequence[arb]) -> Sequence[arb]:
        """Grad F x grad G."""
        return cross(*self.slopes(self.on(sides)))

    def knot(self, point: Floats, axis: int, tube: Tube | None = None) -> Knot | None:
        """The point of the curve close to a point with the same coordinate along an axis, proved; in the tube if given.

        Where letters range it may move further than the tube is wide: then there is none.
        """
        free = others(axis)
        for room in _ROOMS:
            box = [arb(value) for value in point.tolist()]
            for other in free:
                box[other] += arb(0, room * self.extent)
            if tube is not None and not tube.contains(box):
                break
            found = self._only(box, axis)
            if found is not None:
                return self._knot(found, axis)
        if tube is None or axis != tube.axis:
            return None
        value = float(point[axis])
        return self._knot(self.narrowed(tube.over(value, value, tube.width), axis), axis)

    def _knot(self, sides: Point, axis: int) -> Knot:
        tangent = np.array([float(one.mid()) for one in self.tangent(sides)])
        return Knot(sides, axis, tangent / (np.linalg.norm(tangent) or 1))

    def _only(self, box: Sequence[arb], axis: int) -> Point | None:
        section = _Section(self, box[axis], axis)
        zero = unique_zero(section.values, section.jacobian, tuple(box[other] for other in others(axis)))
        if zero is None or not zero.exists or not self.is_analytic(self.on(box)):
            return None
        if all(float(arb(part.rad())) < _NARROW * self.extent for part in zero.box):
            return section.whole(zero.box)
        return section.whole(refined(section.values, section.jacobian, zero.box))

    def narrowed(self, box: Sequence[arb], axis: int) -> Point:
        """The box of the only point with a given coordinate along an axis, as narrow as the precision allows."""
        section = _Section(self, box[axis], axis)
        return section.whole(refined(section.values, section.jacobian, tuple(box[other] for other in others(axis))))

    def tube(self, knot: Knot, end: Floats, axis: int, reach: float) -> Tube | None:
        """The tube around a chord from a knot, if the curve is proved to pass it; `reach` is how wide it is to be."""
        start = knot.middle
        run = float(end[axis] - start[axis])
        middle, slope = (start + end) / 2, (end - start) / run
        slope[axis] = 1.0
        spread = 2 * float(arb(knot.sides[axis].rad()).upper())
        low, high = sorted((float(start[axis]) - OVERLAP * run, float(end[axis]) + OVERLAP * run))
        low, high = min(low, float(start[axis]) - spread), max(high, float(start[axis]) + spread)
        tube = Tube(axis, (low, high), middle, slope, reach, reach, 0)
        local = self.on(tube.over(low, high, reach))
        if not self.is_analytic(local):
            return None
        slopes = self.slopes(local)
        across = [[row[other] for other in others(axis)] for row in slopes]
        near = inverse(across)
        if near is None:
            return None
        along = [
            sum((one * arb(rate) for one, rate in zip(row, slope.tolist(), strict=True)), arb(0)) for row in slopes
        ]
        t = ball(arb(low), arb(high)) - arb(middle[axis])
        centre = self.values(self.on([arb(value) for value in middle.tolist()]))
        room = arb(0, reach)
        moved = image(near, [v + rate * t for v, rate in zip(centre, along, strict=True)], across, (room, room))
        if moved is None or not all(abs(side) < reach for side in moved):
            return None
        width = max(float(abs(side).upper()) for side in moved)
        return replace(tube, width=width * (1 + 2.0**-50), sense=_sense(across, axis))


class _Section:
    """The two equations in the plane where one coordinate has a value."""

    def __init__(self, curve: ZeroCurve, value: arb, axis: int) -> None:
        self._curve, self._value, self._axis = curve, value, axis

    def whole(self, point: Point) -> Point:
        sides = list(point)
        sides.insert(self._axis, self._value)
        return tuple(sides)

    def values(self, point: Point) -> list[arb]:
        return self._curve.values(self._curve.on(self.whole(point)))

    def jacobian(self, point: Point) -> list[list[arb]]:
        slopes = self._curve.slopes(self._curve.on(self.whole(point)))
        return [[row[other] for other in others(self._axis)] for row in slopes]


def _sense(across: Sequence[Sequence[arb]], axis: int) -> int:
    """The sign of grad F x grad G along an axis: one for all matrices of a regular set, so that of the middle."""
    (a, b), (c, d) = [[entry.mid() for entry in row] for row in across]
    return sign_of((b * c - a * d) if axis == 1 else (a * d - b * c))
