"""Factors of sparse matrices that are symmetric in their pattern, those of the last functions by what others leave."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np
from scipy import sparse
from scipy.sparse import linalg

from rsym.arrays import Flags, Floats
from rsym.errors import RsymError

DEPENDENT = 1e-13  # of a function that others do not make up: of the square of its size


class Factors(Protocol):
    """What answers right sides."""

    def solve(self, right: Floats) -> Floats:
        """The answer."""


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


@dataclass(frozen=True, eq=False)
class BorderedFactors:
    """Factors of a matrix [[A, B], [D, C]]: those of A, and the complement C - D A^-1 B.

    down : D.
    made_up : A^-1 B, what others make up of the last functions.
    kept : which of these there are.
    """

    first: linalg.SuperLU
    down: sparse.csr_matrix
    made_up: Floats
    complement: Floats
    kept: Flags

    @classmethod
    def of(cls, matrix: sparse.csr_matrix, last: int) -> BorderedFactors:
        """Those of a matrix with so many last functions."""
        split = matrix.shape[0] - last
        first, down = factored(matrix[:split, :split]), matrix[split:, :split]
        across = matrix[:split, split:].toarray()
        made_up = first.solve(across)
        # What rounding leaves of A^-1 B counts twice then, as an energy does: little is left of much.
        complement = matrix[split:, split:].toarray() - down @ made_up
        complement -= made_up.T @ (across - matrix[:split, :split] @ made_up)
        return cls(first, down, made_up, complement, np.ones(last, np.bool_))

    def without(self, kept: Flags) -> BorderedFactors:
        """The same of some of the last functions."""
        return replace(self, kept=kept)

    def solve(self, right: Floats) -> Floats:
        """The answer; where functions are not independent, no numbers."""
        split = self.down.shape[1]
        own = self.first.solve(right[:split])
        complement = self.complement[np.ix_(self.kept, self.kept)]
        try:
            last = np.linalg.solve(complement, right[split:] - (self.down @ own)[self.kept])
        except np.linalg.LinAlgError:
            return np.full(len(right), np.nan)
        return np.append(own - self.made_up[:, self.kept] @ last, last)

    def independent(self, dependent: float = DEPENDENT) -> Flags:
        """Which of the last functions of a matrix, its diagonal 1, the others and those before do not make up.

        dependent : so much of the square of the size is left of a function that they make up.

        Examples
        --------
        >>> rows = np.array([[1, 0, 0.6, 0.6], [0, 1, 0.8, 0], [0.6, 0.8, 1, 0.36], [0.6, 0, 0.36, 1]])
        >>> BorderedFactors.of(sparse.csr_matrix(rows), 2).independent().tolist()
        [False, True]
        """
        rest, kept = self.complement, np.zeros(len(self.complement), np.bool_)
        for _ in range(len(rest)):
            pivots = np.where(kept, 0.0, np.abs(rest.diagonal()))
            most = int(pivots.argmax())
            if pivots[most] <= dependent:
                break
            kept[most] = True
            rest = rest - np.outer(rest[:, most], rest[most]) / rest[most, most]
        return kept
