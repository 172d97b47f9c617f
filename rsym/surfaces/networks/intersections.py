"""Where curves meet: both parameters of every intersection or nearest approach; one for each pair of two families."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.distance import cdist

from rsym.arrays import Floats
from rsym.errors import RsymError
from rsym.surfaces.corrections import enough
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


Table: TypeAlias = list[list[list[Intersection]]]


def meeting_parameters(
    u_polygons: Sequence[Polygon], v_polygons: Sequence[Polygon], tolerance: float, size: float
) -> tuple[Floats, Floats, Floats]:
    """Arrays u_ij, v_ij and gaps: the v-curve i meets the u-curve j at u_ij on the u-curve and v_ij on the v-curve.

    Curves may miss one another by a share of the size. Parameters increase with i and with j; along curves whose ends
    meet they go on beyond the end. They are NaN on curves that are points, where any parameter does.

    Raises
    ------
    RsymError
        If a pair does not meet, meets more than once, or out of order; it names the pair.
    """
    table = [
        [_meeting(i, j, one, other, tolerance, size) for j, one in enumerate(u_polygons)]
        for i, other in enumerate(v_polygons)
    ]
    _drop_out_of_order(table, u_polygons, v_polygons)
    for i, row in enumerate(table):
        for j, found in enumerate(row):
            if len(found) != 1:
                raise _several(i, j, found)
    of_u, of_v, gaps = (np.array([[found[0][part] for found in row] for row in table]) for part in range(3))
    _order(of_u, u_polygons, "u", "v")
    _order(of_v.T, v_polygons, "v", "u")
    return of_u, of_v, gaps


def _meeting(i: int, j: int, one: Polygon, other: Polygon, tolerance: float, size: float) -> list[Intersection]:
    found = intersections(one, other, tolerance * size)
    if found[0].gap > tolerance * size:
        nearest = found[0]
        raise RsymError(
            f"the u-curve {j} and the v-curve {i} do not meet: their smallest distance is {nearest.gap:.4g}, at "
            f"u = {nearest.first:.6g} and v = {nearest.second:.6g}",
            code="network",
            where=f"the pair (v-curve {i}, u-curve {j})",
            remedy="every curve of one family must meet all of the other; measured ones need "
            f"tolerance={enough(nearest.gap / size)} or more, a share of the size of the network",
        )
    return found


def _drop_out_of_order(table: Table, u_polygons: Sequence[Polygon], v_polygons: Sequence[Polygon]) -> None:
    """Of pairs that meet more than once leave what can stand between its neighbours."""
    rows, columns = len(table), len(table[0])
    changed = any(len(found) > 1 for row in table for found in row)
    while changed:
        changed = False
        for i, row in enumerate(table):
            for j, found in enumerate(row):
                along = [] if u_polygons[j].closes else _neighbours(table, i, j, (1, 0), rows, 0)
                over = [] if v_polygons[i].closes else _neighbours(table, i, j, (0, 1), columns, 1)
                kept = [
                    one
                    for one in found
                    if not any(one[axis] <= low or one[axis] >= high for axis, (low, high) in (*along, *over))
                ]
                if kept and len(kept) < len(found):
                    row[j], changed = kept, True


def _neighbours(
    table: Table, i: int, j: int, step: tuple[int, int], count: int, axis: int
) -> list[tuple[int, tuple[float, float]]]:
    """What the pairs before and after allow the parameter of this axis to be."""
    place = (i, j)[axis]
    before = table[i - step[0]][j - step[1]] if place > 0 else []
    after = table[i + step[0]][j + step[1]] if place < count - 1 else []
    low = min((one[axis] for one in before), default=-np.inf)
    high = max((one[axis] for one in after), default=np.inf)
    return [(axis, (low, high))]


def _several(i: int, j: int, found: list[Intersection]) -> RsymError:
    places = " and ".join(f"(u, v) = ({one.first:.6g}, {one.second:.6g})" for one in found)
    return RsymError(
        f"the u-curve {j} and the v-curve {i} meet {len(found)} times: at {places}",
        code="network",
        where=f"the pair (v-curve {i}, u-curve {j})",
        remedy="cut the curves so that each pair meets once",
    )


def _order(values: Floats, polygons: Sequence[Polygon], along: str, over: str) -> None:
    """Check in place that the parameters on each curve (column) increase; where its ends meet, turn them first."""
    known = values[0, ~np.isnan(values[0])]
    for j, part in enumerate(polygons):
        column = values[:, j]
        length = part.curve.domain[1] - part.curve.domain[0]
        if part.closes:
            column -= length * np.round((column[0] - known[0]) / length) if known.size else 0.0
            column[1:] = column[0] + np.mod(column[1:] - column[0], length)
        bad = np.flatnonzero(np.diff(column) <= 0)
        if len(bad):
            i = int(bad[0])
            raise RsymError(
                f"the {along}-curve {j} meets the {over}-curve {i} at {along} = {column[i]:.6g} and the {over}-curve "
                f"{i + 1} at {along} = {column[i + 1]:.6g}: not in the order of the family",
                code="network",
                where=f"the {along}-curve {j}",
                remedy=f"sort the {over}-curves along {along}, and let all {along}-curves run the same way",
            )
