"""Linear systems and eigenvalues of sparse matrices, scaled by their diagonals."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import partial
from typing import TypeAlias

import numpy as np
from scipy import sparse
from scipy.sparse import linalg

from rsym.arrays import Flags, Floats
from rsym.errors import RsymError, warn
from rsym.problems.systems.factors import DEPENDENT, BorderedFactors, Factors, factored
from rsym.problems.systems.iterations import (
    MOST_STEPS,
    SEED,
    conjugate_gradients,
    largest_eigenvalue,
    norm,
    stabilised_gradients,
)
from rsym.reports.numbers import short

# Unknowns up to which a system is factored; a factor of 30 000 of degree 4 in the plane takes about a second.
DIRECT = {2: 30_000, 3: 6_000}
# The same for a system that is not symmetric, and what a residual must come down to by steps, or it is factored.
# In space 6400 unknowns took 0.1 to 0.3 s by steps, 2 to 3 s by factors; in the plane 8200 took 0.2 s or more
# than 8 s by steps, 0.5 s by factors.
DIRECT_UNEVEN = {2: 200_000, 3: 3_000}
STEPS_SMALL = 1e-11
# Unknowns of a definite system up to which it is factored where steps do not end, as beside necks that are thinner than
# a cell: 80 000 of degree 4 in the plane take as long as 2000 steps and 1 GB, 11 000 of degree 3 in space as 2700.
RESCUED = {2: 200_000, 3: 12_000}
FEWER_STEPS = 2000
# The share of an answer that a step of refinement may change, and of the right side that may be left: systems of
# splines have up to 1e-10, singular ones more than 1e-3.
UNSURE, SINGULAR = 1e-6, 1e-3
# Splines that reach far beyond thin parts of a shape are nearly made up by others: a step changes their numbers by up
# to this share, though not what they add up to.
FAINT = 1e-4
NOTHING = 1e-12  # of the energy, by its root, of what an answer is added to
# Where the answer is not sure still: functions of corners of a square whose coefficient jumps, on 32 cells of degree 5.
MORE_DEPENDENT = 1e-11, 1e-9
# Of a definite matrix, from which on some functions may be dependent. On the L of 64 cells of degree 6, of which 27 of
# 39 functions are kept then, what an answer loses near a corner is 1e-9 of it and not 1e-7, as rounding made it.
DOUBTFUL = 1e12
# The same beside eigenvalues, in turn until pairs are sure: of the hexagon of 48 cells of degree 6, of 42 functions, 30
# are left by the first, and the residuals of four pairs are 1e-10; by 1e-13 36, and 7e-6.
DEPENDENT_MODES = 1e-12, 1e-10, 1e-8
MOST_SHIFTS = 30
# Functions with a mass up to which their rank is found, and the share of the largest size that is rounding.
MOST_RANKED, RANK = 1000, 1e-12

Answer: TypeAlias = Callable[[Floats], Floats]
Size: TypeAlias = Callable[[Floats], float]


@dataclass(frozen=True)
class Solved:
    """Answers of a system, and how they were found: steps is 0 where the matrix was factored.

    condition : of the matrix scaled by its diagonal, an estimate from below; None where it is not definite.
    stopped : whether steps came to their end before the residual was small.
    again : the answer for another right side, nearly.
    """

    values: Floats
    steps: int
    residual: float
    condition: float | None = None
    stopped: bool = False
    again: Answer | None = None


def scales(matrix: sparse.csr_matrix) -> Floats:
    """One over the root of the diagonal; of a row without one, 1."""
    diagonal = np.abs(matrix.diagonal())
    return np.where(diagonal > 0, 1 / np.sqrt(np.where(diagonal > 0, diagonal, 1)), 1.0)


def solve_system(
    matrix: sparse.csr_matrix,
    right: Floats,
    *,
    definite: bool,
    dimension: int,
    symmetric: bool = True,
    last: int = 0,
    held: bool = False,
    size: Size | None = None,
    beside: Callable[[], float] = lambda: 0.0,
    known: Factors | None = None,
) -> Solved:
    """The solution: by factors of a small system or an indefinite one, else by conjugate gradients.

    Of one that is not symmetric by gradients conjugated and stabilised, and by factors where these are slow.

    last : of so many unknowns at the end those are 0 whose functions the others make up but for rounding.
    held : conditions fix the solution, so what is not sure is what functions share of it.
    size : of what numbers of all functions add up to: it tells what is not sure where no energy does.
    beside : asked for the root of the energy of what the solution is added to: what is not sure may be nothing to it.
    known : the factors of the matrix as it is scaled; it is known that the others do not make up the last ones then.
    """
    scale = scales(matrix)
    scaled = (sparse.diags(scale) @ matrix @ sparse.diags(scale)).tocsr()
    wanted = scale * right
    amount = norm(wanted)
    if amount == 0:
        return Solved(np.zeros_like(right), 0, 0.0)
    bordered: BorderedFactors | None = None
    without = partial(_without, matrix, right, size, definite, dimension, symmetric, held, beside)
    if last and not definite and known is None:
        with suppress(RsymError):  # those before them may be no system by themselves
            bordered = BorderedFactors.of(scaled, last)
            own = bordered.independent()
            if not own.all():
                return without(own, scaled, bordered)
    direct = DIRECT if definite and not last else RESCUED if definite else DIRECT_UNEVEN
    steps, stopped, rescued = 0, False, not definite or len(right) <= RESCUED[dimension]
    found: Floats | None = None
    condition: float | None = None
    if (definite or not symmetric) and len(right) > direct[dimension]:
        found, steps, condition, again = _by_steps(scaled, wanted, definite, FEWER_STEPS if rescued else MOST_STEPS)
        stopped = not norm(wanted - scaled @ found) <= STEPS_SMALL * amount
    if found is None or (stopped and rescued):
        steps, stopped = 0, False
        of_scaled: Size | None = None if size is None else lambda values: size(scale * values)
        if last and definite and known is None:
            bordered = BorderedFactors.of(scaled, last)
        factors = known or (bordered if definite else None) or factored(scaled)
        found, condition, again = _by_factors(factors, scaled, wanted, of_scaled, definite, last, held, beside)
    doubtful = found is None or (condition is not None and condition > DOUBTFUL)
    if doubtful and bordered is not None and not steps:
        for dependent in (DEPENDENT, *(MORE_DEPENDENT if found is None else ())):
            own = bordered.independent(dependent)
            if not own.all():
                with suppress(*([RsymError] if dependent < MORE_DEPENDENT[-1] else [])):
                    return without(own, scaled, bordered)
    if found is None:
        raise nearly_singular()
    residual = norm(wanted - scaled @ found) / amount
    if not residual <= UNSURE and not residual * amount <= NOTHING * beside():
        raise nearly_singular()
    if stopped:
        warn(
            f"conjugate gradients came to their end after {steps} steps, {short(residual)} of the right side is left: "
            "the matrix is nearly singular, as beside parts thinner than a cell; give other cells or a lower degree"
        )
    return Solved(scale * found, steps, residual, condition, stopped, lambda other: scale * again(scale * other))


def _by_steps(
    matrix: sparse.csr_matrix, right: Floats, definite: bool, most: int
) -> tuple[Floats, int, float | None, Answer]:
    """The solution, the steps, the condition of a definite matrix, and what answers other right sides."""
    if definite:
        return *conjugate_gradients(matrix, right, most), lambda other: conjugate_gradients(matrix, other, most)[0]
    found, steps = stabilised_gradients(matrix, right)
    return found, steps, None, lambda other: stabilised_gradients(matrix, other)[0]


def _by_factors(
    factors: Factors,
    matrix: sparse.csr_matrix,
    right: Floats,
    size: Size | None,
    definite: bool,
    last: int,
    held: bool,
    beside: Callable[[], float],
) -> tuple[Floats | None, float | None, Answer]:
    """The solution, refined once, None where it is not sure: some of the last functions may be to blame.

    And the condition of a definite matrix, nearly, and what answers other right sides.
    """
    found: Floats = factors.solve(right)
    correction = factors.solve(right - matrix @ found)
    # Of rounding alone, it is as large a share as the condition of the matrix makes it. Where functions are nearly made
    # up by others, it is large in what amounts to nothing: it has no size, and by its energy it is small. That of an
    # answer which is not sure is small too; without sizes it counts where the first unknowns alone have none.
    unsure = norm(correction) / norm(found)
    if unsure > UNSURE:
        energy = np.sqrt(abs(np.sum(correction * (matrix @ correction))))
        of_energy = energy / np.sqrt(abs(np.sum(found * right)))
        if (energy if definite or size is None else size(correction)) <= NOTHING * beside():
            unsure = 0.0
        elif size is not None:
            of_size = size(correction) / size(found)
            unsure = max(of_size, of_energy) if definite else of_size
        elif definite and (last or (held and unsure <= FAINT)):
            if isinstance(factors, BorderedFactors):
                first = slice(len(right) - last)
                known, some = factors.first, (matrix[first, first], right[first])
                if _by_factors(known, *some, None, definite, 0, held, beside)[0] is None:
                    raise nearly_singular()
            unsure = of_energy
    if not unsure <= UNSURE:
        return None, None, factors.solve
    if not definite:
        return found + correction, None, factors.solve
    largest, inverse = (largest_eigenvalue(product, len(right)) for product in (matrix.__matmul__, factors.solve))
    return found + correction, largest * inverse, factors.solve


def _without(
    matrix: sparse.csr_matrix,
    right: Floats,
    size: Size | None,
    definite: bool,
    dimension: int,
    symmetric: bool,
    held: bool,
    beside: Callable[[], float],
    own: Flags,
    scaled: sparse.csr_matrix,
    bordered: BorderedFactors,
) -> Solved:
    """The solution where those of the last unknowns are 0 that are not independent."""
    kept = np.append(np.ones(len(right) - len(own), np.bool_), own)

    def whole(values: Floats) -> Floats:
        found = np.zeros_like(right)
        found[kept] = values
        return found

    some = solve_system(
        matrix[kept][:, kept],
        right[kept],
        definite=definite,
        dimension=dimension,
        symmetric=symmetric,
        last=int(own.sum()),
        held=held,
        known=bordered.without(own) if definite else factored(scaled[kept][:, kept]),
        beside=beside,
        size=None if size is None else lambda values: size(whole(values)),
    )
    again = some.again
    return replace(
        some, values=whole(some.values), again=None if again is None else lambda other: whole(again(other[kept]))
    )


def nearly_singular() -> RsymError:
    """The error for a system whose answer is rounding."""
    return RsymError(
        "the system is nearly singular: its answer would be rounding",
        code="singular",
        remedy="give a condition that fixes the solution, a value on some part or rsym.robin with a coefficient above "
        "0; a term c*u with c near minus an eigenvalue, see modes, has no single answer; where a part of the shape is "
        "thinner than a cell, a lower degree= or smaller cells",
    )


def eigenpairs(
    stiffness: sparse.csr_matrix,
    mass: sparse.csr_matrix,
    count: int,
    shift: float = 0.0,
    step: float = 1.0,
    *,
    last: int = 0,
) -> tuple[Floats, Floats]:
    """The least eigenvalues (count,), ascending, and the vectors (n, count), of K x = lambda M x, M semidefinite.

    By steps, each four times the one before, the shift goes down until K - shift*M has no pivot below 0: by Sylvester's
    law none of the eigenvalues lies below it then, and those nearest to it are the least. Of the last unknowns those
    are 0 whose functions the others nearly make up, more of them until the residual of each pair is small.
    """
    kept = np.ones(stiffness.shape[0], np.bool_)
    for dependent in (*DEPENDENT_MODES[: len(DEPENDENT_MODES) if last else 0], None):
        try:
            values, some = _eigenpairs(stiffness[kept][:, kept], mass[kept][:, kept], count, shift, step)
            break
        except RsymError:
            if dependent is None:
                raise
        scale = sparse.diags(scales(stiffness - shift * mass))
        scaled = (scale @ (stiffness - shift * mass) @ scale).tocsr()
        kept[len(kept) - last :] = BorderedFactors.of(scaled, last).independent(dependent)
    vectors = np.zeros((len(kept), count))
    vectors[kept] = some
    return values, vectors


def _eigenpairs(
    stiffness: sparse.csr_matrix, mass: sparse.csr_matrix, count: int, shift: float, step: float
) -> tuple[Floats, Floats]:
    """The same of all functions, the vectors orthogonal by what is definite: the mass may be all but rounding."""
    size = step
    for _ in range(MOST_SHIFTS):
        scale = sparse.diags(scales(stiffness - shift * mass))
        k, m = (scale @ stiffness @ scale).tocsc(), (scale @ mass @ scale).tocsc()
        definite = (k - shift * m).tocsc()
        factors = _definite_factors(definite)
        if factors is not None:
            break
        shift, step = shift - step, 4 * step
    else:
        raise RsymError(
            "no number lies below all eigenvalues",
            code="singular",
            remedy="a mass on all of the shape bounds them; on parts of the boundary coefficients must not be below 0",
        )
    inverse = linalg.LinearOperator(k.shape, factors.solve, dtype=float)
    start = factors.solve(m @ np.random.default_rng(SEED).standard_normal(k.shape[0]))
    shares, vectors = linalg.eigsh(m, count, definite, Minv=inverse, v0=start, which="LA", tol=1e-14)
    above, vectors = 1 / shares[::-1], vectors[:, ::-1]
    images = definite @ vectors
    left = above * np.linalg.norm(images - above * (m @ vectors), axis=0) / np.linalg.norm(images, axis=0)
    values = shift + above
    if not np.all(left <= UNSURE * max(size, float(np.abs(values).max()))):
        raise RsymError(
            f"an eigenvalue near {short(float(values[left.argmax()]))} would be rounding",
            code="singular",
            remedy="a lower degree= or other cells; fewer modes",
        )
    return values, np.asarray(scale @ vectors)


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
