"""One kernel for all patches of the same blends: the numbers of their matrices enter as letters do.

A hundred patches then compile three kernels instead of three hundred.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from rsym.model.letters import Letter, Letters
from rsym.model.symbols import real_symbol
from rsym.surfaces import symbols
from rsym.surfaces.blends.blending import HermiteBlend
from rsym.surfaces.functions.formulas import CompiledFormulas

Array = NDArray[np.float64]

UNIT = ((0.0, 1.0), (0.0, 1.0))


@lru_cache(maxsize=32)
def formulas_of_blends(blend_u: HermiteBlend, blend_v: HermiteBlend) -> CompiledFormulas:
    """The point f(u)^T Q g(v), every number of Q a letter."""
    f = [function.xreplace({symbols.t: symbols.u}) for function in blend_u.functions]
    g = [function.xreplace({symbols.t: symbols.v}) for function in blend_v.functions]
    names = _names(len(f))
    point = [
        sp.Add(*(f[a] * sp.Add(*(real_symbol(names[a][b][c]) * g[b] for b in range(len(g)))) for a in range(len(f))))
        for c in range(3)
    ]
    flat = [name for row in names for cell in row for name in cell]
    # Not all alike, since kernels are checked with the defaults.
    corners = Letters({name: Letter(1 + place / 8) for place, name in enumerate(flat)})
    return CompiledFormulas(point, ("u", "v"), blend_u.letters.merge(blend_v.letters).merge(corners), UNIT)


def corner_values(matrix: Array) -> dict[str, float]:
    """The numbers of a matrix (n, n, 3) under the names that the formulas have for them.

    Examples
    --------
    >>> list(corner_values(np.zeros((4, 4, 3))))[:4]
    ['corner 0 0 x', 'corner 0 0 y', 'corner 0 0 z', 'corner 0 1 x']
    """
    names = [name for row in _names(len(matrix)) for cell in row for name in cell]
    return dict(zip(names, matrix.ravel().tolist(), strict=True))


def _names(size: int) -> list[list[list[str]]]:
    """No symbol of a user has a blank in its name."""
    return [[[f"corner {a} {b} {axis}" for axis in "xyz"] for b in range(size)] for a in range(size)]
