"""Everything of a mesh that depends on signs alone: its vertices, the crossings around each, the quads.

Ambiguous faces are paired so that no two patches meet twice: then the surface is a manifold.

Corner c of a cell is 4*di + 2*dj + dk, and bit c of its mask says that the corner is inside. Edge 4*a + 2*u + v lies
along axis a, at offsets u and v along the axes a + 1 and a + 2 (modulo 3). Face 2*a + s has normal axis a on side s.
A face is ambiguous where its corners alternate: two segments of the surface cross it, and either its inside corners
are apart or they are joined. All are apart, but for the one face through which a patch may meet a neighbour twice
(see `separate`). The *case* of a cell is 2*mask, and one more where that face is joined.
"""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Executor
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rsym.arrays import Ints
from rsym.sampling.sharp.loops import in_threads, loop, popcount
from rsym.sampling.sharp.signs import (
    ABSENT,
    ONE,
    Bytes,
    Numbers,
    Words,
    block_at,
    fields_in,
    find,
    list_cells,
    lookup,
    ranks,
    scan,
)

# Fewer blocks take less time than a thread needs to take them up.
GRAIN = 32

JOINED = np.uint16(1)

# Cells beside a box: quads in it have vertices in one layer below it, whose faces may be joined for the sake of the
# next, as those in its last layer for that of the one above. Crossings around them are in one layer more.
BELOW, ABOVE = 2, 1


@dataclass(frozen=True)
class Topology:
    """The combinatorial surface of sign bits: a closed 2-manifold.

    Blocks: ``corner`` (3, n) their first cells; ``bits`` (n, stride) their signs; ``cells`` (n + 1, 8) and ``edges``
    (3, n + 1, 8) the fields of cells and crossings, ``cells_before`` and ``edges_before`` the ranks of their words;
    ``blocks``, ``origin`` the lookup of a block.

    Cells that hold surface, in the order of (block, cell): ``case`` (m,) their row of the patch table, 2*mask or one
    more, ``place`` (m,) 512*block + 64*i + 8*j + k, ``start`` (m + 1,) the number of their first vertex.

    Vertices, one for each patch of a cell: ``ring[ring_start[v]:ring_start[v + 1]]`` are the crossings of its patch.

    Crossings, axis by axis, in the order of (block, lattice edge): ``quads`` (crossings, 4) the vertices around each,
    counter-clockwise as seen from outside, -1 where a block beside the crossing is not here. ``flips`` counts the
    faces whose corners were joined.
    """

    corner: Ints
    bits: Bytes
    cells: Words
    cells_before: Numbers
    edges: Words
    edges_before: Numbers
    blocks: Numbers
    origin: Ints
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


