"""Linear systems and eigenvalues of sparse matrices, scaled by their diagonals."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from scipy import sparse
from scipy.linalg import eigvalsh_tridiagonal
from scipy.sparse import linalg

from rsym.arrays import Flags, Floats, Ints
from rsym.backends.kernel import checked_threads
from rsym.errors import RsymError
from rsym.sampling.compiled import loop

# Unknowns up to which a system is factored; a factor of 30 000 of degree 4 in the plane takes about a second.
DIRECT = {2: 30_000, 3: 6_000}
# The same for a system that is not symmetric, and what its residual must come down to within so many steps, or it is
# factored. In space 6400 unknowns took 0.1 to 0.3 s by steps, 2 to 3 s by factors; in the plane 8200 took 0.2 s or more
# than 8 s by steps, 0.5 s by factors.
DIRECT_UNEVEN = {2: 200_000, 3: 3_000}
UNEVEN_SMALL, UNEVEN_STEPS = 1e-11, 500
# Of the residual, where gradients are conjugated; rounding stops at the condition times 1e-16.
SMALL = 1e-13
MOST_STEPS = 5000
# The share of an answer that a step of refinement may change, and of the right side that may be left: systems of
# splines have up to 1e-10, singular ones more than 1e-3.
UNSURE, SINGULAR = 1e-6, 1e-3
DEPENDENT = 1e-13  # of a function that others do not make up: of the square of its size
BLOCKS = 8  # of rows that threads may share
MOST_SHIFTS = 30
# Steps of Lanczos's method to the largest and the least eigenvalue of a matrix that was factored.
LANCZOS = 8
# Functions with a mass up to which their rank is found, and the share of the largest size that is rounding.
MOST_RANKED, RANK = 1000, 1e-12
SEED = 20130605


@dataclass(frozen=True)
class Solved:
    """Answers of a system, and how they were found: steps is 0 where the matrix was factored.

    condition : of the matrix scaled by its diagonal, an estimate from below; None where it is not definite.
    """

    values: Floats
    steps: int
    residual: float
    condition: float | None = None


def scales(matrix: sparse.csr_matrix) -> Floats:
    """One over the root of the diagonal; of a row without one, 1."""
    diagonal = np.abs(matrix.diagonal())
    return np.where(diagonal > 0, 1 / np.sqrt(np.where(diagonal > 0, diagonal, 1)), 1.0)


def factored(matrix: sparse.csr_matrix) -> linalg.SuperLU:
    """The factors of a matrix that is symmetric in its pattern."""
    try:
        return linalg.splu(
            matrix.tocsc(), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True}
        )
    except RuntimeError as error:
        raise RsymError(
            "the system has no answer, or more than one",
            code="singular",
            remedy="give a condition that fixes the solution: a value on some part, rsym.robin, or a term c*u",
        ) from error


def solve_system(
    matrix: sparse.csr_matrix,
    right: Floats,
    *,
    definite: bool,
    dimension: int,
    symmetric: bool = True,
    last: int = 0,
) -> Solved:
    """The solution: by factors of a small system or an indefinite one, else by conjugate gradients.

    Of one that is not symmetric by gradients conjugated and stabilised, and by factors where these are slow.

    last : of so many unknowns at the end those are 0 whose functions the others make up but for rounding.
    """
    scale = scales(matrix)
    scaled = (sparse.diags(scale) @ matrix @ sparse.diags(scale)).tocsr()
    wanted = scale * right
    size = _norm(wanted)
    if size == 0:
        return Solved(np.zeros_like(right), 0, 0.0)
    found: Floats | None
    steps, condition = 0, None
    if definite and len(right) > DIRECT[dimension]:
        found, steps, condition = _conjugate_gradients(scaled, wanted)
    elif not symmetric and len(right) > DIRECT_UNEVEN[dimension]:
        made, steps = _stabilised(scaled, wanted)
        found = made
        if not _norm(wanted - scaled @ made) <= UNEVEN_SMALL * size:
            found, _ = _by_factors(scaled, wanted, definite=definite, dimension=dimension, last=last)
            steps = 0
    else:
        found, condition = _by_factors(scaled, wanted, definite=definite, dimension=dimension, last=last)
    if found is None:
        return _without(matrix, right, last, definite=definite, dimension=dimension, symmetric=symmetric)
    residual = _norm(wanted - scaled @ found) / size
    if not residual <= UNSURE:
        raise nearly_singular()
    return Solved(scale * found, steps, residual, condition)


def _by_factors(
    matrix: sparse.csr_matrix, right: Floats, *, definite: bool, dimension: int, last: int
) -> tuple[Floats | None, float | None]:
    """The solution, refined once, None where it is not sure: some of the last functions may be to blame.

    And the condition of a definite matrix, nearly.
    """
    try:
        factors = factored(matrix)
    except RsymError:
        if not last:
            raise
        return None, None
    found: Floats = factors.solve(right)
    correction = factors.solve(right - matrix @ found)
    # Of rounding alone, it is as large a share as the condition of the matrix makes it. Where the last functions
    # are nearly made up by others, it is large in what amounts to nothing: by its energy it is small. That of an
    # answer which is not sure is small too; then the first unknowns alone have none.
    unsure = _norm(correction) / _norm(found)
    first = slice(len(right) - last)
    if last and unsure > UNSURE and (definite or unsure < SINGULAR or _coercive(matrix[first, first])):
        solve_system(matrix[first, first], right[first], definite=definite, dimension=dimension)
        unsure = np.sqrt(abs(np.sum(correction * (matrix @ correction)) / np.sum(found * right)))
    if not unsure <= UNSURE:
        return None, None
    if not definite:
        return found + correction, None
    largest, inverse = (_largest(product, len(right)) for product in (matrix.__matmul__, factors.solve))
    return found + correction, largest * inverse


def _coercive(matrix: sparse.csr_matrix) -> bool:
    """Whether the symmetric part of a matrix is definite: the pivots are all positive."""
    try:
        return bool((factored(((matrix + matrix.T) / 2).tocsr()).U.diagonal() > 0).all())
    except RsymError:
        return False


def _without(
    matrix: sparse.csr_matrix, right: Floats, last: int, *, definite: bool, dimension: int, symmetric: bool
) -> Solved:
    """The solution where those of the last unknowns are 0 that others make up for; refused if none of them is such."""
    scale = sparse.diags(scales(matrix))
    own = independent((scale @ matrix @ scale).tocsr(), last) if last else np.empty(0, np.bool_)
    if own.all():
        raise nearly_singular()
    kept = np.append(np.ones(len(right) - last, np.bool_), own)
    count = int(own.sum())
    some = solve_system(
        matrix[kept][:, kept], right[kept], definite=definite, dimension=dimension, symmetric=symmetric, last=count
    )
    values = np.zeros_like(right)
    values[kept] = some.values
    return replace(some, values=values)


def independent(scaled: sparse.csr_matrix, last: int) -> Flags:
    """Which of the last functions of a matrix, its diagonal 1, the others and those before do not make up.

    Examples
    --------
    >>> rows = np.array([[1, 0, 0.6, 0.6], [0, 1, 0.8, 0], [0.6, 0.8, 1, 0.36], [0.6, 0, 0.36, 1]])
    >>> independent(sparse.csr_matrix(rows), 2).tolist()
    [False, True]
    """
    first = scaled.shape[0] - last
    beside = scaled[:first, first:].toarray()
    rest = scaled[first:, first:].toarray() - scaled[first:, :first] @ factored(scaled[:first, :first]).solve(beside)
    kept = np.zeros(last, np.bool_)
    for _ in range(last):
        pivots = np.where(kept, 0.0, np.abs(rest.diagonal()))
        most = int(pivots.argmax())
        if pivots[most] <= DEPENDENT:
            break
        kept[most] = True
        rest = rest - np.outer(rest[:, most], rest[most]) / rest[most, most]
    return kept


def nearly_singular() -> RsymError:
    """The error for a system whose answer is rounding."""
    return RsymError(
        "the system is nearly singular: its answer would be rounding",
        code="singular",
        remedy="give a condition that fixes the solution, a value on some part or rsym.robin with a coefficient above "
        "0; a term c*u with c near minus an eigenvalue, see modes, has no single answer",
    )


def _conjugate_gradients(matrix: sparse.csr_matrix, right: Floats) -> tuple[Floats, int, float]:
    """Sums are NumPy's, in an order of their own: a BLAS may share them out among threads.

    To read a matrix takes most of the time: of a symmetric one half is enough. Its rows are in blocks, as many for any
    number of threads; what these make is added in their order.
    """
    lower = sparse.tril(matrix, format="csr")  # the diagonal of a definite matrix is there
    lower.sort_indices()
    bounds = np.linspace(0, len(right), BLOCKS + 1).astype(int)
    blocks = [_Block.of(lower, first, last) for first, last in pairwise(bounds.tolist()) if last > first]

    def product(x: Floats) -> Floats:
        total = np.zeros_like(x)
        for block, _ in zip(blocks, pool.map(lambda block: block.multiply(x), blocks), strict=True):
            total[block.least : block.last] += block.out
        return total

    with ThreadPoolExecutor(checked_threads(None)) as pool:
        return _iterated(product, right)


@dataclass(frozen=True, eq=False)
class _Block:
    """Rows of the lower triangle of a symmetric matrix, and room for what they and their mirror images make.

    Columns count from the least of all rows; in each row they ascend, and the last is that of the diagonal.
    """

    least: int
    last: int
    begins: Ints
    columns: Ints
    values: Floats
    out: Floats

    @classmethod
    def of(cls, lower: sparse.csr_matrix, first: int, last: int) -> _Block:
        """Some rows of a triangle."""
        begins = lower.indptr[first : last + 1].astype(np.int64)
        some = slice(begins[0], begins[-1])
        least = int(lower.indices[some].min(initial=first))
        columns: Ints = (lower.indices[some] - least).astype(np.int32)
        return cls(least, last, begins - begins[0], columns, lower.data[some], np.empty(last - least))

    def multiply(self, x: Floats) -> None:
        """Put the product from the least column to the last row into its room."""
        lower_product(self.begins, self.columns, self.values, x[self.least : self.last], self.out)


@loop
def lower_product(begins: Ints, columns: Ints, values: Floats, x: Floats, out: Floats) -> None:
    """The product of the last rows of a lower triangle, and of their mirror images, with x; two sums at once."""
    for k in range(len(out)):
        out[k] = 0.0
    above = len(x) - (len(begins) - 1)
    for row in range(len(begins) - 1):
        own, one, other = x[above + row], 0.0, 0.0
        k, end = begins[row], begins[row + 1] - 1
        while k + 1 < end:
            i, j, a, b = columns[k], columns[k + 1], values[k], values[k + 1]
            one += a * x[i]
            other += b * x[j]
            out[i] += a * own
            out[j] += b * own
            k += 2
        if k < end:
            one += values[k] * x[columns[k]]
            out[columns[k]] += values[k] * own
        out[above + row] += one + other + values[end] * own


def _iterated(product: Callable[[Floats], Floats], right: Floats) -> tuple[Floats, int, float]:
    """The solution, the steps, and the condition that they show: gradients are conjugated as in Lanczos's method."""
    found, residual = np.zeros_like(right), right.copy()
    direction, size = residual.copy(), float(np.sum(residual * residual))
    enough = SMALL**2 * size
    lengths, shares = [], []
    for _ in range(MOST_STEPS):
        image = product(direction)
        length = size / float(np.sum(direction * image))
        found += length * direction
        residual -= length * image
        size, before = float(np.sum(residual * residual)), size
        lengths.append(length)
        if size <= enough:
            break
        shares.append(size / before)
        direction = residual + shares[-1] * direction
    steps = len(lengths)
    inverse, ratios = 1 / np.array(lengths), np.array(shares[: steps - 1])
    own = inverse + np.concatenate([[0.0], ratios * inverse[:-1]])
    values = eigvalsh_tridiagonal(own, np.sqrt(ratios) * inverse[:-1])
    return found, steps, float(values[-1] / values[0])


