"""The leaves of a formula: its maximal parts that are no R-operations."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import sympy as sp

from rsym.analysis.contracts.promises import Order
from rsym.analysis.contracts.table import Promises, known_compositions
from rsym.model.nodes import Trimming
from rsym.model.powers import AbsolutePower
from rsym.model.rnodes import EquivalenceOperation, ROperation
from rsym.model.shape import Shape
from rsym.model.symbols import real_symbol, substitute

_LOGIC = (ROperation, EquivalenceOperation, Trimming, sp.Min, sp.Max, sp.Abs)


@dataclass(frozen=True)
class Leaf:
    """A part of a formula that R-operations combine: its names, and the order to which it is normalised.

    name: what the model calls it, or nothing; part: the smallest named part of the shape that contains it; order: 0
    where it is not normalised, infinity for an exact distance, None where neither is shown.
    """

    expression: sp.Expr
    name: str
    part: str
    order: Order

    @property
    def title(self) -> str:
        """The name, else the expression as text."""
        return self.name or sp.sstr(self.expression)


def is_logical(part: sp.Expr) -> bool:
    """Whether a part is an R-operation or its kin, through which orders are kept: no leaf.

    Examples
    --------
    >>> from rsym import conjunction, x, y
    >>> is_logical(conjunction(x, y)), is_logical(-conjunction(x, y)), is_logical(x * y)
    (True, True, False)
    """
    if isinstance(part, AbsolutePower):
        return bool(part.args[1] == 1)
    negated = part.is_Mul and len(part.args) == 2 and part.args[0] == -1
    return isinstance(part, _LOGIC) or bool(negated)


def decided_by(part: sp.Expr, promises: Promises) -> Sequence[sp.Expr]:
    """The operands on whose zeros a logical part may be zero."""
    operands = tuple(operand for operand in promises.inward(part) if operand != -1)
    single = isinstance(part, Trimming | AbsolutePower)
    return operands[:1] if single else operands


def leaves(promises: Promises) -> list[sp.Expr]:
    """The distinct leaves, in the order in which the formula has them."""
    return [part for part in promised_parts(promises.root, promises) if not is_logical(part)]


def promised_parts(root: sp.Expr, promises: Promises) -> list[sp.Expr]:
    """The logical parts as the promises see them."""
    return logical_parts(root, lambda part: decided_by(part, promises))


def logical_parts(root: sp.Expr, decided_by: Callable[[sp.Expr], Sequence[sp.Expr]]) -> list[sp.Expr]:
    """The distinct R-operations of an expression, outer ones first, and the leaves, given what decides an operation.

    Examples
    --------
    >>> from rsym import conjunction, x, y
    >>> logical_parts(-conjunction(x, y + 1), lambda part: [operand for operand in part.args if operand != -1])
    [-conjunction(x, y + 1), conjunction(x, y + 1), x, y + 1]
    """
    found: dict[sp.Expr, None] = {}
    stack, seen = [root], set()
    while stack:
        part = stack.pop()
        if id(part) in seen:
            continue
        seen.add(id(part))
        found[part] = None
        if is_logical(part):
            stack.extend(reversed(decided_by(part)))
    return list(found)


def names_of(shape: Shape) -> Mapping[sp.Expr, str]:
    """The named expressions of a shape and their negations: its definitions first, then its parts."""
    names: dict[sp.Expr, str] = {}
    resolved: dict[sp.Basic, sp.Basic] = {}
    for title, value in shape.definitions:
        resolved[real_symbol(title)] = substitute(value, resolved)
    named = [(symbol.name, value) for symbol, value in resolved.items()]
    for title, value in (*named, *shape.parts):
        names.setdefault(value, title)
        names.setdefault(-value, title)
    return names


def parts_around(shape: Shape, promises: Promises) -> list[str]:
    """For each leaf the name of the smallest named part that combines it; empty where none does."""
    inside = [(name, set(promised_parts(known_compositions(part), promises))) for name, part in shape.parts]
    inside.sort(key=lambda item: len(item[1]))
    return [
        next((name for name, pieces in inside if leaf in pieces or -leaf in pieces), "") for leaf in leaves(promises)
    ]
