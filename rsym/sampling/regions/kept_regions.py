"""Regions that keep the value, of boxes that are halved where questions come, and kept for a choice of letters.

Questions about few points at a time, as of untangling, come again and again to the same places: what matters there is
found once.
"""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from rsym.arrays import Flags, Floats, Ints
from rsym.model.shape import Bounds
from rsym.sampling.regions.regions import Regions
from rsym.sampling.sharp.loops import loop

# The regions of boxes (6, n) in some of those given, told by their numbers.
Narrow: TypeAlias = Callable[[Floats, Ints, Regions], Regions]

OPEN, LAST = 0, -1  # instead of the number of the first of eight: not halved yet, not halved any more
FEW = 8  # entries of which none is worth leaving out
DEEPEST = 12  # halvings
MOST = 2**21  # entries, 25 megabytes
WIDER = 2.0  # than the bounds: vertices end a little outside


class KeptRegions:
    """A tree of boxes: that of number 0 has everything, also what matters outside."""

    def __init__(self, bounds: Bounds | None, whole: Regions, narrow: Narrow) -> None:
        low, high = np.array(bounds or [(-1.0, 1.0)] * 3).T
        self._narrow = narrow
        self._growing = threading.Lock()
        self._count, self._used = 1, len(whole.entries)
        self._child, self._depth = np.full(1, OPEN if self._used > FEW else LAST), np.zeros(1, np.int8)
        self._ends = np.empty((1, 6))
        self._ends[0, ::2], self._ends[0, 1::2] = (
            (low + high - WIDER * (high - low)) / 2, (low + high + WIDER * (high - low)) / 2
        )  # fmt: skip
        self._start, self._entries = whole.start.copy(), whole.entries.copy()

    def at(self, points: Floats) -> tuple[Ints, Regions]:
        """The number of the region of each point (3, n), and the regions up to the last of them."""
        numbers = np.zeros(points.shape[1], np.int64)
        while True:
            child, ends = self._child, self._ends  # they grow in place, or are new ones
            wanted = np.zeros(len(child), np.bool_)
            if not descend(points, child, ends, numbers, wanted):
                count = int(numbers.max(initial=0)) + 1
                return numbers, self._first(count)
            self._halve(np.flatnonzero(wanted))

    def _first(self, count: int) -> Regions:
        start, entries = self._start, self._entries
        return Regions(start[: count + 1], entries[: start[count]])

    def _halve(self, which: Ints) -> None:
        with self._growing:
            which = which[self._child[which] == OPEN]
            if self._used > MOST:
                self._child[which] = LAST
            if self._used > MOST or not len(which):
                return
            ends = _eighths(self._ends[which])
            made = self._narrow(np.ascontiguousarray(ends.T), np.repeat(which, 8), self._first(self._count))
            first, last, used = self._count, self._count + len(made), self._used + len(made.entries)
            self._ends, self._depth = _with_room(self._ends, last), _with_room(self._depth, last)
            self._start, self._entries = _with_room(self._start, last + 1), _with_room(self._entries, used)
            child = _with_room(self._child, last)
            self._ends[first:last], self._depth[first:last] = ends, np.repeat(self._depth[which] + 1, 8)
            self._start[first + 1 : last + 1] = self._used + made.start[1:]
            self._entries[self._used : used] = made.entries
            halved = (np.diff(made.start) > FEW) & (self._depth[first:last] < DEEPEST)
            child[first:last] = np.where(halved, OPEN, LAST)
            self._count, self._used = last, used
            child[which] = first + 8 * np.arange(len(which))  # last: another thread may read
            self._child = child


def _with_room(array: NDArray[Any], count: int) -> NDArray[Any]:
    """The same, or a copy twice as long: who reads the old one goes on."""
    if len(array) >= count:
        return array
    longer = np.zeros((max(count, 2 * len(array)), *array.shape[1:]), array.dtype)
    longer[: len(array)] = array
    return longer


def _eighths(ends: Floats) -> Floats:
    """The boxes (8 n, 6) of halves along all axes."""
    halves = np.repeat(ends, 8, axis=0).reshape(-1, 8, 6)
    for axis in range(3):
        low, high = halves[:, :, 2 * axis], halves[:, :, 2 * axis + 1]
        middle, upper = (low + high) / 2, (np.arange(8) >> axis & 1).astype(np.bool_)
        low[:, upper], high[:, ~upper] = middle[:, upper], middle[:, ~upper]
    return halves.reshape(-1, 6)


@loop
def descend(points: Floats, child: Ints, ends: Floats, numbers: Ints, wanted: Flags) -> bool:
    """Go on from the boxes that points are in to the smallest; whether any is wanted halved."""
    some = False
    for i in range(points.shape[1]):
        box = numbers[i]
        inside = True
        for axis in range(3):
            inside &= ends[0, 2 * axis] <= points[axis, i] <= ends[0, 2 * axis + 1]
        if not inside:
            continue
        while child[box] > 0:
            octant = 0
            for axis in range(3):
                if points[axis, i] > (ends[box, 2 * axis] + ends[box, 2 * axis + 1]) / 2:
                    octant |= 1 << axis
            box = child[box] + octant
        numbers[i] = box
        if child[box] == 0:
            wanted[box] = True
            some = True
    return some
