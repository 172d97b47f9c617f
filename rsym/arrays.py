"""The types of arrays, which every layer that computes with numbers writes in its signatures."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

Floats: TypeAlias = NDArray[np.float64]
Complexes: TypeAlias = NDArray[np.complex128]
Ints: TypeAlias = NDArray[np.int64]
Flags: TypeAlias = NDArray[np.bool_]
Integers: TypeAlias = NDArray[np.integer[Any]]  # of any width
Shorts: TypeAlias = NDArray[np.int16]  # numbers of leaves
Faces: TypeAlias = NDArray[np.int32]  # three vertices each
Arrays: TypeAlias = Sequence[NDArray[Any]] | NDArray[Any]  # several, or the rows of one


def addresses(rows: Arrays) -> NDArray[np.intp]:
    """Where the numbers of each row begin in memory, as compiled code is told it; of one array it is reckoned.

    Examples
    --------
    >>> rows = np.zeros((3, 4))
    >>> (addresses(rows) == addresses(list(rows))).all()
    np.True_
    """
    if isinstance(rows, np.ndarray):
        return rows.ctypes.data + rows.strides[0] * np.arange(len(rows))
    return np.array([row.ctypes.data for row in rows], np.intp)
