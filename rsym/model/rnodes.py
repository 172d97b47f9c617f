"""R-nodes: one SymPy function per operation and system, never expanded on its own.

A node is n-ary and flat and *means* the left fold: R_0 is not associative, so
neither the order nor the grouping of its operands is ever changed.
"""

from __future__ import annotations

from typing import Any, ClassVar

import sympy as sp

from rsym.model.nodes import Ahead, RealNode


class ROperation(RealNode):
    """A conjunction or disjunction: parameters of the system first, then two or more operands."""

    parameter_count: ClassVar[int] = 0
    sign: ClassVar[int]  # -1 for conjunction, +1 for disjunction
    symbol: ClassVar[str]  # in LaTeX

    def __new__(cls, *arguments: Any, **options: Any) -> sp.Expr:
        """Flatten on the left, where the fold begins; a single operand is itself."""
        arguments = tuple(sp.sympify(argument, strict=True) for argument in arguments)
        parameters, operands = arguments[: cls.parameter_count], arguments[cls.parameter_count :]
        if operands and type(operands[0]) is cls and operands[0].parameters == parameters:
            operands = (*operands[0].operands, *operands[1:])
        if len(operands) == 1:
            return operands[0]
        return super().__new__(cls, *parameters, *operands, **options)

    @property
    def parameters(self) -> tuple[sp.Expr, ...]:
        """alpha, m or p of the system."""
        return tuple(self.args[: self.parameter_count])

    @property
    def operands(self) -> tuple[sp.Expr, ...]:
        """What is combined, in the order of the fold."""
        return tuple(self.args[self.parameter_count :])

    @property
    def head(self) -> sp.Expr:
        """The fold of all operands but the last."""
        return self.func(*self.args[:-1])

    def pair_as_roots(self, f: sp.Expr, g: sp.Expr) -> sp.Expr:
        """The operation on two operands in plain arithmetic."""
        raise NotImplementedError

    def partial(self, f: sp.Expr, g: sp.Expr) -> sp.Expr:
        """The derivative of the operation on two operands with respect to the first (it is symmetric)."""
        raise NotImplementedError

    def pair_numeric(self, f: sp.Float, g: sp.Float) -> sp.Expr:
        """The operation on two numbers, free of cancellation."""
        raise NotImplementedError

    def as_roots(self) -> sp.Expr:
        """The left fold in plain arithmetic."""
        result, *rest = self.operands
        for operand in rest:
            result = self.pair_as_roots(result, operand)
        return result

    def numeric(self, arguments: list[sp.Float]) -> sp.Expr:
        """The left fold of numbers."""
        result, *rest = arguments[self.parameter_count :]
        for operand in rest:
            result = self.pair_numeric(result, operand)
        return result

    def fdiff(self, argindex: int = 1) -> sp.Expr:
        """The partial derivative with respect to one operand, R-nodes kept."""
        if argindex <= self.parameter_count:
            return sp.S.Zero  # parameters of the system are never differentiated through
        position = argindex - self.parameter_count
        fold, last = self.head, self.operands[-1]
        if position == len(self.operands):
            return self.partial(last, fold)
        outer = self.partial(fold, last)
        return outer if len(self.operands) == 2 else outer * fold.fdiff(argindex)

    def _latex(self, printer: Any, exp: str | None = None) -> str:
        parts = [_bracketed(operand, printer) for operand in self.operands]
        text = rf"\left({f' {self.symbol} '.join(parts)}\right)"
        return text if exp is None else f"{text}^{{{exp}}}"

    def _sympystr(self, printer: Any) -> str:
        name = "conjunction" if self.sign < 0 else "disjunction"
        operands = ", ".join(printer._print(operand) for operand in self.operands)
        return f"{name}({operands}{self._system_text(printer)})"

    def _system_text(self, printer: Any) -> str:
        return ""


class R0Operation(ROperation):
    """System R_0: f + g -+ sqrt(f**2 + g**2)."""

    def pair_as_roots(self, f: sp.Expr, g: sp.Expr) -> sp.Expr:
        """Return f + g + s*sqrt(f**2 + g**2), s = -1 for conjunction."""
        return f + g + self.sign * sp.sqrt(f**2 + g**2)

    def partial(self, f: sp.Expr, g: sp.Expr) -> sp.Expr:
        """Return 1 + s*f/sqrt(f**2 + g**2)."""
        return 1 + self.sign * f / sp.sqrt(f**2 + g**2)

    def pair_numeric(self, f: sp.Float, g: sp.Float) -> sp.Expr:
        """Where the terms cancel, the product form 2 f g / (f + g - s r)."""
        root, total = sp.sqrt(f**2 + g**2), f + g
        cancels = total * self.sign < 0
        return 2 * f * g / (total - self.sign * root) if cancels else total + self.sign * root


class R0Conjunction(R0Operation):
    """Conjunction of system R_0."""

    sign = -1
    symbol = r"\wedge_0"
    runtime_name = "r0_conjunction"


class R0Disjunction(R0Operation):
    """Disjunction of system R_0."""

    sign = 1
    symbol = r"\vee_0"
    runtime_name = "r0_disjunction"


class R1Operation(ROperation):
    """System R_1: (f + g -+ |f - g|)/2, that is min and max."""

    def pair_as_roots(self, f: sp.Expr, g: sp.Expr) -> sp.Expr:
        """Return (f + g + s*|f - g|)/2, s = -1 for conjunction."""
        return (f + g + self.sign * sp.Abs(f - g, evaluate=False)) / 2

    def partial(self, f: sp.Expr, g: sp.Expr) -> sp.Expr:
        """Return 1 where f decides, 0 where g does, undefined on f = g."""
        return Ahead(g, f) if self.sign < 0 else Ahead(f, g)

    def pair_numeric(self, f: sp.Float, g: sp.Float) -> sp.Expr:
        """The smaller or the larger."""
        return min(f, g) if self.sign < 0 else max(f, g)

    def _system_text(self, printer: Any) -> str:
        return ", system=R1"


class R1Conjunction(R1Operation):
    """Conjunction of system R_1."""

    sign = -1
    symbol = r"\wedge_1"
    runtime_name = "r1_conjunction"


class R1Disjunction(R1Operation):
    """Disjunction of system R_1."""

    sign = 1
    symbol = r"\vee_1"
    runtime_name = "r1_disjunction"


def _bracketed(operand: sp.Expr, printer: Any) -> str:
    """An operand inside an infix operation; sums and signs need brackets."""
    text: str = printer._print(operand)
    bare = not (operand.is_Add or operand.could_extract_minus_sign())
    return text if bare else rf"\left({text}\right)"