def topology(
    corner: Ints,
    bits: Bytes,
    pool: Executor | None = None,
    claim: Callable[[int, int], None] = lambda cells, crossings: None,
    box: Ints | None = None,
) -> Topology:
    """Find the surface of the sign bits of blocks in lexicographic order; manifold by construction.

    `claim` is told how many cells and crossings there are before anything is allocated for them, and may raise. Of what
    is beside a `box` (2, 3) of cells only what the quads in it need is found.

    Two patches of neighbouring cells are joined by each segment that they share on the face between the cells. Where
    they share both segments of an ambiguous face, four triangles would meet on one edge; `separate` re-pairs such
    faces. Nothing else can go wrong: two cells share one face or one lattice edge, so no other edge or diagonal of
    the quads comes twice, and the quads around a vertex follow the loop around its patch.

    Examples
    --------
    One lattice point inside: a cube of eight cells, a vertex each, and the six edges around the point crossed.

    >>> bits = np.zeros((1, 96), np.uint8)
    >>> bits[0, (4 * 81 + 4 * 9 + 4) // 8] = 1 << (4 * 81 + 4 * 9 + 4) % 8
    >>> surface = topology(np.zeros((3, 1), np.int64), bits)
    >>> surface.vertices, surface.crossings
    (8, 6)
    """
    corner, bits = np.ascontiguousarray(corner, np.int64), np.ascontiguousarray(bits)
    n, table, (blocks, origin) = corner.shape[1], patch_table(), lookup(corner)
    cells, edges = scanned(bits, pool)
    if box is not None:
        cells[:-1] &= fields_in(corner, box[0] - BELOW, box[1] + ABOVE)
        edges[:, :-1] &= fields_in(corner, box[0] - BELOW, box[1] + ABOVE + 1)
    (cells_before, active), (edges_before, crossings) = ranks(cells), ranks(edges)
    claim(active, crossings)
    case, place = np.empty(active, np.uint16), np.empty(active, np.int32)
    in_threads(lambda first, last: list_cells(bits, cells, cells_before, first, last, case, place), n, GRAIN, pool)
    flips = separate(corner, case, place, blocks, origin, cells, cells_before)
    start, links = np.empty(active + 1, np.int32), np.empty(active + 1, np.int32)
    vertices, links_in_all = tally(case, table.patches, table.edges, start, links)
    ring_start, ring = np.empty(vertices + 1, np.int32), np.empty(links_in_all, np.int32)
    ring_start[-1] = links_in_all
    quads = np.empty((crossings, 4), np.int32)
    quads.fill(ABSENT)

    fields, lists = (cells_before, edges.ravel(), edges_before.ravel()), (place, start, links)
    tables, out = (table.patch, table.order, EDGE_SHIFT), (ring_start, ring, quads)

    def piece(first: int, last: int) -> None:
        link(first, last, corner, blocks, origin, *fields, case, *lists, *tables, *out, np.empty(8, np.int64))

    in_threads(piece, n, GRAIN, pool)
    surface = (case, place, start, ring_start, ring, quads, flips)
    return Topology(corner, bits, cells, cells_before, edges, edges_before, blocks, origin, *surface)


def scanned(bits: Bytes, pool: Executor | None = None) -> tuple[Words, Words]:
    """Fields of the cells that hold surface, and of the crossings."""
    n = len(bits)
    cells, edges = np.empty((n + 1, 8), np.uint64), np.empty((3, n + 1, 8), np.uint64)
    cells[n], edges[:, n] = 0, 0
    in_threads(lambda a, b: scan(bits, a, b, cells, edges, np.empty(81, np.uint64)), n, GRAIN, pool)
    return cells, edges


@loop
def tally(case: NDArray[np.uint16], patches: Bytes, edges: Bytes, start: Numbers, links: Numbers) -> Any:
    """Count the patches and the crossed edges before each cell, and in all."""
    vertices, crossed = 0, 0
    for n in range(len(case)):
        start[n], links[n] = vertices, crossed
        vertices += patches[case[n]]
        crossed += edges[case[n]]
    start[len(case)], links[len(case)] = vertices, crossed
    return vertices, crossed


@loop
def link(
    first: int,
    last: int,
    corner: Ints,
    blocks: Numbers,
    origin: Ints,
    cells_before: Numbers,
    words: Words,
    before: Numbers,
    case: NDArray[np.uint16],
    place: Numbers,
    start: Numbers,
    links: Numbers,
    patch: Bytes,
    order: Bytes,
    shift: NDArray[Any],
    ring_start: Numbers,
    ring: Numbers,
    quads: Numbers,
    near: Ints,
) -> None:
    """Give each vertex the crossings of its patch, and the quad of each crossing its vertices.

    `words` and `before` are the fields of the crossings and their ranks, flat; `near` (8,) is scratch.
    """
    words_of_axis = len(words) // 3
    for b in range(first, last):
        for c in range(8):
            i, j, k = corner[0, b] + 8 * (c >> 2), corner[1, b] + 8 * (c >> 1 & 1), corner[2, b] + 8 * (c & 1)
            near[c] = 8 * block_at(i, j, k, blocks, origin)
        for n in range(cells_before[b, 0], cells_before[b + 1, 0]):
            row, previous = case[n], -1
            # i, j, k in four bits each: an edge that belongs to the next block carries into the fourth.
            cell = (place[n] & 448) << 2 | (place[n] & 56) << 1 | place[n] & 7
            for at in range(links[n], links[n + 1]):
                edge = order[row, at - links[n]]
                end = cell + shift[edge]
                word = np.uint64(
                    (edge >> 2) * words_of_axis + near[end >> 9 & 4 | end >> 6 & 2 | end >> 3 & 1] + (end >> 8 & 7)
                )
                here = ONE << np.uint64(end >> 1 & 56 | end & 7)
                vertex = start[n] + patch[row, edge]
                if vertex != previous:
                    ring_start[vertex], previous = at, vertex
                if words[word] & here == 0:
                    ring[at] = ABSENT
                    continue
                crossing = np.uint64(before[word] + np.int64(popcount(words[word] & (here - ONE))))
                ring[at] = crossing
                lower_end = (shift[edge] >> 6 | shift[edge] >> 3 | shift[edge]) & 7
                turn = (2, 1, 3, 0)[edge & 3]
                quads[crossing, turn if row >> 1 + lower_end & 1 else 3 - turn] = vertex


