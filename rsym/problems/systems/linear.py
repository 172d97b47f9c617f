"""Linear systems and eigenvalues of sparse matrices, scaled by their diagonals."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy import sparse
from scipy.linalg import eigvalsh_tridiagonal
from scipy.sparse import linalg

from rsym.arrays import Floats
from rsym.backends.kernel import checked_threads
from rsym.errors import RsymError

# Unknowns up to which a system is factored; a factor of 30 000 of degree 4 in the plane takes about a second.
DIRECT = {2: 30_000, 3: 6_000}
# Of the residual, where gradients are conjugated; rounding stops at the condition times 1e-16.
SMALL = 1e-13
MOST_STEPS = 5000
# The share of an answer that a step of refinement may change, and of the right side that may be left: systems of
# splines have up to 1e-10, singular ones more than 1e-3.
UNSURE = 1e-6
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


def solve_system(matrix: sparse.csr_matrix, right: Floats, *, definite: bool, dimension: int) -> Solved:
    """The solution: by factors of a small system or an indefinite one, else by conjugate gradients."""
    scale = scales(matrix)
    scaled = (sparse.diags(scale) @ matrix @ sparse.diags(scale)).tocsr()
    wanted = scale * right
    size = _norm(wanted)
    if size == 0:
        return Solved(np.zeros_like(right), 0, 0.0)
    steps, condition = 0, None
    if definite and len(right) > DIRECT[dimension]:
        found, steps, condition = _conjugate_gradients(scaled, wanted)
    else:
        factors = factored(scaled)
        found = factors.solve(wanted)
        correction = factors.solve(wanted - scaled @ found)
        # Of rounding alone, it is as large a share as the condition of the matrix makes it.
        if not _norm(correction) <= UNSURE * _norm(found):
            raise nearly_singular()
        found = found + correction
        if definite:
            largest, inverse = (_largest(product, len(right)) for product in (scaled.__matmul__, factors.solve))
            condition = largest * inverse
    residual = _norm(wanted - scaled @ found) / size
    if not residual <= UNSURE:
        raise nearly_singular()
    return Solved(scale * found, steps, residual, condition)


def nearly_singular() -> RsymError:
    """The error for a system whose answer is rounding."""
    return RsymError(
        "the system is nearly singular: its answer would be rounding",
        code="singular",
        remedy="give a condition that fixes the solution, a value on some part or rsym.robin with a coefficient above "
        "0; a term c*u with c near minus an eigenvalue, see modes, has no single answer",
    )


def _conjugate_gradients(matrix: sparse.csr_matrix, right: Floats) -> tuple[Floats, int, float]:
    """Sums are NumPy's, in an order of their own: a BLAS may share them out among threads. Rows are by themselves."""
    threads = checked_threads(None)
    bounds = np.linspace(0, len(right), threads + 1).astype(int)
    blocks = [matrix[first:last] for first, last in pairwise(bounds.tolist())]
    with ThreadPoolExecutor(threads) as pool:
        return _iterated(lambda x: np.concatenate(list(pool.map(lambda block: block @ x, blocks))), right)


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
