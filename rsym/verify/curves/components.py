"""The components of a curve in a union of boxes: all of them, for every box is accounted for.

Part by part a box holds no point of the curve, or lies in a tube of a component that was followed. A part of which
neither holds is narrowed and divided, and Newton's method looks for a new component in it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from rsym.arrays import Floats
from rsym.bounds.balls import arb
from rsym.sampling.progress import Effort
from rsym.verify.answers.singular import SingularPoint
from rsym.verify.boxes.krawczyk import Point, image, inverse
from rsym.verify.boxes.local import Box, side
from rsym.verify.curves.continuation import Knot, Tube, ZeroCurve, others
from rsym.verify.curves.following import ACCURACY, Ground, Path, Walk, cut
from rsym.verify.curves.region import Region

# Of the extent: what lies so close to a face is on it.
_TOLERANCE = 2.0**-32
# Of the extent: an end is found by halving to 2**-30, and the last tube goes as far beyond it.
_BESIDE = 2.0**-27
# A corner known worse than to this share of the extent is no end of a curve.
_SHARP = 1e-6
# Parts into which a box may fall before it stays open: 1401 were seen where two sheets are nearly tangent. All boxes
# together may fall into so many more than there are of them; three or four for each are common.
_PARTS, _ALL = 2000, 20_000
# The squared cosine of the angle between sheets that may be told apart although both pass through a box.
_STEEP = 0.5
# Where Newton's method has found nothing new it is tried again in parts that are halved so often.
_WAIT = 4


class Tubes:
    """The tubes of all components followed so far, to be asked whether all of the curve in a box lies in them."""

    def __init__(self, curve: ZeroCurve) -> None:
        self.curve = curve
        self.tubes: list[Tube] = []

    def add(self, tubes: Sequence[Tube]) -> None:
        """Take more."""
        self.tubes.extend(tubes)
        hulls = [ends(tube.over(*tube.span, tube.reach)) for tube in self.tubes]
        self._lows, self._highs = np.array([low for low, _ in hulls]), np.array([high for _, high in hulls])

    def contain(self, sides: Sequence[arb]) -> bool:
        """Whether a box lies in one of the tubes, where there is but the arc that was followed."""
        if not self.tubes:
            return False
        low, high = ends(sides)
        near = ((self._lows <= low) & (high <= self._highs)).all(axis=1)
        return any(self.tubes[number].contains(sides) for number in np.flatnonzero(near))

    def pass_through(self, sides: Point) -> bool:
        """Whether there is one arc through a box, and tubes follow it all the way.

        In a box where the slopes across an axis are regular there is at most one point for every value along it. If
        tubes have one for every value, and the arcs in them lie in that box, they are all that there is.
        """
        if not self.tubes:
            return False
        low, high = ends(sides)
        margin = (high - low).max() / 2
        close = ((self._lows <= high + margin) & (low - margin <= self._highs)).all(axis=1)
        tubes = [self.tubes[number] for number in np.flatnonzero(close)]
        return any(self._follow(sides, low - margin, high + margin, axis, tubes) for axis in range(3))

    def _follow(self, sides: Point, low: Floats, high: Floats, axis: int, tubes: Sequence[Tube]) -> bool:
        own = ends(sides)
        first, last, spans, hull = float(own[0][axis]), float(own[1][axis]), [], list(sides)
        for tube in tubes:
            span = max(first, tube.span[0]), min(last, tube.span[1])
            if tube.axis != axis or span[0] > span[1]:
                continue
            arc = tube.over(*span, tube.width)
            lows, highs = ends(arc)
            if (low <= lows).all() and (highs <= high).all():
                spans.append(span)
                hull = [one.union(other) for one, other in zip(hull, arc, strict=True)]
        return _cover(spans, first, last) and self.curve.is_unique(hull, axis)


def _cover(spans: Sequence[tuple[float, float]], first: float, last: float) -> bool:
    """Whether intervals cover an interval."""
    for low, high in sorted(spans):
        if low > first:
            return False
        first = max(first, high)
    return bool(spans) and first >= last


def ends(sides: Sequence[arb]) -> tuple[Floats, Floats]:
    """The lower and upper ends of a box, rounded outward."""
    low = np.array([float(one.lower()) for one in sides[:3]])
    high = np.array([float(one.upper()) for one in sides[:3]])
    return np.nextafter(low, -np.inf), np.nextafter(high, np.inf)


@dataclass(frozen=True, eq=False)
class Component:
    """One component: its points along grad F x grad G, the tubes between them, and how it ends on both sides."""

    knots: list[Knot]
    tubes: list[Tube]
    ends: tuple[str, str]


class Search:
    """The components of a curve in a union of boxes."""

    def __init__(
        self,
        curve: ZeroCurve,
        boxes: Sequence[Box],
        corners: Sequence[tuple[Box, SingularPoint]],
        effort: Effort | None = None,
    ) -> None:
        self.curve, self.boxes, self.effort = curve, boxes, effort or Effort()
        knots = [(box, knot) for box, point in corners if (knot := self._corner(point)) is not None]
        inner, further = (
            Region(union, _TOLERANCE * curve.extent) for union in (boxes, [*boxes, *(box for box, _ in knots)])
        )
        self.ground = Ground(inner, further, [knot for _, knot in knots])
        self.tubes = Tubes(curve)
        self.components: list[Component] = []
        self.open: list[Box] = []
        self._left = _ALL + 20 * len(boxes)

    def _corner(self, corner: SingularPoint) -> Knot | None:
        """A corner as a point of the curve, if it may lie on it and is known well enough."""
        if corner.radius > _SHARP * self.curve.extent:
            return None
        sides = tuple(arb(value, corner.radius) for value in corner.point)
        if not all(value.contains(0) for value in self.curve.values(self.curve.on(sides))):
            return None
        tangent = np.array([float(one.mid()) for one in self.curve.tangent(sides)])
        return Knot(sides, None, tangent / (np.linalg.norm(tangent) or 1))

    def account(self, box: Box) -> None:
        """Prove that all of the curve in a box was followed, and follow what was not."""
        parts: list[tuple[Point, int]] = [(tuple(side(*one) for one in box[:3]), 0)]
        for _ in range(min(_PARTS, self._left)):
            if not parts:
                return
            if self.effort.is_over:
                break
            self._left -= 1
            whole, wait = parts.pop()
            if self.tubes.contain(whole):
                continue
            part = narrowed(self.curve, whole)
            if part is None or self.tubes.contain(part) or self.tubes.pass_through(part):
                continue
            low, high = ends(part)
            if float((high - low).max()) < ACCURACY * self.curve.extent:
                if self._is_end(low, high):  # which is known no better
                    continue
                parts.append((part, 0))
                break
            if wait == 0 and self._seek((low + high) / 2):
                parts.append((part, 0))
            else:
                parts.extend((half, (wait or _WAIT) - 1) for half in halves_of(part))
        if parts:
            self.open.append(box)

    def _is_end(self, low: Floats, high: Floats) -> bool:
        """Whether a component that was followed ends in a box, or right beside it."""
        beside = _BESIDE * self.curve.extent
        return any(
            bool((low - beside <= end.middle).all() and (end.middle <= high + beside).all())
            for component in self.components
            for end in (component.knots[0], component.knots[-1])
        )

    def _seek(self, middle: Floats) -> bool:
        """Look for a new component close to a point, and follow it."""
        point = self.curve.newton(middle)
        if point is None or not self.ground.boxes.holds(point):
            return False
        sides = [arb(value) for value in point.tolist()]
        if self.tubes.contain(sides):
            return False
        direction = np.array([float(one.mid()) for one in self.curve.tangent(sides)])
        seed = self.curve.knot(point, int(np.abs(direction).argmax()))
        if seed is None:
            return False
        forth = self._path(seed, 1)
        back = None
        if forth.end != "closed":
            back = self._path(seed, -1, forth.knots[-1] if forth.end == "lost" else None)
        if not forth.tubes and (back is None or not back.tubes):
            return False
        self._keep(self._continued(_joined(forth, back, ACCURACY * self.curve.extent)))
        return True

    def _continued(self, component: Component) -> Component:
        """A component with those that were followed before and that begin or end where it ends or begins."""
        first, last = component.knots[0], component.knots[-1]
        for known in self.components:
            if component.ends[1] == "known" and known.knots[0] is last:
                component = _appended(component, known)
        if component.ends[0] == "known" and component.knots[-1] is first:  # it closed a gap
            return replace(component, ends=("closed", "closed"))
        for known in self.components:
            if component.ends[0] == "known" and known.knots[-1] is first:
                component = _appended(known, component)
        return component

    def _keep(self, component: Component) -> None:
        """Take a component; of those that are one curve, for a face is grazed or an end was lost, the longest."""
        self.tubes.add(component.tubes)
        own = Tubes(self.curve)
        own.add(component.tubes)
        same = [known for known in self.components if any(own.contain(knot.sides) for knot in known.knots)]
        longest = max([*same, component], key=lambda one: len(one.knots))
        self.components = [*(known for known in self.components if known not in same), longest]

    def _path(self, seed: Knot, sense: int, goal: Knot | None = None) -> Path:
        """Follow the curve to a corner, else to the face on which it enters the box of one."""
        known = [one.knots[0 if sense > 0 else -1] for one in self.components if one.ends[sense < 0] == "face"]
        path = Walk(self.curve, self.ground, seed, sense, goal, self.effort, known).path()
        if path.end == "corner" or self.ground.boxes.holds(path.knots[-1].middle):
            return path
        return Walk(self.curve, self.ground.without_corners(), seed, sense, goal, self.effort, known).path()


def _appended(one: Component, other: Component) -> Component:
    """Two components of one curve; the second begins where the first ends."""
    return Component(one.knots + other.knots[1:], one.tubes + other.tubes, (one.ends[0], other.ends[1]))


def _joined(forth: Path, back: Path | None, beyond: float) -> Component:
    if back is None:
        return Component(forth.knots, forth.tubes, ("closed", "closed"))
    if back.end == "met":
        return Component(forth.knots + back.knots[-2::-1], forth.tubes + back.tubes[::-1], ("closed", "closed"))
    # The first tube of either way goes back a little, perhaps beyond the end of the other.
    ahead = [cut(tube, back.knots[-1], -1, beyond) for tube in forth.tubes[:1]] + forth.tubes[1:]
    behind = [cut(tube, forth.knots[-1], 1, beyond) for tube in back.tubes[:1]] + back.tubes[1:]
    return Component(back.knots[:0:-1] + forth.knots, behind[::-1] + ahead, (back.end, forth.end))


def narrowed(curve: ZeroCurve, box: Point) -> Point | None:
    """A box that holds all of the curve in a box, None if that is nothing.

    Krawczyk's operator in two coordinates, the third over all of its interval, once for each third coordinate along
    which the curve runs fast enough.
    """
    local = curve.on(box)
    if any(not value.contains(0) for value in curve.values(local)):
        return None
    slopes = curve.slopes(local)
    if _are_apart(curve, box, slopes):
        return None
    current = list(box)
    for axis in range(3):
        free = others(axis)
        across = [[row[other] for other in free] for row in slopes]
        near = inverse(across)
        if near is None:
            continue
        middle = [one.mid() for one in current]
        t = current[axis] - middle[axis]
        values = curve.values(curve.on(middle))
        section = tuple(current[other] for other in free)
        moved = image(near, [v + row[axis] * t for v, row in zip(values, slopes, strict=True)], across, section)
        if moved is None:
            continue
        for other, found in zip(free, moved, strict=True):
            if not found.overlaps(current[other]):
                return None
            current[other] = found.intersection(current[other])
    return tuple(current)


def _are_apart(curve: ZeroCurve, box: Point, slopes: Sequence[Sequence[arb]]) -> bool:
    """Whether two sheets that are nearly parallel certainly do not meet in a box.

    By the mean value form of G - k F, where k makes its gradient small: beside a point of contact F and G may both
    vanish in the box, but not together.
    """
    f, g = ([one.mid() for one in row] for row in slopes)
    ff, fg, gg = (sum((u * v for u, v in zip(a, b, strict=True)), arb(0)) for a, b in ((f, f), (f, g), (g, g)))
    if not fg * fg > _STEEP * ff * gg:
        return False
    k, middle = (fg / ff).mid(), [one.mid() for one in box]
    first, second = curve.values(curve.on(middle))
    total = second - k * first
    for p, q, one, own in zip(*slopes, box, middle, strict=True):
        total += (q - k * p) * (one - own)
    return bool(total.is_finite()) and not total.contains(0)


def halves_of(box: Point) -> list[Point]:
    """A box cut in two across its longest side."""
    lows, highs = ends(box)
    axis = int((highs - lows).argmax())
    low, high = box[axis].lower(), box[axis].upper()
    middle = box[axis].mid()
    return [(*box[:axis], part, *box[axis + 1 :]) for part in (low.union(middle), middle.union(high))]
