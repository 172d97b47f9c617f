"""Clusters: boxes that touch, gathered in time proportional to their number."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations_with_replacement

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from rsym.bounds.balls import arb
from rsym.sampling.progress import Effort
from rsym.verify.boxes.local import Box, side

LONG = 50  # widths of a box: a longer cluster of few boxes is a curve
FEW = 40  # boxes for each width of length: a curve that is undecided leaves up to three by three, a surface far more


@dataclass(frozen=True)
class Cluster:
    """Boxes that hang together, of a model of so many coordinates."""

    boxes: tuple[Box, ...]
    dimension: int

    @cached_property
    def ends(self) -> NDArray[np.float64]:
        """(n, dimension, 2)."""
        return np.array([box[: self.dimension] for box in self.boxes], dtype=np.float64)

    @cached_property
    def width(self) -> float:
        """The largest side of a box."""
        return float((self.ends[..., 1] - self.ends[..., 0]).max())

    @cached_property
    def hull(self) -> Box:
        """The box around all."""
        low, high = self.ends[..., 0].min(axis=0), self.ends[..., 1].max(axis=0)
        return tuple((float(a), float(b)) for a, b in zip(low, high, strict=True))

    @property
    def ranges(self) -> Box:
        """The hull of the ranges of letters, the sides of the boxes after those in space."""
        letters = zip(*(box[self.dimension :] for box in self.boxes), strict=True)
        return tuple((min(low for low, _ in ends), max(high for _, high in ends)) for ends in letters)

    @property
    def centre(self) -> tuple[float, ...]:
        """The middle of the hull."""
        return tuple(low + (high - low) / 2 for low, high in self.hull)

    @property
    def radius(self) -> float:
        """Half the diagonal of the hull: all boxes lie within it."""
        return math.nextafter(math.dist(*zip(*self.hull, strict=True)) / 2, math.inf)

    def may_hold(self, point: Sequence[arb]) -> bool:
        """Whether a point may lie in one of the boxes."""
        return any(
            all(part.overlaps(side(*ends)) for part, ends in zip(point, box, strict=False)) for box in self.boxes
        )

    @property
    def is_long(self) -> bool:
        """Whether the boxes lie along a curve."""
        extent = max(high - low for low, high in self.hull)
        return extent > LONG * self.width and len(self.boxes) < FEW * extent / self.width

    def ordered(self) -> NDArray[np.float64]:
        """Middles of the boxes along the curve that they make, two widths apart or more: each step to the nearest.

        A closed curve repeats its first point.
        """
        middles = self.ends.mean(axis=2)
        direction = np.linalg.svd(middles - middles.mean(axis=0), full_matrices=False)[2][0]
        tree, here = cKDTree(middles), int((middles @ direction).argmin())
        left, chain = np.ones(len(middles), bool), [here]
        while True:
            left[tree.query_ball_point(middles[here], 2 * self.width)] = False
            near = np.array(sorted(tree.query_ball_point(middles[here], 6 * self.width)))
            near = near[left[near]]
            if not len(near):
                break
            here = int(near[np.linalg.norm(middles[near] - middles[here], axis=1).argmin()])
            chain.append(here)
        points: NDArray[np.float64] = middles[chain]
        closed = len(chain) > 8 and math.dist(points[0], points[-1]) < 6 * self.width
        return np.concatenate([points, points[:1]]) if closed else points


def clusters(boxes: Sequence[Box], dimension: int, effort: Effort) -> Iterator[Cluster]:
    """The boxes in groups of those that touch, in the order of their first boxes, as long as there is time.

    Examples
    --------
    >>> unit = ((0.0, 1.0), (0.0, 1.0))
    >>> boxes = [((0.0, 1.0), *unit), ((5.0, 6.0), *unit), ((1.0, 1.5), *unit)]
    >>> [len(one.boxes) for one in clusters(boxes, 3, Effort())]
    [2, 1]
    """
    if not boxes or effort.is_over:
        return
    groups = _gathered(boxes, dimension)
    for number, group in enumerate(groups):
        if effort.is_over:
            return
        effort.reach(number / len(groups))
        yield Cluster(group, dimension)


def _gathered(boxes: Sequence[Box], dimension: int) -> list[tuple[Box, ...]]:
    pairs = _touching(np.array(boxes, dtype=np.float64), dimension)
    graph = coo_array((np.ones(len(pairs), bool), (pairs[:, 0], pairs[:, 1])), shape=(len(boxes),) * 2)
    groups: dict[int, list[Box]] = {}
    for box, label in zip(boxes, connected_components(graph, directed=False)[1].tolist(), strict=True):
        groups.setdefault(label, []).append(box)
    return [tuple(group) for group in groups.values()]


def _touching(ends: NDArray[np.float64], dimension: int) -> NDArray[np.int64]:
    """Pairs of boxes (n, axes, 2) that touch: among those with near middles, for each two sizes."""
    low, high = ends[..., 0], ends[..., 1]
    middles, widths = (low + (high - low) / 2)[:, :dimension], (high - low)[:, :dimension].max(axis=1)
    rounded = 4 * np.spacing(np.abs(ends).max())
    sizes = np.frexp(widths)[1]
    groups = [np.flatnonzero(sizes == size) for size in np.unique(sizes)]
    trees = [cKDTree(middles[group]) for group in groups]
    found = []
    for (one, tree), (other, beside) in combinations_with_replacement(zip(groups, trees, strict=True), 2):
        reach = (widths[one].max() + widths[other].max()) / 2 + rounded
        near = tree.sparse_distance_matrix(beside, reach, p=math.inf, output_type="ndarray")
        i, j = one[near["i"]], other[near["j"]]
        touch = ((low[i] <= high[j]) & (low[j] <= high[i])).all(axis=1)
        found.append(np.column_stack([i[touch], j[touch]]))
    return np.concatenate(found)
