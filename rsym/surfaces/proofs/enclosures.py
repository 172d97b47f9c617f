"""What two patches are along a stretch of their common edge, enclosed by balls on intervals that cover it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any

from rsym.codegen.ball_series import SeriesFunction, arb, truncated
from rsym.codegen.balls import ball, exact, square
from rsym.surfaces.proofs.sides import (
    Side,
    Vector,
    cross,
    curvature,
    difference,
    dot,
    facing_normals,
    jump_numerator,
    jump_slack,
    sides,
)
from rsym.surfaces.proofs.specialised import Part

# Sixteen terms and 160 bits: on a quarter of an edge the remainder of a biquintic patch is gone, that of a
# quarter of a circle 1e-20; balls then hold 1e-30 of what they enclose.
ORDER, BITS = 16, 160
# Parts of the stretch, each half of one before: a pole is left out within 1/1024 of the edge.
DEEPEST = 10
# Dividing so deep for nothing stops after this many intervals; a stretch without a proof has hundreds.
MOST_FAILED = 4


@dataclass
class Bounds:
    """The greatest gap, sine of the angle and jump of curvature: no more than `most` everywhere, `least` at `places`.

    `open` are intervals of t on which a normal, or a bound that was asked for, is not enclosed.
    """

    most: list[float] = field(default_factory=lambda: [0.0] * 3)
    least: list[float] = field(default_factory=lambda: [0.0] * 3)
    places: list[Fraction] = field(default_factory=lambda: [Fraction(0)] * 3)
    folded: Fraction | None = None
    open: list[Part] = field(default_factory=list)
    examined: int = 0


class Pair:
    """Both patches on one part of the edge, where neither has pieces."""

    def __init__(self, nodes: Sequence[Any], outputs: Sequence[int], part: Part) -> None:
        self.nodes, self.outputs, self.part = nodes, tuple(outputs), part
        self.function = SeriesFunction(nodes, outputs)

    def sides(self, place: Any) -> tuple[Side, Side] | None:
        """The series of both at a ball, where all of them exist."""
        values = [one for one in self.function(place) if one is not None]
        whole = len(values) == len(self.outputs) and all(one[k].is_finite() for one in values for k in (0, ORDER))
        return sides(values) if whole else None


def survey(pair: Pair, rooms: Sequence[float | None], bounds: Bounds) -> None:
    """Cover a part of the edge and bound what is asked for: rooms has None for what is known to vanish.

    A part is divided until its normals are enclosed and what is asked for is below its room, or proved to be above it.
    """
    stack, failed = [(*pair.part, 0)], 0
    while stack:
        start, stop, depth = stack.pop()
        bounds.examined += 1
        done = _examined(pair, (start, stop), rooms, bounds)
        if done or (depth < DEEPEST and failed < MOST_FAILED):
            middle = (start + stop) / 2
            stack += [] if done else [(middle, stop, depth + 1), (start, middle, depth + 1)]
            continue
        failed += 1
        _leave(bounds, (start, stop))


def _leave(bounds: Bounds, part: Part) -> None:
    """Add an interval on which nothing is known, to the last one if it goes on there."""
    if bounds.open and bounds.open[-1][1] == part[0]:
        part = (bounds.open.pop()[0], part[1])
    bounds.open.append(part)


def look(pair: Pair, place: Fraction, rooms: Sequence[float | None], bounds: Bounds) -> None:
    """Bound what is asked for from below at one place."""
    with truncated(0, BITS):
        values = pair.function(exact(place))
        if all(one is not None and one[0].is_finite() for one in values):
            first, second = sides(values)
            _from_below(first, second, place, rooms, bounds)


def _examined(pair: Pair, part: Part, rooms: Sequence[float | None], bounds: Bounds) -> bool:
    """Whether everything is enclosed on an interval."""
    middle, radius = (part[0] + part[1]) / 2, (part[1] - part[0]) / 2
    with truncated(ORDER, BITS):
        model = _Model.of(pair, middle, radius)
        if model is None:
            return False
        least = [model.least_square(side) for side in (0, 1)]
        if any(one is None for one in least):
            return False
        return _bounded(model, least, middle, rooms, bounds)


def _bounded(model: _Model, least: Sequence[Any], middle: Fraction, rooms: Sequence[Any], bounds: Bounds) -> bool:
    """Whether what is asked for is no greater than its room, or proved to be greater; the bounds grow."""
    _from_below(*model.middle, middle, rooms, bounds)
    settled, most = True, [0.0] * 3
    for level, room in enumerate(rooms):
        if room is None:
            continue
        most[level] = _up(_GREATEST[level](model, least))
        settled &= most[level] <= room or bounds.least[level] > room
    if settled:
        bounds.most = [max(pair) for pair in zip(bounds.most, most, strict=True)]
    return settled


def _from_below(first: Side, second: Side, place: Fraction, rooms: Sequence[Any], bounds: Bounds) -> None:
    """What is asked for at one place, from series there."""
    normals = [[one[0] for one in side.normal] for side in (first, second)]
    lengths = [dot(one, one) for one in normals]
    gap = _length([one[0] for one in difference(first.point, second.point)])
    _raise(bounds, 0, gap, place, rooms)
    if not all(one > 0 for one in lengths):
        return
    product = lengths[0].sqrt() * lengths[1].sqrt()
    if rooms[1] is not None:
        _raise(bounds, 1, _length(cross(*normals)) / product, place, rooms)
    if dot(*normals) > 0:
        bounds.folded = place
    if rooms[2] is not None:
        roots = [one.sqrt() for one in lengths]
        values = [Side(*([x[0] for x in vector] for vector in side)) for side in (first, second)]
        one, other = (curvature(side, length) for side, length in zip(values, roots, strict=True))
        _raise(bounds, 2, abs(one + other), place, rooms)


def _raise(bounds: Bounds, level: int, value: Any, place: Fraction, rooms: Sequence[Any]) -> None:
    least = _down(value)
    if rooms[level] is not None and least > bounds.least[level]:
        bounds.least[level], bounds.places[level] = least, place


@dataclass(frozen=True)
class _Model:
    """Taylor models of both patches on an interval: series at the middle, and over the whole for the remainder."""

    middle: tuple[Side, Side]
    whole: tuple[Side, Side]
    steps: Sequence[Any]

    @classmethod
    def of(cls, pair: Pair, middle: Fraction, radius: Fraction) -> _Model | None:
        half = exact(radius)
        here, all_over = pair.sides(exact(middle)), pair.sides(ball(exact(middle) - half, exact(middle) + half))
        if here is None or all_over is None:
            return None
        powers = [arb(1)]
        for _ in range(ORDER):
            powers.append(powers[-1] * half)
        steps = [ball(-one if k % 2 else arb(0), one) if k else one for k, one in enumerate(powers)]
        return cls(here, all_over, steps)

    def enclosed(self, middle: Any, whole: Any) -> Any:
        """A ball for a function on the interval, from its two series."""
        terms = [middle[k] * self.steps[k] for k in range(ORDER)]
        return sum(terms, whole[ORDER] * self.steps[ORDER])

    def vector(self, middle: Vector, whole: Vector) -> list[Any]:
        """Balls for three coordinates."""
        return [self.enclosed(*one) for one in zip(middle, whole, strict=True)]

    def least_square(self, side: int) -> Any | None:
        """A positive lower bound of |N|**2."""
        normals = [one[side].normal for one in (self.middle, self.whole)]
        square = self.enclosed(*(dot(one, one) for one in normals))
        return square.lower() if square > 0 else None

    def gap(self, least: Sequence[Any]) -> Any:
        """The distance."""
        return _length(self.vector(*(difference(one[0].point, one[1].point) for one in (self.middle, self.whole))))

    def sine(self, least: Sequence[Any]) -> Any:
        """The sine of the angle between the normals; infinite where one may be folded back."""
        pairs = [[side.normal for side in one] for one in (self.middle, self.whole)]
        if not self.enclosed(*(dot(*one) for one in pairs)) < 0:
            return arb("inf")
        return _length(self.vector(*(cross(*one) for one in pairs))) / (least[0].sqrt() * least[1].sqrt())

    def jump(self, least: Sequence[Any]) -> Any:
        """The difference of the normal curvatures across the edge; see `sides.jump_numerator`."""
        speeds = [self.enclosed(*(dot(one[side].along, one[side].along) for one in self._both)) for side in (0, 1)]
        facing = self.enclosed(*(facing_normals(*one) for one in self._both))
        if not (facing > 0 and all(speed > 0 for speed in speeds)):
            return arb("inf")
        crossed = _length(self.vector(*(cross(*(side.normal for side in one)) for one in self._both)))
        numerator = self.enclosed(*(jump_numerator(*one) for one in self._both))
        slack = self.enclosed(*(jump_slack(*one) for one in self._both))
        above = abs(numerator) + abs(slack) * square(crossed) / (2 * facing.lower())
        below = speeds[0].lower() * speeds[1].lower() * square(least[0]) * least[1] * least[1].sqrt()
        return above / below

    @property
    def _both(self) -> tuple[tuple[Side, Side], tuple[Side, Side]]:
        return self.middle, self.whole


_GREATEST = (_Model.gap, _Model.sine, _Model.jump)


def _length(vector: Sequence[Any]) -> Any:
    """The length of balls; of one that may be zero the ball begins there."""
    return sum((square(one) for one in vector), arb(0)).nonnegative_part().sqrt()


def _up(value: Any) -> float:
    """A float that is no less than anything in a ball."""
    high = float(value.upper())
    return math.nextafter(high, math.inf) if math.isfinite(high) else math.inf


def _down(value: Any) -> float:
    """A float that is no more than anything in a ball of sizes."""
    low = float(value.lower())
    return max(0.0, math.nextafter(low, -math.inf)) if math.isfinite(low) else 0.0
