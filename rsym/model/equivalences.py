"""Equivalence and joining: nodes whose zero set is the union of the zero sets of their operands."""

from __future__ import annotations

from typing import Any

import sympy as sp

from rsym.model.folds import Fold
from rsym.model.powers import absolute_power, plain_absolute_power, signed_power


class EquivalenceOperation(Fold):
    """f g/(|f|**m + |g|**m)**(1/m) up to sign; associative; with normalised operands normalised to order m."""

    parameter_count = 1

    def _powers(self, f: sp.Expr, g: sp.Expr) -> sp.Expr:
        (m,) = self.parameters
        return absolute_power(f, m) + absolute_power(g, m)

    def _root(self, f: sp.Expr, g: sp.Expr) -> sp.Expr:
        (m,) = self.parameters
        return (plain_absolute_power(f, m) + plain_absolute_power(g, m)) ** (1 / m)

    def _size(self, f: sp.Float, g: sp.Float, m: sp.Float) -> sp.Expr:
        """The absolute value: the smaller size over (1 + ratio**m)**(1/m), 0 if one operand is."""
        small, large = sorted((abs(f), abs(g)))
        return sp.S.Zero if small == 0 else small / (1 + (small / large) ** m) ** (1 / m)

    def _sympystr(self, printer: Any) -> str:
        name = type(self).__name__.lower()
        operands = ", ".join(printer._print(operand) for operand in self.operands)
        return f"{name}({operands}, order={printer._print(self.parameters[0])})"


class Equivalence(EquivalenceOperation):
    """f g/(|f|**m + |g|**m)**(1/m): positive where the signs agree."""

    runtime_name = "equivalence"

    def pair_as_roots(self, f: sp.Expr, g: sp.Expr) -> sp.Expr:
        """The formula."""
        return f * g / self._root(f, g)

    def partial(self, f: sp.Expr, g: sp.Expr) -> sp.Expr:
        """Return sign(g) (|g|/N)**(m + 1) with N = (|f|**m + |g|**m)**(1/m)."""
        (m,) = self.parameters
        return signed_power(g, m + 1) / self._powers(f, g) ** ((m + 1) / m)

    def pair_numeric(self, f: sp.Float, g: sp.Float, *parameters: sp.Float) -> sp.Expr:
        """The value, stable at zero."""
        return sp.sign(f) * sp.sign(g) * self._size(f, g, *parameters)

    def infix(self, printer: Any) -> str:
        """A tilde with the order below."""
        return rf"\sim_{{{printer._print(self.parameters[0])}}}"


class Joining(EquivalenceOperation):
    """|f| |g|/(|f|**m + |g|**m)**(1/m): never negative, zero where one operand is."""

    runtime_name = "joining"

    @classmethod
    def alone(cls, operand: sp.Expr) -> sp.Expr:
        """The absolute value."""
        return operand if operand.is_nonnegative else absolute_power(operand, sp.S.One)

    def _eval_is_nonnegative(self) -> bool:
        return True

    def _eval_is_extended_nonnegative(self) -> bool:
        return True

    def pair_as_roots(self, f: sp.Expr, g: sp.Expr) -> sp.Expr:
        """The formula."""
        size = [h if h.is_nonnegative else plain_absolute_power(h, sp.S.One) for h in (f, g)]
        return size[0] * size[1] / self._root(f, g)

    def partial(self, f: sp.Expr, g: sp.Expr) -> sp.Expr:
        """Return sign(f) (|g|/N)**(m + 1) with N = (|f|**m + |g|**m)**(1/m); undefined at f = 0 if f changes sign."""
        (m,) = self.parameters
        sign = sp.S.One if f.is_nonnegative else signed_power(f, sp.S.Zero)
        return sign * absolute_power(g, m + 1) / self._powers(f, g) ** ((m + 1) / m)

    def pair_numeric(self, f: sp.Float, g: sp.Float, *parameters: sp.Float) -> sp.Expr:
        """The value, stable at zero."""
        return self._size(f, g, *parameters)

    def infix(self, printer: Any) -> str:
        """A cup with the order below."""
        return rf"\cup_{{{printer._print(self.parameters[0])}}}"
