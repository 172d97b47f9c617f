"""Clusters: cells that are neighbours by faces, edges or corners."""

from __future__ import annotations

import numpy as np
from scipy import sparse

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
    graph = sparse.coo_array((np.ones(len(one), np.bool_), (one, other)), shape=(count, count))
    _, label = sparse.csgraph.connected_components(graph, directed=False)
    _, first, label = np.unique(label, return_index=True, return_inverse=True)
    rank = np.empty_like(first)
    rank[np.argsort(first)] = np.arange(len(first))
    return np.asarray(rank[label], np.int64)
