"""Ambiguous faces paired so that no two patches meet twice: then the surface is a manifold."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from rsym.sampling.sharp.loops import loop, step
from rsym.sampling.sharp.signs import Bytes, Numbers, Words, find
from rsym.sampling.sharp.tables import NO_PATCH, face_edges, patch_table


def separate(
    corner: NDArray[np.int64],
    case: NDArray[np.uint16],
    place: Numbers,
    blocks: Numbers,
    origin: NDArray[np.int64],
    cells: Words,
    before: Numbers,
) -> int:
    """Re-pair, in `case`, every ambiguous face through which two patches would meet twice; tells how many there were.

    *Why one pass is enough.* The loops around the patches of a cell are the cycles of a permutation of its crossed
    edges, and re-pairing a face multiplies it by a transposition of two of them. Both lie on one cycle where the
    patch meets the face twice, so the cycle is split, in the cell on either side: the two segments now join different
    patches. Splitting brings no two segments together that were apart, so no other face gets a double meeting.

    *Why no order matters.* Faces are visited in six turns, by axis and by the parity of the lower cell. In one turn
    a cell is touched through one face only, so what is done there depends on the two cells of the face alone.
    The outcome for a cell therefore depends on the signs of cells at most two away in each direction, and on nothing
    else: on no order, no thread and no cut.
    """
    table = patch_table()
    return int(
        _separate(corner, case, place, blocks, origin, cells, before, table.patch, table.ambiguous, face_edges())
    )


@loop
def _separate(
    corner: NDArray[np.int64],
    case: NDArray[np.uint16],
    place: Numbers,
    blocks: Numbers,
    origin: NDArray[np.int64],
    cells: Words,
    before: Numbers,
    patch: Bytes,
    ambiguous: Bytes,
    edges_of: NDArray[np.int64],
) -> Any:
    flips, some = 0, [n for n in range(len(case)) if ambiguous[case[n] >> 6]]
    c = np.empty(3, np.int64)
    for turn in range(6):
        axis, face = turn >> 1, turn | 1
        for n in some:
            b, q = place[n] >> 9, place[n]
            c[0], c[1], c[2] = corner[0, b] + (q >> 6 & 7), corner[1, b] + (q >> 3 & 7), corner[2, b] + (q & 7)
            if c[axis] & 1 != turn & 1:
                continue
            c[axis] += 1
            other = find(c[0], c[1], c[2], blocks, origin, cells, before)
            if other < 0:  # no surface beyond the face, or the rim of a piece
                continue
            if meets_twice(patch[case[n]], edges_of[face]) and meets_twice(patch[case[other]], edges_of[face - 1]):
                case[n] ^= np.uint16(1 << face)
                case[other] ^= np.uint16(1 << face - 1)
                flips += 1
    return flips


@step
def meets_twice(patch: Bytes, edges: NDArray[np.int64]) -> Any:
    """Whether one patch crosses all edges of a face; three tell, for an even number is crossed."""
    one = patch[edges[0]]
    return one != NO_PATCH and one == patch[edges[1]] and one == patch[edges[2]]
