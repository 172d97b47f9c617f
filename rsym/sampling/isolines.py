"""Level lines of an array of numbers, as they lie between its entries."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from skimage.measure import find_contours

from rsym.arrays import Floats


def isolines(values: Floats, level: float, axes: Sequence[Floats]) -> list[Floats]:
    """Polylines (n, 2) on which the linear interpolation of an array has a value; they end beside NaN.

    Parameters
    ----------
    values : (k, m) array
        The numbers.
    level : float
        The value.
    axes : two arrays, (k,) and (m,)
        The coordinates of rows and columns, increasing.

    Examples
    --------
    >>> isolines(np.array([[0.0, 0.0], [1.0, 1.0]]), 0.25, ([2, 4], [0, 1]))[0].tolist()
    [[2.5, 0.0], [2.5, 1.0]]
    """
    lines: list[Floats] = find_contours(values, level)
    numbers = [np.arange(len(axis)) for axis in axes]
    return [np.column_stack([np.interp(line[:, k], numbers[k], axes[k]) for k in (0, 1)]) for line in lines]
