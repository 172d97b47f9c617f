"""The logic of a shape: gates that join leaves, every gate of two operands, negations moved to the leaves."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple, TypeAlias

import sympy as sp

from rsym.model.rnodes import R1Operation, ROperation
from rsym.model.traversal import with_operands


class Literal(NamedTuple):
    """A leaf by its number, or its negation."""

    leaf: int
    sign: int


class Gate(NamedTuple):
    """The conjunction or disjunction of two earlier steps.

    `keeps` says that the operation of a function with itself is that function, as min and max have it,
    or that a normalisation around it mends what is lost.
    """

    conjunction: bool
    first: int
    second: int
    keeps: bool


Step: TypeAlias = Literal | Gate


class Signed(NamedTuple):
    """A part of the formula times 1 or -1; `mended` inside a normalisation."""

    part: sp.Expr
    sign: int
    mended: bool


@dataclass(frozen=True)
class Logic:
    """Leaves as they are first written, and the steps that join them in their order; the last one is the shape."""

    leaves: tuple[sp.Expr, ...]
    steps: tuple[Step, ...]


def logic_of(expression: sp.Expr) -> Logic:
    """The logic of a formula; a normalisation around R-operations changes no sign and is looked through.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> logic_of(-rsym.conjunction(x, y - 1)).steps
    (Literal(leaf=0, sign=-1), Literal(leaf=1, sign=-1), Gate(conjunction=False, first=0, second=1, keeps=False))
    """
    leaves: list[sp.Expr] = []
    known: dict[sp.Expr, tuple[int, int]] = {}  # the number of a leaf and the sign of its first occurrence
    steps: list[Step] = []
    done: dict[tuple[int, int, bool], int] = {}
    for signed, operands in with_operands(Signed(expression, 1, False), _operands, _key):
        if not operands:
            form, sign = unsigned(signed.part)
            number, written = known.setdefault(form, (len(leaves), sign))
            if number == len(leaves):
                leaves.append(signed.part)
            steps.append(Literal(number, sign * written * signed.sign))
        elif len(operands) > 1:
            first, *rest = (done[_key(operand)] for operand in operands)
            for second in rest:
                steps.append(_gate(signed, first, second))
                first = len(steps) - 1
        done[_key(signed)] = done[_key(operands[0])] if len(operands) == 1 else len(steps) - 1
    return Logic(tuple(leaves), tuple(steps))


def unsigned(leaf: sp.Expr) -> tuple[sp.Expr, int]:
    """A leaf and 1, or its negation and -1: of the two always the same."""
    return (-leaf, -1) if leaf.could_extract_minus_sign() else (leaf, 1)


def normalised(part: sp.Expr) -> tuple[sp.Expr, int] | None:
    """The R-operation f and the sign of f/sqrt(f**2/L**2 + q), as `normalise` writes it."""
    operations = [factor for factor in part.args if isinstance(factor, ROperation)] if part.is_Mul else []
    if len(operations) != 1:
        return None
    (f,) = operations
    numbers = [factor for factor in part.args if factor.is_Rational]
    roots = [factor for factor in part.args if _is_root_over(factor, f)]
    if len(roots) != 1 or len(numbers) + 2 != len(part.args):
        return None
    return f, 1 if sp.Mul(*numbers) > 0 else -1


def _is_root_over(factor: sp.Expr, f: sp.Expr) -> bool:
    """Whether it is 1/sqrt(c*f**2 + q)."""
    if not (factor.is_Pow and factor.exp == -sp.S.Half and factor.base.is_Add):
        return False
    square = f**2
    return any(square in (term.args if term.is_Mul else (term,)) for term in factor.base.args)


def _gate(signed: Signed, first: int, second: int) -> Gate:
    part = signed.part
    meets = isinstance(part, sp.Min) or (isinstance(part, ROperation) and part.sign < 0)
    return Gate(meets == (signed.sign > 0), first, second, signed.mended or not _loses(part))


def _loses(part: sp.Expr) -> bool:
    return isinstance(part, ROperation) and not isinstance(part, R1Operation)


def _operands(signed: Signed) -> list[Signed]:
    part, sign, mended = signed
    if isinstance(part, ROperation):
        return [Signed(operand, sign, mended) for operand in part.operands]
    if isinstance(part, sp.Min | sp.Max):
        return [Signed(operand, sign, mended) for operand in part.args]
    if (inside := normalised(part)) is not None:
        return [Signed(inside[0], sign * inside[1], True)]
    if part.is_Mul and len(part.args) == 2 and part.args[0] == -1 and isinstance(part.args[1], _TOP):
        return [Signed(part.args[1], -sign, mended)]
    return []


def _key(signed: Signed) -> tuple[int, int, bool]:
    return id(signed.part), signed.sign, signed.mended


_TOP = (ROperation, sp.Min, sp.Max)
