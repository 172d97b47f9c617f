"""Families of functions that are splines of one grid times a weight: one for each kink beside the splines themselves.

Of those of a kink sums are functions of a system, splines of larger cells.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import reduce
from operator import add

import numpy as np
from scipy import sparse

from rsym.arrays import Floats
from rsym.problems.splines.web import WebSplines
from rsym.problems.systems.borders import SystemBorder
from rsym.problems.systems.forms import Assembler, CellPoints, FormAt, LoadAt, Some, Weight, transposed

# So many cells wide are those of kinks, wider where they would be more than so many, which are dense rows. A disc of
# k = 10 in one of k = 1, errors on 24 cells of degree 4, 32 and 64 of degree 6: 2 cells wide 3.4e-6, 6.0e-8 in 1.7 s,
# 5.9e-10 in 17 s; 4 wide 5.9e-6, 1.6e-7 in 1.4 s, 1.6e-9 in 5 s; 1 wide 1.1e-8 in 10 s on 32.
WIDER, MOST = 2, 400


@dataclass(frozen=True)
class Family:
    """Splines times a weight, whose derivatives are `tests`; sums of the active ones are functions of a system.

    sums : (active, functions)
    component : of what is sought theirs, in the order of forms.
    """

    tests: Weight
    sums: sparse.csr_matrix
    component: int = 0

    @property
    def count(self) -> int:
        """How many functions there are."""
        return int(self.sums.shape[1])

    def loads(self, assembler: Assembler, where: CellPoints, load: LoadAt, count: int) -> Floats:
        """The loads (count, functions) of linear forms."""
        return np.asarray(assembler.loads(where, load, self.tests, count) @ self.sums)

    def with_other(
        self, other: Family, assembler: Assembler, where: CellPoints, form: FormAt, symmetric: bool
    ) -> sparse.csr_matrix:
        """The matrix of a form, tests of this family, functions of another."""
        same = other is self
        trials = None if same else other.tests
        rows, columns = (
            slice(k * assembler.kinds, (k + 1) * assembler.kinds) for k in (self.component, other.component)
        )

        def own(some: Some, points: Floats) -> Floats:
            return form(some, points)[:, rows, columns]

        made = assembler.matrix(where, own, self.tests, trials, symmetric=symmetric and same)
        return (self.sums.T @ made @ other.sums).tocsr()


def wider_sums(splines: WebSplines, families: int, times: int = WIDER) -> sparse.csr_matrix:
    """The splines of cells so many times as wide, or more for many families, as sums of the active ones of a grid.

    Examples
    --------
    >>> from rsym.problems.splines.web import web_splines
    >>> splines = web_splines(np.zeros(1), 1.0, (4,), 1, np.arange(4), np.arange(4))
    >>> wider_sums(splines, 1, 2).toarray()
    array([[1. , 0. , 0. ],
           [0.5, 0.5, 0. ],
           [0. , 1. , 0. ],
           [0. , 0.5, 0.5],
           [0. , 0. , 1. ]])
    """
    counts, degree = np.array(splines.counts), splines.degree
    while times < counts.max() and families * np.prod(-(-counts // times) + degree) > MOST:
        times += 1
    whole = reduce(lambda one, other: sparse.kron(one, other, format="csr"), (_along(n, degree, times) for n in counts))
    sums = whole[splines.active]
    used = np.bincount(sums[splines.inner].indices, minlength=sums.shape[1]) > 0
    return sums[:, used].tocsr()


def _along(count: int, degree: int, times: int) -> sparse.csr_matrix:
    """Along an axis: (splines, wider splines)."""
    mask = np.array([1.0])
    for _ in range(degree + 1):
        mask = np.convolve(mask, np.ones(times))
    mask = mask / times**degree
    wider = -(-count // times) + degree
    found = sparse.lil_matrix((count + degree, wider))
    for number in range(wider):
        first = (number - degree) * times + degree
        some = np.arange(max(first, 0), min(first + len(mask), count + degree))
        found[some, number] = mask[some - first]
    return found.tocsr()


def with_families(
    bordered: sparse.csr_matrix,
    families: Sequence[Family],
    assembler: Assembler,
    forms: Sequence[tuple[CellPoints, FormAt]],
    border: Callable[[CellPoints], SystemBorder] | None,
    symmetric: bool,
    components: int = 1,
) -> sparse.csr_matrix:
    """A matrix of the first family of each component, and of functions beside if they have a `border`, with others."""
    plain, folds = families[:components], families[components:]

    def among(tests: Family, functions: Family) -> sparse.csr_matrix:
        return reduce(add, (tests.with_other(functions, assembler, *part, symmetric) for part in forms))

    def beside(tests: Family, turned: bool) -> list[sparse.csr_matrix]:
        """Of tests of a family and functions beside, or `turned` the other way round."""
        if border is None:
            return []
        made = []
        for where, form in forms:
            acting = _first(tests.component * assembler.kinds, transposed(form) if turned else form)
            made.append(replace(border(where), tests=(tests.tests,)).columns(acting, symmetric=False, among=False))
        return [tests.sums.T @ reduce(add, made)[: tests.sums.shape[0]]]

    right, below = [], []
    for fold in folds:
        above = [among(one, fold) for one in plain]
        right.append(sparse.vstack([*above, *(one.T for one in beside(fold, turned=True))]))
        left = [] if symmetric else [*(among(fold, one) for one in plain), *beside(fold, turned=False)]
        below.append(right[-1].T if symmetric else sparse.hstack(left))
    own: list[list[sparse.csr_matrix]] = []
    for number, fold in enumerate(folds):
        own.append([own[k][number].T if symmetric and k < number else among(fold, folds[k]) for k in range(len(folds))])
    rows = [[bordered, *right], *([left, *row] for left, row in zip(below, own, strict=True))]
    return sparse.bmat(rows, format="csr")


def _first(rows: int, form: FormAt) -> FormAt:
    """The form with so many rows behind the others."""
    return lambda some, points: np.roll(form(some, points), -rows, axis=1) if rows else form(some, points)
