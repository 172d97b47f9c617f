"""Other parameters for the same curve: a part of it, another start, or a given pace."""

from __future__ import annotations

from collections.abc import Sequence
from math import comb

import numpy as np
import sympy as sp
from scipy.interpolate import CubicHermiteSpline, CubicSpline, PchipInterpolator

from rsym.arrays import Floats
from rsym.surfaces.functions.formulas import exact
from rsym.surfaces.functions.polynomials import Polynomials
from rsym.surfaces.functions.univariate import Univariate
from rsym.surfaces.parameters import Interval, LetterValues, inside
from rsym.surfaces.symbols import t as parameter

# A spline that slows down to less than this share of a chord's slope crowds the lines of a surface and bends it.
SLOWEST = 0.25


class Part(Univariate):
    """A curve over a part of its interval; of one whose ends meet, over a whole turn from another start."""

    def __init__(self, curve: Univariate, domain: Interval, *, closed: bool = False) -> None:
        self.curve, self.domain, self.closed = curve, domain, closed
        self.shape, self.letters = curve.shape, curve.letters

    def evaluate(self, t: Floats, orders: Sequence[int], letters: LetterValues = None) -> list[Floats]:
        """The derivatives of these orders."""
        return self.curve.evaluate(inside(t, self.curve.domain, self.closed, "t"), orders, letters)

    @property
    def is_smooth_formula(self) -> bool:
        """Whether the curve is, and does not start anew inside."""
        return self.curve.is_smooth_formula and self._stays

    @property
    def _stays(self) -> bool:
        (a, b), (c, d) = self.domain, self.curve.domain
        return c <= a and b <= d

    def expressions(self) -> sp.ImmutableDenseNDimArray | None:
        """The formula of the curve, with a jump of the parameter where a turn ends."""
        whole = self.curve.expressions()
        return whole if whole is None or self._stays else whole.xreplace({parameter: _turned(parameter, self.curve)})


class Composed(Univariate):
    """A curve at another pace, c(m(t)), with a smooth increasing function m; exact, no curve is fitted."""

    def __init__(self, curve: Univariate, pace: Univariate, *, closed: bool = False) -> None:
        self.curve, self.pace, self.closed = curve, pace, closed
        self.shape, self.domain, self.letters = curve.shape, pace.domain, curve.letters

    def evaluate(self, t: Floats, orders: Sequence[int], letters: LetterValues = None) -> list[Floats]:
        """The derivatives of these orders, by the formula of Faa di Bruno."""
        top = max(orders)
        pace = self.pace.evaluate(t, list(range(top + 1)))
        inner = inside(pace[0], self.curve.domain, self.closed, "t")
        outer = self.curve.evaluate(inner, list(range(top + 1)), letters)
        bell = _bell(pace, top)
        stretch = (..., *(None for _ in self.shape))
        return [
            sum((bell[order][m][stretch] * outer[m] for m in range(1, order + 1)), np.zeros(())) if order else outer[0]
            for order in orders
        ]

    def expressions(self) -> sp.ImmutableDenseNDimArray | None:
        """The formula of the curve at the pace."""
        whole, pace = self.curve.expressions(), self.pace.expressions()
        if whole is None or pace is None:
            return None
        return whole.xreplace({parameter: _turned(pace[()], self.curve) if self.closed else pace[()]})


def _turned(place: sp.Expr, curve: Univariate) -> sp.Expr:
    """A parameter up to one turn off the interval of a curve, brought back to it."""
    low, high = map(exact, curve.domain)
    length = high - low
    return sp.Piecewise((place + length, place < low), (place - length, place > high), (place, True))


def _bell(pace: Sequence[Floats], top: int) -> list[list[Floats]]:
    """The partial Bell polynomials of the derivatives of the pace, by order and number of parts."""
    zero = np.zeros_like(pace[0])
    table = [[zero + 1.0]]
    for k in range(1, top + 1):
        row = [zero]
        for m in range(1, k + 1):
            row.append(sum((comb(k - 1, i - 1) * pace[i] * table[k - i][m - 1] for i in range(1, k - m + 2)), zero))
        table.append([*row, *(zero for _ in range(top - k))])
    return table


def increasing(knots: Floats, values: Floats, *, closed: bool = False) -> Polynomials:
    """An increasing cubic with these increasing values at the knots; if closed, smooth across the last one too.

    The natural or periodic spline, C2, if it nowhere rises less than a quarter as fast as the chord there. Otherwise
    the C1 interpolant of Fritsch and Butland (PCHIP), whose slopes never vanish inside; those at the ends are held at a
    third of the chord's or above, where a vanishing one would make a surface singular along its edge.

    Examples
    --------
    >>> smooth = increasing(np.array([0.0, 1.0, 2.0]), np.array([0.0, 1.0, 3.0]))
    >>> smooth([0.0, 1.0, 2.0], 1).tolist(), smooth([0.0, 2.0], 2).tolist()
    ([0.75, 1.5, 2.25], [0.0, 0.0])
    >>> steep = increasing(np.array([0.0, 1.0, 2.0]), np.array([0.0, 1.0, 8.0]))
    >>> steep([0.0, 1.0, 2.0]).tolist(), steep([0.0, 1.0, 2.0], 1).tolist()
    ([0.0, 1.0, 8.0], [0.3333333333333333, 1.75, 10.0])
    """
    chords = np.diff(values) / np.diff(knots)
    # A closed pace is a turn at the mean speed and what repeats itself.
    mean = (values[-1] - values[0]) / (knots[-1] - knots[0]) if closed else 0.0
    rest = values - mean * (knots - knots[0])
    rest[-1] = rest[0] if closed else rest[-1]
    spline = CubicSpline(knots, rest, bc_type="periodic" if closed else "natural")
    slopes = spline(knots, 1) + mean
    third, second, first = spline.c[:3]
    turns = np.clip(-second / np.where(third == 0, 1.0, 3 * third), 0, np.diff(knots))
    slowest = np.minimum.reduce([slopes[:-1], slopes[1:], first + mean + turns * (2 * second + 3 * third * turns)])
    if (slowest < SLOWEST * chords).any():
        slopes = _local_slopes(knots, values, closed)
    return Polynomials(CubicHermiteSpline(knots, values, slopes))


def _local_slopes(knots: Floats, values: Floats, closed: bool) -> Floats:
    """Slopes of PCHIP, with those of the ends mended."""
    if closed:
        turn = knots[-1] - knots[0], values[-1] - values[0]
        pairs = zip((knots, values), turn, strict=True)
        around = [np.concatenate([one[-3:-1] - whole, one, one[1:3] + whole]) for one, whole in pairs]
        return np.asarray(PchipInterpolator(*around).derivative()(knots))
    chords = np.diff(values) / np.diff(knots)
    slopes = PchipInterpolator(knots, values).derivative()(knots)
    slopes[0], slopes[-1] = max(slopes[0], chords[0] / 3), max(slopes[-1], chords[-1] / 3)
    return np.asarray(slopes)
