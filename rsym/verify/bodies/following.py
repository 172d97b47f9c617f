"""Following a curve in space tube by tube, until it closes, leaves the boxes it is sought in, or meets a corner."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from rsym.verify.bodies.continuation import Curve, Knot, Tube
from rsym.verify.bodies.region import Region

Array = NDArray[np.float64]

# In shares of the extent: a polyline of longer steps does not look smooth in a picture; shorter ones lead nowhere.
LONGEST, SHORTEST = 2.0**-6, 2.0**-26
# A closed curve has at least 32 points.
TURN = 2 * math.pi / 32
# How fast steps grow where the last one was easy.
_GROWTH = 1.5
_MOST = 20_000
# An end is first looked for by halving to this share of the extent, then on the face that the curve crosses there.
# Where it grazes the face it is halved to the second one, which is also how far the last tube goes beyond an end.
_NEAR, ACCURACY = 2.0**-20, 2.0**-30
_HALVINGS = 40


@dataclass(frozen=True)
class Path:
    """What was followed: knots, the tubes between them, and how it ended: "closed", "face", "corner" or "lost"."""

    knots: list[Knot]
    tubes: list[Tube]
    end: str


class _Step(NamedTuple):
    knot: Knot
    tube: Tube
    end: str


class Walk:
    """The way along a curve from one of its points, `sense` 1 along grad F x grad G, -1 against it."""

    def __init__(self, curve: Curve, region: Region, start: Knot, sense: int, corners: Sequence[Knot]) -> None:
        self.curve, self.region, self.start, self.sense, self.corners = curve, region, start, sense, corners

    def path(self) -> Path:
        """Follow the curve to its end."""
        knots, tubes = [self.start], []
        longest = LONGEST * self.curve.extent
        length = longest
        while len(knots) < _MOST:
            step = self._step(knots[-1], length)
            if step is None:
                length /= 2
                if length < SHORTEST * self.curve.extent:
                    break
                continue
            if step.knot is not knots[-1]:
                knots.append(step.knot)
                tubes.append(step.tube)
            if step.end:
                return Path(knots, tubes, step.end)
            turn = _angle(knots[-2].tangent, step.knot.tangent)
            length = min(longest, length * min(_GROWTH, 0.9 * TURN / max(turn, 1e-9)))
        return Path(knots, tubes, "lost")

    def _step(self, knot: Knot, length: float) -> _Step | None:
        """One step of about a length; None where it cannot be proved or bends too much."""
        curve, direction = self.curve, knot.tangent * self.sense
        axis = int(np.abs(direction).argmax())
        target = curve.newton(knot.middle + length * direction, axis)
        if target is None or np.linalg.norm(target - knot.middle) > 2 * length:
            return None
        tube = curve.tube(knot.middle, target, axis, length)
        if tube is None or not tube.contains(knot.sides):
            return None
        ahead = 1 if target[axis] > knot.middle[axis] else -1
        if tube.sense * self.sense != ahead:
            return None
        step = self._met(knot, tube, ahead) or self._inside(knot, tube, target) or self._leaving(knot, tube, target)
        return step if step is not None and self._covers(step.tube, knot, step.knot) else None

    def _met(self, knot: Knot, tube: Tube, ahead: int) -> _Step | None:
        """The first point of the curve, or a corner on it, that the tube holds ahead of the last knot."""
        met = []
        for known in (self.start, *self.corners):
            advance = (known.sides[tube.axis] - knot.sides[tube.axis]) * ahead
            if advance > 0 and tube.contains(known.sides):
                met.append((float(advance.mid()), known))
        if not met:
            return None
        first = min(met, key=lambda pair: pair[0])[1]
        return _Step(first, tube, "closed" if first is self.start else "corner")

    def _inside(self, knot: Knot, tube: Tube, target: Array) -> _Step | None:
        if not self.region.holds(target):
            return None
        found = self.curve.knot(target, tube.axis, tube)
        if found is None or _angle(knot.tangent, found.tangent) > TURN:
            return None
        return _Step(found, tube, "")

    def _leaving(self, knot: Knot, tube: Tube, target: Array) -> _Step | None:
        """The end of the curve on the face through which it leaves the boxes."""
        if self.region.holds(target):
            return None
        found = self._end(knot.middle, target, tube)
        if found is None:
            return None
        if np.linalg.norm(found.middle - knot.middle) < 4 * ACCURACY * self.curve.extent:
            return _Step(knot, tube, "face")
        return _Step(found, _cut(tube, knot, found, ACCURACY * self.curve.extent), "face")

    def _end(self, inner: Array, outer: Array, tube: Tube) -> Knot | None:
        for _ in range(_HALVINGS):
            gap = np.linalg.norm(outer - inner) / self.curve.extent
            if gap < ACCURACY:
                break
            if gap < _NEAR and (found := self._on_face(inner, outer, tube)) is not None:
                return found
            middle = self.curve.newton((inner + outer) / 2, tube.axis)
            if middle is None:
                return None
            inner, outer = (middle, outer) if self.region.holds(middle) else (inner, middle)
        return self.curve.knot(inner, tube.axis, tube)

    def _on_face(self, inner: Array, outer: Array, tube: Tube) -> Knot | None:
        face = self.region.face(inner, outer)
        if face is None:
            return None
        axis, value = face
        guess = inner.copy()
        guess[axis] = value
        point = self.curve.newton(guess, axis)
        if point is None or np.linalg.norm(point - inner) > 4 * np.linalg.norm(outer - inner):
            return None
        return self.curve.knot(point, axis, tube) if self.region.holds(point) else None

    def _covers(self, tube: Tube, start: Knot, end: Knot) -> bool:
        """Whether the arc between two knots lies in the boxes, each grown by a quarter."""
        ends = [float(knot.sides[tube.axis].mid()) for knot in (start, end)]
        parts, budget = [(min(ends), max(ends))], 256
        while parts and budget:
            low, high = parts.pop()
            budget -= 1
            sides = tube.over(low, high, tube.width)
            slack = self.region.tolerance
            lows = np.array([float(side.lower()) for side in sides]) - slack
            highs = np.array([float(side.upper()) for side in sides]) + slack
            if not self.region.surrounds(lows, highs):
                if high - low < 4 * tube.width:
                    return False
                middle = (low + high) / 2
                parts += [(low, middle), (middle, high)]
        return not parts


def _cut(tube: Tube, last: Knot, end: Knot, beyond: float) -> Tube:
    """The tube up to an end of the curve, and hardly beyond."""
    before, t = (float(knot.sides[tube.axis].mid()) for knot in (last, end))
    low, high = tube.span
    span = (low, min(high, t + beyond)) if t > before else (max(low, t - beyond), high)
    return replace(tube, span=span)


def _angle(a: Array, b: Array) -> float:
    return math.atan2(float(np.linalg.norm(np.cross(a, b))), float(a @ b))