def _largest(product: Callable[[Floats], Floats], count: int) -> float:
    """The largest eigenvalue of a definite matrix, nearly, from below: by some steps of Lanczos's method."""
    vector = np.random.default_rng(SEED).standard_normal(count)
    vector, before, beside = vector / _norm(vector), np.zeros(count), 0.0
    own, others = [], []
    for _ in range(min(LANCZOS, count)):
        image = product(vector) - beside * before
        own.append(float(np.sum(image * vector)))
        image -= own[-1] * vector
        beside = _norm(image)
        if not beside > 0:
            break
        others.append(beside)
        before, vector = vector, image / beside
    return float(eigvalsh_tridiagonal(np.array(own), np.array(others[: len(own) - 1]))[-1])


def _stabilised(matrix: sparse.csr_matrix, right: Floats) -> tuple[Floats, int]:
    """By van der Vorst's BiCGSTAB (1992); rows are by themselves, whatever thread they are of."""
    threads = checked_threads(None)
    bounds = np.linspace(0, len(right), threads + 1).astype(int)
    blocks = [matrix[first:last] for first, last in pairwise(bounds.tolist())]
    with ThreadPoolExecutor(threads) as pool:
        return _gradients_stabilised(lambda x: np.concatenate(list(pool.map(lambda block: block @ x, blocks))), right)


