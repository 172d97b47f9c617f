"""Tensor B-splines on a uniform grid; those that have too little inside are parts of others: WEB splines."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import product

import numpy as np
from scipy import sparse
from scipy.spatial import cKDTree

from rsym.arrays import Flags, Floats, Ints
from rsym.errors import RsymError
from rsym.problems.splines.cardinals import digits
from rsym.problems.splines.joined_cells import JoinedCells, joined_cells

NOT_CLOSED = np.empty((0, 2), np.int64)


@dataclass(frozen=True)
class WebSplines:
    """The B-splines of a degree on a grid of cells that have something of a shape inside.

    lower, size, counts : the corner of the grid, the sides of a cell, how many cells along each axis.
    active : the numbers, in C order, of the splines that some cell touched by the shape carries; behind them once more
        those that are several functions.
    inner : whether each of these has a cell of which enough is inside.
    joined : which cells are touched, and from which one comes to the next along each axis within the shape.
    split, numbers : cells where functions are not those of `number`, and those that live there.

    A spline that has none is no function of its own: its coefficient is that of the polynomial through those of
    the nearest block of ``(degree + 1)**dimension`` inner ones, so what is polynomial inside stays so. A spline whose
    cells fall apart, as on both sides of a gap, is one function on each part, and blocks are looked for on its side.

    Examples
    --------
    >>> splines = web_splines(np.zeros(2), 1.0, (4, 4), 1, np.arange(16), np.arange(4, 16))
    >>> splines.extension.shape, splines.extension[2].toarray()[0, [2, 7]].tolist()
    ((25, 20), [2.0, -1.0])
    """

    lower: Floats
    size: Floats
    counts: tuple[int, ...]
    degree: int
    active: Ints
    inner: Flags
    joined: JoinedCells
    split: Ints = field(default_factory=lambda: np.empty(0, np.int64))
    numbers: Ints = field(default_factory=lambda: np.empty((0, 0), np.int64))

    @property
    def dimension(self) -> int:
        """2 in the plane, 3 in space."""
        return len(self.counts)

    @property
    def shape(self) -> tuple[int, ...]:
        """How many splines there are along each axis."""
        return tuple(count + self.degree for count in self.counts)

    @cached_property
    def number(self) -> Ints:
        """Of each spline of the grid its place among the active ones, or -1."""
        places = np.full(int(np.prod(self.shape)), -1, np.int64)
        # Of several functions the first.
        places[self.active[::-1]] = np.arange(len(self.active))[::-1]
        return places

    def cells(self, flat: Ints) -> Ints:
        """The indices (n, dimension) of cells by their numbers."""
        return np.stack(np.unravel_index(flat, self.counts), axis=1).astype(np.int64)

    def cell_of(self, points: Floats) -> Ints:
        """The numbers of the cells of points (n, dimension); of those beside the grid -1."""
        known = np.isfinite(points).all(axis=1, keepdims=True)
        place = np.floor((np.where(known, points, -np.inf) - self.lower) / self.size)
        place = np.clip(place, -1, np.array(self.counts)).astype(np.int64)
        # What lies on the far side of the grid belongs to the last cell.
        place -= (place == self.counts) & (points <= self.lower + self.size * self.counts)
        within = np.asarray(((place >= 0) & (place < self.counts)).all(axis=1), np.bool_)
        flat = np.ravel_multi_index(tuple(np.where(within[:, None], place, 0).T), self.counts)
        return np.where(within, flat, -1)

    def home_of(self, points: Floats) -> Ints:
        """As `cell_of`; where splines are split, for cells that are not touched the nearest next to them that is.

        On one side of a gap splines are not what they are on the other.
        """
        found = self.cell_of(points)
        if not len(self.split):
            return found
        there = self.joined.touched
        (lost,) = np.nonzero((found >= 0) & ~there[found])
        near = np.array(list(product((-1, 0, 1), repeat=self.dimension)))
        beside = self.cells(found[lost])[:, None] + near
        within = ((beside >= 0) & (beside < self.counts)).all(axis=2)
        flat = np.ravel_multi_index(tuple(np.where(within[..., None], beside, 0).transpose(2, 0, 1)), self.counts)
        middles = self.lower + self.size * (beside + 0.5)
        away = np.maximum(np.abs(points[lost, None] - middles) / self.size - 0.5, 0).sum(axis=2)
        away[~within | ~there[flat]] = np.inf
        best = np.argmin(away, axis=1)
        row = np.arange(len(lost))
        found[lost] = np.where(np.isfinite(away[row, best]), flat[row, best], found[lost])
        return found

    def carried(self, points: Floats) -> Flags:
        """Whether all splines of the cell of a point are active."""
        cells = self.cell_of(points)
        there = np.zeros(self.shape, np.bool_)
        there.ravel()[self.active] = True
        for axis in range(self.dimension):
            windows = np.lib.stride_tricks.sliding_window_view(there, self.degree + 1, axis)
            there = np.asarray(windows.all(axis=-1), np.bool_)
        return there.ravel()[np.maximum(cells, 0)] & (cells >= 0)

    @cached_property
    def extension(self) -> sparse.csr_matrix:
        """The coefficients (active, inner) of all active splines, given those of the inner ones."""
        columns = np.cumsum(self.inner) - 1
        count = int(self.inner.sum())
        whole, outer = np.flatnonzero(self.inner), np.flatnonzero(~self.inner)
        rows, places, values = [whole], [columns[whole]], [np.ones(count)]
        if len(outer):
            block = self._blocks[0]
            positions = np.stack(np.unravel_index(self.active[outer], self.shape), axis=1)
            weights = self._extrapolated(positions - self.cells(block))
            rows.append(np.repeat(outer, weights.shape[1]))
            places.append(columns[self.functions(block)].ravel())
            values.append(weights.ravel())
        entries = np.concatenate(values), (np.concatenate(rows), np.concatenate(places))
        made = sparse.csr_matrix(entries, (len(self.active), count))
        made.sort_indices()
        return made

    def functions(self, flat: Ints) -> Ints:
        """The functions (n, (degree + 1)**dimension) that live on cells, by their numbers; -1 where none is active."""
        local = self.cells(flat)[:, None] + digits(self.degree + 1, self.dimension)
        found: Ints = self.number[np.ravel_multi_index(tuple(np.moveaxis(local, -1, 0)), self.shape)]
        if len(self.split):
            row = self.split_row(flat)
            found[row >= 0] = self.numbers[row[row >= 0]]
        return found

    def split_row(self, flat: Ints) -> Ints:
        """Of cells their rows in `numbers`, or -1."""
        row = np.searchsorted(self.split, flat)
        return np.where(np.append(self.split, -1)[row] == flat, row, -1)

    @property
    def astray(self) -> Ints:
        """Cells, touched, from which there is no way to a block of inner functions."""
        return self._blocks[1]

    @cached_property
    def _blocks(self) -> tuple[Ints, Ints]:
        """The cell of the block of inner functions that is nearest to each outer one on its side; `astray`."""
        outer = np.flatnonzero(~self.inner)
        positions = np.stack(np.unravel_index(self.active[outer], self.shape), axis=1)
        block = self._inner_blocks
        corners = np.flatnonzero(block)
        if not len(corners):
            raise RsymError(
                f"{' x '.join(map(str, self.counts))} cells are too few for splines of degree {self.degree}: no block "
                f"of these, {self.degree + 1} to each side, has a cell half inside the shape each",
                code="cells",
                remedy="ask for more cells, or a lower degree",
            )
        middles: Floats = np.asarray(positions - self.degree / 2, np.float64)
        likely = corners[cKDTree(self.cells(corners)).query(middles)[1]]
        touched = np.flatnonzero(self.joined.touched)
        functions = self.functions(touched)
        row, place = np.nonzero(~self.inner[functions])
        order = np.argsort(functions[row, place], kind="stable")
        cells, owner = touched[row[order]], functions[row, place][order]
        starts = np.searchsorted(owner, np.append(outer, len(self.active)))
        found = self.joined.nearest(block, starts, cells, middles, likely)
        lost = found < 0
        found[lost] = likely[lost]
        return found, np.unique(cells[np.repeat(lost, np.diff(starts))])

    @cached_property
    def _inner_blocks(self) -> Flags:
        """Cells all of whose functions are inner; not those beside the shape that would have to choose between some."""
        inside = np.zeros(self.shape, np.bool_)
        inside.ravel()[self.active] = self.inner
        # Of a spline that is more than one function.
        inside.ravel()[self.active[len(np.unique(self.active)) :]] = False
        block = np.ones(self.counts, np.bool_)
        for shift in product(range(self.degree + 1), repeat=self.dimension):
            block &= inside[tuple(slice(s, s + n) for s, n in zip(shift, block.shape, strict=True))]
        found = block.ravel()
        cells = np.flatnonzero(self.joined.touched)
        functions = self.functions(cells)
        found[cells] = (self.inner[functions]).all(axis=1)
        return found

    def _extrapolated(self, places: Ints) -> Floats:
        """The values (n, (degree + 1)**dimension) at places of Lagrange's polynomials of the nodes 0, ..., degree."""
        nodes = range(self.degree + 1)
        made = np.ones((len(places), 1))
        for axis in range(self.dimension):
            t = places[:, axis]
            along = [
                np.prod([(t - other) / (node - other) for other in nodes if other != node], axis=0) for node in nodes
            ]
            made = (made[:, :, None] * np.stack(along, axis=1)[:, None, :]).reshape(len(places), -1)
        return made


