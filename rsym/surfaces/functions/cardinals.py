"""Cardinal functions: phi_i is 1 at the knot i and 0 at the other knots.

A family r_i blended by them passes through all its members. Those of cubic
splines are Hermite cubics between the knots; slopes q make the kinds:

    c h_j q_(j-1) + (1 + c)(h_(j-1) + h_j) q_j + c h_(j-1) q_(j+1)
        = (1 + 2c) [(h_j/h_(j-1)) (r_j - r_(j-1)) + (h_(j-1)/h_j) (r_(j+1) - r_j)],
    (1 + c) q_0 + q_1 = (2 + c) (r_1 - r_0)/h_0, and the mirror image at the other end,

with c = 0 for composite Hermite splines (Golovanov 3.7.1: third derivatives vanish at the ends) and c = 1 for natural
cubic splines. Closed families have no ends: all indices are cyclic. General knots are ours.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import Any, TypeAlias

import numpy as np
import sympy as sp
from numpy.typing import NDArray
from scipy.interpolate import CubicHermiteSpline

from rsym.arrays import Floats
from rsym.errors import RsymError, warn
from rsym.surfaces.functions.formulas import exact
from rsym.surfaces.functions.polynomials import Polynomials
from rsym.surfaces.functions.univariate import Formula, Univariate
from rsym.surfaces.parameters import LetterValues
from rsym.surfaces.symbols import t as parameter

Knots: TypeAlias = Sequence[Any]

# The cardinal functions of more equidistant knots than this swing to more than 3 between them (Runge): measured, their
# absolute values add up to 1.6, 2.2, 3.1, 4.5 and 7 for 4, 5, 6, 7 and 8 knots.
MOST_LAGRANGE = 6
# What functions of the user's own may be off at the knots; a surface misses its curves by as much.
CARDINALITY = 1e-12


class CubicCardinals(Polynomials):
    """Piecewise cubics phi_i(t) of shape (n,): phi_i is 1 at knot i and 0 at the others.

    `neighbours` is c above. `closed`: the last knot is the first one again, a period later; there are n + 1 knots.
    """

    def __init__(self, knots: Knots, neighbours: int, *, closed: bool = False) -> None:
        self.knots = checked_knots(knots, closed)
        self.count, self.neighbours = len(self.knots) - closed, neighbours
        left, right = _system(np.asarray(self.knots), neighbours, closed)
        self.slopes: Floats = np.linalg.solve(left, right)
        cyclic = np.arange(len(self.knots)) % self.count
        super().__init__(CubicHermiteSpline(self.knots, np.eye(self.count)[cyclic], self.slopes[cyclic]), closed=closed)

    def exact_slopes(self) -> sp.Matrix:
        """The matrix that takes values at the knots to slopes there; rational."""
        left, right = _system(
            np.array([exact(knot) for knot in self.knots], dtype=object), self.neighbours, self.closed
        )
        return sp.Matrix(left).LUsolve(sp.Matrix(right))

    def expressions(self) -> sp.ImmutableDenseNDimArray:
        """The pieces in t, exact for rational knots."""
        ones, slopes = sp.eye(self.count), self.exact_slopes()
        return sp.ImmutableDenseNDimArray([_cubic(self.knots, ones.col(i), slopes.col(i)) for i in range(self.count)])


class SlopeFunctions(Polynomials):
    """Piecewise cubics beta_i(t) of shape (n,) that vanish at all knots, with slope 1 at knot i and 0 at the others.

    Examples
    --------
    >>> SlopeFunctions([0, 1, 2])([0.5, 1.5]).tolist(), SlopeFunctions([0, 1, 2])(1.0, 1).tolist()
    ([[0.125, -0.125, 0.0], [0.0, 0.125, -0.125]], [0.0, 1.0, 0.0])
    """

    def __init__(self, knots: Knots, *, closed: bool = False) -> None:
        self.knots = checked_knots(knots, closed)
        self.count = len(self.knots) - closed
        ones = np.eye(self.count)[np.arange(len(self.knots)) % self.count]
        super().__init__(CubicHermiteSpline(self.knots, 0 * ones, ones), closed=closed)

    def expressions(self) -> sp.ImmutableDenseNDimArray:
        """The pieces in t."""
        ones, none = sp.eye(self.count), sp.zeros(self.count, 1)
        return sp.ImmutableDenseNDimArray([_cubic(self.knots, none, ones.col(i)) for i in range(self.count)])


def hermite_cardinals(knots: Knots, *, closed: bool = False) -> CubicCardinals:
    """Cardinal functions of composite Hermite splines: C1, and local: phi_i lives on four intervals.

    Reproduces quadratics for any knots. Source: Golovanov, 3.7.1, for uniform knots.

    Examples
    --------
    >>> hermite_cardinals([0, 1, 2, 3])(1.5).tolist()
    [-0.0625, 0.5625, 0.5625, -0.0625]
    """
    return CubicCardinals(knots, 0, closed=closed)


def spline_cardinals(knots: Knots, *, closed: bool = False) -> CubicCardinals:
    """Cardinal functions of natural cubic splines, or of periodic ones for a closed family: C2.

    Examples
    --------
    >>> spline_cardinals([0, 1, 2])([0.5, 1.0]).tolist()
    [[0.40625, 0.6875, -0.09375], [0.0, 1.0, 0.0]]
    """
    return CubicCardinals(knots, 1, closed=closed)


class LagrangeCardinals(Univariate):
    """The polynomials L_i(t) = prod_(j != i) (t - t_j)/(t_i - t_j), by the barycentric formula.

    Their derivatives are polynomials too, so L^(k) = L D^k with the matrix D of the slopes at the knots.
    Source: Golovanov, 3.7.3; Berrut and Trefethen (2004).
    """

    def __init__(self, knots: Knots) -> None:
        self.knots = checked_knots(knots, False)
        self.shape, self.domain = (len(self.knots),), (self.knots[0], self.knots[-1])
        places = np.array(self.knots)
        gaps = places[:, None] - places + np.eye(len(places))
        # Scaled by the length of the interval, so that the products neither overflow nor vanish.
        self._weights: Floats = 1 / np.prod(4 * gaps / (places[-1] - places[0]), axis=1)
        slopes = self._weights / self._weights[:, None] / gaps
        self._slopes: Floats = slopes - np.diag(slopes.sum(axis=1))

    def evaluate(self, t: Floats, orders: Sequence[int], letters: LetterValues = None) -> list[Floats]:
        """The derivatives of these orders."""
        gaps = t[..., None] - np.array(self.knots)
        at_knot = gaps == 0
        shares = self._weights / np.where(at_knot, 1.0, gaps)
        values = shares / shares.sum(axis=-1, keepdims=True)
        values = np.where(at_knot.any(axis=-1, keepdims=True), at_knot * 1.0, values)
        powers = [np.linalg.matrix_power(self._slopes, order) if order else None for order in orders]
        # Each point by itself: the bits do not depend on the others.
        return [values if power is None else np.einsum("...i,ij->...j", values, power) for power in powers]

    @property
    def is_smooth_formula(self) -> bool:
        """Always."""
        return True

    def expressions(self) -> sp.ImmutableDenseNDimArray:
        """The products."""
        knots = [exact(knot) for knot in self.knots]
        # One number before factors t - t_j, which are exact near the knots; (t - t_j)/h would become t/h - t_j/h.
        factors = [[(parameter - other, own - other) for other in knots if other != own] for own in knots]
        return sp.ImmutableDenseNDimArray(
            [sp.Mul(1 / sp.prod([h for _, h in pairs]), *(factor for factor, _ in pairs)) for pairs in factors]
        )


def lagrange_cardinals(knots: Knots) -> LagrangeCardinals:
    """Cardinal functions that are polynomials; they swing between more than six knots, which is warned of.

    Examples
    --------
    >>> lagrange_cardinals([0, 1, 2])([0.5, 1.0]).tolist()
    [[0.375, 0.75, -0.125], [0.0, 1.0, 0.0]]
    """
    if len(knots) > MOST_LAGRANGE:
        warn(f"the polynomials of Lagrange swing between {len(knots)} curves; cardinal functions of splines do not")
    return LagrangeCardinals(knots)


def named_cardinals(kind: Any, knots: Knots, closed: bool, name: str) -> Univariate:
    """Cardinal functions by name, or functions of the user's own, checked at the knots.

    "auto" is Lagrange's up to six knots and natural splines beyond; for a closed family periodic splines.
    """
    if isinstance(kind, str):
        if kind == "auto":
            kind = "spline" if closed or len(knots) > MOST_LAGRANGE else "lagrange"
        if kind in ("hermite", "spline"):
            return CubicCardinals(knots, int(kind == "spline"), closed=closed)
        if kind == "lagrange" and not closed:
            return lagrange_cardinals(knots)
        raise RsymError(
            f"cardinal functions of {name} are auto, lagrange (not of a closed family), hermite, spline, or functions; "
            f"got {kind!r}{' for a closed family' if closed else ''}",
            code="cardinals",
            remedy='"spline" suits any family',
        )
    given: Univariate
    if isinstance(kind, Univariate):
        given = kind
    else:
        given = Formula(kind, None, (knots[0], knots[-1]), closed=closed, what="a cardinal function")
    count = len(knots) - closed
    values = given(np.array(knots, np.float64)) if given.shape == (count,) else np.zeros((len(knots), 0))
    expected = np.eye(count)[np.arange(len(knots)) % count]
    if values.shape != expected.shape or np.abs(values - expected).max() > CARDINALITY:
        raise RsymError(
            f"{count} functions of {name} must be 1 at their own knot and 0 at the others {[float(k) for k in knots]}; "
            f"their values there are {np.round(values, 6).tolist()}",
            code="cardinals",
            remedy="divide by the value at the knot, or take cardinal functions by name",
        )
    return given


def checked_knots(knots: Knots, closed: bool) -> tuple[float, ...]:
    """Increasing numbers, at least two of them; for a closed family four, the last one period after the first.

    Examples
    --------
    >>> checked_knots([0, 1, 3], False)
    (0.0, 1.0, 3.0)
    """
    places = tuple(float(knot) for knot in knots)
    least = 4 if closed else 2
    if len(places) < least or not np.isfinite(places).all() or (np.diff(places) <= 0).any():
        raise RsymError(
            f"knots must be at least {least} strictly increasing numbers, got {[float(f'{one:g}') for one in places]}",
            code="knots",
            remedy="a closed family of n >= 3 curves needs n + 1 knots, the last one a period after the first"
            if closed
            else "one knot for each curve, in the order of the curves",
        )
    return places


def _system(knots: NDArray[Any], c: int, closed: bool) -> tuple[NDArray[Any], NDArray[Any]]:
    """The matrices A and B of A q = B r, in the arithmetic of the knots."""
    n = len(knots) - closed
    h = knots[1:] - knots[:-1]
    c = 1 if n == 2 else c  # Two curves: both rows of c = 0 are the same; with c = 1 the slopes are their difference.
    left, right = np.zeros((2, n, n), dtype=knots.dtype)
    for j in range(n) if closed else range(1, n - 1):
        before, after, a, b = (j - 1) % n, (j + 1) % n, h[j - 1], h[j]
        left[j, [before, j, after]] = c * b, (1 + c) * (a + b), c * a
        right[j, [before, j, after]] = -(1 + 2 * c) * b / a, (1 + 2 * c) * (b / a - a / b), (1 + 2 * c) * a / b
    if not closed:
        for end, inner, step in ((0, 1, h[0]), (-1, -2, -h[-1])):
            left[end, [end, inner]] = 1 + c, 1
            right[end, [end, inner]] = -(2 + c) / step, (2 + c) / step
    return left, right


def _cubic(knots: Sequence[float], values: sp.Matrix, slopes: sp.Matrix) -> sp.Expr:
    """The Hermite cubics from knot to knot; indices are cyclic."""
    pieces, n = [], len(values)
    for j, (start, end) in enumerate(pairwise(map(exact, knots))):
        h = end - start
        w, k = (parameter - start) / h, (j + 1) % n
        piece = values[j] * (1 - 3 * w**2 + 2 * w**3) + values[k] * (3 * w**2 - 2 * w**3)
        pieces.append((piece + h * (slopes[j] * (w - 2 * w**2 + w**3) + slopes[k] * (w**3 - w**2)), parameter < end))
    return sp.Piecewise(*pieces[:-1], (pieces[-1][0], True)) if len(pieces) > 1 else pieces[0][0]
