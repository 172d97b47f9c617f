"""Least squares with matrices whose rows are short: Householder reflections within the band.

The sums run in one fixed order, whatever number of threads a BLAS would use.
"""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

Array: TypeAlias = NDArray[np.float64]

# A column whose part outside the span of those before it is smaller than this many roundings for each row is dependent:
# singular collocation matrices of up to 60 rows end at 0.2 to 3 roundings of the column, regular ones stay above 1e-9.
DEPENDENT = 8 * np.finfo(float).eps


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

    def __init__(self, matrix: Array, rounding: float = DEPENDENT) -> None:
        filled, columns = matrix != 0, np.arange(matrix.shape[1])
        first = np.where(filled, columns, len(columns)).min(axis=1, initial=len(columns))
        last = np.where(filled, columns + 1, 0).max(axis=1, initial=0)
        self.order = np.argsort(first, kind="stable")
        self.upper = np.ascontiguousarray(matrix[self.order])
        self.ends = np.searchsorted(first[self.order], columns, side="right")
        self.widths = np.maximum.accumulate(last[self.order])[np.maximum(self.ends - 1, 0)]
        self.reflections: list[tuple[Array, float]] = []
        self.dependent: int | None = None
        sizes = np.sqrt(np.einsum("ij,ij->j", matrix, matrix))
        for column in range(matrix.shape[1]):
            if not self._reflect(column) > rounding * len(matrix) * sizes[column]:
                self.dependent = column
                break

    def _reflect(self, column: int) -> float:
        """Zeros below the diagonal of a column; the size of the diagonal."""
        end, width = self.ends[column], self.widths[column]
        block = self.upper[column:end, column:width]
        if not block.size:
            return 0.0
        mirror = block[:, 0].copy()
        length = float(np.sqrt(np.einsum("i,i->", mirror, mirror)))
        mirror[0] += np.copysign(length, mirror[0])
        size = float(np.einsum("i,i->", mirror, mirror))
        scale = 2 / size if size else 0.0
        block -= mirror[:, None] * (scale * np.einsum("i,ij->j", mirror, block))
        self.reflections.append((mirror, scale))
        return length

    def turned(self, right: Array) -> Array:
        """Q^T right, (rows, numbers in a row)."""
        y = np.array(right, np.float64)[self.order].reshape(len(self.order), -1)
        for column, (mirror, scale) in enumerate(self.reflections):
            part = y[column : self.ends[column]]
            part -= mirror[:, None] * (scale * np.einsum("i,ij->j", mirror, part))
        return y

    def solve(self, right: Array) -> Array:
        """The x with the smallest |A x - right|, along the first axis."""
        y = self.turned(right)
        x = np.zeros((self.upper.shape[1], y.shape[1]))
        for row in reversed(range(len(x))):
            beyond = slice(row + 1, self.widths[row])
            x[row] = (y[row] - np.einsum("j,jk->k", self.upper[row, beyond], x[beyond])) / self.upper[row, row]
        return x.reshape(-1, *right.shape[1:])
