"""Vertices: one for each patch of a cell, on the leaf, the edge or the corner that the patch shows.

The crossings around a patch know their leaves. One smooth leaf: the vertex goes
from the middle of the crossings onto the leaf. Two or three: Newton's method on all
of them at once puts it on their edge or corner. Leaves with kinks inside, and what
Newton's method leaves, start from the minimiser of the quadratic error instead.
"""

from __future__ import annotations

from concurrent.futures import Executor
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from rsym.sampling.kernels.surface_kernels import SurfaceKernels, padded
from rsym.sampling.sharp.corners import settle
from rsym.sampling.sharp.crossings import Crossings
from rsym.sampling.sharp.fitting import fitted
from rsym.sampling.sharp.loops import in_threads, loop
from rsym.sampling.sharp.patches import Topology

Floats: TypeAlias = NDArray[np.float64]
Shorts: TypeAlias = NDArray[np.int16]

# From a hundredth of a cell off, four steps end at rounding: 1e-2, 1e-4, 1e-8, 1e-16.
STEPS = 4
GRAIN = 4096


@dataclass(frozen=True)
class Vertices:
    """Points (3, n), padded; `feature` (n,) is not 0 on edges and corners; `off` counts vertices off the surface."""

    points: Floats
    feature: NDArray[np.uint8]


def place_vertices(
    kernels: SurfaceKernels,
    smooth: NDArray[np.bool_],
    surface: Topology,
    crossings: Crossings,
    lattice: Floats,
    pool: Executor | None,
) -> Vertices:
    """The vertices of a surface; `smooth` tells which leaves have no kinks."""
    count = surface.vertices
    points = np.zeros((3, padded(count)))
    single, feature = np.full(points.shape[1], -1, np.int16), np.zeros(points.shape[1], np.uint8)
    arrays = (surface.ring_start, surface.ring, crossings.points, crossings.leaf, smooth, points, single, feature)
    in_threads(lambda a, b: middles(a, b, *arrays), count, GRAIN, pool)
    in_threads(lambda a, b: kernels.slide(b - a, single, points, STEPS, first=a), count, GRAIN, pool)
    # A gradient that a smooth leaf has not, as that of a root at 0, is a kink.
    feature[:count][~np.isfinite(points[:, :count].sum(axis=0))] = 1
    several = np.flatnonzero(feature[:count])
    if len(several):
        start = fitted(several, surface, crossings, lattice, pool)
        points[:, several] = settle(kernels, several, start, surface, crossings, lattice, pool)
    return Vertices(points, feature)


@loop
def middles(
    first: int,
    last: int,
    ring_start: Any,
    ring: Any,
    crossing: Floats,
    leaf: Shorts,
    smooth: NDArray[np.bool_],
    points: Floats,
    single: Shorts,
    feature: NDArray[np.uint8],
) -> None:
    """The middle of the crossings of each patch; its leaf where it has one and that is smooth, else it is a feature."""
    for v in range(first, last):
        begin, end = ring_start[v], ring_start[v + 1]
        one = leaf[ring[begin]]
        alone = smooth[one]
        x = y = z = 0.0
        for at in range(begin, end):
            c = ring[at]
            x += crossing[0, c]
            y += crossing[1, c]
            z += crossing[2, c]
            alone &= leaf[c] == one
        share = 1.0 / (end - begin)
        points[0, v], points[1, v], points[2, v] = x * share, y * share, z * share
        if alone:
            single[v] = one
        else:
            feature[v] = 1
