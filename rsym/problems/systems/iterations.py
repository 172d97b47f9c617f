"""Solutions by steps, of systems too large to be factored; their bits are the same for any number of threads."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy import sparse
from scipy.linalg import eigvalsh_tridiagonal

from rsym.arrays import Floats, Ints
from rsym.backends.kernel import checked_threads
from rsym.sampling.compiled import loop

# Of the residual, where gradients are conjugated; rounding stops at the condition times 1e-16.
SMALL = 1e-13
MOST_STEPS = 5000
UNEVEN_STEPS = 500
BLOCKS = 8  # of rows that threads may share
# Steps of Lanczos's method to the largest and the least eigenvalue of a matrix that was factored.
LANCZOS = 8
SEED = 20130605


def conjugate_gradients(matrix: sparse.csr_matrix, right: Floats, most: int = MOST_STEPS) -> tuple[Floats, int, float]:
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
        return _iterated(product, right, most)


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


def _iterated(product: Callable[[Floats], Floats], right: Floats, most: int) -> tuple[Floats, int, float]:
    """The solution, the steps, and the condition that they show: gradients are conjugated as in Lanczos's method."""
    found, residual = np.zeros_like(right), right.copy()
    direction, size = residual.copy(), float(np.sum(residual * residual))
    enough = SMALL**2 * size
    lengths, shares = [], []
    for _ in range(most):
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


def largest_eigenvalue(product: Callable[[Floats], Floats], count: int) -> float:
    """The largest eigenvalue of a definite matrix, nearly, from below: by some steps of Lanczos's method."""
    vector = np.random.default_rng(SEED).standard_normal(count)
    vector, before, beside = vector / norm(vector), np.zeros(count), 0.0
    own, others = [], []
    for _ in range(min(LANCZOS, count)):
        image = product(vector) - beside * before
        own.append(float(np.sum(image * vector)))
        image -= own[-1] * vector
        beside = norm(image)
        if not beside > 0:
            break
        others.append(beside)
        before, vector = vector, image / beside
    return float(eigvalsh_tridiagonal(np.array(own), np.array(others[: len(own) - 1]))[-1])


def stabilised_gradients(matrix: sparse.csr_matrix, right: Floats) -> tuple[Floats, int]:
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


def norm(values: Floats) -> float:
    """The length of a vector; a sum of NumPy's, for a BLAS may share it out among threads."""
    return float(np.sqrt(np.sum(values * values)))
