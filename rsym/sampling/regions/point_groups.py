"""Points in groups that one tape runs on: near each other, or on one leaf."""

from __future__ import annotations

import numpy as np

from rsym.arrays import Floats, Ints, Shorts
from rsym.sampling.kernels.routines import LANES

# Places along an axis of the box of points, by which they are sorted before they are taken together.
PLACES = 16


def near_each_other(points: Floats) -> Ints:
    """An order of points in which neighbours are near: by places of their box, halves of halves."""
    low, high = points.min(axis=1, keepdims=True), points.max(axis=1, keepdims=True)
    with np.errstate(all="ignore"):
        share = np.nan_to_num((points - low) / (high - low))
    place = np.minimum(share * PLACES, PLACES - 1).astype(np.int64)
    key = np.zeros(points.shape[1], np.int64)
    for bit in range(PLACES.bit_length() - 1):
        for axis in range(3):
            key |= (place[axis] >> bit & 1) << (3 * bit + axis)
    return np.argsort(key, kind="stable")


def boxes_of(points: Floats) -> Floats:
    """The ends (6, groups) of the boxes of groups of points (3, groups, n); a point that is NaN is anywhere."""
    ends = np.empty((6, points.shape[1]))
    ends[::2], ends[1::2] = points.min(axis=2), points.max(axis=2)
    lost = np.isnan(ends)
    ends[::2][lost[::2]], ends[1::2][lost[1::2]] = -np.inf, np.inf
    return ends


def by_leaf(leaf: Shorts) -> tuple[Ints, Ints, Ints, Ints]:
    """The leaves that occur; where the points of each begin, in whole vectors; which these are, and which count."""
    order = np.argsort(leaf, kind="stable")
    order = order[np.searchsorted(leaf[order], 0) :]
    which, first = np.unique(leaf[order], return_index=True)
    count = np.diff([*first, len(order)])
    room = -(-count // LANES) * LANES
    begin = np.concatenate([[0], np.cumsum(room)])
    source = np.arange(begin[-1]) - np.repeat(begin[:-1] - first, room)
    last = np.repeat(first + count - 1, room)
    padded_places = order[np.minimum(source, last)]
    return which.astype(np.int64), begin, padded_places, np.flatnonzero(source <= last)
