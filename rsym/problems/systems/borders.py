"""Functions beside splines in a system: most are 0 but near a corner, and so are their rows and columns."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy import sparse

from rsym.arrays import Floats, Ints
from rsym.problems.splines.cardinals import derivatives
from rsym.problems.systems.cell_code import apply_forms, tested_loads
from rsym.problems.systems.forms import Assembler, CellPoints, FormAt, LoadAt, Weight

MOST_KEPT = 1 << 25  # numbers, of 256 MB


@dataclass(frozen=True)
class Beside:
    """Some functions beside splines, at those of some points where they are not all 0.

    first, count : the number of the first, and how many there are.
    where : which of the points these are, ascending.
    derivatives : of points (m, dimension) up to an order: (m, kinds, functions).
    """

    first: int
    count: int
    where: Ints
    derivatives: Callable[[Floats, int], Floats]

    @property
    def numbers(self) -> slice:
        """Theirs."""
        return slice(self.first, self.first + self.count)


@dataclass(frozen=True)
class BesideAt:
    """Functions beside splines at points (n, dimension), up to an order: each is evaluated once if all have room."""

    points: Floats
    beside: Sequence[Beside]
    order: int

    @cached_property
    def _kept(self) -> dict[int, Floats]:
        return {}

    @cached_property
    def _has_room(self) -> bool:
        dimension = self.points.shape[1]
        functions = sum(len(one.where) * one.count for one in self.beside)
        return len(derivatives(dimension, self.order)) * functions <= MOST_KEPT

    def evaluate(self, pool: Executor | None) -> None:
        """All of them, each by a thread, if there is room."""
        if self._has_room:
            list((map if pool is None else pool.map)(self.of, range(len(self.beside))))

    def of(self, number: int, some: Ints | slice = slice(None)) -> Floats:
        """The derivatives (m, kinds, functions) of one group, at some of the points where it is not 0."""
        one = self.beside[number]
        if not self._has_room:
            return one.derivatives(self.points[one.where[some]], self.order)
        if number not in self._kept:
            self._kept[number] = one.derivatives(self.points[one.where], self.order)
        return self._kept[number][some]

    def add_to(self, found: Floats, numbers: Floats) -> None:
        """Add the derivatives of their sum, with numbers, to some (kinds, n), in place."""
        for number, one in enumerate(self.beside):
            found[:, one.where] += (self.of(number)[:, : len(found)] @ numbers[one.numbers]).T


@dataclass(frozen=True)
class SystemBorder:
    """So many functions beside the splines of an assembler, at the points of a rule.

    tests : the derivatives of the weight of the splines; of more than one component those of the weight of each. The
        derivatives of functions, forms and loads of all components stand one after the other.
    """

    assembler: Assembler
    tests: Sequence[Weight]
    where: CellPoints
    functions: BesideAt
    count: int

    def loads(self, load: LoadAt, count: int) -> Floats:
        """The loads (count, functions) of so many linear forms."""
        found = np.zeros((self.count, count))
        for number, one in enumerate(self._beside):
            given = load(one.where, self.where.points[one.where])
            tested_loads(self.functions.of(number), given, found[one.numbers])
        return found.T

    def columns(self, form: FormAt, *, symmetric: bool, among: bool = True) -> sparse.csr_matrix:
        """The columns (active + functions, functions) of a form: tests are splines, then these functions.

        among : whether those of which both are these functions are asked for; else they are 0.
        """
        with self.assembler.pool() as pool:
            self.functions.evaluate(pool)
            numbers = range(len(self._beside))
            made = list((map if pool is None else pool.map)(lambda k: self._of_one(k, form, symmetric, among), numbers))
        rows, columns, values = (np.concatenate(parts) for parts in zip(_NONE, *made, strict=True))
        return sparse.coo_matrix((values, (rows, columns)), (self._active + self.count, self.count)).tocsr()

    def _of_one(self, number: int, form: FormAt, symmetric: bool, among: bool) -> tuple[Ints, Ints, Floats]:
        """The rows, columns and values of what one of `beside` has with the splines and with others."""
        one, where = self._beside[number], self.where
        points = where.points[one.where]
        functions, forms = self.functions.of(number), np.ascontiguousarray(form(one.where, points))
        loads = np.empty_like(functions)
        apply_forms(forms, functions, loads)
        cells, _, plain = where.groups
        own = CellPoints(points, where.cells[one.where], cells[plain], where.order)
        found = []
        for component, tests in enumerate(self.tests):
            acting = _rows(loads[:, component * self.assembler.kinds :][:, : self.assembler.kinds])
            across = self.assembler.columns(own, acting, tests, one.count).tocoo()
            found.append((across.row + component * self._splines, across.col + one.first, across.data))
        place = np.full(len(where.points), -1, np.int64)
        place[one.where] = np.arange(len(one.where))
        others = number + 1 if symmetric else len(self._beside)
        for k in range(others if among else 0):
            other = self._beside[k]
            mine = place[other.where]
            common = np.flatnonzero(mine >= 0)
            if len(common):
                theirs = functions if k == number else self.functions.of(k, common)
                block = np.zeros((other.count, one.count))
                tested_loads(theirs, loads if k == number else loads[mine[common]], block)
                i, j = (part.ravel() for part in np.indices(block.shape))
                found.append((i + other.first + self._active, j + one.first, block.ravel()))
                if symmetric and k < number:
                    found.append((j + one.first + self._active, i + other.first, block.ravel()))
        rows, columns, values = (np.concatenate(parts) for parts in zip(*found, strict=True))
        return rows, columns, values

    @property
    def _beside(self) -> Sequence[Beside]:
        return self.functions.beside

    @property
    def _active(self) -> int:
        return len(self.tests) * self._splines

    @property
    def _splines(self) -> int:
        return len(self.assembler.splines.active)


def _rows(loads: Floats) -> LoadAt:
    return lambda some, points: loads[some]


_NONE = np.empty(0, np.int64), np.empty(0, np.int64), np.empty(0)
