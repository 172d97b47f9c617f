"""Points in groups that one tape runs on: of one region, or on one leaf."""

from __future__ import annotations

import numpy as np

from rsym.arrays import Ints, Shorts
from rsym.sampling.kernels.routines import LANES


def by_number(numbers: Shorts | Ints) -> tuple[Ints, Ints, Ints, Ints]:
    """The numbers from 0 on that occur; where points of each begin, in whole vectors; which these are, which count."""
    # Of 16 bits they are sorted by counting, in a tenth of the time.
    few = numbers.astype(np.int16) if len(numbers) and numbers.max() < 2**15 else numbers
    order = np.argsort(few, kind="stable")
    ordered = few[order]
    nothing = np.searchsorted(ordered, 0)
    order, ordered = order[nothing:], ordered[nothing:]
    new = np.ones(len(order), np.bool_)
    np.not_equal(ordered[1:], ordered[:-1], out=new[1:])
    first = np.flatnonzero(new)
    which, count = ordered[first], np.diff(first, append=len(order))
    room = -(-count // LANES) * LANES
    begin = np.concatenate([[0], np.cumsum(room)])
    source = np.arange(begin[-1]) - np.repeat(begin[:-1] - first, room)
    last = np.repeat(first + count - 1, room)
    padded_places = order[np.minimum(source, last)]
    return which.astype(np.int64), begin, padded_places, np.flatnonzero(source <= last)
