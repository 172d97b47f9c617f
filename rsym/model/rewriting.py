"""Functions and conditions of SymPy that rsym has no operation for: each becomes a formula in those it has.

What a shape or a program is given is rewritten once, at its door, so everything behind it knows the functions of
`rsym.model.functions` alone: secants, inverse hyperbolic functions, steps, remainders, and conditions of equality.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import sympy as sp

from rsym.model.symbols import postorder, rebuild

_HALF = sp.Rational(1, 2)


def _asinh(u: sp.Expr) -> sp.Expr:
    return sp.asinh(u, evaluate=False)


def _floor(u: sp.Expr) -> sp.Expr:
    return sp.floor(u, evaluate=False)


def _sinc(u: sp.Expr) -> sp.Expr:
    return sp.Piecewise((sp.sin(u, evaluate=False) / u, unequal(u, sp.S.Zero)), (1, True), evaluate=False)


def _heaviside(u: sp.Expr, at_zero: sp.Expr = _HALF) -> sp.Expr:
    sign = sp.sign(u, evaluate=False)
    return (1 + sign) / 2 + (at_zero - _HALF) * (1 - sign**2)


def unequal(a: sp.Expr, b: sp.Expr) -> sp.Basic:
    """The condition that two expressions differ."""
    return sp.Or(sp.Lt(a, b, evaluate=False), sp.Gt(a, b, evaluate=False), evaluate=False)


REWRITTEN: Mapping[type[sp.Basic], Callable[..., Any]] = {
    sp.sec: lambda u: 1 / sp.cos(u, evaluate=False),
    sp.csc: lambda u: 1 / sp.sin(u, evaluate=False),
    sp.sech: lambda u: 1 / sp.cosh(u, evaluate=False),
    sp.csch: lambda u: 1 / sp.sinh(u, evaluate=False),
    sp.coth: lambda u: 1 / sp.tanh(u, evaluate=False),
    sp.acot: lambda u: sp.atan(1 / u, evaluate=False),
    sp.asec: lambda u: sp.acos(1 / u, evaluate=False),
    sp.acsc: lambda u: sp.asin(1 / u, evaluate=False),
    # Two roots: below 1 one of them has no value.
    sp.acosh: lambda u: _asinh(sp.Mul(sp.sqrt(u - 1), sp.sqrt(u + 1), evaluate=False)),
    sp.atanh: lambda u: _asinh(u / sp.sqrt(sp.Mul(1 - u, 1 + u, evaluate=False))),
    sp.acoth: lambda u: _asinh(1 / sp.sqrt(sp.Mul(u - 1, u + 1, evaluate=False))) * sp.sign(u, evaluate=False),
    sp.erfc: lambda u: 1 - sp.erf(u, evaluate=False),
    sp.sinc: _sinc,
    sp.Heaviside: _heaviside,
    sp.ceiling: lambda u: -_floor(-u),
    sp.frac: lambda u: u - _floor(u),
    sp.Mod: lambda a, b: a - b * _floor(a / b),
    sp.Ne: unequal,
    sp.Eq: lambda a, b: sp.And(sp.Le(a, b, evaluate=False), sp.Ge(a, b, evaluate=False), evaluate=False),
}


def in_known_functions(expression: sp.Expr) -> sp.Expr:
    """The expression without these; what has none of them stays the object that it is.

    Examples
    --------
    >>> from rsym import x, y
    >>> in_known_functions(sp.sec(x) + sp.Heaviside(y)), in_known_functions(sp.Mod(x, 2))
    (sign(y)/2 + 1/2 + 1/cos(x), x - 2*floor(x/2))
    """
    if all(type(part) not in REWRITTEN for part in postorder(expression)):
        return expression

    def known(part: sp.Basic) -> sp.Basic | None:
        formula = REWRITTEN.get(type(part))
        return None if formula is None else formula(*part.args)

    return rebuild(expression, known)
