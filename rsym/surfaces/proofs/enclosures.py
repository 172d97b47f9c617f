"""What two patches are along a stretch of their common edge, enclosed by balls on intervals that cover it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any

from rsym.bounds.ball_series import SeriesFunction, arb, truncated
from rsym.bounds.balls import ball, exact, square
from rsym.model.vectors import cross
from rsym.surfaces.proofs.sides import (
    Side,
    Vector,
    curvature,
    difference,
    dot,
    facing_normals,
    jump_numerator,
    jump_slack,
    linkage,
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
class DifferenceBounds:
    """The greatest gap, sine of the angle and jump of curvature: no more than `most` everywhere, `least` at `places`.

    `open` are intervals of t on which a normal, or a bound that was asked for, is not enclosed. On all others |N|**2 of
    both patches is at least `squares`, and |T|**2 of the first at most `speed`.
    """

    rooms: Sequence[float]
    most: list[float] = field(default_factory=lambda: [0.0] * 3)
    least: list[float] = field(default_factory=lambda: [0.0] * 3)
    places: list[Fraction] = field(default_factory=lambda: [Fraction(0)] * 3)
    folded: Fraction | None = None
    open: list[Part] = field(default_factory=list)
    squares: list[float] = field(default_factory=lambda: [math.inf] * 2)
    speed: float = 0.0
    # Whether the tangent planes are known to agree.
    flat: bool = False

    @property
    def alive(self) -> int:
        """How many of the levels are not refuted."""
        held = [least <= room for least, room in zip(self.least, self.rooms, strict=True)]
        held[1] &= self.folded is None
        return [*held, False].index(False)


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


def survey(pair: Pair, wanted: Sequence[bool], bounds: DifferenceBounds) -> None:
    """Cover a part of the edge, enclose the normals there and bound the levels that are wanted.

    A part is divided until what is asked for is below its room, or proved to be above it.
    """
    stack, failed = [(*pair.part, 0)], 0
    while stack:
        start, stop, depth = stack.pop()
        done = _examined(pair, (start, stop), wanted, bounds)
        if done or (depth < DEEPEST and failed < MOST_FAILED):
            middle = (start + stop) / 2
            stack += [] if done else [(middle, stop, depth + 1), (start, middle, depth + 1)]
            continue
        failed += 1
        _leave(bounds, (start, stop))


def _leave(bounds: DifferenceBounds, part: Part) -> None:
    """Add an interval on which nothing is known, to the last one if it goes on there."""
    if bounds.open and bounds.open[-1][1] == part[0]:
        part = (bounds.open.pop()[0], part[1])
    bounds.open.append(part)


def look(pair: Pair, place: Fraction, bounds: DifferenceBounds) -> None:
    """Bound all levels from below at one place."""
    with truncated(0, BITS):
        values = [one for one in pair.function(exact(place)) if one is not None]
        if len(values) == len(pair.outputs) and all(one[0].is_finite() for one in values):
            _from_below(*sides(values), place, bounds)


def _examined(pair: Pair, part: Part, wanted: Sequence[bool], bounds: DifferenceBounds) -> bool:
    """Whether everything is enclosed on an interval; of edges with a kink that is the gap alone."""
    middle, radius = (part[0] + part[1]) / 2, (part[1] - part[0]) / 2
    with truncated(ORDER, BITS):
        model = _Model.of(pair, middle, radius)
        if model is None:
            return False
        _from_below(*model.middle, middle, bounds)
        if bounds.alive < 2:
            return bounds.alive == 0 or not wanted[0] or _bounded(model, (), wanted[:1], bounds)
        least = [square for side in (0, 1) if (square := model.least_square(side)) is not None]
        if len(least) < 2 or not _bounded(model, least, wanted, bounds):
            return False
        bounds.squares = [min(old, _down(new)) for old, new in zip(bounds.squares, least, strict=True)]
        bounds.speed = max(bounds.speed, _up(model.speed(0)))
    return True


def _bounded(model: _Model, least: Sequence[Any], wanted: Sequence[bool], bounds: DifferenceBounds) -> bool:
    """Whether what is wanted is no greater than its room, or proved to be greater; the bounds grow."""
    most = [0.0] * 3
    for level, asked in enumerate(wanted):
        if asked and level < bounds.alive:
            most[level] = _up(model.greatest(level, least, bounds.flat))
            if not most[level] <= bounds.rooms[level]:
                return False
    bounds.most = [max(pair) for pair in zip(bounds.most, most, strict=True)]
    return True


def _from_below(first: Side, second: Side, place: Fraction, bounds: DifferenceBounds) -> None:
    """All levels at one place, from series there: the angle where the points agree, the jump where planes do."""
    first, second = (Side(*([one[0] for one in vector] for vector in side)) for side in (first, second))
    gap = _length(difference(first.point, second.point))
    _raise(bounds, 0, gap, place)
    normals = first.normal, second.normal
    squares = [dot(one, one) for one in normals]
    if not (gap <= bounds.rooms[0] and all(one > 0 for one in squares)):
        return
    roots = [one.sqrt() for one in squares]
    sine = _length(cross(*normals)) / (roots[0] * roots[1])
    _raise(bounds, 1, sine, place)
    if dot(*normals) > 0:
        bounds.folded = place
    elif sine <= bounds.rooms[1]:
        one, other = (curvature(side, root) for side, root in zip((first, second), roots, strict=True))
        _raise(bounds, 2, abs(one + other), place)


def _raise(bounds: DifferenceBounds, level: int, value: Any, place: Fraction) -> None:
    least = _down(value)
    if least > bounds.least[level]:
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
        normals = [one[side].normal for one in self._both]
        square = self.enclosed(*(dot(one, one) for one in normals))
        return square.lower() if square > 0 else None

    def speed(self, side: int) -> Any:
        """|T|**2."""
        return self.enclosed(*(dot(one[side].along, one[side].along) for one in self._both))

    def greatest(self, level: int, least: Sequence[Any], flat: bool) -> Any:
        """A ball for the gap, the sine of the angle or the jump of curvature; least: bounds of both |N|**2."""
        if level < 2:
            return self.sine(least) if level else self.gap()
        return self.linked_jump(least) if flat else self.jump(least)

    def linked_jump(self, least: Sequence[Any]) -> Any:
        """The difference of the normal curvatures across the edge, where tangent planes agree; see `sides.linkage`."""
        numerator = self.enclosed(*(linkage(*one) for one in self._both))
        return abs(numerator) * self.speed(0).upper() / (least[0] * least[0].sqrt() * least[1])

    def gap(self) -> Any:
        """The distance."""
        return _length(self.vector(*(difference(one[0].point, one[1].point) for one in self._both)))

    def sine(self, least: Sequence[Any]) -> Any:
        """The sine of the angle between the normals; infinite where one may be folded back."""
        pairs = [[side.normal for side in one] for one in self._both]
        if not self.enclosed(*(dot(*one) for one in pairs)) < 0:
            return arb("inf")
        return _length(self.vector(*(cross(*one) for one in pairs))) / (least[0].sqrt() * least[1].sqrt())

    def jump(self, least: Sequence[Any]) -> Any:
        """The difference of the normal curvatures across the edge; see `sides.jump_numerator`."""
        speeds = self.speed(0), self.speed(1)
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
