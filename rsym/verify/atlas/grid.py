"""The lines on which the sides of rectangles lie, and what stands in each cell between them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rsym.arrays import Floats, Ints
from rsym.reports.document import CERTIFIED, DEGENERATE, REFUTED, UNDECIDED

# What stands in a cell; the signs tell certified from refuted.
KINDS = {CERTIFIED: 1, REFUTED: -1, UNDECIDED: 0, DEGENERATE: 2}
# An undecided island beside a threshold widens its enclosure: it counts as so many times as wide as it is.
ISLAND = 16.0


@dataclass(frozen=True, eq=False)
class Grid:
    """Rectangles (n, 2, 2) that tile one rectangle, by the cells between all lines of both directions.

    `lines` are the coordinates of the lines along each axis; `owner` tells which rectangle each cell is part of.

    Examples
    --------
    >>> halves = np.array([[[0, 1], [0, 2]], [[1, 4], [0, 1]], [[1, 4], [1, 2]]], dtype=float)
    >>> grid_of(halves).owner.tolist()
    [[0, 0], [1, 2]]
    """

    lines: tuple[Floats, Floats]
    owner: Ints

    @property
    def shares(self) -> tuple[Floats, Floats]:
        """The widths of the columns and rows, as shares of the whole."""
        first, second = (np.diff(line) / (line[-1] - line[0]) for line in self.lines)
        return first, second


def grid_of(rectangles: Floats) -> Grid:
    """The grid of rectangles that tile one."""
    lines = np.unique(rectangles[:, 0]), np.unique(rectangles[:, 1])
    owner = np.full((len(lines[0]) - 1, len(lines[1]) - 1), -1, np.int64)
    for number, sides in enumerate(rectangles):
        (i, j), (k, m) = (np.searchsorted(line, side) for line, side in zip(lines, sides, strict=True))
        owner[i:j, k:m] = number
    return Grid(lines, owner)


def run_lengths(marked: NDArray[np.bool_], shares: Floats) -> Floats:
    """For each marked cell the length of the run of marked cells along the first axis that it is part of, else 0.

    Examples
    --------
    >>> run_lengths(np.array([[True], [True], [False], [True]]), np.array([1.0, 2.0, 1.0, 4.0])).ravel()
    array([3., 3., 0., 4.])
    """
    begins = np.cumsum(np.diff(marked, axis=0, prepend=False) & marked, axis=0) * marked
    lengths = np.zeros(marked.shape)
    for column, runs in enumerate(begins.T):
        lengths[:, column] = np.bincount(runs, weights=shares)[runs]
    return np.where(marked, lengths, 0.0)


def narrowest(kinds: Ints, shares: Sequence[Floats]) -> Floats:
    """How wide what is open (0) is at each cell, along the letter along which it is narrower; 0 where it is not open.

    A run of open cells from what is certified (1) to what is refuted (-1) has a threshold in it. One between cells of
    the same kind says less, and counts as `ISLAND` times as wide.
    """
    along, across = (_widths(kinds, shares[0]), _widths(kinds.T, shares[1]).T)
    return np.minimum(along, across)


def too_wide(kinds: Ints, shares: Sequence[Floats], tolerance: float) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """The open cells that are too wide along both letters, by the letter along which they are narrower."""
    along, across = (_widths(kinds, shares[0]), _widths(kinds.T, shares[1]).T)
    wide = np.minimum(along, across) > tolerance
    return wide & (along <= across), wide & (along > across)


def run_through(marked: NDArray[np.bool_], line: Ints, place: int) -> list[int]:
    """The different entries of a line of cells on the run of marked ones through a place.

    Examples
    --------
    >>> run_through(np.array([True, True, False, True]), np.array([5, 7, 7, 8]), 0)
    [5, 7]
    """
    gaps = np.flatnonzero(~marked)
    first = gaps[gaps < place].max(initial=-1) + 1
    last = gaps[gaps > place].min(initial=len(line))
    return sorted(set(line[first:last].tolist()))


def _widths(kinds: Ints, shares: Floats) -> Floats:
    lengths = run_lengths(kinds == 0, shares)
    before, after = _carried(kinds), _carried(kinds[::-1])[::-1]
    return np.where(before * after > 0, ISLAND * lengths, lengths)


def _carried(kinds: Ints) -> Ints:
    """For each cell the kind of the last one that is not open before it, 0 if there is none."""
    rows = np.arange(1, len(kinds) + 1)[:, None]
    last = np.maximum.accumulate(np.where(kinds != 0, rows, 0), axis=0)
    padded = np.vstack([np.zeros((1, kinds.shape[1]), np.int64), kinds])
    carried: Ints = np.take_along_axis(padded, last, axis=0)
    return carried
