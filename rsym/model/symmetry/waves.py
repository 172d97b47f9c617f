"""Waves that fold a line onto one cell: triangle, sawtooth, and their finite kin.

Each is a node of its own name that stands for a formula in plain operations.
"""

from __future__ import annotations

from typing import Any

import sympy as sp

from rsym.errors import RsymError
from rsym.model.arguments import number, whole
from rsym.model.choices import Choice
from rsym.model.nodes import Composition


class Wave(Composition):
    """A function of t, a period h, and for finite ones a number of cells."""

    word = ""

    def _sympystr(self, printer: Any) -> str:
        return f"{self.word}({', '.join(printer._print(argument) for argument in self.args)})"

    def _latex(self, printer: Any, exp: str | None = None) -> str:
        t, *indices = (printer._print(argument) for argument in self.args)
        text = rf"\operatorname{{{self.word[:3]}}}_{{{', '.join(indices)}}}\left({t}\right)"
        return text if exp is None else f"{text}^{{{exp}}}"


class TriangleWave(Wave):
    """(h/pi) asin(sin(pi t/h)): t on the cell |t| <= h/2, mirrored from cell to cell.

    Written (h/pi) atan2(sin u, |cos u|), which keeps every digit at the peaks, where asin loses half of them.
    """

    word = "triangle_wave"

    def composition(self) -> sp.Expr:
        """The formula."""
        t, period = self.args
        angle = sp.pi * t / period
        sine, cosine = sp.sin(angle, evaluate=False), sp.cos(angle, evaluate=False)
        return period / sp.pi * sp.atan2(sine, sp.Abs(cosine, evaluate=False), evaluate=False)


class SawtoothWave(Wave):
    """t - h round(t/h): t on the cell |t| <= h/2, carried along from cell to cell; it jumps on the borders."""

    word = "sawtooth_wave"

    def composition(self) -> sp.Expr:
        """The formula, (h/(2 pi)) atan2(sin(2 pi t/h), cos(2 pi t/h))."""
        t, period = self.args
        angle = 2 * sp.pi * t / period
        sine, cosine = sp.sin(angle, evaluate=False), sp.cos(angle, evaluate=False)
        return period / (2 * sp.pi) * sp.atan2(sine, cosine, evaluate=False)


class TriangleRow(Wave):
    """The triangle wave on the cells 0 to n - 1, straight on outside of them.

    A sum of clips, one a cell, with alternating signs: at most two of them vary
    near a point, and nothing is singular but the borders between the cells.
    """

    word = "triangle_wave"

    def composition(self) -> sp.Expr:
        """Return min(t, h/2) + sum_j (-1)**j clip(t - (j - 1/2) h, 0, h) + (-1)**(n-1) max(t - (n - 3/2) h, 0)."""
        t, period, count = self.args
        cells = int(count)
        half = sp.Rational(1, 2)
        first = sp.Min(t, half * period, evaluate=False)
        last = sp.Max(t - (cells - 3 * half) * period, sp.S.Zero, evaluate=False)
        inner = [(-1) ** j * _clip(t - (j - half) * period, period) for j in range(1, cells - 1)]
        return sp.Add(first, *inner, (-1) ** (cells - 1) * last)


class SawtoothRow(Wave):
    """The sawtooth on the cells 0 to n - 1, straight on outside of them: a step down beyond each border.

    The border itself belongs to the cell before it, as with the endless wave, so that it is defined everywhere.
    """

    word = "sawtooth_wave"

    def composition(self) -> sp.Expr:
        """Return t - h sum_j [t > (j - 1/2) h], j = 1..n - 1."""
        t, period, count = self.args
        steps = [Choice(t, (j - sp.Rational(1, 2)) * period, sp.S.One, sp.S.Zero) for j in range(1, int(count))]
        return t - period * sp.Add(*steps)


def triangle_wave(t: Any, period: Any, terms: Any = None) -> sp.Expr:
    """The wave that folds a line onto the cell |t| <= h/2, every second cell mirrored.

    exact: (h/pi) asin(sin(pi t/h)), slope 1 and -1 in turn, kinks at t = (k + 1/2) h
    N terms: (4 h/pi**2) sum_{k=1..N} (-1)**(k+1) sin((2k - 1) pi t/h)/(2k - 1)**2, analytic,
    off by h/(pi**2 N) on the kinks and by a share of 1/N**2 between them.

    Parameters
    ----------
    t : expression
        Where, in any unit.
    period : number or expression
        h > 0, the width of a cell, in the unit of t; the wave repeats after 2 h.
    terms : integer, optional
        N; without it the exact wave.

    Raises
    ------
    RsymError
        For a period that is a number and not positive, or terms that are not a positive integer.

    Source: Maksimenko-Sheiko and Sheiko (2008).

    Examples
    --------
    >>> from rsym import x
    >>> [triangle_wave(x, 2).subs(x, place).evalf(3) for place in (0.5, 1, 1.5, 2.5)]
    [0.500, 1.00, 0.500, -0.500]
    """
    t, period = number(t, "the place"), number(period, "the period")
    if period.is_nonpositive:
        raise RsymError(f"the period must be positive, got {period}", code="positive")
    if terms is None:
        return TriangleWave(t, period)
    orders = [2 * k - 1 for k in range(1, whole(terms, "the number of terms", 1) + 1)]
    sines = [(-1) ** (k // 2) * sp.sin(k * sp.pi * t / period, evaluate=False) / sp.Integer(k) ** 2 for k in orders]
    return 4 * period / sp.pi**2 * sp.Add(*sines)


def _clip(t: sp.Expr, upper: sp.Expr) -> sp.Expr:
    return sp.Max(sp.S.Zero, sp.Min(t, upper, evaluate=False), evaluate=False)