def separate(
    corner: Ints,
    case: NDArray[np.uint16],
    place: Numbers,
    blocks: Numbers,
    origin: Ints,
    cells: Words,
    before: Numbers,
) -> int:
    """Re-pair, in `case`, every ambiguous face through which two patches meet twice; tells how many there were.

    While the inside corners of all faces are apart, the patches of a cell meet at most one of its faces twice (36 of
    the 256 masks have one; `PatchTable.twice`). A face is re-paired where it is the one of the cells on either side.

    *Why this is enough.* The loops around the patches of a cell are the cycles of a permutation of its crossed edges,
    and re-pairing a face multiplies it by a transposition of two of them. Both lie on one cycle where a patch meets
    the face twice, so the cycle is split, in the cell on either side: the two segments now join different patches.
    Splitting brings no two segments together that were apart, so no other face gets a double meeting.

    *Why nothing else matters.* A cell is touched through one face at most, and what is done there depends on the
    signs of the two cells beside it: on no order, no thread and no cut.
    """
    twice, cell = patch_table().twice, np.empty(3, np.int64)
    return int(_separate(corner, case, place, blocks, origin, cells, before, twice, cell))


@loop
def _separate(
    corner: Ints,
    case: NDArray[np.uint16],
    place: Numbers,
    blocks: Numbers,
    origin: Ints,
    cells: Words,
    before: Numbers,
    twice: Bytes,
    c: Ints,
) -> Any:
    flips = 0
    for n in range(len(case)):
        face = twice[case[n] >> 1]
        if face & 1 == 0:  # the cell below a face decides
            continue
        b, q = place[n] >> 9, place[n]
        c[0], c[1], c[2] = corner[0, b] + (q >> 6 & 7), corner[1, b] + (q >> 3 & 7), corner[2, b] + (q & 7)
        c[face >> 1] += 1
        other = find(c[0], c[1], c[2], blocks, origin, cells, before)
        if other >= 0 and twice[case[other] >> 1] == face - 1:  # beyond the rim of a piece there is none
            case[n] |= JOINED
            case[other] |= JOINED
            flips += 1
    return flips


NO_PATCH = 255
NO_FACE = 6


def _offset(axis: int, along: int, u: int, v: int) -> int:
    """Corner at these offsets along an axis and the two after it."""
    weights = (4, 2, 1)
    return along * weights[axis] + u * weights[(axis + 1) % 3] + v * weights[(axis + 2) % 3]


EDGE_ENDS = np.array([[_offset(e >> 2, s, e >> 1 & 1, e & 1) for s in (0, 1)] for e in range(12)])
# Offsets of the lower end of an edge, i << 8 | j << 4 | k: room for a carry beside each.
EDGE_SHIFT = (EDGE_ENDS[:, 0] >> 2) << 8 | (EDGE_ENDS[:, 0] >> 1 & 1) << 4 | EDGE_ENDS[:, 0] & 1
# Corners of a face counter-clockwise as seen from outside the cell, so that what follows an edge lies on one loop.
FACE_CORNERS = np.array(
    [
        [_offset(f >> 1, f & 1, *((u, v) if f & 1 == 0 else (v, u))) for u, v in ((0, 0), (0, 1), (1, 1), (1, 0))]
        for f in range(6)
    ]
)


@cache
def face_edges() -> Ints:
    """Edges of each face: number q joins its corners q and q + 1."""
    number = {frozenset(ends): edge for edge, ends in enumerate(EDGE_ENDS.tolist())}
    return np.array([[number[frozenset((c[q], c[(q + 1) % 4]))] for q in range(4)] for c in FACE_CORNERS.tolist()])


