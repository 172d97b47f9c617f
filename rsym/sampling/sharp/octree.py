"""Blocks of cells that the surface may meet: an octree, breadth first, that interval arithmetic prunes."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rsym.arrays import Floats, Ints
from rsym.sampling.kernels.mesher_kernels import MesherKernels, columns
from rsym.sampling.sharp.loops import in_threads

BLOCK = 8  # cells along its side
# Of the first boxes there are at most 4 to 8 along the longest side: fewer prune nothing.
FIRST = 4
GRAIN = 2048
_HALVES = np.array([[i, j, k] for i in (0, 1) for j in (0, 1) for k in (0, 1)], np.float64)


@dataclass(frozen=True)
class Blocks:
    """Kept blocks in lexicographic order: first cells (3, n), and n rows of words of idle operands.

    `visited` tells for each level the size of its boxes in cells, how many were looked at, and how many kept.
    """

    corner: Ints
    words: NDArray[np.uint64]
    visited: tuple[tuple[int, int, int], ...]


def find_blocks(
    kernels: MesherKernels,
    lattice: Floats,
    cells: Sequence[int],
    pool: Executor | None = None,
    region: tuple[Sequence[int], Sequence[int]] | None = None,
    claim: Callable[[int, int], None] = lambda kept, size: None,
) -> Blocks:
    """The blocks of a lattice, or of a region of cells in it, in which the form may have a zero.

    Which blocks are kept depends on the whole lattice alone, not on the region. `claim` is told how many
    boxes of what size are kept before their halves, eight of each, are allocated, and may raise.
    """
    size = BLOCK
    while size * FIRST < max(cells):
        size *= 2
    low, high = (np.zeros(3), np.array(cells, np.float64)) if region is None else map(np.asarray, region)
    axes = [np.arange(a // size * size, b, size, dtype=np.float64) for a, b in zip(low, high, strict=True)]
    corner = np.stack(np.meshgrid(*axes, indexing="ij")).reshape(3, -1)
    visited = []
    while True:
        keep, skip = _kept(kernels, corner, size, lattice, pool)
        visited.append((size, corner.shape[1], int(keep.sum())))
        corner = corner[:, keep]
        if size == BLOCK:
            break
        claim(corner.shape[1], size)
        size //= 2
        corner = (corner[:, :, None] + size * _HALVES.T[:, None, :]).reshape(3, -1)
        corner = corner[:, ((corner < high[:, None]) & (corner + size > low[:, None])).all(axis=0)]
    order = np.lexsort(corner[::-1])
    words = np.ascontiguousarray(skip[:, keep].T[order])
    return Blocks(np.ascontiguousarray(corner[:, order], np.int64), words, tuple(visited))


def _kept(
    kernels: MesherKernels, corner: Floats, size: int, lattice: Floats, pool: Executor | None
) -> tuple[NDArray[np.bool_], NDArray[Any]]:
    count = corner.shape[1]
    places = columns(corner)
    keep = np.empty(places.shape[1] // 8, np.uint8)
    skip = np.empty((kernels.words, places.shape[1]), np.uint64)
    in_threads(lambda a, b: kernels.boxes(a, b, places, size, lattice, keep, skip), count, GRAIN, pool)
    return np.unpackbits(keep, count=count, bitorder="little").view(np.bool_), skip[:, :count]
