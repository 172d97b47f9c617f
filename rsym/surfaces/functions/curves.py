"""Whatever a user means by a curve, as one: expressions, points, or a function of Python."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, TypeAlias

import numpy as np
import sympy as sp
from numpy.polynomial import chebyshev
from scipy.interpolate import CubicSpline, PPoly

from rsym.arrays import Floats
from rsym.errors import RsymError
from rsym.surfaces.functions.polynomials import Polynomials
from rsym.surfaces.functions.univariate import Formula, Univariate
from rsym.surfaces.parameters import Interval, LetterValues, as_interval, real_array

Layout: TypeAlias = Callable[[Floats], Floats]
PROBES = 5  # not 3, so that points and components cannot be mistaken for one another
# Of exp and sin, degree 24 over half a radian or so leaves nothing but rounding; more would amplify it.
DEGREE = 24
# The last coefficients of a resolved piece are below this share of the largest value.
RESOLVED = 1e-14
# A piece of 1/1024 of the interval that is still not resolved has a kink or noise in it.
DEEPEST = 10


def as_curve(
    given: Any, letters: Mapping[Any, Any] | None = None, domain: Interval = (0.0, 1.0), *, what: str = "a curve"
) -> Univariate:
    """A curve in space.

    Parameters
    ----------
    given : Univariate, three expressions, callable or points
        A `Univariate` (a `Nurbs`, say) keeps its interval. Three SymPy expressions or numbers, in one parameter, which
        may be written t, u, v or s; a function of one number; or points (n, 3), joined by a cubic spline over their
        chord length, closed if the last is the first.
    letters : mapping, optional
        Symbols or names to numbers or `rsym.Letter`: what else the expressions contain.
    domain : pair of float
        The interval of the parameter of expressions, callables and points.
    what : str
        What the curve is, for messages.

    Examples
    --------
    >>> from rsym.surfaces.symbols import t
    >>> as_curve((t, t**2, 0))(0.5).tolist()
    [0.5, 0.25, 0.0]
    >>> as_curve([[0, 0, 0], [1, 0, 0], [1, 1, 0]])([0, 0.5, 1]).tolist()
    [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0]]
    """
    if isinstance(given, Univariate):
        if given.shape != (3,):
            raise RsymError(f"{what} must have points (3,) as values, got the shape {given.shape}", code="curve")
        return given
    if callable(given):
        return Called(given, domain=domain)
    if isinstance(given, sp.MatrixBase):
        given = list(given)
    if not isinstance(given, Sequence | np.ndarray) or isinstance(given, str):
        raise _not_a_curve(given, what)
    if len(given) == 3 and all(np.ndim(part) == 0 for part in given):
        return Formula(given, letters, domain, what=what)
    try:
        points = real_array(given)
    except (TypeError, ValueError) as error:
        raise _not_a_curve(given, what) from error
    return through_points(points, domain, what=what)


def through_points(points: np.ndarray[Any, Any], domain: Interval = (0.0, 1.0), *, what: str = "a curve") -> Univariate:
    """The cubic spline through points (n, 3) over their chord length, closed if the last is the first."""
    if points.ndim != 2 or points.shape[1] != 3 or len(points) < 2 or not np.isfinite(points).all():
        raise RsymError(
            f"{what} needs two or more finite points (n, 3), got an array of the shape {points.shape}", code="curve"
        )
    chords = np.sqrt(((points[1:] - points[:-1]) ** 2).sum(axis=1))
    if (chords == 0).any():
        row = int(np.flatnonzero(chords == 0)[0])
        raise RsymError(f"{what} has the point {row} twice in a row", code="curve", remedy="leave one of them out")
    knots = np.concatenate([[0.0], np.cumsum(chords)]) / chords.sum()
    knots = domain[0] + (domain[1] - domain[0]) * knots
    knots[-1] = domain[1]
    closed = len(points) > 3 and bool((points[0] == points[-1]).all())
    spline = CubicSpline(knots, points, bc_type="periodic" if closed else "not-a-knot")
    return Polynomials(PPoly(spline.c, spline.x), closed=closed)


def _not_a_curve(given: Any, what: str) -> RsymError:
    return RsymError(
        f"{what} cannot be made of {type(given).__name__}",
        code="curve",
        remedy="give three SymPy expressions in t, a function of t, points (n, 3), or a Nurbs",
    )


class Called(Univariate):
    """A curve that a Python function gives: t to a point.

    The function takes an array (n,) and gives (n, 3), three components, or (3, n); or it takes one number and gives
    three. Derivatives that are not given come from a Chebyshev interpolant that has converged.

    Examples
    --------
    >>> circle = Called(lambda t: (np.cos(t), np.sin(t), 0 * t), domain=(0, np.pi))
    >>> circle(np.pi / 2).round(12).tolist(), (circle(0.0, 1).round(9) + 0).tolist()
    ([0.0, 1.0, 0.0], [0.0, 1.0, 0.0])
    """

    def __init__(
        self,
        function: Callable[[Any], Any],
        derivatives: Sequence[Callable[[Any], Any]] = (),
        domain: Interval = (0.0, 1.0),
        *,
        closed: bool = False,
    ) -> None:
        self.shape = (3,)
        self.domain = as_interval(domain, "a curve")
        self.closed = closed
        self.known = tuple(_vectorised(one, self.domain) for one in (function, *derivatives))

    @cached_property
    def _interpolant(self) -> Interpolant:
        return Interpolant(self.known[-1], self.domain)

    def evaluate(self, t: Floats, orders: Sequence[int], letters: LetterValues = None) -> list[Floats]:
        """The derivatives of these orders."""
        flat = t.reshape(-1)
        given = len(self.known) - 1
        parts = [
            self.known[order](flat) if order <= given else self._interpolant.derivative(flat, order - given)
            for order in orders
        ]
        return [part.reshape(*t.shape, 3) for part in parts]


def _vectorised(function: Callable[[Any], Any], domain: Interval) -> Layout:
    """The function from (n,) to (n, 3), however it is written."""
    probes = np.linspace(*domain, PROBES)
    for layout in (_by_rows, _by_components):
        try:
            found = layout(function, probes)
        except (TypeError, ValueError, IndexError):
            continue
        if found.shape == (PROBES, 3):
            return _Points(function, layout)
    try:
        found = _one_by_one(function, probes)
    except (TypeError, ValueError, IndexError) as error:
        raise RsymError(f"a curve must be a function of one number: {error}", code="curve") from error
    if found.shape != (PROBES, 3):
        raise RsymError(
            f"a curve must give points (x, y, z), got values of the shape {found.shape[1:]}",
            code="curve",
            remedy="return three coordinates, such as (cos(t), sin(t), t)",
        )
    return _Points(function, _one_by_one)


@dataclass(frozen=True)
class _Points:
    """A function from (n,) to (n, 3) that was written in one of the layouts; what is not finite is refused."""

    function: Callable[[Any], Any]
    layout: Callable[[Callable[[Any], Any], Floats], Floats]

    def __call__(self, t: Floats) -> Floats:
        found = self.layout(self.function, t)
        bad = np.isfinite(t) & ~np.isfinite(found).all(axis=-1)
        if bad.any():
            raise RsymError(f"a curve is not finite at t = {t[bad][0]:.17g}", code="curve", remedy="mend it there")
        return found


def _by_rows(function: Callable[[Any], Any], t: Floats) -> Floats:
    found = function(t)
    return np.asarray(found, np.float64) if isinstance(found, np.ndarray) else np.empty(0)


def _by_components(function: Callable[[Any], Any], t: Floats) -> Floats:
    return np.stack([np.broadcast_to(np.asarray(part, np.float64), t.shape) for part in function(t)], axis=-1)


def _one_by_one(function: Callable[[Any], Any], t: Floats) -> Floats:
    found = [np.asarray(function(float(one)), np.float64).reshape(-1) for one in t]
    return np.array(found) if found else np.empty((0, 3))


# Derivatives of functions that are known by their values alone.
class Interpolant:
    """A piecewise Chebyshev interpolant of a function of one parameter with values (n, k).

    Examples
    --------
    >>> sine = Interpolant(lambda t: np.sin(t)[:, None], (0.0, 3.0))
    >>> float(abs(sine.derivative(np.array([1.0]), 2)[0, 0] + np.sin(1.0))) < 1e-10
    True
    """

    def __init__(self, function: Callable[[Floats], Floats], domain: Interval) -> None:
        self.breaks, self.pieces = [domain[0]], list[Floats]()
        self._resolve(function, *domain, 0)

    def _resolve(self, function: Callable[[Floats], Floats], low: float, high: float, depth: int) -> None:
        nodes = chebyshev.chebpts1(DEGREE + 1)
        values = function((low + high) / 2 + (high - low) / 2 * nodes)
        coefficients = chebyshev.chebfit(nodes, values, DEGREE)
        tail = np.abs(coefficients[-3:]).max()
        if tail <= RESOLVED * max(np.abs(values).max(), np.finfo(float).tiny):
            self.breaks.append(high)
            self.pieces.append(coefficients.astype(np.float64))
        elif depth == DEEPEST:
            raise RsymError(
                f"the function is not smooth near {(low + high) / 2:.6g}: its values do not tell its derivative",
                code="not-smooth",
                remedy="give its derivatives, Called(function, (first, second, ...)), or split it there",
            )
        else:
            middle = (low + high) / 2
            self._resolve(function, low, middle, depth + 1)
            self._resolve(function, middle, high, depth + 1)

    def derivative(self, t: Floats, order: int) -> Floats:
        """The derivative of this order at parameters (n,), as (n, k)."""
        breaks = np.array(self.breaks)
        which = np.clip(np.searchsorted(breaks, t, side="right") - 1, 0, len(self.pieces) - 1)
        result = np.empty((len(t), self.pieces[0].shape[1]))
        for number in np.unique(which):
            here = which == number
            half = (breaks[number + 1] - breaks[number]) / 2
            inner = (t[here] - breaks[number]) / half - 1
            result[here] = chebyshev.chebval(inner, chebyshev.chebder(self.pieces[number], order, 1 / half)).T
        return result
