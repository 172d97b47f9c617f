"""The zeros of a function on a circle: crossings, touches, and edges of its domain."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

import mpmath as mp
from mpmath import mpf

Function = Callable[[mpf], mpf]
Points = list[tuple[mpf, mpf]]

# First samples of a circle; dips between them and zeros beside zeros are looked for afterwards.
SAMPLES = 32
# The samples start at an angle that no symmetric model prefers.
OFFSET = mpf("0.381966")
# Zooming stops here: branches closer than 2^-ZOOMS of a sample's width are not told apart at depth one.
ZOOMS = 60
DEEPEST = 2
# A slope at a zero below this share of the mean slope beside it: several zeros may be hidden there.
FLAT = mpf("0.1")
# A dip shallower than this is rounding: a sample beside the bottom of a smooth one is a hundredth higher.
STEADY = 1 - mpf("1e-9")
# Bisection to 60 digits takes 200 steps; Chandrupatla's method takes at most about three times as many.
MOST_STEPS = 600


@dataclass(frozen=True)
class CircleZeros:
    """Zeros of w on a circle: (angle, rising) with a change of sign, angles of touches, number of edges.

    An edge is where the function is cut off: its domain ends there, or it jumps over zero. `least` is the smallest
    size of the samples; `vanishing` says that the function is zero on a whole arc.
    """

    radius: mpf
    crossings: tuple[tuple[mpf, bool], ...]
    touches: tuple[mpf, ...] = ()
    edges: int = 0
    least: mpf = mp.inf
    inside: bool = False
    vanishing: bool = False


def zeros_on_circle(value: Callable[[mpf, mpf], mpf], centre: tuple[mpf, mpf], radius: mpf, digits: int) -> CircleZeros:
    """All zeros of `value` on a circle that dips and slopes of its samples give away.

    Examples
    --------
    >>> circle = zeros_on_circle(lambda x, y: y - x * x, (mpf(0), mpf(0)), mpf("0.1"), 15)
    >>> [(mp.nstr(angle, 6), rising) for angle, rising in circle.crossings]
    [('0.099182', True), ('3.04241', False)]
    """

    def along(angle: mpf) -> mpf:
        return _real(value, centre[0] + radius * mp.cos(angle), centre[1] + radius * mp.sin(angle))

    start = [2 * mp.pi * (index + OFFSET) / SAMPLES for index in range(SAMPLES)]
    points = [(angle, along(angle)) for angle in start]
    finite = [abs(height) for _, height in points if mp.isfinite(height)]
    if not finite or sum(height == 0 for height in finite) > 1:
        return CircleZeros(radius, (), edges=0 if finite else 1, vanishing=bool(finite))
    # No dip of |w| straddles the seam if the circle is opened where |w| is largest.
    top = max(range(SAMPLES), key=lambda index: abs(points[index][1]) if mp.isfinite(points[index][1]) else -1)
    turned = [*points[top:], *((angle + 2 * mp.pi, height) for angle, height in points[: top + 1])]
    search = _WayRound(along, mpf(10) ** -digits, [], [], 0)
    search.resolve([point for point in turned if point[1] != 0], 0)
    crossings = sorted((angle % (2 * mp.pi), rising) for angle, rising in search.crossings)
    touches = tuple(sorted(angle % (2 * mp.pi) for angle in search.touches))
    return CircleZeros(radius, tuple(crossings), touches, search.edges, min(finite), turned[0][1] > 0)


def _real(value: Callable[[mpf, mpf], mpf], x: mpf, y: mpf) -> mpf:
    """A value, NaN where it is undefined or complex."""
    try:
        height = value(x, y)
    except (ZeroDivisionError, ValueError):
        return mp.nan
    return height if isinstance(height, mpf) else mp.nan


@dataclass
class _WayRound:
    """What is found on the way round."""

    along: Function
    tolerance: mpf
    crossings: list[tuple[mpf, bool]]
    touches: list[mpf]
    edges: int

    def resolve(self, points: Points, depth: int) -> None:
        """Find the zeros between neighbouring points of an arc."""
        points = self._with_dips(self._with_edges(points), depth)
        for (a, fa), (b, fb) in pairwise(points):
            if fa * fb < 0:
                self._cross(a, fa, b, fb, depth)

    def _with_edges(self, points: Points) -> Points:
        """Add samples that close in on the edge of the domain."""
        found = list(points)
        for (a, fa), (b, fb) in pairwise(points):
            if mp.isfinite(fa) != mp.isfinite(fb):
                self.edges += 1
                good, bad = (a, b) if mp.isfinite(fa) else (b, a)
                for _ in range(ZOOMS):
                    middle = (good + bad) / 2
                    height = self.along(middle)
                    if mp.isfinite(height):
                        good = middle
                        found.append((middle, height))
                    else:
                        bad = middle
        return sorted(point for point in found if point[1] != 0)

    def _with_dips(self, points: Points, depth: int) -> Points:
        """Add the lowest point of every dip of |w|, or a point beyond zero if it goes there."""
        found = list(points)
        for (a, fa), (m, fm), (b, fb) in zip(points, points[1:], points[2:], strict=False):
            if fa * fm > 0 and fm * fb > 0 and abs(fm) < STEADY * abs(fa) and abs(fm) < STEADY * abs(fb):
                low, height = self._lowest(a, m, b, mp.sign(fm))
                if height * fm < 0:
                    found.append((low, height))
                elif abs(height) < FLAT * abs(fm):
                    self._touch(a, low, b, abs(fm), abs(height), depth)
        return sorted(found)

    def _touch(self, a: mpf, low: mpf, b: mpf, beside: mpf, height: mpf, depth: int) -> None:
        """A dip that comes near zero: a touch, or a lens too narrow to have been seen."""
        if depth < DEEPEST:
            before = len(self.crossings) + len(self.touches)
            self.resolve(self._zoomed(a, low, b), DEEPEST)
            if len(self.crossings) + len(self.touches) > before:
                return
        # A dip whose bottom is only very near zero is level there; at a touch only the step of the search is left.
        aside = 100 * mp.sqrt(self.tolerance)
        around = min(abs(self.along(low - aside * (b - a))), abs(self.along(low + aside * (b - a))))
        if height <= mp.sqrt(self.tolerance) * beside and height < FLAT * around:
            self.touches.append(low)

    def _zoomed(self, a: mpf, centre: mpf, b: mpf) -> Points:
        """Samples that close in on a point from both sides."""
        shares = [mpf(2) ** -index for index in range(ZOOMS)]
        angles = [centre + (a - centre) * share for share in shares]
        angles += [centre + (b - centre) * share for share in reversed(shares)]
        points = [(angle, self.along(angle)) for angle in angles]
        return [point for point in points if point[1] != 0]

    def _lowest(self, a: mpf, m: mpf, b: mpf, sign: mpf) -> tuple[mpf, mpf]:
        """Close in on the lowest point of sign*w in (a, b) by the sign of its slope; stop beyond zero."""
        step = mp.sqrt(self.tolerance) * (b - a)
        low = m
        height = sign * self.along(low)
        while b - a > 4 * step and height > 0:
            slope = sign * self.along(low + step) - height
            a, b = (a, low) if slope > 0 else (low, b)
            low = (a + b) / 2
            height = sign * self.along(low)
        return low, sign * height

    def _cross(self, a: mpf, fa: mpf, b: mpf, fb: mpf, depth: int) -> None:
        """One change of sign: a zero, several zeros, or a jump."""
        root, left = bracketed_root(self.along, a, fa, b, fb, self.tolerance)
        if left > mpf("1e-6") * min(abs(fa), abs(fb)):
            self.edges += 1
            return
        if depth < DEEPEST and self._flat(a, fa, root, b, fb):
            self.resolve(self._zoomed(a, root, b), DEEPEST)
        else:
            self.crossings.append((root, bool(fb > 0)))

    def _flat(self, a: mpf, fa: mpf, root: mpf, b: mpf, fb: mpf) -> bool:
        """Whether w leaves its zero much more slowly than it reaches the ends."""
        share = self.tolerance ** mpf("0.25")
        left, right = root + (a - root) * share, root + (b - root) * share
        return bool(abs(self.along(left)) < FLAT * share * abs(fa) or abs(self.along(right)) < FLAT * share * abs(fb))


def bracketed_root(function: Function, a: mpf, fa: mpf, b: mpf, fb: mpf, tolerance: mpf) -> tuple[mpf, mpf]:
    """A zero between a and b, where the values differ in sign, and the size of the function there.

    Chandrupatla's method (1997): inverse quadratic interpolation where it is safe, bisection elsewhere.

    Examples
    --------
    >>> root, left = bracketed_root(lambda t: t * t - 2, mpf(1), mpf(-1), mpf(2), mpf(2), mpf("1e-12"))
    >>> mp.nstr(root, 10)
    '1.414213562'
    """
    c, fc, t = a, fa, mpf("0.5")
    a, fa, b, fb = b, fb, a, fa
    least_width = 4 * max(tolerance * abs(b - a), mp.eps * max(abs(a), abs(b)))
    best, least = a, abs(fa)
    for _ in range(MOST_STEPS):
        point = a + t * (b - a)
        height = function(point)
        if not mp.isfinite(height):
            return point, mp.inf
        if mp.sign(height) == mp.sign(fa):
            c, fc = a, fa
        else:
            c, b, fc, fb = b, a, fb, fa
        a, fa = point, height
        best, least = (a, abs(fa)) if abs(fa) < abs(fb) else (b, abs(fb))
        if least == 0 or abs(b - a) < least_width:
            break
        t = mpf("0.5")
        xi, phi = (a - b) / (c - b), (fa - fb) / (fc - fb)
        if phi**2 < xi and (1 - phi) ** 2 < 1 - xi:
            t = fa / (fb - fa) * fc / (fb - fc) + (c - a) / (b - a) * fa / (fc - fa) * fb / (fc - fb)
        nearest = least_width / (4 * abs(b - a))
        t = min(max(t, nearest), 1 - nearest)
    return best, least
