"""Where two curves meet: both parameters of every intersection, or of the nearest approach."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.distance import cdist

from rsym.arrays import Floats
from rsym.surfaces.functions.univariate import Univariate
from rsym.surfaces.parameters import inside

# Chords along a curve. Intersections nearer to one another than two chords may be taken for one.
CHORDS = 128
MOST_STARTS = 16
STEPS = 40
# Intersections whose parameters agree to this share of the interval are the same one.
SAME = 1e-6
# Step of difference quotients, as a share of the interval: they are right to about 1e-7.
QUOTIENT = 1e-7


class Intersection(NamedTuple):
    """Parameters on both curves and the distance left between them; NaN on a curve that is a point."""

    first: float
    second: float
    gap: float


@dataclass(frozen=True)
class Polygon:
    """A curve and points on it; of a curve that is a point, one."""

    curve: Univariate
    places: Floats
    points: Floats
    is_point: bool
    closes: bool

    @property
    def reach(self) -> Floats:
        """The longer of the chords beside each point."""
        chords = np.sqrt(((self.points[1:] - self.points[:-1]) ** 2).sum(axis=-1))
        return np.asarray(np.maximum(np.append(chords, 0.0), np.append(0.0, chords)))


def polygon(curve: Univariate, size: float, closes: bool) -> Polygon:
    """The curve between points; `closes`: its ends meet and count as one."""
    places = np.linspace(*curve.domain, CHORDS + 1)
    points = curve(places)
    is_point = bool(np.ptp(points, axis=0).max() <= 1e-12 * size)
    count = 1 if is_point else len(places)
    return Polygon(curve, places[:count], points[:count], is_point, closes)


def intersections(one: Polygon, other: Polygon, tolerance: float) -> list[Intersection]:
    """All intersections with a gap up to the tolerance; if there is none, the nearest approach, whose gap is larger.

    Examples
    --------
    >>> from rsym.surfaces.functions.curves import as_curve
    >>> from rsym.surfaces.symbols import t
    >>> one, other = (polygon(as_curve(given), 1.0, False) for given in ((t, 0, 0), (0.25, 4 * t - 1, 0)))
    >>> intersections(one, other, 1e-9)
    [Intersection(first=0.25, second=0.25, gap=0.0)]
    """
    starts = _starts(one, other)
    x, y, gaps = _refined(one, other, one.places[starts[:, 0]], other.places[starts[:, 1]])
    found: list[Intersection] = []
    for k in np.argsort(gaps, kind="stable"):
        here = Intersection(float(x[k]), float(y[k]), float(gaps[k]))
        if here.gap > tolerance and found:
            break
        if not any(_same(one, here.first, known.first) and _same(other, here.second, known.second) for known in found):
            found.append(here)
    return [
        Intersection(np.nan if one.is_point else a, np.nan if other.is_point else b, gap) for a, b, gap in sorted(found)
    ]


def _starts(one: Polygon, other: Polygon) -> NDArray[np.intp]:
    """Pairs of points nearer than their neighbours and near enough for a intersection; and the nearest of all."""
    squares = cdist(one.points, other.points, "sqeuclidean")
    pairs = np.argwhere(squares <= (1.5 * np.add.outer(one.reach, other.reach)) ** 2)
    walled = np.pad(squares, 1, constant_values=np.inf)
    around = [walled[pairs[:, 0] + i, pairs[:, 1] + j] for i in range(3) for j in range(3)]
    pairs = pairs[squares[tuple(pairs.T)] <= np.min(around, axis=0)]
    pairs = pairs[np.argsort(squares[tuple(pairs.T)], kind="stable")][:MOST_STARTS]
    nearest = np.array(np.unravel_index(int(squares.argmin()), squares.shape))
    return np.vstack([nearest, pairs])


def _refined(one: Polygon, other: Polygon, x: Floats, y: Floats) -> tuple[Floats, Floats, Floats]:
    """Gauss-Newton steps on the distance; the best that was met."""
    best = x, y, np.full(len(x), np.inf)
    longest = [0.1 * (part.curve.domain[1] - part.curve.domain[0]) for part in (one, other)]
    for _ in range(STEPS):
        (p, p_x), (q, q_y) = _with_tangent(one.curve, x), _with_tangent(other.curve, y)
        gap = p - q
        size = np.sqrt((gap**2).sum(axis=-1))
        best = tuple(np.where(size < best[2], new, old) for new, old in zip((x, y, size), best, strict=True))  # type: ignore[assignment]
        a, b, c = (p_x * p_x).sum(-1), (p_x * q_y).sum(-1), (q_y * q_y).sum(-1)
        # A little more than the squares, so that tangent curves and points leave a number to divide by.
        a, c = a + 1e-14 * (a + c) + 1e-300, c + 1e-14 * (a + c) + 1e-300
        along, over = (gap * p_x).sum(-1), (gap * q_y).sum(-1)
        new_x = _moved(one, x, np.clip((b * over - c * along) / (a * c - b * b), -longest[0], longest[0]))
        # The other parameter answers to the step that the interval has left of it.
        step = np.where(np.abs(new_x - x) > longest[0], 0.0, new_x - x)
        new_y = _moved(other, y, np.clip((over + b * step) / c, -longest[1], longest[1]))
        if (new_x == x).all() and (new_y == y).all():
            break
        x, y = new_x, new_y
    return best


def _with_tangent(curve: Univariate, t: Floats) -> tuple[Floats, Floats]:
    """Points and difference quotients: steps need no better, and curves may have kinks."""
    low, high = curve.domain
    step = QUOTIENT * (high - low) * np.where(t > (low + high) / 2, -1.0, 1.0)
    here, beside = np.split(curve.evaluate(np.concatenate([t, t + step]), [0])[0], 2)
    return here, (beside - here) / step[:, None]


def _moved(part: Polygon, t: Floats, step: Floats) -> Floats:
    """The parameter after a step, turned or held back at the ends."""
    return inside(t + step, part.curve.domain, True, "t") if part.closes else np.clip(t + step, *part.curve.domain)


def _same(part: Polygon, a: float, b: float) -> bool:
    length = part.curve.domain[1] - part.curve.domain[0]
    apart = abs(a - b)
    return part.is_point or min(apart, abs(length - apart) if part.closes else apart) <= SAME * length
