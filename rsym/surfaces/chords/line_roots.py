"""All roots of a function of one parameter on an interval, none overlooked: intervals exclude, signs bracket."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeAlias

import numpy as np
import sympy as sp
from numpy.typing import NDArray
from scipy.optimize import brentq

from rsym.bounds.intervals import IntervalFunction
from rsym.errors import RsymError
from rsym.model.letters import Letters
from rsym.surfaces.functions.formulas import CompiledFormulas
from rsym.surfaces.symbols import t

Array: TypeAlias = NDArray[np.float64]

PIECES = 64
# Pieces left open at once. A simple root keeps one, a double root a few dozen; thousands mean a function that is 0
# along a stretch or undefined there.
MOST = 4096
# Of the interval; shorter pieces are points to float64.
SHORTEST = 1e-14


def roots_between(expression: sp.Expr, low: float, high: float) -> tuple[list[sp.Expr], Callable[[float], int]]:
    """The roots in [low, high] of an expression in t, and its sign as a function of a number.

    Examples
    --------
    >>> roots, sign = roots_between(sp.exp(t) - 2, 0.0, 1.0)
    >>> [round(float(root), 12) for root in roots], sign(0.5), sign(0.75)
    ([0.69314718056], -1, 1)
    """
    formulas = CompiledFormulas([expression], (t.name,), Letters({}), ((low, high),))

    def value(place: float) -> float:
        return float(formulas.evaluate([np.array([place])], [(0,)], {})[0][0, 0])

    function = IntervalFunction(formulas.program([(0,), (1,)]))
    edges = np.linspace(low, high, PIECES + 1)
    lower, upper = edges[:-1], edges[1:]
    found: list[float] = []
    while len(lower):
        doubtful, monotone = _sorted(function, lower, upper)
        found += [root for a, b in zip(lower[monotone], upper[monotone], strict=True) for root in _single(value, a, b)]
        short = doubtful & (upper - lower <= SHORTEST * (high - low))
        found += ((lower[short] + upper[short]) / 2).tolist()
        lower, upper = _halved(lower[doubtful & ~short], upper[doubtful & ~short])
        if len(lower) > MOST:
            raise RsymError(
                f"where {expression} vanishes along the line cannot be told",
                code="undecided",
                remedy="describe the boundary of the domain by functions that are defined and not 0 along a stretch",
            )
    return [sp.Float(root) for root in sorted(found)], lambda place: int(np.sign(value(place)))


def _sorted(function: IntervalFunction, lower: Array, upper: Array) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Which pieces may hold any number of roots, and which at most one."""
    value, slope = (function([lower], [upper])[name] for name in ("0_0", "0_1"))
    possible = (value[0] <= 0) & (value[1] >= 0)
    monotone = possible & ((slope[0] > 0) | (slope[1] < 0))
    return possible & ~monotone, monotone


def _single(value: Callable[[float], float], low: float, high: float) -> list[float]:
    """The root of a monotone function between two numbers, if there is one."""
    first, last = value(low), value(high)
    if first == 0 or last == 0:
        return [low if first == 0 else high]
    return [float(brentq(value, low, high, xtol=1e-300, rtol=4 * np.finfo(float).eps))] if first * last < 0 else []


def _halved(lower: Array, upper: Array) -> tuple[Array, Array]:
    middle = (lower + upper) / 2
    return np.concatenate([lower, middle]), np.concatenate([middle, upper])
