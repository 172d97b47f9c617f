"""Rational B-spline curves.

c(t) = sum_i w_i P_i N_(i,k)(t) / sum_i w_i N_(i,k)(t)

The quotient rule gives every derivative: c^(n) = (a^(n) - sum_(i=1..n) (n over i) w^(i) c^(n-i)) / w
(Piegl and Tiller 1997, equation 4.8).
"""

from __future__ import annotations

from collections.abc import Sequence
from math import comb
from typing import Any

import numpy as np
import sympy as sp
from numpy.typing import ArrayLike
from scipy.interpolate import PPoly

from rsym.arrays import Floats
from rsym.errors import RsymError
from rsym.surfaces.bsplines.bspline_data import fitted_curve, order_of
from rsym.surfaces.bsplines.bspline_fitting import Residual, SplineFit
from rsym.surfaces.bsplines.spline_spaces import checked_space, derivative, inner_pieces
from rsym.surfaces.functions.formulas import entries_of
from rsym.surfaces.functions.polynomials import Polynomials
from rsym.surfaces.functions.univariate import Univariate
from rsym.surfaces.parameters import LetterValues, real_array

# Share of the size of a curve by which its end may miss its start, and of its speed by which these may differ.
CLOSED = 1e-12


class Nurbs(Univariate):
    """A curve of some degree over knots, with points and weights.

    Parameters
    ----------
    degree : int
        1 or more.
    knots : array or None
        As many as points and degree + 1 together; the curve runs from knots[degree] to knots[-degree - 1]. None:
        uniform over [0, 1], open ends degree + 1 times. Closed: of one period, one more than points, or all.
    points : array (n, 3)
        The vertices.
    weights : array (n,), optional
        Positive; all 1 by default.
    closed : bool
        Whether the points go round; the first is not repeated. A curve whose end meets its start with the same
        derivative is closed in any case.

    Examples
    --------
    >>> arc = Nurbs(2, [0, 0, 0, 1, 1, 1], [[1, 0, 0], [1, 1, 0], [0, 1, 0]], [1, 0.5**0.5, 1])
    >>> arc
    Nurbs(degree 2, 3 points, t in [0, 1])
    >>> x, y, z = arc(0.3)
    >>> bool(abs(x**2 + y**2 - 1) < 1e-15), arc.closed
    (True, False)
    """

    def __init__(
        self,
        degree: int,
        knots: ArrayLike | None,
        points: ArrayLike,
        weights: ArrayLike | None = None,
        *,
        closed: bool = False,
    ) -> None:
        if isinstance(degree, bool) or not isinstance(degree, int | np.integer) or degree < 1:
            raise RsymError(f"a degree is an integer >= 1, got {degree!r}", code="degree")
        self.points = _checked_points(points)
        self.weights = _checked_weights(weights, len(self.points))
        self.space = checked_space(degree + 1, knots, len(self.points), closed, "t")
        factors = self.weights[:, None]
        self._above = self.space.spline(factors * self.points)
        self._below = None if (self.weights == self.weights[0]).all() else self.space.spline(factors)
        self.shape = (3,)
        self.domain = self.space.domain
        self.closed = closed or self._meets_itself()
        self.fit: SplineFit | None = None

    @classmethod
    def interpolate(
        cls,
        points: ArrayLike,
        order: int | None = None,
        *,
        degree: int | None = None,
        parameters: str | ArrayLike = "chord-length",
        knots: str | ArrayLike = "averaged",
        closed: bool = False,
    ) -> Nurbs:
        """The curve through points, with as many vertices and weights of 1.

        Parameters
        ----------
        points : array (n, 3)
            The data.
        order, degree : int, optional
            The order, or the degree, which is one less; cubic by default.
        parameters : "chord-length", "centripetal" or n numbers
            Of the data: shares of the chord length, of the roots of the chords, from 0 to 1 or over the interval of
            knots that are given; or given, not decreasing, and the curve runs from the first to the last. A closed
            curve has one more, which ends the period.
        knots : "averaged", "uniform" or numbers
            Means of neighbouring parameters, which always determine the curve; uniform; or given.
        closed : bool
            Whether the points go round; the first is not repeated.

        Raises
        ------
        RsymError
            For points that do not determine the vertices: the vertex without a datum of its own (Schoenberg-Whitney) is
            named.

        Examples
        --------
        >>> import numpy as np
        >>> turn = np.linspace(0, np.pi, 9)
        >>> arc = Nurbs.interpolate(np.stack([np.cos(turn), np.sin(turn), 0 * turn], axis=-1))
        >>> arc.domain, arc.order, arc.degree, arc.residual.maximum < 1e-14
        ((0.0, 1.0), 4, 3, True)
        """
        data = _checked_points(points)
        return cls._fitted(data, len(data), order_of(order, degree), parameters, knots, closed)

    @classmethod
    def least_squares(
        cls,
        points: ArrayLike,
        vertices: int,
        order: int | None = None,
        *,
        degree: int | None = None,
        parameters: str | ArrayLike = "chord-length",
        knots: str | ArrayLike = "averaged",
        closed: bool = False,
    ) -> Nurbs:
        """The curve with fewer vertices that passes points nearest; others as in `interpolate`.

        Examples
        --------
        >>> import numpy as np
        >>> t = np.linspace(0, 1, 30)
        >>> curve = Nurbs.least_squares(np.stack([t, t**2, t**3], axis=-1), 6, parameters=t)
        >>> curve(0.5).round(12).tolist(), len(curve.points)
        ([0.5, 0.25, 0.125], 6)
        """
        return cls._fitted(_checked_points(points), vertices, order_of(order, degree), parameters, knots, closed)

    @classmethod
    def _fitted(cls, data: Floats, vertices: Any, order: Any, parameters: Any, knots: Any, closed: Any) -> Nurbs:
        space, found, fit = fitted_curve(data, vertices, order, parameters, knots, bool(closed))
        curve = cls(space.degree, space.knots, found, closed=space.closed)
        curve.fit = fit
        return curve

    @property
    def degree(self) -> int:
        """The degree."""
        return self.space.degree

    @property
    def order(self) -> int:
        """The order: one more than the degree."""
        return self.space.degree + 1

    @property
    def parameters(self) -> Floats:
        """Those of the data, (n,)."""
        return self._data().parameters[0]

    @property
    def residual(self) -> Residual:
        """How far the curve passes from its data."""
        return self._data().residual

    def _data(self) -> SplineFit:
        if self.fit is None:
            raise RsymError(
                "this curve was made of vertices, not of data", code="no-data", remedy="Nurbs.interpolate(points)"
            )
        return self.fit

    @property
    def knots(self) -> Floats:
        """All knots."""
        return self.space.knots

    def evaluate(self, t: Floats, orders: Sequence[int], letters: LetterValues = None) -> list[Floats]:
        """The derivatives of these orders; at a knot those of the span that begins there."""
        if self._below is None:
            return [derivative(self._above, t, order) / self.weights[0] for order in orders]
        found: list[Floats] = []
        weights = [derivative(self._below, t, order) for order in range(max(orders, default=-1) + 1)]
        for n in range(len(weights)):
            rest = derivative(self._above, t, n)
            for i in range(1, n + 1):
                rest = rest - comb(n, i) * weights[i] * found[n - i]
            found.append(rest / weights[0])
        return [found[order] for order in orders]

    @property
    def is_smooth_formula(self) -> bool:
        """Whether there is one span alone."""
        return self.space.pieces == 1

    def expressions(self) -> sp.ImmutableDenseNDimArray:
        """The quotients in t, piecewise where there are inner knots."""
        rows = np.column_stack([self.weights[:, None] * self.points, self.weights])
        pieces = inner_pieces([PPoly.from_spline(self.space.spline(row)) for row in rows.T], self.domain)
        *above, below = entries_of(Polynomials(pieces).expressions())
        return sp.ImmutableDenseNDimArray([entry / below for entry in above], (3,))

    def __repr__(self) -> str:
        (low, high), closed = self.domain, ", closed" if self.closed else ""
        return f"Nurbs(degree {self.degree}, {len(self.points)} points, t in [{low:.6g}, {high:.6g}]{closed})"

    def _meets_itself(self) -> bool:
        """Whether the end has the point and the derivative of the start."""
        ends = self.evaluate(np.array(self.domain), [0, 1])
        sizes = np.abs(self.points - self.points[0]).max(), np.abs(ends[1]).max()
        gaps = [np.abs(one[1] - one[0]).max() for one in ends]
        return all(gap <= CLOSED * size for gap, size in zip(gaps, sizes, strict=True)) and sizes[0] > 0


