"""Powers of absolute values: nodes with derivatives of their own, where SymPy's would end in Dirac impulses."""

from __future__ import annotations

from typing import Any

import sympy as sp

from rsym.model.nodes import RealNode


def absolute_power(base: sp.Expr, exponent: sp.Expr) -> sp.Expr:
    """|u|**a, an ordinary power where a is an even integer."""
    return base**exponent if exponent.is_Integer and exponent % 2 == 0 else AbsolutePower(base, exponent)


def signed_power(base: sp.Expr, exponent: sp.Expr) -> sp.Expr:
    """sign(u) |u|**a, an ordinary power where a is an odd integer."""
    return base**exponent if exponent.is_Integer and exponent % 2 == 1 else SignedPower(base, exponent)


def plain_absolute_power(base: sp.Expr, exponent: sp.Expr) -> sp.Expr:
    """|u|**a without a node."""
    return base**exponent if exponent.is_Integer and exponent % 2 == 0 else sp.Abs(base, evaluate=False) ** exponent


class AbsolutePower(RealNode):
    """|u|**a; its derivative is a sign(u) |u|**(a - 1)."""

    runtime_name, of_shapes = "absolute_power", True

    def _eval_is_nonnegative(self) -> bool:
        return True

    def _eval_is_extended_nonnegative(self) -> bool:
        return True

    def as_roots(self) -> sp.Expr:
        """The formula."""
        return plain_absolute_power(*self.args)

    def fdiff(self, argindex: int = 1) -> sp.Expr:
        """A sign(u) |u|**(a - 1), and |u|**a log|u| by the exponent, which is a letter at most."""
        base, exponent = self.args
        return exponent * signed_power(base, exponent - 1) if argindex == 1 else self * sp.log(sp.Abs(base))

    def numeric(self, arguments: list[sp.Float]) -> sp.Expr:
        """The value."""
        return abs(arguments[0]) ** arguments[1]

    def _latex(self, printer: Any, exp: str | None = None) -> str:
        text = rf"\left|{printer._print(self.args[0])}\right|^{{{printer._print(self.args[1])}}}"
        return text if exp is None else rf"\left({text}\right)^{{{exp}}}"

    def _sympystr(self, printer: Any) -> str:
        return f"|{printer._print(self.args[0])}|**{_bracketed(self.args[1], printer)}"


class SignedPower(RealNode):
    """sign(u) |u|**a; its derivative is a |u|**(a - 1). For a = 0 it is undefined at u = 0."""

    runtime_name = "signed_power"

    def as_roots(self) -> sp.Expr:
        """The formula."""
        return self.args[0] * sp.Abs(self.args[0], evaluate=False) ** (self.args[1] - 1)

    def fdiff(self, argindex: int = 1) -> sp.Expr:
        """A |u|**(a - 1), and sign(u) |u|**a log|u| by the exponent."""
        base, exponent = self.args
        return exponent * absolute_power(base, exponent - 1) if argindex == 1 else self * sp.log(sp.Abs(base))

    def numeric(self, arguments: list[sp.Float]) -> sp.Expr:
        """The value."""
        base, exponent = arguments
        if base == 0:
            return sp.S.NaN if exponent <= 0 else sp.S.Zero
        return base * abs(base) ** (exponent - 1)

    def _latex(self, printer: Any, exp: str | None = None) -> str:
        base, power = (printer._print(argument) for argument in self.args)
        text = rf"\operatorname{{sgn}}\left({base}\right)"
        if self.args[1] != 0:
            text += rf" \left|{base}\right|^{{{power}}}"
        return text if exp is None else rf"\left({text}\right)^{{{exp}}}"

    def _sympystr(self, printer: Any) -> str:
        base, exponent = self.args
        power = "" if exponent == 0 else f"*|{printer._print(base)}|**{_bracketed(exponent, printer)}"
        return f"sign({printer._print(base)}){power}"


def _bracketed(exponent: sp.Expr, printer: Any) -> str:
    text: str = printer._print(exponent)
    return text if exponent.is_Symbol or exponent.is_Integer else f"({text})"
