"""Forms at the points of a rule, and their matrices on weighted splines.

A form is given by its values (n, kinds, kinds) on the derivatives of two functions at n points, weights of the rule
in it: the integral of grad u . grad v has the weights on the diagonal, but for the first place, that of values.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Executor, ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple, TypeAlias

import numpy as np
from scipy import sparse

from rsym.arrays import Flags, Floats, Ints
from rsym.backends.kernel import checked_threads
from rsym.problems.splines.cardinals import derivatives, digits, pieces, product_terms
from rsym.problems.splines.web import WebSplines
from rsym.problems.systems.axis_sums import axis_sums
from rsym.problems.systems.cell_code import (
    LANES,
    apply_forms,
    cell_loads,
    cell_matrices,
    compressed,
    gather,
    gather_loads,
    pull_back,
    pull_back_loads,
    whole_cell_loads,
    whole_cell_matrices,
)

# Cells whose matrices are held at once; where their pieces begin depends on nothing else.
AT_ONCE = 1024
GRAIN = 64

Weight: TypeAlias = Callable[[Floats], Floats]  # points (n, dimension) to derivatives (kinds, n)


class Chunk(NamedTuple):
    """Some cells: their numbers, where their points begin in a slice of all, which have those of a plain rule."""

    cells: Ints
    begins: Ints
    plain: Flags
    points: slice


@dataclass(frozen=True)
class CellPoints:
    """Points (n, dimension) of a rule, sorted by cells, and the number of the cell of each.

    plain : cells whose points are those of the plain Gauss rule of an order, the last coordinate fastest, if there are
        as many as there.
    """

    points: Floats
    cells: Ints

    plain: Ints = field(default_factory=lambda: np.empty(0, np.int64))
    order: int = 0

    @cached_property
    def groups(self) -> tuple[Ints, Ints, Flags]:
        """The cells that have points, where those of each begin, with the end, and whether they are a plain rule's."""
        cells, begins = np.unique(self.cells, return_index=True)
        begins = np.append(begins, len(self.cells)).astype(np.int64)
        plain = np.isin(cells, self.plain) & (np.diff(begins) == self.order ** self.points.shape[1])
        return cells.astype(np.int64), begins, plain

    def chunks(self) -> Iterator[Chunk]:
        """Some cells after the others."""
        cells, begins, plain = self.groups
        for first in range(0, len(cells), AT_ONCE):
            some = slice(first, first + AT_ONCE)
            ends = begins[first : first + AT_ONCE + 1]
            yield Chunk(cells[some], ends - ends[0], plain[some], slice(int(ends[0]), int(ends[-1])))


Some: TypeAlias = slice | Ints  # which of the points of a rule
FormAt: TypeAlias = Callable[[Some, Floats], Floats]  # which points, and these, to (n, kinds, kinds)
LoadAt: TypeAlias = Callable[[Some, Floats], Floats]  # to (n, kinds, functions)


