"""The Boolean sum that every patch system is an instance of.

p(u, v) = sum_a f_a(u) C_a(v) + sum_b g_b(v) E_b(u) - sum_ab f_a(u) M_ab g_b(v)

f and g are blending or cardinal functions, C and E the curves and ribbons
across them, M what both say at the corners (Coons 1967, Gordon 1971). A loft
is one of the first two terms alone, a tensor product the third.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from math import prod

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from rsym.arrays import Floats
from rsym.backends.kernel import blocks_of
from rsym.errors import RsymError
from rsym.model.letters import Letters
from rsym.surfaces import symbols
from rsym.surfaces.functions.formulas import CompiledFormulas, entries_of
from rsym.surfaces.functions.univariate import NO_LETTERS, Univariate
from rsym.surfaces.parameters import LetterValues
from rsym.surfaces.patch import Domain, Orders, Patch

# Points combined at once: their factors stay in the cache of a core.
BLOCK = 4096
# Numbers that the factors of one pass may take.
FACTORS = 1 << 23


class Loft:
    """One term of a Boolean sum: sum_a f_a(s) C_a(t), f of shape (n,) along, C of shape (n, 3) across."""

    def __init__(self, functions: Univariate, curves: Univariate) -> None:
        if len(functions.shape) != 1 or curves.shape != (functions.shape[0], 3):
            raise RsymError(
                f"functions of the shape {functions.shape} cannot blend curves of the shape {curves.shape}",
                code="curve",
                remedy="n functions need the shape (n,), the curves across them (n, 3)",
            )
        self.functions, self.curves = functions, curves


class BooleanSum(Patch):
    """A patch p = P_u + P_v - P_u P_v of two lofts and their corners; each of the three may be missing.

    Parameters
    ----------
    along_u : Loft, optional
        Functions f of u, curves C of v.
    along_v : Loft, optional
        Functions g of v, curves E of u.
    corners : Univariate of shape (len f, len g, 3), optional
        A constant (`Constant`, `Sampled` or a formula without parameter).
    basis : pair of Univariate, optional
        f and g, for a patch of the third term alone, which then counts as positive.

    Examples
    --------
    >>> from rsym.surfaces.symbols import t
    >>> from rsym.surfaces.functions.univariate import Formula, Stack
    >>> ruled = BooleanSum(along_u=Loft(Formula((1 - t, t)), Formula([[0, t, 0], [1, t, t]])))
    >>> ruled(0.5, [0.0, 1.0]).tolist()
    [[0.5, 0.0, 0.0], [0.5, 1.0, 0.5]]
    >>> ruled.expression()
    Matrix([
    [              u],
    [u*v + v*(1 - u)],
    [            u*v]])
    """

    def __init__(
        self,
        along_u: Loft | None = None,
        along_v: Loft | None = None,
        corners: Univariate | None = None,
        *,
        basis: tuple[Univariate, Univariate] | None = None,
    ) -> None:
        f = along_u.functions if along_u else basis[0] if basis else None
        g = along_v.functions if along_v else basis[1] if basis else None
        self.lofts = (along_u, along_v)
        self.basis, self.corners = (f, g), corners
        self.sign = 1.0 if along_u is None and along_v is None else -1.0
        u_parts = [one for one in (f, along_v.curves if along_v else None) if one is not None]
        v_parts = [one for one in (g, along_u.curves if along_u else None) if one is not None]
        self._domain = (_common(u_parts, "u"), _common(v_parts, "v"))
        self._closed = (all(one.closed for one in u_parts), all(one.closed for one in v_parts))
        letters = NO_LETTERS
        for one in (*u_parts, *v_parts, *([] if corners is None else [corners])):
            letters = letters.merge(one.letters)
        self._letters = letters

    @property
    def domain(self) -> Domain:
        """The intervals of u and v."""
        return self._domain

    @property
    def closed(self) -> tuple[bool, bool]:
        """Whether all functions of u, and of v, are closed."""
        return self._closed

    @property
    def letters(self) -> Letters:
        """The letters of all parts."""
        return self._letters

    def evaluate(self, u: Floats, v: Floats, orders: Orders, letters: LetterValues = None) -> list[Floats]:
        """The derivatives of these orders."""
        values = self._letters.values_with(letters)
        if self._compiled is not None:
            return self._compiled.evaluate([u, v], orders, values)
        return _Separable(self, orders, values).evaluate(u, v)

    @cached_property
    def _compiled(self) -> CompiledFormulas | None:
        """One kernel for the whole formula, where it is one without pieces."""
        functions = [*self.basis, *(loft.curves for loft in self.lofts if loft), self.corners]
        if not all(one is None or one.is_smooth_formula for one in functions):
            return None
        point = self.expression()
        return CompiledFormulas(list(point), ("u", "v"), self._letters, self._domain)

    def expression(self) -> sp.ImmutableMatrix:
        """The point as expressions in u, v and the letters."""
        f, g = (_terms(one, name) for one, name in zip(self.basis, (symbols.u, symbols.v), strict=True))
        point = [sp.Integer(0)] * 3
        for loft, functions, name in zip(self.lofts, (f, g), (symbols.v, symbols.u), strict=True):
            if loft:
                curves = _terms(loft.curves, name)
                for row, function in enumerate(functions):
                    point = [known + function * curves[3 * row + c] for c, known in enumerate(point)]
        if self.corners is not None:
            point = [known + int(self.sign) * term for known, term in zip(point, self._corner_terms(f, g), strict=True)]
        return sp.ImmutableMatrix(point)

    def _corner_terms(self, f: Sequence[sp.Expr], g: Sequence[sp.Expr]) -> list[sp.Expr]:
        assert self.corners is not None
        corners = _terms(self.corners, symbols.u)
        size = len(g)
        return [
            sum((f[a] * corners[3 * (a * size + b) + c] * g[b] for a in range(len(f)) for b in range(size)), sp.S.Zero)
            for c in range(3)
        ]


class _Separable:
    """Values of a Boolean sum from those of its factors, in blocks; every operation is elementwise.

    The bits of a point depend on nothing but the point: not on the grid or block it stands in.
    """

    def __init__(self, patch: BooleanSum, orders: Orders, letters: dict[str, float]) -> None:
        self.patch, self.orders, self.letters = patch, orders, letters
        along_u, along_v = patch.lofts
        self.of_u = [patch.basis[0], along_v.curves if along_v else None]
        self.of_v = [patch.basis[1], along_u.curves if along_u else None]
        self.corners = None if patch.corners is None else patch.corners.at_start(letters)
        self.width = sum(prod(one.shape) for one in (*self.of_u, *self.of_v) if one is not None)

    def evaluate(self, u: Floats, v: Floats) -> list[Floats]:
        """The derivatives (..., 3); the factors are computed for the parameters as given, before they broadcast."""
        shape = np.broadcast_shapes(u.shape, v.shape)
        u, v = (one.reshape((1,) * (len(shape) - one.ndim) + one.shape) for one in (u, v))
        out = [np.empty((*shape, 3)) for _ in self.orders]
        if not shape:
            self._fill(u.reshape(1), v.reshape(1), [one.reshape(1, 3) for one in out])
            return out
        room = max(FACTORS // (self.width * len(self.orders)), 1)
        for block in blocks_of(shape, room):
            self._fill(_cut(u, block), _cut(v, block), [one[block] for one in out])
        return out

    def _fill(self, u: Floats, v: Floats, out: list[Floats]) -> None:
        """Write the derivatives at one block."""
        of_u = [self._factors(one, u, 0) for one in self.of_u]
        of_v = [self._factors(one, v, 1) for one in self.of_v]
        for block in blocks_of(out[0].shape[:-1], BLOCK):
            for (i, j), result in zip(self.orders, out, strict=True):
                parts_u = [_cut(one[i], block) if one else None for one in of_u]
                parts_v = [_cut(one[j], block) if one else None for one in of_v]
                result[block] = self._combine(parts_u, parts_v)

    def _factors(self, curve: Univariate | None, t: Floats, axis: int) -> dict[int, Floats]:
        """The derivatives of a factor by their order in the parameter of this axis; none of one that is missing."""
        orders = sorted({order[axis] for order in self.orders})
        return {} if curve is None else dict(zip(orders, curve.evaluate(t, orders, self.letters), strict=True))

    def _combine(self, of_u: list[Floats | None], of_v: list[Floats | None]) -> Floats:
        (f, across_v), (g, across_u) = of_u, of_v
        total: Floats = np.zeros(3)
        if f is not None and across_u is not None:
            total = total + _blend(f, across_u)
        if g is not None and across_v is not None:
            total = total + _blend(g, across_v)
        if self.corners is not None:
            assert f is not None
            assert g is not None
            inner = _blend(f, self.corners.reshape(len(self.corners), -1)).reshape(*f.shape[:-1], -1, 3)
            total = total + self.patch.sign * _blend(g, inner)
        return total


def _blend(functions: Floats, curves: Floats) -> Floats:
    """Sum of functions (..., n) times curves (..., n, k), term by term in the order of n."""
    total = functions[..., 0, None] * curves[..., 0, :]
    for row in range(1, functions.shape[-1]):
        total = total + functions[..., row, None] * curves[..., row, :]
    return total


def _cut(array: NDArray[np.float64], block: tuple[slice, ...]) -> Floats:
    """The part of an array that broadcasts to a block; axes of length 1 stay."""
    return array[tuple(slice(None) if array.shape[axis] == 1 else part for axis, part in enumerate(block))]


def _terms(curve: Univariate | None, parameter: sp.Symbol) -> list[sp.Expr]:
    """The entries of a function of one parameter, written in that parameter."""
    if curve is None:
        return []
    inner = curve.expressions()
    if inner is None:
        raise RsymError(
            "this patch is not made of formulas alone",
            code="no-formula",
            remedy="give its curves as SymPy expressions",
        )
    return [entry.xreplace({symbols.t: parameter}) for entry in entries_of(inner)]


def _common(parts: Sequence[Univariate], name: str) -> tuple[float, float]:
    """The interval that all parts share."""
    low, high = parts[0].domain
    for part in parts:
        if not np.allclose(part.domain, (low, high), rtol=1e-12, atol=0):
            raise RsymError(
                f"functions of {name} live on [{low:g}, {high:g}] and [{part.domain[0]:g}, {part.domain[1]:g}]",
                code="domain",
                remedy="bring them to a common interval: on_interval(curve, a, b)",
            )
    return float(low), float(high)
