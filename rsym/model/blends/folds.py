"""What blends that are R-operations share: n-ary, named, and written out pair by pair from the left."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, TypeAlias

import sympy as sp

from rsym.errors import RsymError
from rsym.model.arguments import number
from rsym.model.choices import Choice
from rsym.model.nodes import Composition
from rsym.model.rnodes import ROperation

Pair: TypeAlias = tuple[sp.Expr, sp.Expr]


class BlendOperation(Composition, ROperation):
    """A conjunction that rounds the edge; the disjunction is its dual, -(-f and -g)."""

    def conjunction_of(self, f: sp.Expr, g: sp.Expr) -> sp.Expr:
        """The conjunction of two operands, in other nodes."""
        raise NotImplementedError

    def as_roots(self) -> sp.Expr:
        """The left fold of the formula as books have it, which `composition` says in a stable form."""
        return ROperation.as_roots(self)

    def numeric(self, arguments: list[sp.Float]) -> sp.Expr:
        """The left fold of numbers."""
        return ROperation.numeric(self, arguments)

    def pair(self, f: sp.Expr, g: sp.Expr) -> sp.Expr:
        """The operation on two operands, in other nodes."""
        return self.conjunction_of(f, g) if self.sign < 0 else -self.conjunction_of(-f, -g)

    def carried(self, f: sp.Expr, g: sp.Expr) -> sp.Expr:
        """What the operand after these two is blended with."""
        return self.pair(f, g)

    def composition(self) -> sp.Expr:
        """The left fold."""
        head, *rest, last = self.operands
        for operand in rest:
            head = self.carried(head, operand)
        return self.pair(head, last)

    def gates(self, operands: Sequence[sp.Expr]) -> sp.Expr:
        """The same sign by min and max of operands and fillets; `operands` have the signs of the node's own."""
        value, *rest = self.operands
        gate, *more = operands
        for operand, other in zip(rest, more, strict=True):
            if self.sign < 0:
                gate = self.conjunction_gates((value, operand), (gate, other))
            else:
                gate = -self.conjunction_gates((-value, -operand), (-gate, -other))
            value = self.carried(value, operand)
        return gate

    def conjunction_gates(self, values: Pair, signs: Pair) -> sp.Expr:
        """The conjunction of two operands, given their values, and expressions of the same signs."""
        raise NotImplementedError

    def pair_numeric(self, f: sp.Float, g: sp.Float, *parameters: sp.Float) -> sp.Expr:
        """The operation on two numbers; parameters are the node's own."""
        return self.func(*parameters, f, g).composition().evalf(f._prec // 3)


def in_range(value: Any, what: str, low: Any, high: Any) -> sp.Expr:
    """A number between low and high, or an expression in letters.

    Examples
    --------
    >>> in_range(2, "the ratio", 0, 3)
    2
    """
    expression = number(value, what)
    if expression.is_number and not low < expression < high:
        wanted = "positive" if (low, high) == (0, sp.oo) else f"in ({low}, {high})"
        raise RsymError(f"{what} must be {wanted}, got {value}", code="parameter")
    return expression


def where_legal(quantities: list[sp.Expr], blend: sp.Expr) -> sp.Expr:
    """The blend where all quantities are positive, undefined elsewhere; numbers have been examined already."""
    for quantity in quantities:
        if quantity.free_symbols:
            # Not NaN itself, which would leave open in all boxes what depends on it: this is defined where it is legal.
            illegal = blend * sp.sqrt(quantity) * sp.log(quantity)
            blend = Choice(quantity, 0, blend, illegal)
    return blend


def infix_index(parts: list[tuple[str, sp.Expr]], printer: Any) -> str:
    """The indices of a wedge or vee: rho=1/5, or rho alone if that is what the letter is called."""
    texts = []
    for name, value in parts:
        symbol = printer._print(sp.Symbol(name))
        same = value.is_Symbol and value.name == name
        texts.append(symbol if same else f"{symbol}={printer._print(value)}")
    return rf"_{{{', '.join(texts)}}}"
