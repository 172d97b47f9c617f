"""Everything of a mesh that depends on signs alone: its vertices, the crossings around each, the quads."""

from __future__ import annotations

from concurrent.futures import Executor
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rsym.sampling.sharp.loops import in_threads, loop, step
from rsym.sampling.sharp.signs import (
    ABSENT,
    Bytes,
    Numbers,
    Words,
    block_at,
    find,
    list_cells,
    lookup,
    rank,
    ranks,
    scan,
)
from rsym.sampling.sharp.tables import NO_PATCH, PatchTable, face_edges, patch_table

# A piece of fewer blocks takes less time than a thread needs to take it up.
GRAIN = 32


@dataclass(frozen=True)
class Topology:
    """The combinatorial surface of sign bits: a closed 2-manifold.

    Blocks: ``corner`` (3, n) their first cells; ``bits`` (n, stride) their signs; ``cells`` (n + 1, 8) and ``edges``
    (3, n + 1, 8) the fields of cells and crossings, ``cells_before`` and ``edges_before`` the ranks of their words;
    ``blocks``, ``origin`` the lookup of a block.

    Cells that hold surface, in the order of (block, cell): ``case`` (m,) their row of the patch table, ``place`` (m,)
    512*block + 64*i + 8*j + k, ``start`` (m + 1,) the number of their first vertex.

    Vertices, one for each patch of a cell: ``ring[ring_start[v]:ring_start[v + 1]]`` are the crossings of its patch.

    Crossings, axis by axis, in the order of (block, lattice edge): ``quads`` (crossings, 4) the vertices around each,
    counter-clockwise as seen from outside, -1 where a block beside the crossing is not here.
    """

    corner: NDArray[np.int64]
    bits: Bytes
    cells: Words
    cells_before: Numbers
    edges: Words
    edges_before: Numbers
    blocks: Numbers
    origin: NDArray[np.int64]
    case: NDArray[np.uint16]
    place: Numbers
    start: Numbers
    ring_start: Numbers
    ring: Numbers
    quads: Numbers
    flips: int

    @property
    def vertices(self) -> int:
        """Number of vertices."""
        return int(self.start[-1])

    @property
    def crossings(self) -> int:
        """Number of crossings."""
        return len(self.quads)

    @property
    def axes(self) -> list[int]:
        """First crossing of each axis, and the number of all."""
        return [*self.edges_before[:, 0, 0].tolist(), self.crossings]


def topology(corner: NDArray[np.int64], bits: Bytes, pool: Executor | None = None) -> Topology:
    """Find the surface of the sign bits of blocks in lexicographic order; manifold by construction.

    Two patches of neighbouring cells are joined by each segment that they share on the face between the cells. Where
    they share both segments of an ambiguous face, four triangles would meet on one edge; `separate` re-pairs such
    faces. Nothing else can go wrong: two cells share one face or one lattice edge, so no other edge or diagonal of
    the quads comes twice, and the quads around a vertex follow the loop around its patch.
    """
    table, (blocks, origin), n = patch_table(), lookup(corner), corner.shape[1]
    cells, edges = np.empty((n + 1, 8), np.uint64), np.empty((3, n + 1, 8), np.uint64)
    cells[n], edges[:, n] = 0, 0
    in_threads(lambda first, last: scan(bits, first, last, cells, edges), n, GRAIN, pool)
    (cells_before, active), (edges_before, crossings) = ranks(cells), ranks(edges)
    case, place = np.empty(active, np.uint16), np.empty(active, np.int32)
    in_threads(lambda first, last: list_cells(bits, cells, cells_before, first, last, case, place), n, GRAIN, pool)
    flips = separate(corner, case, place, blocks, origin, cells, cells_before, table)
    start, links = _starts(table.patches[case]), _starts(table.edges[case])
    ring_start, ring = np.empty(start[-1] + 1, np.int32), np.empty(links[-1], np.int32)
    ring_start[-1] = links[-1]
    quads = np.full((crossings, 4), ABSENT, np.int32)

    def piece(first: int, last: int) -> None:
        around = (corner, blocks, origin, cells_before, edges, edges_before)
        link(first, last, *around, case, place, start, links, table.patch, table.order, ring_start, ring, quads)

    in_threads(piece, n, GRAIN, pool)
    surface = (case, place, start, ring_start, ring, quads, flips)
    return Topology(corner, bits, cells, cells_before, edges, edges_before, blocks, origin, *surface)


def _starts(counts: NDArray[Any]) -> Numbers:
    starts = np.zeros(len(counts) + 1, np.int32)
    np.cumsum(counts, out=starts[1:])
    return starts


