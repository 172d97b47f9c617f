"""Blocks of cells that the surface may meet, found breadth first in an octree that interval arithmetic prunes.

Their sign bits as bit fields say which cells hold surface, which lattice edges cross it, and their numbers.

A block is 8x8x8 cells; its signs are the bits i*81 + j*9 + k of a row of bytes, at least 93 of them. A field is one
64-bit word for each layer i of a block, bit j*8 + k. One more block, empty, follows the last: its rank is the number
of all, and a block that is not kept is looked up as this one.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass
from functools import partial
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from rsym.arrays import Flags, Floats, Ints
from rsym.sampling.kernels.mesher_kernels import MesherKernels
from rsym.sampling.sharp.loops import in_threads, loop, lowest, popcount, step

Bytes: TypeAlias = NDArray[np.uint8]
Words: TypeAlias = NDArray[np.uint64]
Numbers: TypeAlias = NDArray[np.int32]

ONE = np.uint64(1)
BYTE = np.uint64(255)
PAIR, TWO, FOUR = np.uint64(3), np.uint64(2), np.uint64(4)
LINE = np.uint64(511)
ABSENT = -1


@step
def line(bits: Bytes, block: int, i: int, j: int) -> Any:
    """Signs of the nine lattice points of a block along k, as the low bits of a word."""
    at = (i * 9 + j) * 9
    q = at >> 3
    word = bits[block, q] | np.uint32(bits[block, q + 1]) << 8 | np.uint32(bits[block, q + 2]) << 16
    return np.uint64(word) >> np.uint64(at & 7) & LINE


@loop
def scan(bits: Bytes, first: int, last: int, cells: Words, edges: Words, row: Words) -> None:
    """Fields of the cells that hold surface (blocks, 8) and of the lattice edges that cross it (3, blocks, 8).

    `row` (81,) is scratch.
    """
    for b in range(first, last):
        for r in range(81):
            row[r] = line(bits, b, 0, r)
        for i in range(8):
            c = x = y = z = np.uint64(0)
            for j in range(8):
                # The four lines of lattice points along k that bound a line of cells.
                p, q, r, s = row[i * 9 + j], row[i * 9 + j + 1], row[i * 9 + 9 + j], row[i * 9 + j + 10]
                some, every = p | q | r | s, p & q & r & s
                shift = np.uint64(8 * j)
                c |= ((some | some >> ONE) & ~(every & every >> ONE) & BYTE) << shift
                x |= ((p ^ r) & BYTE) << shift
                y |= ((p ^ q) & BYTE) << shift
                z |= ((p ^ p >> ONE) & BYTE) << shift
            cells[b, i] = c
            edges[0, b, i] = x
            edges[1, b, i] = y
            edges[2, b, i] = z


def ranks(fields: Words) -> tuple[Numbers, int]:
    """How many bits are set before each word, in the order of the array, and in all.

    Examples
    --------
    >>> before, total = ranks(np.array([5, 0, 7], np.uint64))
    >>> before.tolist(), total
    ([0, 2, 2], 5)
    """
    count = np.bitwise_count(fields).ravel()
    before = np.zeros(count.size, np.int32)
    np.cumsum(count[:-1], out=before[1:])
    return before.reshape(fields.shape), int(before[-1]) + int(count[-1])


# Lines of eight cells, from the first on, so many.
_LINES = np.array([sum(1 << 8 * j for j in range(count)) for count in range(9)], np.uint64)


def fields_in(corner: Ints, low: Ints, high: Ints) -> Words:
    """Fields (blocks, 8) of the cells of blocks that lie in a box, from `low` to below `high`.

    Examples
    --------
    >>> field = fields_in(np.zeros((3, 1), np.int64), np.array([-3, 1, 2]), np.array([2, 3, 4]))
    >>> [hex(word) for word in field[0].tolist()]
    ['0xc0c00', '0xc0c00', '0x0', '0x0', '0x0', '0x0', '0x0', '0x0']
    """
    begin, end = (np.clip(ends[:, None] - corner, 0, 8) for ends in (low, high))
    plane = (_LINES[end[1]] - _LINES[begin[1]]) * ((1 << end[2]) - (1 << begin[2])).astype(np.uint64)
    layer = np.arange(8)
    held = (layer >= begin[0][:, None]) & (layer < end[0][:, None])
    return np.where(held, plane[:, None], np.uint64(0))


@step
def rank(block: int, i: int, j: int, k: int, fields: Words, before: Numbers) -> Any:
    """Give the number of cell (or lattice edge) (i, j, k) of a block, -1 where its bit is not set."""
    here = ONE << np.uint64(j * 8 + k)
    if fields[block, i] & here == 0:
        return ABSENT
    return before[block, i] + np.int64(popcount(fields[block, i] & (here - ONE)))


@step
def block_at(i: int, j: int, k: int, blocks: Numbers, origin: Ints) -> Any:
    """Give the number of the block that holds a cell of the lattice, at most one block away from some kept block."""
    return blocks[(i >> 3) - origin[0], (j >> 3) - origin[1], (k >> 3) - origin[2]]


@step
def find(i: int, j: int, k: int, blocks: Numbers, origin: Ints, fields: Words, before: Numbers) -> Any:
    """Give the number of a cell (or lattice edge) of the lattice, -1 where it has none."""
    return rank(block_at(i, j, k, blocks, origin), i & 7, j & 7, k & 7, fields, before)


def lookup(corner: Ints) -> tuple[Numbers, Ints]:
    """Numbers of the blocks over the box that they fill, with a margin of one block, and the first block of that box.

    Examples
    --------
    >>> blocks, origin = lookup(np.array([[0, 8], [8, 8], [8, 8]]))
    >>> blocks.shape, origin.tolist(), blocks[1:3, 1, 1].tolist()
    ((4, 3, 3), [-1, 0, 0], [0, 1])
    """
    place, number = corner >> 3, corner.shape[1]
    origin = place.min(axis=1, initial=2**31) - 1 if number else np.zeros(3, np.int64)
    place = place - origin[:, None]
    blocks = np.full(place.max(axis=1, initial=0) + 2, number, np.int32)
    blocks[tuple(place)] = np.arange(number)
    return blocks, origin


@loop
def list_cells(bits: Bytes, cells: Words, before: Numbers, first: int, last: int, case: Any, place: Numbers) -> None:
    """Cases of the cells that hold surface, all faces apart, and their places, 512*block + 64*i + 8*j + k."""
    for b in range(first, last):
        for i in range(8):
            w, n = cells[b, i], before[b, i]
            while w:
                q = lowest(w)
                w &= w - ONE
                j, k = q >> 3, np.uint64(q & 7)
                low = line(bits, b, i, j) >> k & PAIR | (line(bits, b, i, j + 1) >> k & PAIR) << TWO
                high = line(bits, b, i + 1, j) >> k & PAIR | (line(bits, b, i + 1, j + 1) >> k & PAIR) << TWO
                case[n] = (low | high << FOUR) * TWO
                place[n] = b * 512 + i * 64 + q
                n += 1


@loop
def list_edges(corner: Ints, edges: Words, before: Numbers, first: int, last: int, x: Any, y: Any, z: Any) -> None:
    """Lower ends, as integers of the lattice, of the edges of one axis that cross the surface."""
    for b in range(first, last):
        for i in range(8):
            w, n = edges[b, i], before[b, i]
            while w:
                q = lowest(w)
                w &= w - ONE
                x[n], y[n], z[n] = corner[0, b] + i, corner[1, b] + (q >> 3), corner[2, b] + (q & 7)
                n += 1


@loop
def list_places(fields: Words, before: Numbers, place: Numbers) -> None:
    """Places, 512*block + 64*i + 8*j + k, of the bits that are set."""
    for b in range(fields.shape[0]):
        for i in range(8):
            w, n = fields[b, i], before[b, i]
            while w:
                place[n] = b * 512 + i * 64 + lowest(w)
                w &= w - ONE
                n += 1


BLOCK = 8  # cells along its side
# Of the first boxes there are at most 4 to 8 along the longest side: fewer prune nothing.
FIRST = 4
_HALVES = np.array([[i, j, k] for i in (0, 1) for j in (0, 1) for k in (0, 1)], np.float64)


@dataclass(frozen=True)
class Blocks:
    """Kept blocks in lexicographic order: first cells (3, n), and what matters in each, `words` of kernels.

    `visited` tells for each level the size of its boxes in cells, how many were looked at, and how many kept.
    """

    corner: Ints
    words: Any
    visited: tuple[tuple[int, int, int], ...]


def find_blocks(
    kernels: MesherKernels,
    lattice: Floats,
    cells: Sequence[int],
    pool: Executor | None = None,
    region: tuple[Ints | Sequence[int], Ints | Sequence[int]] | None = None,
    claim: Callable[[Floats, int], None] = lambda corner, size: None,
    finest: int = BLOCK,
) -> Blocks:
    """The blocks of a lattice, or of a region of cells in it, in which the form may have a zero; or `finest` boxes.

    Which blocks are kept depends on the whole lattice alone, not on the region. `claim` is told which
    boxes of what size are kept before their halves, eight of each, are allocated, and may raise.
    """
    size = BLOCK
    while size * FIRST < max(cells):
        size *= 2
    low, high = (np.zeros(3), np.array(cells, np.float64)) if region is None else map(np.asarray, region)
    axes = [np.arange(a // size * size, b, size, dtype=np.float64) for a, b in zip(low, high, strict=True)]
    corner = np.stack(np.meshgrid(*axes, indexing="ij")).reshape(3, -1)
    parent, among, visited = np.zeros(corner.shape[1], np.int64), None, []
    run = partial(in_threads, pool=pool)
    while True:
        keep, words = kernels.kept(_ends(lattice, corner, size), parent, among, run)
        visited.append((size, corner.shape[1], int(keep.sum())))
        corner, among = corner[:, keep], words[keep]
        if size <= finest:
            break
        claim(corner, size)
        size //= 2
        parent = np.repeat(np.arange(corner.shape[1]), len(_HALVES))
        corner = (corner[:, :, None] + size * _HALVES.T[:, None, :]).reshape(3, -1)
        some = ((corner < high[:, None]) & (corner + size > low[:, None])).all(axis=0)
        corner, parent = corner[:, some], parent[some]
    order = np.lexsort(corner[::-1])
    return Blocks(np.ascontiguousarray(corner[:, order], np.int64), among[order], tuple(visited))


def inside(corner: Ints | Floats, box: Ints | Floats) -> Flags:
    """Which cells are in a box (2, 3)."""
    return np.asarray(((corner >= box[0, :, None]) & (corner < box[1, :, None])).all(axis=0))


def _ends(lattice: Floats, corner: Floats, size: int) -> Floats:
    """The ends (6, n) of boxes on the lattice, lower and upper for each axis."""
    ends = np.empty((6, corner.shape[1]))
    ends[::2] = lattice[:3, None] + lattice[3:, None] * corner
    ends[1::2] = lattice[:3, None] + lattice[3:, None] * (corner + size)
    return ends