@dataclass(frozen=True)
class PatchTable:
    """Patches of all cases.

    ``patch``: (512, 12), number of the patch an edge belongs to, 255 where the edge is not crossed or there is no such
    case. ``order``: (512, 12), the edges patch by patch, those not crossed last. ``patches``, ``edges``: (512,), how
    many of either a case has. ``twice``: (256,), the face of a mask that one patch meets twice while the inside
    corners of all faces are apart, `NO_FACE` where there is none; there is never more than one.
    """

    patch: NDArray[np.uint8]
    order: NDArray[np.uint8]
    patches: NDArray[np.uint8]
    edges: NDArray[np.uint8]
    twice: NDArray[np.uint8]


@cache
def patch_table() -> PatchTable:
    """Follow the loops around the patches of every case.

    Examples
    --------
    >>> table = patch_table()
    >>> table.patch[2 * 0b00000001].tolist(), int(table.patches[2 * 0b10000001])
    ([0, 255, 255, 255, 0, 255, 255, 255, 0, 255, 255, 255], 2)
    """
    apart = _patches(np.arange(256), np.full(256, NO_FACE))
    around = apart[:, face_edges()]
    double = (around != NO_PATCH).all(axis=2) & (around == around[:, :, :1]).all(axis=2)
    twice = np.where(double.any(axis=1), double.argmax(axis=1), NO_FACE)
    some = np.flatnonzero(twice < NO_FACE)
    patch = np.full((512, 12), NO_PATCH, np.uint8)
    patch[::2], patch[2 * some + 1] = apart, _patches(some, twice[some])
    crossed = patch != NO_PATCH
    patches, edges = np.where(crossed, patch + 1, 0).max(axis=1), crossed.sum(axis=1)
    order = np.argsort(patch, axis=1, kind="stable")
    return PatchTable(patch, *(array.astype(np.uint8) for array in (order, patches, edges, twice)))


def _patches(masks: Ints, joined: Ints) -> Ints:
    """Patch of each edge of cells of these masks; the inside corners of face `joined` are joined.

    The segments on the six faces send every edge on which the boundary of a patch leaves the inside of a face to the
    edge on which it comes back: a permutation of the crossed edges, whose cycles are the patches.
    """
    follow = _follow(masks, joined)
    crossed = follow >= 0
    follow = np.where(crossed, follow, np.arange(12))
    first = np.tile(np.arange(12), (len(masks), 1))
    for _ in range(4):  # each turn doubles the stretch of the loop that an edge has seen: 16 in the end, of at most 12
        first = np.minimum(first, np.take_along_axis(first, follow, axis=1))
        follow = np.take_along_axis(follow, follow, axis=1)
    begins = crossed & (first == np.arange(12))
    number = np.take_along_axis(begins.cumsum(axis=1) - 1, first, axis=1)
    return np.where(crossed, number, NO_PATCH)


def _follow(masks: Ints, joined: Ints) -> Ints:
    """Edge after each edge on the loop around its patch, -1 where it is not crossed."""
    edges, rule, follow = face_edges(), _rule(), np.full((len(masks), 12), -1)
    for face in range(6):
        pattern = ((masks[:, None] >> FACE_CORNERS[face] & 1) << np.arange(4)).sum(axis=1)
        after = rule[pattern, (joined == face).astype(int)]
        row, side = np.nonzero(after >= 0)
        follow[row, edges[face, side]] = edges[face, after[row, side]]
    return follow


def _rule() -> Ints:
    """[corners inside, joined, side] of one face: the side on which the segment that begins on this side ends.

    A side along which the inside ends is followed by the one before it along which the inside begins, or, where the
    inside corners are joined, by the one after it.
    """
    rule = np.full((16, 2, 4), -1)
    for corners in range(16):
        change = [(corners >> (q + 1) % 4 & 1) - (corners >> q & 1) for q in range(4)]
        for joined, step in enumerate((3, 1)):
            for q in range(4):
                if change[q] == -1:
                    after = ((q + step * turns) % 4 for turns in range(1, 4))
                    rule[corners, joined, q] = next(side for side in after if change[side] == 1)
    return rule
