"""Surface patches of a cell, for every mask of its eight corners.

Corner c of a cell is 4*di + 2*dj + dk, and bit c of its mask says that the corner is inside. Edge 4*a + 2*u + v lies
along axis a, at offsets u and v along the axes a + 1 and a + 2 (modulo 3). Face 2*a + s has normal axis a on side s.
A face is ambiguous where its corners alternate: two segments of the surface cross it, and either its inside corners
are apart or they are joined. All are apart, but for the one face through which a patch may meet a neighbour twice
(see `separate`). The *case* of a cell is 2*mask, and one more where that face is joined.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

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
def face_edges() -> NDArray[np.int64]:
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


def _patches(masks: NDArray[np.int64], joined: NDArray[np.int64]) -> NDArray[np.int64]:
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


def _follow(masks: NDArray[np.int64], joined: NDArray[np.int64]) -> NDArray[np.int64]:
    """Edge after each edge on the loop around its patch, -1 where it is not crossed."""
    edges, rule, follow = face_edges(), _rule(), np.full((len(masks), 12), -1)
    for face in range(6):
        pattern = ((masks[:, None] >> FACE_CORNERS[face] & 1) << np.arange(4)).sum(axis=1)
        after = rule[pattern, (joined == face).astype(int)]
        row, side = np.nonzero(after >= 0)
        follow[row, edges[face, side]] = edges[face, after[row, side]]
    return follow


def _rule() -> NDArray[np.int64]:
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
