"""Boxes and the leaves that matter in them, as arrays."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rsym.arrays import Flags, Floats, Ints
from rsym.sampling.sharp.loops import loop

_CORNERS = np.stack(np.meshgrid([0, 1], [0, 1], [0, 1], indexing="ij")).reshape(3, 1, 8)
NO_BOUNDS = np.empty((2, 0)), np.empty((3, 2, 0))


@dataclass(frozen=True)
class CellBoxes:
    """Boxes, and for each the leaves that may matter in it.

    Attributes
    ----------
    corner, size : (3, n), (n,)
        In units of the lattice they belong to.
    owner : (n,)
        The number of what they are part of, ascending.
    start, leaf : (n + 1,), (m,)
        Leaves ``leaf[start[k]:start[k + 1]]`` may matter in box k.
    skip : (n, words)
        Bit 2*gate + operand is set where that operand of the gate cannot be the active one.
    value, gradient : (2, m), (3, 2, m)
        Bounds of these leaves and of their gradients, once they are known.
    """

    corner: Ints
    size: Ints
    owner: Ints
    start: Ints
    leaf: NDArray[np.int16]
    skip: NDArray[np.uint64]
    value: Floats
    gradient: Floats

    def __len__(self) -> int:
        return len(self.size)

    def ends(self, lattice: Floats) -> tuple[Floats, Floats]:
        """Lower and upper ends of the box of each leaf, in the coordinates of a lattice (origin, spacing).

        Neighbours share their faces to the last bit.
        """
        lower, upper = np.empty((3, len(self.leaf))), np.empty((3, len(self.leaf)))
        _place(lattice, self.corner, self.size, self.start, lower, upper)
        return lower, upper

    def chosen(self, which: Flags, kept: Flags) -> CellBoxes:
        """Some of the boxes, with those of their leaves that are kept."""
        start = np.empty(int(which.sum()) + 1, np.int64)
        some = np.empty(_count(which, kept, self.start, start), np.int64)
        _gather(which, kept, self.start, some)
        return CellBoxes(
            self.corner[:, which],
            self.size[which],
            self.owner[which],
            start,
            self.leaf[some],
            self.skip[which],
            self.value.take(some, axis=1),
            self.gradient.take(some, axis=2),
        )

    def all_leaves(self) -> Flags:
        """That each leaf is kept."""
        return np.ones(len(self.leaf), np.bool_)

    def halved(self) -> CellBoxes:
        """The eight halves of each box, without bounds."""
        size = self.size // 2
        corner = (self.corner[:, :, None] + size[None, :, None] * _CORNERS).reshape(3, -1)
        start = _starts(np.repeat(np.diff(self.start), 8))
        leaf = np.empty(start[-1], np.int16)
        _spread(self.start, self.leaf, start, leaf)
        owner, skip = np.repeat(self.owner, 8), np.repeat(self.skip, 8, axis=0)
        return CellBoxes(corner, np.repeat(size, 8), owner, start, leaf, skip, *NO_BOUNDS)

    def renumbered(self) -> CellBoxes:
        """The same boxes, each its own owner."""
        return replace(self, owner=np.arange(len(self)))

    def having(self, value: Floats, gradient: Floats) -> CellBoxes:
        """The same boxes with these bounds."""
        return replace(self, value=value, gradient=gradient)


def _starts(count: NDArray[Any]) -> Ints:
    return np.concatenate([[0], np.cumsum(count)])


@loop
def _place(lattice: Any, corner: Any, size: Any, start: Any, lower: Any, upper: Any) -> None:
    for box in range(len(size)):
        for k in range(3):
            low = lattice[k] + lattice[3 + k] * corner[k, box]
            high = lattice[k] + lattice[3 + k] * (corner[k, box] + size[box])
            for pair in range(start[box], start[box + 1]):
                lower[k, pair], upper[k, pair] = low, high


@loop
def _count(which: Any, kept: Any, start: Any, found: Any) -> int:
    """Where the leaves of each chosen box will start, and how many they are."""
    total, number = 0, 0
    for box in range(len(which)):
        if which[box]:
            found[number] = total
            number += 1
            for pair in range(start[box], start[box + 1]):
                total += kept[pair]
    found[number] = total
    return total


@loop
def _gather(which: Any, kept: Any, start: Any, some: Any) -> None:
    """The numbers of the kept leaves of the chosen boxes."""
    number = 0
    for box in range(len(which)):
        if which[box]:
            for pair in range(start[box], start[box + 1]):
                if kept[pair]:
                    some[number] = pair
                    number += 1


@loop
def _spread(parents: Any, given: Any, start: Any, leaf: Any) -> None:
    """Eight times the leaves of each parent."""
    for box in range(len(start) - 1):
        first = parents[box >> 3] - start[box]
        for k in range(start[box], start[box + 1]):
            leaf[k] = given[first + k]
