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

from rsym.arrays import Floats
from rsym.sampling.kernels.mesher_kernels import MesherKernels, padded
from rsym.sampling.sharp.corners import settle
from rsym.sampling.sharp.crossings import Crossings
from rsym.sampling.sharp.loops import in_threads, loop, step
from rsym.sampling.sharp.topology import Topology

Shorts: TypeAlias = NDArray[np.int16]

# From a hundredth of a cell off, four steps end at rounding: 1e-2, 1e-4, 1e-8, 1e-16.
STEPS = 4
GRAIN = 4096

# Directions in which the tangent planes hardly differ say nothing: those below this share of the largest eigenvalue.
FLAT = 0.02
FIT_GRAIN = 1024
CLOSE = 0.5  # cells beyond its own in which a fitted vertex may lie


@dataclass(frozen=True)
class Vertices:
    """Points (3, n), padded; `feature` (n,) is not 0 on edges and corners; `off` counts vertices off the surface."""

    points: Floats
    feature: NDArray[np.uint8]


def place_vertices(
    kernels: MesherKernels,
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


def fitted(
    which: NDArray[np.integer[Any]],
    surface: Topology,
    crossings: Crossings,
    lattice: Floats,
    pool: Executor | None,
) -> Floats:
    """Minimisers (3, n) of the quadratic error of tangent planes, for some vertices.

    Sum of (n_i . (x - p_i))**2 over crossings p_i with unit normals n_i, least norm from the middle of the crossings
    (Ju, Losasso, Schaefer and Warren 2002), kept near the cell.
    """
    cell = np.searchsorted(surface.start, which, "right") - 1
    place = surface.place[cell].astype(np.int64)
    first = surface.corner[:, place >> 9] + np.stack([place >> 6 & 7, place >> 3 & 7, place & 7])
    low = lattice[:3, None] + lattice[3:, None] * (first - CLOSE)
    high = low + lattice[3:, None] * (1 + 2 * CLOSE)
    points = np.empty((3, len(which)))
    rings, tangents = (surface.ring_start, surface.ring), (crossings.points, crossings.gradients)
    in_threads(lambda a, b: minimise(a, b, which, *rings, *tangents, low, high, points), len(which), FIT_GRAIN, pool)
    return points


@loop
def minimise(
    first: int,
    last: int,
    which: Any,
    ring_start: Any,
    ring: Any,
    crossing: Floats,
    gradient: Floats,
    low: Floats,
    high: Floats,
    out: Floats,
) -> None:
    """The fit for each of some vertices, clamped between low and high."""
    matrix, vectors = np.empty((3, 3)), np.empty((3, 3))
    middle, right = np.empty(3), np.empty(3)
    for w in range(first, last):
        begin, end = ring_start[which[w]], ring_start[which[w] + 1]
        middle[:] = 0
        for at in range(begin, end):
            for a in range(3):
                middle[a] += crossing[a, ring[at]] / (end - begin)
        matrix[:] = 0
        right[:] = 0
        for at in range(begin, end):
            c = ring[at]
            square = gradient[0, c] ** 2 + gradient[1, c] ** 2 + gradient[2, c] ** 2
            if not 0 < square < np.inf:  # no tangent plane
                continue
            height = 0.0
            for a in range(3):
                height += gradient[a, c] * (crossing[a, c] - middle[a])
            for a in range(3):
                right[a] += gradient[a, c] * height / square
                for q in range(3):
                    matrix[a, q] += gradient[a, c] * gradient[q, c] / square
        diagonalise(matrix, vectors)
        top = max(matrix[0, 0], matrix[1, 1], matrix[2, 2])
        for a in range(3):
            out[a, w] = middle[a]
        for k in range(3):
            if matrix[k, k] > FLAT * top:
                step = (vectors[0, k] * right[0] + vectors[1, k] * right[1] + vectors[2, k] * right[2]) / matrix[k, k]
                for a in range(3):
                    out[a, w] += step * vectors[a, k]
        for a in range(3):
            out[a, w] = min(max(out[a, w], low[a, w]), high[a, w])


@step
def diagonalise(matrix: Floats, vectors: Floats) -> None:
    """Eigenvalues of a symmetric 3x3 matrix on its diagonal, vectors in the columns: cyclic Jacobi rotations."""
    for i in range(3):
        for j in range(3):
            vectors[i, j] = i == j
    for _ in range(6):
        if abs(matrix[0, 1]) + abs(matrix[0, 2]) + abs(matrix[1, 2]) < 1e-15 * (
            matrix[0, 0] + matrix[1, 1] + matrix[2, 2]
        ):
            break
        for p, q in ((0, 1), (0, 2), (1, 2)):
            if matrix[p, q] == 0:
                continue
            half = (matrix[q, q] - matrix[p, p]) / (2 * matrix[p, q])
            tangent = (1 if half >= 0 else -1) / (abs(half) + np.sqrt(half * half + 1))
            cosine = 1 / np.sqrt(tangent * tangent + 1)
            sine = tangent * cosine
            for k in range(3):
                u, v = matrix[k, p], matrix[k, q]
                matrix[k, p], matrix[k, q] = cosine * u - sine * v, sine * u + cosine * v
            for k in range(3):
                u, v = matrix[p, k], matrix[q, k]
                matrix[p, k], matrix[q, k] = cosine * u - sine * v, sine * u + cosine * v
            for k in range(3):
                u, v = vectors[k, p], vectors[k, q]
                vectors[k, p], vectors[k, q] = cosine * u - sine * v, sine * u + cosine * v
