"""Points in groups that one tape runs on: of one region, or on one leaf."""

from __future__ import annotations

import numpy as np

from rsym.arrays import Ints, Shorts
from rsym.sampling.kernels.routines import LANES


def by_number(numbers: Shorts | Ints) -> tuple[Ints, Ints, Ints, Ints]:
    """The numbers from 0 on that occur; where points of each begin, in whole vectors; which these are, which count."""
    order = np.argsort(numbers, kind="stable")
    order = order[np.searchsorted(numbers[order], 0) :]
    which, first = np.unique(numbers[order], return_index=True)
    count = np.diff([*first, len(order)])
    room = -(-count // LANES) * LANES
    begin = np.concatenate([[0], np.cumsum(room)])
    source = np.arange(begin[-1]) - np.repeat(begin[:-1] - first, room)
    last = np.repeat(first + count - 1, room)
    padded_places = order[np.minimum(source, last)]
    return which.astype(np.int64), begin, padded_places, np.flatnonzero(source <= last)