def _checked_points(points: ArrayLike) -> Floats:
    given = _numbers(points, "points")
    if given.ndim != 2 or given.shape[1] != 3:
        raise RsymError(f"the points of a Nurbs must have the shape (n, 3), got {given.shape}", code="points")
    return given


def _checked_weights(weights: ArrayLike | None, count: int) -> Floats:
    if weights is None:
        return np.ones(count)
    given = _numbers(weights, "weights")
    if given.shape != (count,):
        raise RsymError(f"{count} points need {count} weights, got an array of the shape {given.shape}", code="weights")
    if (given <= 0).any():
        place = int(np.flatnonzero(given <= 0)[0])
        raise RsymError(
            f"weights must be positive, that of the point {place} is {given[place]:g}",
            code="weights",
            remedy="a curve with such a weight may run through infinity",
        )
    return given


def _numbers(given: Any, what: str) -> Floats:
    try:
        array = np.array(real_array(given))
    except (TypeError, ValueError) as error:
        raise RsymError(f"the {what} of a Nurbs must be an array of numbers: {error}", code=what) from error
    if not np.isfinite(array).all():
        place = tuple(map(int, np.argwhere(~np.isfinite(array))[0]))
        raise RsymError(f"the {what} of a Nurbs must be finite, but entry {place} is {array[place]}", code=what)
    return array