def web_splines(
    lower: Floats,
    size: float,
    counts: Sequence[int],
    degree: int,
    touched: Ints,
    inner: Ints,
    closed: Ints = NOT_CLOSED,
) -> WebSplines:
    """The splines of the cells `touched` by a shape; those of the cells `inner` are functions of their own.

    closed : pairs (n, 2) of cells next to each other that are not joined.

    Examples
    --------
    >>> cells = np.array([0, 1, 3, 4])
    >>> apart = web_splines(np.zeros(2), 1.0, (5, 1), 2, cells, cells)
    >>> apart.shape, len(apart.active), apart.split.tolist()
    ((7, 3), 24, [1])
    """
    counts = tuple(int(count) for count in counts)
    local = digits(degree + 1, len(counts))
    splines = WebSplines(
        *(np.asarray(lower, float), np.full(len(counts), size, np.float64), counts, degree),
        *(np.empty(0, np.int64), np.empty(0, np.bool_)),
        joined_cells(counts, np.union1d(touched, inner).astype(np.int64), closed),
    )
    shape = splines.shape

    def carried(cells: Ints) -> Ints:
        found = np.zeros(shape, np.bool_)
        for index in local:
            found[tuple(np.stack(np.unravel_index(cells, counts)) + index[:, None])] = True
        return np.flatnonzero(found)

    active = carried(np.flatnonzero(splines.joined.touched))
    own = np.isin(active, carried(np.asarray(inner, np.int64)))
    splines = replace(splines, active=active, inner=own)
    parts = splines.joined.parts(degree, active)
    more = parts.max(axis=1)
    if not more.any():
        return splines
    places = np.stack(np.unravel_index(active, shape), axis=1)
    several, other = np.nonzero(parts > 0)
    begin = len(active) + np.cumsum(more) - more
    cells = np.ravel_multi_index(tuple((places[several] - local[other]).T), counts)
    split, row = np.unique(cells, return_inverse=True)
    numbers = splines.functions(split)
    numbers[row, other] = begin[several] + parts[several, other] - 1
    splines = replace(splines, active=np.append(active, np.repeat(active, more)), split=split, numbers=numbers)
    own = np.zeros(len(splines.active), np.bool_)
    own[splines.functions(np.asarray(inner, np.int64))] = True
    return replace(splines, inner=own)