def _gradients_stabilised(product: Callable[[Floats], Floats], right: Floats) -> tuple[Floats, int]:
    """Where a product of the method vanishes it ends."""
    found, residual, shadow = np.zeros_like(right), right.copy(), right
    direction, size = residual.copy(), np.sum(shadow * residual)
    enough = SMALL**2 * size
    for step in range(1, UNEVEN_STEPS + 1):
        image = product(direction)
        with np.errstate(all="ignore"):
            length = size / np.sum(shadow * image)
            half = residual - length * image
            turned = product(half)
            share = np.sum(turned * half) / np.sum(turned * turned)
            if not np.isfinite(length) or not np.isfinite(share):
                return found, step
            found += length * direction + share * half
            residual = half - share * turned
            if np.sum(residual * residual) <= enough:
                return found, step
            size, before = np.sum(shadow * residual), size
            direction = residual + (size / before) * (length / share) * (direction - share * image)
    return found, UNEVEN_STEPS


def _norm(values: Floats) -> float:
    return float(np.sqrt(np.sum(values * values)))


def eigenpairs(
    stiffness: sparse.csr_matrix, mass: sparse.csr_matrix, count: int, shift: float = 0.0, step: float = 1.0
) -> tuple[Floats, Floats]:
    """The least eigenvalues (count,), ascending, and the vectors (n, count), of K x = lambda M x, M semidefinite.

    By steps, each four times the one before, the shift goes down until K - shift*M has no pivot below 0: by Sylvester's
    law none of the eigenvalues lies below it then, and those nearest to it are the least.
    """
    for _ in range(MOST_SHIFTS):
        scale = sparse.diags(scales(stiffness - shift * mass))
        k, m = (scale @ stiffness @ scale).tocsc(), (scale @ mass @ scale).tocsc()
        factors = _definite_factors((k - shift * m).tocsc())
        if factors is not None:
            break
        shift, step = shift - step, 4 * step
    else:
        raise RsymError(
            "no number lies below all eigenvalues",
            code="singular",
            remedy="a mass on all of the shape bounds them; on parts of the boundary coefficients must not be below 0",
        )
    operator = linalg.LinearOperator(k.shape, factors.solve, dtype=float)
    start = np.random.default_rng(SEED).standard_normal(k.shape[0])
    values, vectors = linalg.eigsh(k, count, m, sigma=shift, OPinv=operator, v0=start, tol=1e-14)
    order = np.argsort(values)
    return values[order], np.asarray(scale @ vectors[:, order])


def _definite_factors(matrix: sparse.csc_matrix) -> linalg.SuperLU | None:
    """The factors of a symmetric matrix if all of its pivots, those of the diagonal, are above 0."""
    try:
        factors = factored(matrix)
    except RsymError:
        return None
    own = np.array_equal(factors.perm_r, factors.perm_c)
    return factors if own and np.all(factors.U.diagonal() > 0) else None


def rank(mass: sparse.csr_matrix) -> int:
    """How many eigenvalues a mass has that is on few functions; of one on many, how many these are."""
    on = np.flatnonzero(mass.diagonal() > 0)
    if len(on) > MOST_RANKED:
        return len(on)
    scale = sparse.diags(scales(mass))
    sizes = np.linalg.eigvalsh((scale @ mass @ scale).tocsr()[on][:, on].toarray())
    return int(np.count_nonzero(sizes > RANK * sizes[-1])) if len(on) else 0
