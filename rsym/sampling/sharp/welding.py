"""Names of vertices and crossings that all pieces of a lattice share, so that pieces weld to the uncut surface.

A piece is the blocks of a box and a halo of one block around them. What its own blocks hold comes out as in the uncut
surface, and so do the cells of the halo that its own crossings touch; only the numbers differ. Names do not: they are
integers that ascend along the uncut surface, so a number there is the rank of a name among all names,
``np.searchsorted(names, names_of_a_piece)``.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rsym.sampling.kernels.mesher_kernels import padded
from rsym.sampling.sharp.assembly import Assembly, Unfinished
from rsym.sampling.sharp.signs import Numbers, list_places
from rsym.sampling.sharp.topology import Topology

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


@dataclass(frozen=True)
class Piece:
    """The part of a surface that belongs to the blocks of a box.

    Blocks: ``corner`` (3, n), in lexicographic order; ``vertices`` (n,) and ``crossings`` (3, n) tell how many each
    has. Arrays of the surface are in the order of the whole surface. Faces count the piece's own vertices and, after
    them, the `strangers`: names of vertices of other pieces. ``rim`` are the names of those own vertices that others
    may touch, ``rim_number`` which ones they are.
    """

    corner: NDArray[np.int64]
    vertices: Numbers
    crossings: Numbers
    surface: Unfinished
    strangers: NDArray[np.int64]
    rim: NDArray[np.int64]
    rim_number: Numbers

    @property
    def size(self) -> int:
        """Bytes of its surface."""
        return self.surface.points.nbytes + self.surface.faces.nbytes + self.surface.leaf.nbytes


def own_piece(
    made: Assembly, box: NDArray[np.int64], extent: tuple[int, int, int], notes: tuple[Any, ...] = ()
) -> Piece:
    """What belongs to a box, from the surface of its blocks and their neighbours.

    `box` (2, 3): its first cells, and those past its last.
    """
    surface = made.surface
    own = inside(surface.corner, box)
    place = vertex_places(surface)
    mine, block = own[place >> 9], crossing_places(surface) >> 9
    crossed, axis = own[block], np.repeat(np.arange(3), np.diff(surface.axes))
    names = vertex_names(surface, extent)

    # Others touch the cells on the upper sides of the box: the crossings of a cell's lower ends are around it.
    cell = surface.corner[:, place >> 9] + np.stack([place >> 6 & 7, place >> 3 & 7, place & 7])
    rim = np.flatnonzero(mine & (cell == box[1, :, None] - 1).any(axis=0))
    count = int(mine.sum())
    number = np.cumsum(mine, dtype=np.int32) - 1
    faces = made.faces.reshape(-1, 6)[crossed].reshape(-1, 3)
    strange = np.unique(faces[~mine[faces]])
    number[strange] = count + np.arange(len(strange))

    n = surface.corner.shape[1]
    per_axis = np.bincount((axis * n + block)[crossed], minlength=3 * n).reshape(3, n)[:, own]
    points = np.ascontiguousarray(made.points[:, : len(mine)][:, mine])
    return Piece(
        np.ascontiguousarray(surface.corner[:, own]),
        np.bincount(place[mine] >> 9, minlength=n)[own].astype(np.int32),
        per_axis.astype(np.int32),
        Unfinished(points, count, number[faces], made.leaf[crossed], made.flaws[crossed], notes),
        names[strange],
        names[rim],
        number[rim],
    )


def inside(corner: NDArray[np.int64], box: NDArray[np.int64]) -> NDArray[np.bool_]:
    """Which cells are in a box (2, 3)."""
    return np.asarray(((corner >= box[0, :, None]) & (corner < box[1, :, None])).all(axis=0))


def weld(pieces: list[Piece]) -> Unfinished:
    """The whole surface, as if it had never been cut; pieces leave the list as they are used up."""
    order = np.lexsort(np.concatenate([piece.corner for piece in pieces], axis=1)[::-1])
    first = _ranks([piece.vertices[None] for piece in pieces], order)
    begin = _ranks([piece.crossings for piece in pieces], order)
    numbers = [_numbers(*ends) for ends in zip(first, (piece.vertices[None] for piece in pieces), strict=True)]
    rim = np.concatenate([piece.rim for piece in pieces])
    rim_number = np.concatenate([number[piece.rim_number] for number, piece in zip(numbers, pieces, strict=True)])
    by_name = np.argsort(rim)

    total = sum(len(number) for number in numbers)
    points = np.empty((3, padded(total)))
    leaf = np.empty(sum(len(piece.surface.leaf) for piece in pieces), np.int16)
    flaws = np.empty(len(leaf), np.uint8)
    faces = np.empty((len(leaf), 6), np.int32)
    notes: list[Any] = []
    for number, starts in zip(numbers, begin, strict=True):
        piece = pieces.pop(0)
        strangers = rim_number[by_name[np.searchsorted(rim, piece.strangers, sorter=by_name)]]
        place = _numbers(starts, piece.crossings)
        points[:, number] = piece.surface.points
        leaf[place], flaws[place] = piece.surface.leaf, piece.surface.flaws
        faces[place] = np.concatenate([number, strangers])[piece.surface.faces].reshape(-1, 6)
        notes += piece.surface.notes
    return Unfinished(points, total, faces.reshape(-1, 3), leaf, flaws, tuple(notes))


def _ranks(counts: list[Numbers], order: NDArray[np.int64]) -> list[NDArray[np.int64]]:
    """The number of the first of each (row, block), row by row, in each row block by block in this order."""
    all_ = np.concatenate(counts, axis=1).astype(np.int64)
    ranked = all_[:, order]
    first = np.empty_like(all_)
    first[:, order] = (np.cumsum(ranked) - ranked.ravel()).reshape(ranked.shape)
    return np.split(first, np.cumsum([count.shape[1] for count in counts])[:-1], axis=1)


def _numbers(first: NDArray[np.int64], counts: Numbers) -> Numbers:
    """Number of each member of a piece, from that of the first of each (row, block)."""
    here = np.cumsum(counts) - counts.ravel()
    total = int(counts.sum())
    return np.asarray(np.repeat(first.ravel() - here, counts.ravel()) + np.arange(total), np.int32)
