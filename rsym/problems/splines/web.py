"""Tensor B-splines on a uniform grid; those that have too little inside are parts of others: WEB splines."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import product

import numpy as np
from scipy import sparse
from scipy.spatial import cKDTree

from rsym.arrays import Flags, Floats, Ints
from rsym.errors import RsymError
from rsym.problems.splines.cardinals import digits


@dataclass(frozen=True)
class WebSplines:
    """The B-splines of a degree on a grid of cells that have something of a shape inside.

    lower, size, counts : the corner of the grid, the sides of a cell, how many cells along each axis.
    active : the numbers, in C order, of the splines that some cell touched by the shape carries.
    inner : whether each of these has a cell of which enough is inside.

    A spline that has none is no function of its own: its coefficient is that of the polynomial through those of
    the nearest block of ``(degree + 1)**dimension`` inner ones, so what is polynomial inside stays so.

    Examples
    --------
    >>> splines = WebSplines(np.zeros(2), np.ones(2), (4, 4), 1, np.arange(25), np.arange(25) >= 5)
    >>> splines.extension.shape, splines.extension[2].toarray()[0, [2, 7]].tolist()
    ((25, 20), [2.0, -1.0])
    """

    lower: Floats
    size: Floats
    counts: tuple[int, ...]
    degree: int
    active: Ints
    inner: Flags

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
        places[self.active] = np.arange(len(self.active))
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
        positions = np.stack(np.unravel_index(self.active, self.shape), axis=1)
        outer = np.flatnonzero(~self.inner)
        columns = np.cumsum(self.inner) - 1
        count = int(self.inner.sum())
        whole = np.flatnonzero(self.inner)
        rows, places, values = [whole], [columns[whole]], [np.ones(count)]
        if len(outer):
            block = self._nearest_blocks(positions, outer)
            weights = self._extrapolated(positions[outer] - block)
            local = block[:, None] + digits(self.degree + 1, self.dimension)
            flat = np.ravel_multi_index(tuple(np.moveaxis(local, -1, 0)), self.shape)
            rows.append(np.repeat(outer, weights.shape[1]))
            places.append(columns[self.number[flat]].ravel())
            values.append(weights.ravel())
        entries = np.concatenate(values), (np.concatenate(rows), np.concatenate(places))
        made = sparse.csr_matrix(entries, (len(self.active), count))
        made.sort_indices()
        return made

    def _nearest_blocks(self, positions: Ints, outer: Ints) -> Ints:
        """The first corner of the block of inner splines that is nearest to each outer one."""
        inside = np.zeros(self.shape, np.bool_)
        inside[tuple(positions[self.inner].T)] = True
        block = np.ones(tuple(count - self.degree for count in self.shape), np.bool_)
        for shift in product(range(self.degree + 1), repeat=self.dimension):
            block &= inside[tuple(slice(s, s + n) for s, n in zip(shift, block.shape, strict=True))]
        corners = np.argwhere(block)
        if not len(corners):
            raise RsymError(
                f"{' x '.join(map(str, self.counts))} cells are too few for splines of degree {self.degree}: no block "
                f"of these, {self.degree + 1} to each side, has a cell half inside the shape each",
                code="cells",
                remedy="ask for more cells, or a lower degree",
            )
        nearest = cKDTree(corners + self.degree / 2).query(positions[outer])[1]
        return np.asarray(corners[nearest], np.int64)

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
    lower: Floats, size: float, counts: Sequence[int], degree: int, touched: Ints, inner: Ints
) -> WebSplines:
    """The splines of the cells `touched` by a shape; those of the cells `inner` are functions of their own."""
    counts = tuple(int(count) for count in counts)
    shape = tuple(count + degree for count in counts)
    local = digits(degree + 1, len(counts))

    def carried(cells: Ints) -> Ints:
        found = np.zeros(shape, np.bool_)
        for index in local:
            found[tuple(np.stack(np.unravel_index(cells, counts)) + index[:, None])] = True
        return np.flatnonzero(found)

    active = carried(np.union1d(touched, inner).astype(np.int64))
    own = np.isin(active, carried(np.asarray(inner, np.int64)))
    return WebSplines(np.asarray(lower, float), np.full(len(counts), size, np.float64), counts, degree, active, own)
