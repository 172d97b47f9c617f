"""The boundary of a plane shape as polylines that follow every bend: areas, volumes and distances, numerical."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from rsym.arrays import Flags, Floats, Ints
from rsym.model.shape import Shape
from rsym.sampling.level_lines import trace
from rsym.sampling.plane import PlaneSampler, plane_sampler

RESOLUTION = 256
BEND = 0.04  # radians: where a polyline turns more it is refined; the sagitta is a hundredth of the segment
FINEST = 1e-8  # of the extent: segments at a corner are no longer than this
PASSES = 64  # from a cell to FINEST a tip of 35 degrees takes 45
# Shares of a segment at which the boundary is sought on the normal through its middle, ever farther away. A tip of
# 28 degrees cut off by a segment rises twice its length, one of 7 degrees eight times.
REACH = (0.0, 1 / 64, 1 / 16, 1 / 4, 1 / 2, 1.0, 2.0, 4.0, 8.0)
HALVINGS = 50
TOGETHER, FEW = 5, 128  # so many halvings in one call, of so few segments: a call takes as long as some 2 000 points
NODES = (np.array([-1.0, 0.0, 1.0]) * np.sqrt(0.6) + 1) / 2  # of Gauss, exact to degree 5
WEIGHTS = np.array([5.0, 8.0, 5.0]) / 18
TOP = 256  # points whose distance is found exactly at a time


@dataclass(frozen=True, eq=False)
class Boundary:
    """Polylines (n, 2) with the inside on one side, and a point of the boundary over the middle of each segment.

    A closed line repeats its first point.
    """

    lines: tuple[Floats, ...]
    middles: tuple[Floats, ...]
    slopes: Floats  # |grad omega| at the points

    @property
    def closed(self) -> bool:
        """Whether no line ends."""
        return all(bool((line[0] == line[-1]).all()) for line in self.lines)

    @property
    def points(self) -> Floats:
        """All points."""
        return np.concatenate([np.empty((0, 2)), *self.lines, *self.middles])

    @property
    def deviation(self) -> float:
        """The largest | |grad omega| - 1 | found, where there is a gradient; NaN without any."""
        known = self.slopes[np.isfinite(self.slopes)]
        return float(np.abs(known - 1).max()) if len(known) else np.nan

    def area(self) -> float:
        """The area inside."""
        return float(abs(self._integral(lambda v: v)))

    def volume(self) -> float:
        """The volume inside the body that turns about the first coordinate; the lines are symmetric to it."""
        return float(np.pi / 2) * abs(self._integral(lambda v: v * np.abs(v)))

    def _integral(self, weight: Callable[[Floats], Floats]) -> float:
        """The integral of weight(v) du along the lines, each segment a parabola."""
        total = 0.0
        for line, middle in zip(self.lines, self.middles, strict=True):
            start, end = line[:-1], line[1:]
            linear, square = -3 * start + 4 * middle - end, 2 * (start - 2 * middle + end)
            for node, share in zip(NODES, WEIGHTS, strict=True):
                place, speed = start + node * (linear + node * square), linear + 2 * node * square
                total += share * float(np.sum(weight(place[:, 1]) * speed[:, 0]))
        return total


def boundary(shape: Shape, bounds: Sequence[Sequence[float]], resolution: int = RESOLUTION) -> Boundary:
    """The boundary of a plane shape within bounds, refined until no polyline turns by more than `BEND` at a point.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> square = rsym.conjunction(1 - x, 1 + x, 1 - y, 1 + y)
    >>> found = boundary(rsym.Shape(square, (x, y)), ((-2, 2), (-2, 2)), 32)
    >>> found.closed, round(found.area(), 9)
    (True, 4.0)
    """
    sampler = plane_sampler(shape, "value", resolution=resolution, bounds=tuple(bounds))
    extent = max(high - low for low, high in bounds)
    found = trace(sampler, 0.0, bounds=sampler.bounds)
    lines = _refined(sampler, [line for line in found if len(line) > 2], FINEST * extent)
    middles = _over(sampler, *_segments_of(lines))[0]
    every = np.concatenate([np.empty((0, 2)), *lines, middles])
    _, gradient = sampler.value_and_gradient(every)
    return Boundary(tuple(lines), tuple(_parts(middles, [len(line) - 1 for line in lines])), np.hypot(*gradient.T))


def _segments_of(lines: Sequence[Floats]) -> tuple[Floats, Floats]:
    """Starts and ends of the segments of all lines."""
    start, end = ([line[part] for line in lines] for part in (slice(None, -1), slice(1, None)))
    return np.concatenate([np.empty((0, 2)), *start]), np.concatenate([np.empty((0, 2)), *end])


def _parts(array: NDArray[Any], counts: Sequence[int]) -> list[NDArray[Any]]:
    """So many rows for each."""
    return np.split(array, np.cumsum(counts)[:-1]) if counts else []


def _refined(sampler: PlaneSampler, lines: Sequence[Floats], finest: float) -> list[Floats]:
    """Halve the segments at both sides of every bend, again and again, those of all lines at once."""
    lines, going = list(lines), list(range(len(lines)))
    for _ in range(PASSES):
        wanted = [_beside_bends(lines[k], finest) for k in going]
        parts = [lines[k][np.stack([at, at + 1])] for k, at in zip(going, wanted, strict=True)]
        start, end = np.concatenate([np.empty((2, 0, 2)), *parts], axis=1)
        middles, found = (_parts(array, [len(at) for at in wanted]) for array in _over(sampler, start, end))
        changed = [k for k, some in zip(going, found, strict=True) if some.any()]
        for k, at, middle, some in zip(going, wanted, middles, found, strict=True):
            lines[k] = np.insert(lines[k], at[some] + 1, middle[some], axis=0)
        going = changed
    return lines


def _beside_bends(line: Floats, finest: float) -> Ints:
    """The segments at both sides of bends that are not as short as they may be."""
    along = np.diff(line, axis=0)
    bent = _bends(along, closed=bool((line[0] == line[-1]).all()))
    return np.flatnonzero((bent[:-1] | bent[1:]) & (np.hypot(*along.T) > finest))


def _bends(along: Floats, *, closed: bool) -> Flags:
    """At each vertex, whether the polyline turns there."""
    angle = np.arctan2(along[:, 1], along[:, 0])
    turn = np.abs(np.angle(np.exp(1j * np.diff(angle))))
    around = abs(np.angle(np.exp(1j * (angle[0] - angle[-1])))) if closed else 0.0
    return np.concatenate([[around], turn, [around]]) > BEND


def _over(sampler: PlaneSampler, start: Floats, end: Floats) -> tuple[Floats, Flags]:
    """The nearest point of the boundary on the normal through the middle of each segment, and whether there is one."""
    middle = (start + end) / 2
    along = end - start
    normal = np.stack([-along[:, 1], along[:, 0]], axis=1)

    def at(shares: Floats) -> Floats:
        return middle + shares[..., None] * normal

    def sign(shares: Floats) -> Flags:
        return sampler.inside(at(shares).reshape(-1, 2)).reshape(shares.shape)

    # All that is asked before the halving, in one call: the nearest share first, and this side before the other.
    sides = [(side * before, side * after) for before, after in pairwise(REACH) for side in (1.0, -1.0)]
    near, far = np.array([(0.0, 0.0), *sides]).T
    signs = sign(np.broadcast_to(far[:, None], (len(far), len(middle))))
    here = signs[0]
    first = (signs != here).argmax(axis=0)  # the first of all where there is none
    low, high = near[first], far[first]
    together = TOGETHER if len(middle) <= FEW else 1
    for _ in range(0, HALVINGS, together):
        if (at(low) == at(high)).all():  # rounded, a point between them is no other
            break
        low, high = _halved(low, high, sign, here, together)
    found = first > 0
    return np.where(found[:, None], at((low + high) / 2), middle), found


def _halved(
    low: Floats, high: Floats, sign: Callable[[Floats], Flags], here: Flags, times: int
) -> tuple[Floats, Floats]:
    """What halving intervals so many times leaves of each, `here` being the sign at its lower end, in one call."""
    marks = np.stack([low, high])
    for _ in range(times):
        marks = np.insert(marks, range(1, len(marks)), (marks[:-1] + marks[1:]) / 2, axis=0)
    same = sign(marks[1:-1]) == here
    every, place = np.arange(len(low)), np.zeros(len(low), int)
    for step in (2**k for k in reversed(range(times))):
        place += np.where(same[place + step - 1, every], step, 0)
    return marks[place, every], marks[place + 1, every]


def distance(first: Boundary, second: Boundary) -> float:
    """The largest distance of a point of one boundary from the other (Hausdorff's), of the polylines.

    Infinite if one of them is empty.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> box = ((-2, 2), (-2, 2))
    >>> disc, larger = (boundary(rsym.Shape(r - x**2 - y**2, (x, y)), box, 64) for r in (1, 1.21))
    >>> round(distance(disc, larger), 3)
    0.1
    """
    if not (first.lines and second.lines):
        return math.inf
    return max(_farthest(first, second), _farthest(second, first))


def distances_to(points: Floats, other: Boundary) -> Floats:
    """The distance of each point (n, 2) from the polylines of a boundary.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> disc = boundary(rsym.Shape(1 - x**2 - y**2, (x, y)), ((-2, 2), (-2, 2)), 64)
    >>> distances_to(np.array([[0.0, 3.0], [0.25, 0.0]]), disc).round(3)
    array([2.  , 0.75])
    """
    return _to_segments(points, *_segments(other))


def _farthest(one: Boundary, other: Boundary) -> float:
    """The largest distance of a point of one boundary from the polylines of the other."""
    starts, along = _segments(other)
    tree = cKDTree(np.concatenate([starts, starts + along]))
    bound, _ = tree.query(one.points)
    order = np.argsort(-bound, kind="stable")
    largest = 0.0
    for begin in range(0, len(order), TOP):
        part = order[begin : begin + TOP]
        if bound[part[0]] <= largest:
            break
        largest = max(largest, float(_to_segments(one.points[part], starts, along).max()))
    return largest


def _segments(of: Boundary) -> tuple[Floats, Floats]:
    """Starts and directions of the segments, each halved at the boundary's point over its middle."""
    chains = [
        np.insert(line, np.arange(1, len(line)), middle, axis=0)
        for line, middle in zip(of.lines, of.middles, strict=True)
    ]
    starts = np.concatenate([chain[:-1] for chain in chains])
    return starts, np.concatenate([chain[1:] for chain in chains]) - starts


def _to_segments(points: Floats, starts: Floats, along: Floats) -> Floats:
    """The distance of each point (n, 2) from the nearest segment."""
    gap = points[:, None] - starts
    squared = np.maximum(np.einsum("ij,ij->i", along, along), np.finfo(float).tiny)
    share = np.clip(np.einsum("nij,ij->ni", gap, along) / squared, 0.0, 1.0)
    nearest: Floats = np.linalg.norm(gap - share[..., None] * along, axis=2).min(axis=1)
    return nearest
