"""Which cells of a grid are joined within a shape: on both sides of a gap they are not, however close.

Cells are joined across a side that they have in common, and that the shape crosses.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from rsym.arrays import Flags, Floats, Ints
from rsym.problems.splines.cardinals import digits
from rsym.sampling.compiled import loop


@dataclass(frozen=True, eq=False)
class JoinedCells:
    """Cells in C order: which are touched by a shape, and from which it comes to the next along each axis.

    touched : (cells,)
    onwards : (dimension, cells)

    Examples
    --------
    >>> joined_cells((2, 2), np.array([0, 1, 3]), np.array([[1, 3]])).onwards.tolist()
    [[False, False, False, False], [True, False, False, False]]
    """

    counts: tuple[int, ...]
    touched: Flags
    onwards: Flags

    def parts(self, degree: int, splines: Ints) -> Ints:
        """Of the cells (n, (degree + 1)**dimension) of some splines, which part of them, from 0 on; -1 if not touched.

        Cells stand in the order of what the spline is there, as in `digits`.
        """
        local = digits(degree + 1, len(self.counts))
        found = np.full((len(splines), len(local)), -1, np.int64)
        _parts(self._counts, degree, splines, local, self.touched, self.onwards, found)
        return found

    def reached(self, blocks: Flags) -> Flags:
        """As `onwards`, where cells of some blocks of splines are passed too if they are not touched."""
        there = (self.touched | blocks).reshape(self.counts)
        free = ~self.touched & blocks
        found = self.onwards.copy()
        for axis, row in enumerate(found):
            next_there = np.zeros(self.counts, np.bool_)
            inner, after = ([slice(None)] * len(self.counts) for _ in range(2))
            inner[axis], after[axis] = slice(None, -1), slice(1, None)
            next_there[tuple(inner)] = there[tuple(after)]
            next_free = np.zeros(self.counts, np.bool_)
            next_free[tuple(inner)] = free.reshape(self.counts)[tuple(after)]
            row |= (free & next_there.ravel()) | (there & next_free).ravel()
        return found

    def nearest(self, blocks: Flags, starts: Ints, cells: Ints, middles: Floats, likely: Ints) -> Ints:
        """For groups of cells the block, a cell of `blocks`, that is nearest to a place and joined; -1 where none is.

        starts : where the cells of each group begin in `cells`, with the end.
        middles : the places (n, dimension), in cells.
        likely : for each group a block that is taken if it is joined with it straight on.
        """
        found = np.full(len(middles), -1, np.int64)
        _nearest(self._counts, blocks, self.reached(blocks), starts, cells, middles, likely, found)
        return found

    @property
    def _counts(self) -> Ints:
        return np.array(self.counts, np.int64)


def joined_cells(counts: Sequence[int], touched: Ints, closed: Ints) -> JoinedCells:
    """The cells that are touched, joined but where sides between two of them, (n, 2), are closed."""
    there = np.zeros(tuple(counts), np.bool_)
    there.ravel()[touched] = True
    onwards = np.zeros((len(counts), there.size), np.bool_)
    for axis in range(len(counts)):
        inner = (*[slice(None)] * axis, slice(None, -1))
        after = (*[slice(None)] * axis, slice(1, None))
        onwards[axis].reshape(there.shape)[inner] = there[inner] & there[after]
        step = int(np.prod(counts[axis + 1 :]))
        onwards[axis][closed[closed[:, 1] - closed[:, 0] == step, 0]] = False
    return JoinedCells(tuple(counts), there.ravel(), onwards)


@loop
def _parts(counts: Ints, degree: int, splines: Ints, local: Ints, touched: Flags, onwards: Flags, found: Ints) -> None:
    """Each cell that is not in a part begins one, which is filled."""
    dimension, wide = len(counts), degree + 1
    count = len(local)
    numbers, waiting = np.empty(count, np.int64), np.empty(count, np.int64)
    place = np.empty(dimension, np.int64)
    for k in range(len(splines)):
        rest = splines[k]
        for axis in range(dimension - 1, -1, -1):
            place[axis] = rest % (counts[axis] + degree)
            rest //= counts[axis] + degree
        for i in range(count):
            flat, inside = 0, True
            for axis in range(dimension):
                at = place[axis] - local[i, axis]
                inside = inside and 0 <= at and at < counts[axis]
                flat = flat * counts[axis] + at
            numbers[i] = flat if inside and touched[max(flat, 0)] else -1
        part = 0
        for first in range(count):
            if numbers[first] < 0 or found[k, first] >= 0:
                continue
            found[k, first] = part
            waiting[0], left = first, 1
            while left > 0:
                left -= 1
                i = waiting[left]
                step = 1
                for axis in range(dimension - 1, -1, -1):
                    # A cell that is farther on is what the spline began with.
                    if local[i, axis] > 0:
                        j = i - step
                        if numbers[j] >= 0 and found[k, j] < 0 and onwards[axis, numbers[i]]:
                            found[k, j] = part
                            waiting[left] = j
                            left += 1
                    if local[i, axis] < degree:
                        j = i + step
                        if numbers[j] >= 0 and found[k, j] < 0 and onwards[axis, numbers[j]]:
                            found[k, j] = part
                            waiting[left] = j
                            left += 1
                    step *= wide
            part += 1


@loop
def _nearest(
    counts: Ints,
    blocks: Flags,
    onwards: Flags,
    starts: Ints,
    cells: Ints,
    middles: Floats,
    likely: Ints,
    found: Ints,
) -> None:
    """Cells are entered one step after the other; first within the box of the group and its likely block."""
    dimension, size = len(counts), len(blocks)
    entered, waiting = np.full(size, -1, np.int64), np.empty(size, np.int64)
    low, high = np.empty(dimension, np.int64), np.empty(dimension, np.int64)
    for k in range(len(found)):
        for boxed in range(2):
            for axis in range(dimension):
                low[axis], high[axis] = 0, counts[axis] - 1
            if boxed == 0:
                step = 1
                for axis in range(dimension - 1, -1, -1):
                    low[axis] = high[axis] = likely[k] // step % counts[axis]
                    for c in range(starts[k], starts[k + 1]):
                        low[axis] = min(low[axis], cells[c] // step % counts[axis])
                        high[axis] = max(high[axis], cells[c] // step % counts[axis])
                    step *= counts[axis]
            stamp, ends = 2 * k + boxed, 0
            for c in range(starts[k], starts[k + 1]):
                entered[cells[c]] = stamp
                waiting[ends] = cells[c]
                ends += 1
            first, best, nearest, steps, most = 0, np.inf, -1, 0, size
            while first < ends and steps <= most and found[k] < 0:
                last = ends
                for w in range(first, last):
                    cell = waiting[w]
                    if boxed == 0 and cell == likely[k]:
                        found[k] = cell
                        break
                    away, step = 0.0, 1
                    for axis in range(dimension - 1, -1, -1):
                        at = cell // step % counts[axis]
                        away += (at - middles[k, axis]) ** 2
                        for way in range(2):
                            other = cell + step if way == 0 else cell - step
                            inside = at < high[axis] if way == 0 else at > low[axis]
                            if inside and entered[other] != stamp and onwards[axis, min(cell, other)]:
                                entered[other] = stamp
                                waiting[ends] = other
                                ends += 1
                        step *= counts[axis]
                    if boxed == 1 and blocks[cell] and away < best:
                        # Blocks that are not much farther on may be nearer.
                        if best == np.inf:
                            most = steps + 2 * dimension
                        best = away
                        nearest = cell
                first = last
                steps += 1
            if boxed == 1 and best < np.inf:
                found[k] = nearest
            if found[k] >= 0:
                break
