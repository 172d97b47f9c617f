"""Patches of a corner information matrix: points, tangents and twists at the four corners.

All patches of the same blends share one kernel, which the numbers of their matrices enter as letters do: a hundred
patches compile three kernels instead of three hundred.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache
from typing import Any

import numpy as np
import sympy as sp

from rsym.arrays import Floats
from rsym.errors import RsymError
from rsym.model.letters import Letter, Letters, as_letters
from rsym.model.symbols import real_symbol
from rsym.surfaces import symbols
from rsym.surfaces.blends.blending import HermiteBlend, blend_of_class
from rsym.surfaces.coons.patch_latex import bicubic_latex
from rsym.surfaces.corrections import Correction
from rsym.surfaces.functions.formulas import CompiledFormulas, entries_and_shape
from rsym.surfaces.functions.univariate import Constant, Formula, Univariate
from rsym.surfaces.parameters import LetterValues
from rsym.surfaces.patch import Orders
from rsym.surfaces.transfinite import BooleanSum

UNIT = ((0.0, 1.0), (0.0, 1.0))


class BicubicCoons(BooleanSum):
    """The patch p = f(u)^T Q f(v) of a corner information matrix; bicubic for the cubic blend.

    Parameters
    ----------
    matrix : (4, 4, 3) numbers or SymPy expressions
        Rows p(0,.), p(1,.), p_u(0,.), p_u(1,.); columns alike in v: .(.,0), .(.,1), ._v(.,0), ._v(.,1). So the lower
        right block holds the twists p_uv. A matrix (6, 6, 3) adds p_uu and p_vv, for blends of class 3.
    blend_u, blend_v : HermiteBlend, optional
        Cubic by default; quintic for a matrix (6, 6, 3).
    letters : mapping, optional
        Of the expressions: symbols or names to numbers or `rsym.Letter`.

    Attributes
    ----------
    correction : Correction or None
        What `join` changed, if it made this patch.

    Notes
    -----
    The form of the program `test1` of "Modelling of composite surfaces in MATLAB", and (2.4.2) of the thesis that
    `CoonsPatch` names. With the default blends this is the bicubic Hermite patch, with zero twists Ferguson's (1964).

    Examples
    --------
    >>> import numpy as np
    >>> flat = np.zeros((4, 4, 3))
    >>> flat[1, :2, 0] = flat[2:, :2, 0] = 1    # x = u
    >>> flat[:2, 1, 1] = flat[:2, 2:, 1] = 1    # y = v
    >>> BicubicCoons(flat)(0.25, 0.75).tolist()
    [0.25, 0.75, 0.0]
    """

    def __init__(
        self,
        matrix: Any,
        blend_u: HermiteBlend | None = None,
        blend_v: HermiteBlend | None = None,
        *,
        letters: Mapping[Any, Any] | None = None,
    ) -> None:
        data = _matrix(matrix, letters)
        order = data.shape[0] // 2
        self.blend_u, self.blend_v = (
            blend_of_class(one, order, name) for one, name in ((blend_u, "u"), (blend_v, "v"))
        )
        super().__init__(corners=data, basis=(self.blend_u.curve, self.blend_v.curve))
        self.data = data
        self.correction: Correction | None = None

    def evaluate(self, u: Floats, v: Floats, orders: Orders, letters: LetterValues = None) -> list[Floats]:
        """The derivatives of these orders."""
        if not isinstance(self.data, Constant):
            return super().evaluate(u, v, orders, letters)
        values = self.letters.values_with(letters) | corner_values(self.data.values)
        return formulas_of_blends(self.blend_u, self.blend_v).evaluate([u, v], orders, values)

    @property
    def matrix(self) -> Floats:
        """The corner information matrix at the defaults of the letters."""
        return np.array(self.data.at_start())

    def _repr_latex_(self) -> str:
        """P = f(u)^T Q f(v) with Q and f."""
        return bicubic_latex(self.data, self.blend_u, self.blend_v)

    def with_matrix(self, matrix: Any) -> BicubicCoons:
        """The patch of another matrix with the same blends."""
        return BicubicCoons(matrix, self.blend_u, self.blend_v)


def _matrix(matrix: Any, letters: Mapping[Any, Any] | None) -> Univariate:
    """The corner information as a constant."""
    try:
        data: Univariate = Constant(matrix)
    except (TypeError, ValueError):
        entries, shape = entries_and_shape(matrix)
        known = as_letters(letters)
        free = sorted({symbol.name for entry in entries for symbol in entry.free_symbols} - set(known))
        if free:
            raise RsymError(
                f"the corner information has an unknown symbol {free[0]!r}",
                code="unknown-letter",
                remedy=f"declare it: letters={{{free[0]!r}: number}}",
            ) from None
        data = Formula(sp.ImmutableDenseNDimArray(entries, shape), known, what="the corner information")
    if data.shape not in ((4, 4, 3), (6, 6, 3)):
        raise RsymError(
            f"the corner information is an array (4, 4, 3), or (6, 6, 3) for class 3, got the shape {data.shape}",
            code="matrix",
            remedy="rows p(0,.) p(1,.) p_u(0,.) p_u(1,.), columns alike in v, points last",
        )
    if isinstance(data, Constant) and not np.isfinite(data.values).all():
        where = tuple(int(k) for k in np.argwhere(~np.isfinite(data.values))[0])
        raise RsymError(f"the corner information is not finite at {where}", code="matrix", remedy="mend the number")
    return data


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


def corner_values(matrix: Floats) -> dict[str, float]:
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
