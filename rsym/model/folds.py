"""Folds: n-ary nodes that mean a pairwise operation from the left, parameters first."""

from __future__ import annotations

from typing import Any, ClassVar

import sympy as sp

from rsym.errors import RsymError
from rsym.model.nodes import RealNode


class Fold(RealNode):
    """A symmetric operation on two operands, folded from the left: parameters first, then two or more operands.

    Neither the order nor the grouping of the operands is ever changed.
    """

    of_shapes = True
    parameter_count: ClassVar[int] = 0

    def __new__(cls, *arguments: Any, **options: Any) -> sp.Expr:
        """Flatten on the left, where the fold begins; a single operand is what `alone` makes of it."""
        arguments = tuple(sp.sympify(argument, strict=True) for argument in arguments)
        parameters, operands = arguments[: cls.parameter_count], arguments[cls.parameter_count :]
        if operands and type(operands[0]) is cls and operands[0].parameters == parameters:
            operands = (*operands[0].operands, *operands[1:])
        if len(operands) == 1:
            return cls.alone(operands[0])
        return super().__new__(cls, *parameters, *operands, **options)

    @classmethod
    def alone(cls, operand: sp.Expr) -> sp.Expr:
        """The fold of one operand: itself."""
        return operand

    @property
    def parameters(self) -> tuple[sp.Expr, ...]:
        """alpha, m or p."""
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

    def pair_numeric(self, f: sp.Float, g: sp.Float, *parameters: sp.Float) -> sp.Expr:
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
        parameters = arguments[: self.parameter_count]
        result, *rest = arguments[self.parameter_count :]
        for operand in rest:
            result = self.pair_numeric(result, operand, *parameters)
        return result

    def fdiff(self, argindex: int = 1) -> sp.Expr:
        """The partial derivative with respect to one operand, nodes kept."""
        if argindex <= self.parameter_count:
            raise RsymError(
                f"{self.args[argindex - 1]} is the parameter of an R-operation, which is not differentiated through",
                code="parameter-derivative",
                remedy="differentiate node.doit(), in which the operation is written out",
            )
        position = argindex - self.parameter_count
        fold, last = self.head, self.operands[-1]
        if position == len(self.operands):
            return self.partial(last, fold)
        outer = self.partial(fold, last)
        if len(self.operands) > 2:
            return outer * fold.fdiff(argindex)
        return outer if fold == self.operands[0] else outer * fold.fdiff()  # its absolute value, say

    def infix(self, printer: Any) -> str:
        """What stands between operands in LaTeX."""
        raise NotImplementedError

    def _latex(self, printer: Any, exp: str | None = None) -> str:
        parts = [_bracketed(operand, printer) for operand in self.operands]
        text = rf"\left({f' {self.infix(printer)} '.join(parts)}\right)"
        return text if exp is None else f"{text}^{{{exp}}}"


def _bracketed(operand: sp.Expr, printer: Any) -> str:
    """An operand inside an infix operation; sums and signs need brackets."""
    text: str = printer._print(operand)
    bare = not (operand.is_Add or operand.could_extract_minus_sign())
    return text if bare else rf"\left({text}\right)"
