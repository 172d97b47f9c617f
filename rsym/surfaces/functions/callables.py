"""Python functions as curves."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, TypeAlias

import numpy as np
from numpy.polynomial import chebyshev

from rsym.arrays import Floats
from rsym.errors import RsymError
from rsym.surfaces.functions.univariate import LetterValues, Univariate
from rsym.surfaces.parameters import Interval, as_interval

Layout: TypeAlias = Callable[[Floats], Floats]

PROBES = 5  # not 3, so that points and components cannot be mistaken for one another

# Of exp and sin, degree 24 over half a radian or so leaves nothing but rounding; more would amplify it.
DEGREE = 24
# The last coefficients of a resolved piece are below this share of the largest value.
RESOLVED = 1e-14
# A piece of 1/1024 of the interval that is still not resolved has a kink or noise in it.
DEEPEST = 10


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
