"""Coons patches: four edges, and what the surface does across them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import Any

import numpy as np
import sympy as sp

from rsym.arrays import Floats
from rsym.errors import RsymError
from rsym.surfaces.blends.blending import HermiteBlend, blend_of_class
from rsym.surfaces.coons.corners import CornerData, gregory_of
from rsym.surfaces.coons.patch_latex import coons_latex
from rsym.surfaces.corrections import MEETING, Correction, require_tolerance
from rsym.surfaces.functions.curves import as_curve
from rsym.surfaces.functions.univariate import Blended, Combination, SingleSample, Stack, Univariate, on_interval
from rsym.surfaces.parameters import LetterValues
from rsym.surfaces.parametric import ParametricSurface
from rsym.surfaces.patch import Orders
from rsym.surfaces.symbols import t, u, v
from rsym.surfaces.transfinite import BooleanSum, Loft

EDGES = ("u0", "u1", "v0", "v1")


class CoonsPatch(BooleanSum):
    """The transfinite patch of class 1, 2 or 3 through four edges.

    With f the blending functions of the class and D_k = (p, p_n, p_nn) the edges and their derivatives across,

        p(u, v) = -[-1, f(u)] M [-1, f(v)]^T,

    where M holds the edges in its first row and column and the corner data in the rest, so that position, first
    and second derivative across every edge are those given (Coons 1967; in a thesis on Coons patches with shape
    parameters, Central South University, 2009: (2.1.7), (2.2.7), (2.3.3)).

    Parameters
    ----------
    curve_u0, curve_u1, curve_v0, curve_v1 : curves
        p(0, v), p(1, v), p(u, 0), p(u, 1): three SymPy expressions in one parameter, a function, points (n, 3), or a
        `Nurbs`. Each is brought to [0, 1].
    order : {1, 2, 3}
        The class: how many derivatives across the edges, position included, are given.
    ribbons : mapping, optional
        ``{"u0": p_u(0, v), "u1": ..., "v0": p_v(u, 0), "v1": ...}``; for class 3 pairs (p_u, p_uu). In class 2 the
        default follows the tangents at the corners, with Adini's twist.
    corners : {"mean", "gregory", "refuse"}
        What to do if the edges disagree on the twist p_uv at a corner: take the mean, which bends the ribbons near
        it; Gregory's square (class 2), which keeps both; or raise.
    blend_u, blend_v : HermiteBlend, optional
        Of the class of the patch or a higher one; linear, cubic, quintic by default.
    letters : mapping, optional
        Symbols or names to numbers or `rsym.Letter`.
    tolerance : float
        By which share of the size of the patch edges, and ribbons with the edges that they end on, may miss one another
        at the corners; rounding by default. Measured curves need more: then each corner is the mean of what both say,
        which the blends carry into the edges, and `correction` tells how far these are from the curves given.

    Raises
    ------
    RsymError
        If edges or ribbons do not meet at a corner (which corner, the gap, both values), or the class does not fit.

    Examples
    --------
    >>> from rsym.surfaces.symbols import t
    >>> saddle = CoonsPatch((0, t, 0), (1, t, t), (t, 0, 0), (t, 1, t))
    >>> saddle(0.5, [0.0, 1.0]).tolist()
    [[0.5, 0.0, 0.0], [0.5, 1.0, 0.5]]
    >>> CoonsPatch((0, t, 0), (1, t, t), (t, 0, 0), (t, 1, 0))  # doctest: +ELLIPSIS
    Traceback (most recent call last):
    ...
    rsym.errors.RsymError: corner (1, 1): the edge u1 at v = 1 is (1, 1, 1) and the edge v1 at u = 1 is (1, 1, 0): ...
    >>> print(CoonsPatch((0, t, 0), (1, t, t), (t, 0, 0), (t, 1, 0.99 * t), tolerance=0.02).correction)
    a gap of 0.01 closed; points moved by 0.005 at most, at (u, v) = (1, 1)
    """

    def __init__(
        self,
        curve_u0: Any,
        curve_u1: Any,
        curve_v0: Any,
        curve_v1: Any,
        *,
        order: int = 1,
        ribbons: Mapping[str, Any] | None = None,
        corners: str = "mean",
        blend_u: HermiteBlend | None = None,
        blend_v: HermiteBlend | None = None,
        letters: Mapping[Any, Any] | None = None,
        tolerance: float = MEETING,
    ) -> None:
        require_tolerance(tolerance)
        self.order, self.tolerance = order, tolerance
        self.blend_u, self.blend_v = blend_of_class(blend_u, order, "u"), blend_of_class(blend_v, order, "v")
        given = dict(zip(EDGES, (curve_u0, curve_u1, curve_v0, curve_v1), strict=True))
        edges = {name: unit_curve(curve, letters, f"the curve of the edge {name}") for name, curve in given.items()}
        across_u, across_v = stacks_across(edges, ribbons, order, letters)
        self.data = CornerData(across_u, across_v)
        self.data.check(tolerance)
        self.gregory = gregory_of(corners, self.data, (self.blend_u, self.blend_v), tolerance)
        super().__init__(Loft(self.blend_u.curve, across_u), Loft(self.blend_v.curve, across_v), self.data)

    @classmethod
    def of_surface(cls, point: Any, *, order: int = 1, letters: Mapping[Any, Any] | None = None) -> CoonsPatch:
        """The patch with the edges, and the derivatives across them, of a surface (x, y, z) in u and v over [0, 1]^2.

        Examples
        --------
        >>> import sympy as sp
        >>> from rsym.surfaces.symbols import u, v
        >>> patch = CoonsPatch.of_surface((u, v, sp.exp(u * v)), order=2)
        >>> patch.derivative(1.0, 0.5, (1, 0)).round(12).tolist()
        [1.0, 0.0, 0.82436063535]
        """
        whole = ParametricSurface(point, letters=letters).expression()
        rows = []
        for k in range(order):
            at = {f"u{i}": whole.diff(u, k).subs(u, i).subs(v, t) for i in (0, 1)}
            rows.append(at | {f"v{j}": whole.diff(v, k).subs(v, j).subs(u, t) for j in (0, 1)})
        ribbons = {name: tuple(row[name] for row in rows[1:]) for name in EDGES} if order > 1 else None
        return cls(*(rows[0][name] for name in EDGES), order=order, ribbons=ribbons, letters=letters)

    @cached_property
    def correction(self) -> Correction:
        """The greatest gap at a corner, and how far the edges are from the curves given; at the defaults of letters."""
        return self.data.correction(self.blend_u.curve, self.blend_v.curve)

    def evaluate(self, u: Floats, v: Floats, orders: Orders, letters: LetterValues = None) -> list[Floats]:
        """The derivatives of these orders."""
        if letters and len(self.data.letters):
            self.data.check(self.tolerance, self.letters.values_with(letters))
        parts = super().evaluate(u, v, orders, letters)
        if self.gregory is None or self._compiled is not None:  # a kernel of the whole formula holds the correction
            return parts
        extra = self.gregory.evaluate(u, v, orders, self.letters.values_with(letters))
        return [part + more for part, more in zip(parts, extra, strict=True)]

    def expression(self) -> sp.ImmutableMatrix:
        """The point as expressions in u, v and the letters."""
        point = super().expression()
        return point if self.gregory is None else point + self.gregory.expression()

    def _repr_latex_(self) -> str | None:
        """The matrix formula with its entries; none where the patch is not a formula."""
        lofts = [loft.curves for loft in self.lofts if loft]
        if self.gregory is not None or any(one.expressions() is None for one in (*lofts, self.data)):
            return super()._repr_latex_()
        return coons_latex(self.data, lofts, self.blend_u, self.blend_v)


def stacks_across(
    edges: Mapping[str, Univariate], ribbons: Mapping[str, Any] | None, order: int, letters: Mapping[Any, Any] | None
) -> tuple[Stack, Stack]:
    """What happens across the edges u = 0, 1 and across v = 0, 1: the edges and their ribbons, order by order."""
    rows = [edges, *ribbons_of(edges, ribbons, order, letters)]
    across_u, across_v = (Stack([row[name + end] for row in rows for end in "01"]) for name in "uv")
    return across_u, across_v


def ribbons_of(
    edges: Mapping[str, Univariate], ribbons: Mapping[str, Any] | None, order: int, letters: Mapping[Any, Any] | None
) -> list[dict[str, Univariate]]:
    """The derivatives across the edges, order by order, as given or as they follow from the edges."""
    if order == 1 or ribbons is None:
        if order == 3 or (order == 1 and ribbons is not None):
            expected = "no ribbons" if order == 1 else "ribbons (first, second) for each edge"
            raise RsymError(f"a patch of class {order} takes {expected}", code="ribbons", remedy="change order=")
        return [] if order == 1 else [tangent_ribbons(edges)]
    if set(ribbons) != set(EDGES):
        raise RsymError(
            f"ribbons are given for {', '.join(EDGES)}, got {', '.join(map(str, ribbons))}",
            code="ribbons",
            remedy="a mapping from each edge to the derivative across it",
        )
    rows: list[dict[str, Univariate]] = [{} for _ in range(order - 1)]
    for name in EDGES:
        for row, one in zip(rows, _derivatives_across(ribbons[name], order, name), strict=True):
            row[name] = unit_curve(one, letters, f"the ribbon of the edge {name}")
    return rows


def _derivatives_across(given: Any, order: int, name: str) -> Sequence[Any]:
    """The order - 1 ribbons of one edge; one alone need not be wrapped."""
    if isinstance(given, tuple | list) and len(given) == order - 1 and (order == 3 or not _is_number(given[0])):
        return given
    if order == 2:
        return (given,)
    raise RsymError(
        f"a patch of class 3 takes a pair (first, second derivative) across the edge {name}", code="ribbons"
    )


def _is_number(given: Any) -> bool:
    return np.ndim(given) == 0 and not callable(given) and not isinstance(given, Univariate)


def tangent_ribbons(edges: Mapping[str, Univariate]) -> dict[str, Univariate]:
    """For each edge the cubic ribbon with the tangents of the edges that it ends on, and Adini's twists.

    p_uv(i, j) = p_v(1, j) - p_v(0, j) + p_u(i, 1) - p_u(i, 0) - (p(1, 1) - p(1, 0) - p(0, 1) + p(0, 0)): what a
    surface f(u){1, v} + {1, u}g(v) through the corners has.
    """
    functions = HermiteBlend.cubic().curve
    twist = [[_adini(edges, i, j) for j in (0, 1)] for i in (0, 1)]
    ribbons: dict[str, Univariate] = {}
    for end in (0, 1):
        across_u = [_at(edges[f"v{j}"], end, 1) for j in (0, 1)]
        across_v = [_at(edges[f"u{i}"], end, 1) for i in (0, 1)]
        ribbons[f"u{end}"] = Blended(functions, Stack([*across_u, *twist[end]]))
        ribbons[f"v{end}"] = Blended(functions, Stack([*across_v, twist[0][end], twist[1][end]]))
    return ribbons


def _adini(edges: Mapping[str, Univariate], i: int, j: int) -> Univariate:
    slopes = [_at(edges["u1"], j, 1), _at(edges["u0"], j, 1), _at(edges["v1"], i, 1), _at(edges["v0"], i, 1)]
    points = [_at(edges["u1"], 1, 0), _at(edges["u1"], 0, 0), _at(edges["u0"], 1, 0), _at(edges["u0"], 0, 0)]
    return Combination([*slopes, *points], [1, -1, 1, -1, -1, 1, 1, -1])


def _at(curve: Univariate, place: int, order: int) -> Univariate:
    """A point or tangent of a curve over [0, 1], as a constant (3,)."""
    return SingleSample(curve, float(place), order)


def unit_curve(given: Any, letters: Mapping[Any, Any] | None, what: str) -> Univariate:
    """Whatever a user means by a curve, over [0, 1]."""
    return on_interval(as_curve(given, letters, what=what), 0.0, 1.0)
