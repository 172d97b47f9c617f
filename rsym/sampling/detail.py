"""Detail that a lattice is too coarse for: walls and gaps thinner than a cell, pieces of a few cells."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from rsym.arrays import Floats, Ints
from rsym.sampling.lattice import Lattice
from rsym.sampling.manifolds import point

# The cosine below which two normals face away from each other: at a wedge of more than 25 degrees they do not,
# for it is thinner than any cell near its edge, and no resolution changes that.
OPPOSED = -0.9
# Of a ball three cells wide marching cubes finds some 80 triangles and 7 % too little volume.
SMALLEST_PIECE = 3.0


@dataclass(frozen=True)
class Detail:
    """Places too fine for the lattice: how many, where the finest is, and how many cells it measures."""

    places: int
    finest: tuple[float, float, float]
    cells: float


def thin_walls(index: Floats, vertices: Floats, normals: Floats, lattice: Lattice) -> Detail | None:
    """Walls and gaps thinner than a cell: crossings on either side of one sample whose normals oppose each other.

    Parameters
    ----------
    index : (n, 3) array
        Where marching cubes put the vertices, in cells: each on an edge of the lattice.
    vertices, normals : (n, 3) arrays
        Their true places, and the unit normals there; NaN where there is none.
    """
    lower = np.floor(index).astype(np.int64)
    axis = (index - lower).argmax(axis=1)
    one, other = np.concatenate([_pairs(lower, axis, k, lattice.counts) for k in range(3)]).T
    opposed = np.einsum("ij,ij->i", normals[one], normals[other]) < OPPOSED
    one, other = one[opposed], other[opposed]
    across = (normals[other] - normals[one]) / 2
    thickness = np.abs(np.einsum("ij,ij->i", across, vertices[other] - vertices[one]))
    cells = thickness / np.linalg.norm(across * lattice.spacing, axis=1)
    if not (cells < 1).any():
        return None
    finest = int(cells.argmin())
    place = (vertices[one[finest]] + vertices[other[finest]]) / 2
    return Detail(int((cells < 1).sum()), point(place), float(cells[finest]))


def _pairs(lower: Ints, axis: Ints, k: int, counts: Sequence[int]) -> Ints:
    """Vertices (m, 2) on neighbouring edges of one lattice line along axis k."""
    which = np.flatnonzero(axis == k)
    order = [*(j for j in range(3) if j != k), k]
    # The last sample of a line starts no edge, so numbers of different lines differ by more than one.
    numbers = np.ravel_multi_index(tuple(lower[which][:, order].T), tuple(counts[j] for j in order))
    along = np.argsort(numbers)
    first = np.flatnonzero(np.diff(numbers[along]) == 1)
    return which[np.stack([along[first], along[first + 1]], axis=1)]


def small_pieces(vertices: Floats, piece: Ints, spacing: Sequence[float]) -> Detail | None:
    """Pieces less than three cells long in every direction; `piece` numbers the piece of each vertex."""
    order = np.argsort(piece, kind="stable")
    starts = np.flatnonzero(np.diff(piece[order], prepend=-1))
    low, high = (extreme.reduceat(vertices[order], starts) for extreme in (np.minimum, np.maximum))
    cells = ((high - low) / np.asarray(spacing)).max(axis=1)
    small = cells < SMALLEST_PIECE
    if not small.any():
        return None
    finest = int(cells.argmin())
    return Detail(int(small.sum()), point((low + high)[finest] / 2), float(cells[finest]))
