"""Following a curve in space tube by tube, until it closes, leaves the boxes it is sought in, or meets a corner."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from rsym.arrays import Floats
from rsym.sampling.progress import Effort
from rsym.verify.curves.continuation import Knot, Tube, ZeroCurve
from rsym.verify.curves.region import Region

# In shares of the extent: a polyline of longer steps does not look smooth in a picture; shorter ones lead nowhere.
LONGEST, SHORTEST = 2.0**-6, 2.0**-38
# A closed curve has at least 32 points.
TURN = 2 * math.pi / 32
# How fast steps grow where the last one was easy.
_GROWTH = 1.5
_MOST = 20_000
# An end is first looked for by halving to this share of the extent, then on the face that the curve crosses there.
# Where it grazes the face it is halved to the second one, which is also how far the last tube goes beyond an end.
_NEAR, ACCURACY = 2.0**-20, 2.0**-30
_HALVINGS = 40
# How wide tubes are, in shares of their length: wide ones account for more, narrow ones fit between close curves.
_REACHES = (1.0, 0.25, 0.0625)
# Parts of an arc, each of which must lie in one box.
_PARTS = 256


@dataclass(frozen=True)
class Path:
    """What was followed: knots, the tubes between them, and how it ended.

    "closed" or "met" its own beginning or end, at the end of a "known" curve, at a "face" or a "corner", or "lost".
    """

    knots: list[Knot]
    tubes: list[Tube]
    end: str


class _Step(NamedTuple):
    knot: Knot
    tube: Tube
    end: str


@dataclass(frozen=True)
class Ground:
    """Where a curve is followed: in boxes, and on from there to one of the corners in further boxes."""

    boxes: Region
    further: Region
    corners: Sequence[Knot]

    def without_corners(self) -> Ground:
        """The boxes alone."""
        return Ground(self.boxes, self.boxes, ())


class Walk:
    """The way along a curve from one of its points, `sense` 1 along grad F x grad G, -1 against it.

    `goal` is another point of the curve, at which the way may end as well: the last one of a way that was lost. So
    are those of `known`, at which ways that were followed before begin.
    """

    def __init__(
        self,
        curve: ZeroCurve,
        ground: Ground,
        start: Knot,
        sense: int,
        goal: Knot | None = None,
        effort: Effort | None = None,
        known: Sequence[Knot] = (),
    ) -> None:
        self.effort = effort or Effort()
        self.curve, self.ground, self.start, self.sense = curve, ground, start, sense
        met = [] if goal is None else [goal]
        self._ends = {"closed": [start], "met": met, "corner": ground.corners, "known": known}
        self._width = 0

    def path(self) -> Path:
        """Follow the curve to its end; no tube goes on beyond it, so that what is there is not taken for followed."""
        path = self._path()
        if path.end in {"closed", "met", "known"}:
            return path
        beyond = ACCURACY * self.curve.extent
        return replace(path, tubes=[cut(tube, path.knots[-1], self.sense, beyond) for tube in path.tubes])

    def _path(self) -> Path:
        knots, tubes = [self.start], []
        longest = LONGEST * self.curve.extent
        length = longest
        while len(knots) < _MOST and not self.effort.is_over:
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
        ahead = 1 if target[axis] > knot.middle[axis] else -1
        for number in range(max(self._width - 1, 0), len(_REACHES)):
            tube = curve.tube(knot, target, axis, _REACHES[number] * length)
            if tube is None or tube.sense * self.sense != ahead or not tube.contains(knot.sides):
                continue
            step = self._along(knot, tube, target, ahead)
            if step is not None and self._stays(knot, step):
                self._width = number
                return step
        return None

    def _along(self, knot: Knot, tube: Tube, target: Floats, ahead: int) -> _Step | None:
        """The step in a tube: to the first of the ends that it holds, to the target, or to a face before it."""
        met = []
        for end, known in ((end, one) for end, knots in self._ends.items() for one in knots if one is not knot):
            advance = (known.sides[tube.axis] - knot.sides[tube.axis]) * ahead
            if tube.contains(known.sides) and advance > 0:
                met.append((float(advance.mid()), _Step(known, tube, end)))
            elif tube.is_near(known) and not advance < 0:
                return None  # on the arc or not, ahead or not: that must be certain
        if met:
            return min(met, key=lambda pair: pair[0])[1]
        return self._inside(knot, tube, target) or self._leaving(knot, tube, target)

    def _inside(self, knot: Knot, tube: Tube, target: Floats) -> _Step | None:
        if not self.ground.further.holds(target):
            return None
        found = self.curve.knot(target, tube.axis, tube)
        if found is None or _angle(knot.tangent, found.tangent) > TURN:
            return None
        return _Step(found, tube, "")

    def _leaving(self, knot: Knot, tube: Tube, target: Floats) -> _Step | None:
        """The end of the curve on the face through which it leaves the boxes."""
        if self.ground.further.holds(target):
            return None
        found = self._end(knot.middle, target, tube)
        if found is None:
            return None
        if np.linalg.norm(found.middle - knot.middle) < 4 * ACCURACY * self.curve.extent:
            return _Step(knot, tube, "face")
        return _Step(found, tube, "face")

    def _end(self, inner: Floats, outer: Floats, tube: Tube) -> Knot | None:
        for _ in range(_HALVINGS):
            gap = np.linalg.norm(outer - inner) / self.curve.extent
            if gap < ACCURACY:
                break
            if gap < _NEAR and (found := self._on_face(inner, outer, tube)) is not None:
                return found
            middle = self.curve.newton((inner + outer) / 2, tube.axis)
            if middle is None:
                return None
            inner, outer = (middle, outer) if self.ground.further.holds(middle) else (inner, middle)
        return self.curve.knot(inner, tube.axis, tube)

    def _on_face(self, inner: Floats, outer: Floats, tube: Tube) -> Knot | None:
        face = self.ground.further.face(inner, outer)
        if face is None:
            return None
        axis, value = face
        guess = inner.copy()
        guess[axis] = value
        point = self.curve.newton(guess, axis)
        if point is None or np.linalg.norm(point - inner) > 4 * np.linalg.norm(outer - inner):
            return None
        return self.curve.knot(point, axis, tube) if self.ground.further.holds(point) else None

    def _stays(self, knot: Knot, step: _Step) -> bool:
        """Whether the arc up to the next knot lies in the boxes, each grown by a quarter, or in those of a corner."""
        boxes = self.ground.boxes
        if step.end != "corner" and boxes.holds(step.knot.middle):
            return boxes.holds(knot.middle) and covers(boxes, step.tube, knot, step.knot)
        return covers(self.ground.further, step.tube, knot, step.knot)


def covers(region: Region, tube: Tube, start: Knot, end: Knot) -> bool:
    """Whether the arc in a tube between two knots lies in the boxes of a region, each grown by a quarter."""
    ends = [float(knot.sides[tube.axis].mid()) for knot in (start, end)]
    parts = [(min(ends), max(ends))]
    for _ in range(_PARTS):
        if not parts:
            return True
        low, high = parts.pop()
        sides = tube.over(low, high, tube.width)
        lows = np.array([float(side.lower()) for side in sides]) - region.tolerance
        highs = np.array([float(side.upper()) for side in sides]) + region.tolerance
        if not region.surrounds(lows, highs):
            if high - low < 4 * tube.width:
                return False
            middle = (low + high) / 2
            parts += [(low, middle), (middle, high)]
    return False


def cut(tube: Tube, end: Knot, sense: int, beyond: float) -> Tube:
    """The tube up to an end of the curve that it holds, and hardly beyond, for a way with or against the curve."""
    if not tube.contains(end.sides):
        return tube
    t = float(end.sides[tube.axis].mid())
    low, high = tube.span
    span = (low, min(high, t + beyond)) if tube.sense == sense else (max(low, t - beyond), high)
    return replace(tube, span=span)


def _angle(a: Floats, b: Floats) -> float:
    return math.atan2(float(np.linalg.norm(np.cross(a, b))), float(a @ b))
