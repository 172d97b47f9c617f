"""What the samples of a plane lattice do not show: ovals, slots, gaps and rings thinner than a cell.

Intervals exclude most cells: the form has one sign all over them. The others are looked at on a finer lattice.
A cell is seen if either side has one piece in it, no hole, and a sample of the lattice in its own corners or, where a
line bulges through a side, so have it and the neighbour that the line comes from together; and if a line goes nowhere
farther than a part of the cell from its chord there, but in the smallest. Where cells are not seen, they and those
around them are cut in smaller ones, and these again, up to a limit; lines run through all sizes of them.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from rsym.arrays import Flags, Floats, Ints
from rsym.sampling.cut_cells import (
    BEYOND,
    CORNERS,
    DEPTH,
    MIDDLES,
    PARTS,
    UNIT,
    CutCells,
    cells_around,
    cells_beside,
    elsewhere,
    finer_lattice,
    larger_cells,
    loose_sides,
    on_lattice,
)
from rsym.sampling.isolines import beyond_chords, index_lines, lines_through, pieces
from rsym.sampling.lattice import AROUND, Lattice, grown, heaps, numbers_of
from rsym.sampling.plane_leaves import REACH, PlaneLeaves

BULGE = 1.5  # of the parts of a cell a line may go beyond its chord in a cell, or beyond the cell
TRIES = 5  # to cut larger cells too where lines of smaller ones do not go on
FEW, AROUND_ENDS = 64, 3  # so many of the smallest cells, with so many on each side, are looked at for the end of a tip
MOST = 32_000  # cells that may be looked at on one lattice; more, all over, are no lines
WORK = 3e7  # boxes of cells, each times the operations of the form, at a time: a second or two
_TOP, _BOTTOM, _LEFT, _RIGHT = range(4)  # rows and columns as in `isolines`
NOWHERE = np.empty((0, 2))


class _TooMuch(Exception):
    """More boxes than WORK allows."""


class SeenLines(NamedTuple):
    """Lines by the middles (n, 2) of the sides that they cross, in indices; how many cells are unseen, and where.

    Of a few that lie together one place is told.

    Not `examined` are forms without bounds, and those that have none in too many cells.
    """

    lines: list[Floats]
    unseen: int = 0
    places: tuple[tuple[float, float], ...] = ()
    finer: float = 0.0
    examined: bool = True


class _Found(NamedTuple):
    """Whether cells are unseen, whether they and those around are to be cut, and the signs (k, m, m) within them.

    plain: the sides (k, 4) that lines cross once, where their corners differ, and no other.
    """

    unseen: Flags
    cut: Flags
    high: Flags
    plain: Flags


def seen_lines(lattice: Lattice, signs: Floats, leaves: PlaneLeaves, near: Floats = NOWHERE) -> SeenLines:
    """The lines between signs of a form on a lattice, the inside to their left, and what lies between the samples.

    Cells `near` places (n, 2) in indices are cut in the smallest ones.
    """
    plain = [line[::-1] for line in index_lines(signs, 0.0)]
    undefined = np.isnan(signs)
    known = ~(undefined[:-1, :-1] | undefined[1:, :-1] | undefined[:-1, 1:] | undefined[1:, 1:])
    try:
        open_cells = _undecided(leaves, lattice, known)
        if open_cells is None:
            return SeenLines(plain, examined=False)
        cells = on_lattice(open_cells, signs > 0)
        forced, loose = [cells_around(near, depth) for depth in range(DEPTH)], np.empty((0, 2), np.int64)
        for attempt in range(TRIES):
            small, cut, unseen, places, size = _descended(leaves, lattice, cells, forced)
            if small is None:
                return SeenLines(plain)
            apart = elsewhere(signs > 0, known, cut)
            every = CutCells(*(np.concatenate(parts) for parts in zip(apart, small, strict=True)))
            every = every.take(every.crossed)
            loose = loose_sides(every, lattice)
            if not len(loose):
                break
            forced = [np.concatenate([old, larger_cells(loose, depth, 2**attempt)]) for depth, old in enumerate(forced)]
    except _TooMuch:
        return SeenLines(plain, examined=False)
    lines = [line / UNIT for line in lines_through(every.sides, every.high)]
    if not unseen and not len(loose):
        return SeenLines(lines)
    unseen, places = unseen + len(loose), np.concatenate([places, loose / UNIT])
    return SeenLines(lines, unseen, tuple((float(a), float(b)) for a, b in lattice.points(heaps(places))), size)


def _descended(
    leaves: PlaneLeaves, lattice: Lattice, cells: CutCells, forced: Sequence[Ints]
) -> tuple[CutCells | None, Ints, int, Floats, float]:
    """Cells cut until what they hold is seen, None if nothing is; which of the first are cut; what stays unseen.

    That is told by the number of cells, their middles in indices, their size. At each depth those `forced` are cut too.
    """
    finer = lattice
    looked, found = _look(leaves, finer, cells, forced[0])
    cut, done = looked.first[found.cut], []
    if not found.cut.any():
        return None, cut, 0, np.empty((0, 2)), 0.0
    for depth in range(1, DEPTH + 1):
        size, places = max(finer.spacing), (looked.first[found.unseen] + 0.5) / PARTS ** (depth - 1)
        cells, finer = _parts(looked, found, UNIT // (2 * PARTS**depth)), finer_lattice(finer)
        try:
            undecided = _holds(leaves, finer, cells.first, 1)
            if np.count_nonzero(undecided) > MOST:
                break
            beyond, more = (BULGE, forced[depth]) if depth < DEPTH else (PARTS, cut[:0])
            looked, found = _look(leaves, finer, cells.take(undecided), more, beyond)
        except _TooMuch:
            break
        size, places = max(finer.spacing), (looked.first[found.unseen] + 0.5) / PARTS**depth
        if not found.cut.any() or depth == DEPTH:
            break
        done.append(cells.take(numbers_of(looked.first[found.cut], cells.first) < 0))
    every = CutCells(*(np.concatenate(parts) for parts in zip(*done, cells, strict=True)))
    return every, cut, len(places), places, size


def _parts(cells: CutCells, found: _Found, half: int) -> CutCells:
    """The parts of those cells that are to be cut; `half` is that of their side in units."""
    own, high, plain = cells.take(found.cut), found.high[found.cut], found.plain[found.cut]
    inside = np.indices((PARTS, PARTS)).reshape(2, -1).T
    first = PARTS * own.first[:, None] + inside
    sides = half * (2 * first[:, :, None] + MIDDLES)
    beside = cells_beside(own.first)
    for side, (axis, end) in enumerate(((0, 0), (0, PARTS - 1), (1, 0), (1, PARTS - 1))):
        larger = np.flatnonzero((beside[:, side] < 0) & plain[:, side])
        along = np.flatnonzero(inside[:, axis] == end)
        sides[larger[:, None], along, side] = own.sides[larger, side][:, None]
    corners = high[:, inside[:, None, 0] + CORNERS[:, 0], inside[:, None, 1] + CORNERS[:, 1]]
    return CutCells(first.reshape(-1, 2), corners.reshape(-1, 4), sides.reshape(-1, 4, 2))


def _undecided(leaves: PlaneLeaves, lattice: Lattice, known: Flags) -> Ints | None:
    """The cells (k, 2), all corners known, that intervals do not exclude; halved from large blocks down."""
    size = 4 * PARTS
    blocks = np.indices([-(-count // size) for count in known.shape]).reshape(2, -1).T * size
    while True:
        blocks = blocks[_holds(leaves, lattice, blocks, size)]
        if size == 1:
            break
        size //= 2
        blocks = (blocks[:, None] + size * CORNERS).reshape(-1, 2)
        blocks = blocks[(blocks < known.shape).all(axis=1)]
        if len(blocks) > 16 * MOST:
            return None
    blocks = blocks[known[tuple(blocks.T)]]
    return blocks if len(blocks) <= MOST else None


def _holds(leaves: PlaneLeaves, lattice: Lattice, first: Floats | Ints, size: float) -> Flags:
    """Whether blocks of cells may hold a line."""
    if len(first) * leaves.operations > WORK:
        raise _TooMuch
    return np.asarray(leaves.signs_over(lattice.points(first), lattice.points(first + size)) == 0)


def _look(
    leaves: PlaneLeaves, lattice: Lattice, every: CutCells, forced: Ints, beyond: float = BULGE
) -> tuple[CutCells, _Found]:
    """What cells hold between their corners: those that were looked at, and what was found in them.

    Of the smallest it does not matter how far `beyond` its chord a line goes: it may so by all their parts.
    """
    wild = _wild(leaves, lattice, every)
    must = numbers_of(every.first, forced)
    wild[must[must >= 0]] = True
    while True:
        cells, found = _look_at(leaves, lattice, every, wild, forced, beyond)
        # A side to a cell that is not to be cut is plain.
        beside = (cells.first[:, None] + BEYOND)[found.cut[:, None] & ~found.plain]
        missed = numbers_of(every.first, beside[numbers_of(cells.first, beside) < 0])
        if not (missed >= 0).any():
            return cells, found
        wild[missed[missed >= 0]] = True


def _look_at(
    leaves: PlaneLeaves, lattice: Lattice, every: CutCells, wild: Flags, forced: Ints, beyond: float
) -> tuple[CutCells, _Found]:
    """The same for some wild cells, and those around."""
    near = grown(grown(wild, every.first), every.first)
    cells, wild = every.take(near), wild[near]
    inside = np.indices((PARTS + 1, PARTS + 1)).reshape(2, -1).T / PARTS
    points = lattice.points((cells.first[:, None] + inside).reshape(-1, 2))
    values = leaves.active(points)[0].reshape(-1, PARTS + 1, PARTS + 1)
    known = np.asarray(~np.isnan(values).any(axis=(1, 2)))
    high = np.asarray(values >= 0)
    doubtful = _doubtful(leaves, lattice, cells, high, wild)
    unseen = np.asarray((_hidden(high, cells, beyond) | beyond_chords(high, beyond) | doubtful) & known & wild)
    tips = np.zeros(len(unseen), np.bool_)
    tips[unseen] = _tips(leaves, lattice, cells.first[unseen])
    unseen &= ~_joined(tips, cells)
    if beyond >= PARTS:
        tips, ends = unseen.copy(), unseen.copy()
        tips[unseen], ends[unseen] = _tips_around(leaves, lattice, cells.first[unseen])
        # The very point of a tip is where no sample is, beside the last that shows it.
        unseen &= ~(ends | (tips & grown(tips & ~doubtful, cells.first)))
    cut = np.asarray(grown(unseen, cells.first))
    must = numbers_of(cells.first, forced)
    cut[must[must >= 0]] = True
    cut &= known
    ends = np.stack([high[:, 0], high[:, -1], high[:, :, 0], high[:, :, -1]], axis=1)
    # Across a side to a larger cell a line goes once, where its corners differ.
    changes = np.count_nonzero(np.diff(ends, axis=2), axis=2)
    plain = np.asarray(changes == (cells.high[:, [0, 2, 0, 1]] != cells.high[:, [1, 3, 2, 3]]))
    beside = cells_beside(cells.first)
    while True:
        more = beside[~(plain | ~cut[:, None])]
        more = more[(more >= 0) & ~cut[more] & known[more]]
        if not len(more):
            break
        cut[more] = True
    return cells, _Found(unseen, cut, high, plain)


def _wild(leaves: PlaneLeaves, lattice: Lattice, cells: CutCells) -> Flags:
    """Which cells may hold more than one line that is a graph, and that their corners show, or a neighbour's."""
    slopes = leaves.slopes_over(lattice.points(cells.first), lattice.points(cells.first + 1))
    crossed = cells.crossed
    tame = np.asarray(slopes.any(axis=1))
    wild = np.asarray(~tame)
    # Without a crossing there is nothing if it slopes along both; along one, what comes through a side goes back there.
    own = np.flatnonzero(tame & ~crossed & ~slopes.all(axis=1))
    towards = np.where(cells.high[own, 0], -1, 1)[:, None] * slopes[own]
    side = np.where(towards[:, 0] != 0, (towards[:, 0] > 0) + _TOP, (towards[:, 1] > 0) + _LEFT)
    other = cells_beside(cells.first)[own, side]
    wild[own] = (other < 0) | ~(crossed & tame)[other]
    return wild


