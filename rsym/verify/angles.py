"""Angles that fold: roots and arcs of sines and cosines, with their corners as zeros of moduli."""

from __future__ import annotations

import sympy as sp


def unfolded(part: sp.asin | sp.acos) -> sp.Expr | None:
    """The arc of the sine or cosine of an angle, by both of them: analytic but where a modulus is zero.

    Examples
    --------
    >>> from rsym import x
    >>> unfolded(sp.asin(sp.sin(x))), unfolded(sp.asin(x))
    (atan2(sin(x), Abs(cos(x))), None)
    """
    (inner,) = part.args
    if not isinstance(inner, sp.sin | sp.cos):
        return None
    other = sp.cos if isinstance(inner, sp.sin) else sp.sin
    arc = sp.atan2(inner, sp.Abs(other(inner.args[0])))
    return arc if isinstance(part, sp.asin) else sp.pi / 2 - arc


def root_of_angles(part: sp.Pow) -> sp.Expr | None:
    """A root with a(1 - cos(u)), a(1 + sin(u)), a(1 - cos(u)**2) and the like under it written as a square.

    Examples
    --------
    >>> from rsym import x
    >>> root_of_angles(sp.sqrt(1 - sp.cos(x)))
    sqrt(2)*Abs(sin(x/2))
    """
    factors = sp.Mul.make_args(part.base)
    squared = [_square_of_angle(factor) or factor for factor in factors]
    return None if squared == list(factors) else sp.Pow(sp.Mul(*squared), part.exp)


def _square_of_angle(factor: sp.Expr) -> sp.Expr | None:
    """A term a(1 - cos(u)), a > 0, and the like as a multiple of a square."""
    constant, rest = factor.as_independent(sp.sin, sp.cos, as_Add=True)
    coefficient, wave = rest.as_independent(sp.sin, sp.cos, as_Add=False)
    base, exponent = wave.as_base_exp()
    if not (isinstance(base, sp.sin | sp.cos) and constant.is_positive):
        return None  # the root of cos(u) - 1 is defined at points alone
    if exponent == 2 and constant == -coefficient:
        return constant * (sp.cos if isinstance(base, sp.sin) else sp.sin)(base.args[0]) ** 2
    if exponent != 1 or constant not in (coefficient, -coefficient):
        return None
    angle = base.args[0] if isinstance(base, sp.cos) else sp.pi / 2 - base.args[0]
    half = sp.sin if constant == -coefficient else sp.cos
    return 2 * constant * half(angle / 2) ** 2