@dataclass(frozen=True)
class Assembler:
    """Matrices of forms on the splines of a grid, weighted.

    order : of the highest derivatives in the forms.
    """

    splines: WebSplines
    order: int = 1
    threads: int | None = None

    @property
    def kinds(self) -> int:
        """How many derivatives there are."""
        return len(derivatives(self.splines.dimension, self.order))

    def matrix(
        self, where: CellPoints, form: FormAt, tests: Weight, trials: Weight | None = None, *, symmetric: bool = True
    ) -> sparse.csr_matrix:
        """The matrix (active, active) of a form of functions with weights, the second of those of the first if None."""
        splines, local = self.splines, self._local
        shape = np.array(splines.shape, np.int64)
        offsets = digits(2 * splines.degree + 1, splines.dimension) - splines.degree
        stencil = np.zeros((len(splines.active), len(offsets)))
        terms = np.array(product_terms(splines.dimension, self.order), np.int64)
        wide = -(-len(local) // LANES) * LANES
        out = np.empty((AT_ONCE, len(local), wide))
        sums = axis_sums(splines.degree, where.order, splines.dimension, self.order, float(splines.size[0]))
        beside = []
        with self.pool() as pool:
            for chunk in where.chunks():
                points = np.ascontiguousarray(where.points[chunk.points])
                given = np.ascontiguousarray(form(chunk.points, points))
                first = tests(points)
                pulled = np.empty_like(given)
                pull_back(terms, first, first if trials is None else trials(points), given, pulled)
                cells = splines.cells(chunk.cells)
                whole, cut = np.flatnonzero(chunk.plain), np.flatnonzero(~chunk.plain)

                def work(
                    some: Ints,
                    chunk: Chunk = chunk,
                    cells: Ints = cells,
                    points: Floats = points,
                    pulled: Floats = pulled,
                ) -> None:
                    if chunk.plain[some[0]]:
                        tables = sums.pairs, sums.parents, sums.along, sums.places
                        scratch = np.empty((2, sums.largest))
                        whole_cell_matrices(chunk.begins, pulled, some, *tables, symmetric, scratch, out)
                        return
                    features = np.zeros((2, self.kinds, wide))
                    cell_matrices(
                        *(chunk.begins, some, cells, points, pulled, *self._grid, symmetric),
                        *(self._table(), features[0], features[1], out),
                    )

                pieces = [kind[k : k + GRAIN] for kind in (cut, whole) for k in range(0, len(kind), GRAIN)]
                _each(pool, work, pieces)
                split = splines.split_row(chunk.cells) >= 0
                gather(cells, split, out, local, shape, splines.number, symmetric, stencil)
                if split.any():
                    beside.append(_among(splines.functions(chunk.cells[split]), out[: len(split)][split], symmetric))
        made = self._compressed(stencil, offsets, shape)
        for rows, columns, values in beside:
            made = made + sparse.coo_matrix((values, (rows, columns)), made.shape).tocsr()
        return made

    def loads(self, where: CellPoints, load: LoadAt, tests: Weight, count: int = 1) -> Floats:
        """The loads (count, active) of so many linear forms."""
        total = np.zeros((count, len(self.splines.active)))
        for functions, out in self._cell_loads(where, load, tests, count):
            gather_loads(functions, out, total)
        return total

    def columns(self, where: CellPoints, load: LoadAt, tests: Weight, count: int) -> sparse.csr_matrix:
        """The same as columns (active, count): of few cells, as sparse as these are few."""
        splines, rows, values = self.splines, [np.empty(0, np.int64)], [np.empty((0, count))]
        for functions, out in self._cell_loads(where, load, tests, count):
            rows.append(functions.ravel())
            values.append(out.transpose(0, 2, 1).reshape(-1, count))
        row, column = np.concatenate(rows), np.arange(count)
        entries = np.concatenate(values).ravel(), (np.repeat(row, count), np.tile(column, len(row)))
        return sparse.coo_matrix(entries, (len(splines.active), count)).tocsr()

    def _cell_loads(self, where: CellPoints, load: LoadAt, tests: Weight, count: int) -> Iterator[tuple[Ints, Floats]]:
        """The functions (n, splines) of some cells after the others, and their loads (n, count, splines)."""
        splines, local = self.splines, self._local
        terms = np.array(product_terms(splines.dimension, self.order), np.int64)
        features = np.empty((self.kinds, len(local)))
        sums = axis_sums(splines.degree, where.order, splines.dimension, self.order, float(splines.size[0]))
        for chunk in where.chunks():
            points = np.ascontiguousarray(where.points[chunk.points])
            given = np.ascontiguousarray(load(chunk.points, points))
            pulled = np.empty_like(given)
            pull_back_loads(terms, tests(points), given, pulled)
            cells, out = splines.cells(chunk.cells), np.empty((len(chunk.cells), count, len(local)))
            whole, cut = np.flatnonzero(chunk.plain), np.flatnonzero(~chunk.plain)
            if len(whole):
                whole_cell_loads(chunk.begins, pulled, whole, sums.everywhere, out)
            cell_loads(chunk.begins, cut, cells, points, pulled, *self._grid, self._table(), features, out)
            yield splines.functions(chunk.cells), out

    @cached_property
    def _local(self) -> Ints:
        return digits(self.splines.degree + 1, self.splines.dimension)

    @property
    def _grid(self) -> tuple[Floats, Floats, Floats, Ints, Ints]:
        kinds = np.array(derivatives(self.splines.dimension, self.order), np.int64)
        return self.splines.lower, self.splines.size, pieces(self.splines.degree).T.copy(), self._local, kinds

    def _table(self) -> Floats:
        return np.empty((self.splines.dimension, self.order + 1, self.splines.degree + 1))

    @contextmanager
    def pool(self) -> Iterator[Executor | None]:
        """Threads; None for one."""
        count = checked_threads(self.threads)
        if count == 1:
            yield None
            return
        with ThreadPoolExecutor(count) as pool:
            yield pool

    def _compressed(self, stencil: Floats, offsets: Ints, shape: Ints) -> sparse.csr_matrix:
        most = int(np.count_nonzero(stencil))
        begins = np.empty(len(stencil) + 1, np.int64)
        columns, values = np.empty(most, np.int64), np.empty(most)
        compressed(stencil, self.splines.active, offsets, shape, self.splines.number, begins, columns, values)
        return sparse.csr_matrix((values, columns.astype(np.int32), begins.astype(np.int32)), (len(stencil),) * 2)


def _each(pool: Executor | None, work: Callable[[Ints], None], pieces: Sequence[Ints]) -> None:
    if pool is None:
        for piece in pieces:
            work(piece)
    else:
        list(pool.map(work, pieces))


def _among(functions: Ints, matrices: Floats, symmetric: bool) -> tuple[Ints, Ints, Floats]:
    """The rows, columns and values of the matrices of cells on their functions (n, splines)."""
    wide = functions.shape[1]
    own = matrices[:, :, :wide]
    if symmetric:
        lower = np.tril(own)
        own = lower + np.tril(own, -1).transpose(0, 2, 1)
    rows, columns = np.repeat(functions, wide, axis=1), np.tile(functions, (1, wide))
    return rows.ravel(), columns.ravel(), own.ravel()


def extended(splines: WebSplines, matrix: sparse.csr_matrix, others: WebSplines | None = None) -> sparse.csr_matrix:
    """A matrix on all active splines as one on the inner ones: E^T A E.

    Outer splines are few: only their rows and columns are multiplied.
    """
    left, right = splines.extension, (others or splines).extension
    rows, columns = splines.inner, (others or splines).inner
    tails, tops = left[~rows], right[~columns]
    middle = matrix[rows][:, columns]
    across = matrix[rows][:, ~columns] @ tops
    down = tails.T @ (matrix[~rows][:, columns] + matrix[~rows][:, ~columns] @ tops)
    return (middle + across + down).tocsr()


def applied_form(form: FormAt, given: Weight) -> LoadAt:
    """The load that a form makes of a given function, whose derivatives are (kinds, n)."""

    def load(some: Some, points: Floats) -> Floats:
        values = np.ascontiguousarray(form(some, points))
        functions = np.ascontiguousarray(given(points).T[:, :, None])
        found = np.empty((*values.shape[:2], 1))
        apply_forms(values, functions, found)
        return found

    return load


def energy(where: CellPoints, form: FormAt, given: Weight) -> float:
    """The size of what a form gives of a function and itself, its derivatives being (kinds, n).

    Examples
    --------
    >>> where = CellPoints(np.array([[0.5], [1.5]]), np.array([0, 1]))
    >>> energy(where, lambda some, points: 2 * np.ones((len(points), 1, 1)), lambda points: points.T)
    5.0
    """
    total = 0.0
    for first in range(0, len(where.points), AT_ONCE * GRAIN):
        some = slice(first, first + AT_ONCE * GRAIN)
        values = given(where.points[some])
        total += float(np.einsum("kn,nkl,ln->", values, form(some, where.points[some]), values))
    return abs(total)


def single_load(weights: Floats, kinds: int) -> LoadAt:
    """The load weights*v."""

    def load(some: Some, points: Floats) -> Floats:
        found = np.zeros((len(points), kinds, 1))
        found[:, 0, 0] = weights[some]
        return found

    return load


def transposed(form: FormAt) -> FormAt:
    """The form with tests and functions changed for each other."""
    return lambda some, points: form(some, points).transpose(0, 2, 1)
