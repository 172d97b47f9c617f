"""Where the edges of patches run together, and how smoothly the patches pass into one another there.

Stretches that two edges share are found by closest points; gaps, angles and jumps of curvature are sampled along them
until the greatest stay.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from rsym.arrays import Floats
from rsym.surfaces.forms import dot, norm
from rsym.surfaces.joints.borders import SAMPLES, Border, closest, projected
from rsym.surfaces.parameters import Interval

# Samples lie at multiples of the golden ratio, modulo 1: no period of the surfaces, knots say, can hide between them.
# With Fibonacci numbers of samples the distances are almost equal; more are taken until the greatest values stay.
LEVELS = (34, 89, 233, 610)
GOLDEN = (5**0.5 - 1) / 2
# A greatest value that moves by less than this share of itself, or of what is tolerated, is found.
SETTLED, NEGLIGIBLE = 1e-3, 1e-2
PEAKS, INNER, ROUNDS = 3, 15, 3
# Steps of a bisection from one sample to double precision.
BISECTIONS = 40
# A stretch shorter than this many gaps that count as closed is a point in which the edges touch.
TOUCH = 20.0
# Samples in a row that make a stretch if neither edge ends there; curves in contact of high order have fewer.
LEAST_RUN = 8
# At the distance d from a pole, data that are off by e give curvatures that are off by e/d^2, but their limit is well
# known: nearer than this share of the stretch it is taken, and 1e-12 does no harm.
BESIDE_POLE = 2e-3
# The derivative across an edge is zero at a pole; so small a share of its greatest value is zero.
POLE = 1e-6


@dataclass(frozen=True, eq=False)
class Stretch:
    """Two edges run together: t of the first in `interval`; s of the second follows `partner`, one value for each t.

    Examples
    --------
    >>> Stretch((None, None), (0.0, 1.0), np.array([0.0, 1.0]), np.array([1.0, 0.0])).opposite
    True
    """

    borders: tuple[Border, Border]
    interval: Interval
    t: Floats
    s: Floats

    @property
    def intervals(self) -> tuple[Interval, Interval]:
        """The stretch on both edges."""
        return self.interval, (float(min(self.s)), float(max(self.s)))

    @property
    def opposite(self) -> bool:
        """Whether the two parameters run against each other."""
        return bool(self.s[-1] < self.s[0])

    def partner(self, t: Floats) -> Floats:
        """The parameters on the second edge of the points closest to those of the first."""
        first, second = self.borders
        low, high = sorted((float(self.s[0]), float(self.s[-1])))
        guess = np.interp(t, self.t, self.s)
        room = 2 * np.abs(np.diff(self.s)).max()
        bounds = np.maximum(guess - room, low), np.minimum(guess + room, high)
        return closest(second.edge, first.edge.position(t), guess, *bounds)

    @cached_property
    def poles(self) -> tuple[int, ...]:
        """Which ends, 0 and -1, are at a pole of one of the patches."""
        sides = zip(self.borders, (self.t, self.s), strict=True)
        sizes = [np.linalg.norm(border.edge.outward(places), axis=-1) for border, places in sides]
        return tuple(end for end in (0, -1) if any(size[end] < POLE * size.max() for size in sizes))

    def calm(self, t: Floats, s: Floats) -> tuple[Floats, Floats]:
        """The pairs of parameters, those beside a pole moved to it."""
        room = BESIDE_POLE * (self.t[-1] - self.t[0])
        for end in self.poles:
            beside = np.abs(t - self.t[end]) < room
            t, s = np.where(beside, self.t[end], t), np.where(beside, self.s[end], s)
        return t, s


def shared_stretches(borders: Sequence[Border]) -> list[Stretch]:
    """All stretches on which two edges are together, then those within reach that nothing else joins."""
    pairs = list(_near_pairs(borders))
    joins = [stretch for pair in pairs for stretch in _stretches(pair, min(one.gap for one in pair))]
    found, joined = list(joins), covered(joins, borders)
    open_edges = {border for border in borders if free_intervals(border, joined[border])}
    for pair in pairs:
        if not open_edges.issuperset(pair):
            continue
        elsewhere = covered([one for one in joins if one.borders != pair], pair)
        for stretch in _stretches(pair, min(one.reach for one in pair)):
            if all(_overlap(*one) <= 0.5 for one in zip(stretch.intervals, elsewhere.values(), strict=True)):
                found += _loose_parts(stretch, joined)
    return found


def covered(stretches: Sequence[Stretch], borders: Sequence[Border]) -> dict[Border, list[Interval]]:
    """The intervals of each edge that stretches cover."""
    joined: dict[Border, list[Interval]] = {border: [] for border in borders}
    for stretch in stretches:
        for border, interval in zip(stretch.borders, stretch.intervals, strict=True):
            if border in joined:
                joined[border].append(interval)
    return joined


def free_intervals(border: Border, joined: Sequence[Interval]) -> list[Interval]:
    """What is left of an edge; shorter than a millionth of it is nothing.

    Examples
    --------
    >>> from types import SimpleNamespace
    >>> border = SimpleNamespace(edge=SimpleNamespace(interval=(0.0, 1.0)))
    >>> free_intervals(border, [(0.25, 0.5), (0.4, 0.75)])
    [(0.0, 0.25), (0.75, 1.0)]
    """
    (reached, high), left = border.edge.interval, []
    least = 1e-6 * (high - reached)
    for start, stop in [*sorted(joined), (high, high)]:
        if start - reached > least:
            left.append((reached, start))
        reached = max(reached, stop)
    return left


def _loose_parts(stretch: Stretch, joined: dict[Border, list[Interval]]) -> Iterator[Stretch]:
    """What of a stretch is joined to nothing on the first edge, nor for the most part on the second."""
    first, second = stretch.borders
    for low, high in free_intervals(first, joined[first]):
        start, stop = max(low, stretch.interval[0]), min(high, stretch.interval[1])
        t = np.linspace(start, max(start, stop), SAMPLES)
        s = stretch.partner(t)
        for end in (0, -1):
            s[end] = stretch.s[end] if t[end] == stretch.t[end] else s[end]
        wide = np.ptp(first.edge.position(t), axis=0).max() > TOUCH * min(first.gap, second.gap)
        part = Stretch(stretch.borders, (start, stop), t, s)
        if wide and _overlap(part.intervals[1], joined[second]) <= 0.5:
            yield part


def _overlap(interval: Interval, others: Sequence[Interval]) -> float:
    """The share of an interval that others cover, which do not cover one another."""
    low, high = interval
    return sum(max(0.0, min(high, stop) - max(low, start)) for start, stop in others) / max(high - low, 1e-300)


def _near_pairs(borders: Sequence[Border]) -> Iterator[tuple[Border, Border]]:
    if not borders:
        return
    boxes = np.array([border.box for border in borders])
    reach = np.array([border.reach for border in borders])
    room = np.minimum(reach[:, None], reach[None])[..., None]
    apart = (boxes[:, None, 0] - room > boxes[None, :, 1]) | (boxes[None, :, 0] - room > boxes[:, None, 1])
    for i, j in zip(*np.nonzero(~apart.any(axis=-1)), strict=True):
        if i < j:
            yield borders[i], borders[j]


def _stretches(pair: tuple[Border, Border], room: float) -> Iterator[Stretch]:
    """Where the second edge stays within `room` of the first, cut where either of them ends."""
    first, second = pair
    gap = min(first.gap, second.gap)
    if not (_could_meet(first, second, room) or _could_meet(second, first, room)):
        return
    least = max(2 * room, TOUCH * gap)
    ends, distances = projected(first, second.points[[0, -1]], room)
    cuts = _cuts(first, [float(t) for t, d in zip(ends, distances, strict=True) if d <= room], least)
    for start, stop in pairwise(cuts):
        t = np.linspace(start, stop, SAMPLES)
        s, away = projected(second, first.edge.position(t), room)
        if (away <= room).all():
            runs = [(t, s)]
        else:
            runs = list(_parts(pair, t, away <= room, room)) if room <= gap else []
        for places, partners in runs:
            if np.ptp(first.edge.position(places), axis=0).max() > least:
                interval = (float(places[0]), float(places[-1]))
                yield Stretch(pair, interval, places, _to_ends(second, _unwound(second, partners), least))


def _could_meet(one: Border, other: Border, room: float) -> bool:
    """Whether some neighbouring samples of one edge, at its ends two, may all be within `room` of the other."""
    near = other.roughly(one.points)[1] <= room
    return bool((near[2:] & near[1:-1] & near[:-2]).any() or near[:2].all() or near[-2:].all())


def _cuts(border: Border, places: Sequence[float], least: float) -> list[float]:
    """Both ends of an edge and, in order, the places between that are not too near to others."""
    low, high = border.edge.interval
    points = {t: border.edge.position(t) for t in (low, high, *places)}
    kept = [low, high]
    for t in places:
        if min(float(np.linalg.norm(points[t] - points[one])) for one in kept) > least:
            kept.append(t)
    return sorted(kept)


def _parts(
    pair: tuple[Border, Border], t: Floats, inside: NDArray[np.bool_], room: float
) -> Iterator[tuple[Floats, Floats]]:
    """Runs of samples within `room` of the second edge, extended to where it leaves."""
    first, second = pair
    steps = np.diff(np.concatenate([[False], inside, [False]]).astype(int))
    starts, stops = (np.nonzero(steps == sign)[0].tolist() for sign in (1, -1))
    for start, after in zip(starts, stops, strict=True):
        stop = after - 1
        if stop - start + 1 >= LEAST_RUN:
            begin = _border_of_run(pair, t[start], t[max(start - 1, 0)], room)
            end = _border_of_run(pair, t[stop], t[min(stop + 1, len(t) - 1)], room)
            places = np.unique([begin, *t[start : stop + 1], end])
            yield places, projected(second, first.edge.position(places), room)[0]


def _border_of_run(pair: tuple[Border, Border], inside: float, outside: float, room: float) -> float:
    """The last parameter at which the edges are together, between one where they are and one where they are not."""
    for _ in range(BISECTIONS):
        middle = (inside + outside) / 2
        together = projected(pair[1], pair[0].edge.position(np.array([middle])), room)[1][0] <= room
        inside, outside = (middle, outside) if together else (inside, middle)
    return inside


def _to_ends(border: Border, s: Floats, least: float) -> Floats:
    """The parameters, the first and last moved to the ends of the edge if less than `least` is left over there."""
    ends = np.array(border.edge.interval)
    for place in (0, -1):
        nearest = int(np.argmin(np.abs(ends - s[place])))
        left = np.linalg.norm(border.edge.position(s[place]) - border.points[-nearest])
        s[place] = ends[nearest] if left <= least else s[place]
    return s


def _unwound(border: Border, s: Floats) -> Floats:
    """Parameters without the jump where a loop begins anew."""
    low, high = border.edge.interval
    if not border.loop:
        return s
    turned = np.unwrap(s, period=high - low)
    turned -= (high - low) * np.floor((np.median(turned) - low) / (high - low))
    return np.asarray(np.clip(turned, low, high))


@dataclass(frozen=True, eq=False)
class Comparison:
    """What was measured at parameters t of the first edge and s of the second, n of each.

    gaps are lengths, angles degrees, curvature_jumps one over length; what does not exist is NaN.
    """

    t: Floats
    s: Floats
    points: Floats
    gaps: Floats
    angles: Floats
    curvature_jumps: Floats
    curvatures: Floats

    @property
    def values(self) -> Floats:
        """Gaps, angles and jumps of curvature (3, n)."""
        return np.stack([self.gaps, self.angles, self.curvature_jumps])

    def __add__(self, other: Comparison) -> Comparison:
        """Both, in the order of t."""
        order = np.argsort(np.concatenate([self.t, other.t]), kind="stable")
        pairs = [(getattr(self, name), getattr(other, name)) for name in self.__dataclass_fields__]
        return Comparison(*(np.concatenate(pair)[order] for pair in pairs))


def compare(stretch: Stretch, t: Floats) -> Comparison:
    """Gap, kink and jump of curvature at parameters t of the first edge.

    The kink is the angle between the outer conormal of one patch and the inner one of the other: the angle between
    the normals, but 180 degrees where a surface turns back on itself. The curvatures are those across the edge, one
    transversal direction: surfaces with equal tangent planes along a curve have equal second forms there if they
    have equal normal curvatures in one direction other than the tangent's.

    Source of the criterion: Pegna and Wolter (1992), the linkage curve theorem.
    """
    first, second = (border.edge for border in stretch.borders)
    s = stretch.partner(t)
    points, others = first.position(t), second.position(s)
    (n1, out1, k1), (n2, out2, k2) = (
        edge.bend(at) for edge, at in zip((first, second), stretch.calm(t, s), strict=True)
    )
    tilt = np.degrees(np.arctan2(norm(np.cross(n1, n2)), np.abs(dot(n1, n2))))
    angles = np.where(dot(out1, out2) > 0, 180 - tilt, tilt)
    k2 = -k2 if flipped(stretch) else k2
    return Comparison(t, s, points, norm(points - others), angles, np.abs(k1 - k2), np.maximum(abs(k1), abs(k2)))


def flipped(stretch: Stretch) -> bool:
    """Whether the normals of the two patches point to different sides: both boundaries then run the same way."""
    first, second = (border.edge.anticlockwise for border in stretch.borders)
    return (first == second) != stretch.opposite


@dataclass(frozen=True, eq=False)
class EdgeSurvey:
    """All that was measured, and how much the three greatest values moved when more was."""

    samples: Comparison
    errors: Floats

    @property
    def greatest(self) -> list[int]:
        """Where the gap, the angle and the jump are greatest; 0 where nothing is known."""
        return [int(np.argmax(row)) for row in _known(self.samples.values)]


def survey(stretch: Stretch, tolerances: Callable[[Comparison], Floats]) -> EdgeSurvey:
    """Measure along a stretch until the greatest values stay; they are looked for between the samples too."""
    low, high = stretch.interval
    found, before = compare(stretch, np.array([low, high])), np.full(3, np.inf)
    for count in LEVELS:
        new = np.setdiff1d(golden_samples(count, low, high), found.t)
        found = found + compare(stretch, new)
        tolerated = tolerances(found)
        if (_known(found.values).max(axis=1) > NEGLIGIBLE * tolerated).any():
            found = _climbed(stretch, found, tolerated)
        now = _known(found.values).max(axis=1)
        moved, before = np.abs(now - before), now
        if (moved <= np.maximum(SETTLED * now, NEGLIGIBLE * tolerated)).all():
            break
    return EdgeSurvey(found, moved)


def golden_samples(count: int, low: float, high: float) -> Floats:
    """Sorted parameters, both ends among them; those for fewer are among those for more.

    Examples
    --------
    >>> golden_samples(4, 0.0, 1.0).round(3).tolist()
    [0.0, 0.236, 0.618, 1.0]
    """
    inner = np.mod(np.arange(1, count - 1) * GOLDEN, 1.0)
    return np.concatenate([[low], low + (high - low) * np.sort(inner), [high]])


def _climbed(stretch: Stretch, found: Comparison, tolerated: Floats) -> Comparison:
    """The samples, and those on the way to the greatest values: brackets round the best, divided again and again."""
    for _ in range(ROUNDS):
        values, last = _known(found.values), len(found.t) - 1
        worth = values[values.max(axis=1) > NEGLIGIBLE * tolerated]
        best = np.argsort(worth, axis=1, kind="stable")[:, -PEAKS:]
        peaks = np.unique(best)
        low, high = found.t[np.maximum(peaks - 1, 0)], found.t[np.minimum(peaks + 1, last)]
        shares = np.arange(1, INNER + 1) / (INNER + 1)
        new = np.setdiff1d(low[:, None] + (high - low)[:, None] * shares, found.t)
        found = found + compare(stretch, new)
    return found


def _known(values: Floats) -> Floats:
    return np.where(np.isfinite(values), values, -1.0)
