"""Cells of a plane lattice cut in smaller ones, these again, and lines that run through all sizes of them.

Places are in units so small that the middle of every side is whole.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from rsym.arrays import Flags, Floats, Ints
from rsym.sampling.lattice import AROUND, Lattice, numbers_of

PARTS = 8  # of the side of a cell that is cut
DEPTH = 4  # how often: what is thinner than a cell / PARTS**DEPTH is told
UNIT = 2 * PARTS**DEPTH  # of a cell of the lattice: the middles of all sides are whole
BEYOND = np.array([(-1, 0), (1, 0), (0, -1), (0, 1)])
MIDDLES = BEYOND + 1  # of a side, in halves of a cell
CORNERS = np.array([(0, 0), (0, 1), (1, 0), (1, 1)])


class CutCells(NamedTuple):
    """Cells (k, 2) by their first corners, in sizes of theirs; which corners (k, 4) are inside; their sides.

    These are given by their middles (k, 4, 2) in units; a side to a larger neighbour is that of the neighbour.
    """

    first: Ints
    high: Flags
    sides: Ints

    @property
    def crossed(self) -> Flags:
        """Whether corners lie on both sides."""
        return np.asarray(self.high.any(axis=1) & ~self.high.all(axis=1))

    def take(self, which: Flags | Ints) -> CutCells:
        """Some of them."""
        return CutCells(self.first[which], self.high[which], self.sides[which])


def loose_sides(cells: CutCells, lattice: Lattice) -> Ints:
    """The middles (n, 2) of sides where lines of cells do not go on: not crossed once from both."""
    across = np.stack(
        [cells.high[:, one] != cells.high[:, other] for one, other in ((0, 1), (2, 3), (0, 2), (1, 3))], 1
    )
    sides, place = np.unique(cells.sides[across], axis=0, return_inverse=True)
    second = np.broadcast_to([False, True, False, True], across.shape)[across]
    counts = np.array([np.bincount(place[which].ravel(), minlength=len(sides)) for which in (~second, second)])
    end = UNIT * (np.array(lattice.counts) - 1)
    return np.asarray(sides[(counts != 1).any(axis=0) & ((sides > 0) & (sides < end)).all(axis=1)])


def cells_around(places: Floats, depth: int) -> Ints:
    """The cells of a depth that hold places in indices, and those beside."""
    return np.unique((np.floor(places * PARTS**depth).astype(np.int64)[:, None] + AROUND).reshape(-1, 2), axis=0)


def larger_cells(middles: Ints, depth: int, reach: int) -> Ints:
    """The cells of a depth so many cells around sides with these middles, if they are larger than the sides."""
    either = middles[:, 0] | middles[:, 1]
    size = UNIT // PARTS**depth
    own = middles[2 * (either & -either) < size]
    around = np.indices((2 * reach + 1, 2 * reach + 1)).reshape(2, -1).T - reach
    return np.unique((np.unique(own // size, axis=0)[:, None] + around).reshape(-1, 2), axis=0)


def edges_of(index: Floats) -> tuple[Floats, Floats]:
    """The ends (n, 2) in indices of the sides of cells, of whatever size, with these middles.

    Examples
    --------
    >>> start, end = edges_of(np.array([[3.0, 1.5], [2.0625, 4.0]]))
    >>> start.tolist(), end.tolist()
    ([[3.0, 1.0], [2.0, 4.0]], [[3.0, 2.0], [2.125, 4.0]])
    """
    whole = np.rint(index * UNIT).astype(np.int64)
    either = whole[:, 0] | whole[:, 1]
    half = (either & -either)[:, None]
    along = half * ((whole & half) != 0)
    return (whole - along) / UNIT, (whole + along) / UNIT


def finer_lattice(lattice: Lattice) -> Lattice:
    """The lattice of the parts of cells."""
    counts = tuple(PARTS * (count - 1) + 1 for count in lattice.counts)
    return Lattice(lattice.origin, tuple(h / PARTS for h in lattice.spacing), counts)


def on_lattice(first: Ints, high: Flags) -> CutCells:
    """Cells of a lattice whose samples are inside where they are `high`."""
    corners = (first[:, None] + CORNERS).reshape(-1, 2)
    return CutCells(first, high[tuple(corners.T)].reshape(-1, 4), (UNIT // 2) * (2 * first[:, None] + MIDDLES))


def elsewhere(high: Flags, known: Flags, apart: Ints) -> CutCells:
    """The cells that lines of a lattice cross, without some."""
    corners = np.stack([high[:-1, :-1], high[:-1, 1:], high[1:, :-1], high[1:, 1:]])
    crossed = known & corners.any(axis=0) & ~corners.all(axis=0)
    crossed[tuple(apart.T)] = False
    return on_lattice(np.argwhere(crossed), high)


def cells_beside(cells: Ints) -> Ints:
    """Which cells (k, 4) lie across the sides of each, -1 for none."""
    return numbers_of(cells, (cells[:, None] + BEYOND).reshape(-1, 2)).reshape(-1, 4)
