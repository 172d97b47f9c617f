"""Names of vertices and crossings that all pieces of a lattice share, so that pieces weld to the uncut surface.

A piece is the blocks of a box and a halo of one block around them. What its own blocks hold comes out as in the uncut
surface, and so do the cells of the halo that its own crossings touch; only the numbers differ. Names do not: they are
integers that ascend along the uncut surface, so a number there is the rank of a name among all names,
``np.searchsorted(names, names_of_a_piece)``.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from rsym.sampling.sharp.patches import Topology
from rsym.sampling.sharp.signs import Numbers, list_places

CELLS = 512  # of a block
PATCHES = 4  # of a cell, at most


def vertex_places(surface: Topology) -> Numbers:
    """Place, 512*block + 64*i + 8*j + k, of the cell of each vertex."""
    return np.repeat(surface.place, np.diff(surface.start))


def crossing_places(surface: Topology) -> Numbers:
    """Place, 512*block + 64*i + 8*j + k, of the lower end of each crossing."""
    place = np.empty(surface.crossings, np.int32)
    for axis in range(3):
        list_places(surface.edges[axis], surface.edges_before[axis], place)
    return place


def vertex_names(surface: Topology, extent: tuple[int, int, int]) -> NDArray[np.int64]:
    """(Block, cell, patch) of each vertex as one integer, on a lattice of extent blocks."""
    patch = np.arange(surface.vertices) - np.repeat(surface.start[:-1], np.diff(surface.start))
    return np.asarray(_names(surface, extent, vertex_places(surface)) * PATCHES + patch)


def crossing_names(surface: Topology, extent: tuple[int, int, int]) -> NDArray[np.int64]:
    """(Axis, block, lattice edge) of each crossing as one integer, on a lattice of extent blocks."""
    axis = np.repeat(np.arange(3), np.diff(surface.axes))
    return axis * (CELLS * extent[0] * extent[1] * extent[2]) + _names(surface, extent, crossing_places(surface))


def _names(surface: Topology, extent: tuple[int, int, int], place: Numbers) -> NDArray[np.int64]:
    i, j, k = surface.corner >> 3
    block = (i * extent[1] + j) * extent[2] + k
    return np.asarray(block[place >> 9] * CELLS + (place & CELLS - 1), np.int64)
