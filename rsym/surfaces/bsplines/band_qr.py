"""Least squares with matrices whose rows are short: Householder reflections within the band.

The sums run in one fixed order, whatever number of threads a BLAS would use.
"""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from rsym.arrays import Floats

Rows: TypeAlias = NDArray[np.intp]

# Rows are made a triangle when they are this many times as many as their columns. 10 000 points and 20 x 20 vertices
# take 0.25 s with 4, 0.21 s with 8, 0.19 s with 16, 0.92 s if never.
TALL = 8

# A column whose part outside the span of those before it is smaller than this many roundings for each row is dependent:
# closed splines of even degree through up to 60 data at their knots, an even number, end at 0 to 0.34.
DEPENDENT = 2 * np.finfo(float).eps


class BandQR:
    """A = QR for a matrix with at least as many rows as columns; the zeros outside its band cost nothing.

    `dependent` is the number of a column that depends on those before it, or None; `rounding` tells from how small a
    rest on, as a share of the column for each row.

    Examples
    --------
    >>> qr = BandQR(np.array([[1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]))
    >>> np.round(qr.solve(np.array([1.0, 3.0, 2.0])), 12).tolist(), qr.dependent
    ([1.0, 2.0], None)
    """

    def __init__(self, matrix: Floats, rounding: float = DEPENDENT) -> None:
        filled, columns = matrix != 0, np.arange(matrix.shape[1])
        first = np.where(filled, columns, len(columns)).min(axis=1, initial=len(columns))
        self._last = np.where(filled, columns + 1, 0).max(axis=1, initial=0)
        order = np.argsort(first, kind="stable")
        starts = np.searchsorted(first[order], np.arange(len(columns) + 1))
        self._entries = np.array(matrix, np.float64)
        self._reflections: list[tuple[Rows, Floats]] = []
        self._pivots, self._widths = np.empty_like(columns), np.empty_like(columns)
        self.dependent: int | None = None
        sizes = np.sqrt(np.einsum("ij,ij->j", matrix, matrix))
        rows = order[:0]
        for column in range(len(columns)):
            rows = np.concatenate([self._shortened(rows, column), order[starts[column] : starts[column + 1]]])
            if not self._reflect(rows, column) > rounding * len(matrix) * sizes[column]:
                self.dependent = column
                break
            self._pivots[column], self._widths[column] = rows[0], self._last[rows[0]]
            rows = rows[1:]

    def _shortened(self, rows: Rows, column: int) -> Rows:
        """The rows from this column on, without those that a triangle of reflections makes zero, if these are many."""
        width = int(self._last[rows].max(initial=column))
        if len(rows) <= TALL * (width - column):
            return rows
        for inner in range(column, width):
            self._reflect(rows[inner - column :], inner)
        return rows[: width - column]

    def _reflect(self, rows: Rows, column: int) -> float:
        """Zeros in a column below the first of the rows; the size of that."""
        if not len(rows):
            return 0.0
        width = int(self._last[rows].max())
        self._last[rows] = width
        block = self._entries[rows, column:width]
        mirror = block[:, 0].copy()
        length = float(np.sqrt(np.einsum("i,i->", mirror, mirror)))
        mirror[0] += np.copysign(length, mirror[0])
        size = float(np.sqrt(np.einsum("i,i->", mirror, mirror)))
        if size:
            mirror /= size
            block -= mirror[:, None] * (2 * np.einsum("i,ij->j", mirror, block))
            self._entries[rows, column:width] = block
            self._reflections.append((rows, mirror))
        return length

    @property
    def upper(self) -> Floats:
        """R."""
        return np.triu(self._entries[self._pivots])

    def turned(self, right: Floats) -> Floats:
        """Q^T right, (rows, numbers in a row), the rows of R first."""
        y = self._turned(right)
        return np.concatenate([y[self._pivots], np.delete(y, self._pivots, axis=0)])

    def solve(self, right: Floats) -> Floats:
        """The x with the smallest |A x - right|, along the first axis."""
        y = self._turned(right)
        x = np.zeros((len(self._pivots), y.shape[1]))
        for row in reversed(range(len(x))):
            pivot, width = self._pivots[row], self._widths[row]
            rest = np.einsum("j,jk->k", self._entries[pivot, row + 1 : width], x[row + 1 : width])
            x[row] = (y[pivot] - rest) / self._entries[pivot, row]
        return x.reshape(-1, *right.shape[1:])

    def _turned(self, right: Floats) -> Floats:
        y = np.array(right, np.float64).reshape(len(self._entries), -1)
        for rows, mirror in self._reflections:
            part = y[rows]
            y[rows] = part - mirror[:, None] * (2 * np.einsum("i,ij->j", mirror, part))
        return y