def _tips(leaves: PlaneLeaves, lattice: Lattice, first: Ints) -> Flags:
    """Which cells have within so many cells a corner where the two leaves that alone matter in them cross.

    No samples show the tip of a sharp one.
    """
    one, other = leaves.crossing_over(lattice.points(first), lattice.points(first + 1))
    tips, own = np.zeros(len(first), np.bool_), np.flatnonzero(one >= 0)
    middle = lattice.points(first[own] + 0.5)
    corner = leaves.common(middle, one[own], other[own])
    cell = min(lattice.spacing)
    holds = leaves.meet(corner, one[own], other[own], cell)
    with np.errstate(all="ignore"):
        tips[own] = (np.hypot(*(corner - middle).T) <= REACH * cell) & holds
    return tips


def _joined(tips: Flags, cells: CutCells) -> Flags:
    """Which tips go on to a line that samples show: of a needle that none shows all cells would be such."""
    if not tips.any():
        return tips
    joined = tips & grown(cells.crossed, cells.first)
    while (more := tips & grown(joined, cells.first)).sum() > joined.sum():
        joined = more
    return joined


def _tips_around(leaves: PlaneLeaves, lattice: Lattice, first: Ints) -> tuple[Flags, Flags]:
    """Of which cells, if they are few, either side is one piece around, of corners too; of which one comes and ends."""
    if not 0 < len(first) <= FEW:
        return (np.zeros(len(first), np.bool_),) * 2
    count = (2 * AROUND_ENDS + 1) * PARTS + 1
    inside = np.indices((count, count)).reshape(2, -1).T / PARTS - AROUND_ENDS
    high = leaves.active(lattice.points((first[:, None] + inside).reshape(-1, 2)))[0].reshape(-1, count, count) >= 0
    borders = [np.stack([side[:, 0], side[:, -1], side[:, :, 0], side[:, :, -1]]).any(axis=2) for side in (high, ~high)]
    corners = high[:, ::PARTS, ::PARTS]  # between which lines go
    tips = (pieces(high) == 1) & (pieces(~high) == 1) & (pieces(corners) <= 1) & (pieces(~corners) <= 1)
    return tips, tips & (np.count_nonzero(borders, axis=1) == 1).any(axis=0)


