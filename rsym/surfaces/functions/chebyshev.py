"""Derivatives of functions that are known by their values alone.

A function is replaced, piece by piece, by the Chebyshev interpolant whose
coefficients have fallen to rounding; that is differentiated exactly.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeAlias

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import NDArray

from rsym.errors import RsymError
from rsym.surfaces.parameters import Interval

Array: TypeAlias = NDArray[np.float64]

# Of exp and sin, degree 24 over half a radian or so leaves nothing but rounding; more would amplify it.
DEGREE = 24
# The last coefficients of a resolved piece are below this share of the largest value.
RESOLVED = 1e-14
# A piece of 1/1024 of the interval that is still not resolved has a kink or noise in it.
DEEPEST = 10


class Interpolant:
    """A piecewise Chebyshev interpolant of a function of one parameter with values (n, k).

    Examples
    --------
    >>> sine = Interpolant(lambda t: np.sin(t)[:, None], (0.0, 3.0))
    >>> float(abs(sine.derivative(np.array([1.0]), 2)[0, 0] + np.sin(1.0))) < 1e-10
    True
    """

    def __init__(self, function: Callable[[Array], Array], domain: Interval) -> None:
        self.breaks, self.pieces = [domain[0]], list[Array]()
        self._resolve(function, *domain, 0)

    def _resolve(self, function: Callable[[Array], Array], low: float, high: float, depth: int) -> None:
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

    def derivative(self, t: Array, order: int) -> Array:
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