def separate(
    corner: NDArray[np.int64],
    case: NDArray[np.uint16],
    place: Numbers,
    blocks: Numbers,
    origin: NDArray[np.int64],
    cells: Words,
    cells_before: Numbers,
    table: PatchTable,
) -> int:
    """Re-pair every ambiguous face through which two patches would meet twice; tells how many there were.

    *Why one pass is enough.* The loops around the patches of a cell are the cycles of a permutation of its crossed
    edges, and re-pairing a face multiplies it by a transposition of two of them. Both lie on one cycle where the
    patch meets the face twice, so the cycle is split, in the cell on either side: the two segments now join different
    patches. Splitting brings no two segments together that were apart, so no other face gets a double meeting.

    *Why no order matters.* Faces are visited in six turns, by axis and by the parity of the lower cell. In one turn
    a cell is touched through one face only, so what is done there depends on the two cells of the face alone.
    The outcome for a cell therefore depends on the signs of cells at most two away in each direction, and on nothing
    else: on no order, no thread and no cut.
    """
    ambiguous = np.flatnonzero(table.ambiguous[case >> 6]).astype(np.int32)
    if not len(ambiguous):
        return 0
    where = (corner, case, place, blocks, origin, cells, cells_before)
    return int(_separate(ambiguous, *where, table.patch, face_edges()))


@loop
def _separate(
    ambiguous: Numbers,
    corner: NDArray[np.int64],
    case: NDArray[np.uint16],
    place: Numbers,
    blocks: Numbers,
    origin: NDArray[np.int64],
    cells: Words,
    cells_before: Numbers,
    patch: Bytes,
    edges_of: NDArray[np.int64],
) -> Any:
    flips = 0
    c = np.empty(3, np.int64)
    for turn in range(6):
        axis, face = turn >> 1, turn | 1
        for n in ambiguous:
            b, q = place[n] >> 9, place[n]
            c[0], c[1], c[2] = corner[0, b] + (q >> 6 & 7), corner[1, b] + (q >> 3 & 7), corner[2, b] + (q & 7)
            if c[axis] & 1 != turn & 1:
                continue
            c[axis] += 1
            o = find(c[0], c[1], c[2], blocks, origin, cells, cells_before)
            if o < 0:  # beyond the halo of a piece
                continue
            if meets_twice(patch[case[n]], edges_of[face]) and meets_twice(patch[case[o]], edges_of[face - 1]):
                case[n] ^= np.uint16(1 << face)
                case[o] ^= np.uint16(1 << (face - 1))
                flips += 1
    return flips


@step
def meets_twice(patch: Bytes, edges: NDArray[np.int64]) -> Any:
    """Whether one patch crosses all edges of a face; three tell, for an even number is crossed."""
    one = patch[edges[0]]
    return one != NO_PATCH and one == patch[edges[1]] and one == patch[edges[2]]


@loop
def link(
    first: int,
    last: int,
    corner: NDArray[np.int64],
    blocks: Numbers,
    origin: NDArray[np.int64],
    cells_before: Numbers,
    edges: Words,
    edges_before: Numbers,
    case: NDArray[np.uint16],
    place: Numbers,
    start: Numbers,
    links: Numbers,
    patch: Bytes,
    order: Bytes,
    ring_start: Numbers,
    ring: Numbers,
    quads: Numbers,
) -> None:
    """Give each vertex the crossings of its patch, and the quad of each crossing its vertices."""
    near = np.empty(8, np.int64)
    for b in range(first, last):
        for c in range(8):
            i, j, k = corner[0, b] + 8 * (c >> 2), corner[1, b] + 8 * (c >> 1 & 1), corner[2, b] + 8 * (c & 1)
            near[c] = block_at(i, j, k, blocks, origin)
        for n in range(cells_before[b, 0], cells_before[b + 1, 0]):
            i, j, k, row, previous = place[n] >> 6 & 7, place[n] >> 3 & 7, place[n] & 7, case[n], -1
            for at in range(links[n], links[n + 1]):
                edge = order[row, at - links[n]]
                axis, u, v = edge >> 2, edge >> 1 & 1, edge & 1
                i1, j1, k1 = i + (0, v, u)[axis], j + (u, 0, v)[axis], k + (v, u, 0)[axis]
                other = near[4 * (i1 >> 3) + 2 * (j1 >> 3) + (k1 >> 3)]
                crossing = rank(other, i1 & 7, j1 & 7, k1 & 7, edges[axis], edges_before[axis])
                vertex = start[n] + patch[row, edge]
                if vertex != previous:
                    ring_start[vertex] = at
                    previous = vertex
                ring[at] = crossing
                if crossing >= 0:
                    inside = row >> 6 + 4 * (i1 - i) + 2 * (j1 - j) + (k1 - k) & 1  # the lower end of the edge
                    turn = (2, 1, 3, 0)[2 * u + v]
                    quads[crossing, turn if inside else 3 - turn] = vertex
