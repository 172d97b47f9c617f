"""Clusters: cells that are neighbours by faces, edges or corners."""

from __future__ import annotations

import numpy as np

from rsym.sampling.sharp.boxes import Ints


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
