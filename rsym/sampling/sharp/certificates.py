"""Which cells are simple: nothing thinner than a cell is lost silently.

The form is a min and max of leaves. Over a box the signs of some leaves are
known; a gate with a decided operand passes on the other one or is decided
itself. What remains *matters*: the leaves of open sign that are reached from the
form through open gates. In the box the form has the sign of a min and max of
just these.

A box is **discarded** if the sign of the form is known there, and **simple** if
one direction d has d.g > 0 for every gradient g that a leaf that matters takes
in it. Each of these leaves then rises strictly along d (a Lipschitz leaf too:
its generalised gradients lie in the enclosure), min and max keep that, and so
does the form: along every line parallel to d its sign changes at most once, from
outside to inside. The zero set in the box is one graph over the plane across d.
No wall, gap, bubble, sheet or second piece lies inside. We ask for
d.g > STEEPEST*|g|: that bounds the slope of the graph, so it is no needle.

Blocks of 8 cells a side are split in halves until they are discarded or simple,
or cells. A cell that is neither is split further, into sub-boxes; it is simple
after all if one d serves all its sub-boxes that are not discarded: a line along
d passes through sub-boxes one after the other, in each the sign keeps or turns
from outside to inside, and neighbours agree on what they share. (Directions of
their own would prove nothing: each half of a wall rises in its own way.) A cell
that holds two pieces of the zero set that no d serves is not split to the end,
nor are the cells of a block where splitting settles next to none.

A leaf that is undefined throughout a box has the enclosure (-inf, inf), for its
gradient too, so such a box is never discarded because of it and never simple;
where it is undefined in part, its bounds speak of the other part.

What this does not say: a body may leave a simple cell through a face and be
caught by no lattice point. It then goes on growing along d on the other side,
until it closes somewhere: a smooth piece that no lattice point meets has a point
where the gradient is zero, and the cell around that point is not simple.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rsym.arrays import Flags, Floats, Ints
from rsym.sampling.regions.regions import Regions, of_leaves, without_idle
from rsym.sampling.sharp.crossings import Leaves
from rsym.sampling.sharp.gates import OPEN, UNRESOLVED, judge, judge_groups, reach
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
    region : (n,)
        The number of the region that they lie in.
    skip : (n, words)
        Bit 2*entry + operand is set where that operand of an entry of the region cannot be the active one.
    value, gradient : (2, m), (3, 2, m)
        Bounds of these leaves and of their gradients, once they are known.
    """

    corner: Ints
    size: Ints
    owner: Ints
    start: Ints
    leaf: NDArray[np.int16]
    region: Ints
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
        _place(lattice, np.ascontiguousarray(self.corner), self.size, self.start, lower, upper)
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
            self.region[which],
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
        owner, region = np.repeat(self.owner, 8), np.repeat(self.region, 8)
        return CellBoxes(
            corner, np.repeat(size, 8), owner, start, leaf, region, np.repeat(self.skip, 8, axis=0), *NO_BOUNDS
        )

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


# The least cosine between d and a gradient. The bisector of a wedge of 23 degrees has 0.2 with both sides; a sharper
# edge is a needle to any cell, and walls of two leaves count as facing each other from there on.
STEEPEST = 0.2
# Of 1654 cells of a tilted torus as one polynomial, 24 cells wide, depths 1 to 3 leave 584, 1 and none; of 1009 of
# the car at 256**3 depths 1 to 4 leave 824, 671, 518 and 511.
DEPTH = 3
# A block with more open cells, of which a level settles less than a quarter, holds a wall: of a thin sphere further
# levels settle one cell in a thousand, at eight times the work each. Blocks of the car have up to 48 such cells.
CROWD, SETTLED = 64, 0.25
# Blocks and cells that are treated at once: their enclosures stay within some 20 MB.
BLOCKS, CELLS = 2048, 2048


@dataclass(frozen=True)
class Form:
    """A sign form: the leaves, how many they are, and the region in which everything matters."""

    leaves: Leaves
    count: int
    region: Regions


