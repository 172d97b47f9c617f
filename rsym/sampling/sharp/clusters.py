"""Clusters: connected components of what is joined in pairs, of neighbouring cells above all."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from rsym.arrays import Ints


def clusters(cells: Ints) -> Ints:
    """The number of the cluster of each cell (3, n), in the order of their first cells."""
    count = cells.shape[1]
    shape = tuple(cells.max(axis=1) + 3)
    key = np.ravel_multi_index(tuple(cells + 1), shape)
    order = np.argsort(key)
    pairs = []
    for offset in np.ndindex(3, 3, 3):
        if offset > (1, 1, 1):
            near = np.ravel_multi_index(tuple(cells + np.array(offset)[:, None]), shape)
            at = np.minimum(np.searchsorted(key, near, sorter=order), count - 1)
            here = np.flatnonzero(key[order[at]] == near)
            pairs.append(np.stack([here, order[at[here]]]))
    one, other = np.concatenate(pairs, axis=1)
    return components(one, other, count)


def components(one: NDArray[np.integer[Any]], other: NDArray[np.integer[Any]], count: int) -> Ints:
    """The number of the connected component of each of so many things, of which some pairs are joined.

    Examples
    --------
    >>> components(np.array([0, 3]), np.array([2, 2]), 5).tolist()
    [0, 1, 0, 0, 2]
    """
    label = np.arange(count)
    while True:
        # The lowest number on either side of a pair, then that of whoever bears it: a chain shortens by halves.
        lowest = np.minimum(label[one], label[other])
        lower = label.copy()
        np.minimum.at(lower, one, lowest)
        np.minimum.at(lower, other, lowest)
        lower = lower[lower]
        if (lower == label).all():
            return np.asarray(np.unique(label, return_inverse=True)[1], np.int64)
        label = lower