def _doubtful(leaves: PlaneLeaves, lattice: Lattice, cells: CutCells, high: Flags, wild: Flags) -> Flags:
    """In which wild cells a part may hold a line, and neither it nor those around it do as the samples have it."""
    crossed = np.zeros((len(high), PARTS + 2, PARTS + 2), np.bool_)
    corners = np.stack([high[:, :-1, :-1], high[:, :-1, 1:], high[:, 1:, :-1], high[:, 1:, 1:]])
    crossed[:, 1:-1, 1:-1] = corners.any(axis=0) & ~corners.all(axis=0)
    near = np.repeat(~wild, PARTS**2).reshape(-1, PARTS, PARTS)
    for down, right in AROUND + 1:
        near |= crossed[:, down : down + PARTS, right : right + PARTS]
    own, size = np.flatnonzero(~near.all(axis=(1, 2))), PARTS
    rest = np.zeros((len(own), 2), np.int64)
    while size > 1:
        size //= 2
        own, rest = np.repeat(own, 4), (rest[:, None] + size * CORNERS).reshape(-1, 2)
        blocks = (~near).reshape(len(high), PARTS // size, size, PARTS // size, size)
        some = np.asarray(blocks.any(axis=(2, 4)))[own, rest[:, 0] // size, rest[:, 1] // size]
        own, rest = own[some], rest[some]
        some = _holds(leaves, lattice, cells.first[own] + rest / PARTS, size / PARTS)
        own, rest = own[some], rest[some]
    rest += PARTS * cells.first[own]
    parts = PARTS * cells.first[:, None, None] + np.moveaxis(np.indices((PARTS, PARTS)), 0, -1)
    beside = numbers_of(parts[crossed[:, 1:-1, 1:-1]], (rest[:, None] + AROUND).reshape(-1, 2)).reshape(-1, 9)
    doubtful = np.zeros(len(high), np.bool_)
    doubtful[own[(beside < 0).all(axis=1)]] = True
    return doubtful


def _hidden(high: Flags, cells: CutCells, beyond: float) -> Flags:
    """Which cells hold more than their corners say, or a line from another that goes so many parts into them."""
    corners = high[:, [0, 0, -1, -1], [0, -1, 0, -1]]
    crossed = ~(corners == corners[:, :1]).all(axis=1)
    above, below = pieces(high), pieces(~high)
    saddle = (corners[:, 0] == corners[:, 3]) & (corners[:, 1] == corners[:, 2]) & (corners[:, 0] != corners[:, 1])
    # The lines keep the high ones of a saddle apart.
    alone = (above + below == 1) & ~crossed
    simple = ((below == 1) & (above == np.where(saddle, 2, 1))) | alone
    hidden = ~simple
    # A line that bulges into a cell without a sample on its other side is seen if it and the cell beside are one.
    bulge = np.asarray((high != corners[:, :1, None]) & ~crossed[:, None, None])
    hidden |= bulge.any(axis=(1, 2))
    for axis in (1, 2):
        for end in (0, -1):
            deep = np.arange(int(beyond) + 1)
            inner = np.delete(bulge, deep if end == 0 else -1 - deep, axis)
            own = np.flatnonzero(simple & bulge.take(end, axis).any(axis=1) & ~inner.any(axis=(1, 2)))
            beside = cells.first[own] + (1 if end else -1) * (np.arange(2) == axis - 1)
            other = numbers_of(cells.first, beside)
            own, other = own[other >= 0], other[other >= 0]
            pair = (high[other], high[own]) if end == 0 else (high[own], high[other])
            both = np.concatenate([pair[0], pair[1].take(np.arange(1, high.shape[axis]), axis)], axis=axis)
            one = (pieces(both) == 1) & (pieces(~both) == 1) & crossed[other]
            hidden[own[one]] = hidden[other[one]] = False
    return np.asarray(hidden)
