"""A choice between two formulas: what SymPy's Piecewise is, but one choice may stand in the condition of another."""

from __future__ import annotations

from typing import Any

import sympy as sp

from rsym.model.nodes import RealNode


class Choice(RealNode):
    """Choice(a, b, yes, no): `yes` where a > b, `no` elsewhere, each differentiated on its own.

    SymPy folds a Piecewise that it finds in a condition, which fails as soon as two symbols are compared.
    """

    runtime_name = "choice"

    def as_roots(self) -> sp.Expr:
        """The Piecewise."""
        a, b, yes, no = self.args
        return sp.Piecewise((yes, sp.StrictGreaterThan(a, b, evaluate=False)), (no, True), evaluate=False)

    def fdiff(self, argindex: int = 1) -> sp.Expr:
        """0 for what is compared, 1 for the formula that is chosen."""
        a, b, _, _ = self.args
        return sp.S.Zero if argindex <= 2 else self.func(a, b, sp.Integer(argindex == 3), sp.Integer(argindex == 4))

    def _eval_evalf(self, precision: int) -> sp.Expr:
        """The chosen formula alone: the other need not be real there."""
        a, b, yes, no = self.args
        gap = (a - b).evalf(precision // 3)
        if not (gap.is_Float or gap.is_Rational):
            return self
        return (yes if gap > 0 else no).evalf(precision // 3)

    def _latex(self, printer: Any, exp: str | None = None) -> str:
        a, b, yes, no = (printer._print(argument) for argument in self.args)
        text = rf"\begin{{cases}} {yes} & {a} > {b} \\ {no} & \text{{otherwise}} \end{{cases}}"
        return text if exp is None else rf"\left({text}\right)^{{{exp}}}"

    def _sympystr(self, printer: Any) -> str:
        a, b, yes, no = (printer._print(argument) for argument in self.args)
        return f"({yes} if {a} > {b} else {no})"