@dataclass(frozen=True)
class Unresolved:
    """Cells without a certificate, and the conflicts in them.

    Attributes
    ----------
    cells : (3, n)
        In lexicographic order.
    owner : (m,)
        The cell of each member of a conflict, ascending.
    leaf : (m,)
        A leaf that matters in a box ...
    lower, upper : (3, m)
        ... and the box: no direction serves the gradients that the members in one cell take.
    tested : tuple of int
        Boxes tested: blocks, their halves down to cells, and parts of cells.
    """

    cells: Ints
    owner: Ints
    leaf: NDArray[np.int16]
    lower: Floats
    upper: Floats
    tested: tuple[int, ...]

    def __len__(self) -> int:
        return int(self.cells.shape[1])


def certify(
    form: Form,
    lattice: Floats,
    corner: Ints,
    words: Regions | NDArray[np.uint64] | None = None,
    *,
    depth: int = DEPTH,
    pool: Executor | None = None,
) -> Unresolved:
    """The cells of kept blocks that are neither free of the surface nor simple.

    Parameters
    ----------
    form : Form
    lattice : (6,)
        Origin and spacing.
    corner : (3, n)
        First cells of the blocks of 8*8*8 cells.
    words : Regions or (n, words), optional
        What matters in the blocks as kernels say it: their regions, or bits 2*gate + operand that are set where that
        operand cannot be the active one.
    depth : int
        How often a cell is halved.
    pool : Executor, optional
        Threads that share the work; the result does not depend on them.
    """
    if words is None:
        words = np.zeros((corner.shape[1], max(1, -(-2 * len(form.region.entries) // 64))), np.uint64)
    # Least boxes are the unit, so that a corner is a whole number and a coordinate the lattice's own.
    fine = np.concatenate([lattice[:3], lattice[3:] / 2**depth])

    def part(first: int) -> Unresolved:
        blocks = slice(first, first + BLOCKS)
        some = words[blocks]
        regions = of_leaves(some) if isinstance(some, Regions) else without_idle(form.region, some)
        return _part(form, regions, fine, _blocks(form, corner[:, blocks], regions, depth), depth)

    run = map if pool is None else pool.map
    return joined([_nothing((0,) * 5), *run(part, range(0, corner.shape[1], BLOCKS))])


def _blocks(form: Form, corner: Ints, regions: Regions, depth: int) -> CellBoxes:
    count = corner.shape[1]
    reached = np.zeros((count, form.count), np.bool_)
    reach(regions.start, regions.entries, reached)
    start = np.concatenate([[0], np.cumsum(reached.sum(axis=1))])
    leaf = np.nonzero(reached)[1].astype(np.int16)
    skip = np.zeros((count, -(-2 * int(np.diff(regions.start).max(initial=1)) // 64)), np.uint64)
    numbers = np.arange(count)
    return CellBoxes(corner << depth, np.full(count, 8 << depth), numbers, start, leaf, numbers, skip, *NO_BOUNDS)


def _part(form: Form, regions: Regions, fine: Floats, boxes: CellBoxes, depth: int) -> Unresolved:
    """From blocks to cells, and into those that are not simple."""
    tested = []
    for level in range(4):
        if level:
            boxes = boxes.halved()
        tested.append(len(boxes))
        boxes = _left(form, regions, fine, boxes, STEEPEST)
    parts = [_nothing((*tested, 0))]
    for first, last in _whole_blocks(boxes.owner):
        some = np.zeros(len(boxes), np.bool_)
        some[first:last] = True
        parts.append(_conflicts(form, regions, fine, boxes.chosen(some, boxes.all_leaves()), depth))
    return joined(parts)


def _whole_blocks(block: Ints) -> Iterator[tuple[int, int]]:
    """Parts of an ascending array that cut no block and, where that can be, hold CELLS at most."""
    ends = np.flatnonzero(np.diff(block, append=-1)) + 1
    first = 0
    while first < len(block):
        last = int(ends[max(np.searchsorted(ends, first + CELLS, "right") - 1, np.searchsorted(ends, first, "right"))])
        yield first, last
        first = last


def _left(form: Form, regions: Regions, fine: Floats, boxes: CellBoxes, cosine: float) -> CellBoxes:
    """The boxes that are neither discarded nor simple, the leaves that matter in them, and their gradients."""
    value, gradient = form.leaves.enclose(boxes.leaf, *boxes.ends(fine))
    verdict, kept = np.empty(len(boxes), np.uint8), np.zeros(len(boxes.leaf), np.bool_)
    judge(
        regions.start, regions.entries, form.count, boxes.region, boxes.start, boxes.leaf, boxes.skip, value, gradient,
        cosine, verdict, kept,
    )  # fmt: skip
    return boxes.having(value, gradient).chosen(verdict == OPEN, kept)


def _conflicts(form: Form, regions: Regions, fine: Floats, boxes: CellBoxes, depth: int) -> Unresolved:
    """Cells that are split until one direction serves all that is left of each, or surely none, or depth ends."""
    cells, tested = boxes.corner >> depth, 0
    _, block = np.unique(boxes.owner, return_inverse=True)
    boxes = boxes.renumbered()
    before = np.bincount(block)
    found: list[CellBoxes] = []
    for level in range(depth + 1):
        if level:
            halves = boxes.halved()
            tested += len(halves)
            boxes = _left(form, regions, fine, halves, np.inf)
        member, verdict = np.zeros(len(boxes.leaf), np.bool_), np.empty(cells.shape[1], np.uint8)
        ends = np.searchsorted(boxes.owner, np.arange(len(verdict) + 1))
        last = level == depth
        judge_groups(ends, boxes.start, boxes.value, boxes.gradient, STEEPEST, last, member, verdict)
        after = np.bincount(block[verdict == OPEN], minlength=len(before))
        crowded = (after > CROWD) & (after > (1 - SETTLED) * before) & (level > 0)
        verdict[(verdict == OPEN) & crowded[block]] = UNRESOLVED
        before, state = after, verdict[boxes.owner]
        found.append(boxes.chosen(state == UNRESOLVED, member))
        boxes = boxes.chosen(state == OPEN, boxes.all_leaves())
    return _unresolved(fine, cells, found, tested)


def _unresolved(fine: Floats, cells: Ints, found: list[CellBoxes], tested: int) -> Unresolved:
    owner = np.concatenate([np.repeat(boxes.owner, np.diff(boxes.start)) for boxes in found])
    leaf = np.concatenate([boxes.leaf for boxes in found])
    lower, upper = (np.concatenate(end, axis=1) for end in zip(*(boxes.ends(fine) for boxes in found), strict=True))
    numbers, owner = np.unique(owner, return_inverse=True)
    return Unresolved(cells[:, numbers], owner, leaf, lower, upper, (0, 0, 0, 0, tested))


def _nothing(tested: tuple[int, ...]) -> Unresolved:
    none = np.empty(0, np.int64)
    return Unresolved(
        np.empty((3, 0), np.int64), none, none.astype(np.int16), np.empty((3, 0)), np.empty((3, 0)), tested
    )


def joined(parts: Sequence[Unresolved]) -> Unresolved:
    """The parts as one, cells in lexicographic order."""
    cells = np.concatenate([part.cells for part in parts], axis=1)
    order = np.lexsort(cells[::-1])
    rank = np.empty_like(order)
    rank[order] = np.arange(len(order))
    first = np.cumsum([0, *(len(part) for part in parts[:-1])])
    owner = rank[np.concatenate([part.owner + shift for part, shift in zip(parts, first, strict=True)])]
    place = np.argsort(owner, kind="stable")
    leaf = np.concatenate([part.leaf for part in parts])[place]
    lower = np.concatenate([part.lower for part in parts], axis=1)[:, place]
    upper = np.concatenate([part.upper for part in parts], axis=1)[:, place]
    tested = tuple(int(sum(level)) for level in zip(*(part.tested for part in parts), strict=True))
    return Unresolved(cells[:, order], owner[place], leaf, lower, upper, tested)
