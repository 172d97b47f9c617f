"""Triply periodic surfaces: level sets of short trigonometric sums, near to minimal surfaces of the same symmetry."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeAlias

import sympy as sp

from rsym.errors import RsymError
from rsym.model.arguments import LetterMapping, default, number, positive
from rsym.model.primitives.formulas import by_differentiation
from rsym.model.shape import Shape
from rsym.model.symbols import SPACE, substitute

Sum: TypeAlias = Callable[[sp.Expr, sp.Expr, sp.Expr], sp.Expr]


def gyroid(period: Any = 1, level: Any = 0, thickness: Any = None, *, letters: LetterMapping = None) -> Shape:
    """A body of u = sin X cos Y + sin Y cos Z + sin Z cos X, with X = k x and so on, k = 2 pi/period.

    Without a thickness, what has u > level, by Rvachev's theorem: w = g/sqrt(k**2*g**2 + |grad g|**2), g = u - level,
    between -1/k and 1/k. With a thickness t, the sheet |g| <= |grad g|*tan(k*t/2)/k about u = level by the theorem: t
    thick where u runs like a sine across it. Of the gyroid (level 0) 0 to 1 % less at t = period/10, to 4 % at
    period/5.

    Normalised to order 1. Analytic everywhere for |level| other than sqrt(2), where necks close, and 3/2, the extreme;
    thin sheets too.

    Raises
    ------
    RsymError
        For a period or thickness that is not positive.

    Source: Schoen (1970).

    Examples
    --------
    >>> import rsym
    >>> rsym.compile(rsym.gyroid())([0.0, 0.125], [0.0, 0.125], [0.0, 0.125])["value"].round(12).tolist()
    [0.0, 0.159154943092]
    """
    return _periodic(_gyroid, period, level, thickness, letters)


def schwarz_p(period: Any = 1, level: Any = 0, thickness: Any = None, *, letters: LetterMapping = None) -> Shape:
    """The primitive surface: u = cos X + cos Y + cos Z; normalised to order 1, as `gyroid` is.

    Inside are the rooms at whole periods. Analytic everywhere for |level| other than 1 (where necks close)
    and 3 (where rooms vanish). A sheet is 0 to 3 % thicker than it says at t = period/10, 13 % at period/5.

    Raises
    ------
    RsymError
        As `gyroid` does.

    Source: Schwarz (1890).

    Examples
    --------
    >>> import rsym
    >>> rsym.compile(rsym.schwarz_p())([0.0, 0.25], [0.0, 0.25], [0.0, 0.25])["value"].round(12).tolist()
    [0.159154943092, 0.0]
    """
    return _periodic(_primitive, period, level, thickness, letters)


def schwarz_d(period: Any = 1, level: Any = 0, thickness: Any = None, *, letters: LetterMapping = None) -> Shape:
    """The diamond surface: u = sin X sin Y sin Z + sin X cos Y cos Z + cos X sin Y cos Z + cos X cos Y sin Z.

    Normalised to order 1, as `gyroid` is. Analytic everywhere for |level| other than 1 and sqrt(2). A sheet is 0 to 3 %
    thinner than it says at t = period/10, 10 % at period/5.

    Raises
    ------
    RsymError
        As `gyroid` does.

    Source: Schwarz (1890).

    Examples
    --------
    >>> import rsym
    >>> rsym.compile(rsym.schwarz_d())([0.0, 0.125], [0.0, 0.125], [0.0, 0.125])["value"].round(12).tolist()
    [0.0, 0.159154943092]
    """
    return _periodic(_diamond, period, level, thickness, letters)


def neovius(period: Any = 1, level: Any = 0, thickness: Any = None, *, letters: LetterMapping = None) -> Shape:
    """The surface of Neovius: u = 3 (cos X + cos Y + cos Z) + 4 cos X cos Y cos Z.

    Normalised to order 1, as `gyroid` is. Analytic everywhere for |level| other than 3/4, 1 and 13. A sheet is as
    thick as it says within 3 % at t = period/20, 13 % at period/10.

    Raises
    ------
    RsymError
        As `gyroid` does.

    Source: Neovius (1883).

    Examples
    --------
    >>> import rsym
    >>> rsym.compile(rsym.neovius())([0.0, 0.25], [0.0, 0.25], [0.0, 0.25])["value"].round(12).tolist()
    [0.159154943092, 0.0]
    """
    return _periodic(_neovius, period, level, thickness, letters)


def lidinoid(period: Any = 1, level: Any = 0, thickness: Any = None, *, letters: LetterMapping = None) -> Shape:
    """The surface of Lidin; normalised to order 1, as `gyroid` is.

    u = (sin 2X cos Y sin Z + sin X sin 2Y cos Z + cos X sin Y sin 2Z)/2
    - (cos 2X cos 2Y + cos 2Y cos 2Z + cos 2Z cos 2X)/2 + 3/20.
    Analytic everywhere for levels near 0, the critical values next to which are -0.1739 and 3/20.
    A sheet is as thick as it says within 2 % at t = period/50, 10 % at period/20.

    Raises
    ------
    RsymError
        As `gyroid` does.

    Source: Lidin and Larsson (1990).

    Examples
    --------
    >>> import rsym
    >>> bool(rsym.compile(rsym.lidinoid())(0.0, 0.0, 0.0)["value"] < 0)
    True
    """
    return _periodic(_lidinoid, period, level, thickness, letters)


def _periodic(of: Sum, period: Any, level: Any, thickness: Any, letters: LetterMapping) -> Shape:
    period, level = positive(period, "the period", letters), number(level, "the level")
    default(level, letters, "the level")
    rate = 2 * sp.pi / period
    surface = of(*SPACE) - level
    # In units of 1/k, and stretched in the end: derivatives are then free of the period.
    if thickness is None:
        body = by_differentiation(surface, SPACE)
    else:
        # Unevaluated: as nested roots, which SymPy makes of tan(pi/10), the square of it is not visibly positive.
        half = sp.tan(_half_phase(thickness, rate, letters), evaluate=False)
        slope = sp.Add(*(sp.diff(surface, symbol) ** 2 for symbol in SPACE))
        body = by_differentiation(half**2 * slope - surface**2, SPACE, half)
    stretched = substitute(body, {symbol: rate * symbol for symbol in SPACE})
    return Shape(stretched / rate, SPACE, letters=letters)


def _gyroid(a: sp.Expr, b: sp.Expr, c: sp.Expr) -> sp.Expr:
    return sp.sin(a) * sp.cos(b) + sp.sin(b) * sp.cos(c) + sp.sin(c) * sp.cos(a)


def _primitive(a: sp.Expr, b: sp.Expr, c: sp.Expr) -> sp.Expr:
    return sp.cos(a) + sp.cos(b) + sp.cos(c)


def _diamond(a: sp.Expr, b: sp.Expr, c: sp.Expr) -> sp.Expr:
    (sa, ca), (sb, cb), (sc, cc) = ((sp.sin(angle), sp.cos(angle)) for angle in (a, b, c))
    return sa * sb * sc + sa * cb * cc + ca * sb * cc + ca * cb * sc


def _neovius(a: sp.Expr, b: sp.Expr, c: sp.Expr) -> sp.Expr:
    return 3 * _primitive(a, b, c) + 4 * sp.cos(a) * sp.cos(b) * sp.cos(c)


def _lidinoid(a: sp.Expr, b: sp.Expr, c: sp.Expr) -> sp.Expr:
    turns = ((a, b, c), (b, c, a), (c, a, b))
    waves = sp.Add(*(sp.sin(2 * p) * sp.cos(q) * sp.sin(r) for p, q, r in turns))
    doubles = sp.Add(*(sp.cos(2 * p) * sp.cos(2 * q) for p, q, _ in turns))
    return (waves - doubles) / 2 + sp.Rational(3, 20)


def _half_phase(thickness: Any, rate: sp.Expr, letters: LetterMapping) -> sp.Expr:
    """k*t/2, which must be below pi/2."""
    phase = rate * positive(thickness, "the thickness", letters) / 2
    if default(phase, letters) >= sp.pi.evalf() / 2:
        raise RsymError(
            f"the thickness must be below half the period, got {thickness}",
            code="thickness",
            remedy="for a solid between two level sets combine bodies of two levels",
        )
    return phase
