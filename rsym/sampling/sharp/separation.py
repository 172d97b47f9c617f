"""Ambiguous faces paired so that no two patches meet twice: then the surface is a manifold."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from rsym.sampling.sharp.loops import loop
from rsym.sampling.sharp.signs import Bytes, Numbers, Words, find
from rsym.sampling.sharp.tables import patch_table

JOINED = np.uint16(1)


def separate(
    corner: NDArray[np.int64],
    case: NDArray[np.uint16],
    place: Numbers,
    blocks: Numbers,
    origin: NDArray[np.int64],
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
    return int(_separate(corner, case, place, blocks, origin, cells, before, patch_table().twice))


@loop
def _separate(
    corner: NDArray[np.int64],
    case: NDArray[np.uint16],
    place: Numbers,
    blocks: Numbers,
    origin: NDArray[np.int64],
    cells: Words,
    before: Numbers,
    twice: Bytes,
) -> Any:
    flips = 0
    c = np.empty(3, np.int64)
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
