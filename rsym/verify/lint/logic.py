"""The logic of a shape: gates that join leaves, every gate of two operands, negations moved to the leaves."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import sympy as sp

from rsym.logic.gates import Gate
from rsym.logic.kleene import Literal
from rsym.logic.sign_form import Operand
from rsym.model.rnodes import R1Operation, ROperation
from rsym.model.symbols import with_operands


@dataclass(frozen=True)
class Logic:
    """Leaves as they are first written, literals, which are leaves or their negatives, and the gates that join these.

    The last gate is the shape, without gates the only literal. `keeps` says of each gate that the operation of a
    function with itself is that function, as min and max have it, or that a normalisation around it mends what is lost.
    """

    leaves: tuple[sp.Expr, ...]
    literals: tuple[Literal, ...]
    gates: tuple[Gate, ...]
    keeps: tuple[bool, ...]


class _Signed(NamedTuple):
    """A part of the formula times 1 or -1; `mended` inside a normalisation."""

    part: sp.Expr
    sign: int
    mended: bool


def logic_of(expression: sp.Expr) -> Logic:
    """The logic of a formula; a normalisation around R-operations changes no sign and is looked through.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> logic = logic_of(-rsym.conjunction(x, y - 1))
    >>> [literal.sign for literal in logic.literals], logic.gates
    ([-1, -1], (Gate(operation='max', first=0, second=1),))
    """
    leaves: list[sp.Expr] = []
    known: dict[sp.Expr, tuple[int, int]] = {}  # the number of a leaf and the sign of its first occurrence
    literals: list[Literal] = []
    joined: list[tuple[str, Operand, Operand]] = []
    keeps: list[bool] = []
    done: dict[tuple[int, int, bool], Operand] = {}
    for signed, operands in with_operands(_Signed(expression, 1, False), _operands, _key):
        if not operands:
            form, sign = unsigned(signed.part)
            number, written = known.setdefault(form, (len(leaves), sign))
            if number == len(leaves):
                leaves.append(signed.part)
            literals.append(Literal(number, sign * written * signed.sign))
            done[_key(signed)] = Operand(False, len(literals) - 1)
            continue
        first, *rest = (done[_key(operand)] for operand in operands)
        exact = isinstance(signed.part, R1Operation) or not isinstance(signed.part, ROperation)
        for second in rest:
            joined.append((_kind(signed), first, second))
            keeps.append(signed.mended or exact)
            first = Operand(True, len(joined) - 1)
        done[_key(signed)] = first
    count = len(literals)
    gates = tuple(Gate(kind, first.after(count), second.after(count)) for kind, first, second in joined)
    return Logic(tuple(leaves), tuple(literals), gates, tuple(keeps))


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


def _kind(signed: _Signed) -> str:
    part = signed.part
    meets = isinstance(part, sp.Min) or (isinstance(part, ROperation) and part.sign < 0)
    return "min" if meets == (signed.sign > 0) else "max"


def _operands(signed: _Signed) -> list[_Signed]:
    part, sign, mended = signed
    if isinstance(part, ROperation):
        return [_Signed(operand, sign, mended) for operand in part.operands]
    if isinstance(part, sp.Min | sp.Max):
        return [_Signed(operand, sign, mended) for operand in part.args]
    if (inside := normalised(part)) is not None:
        return [_Signed(inside[0], sign * inside[1], True)]
    if part.is_Mul and len(part.args) == 2 and part.args[0] == -1 and isinstance(part.args[1], _TOP):
        return [_Signed(part.args[1], -sign, mended)]
    return []


def _key(signed: _Signed) -> tuple[int, int, bool]:
    return id(signed.part), signed.sign, signed.mended


_TOP = (ROperation, sp.Min, sp.Max)
