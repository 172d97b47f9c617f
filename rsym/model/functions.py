"""The functions that a formula may name: one row each, for SymPy, for model files, and for what contracts promise.

A program knows those that are operations of its own by that name (`rsym.program.operations`); the others it rewrites.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import sympy as sp

from rsym.model.nodes import RealNode
from rsym.model.rnodes import R1Disjunction


class Softplus(RealNode):
    """log(1 + exp(u)): a maximum of u and 0 that is analytic; max(u, 0) + log(1 + exp(-|u|)) does not overflow.

    Examples
    --------
    >>> from rsym import x
    >>> Softplus(x).diff(x)
    1/(1 + exp(-x))
    >>> Softplus(sp.Integer(-40)).evalf(5), Softplus(sp.Integer(1000)).evalf(5)
    (4.2484e-18, 1000.0)
    """

    def as_roots(self) -> sp.Expr:
        """The formula."""
        return sp.log(1 + sp.exp(self.args[0]))

    def fdiff(self, argindex: int = 1) -> sp.Expr:
        """1/(1 + exp(-u))."""
        return 1 / (1 + sp.exp(-self.args[0]))

    def numeric(self, arguments: list[sp.Float]) -> sp.Expr:
        """The value, with as many more digits as the sum costs."""
        (u,) = arguments
        size = sp.exp(-abs(u))
        more = u._prec + max(0, -int(sp.log(size, 2).evalf(5)))
        return (u if u > 0 else sp.S.Zero) + sp.log(1 + sp.Float(size, precision=more)).evalf(more // 3)

    def _runtime_call(self, printer: Any) -> str:
        """log(1 + w) = 2 artanh(w/(2 + w)) loses nothing for small w."""
        (u,) = self.args
        small = sp.exp(-sp.Abs(u))
        return f"({printer._print(R1Disjunction(u, sp.S.Zero) + 2 * sp.atanh(small / (2 + small)))})"

    _numpycode = _pythoncode = _mpmathcode = _jaxcode = _torchcode = _cupycode = _runtime_call

    def _eval_is_positive(self) -> bool:
        return True

    def _eval_is_extended_positive(self) -> bool:
        return True

    def _latex(self, printer: Any, exp: str | None = None) -> str:
        text = rf"\operatorname{{softplus}}\left({printer._print(self.args[0])}\right)"
        return text if exp is None else f"{text}^{{{exp}}}"

    def _sympystr(self, printer: Any) -> str:
        return f"softplus({printer._print(self.args[0])})"


@dataclass(frozen=True)
class Function:
    """One function.

    Attributes
    ----------
    kind : type
        The class in SymPy.
    number : callable
        Its value of floats.
    operation : str
        The operation of a program that it is; "" where a program rewrites it.
    arity : (int, int or None)
        The fewest and the most arguments; None is any number.
    exact : callable, optional
        Its value of fractions, where that is one.
    sorts : bool
        Whether SymPy puts the arguments into an order of its own.
    latex : str
        How it is typeset; its name behind a backslash, where nothing is said.
    analytic : bool
        Whether it is analytic wherever it is defined; entire: it is so, and defined everywhere.
    grows : int
        1 if it grows everywhere, -1 if it falls, else 0.
    sign : str
        "odd" for the sign of the argument, "positive", else "".
    levels : bool
        Whether it tends to a value far away.
    """

    kind: type[sp.Basic]
    number: Callable[..., float]
    operation: str = ""
    arity: tuple[int, int | None] = (1, 1)
    exact: Callable[..., Fraction] | None = None
    sorts: bool = False
    latex: str = ""
    analytic: bool = False
    entire: bool = False
    grows: int = 0
    sign: str = ""
    levels: bool = False


def _sign(u: Any) -> int:
    return int(u > 0) - int(u < 0)


def _floor(u: Fraction) -> Fraction:
    return Fraction(math.floor(u))


FUNCTIONS: dict[str, Function] = {
    "abs": Function(sp.Abs, abs, exact=abs),
    "min": Function(sp.Min, min, arity=(2, None), exact=min, sorts=True),
    "max": Function(sp.Max, max, arity=(2, None), exact=max, sorts=True),
    "sin": Function(sp.sin, math.sin, "sin", analytic=True, entire=True),
    "cos": Function(sp.cos, math.cos, "cos", analytic=True, entire=True),
    "tan": Function(sp.tan, math.tan, analytic=True),
    "cot": Function(sp.cot, lambda u: 1 / math.tan(u), analytic=True),
    "asin": Function(sp.asin, math.asin, latex=r"\arcsin", grows=1),
    "acos": Function(sp.acos, math.acos, latex=r"\arccos", grows=-1),
    "atan": Function(
        sp.atan, math.atan, latex=r"\arctan", analytic=True, entire=True, grows=1, sign="odd", levels=True
    ),
    "atan2": Function(sp.atan2, math.atan2, "atan2", (2, 2), latex=r"\mathrm{atan2}"),
    "sec": Function(sp.sec, lambda u: 1 / math.cos(u)),
    "csc": Function(sp.csc, lambda u: 1 / math.sin(u)),
    "sinc": Function(sp.sinc, lambda u: math.sin(u) / u if u else 1.0, latex=r"\operatorname{sinc}"),
    "asinh": Function(
        *(sp.asinh, math.asinh, "asinh"),
        latex=r"\operatorname{arsinh}",
        analytic=True,
        entire=True,
        grows=1,
        sign="odd",
    ),
    "acosh": Function(sp.acosh, math.acosh, latex=r"\operatorname{arcosh}"),
    "atanh": Function(sp.atanh, math.atanh, latex=r"\operatorname{artanh}"),
    "floor": Function(sp.floor, lambda u: float(math.floor(u)), "floor", exact=_floor, latex=r"\operatorname{floor}"),
    "ceil": Function(
        sp.ceiling, lambda u: float(math.ceil(u)), exact=lambda u: -_floor(-u), latex=r"\operatorname{ceil}"
    ),
    "mod": Function(
        *(sp.Mod, lambda u, v: u - v * math.floor(u / v)),
        arity=(2, 2),
        exact=lambda u, v: u - v * _floor(u / v),
        latex=r"\operatorname{mod}",
    ),
    "heaviside": Function(
        *(sp.Heaviside, lambda u: (1 + _sign(u)) / 2),
        exact=lambda u: Fraction(1 + _sign(u), 2),
        latex=r"\operatorname{H}",
    ),
    "sinh": Function(sp.sinh, math.sinh, analytic=True, entire=True, grows=1, sign="odd"),
    "cosh": Function(sp.cosh, math.cosh, analytic=True, entire=True, sign="positive"),
    "tanh": Function(sp.tanh, math.tanh, analytic=True, entire=True, grows=1, sign="odd", levels=True),
    "exp": Function(sp.exp, math.exp, "exp", analytic=True, entire=True, grows=1, sign="positive", levels=True),
    "log": Function(sp.log, math.log, "log", latex=r"\ln", analytic=True, grows=1),
    "sign": Function(
        sp.sign, lambda u: float(_sign(u)), "sign", exact=lambda u: Fraction(_sign(u)), latex=r"\operatorname{sign}"
    ),
    "erf": Function(
        *(sp.erf, math.erf, "erf"),
        latex=r"\operatorname{erf}",
        analytic=True,
        entire=True,
        grows=1,
        sign="odd",
        levels=True,
    ),
    "softplus": Function(
        *(Softplus, lambda u: max(u, 0.0) + math.log1p(math.exp(-abs(u))), "softplus"),
        latex=r"\operatorname{softplus}",
        analytic=True,
        entire=True,
        grows=1,
        sign="positive",
        levels=True,
    ),
}
