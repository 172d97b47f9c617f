"""Whatever a user means by a curve, as one."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import sympy as sp
from scipy.interpolate import CubicSpline, PPoly

from rsym.errors import RsymError
from rsym.surfaces.functions.callables import Called
from rsym.surfaces.functions.polynomials import Polynomials
from rsym.surfaces.functions.univariate import Formula, Univariate
from rsym.surfaces.parameters import Interval, real_array


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
