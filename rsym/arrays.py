"""The types of arrays, which every layer that computes with numbers writes in its signatures."""

from __future__ import annotations

from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

Floats: TypeAlias = NDArray[np.float64]
Ints: TypeAlias = NDArray[np.int64]
Flags: TypeAlias = NDArray[np.bool_]
Integers: TypeAlias = NDArray[np.integer[Any]]  # of any width
Shorts: TypeAlias = NDArray[np.int16]  # numbers of leaves
Faces: TypeAlias = NDArray[np.int32]  # three vertices each
