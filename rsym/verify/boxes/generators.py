"""Generators of non-smoothness: the places where a node of a program is not analytic in its arguments.

A node is analytic wherever all generators that are alive exclude zero; one under a branch that is not taken is
dead. Some generators are *switches*: on either side of the zero set of one node the operation is another analytic
function, |u| is u or -u. The others (a joint zero of R_0, the edge of a root) are *hard*: nothing resolves them.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import NamedTuple

from rsym.logic.stripping import bare
from rsym.program.builder import Builder
from rsym.program.operations import BRANCHING, CHOOSING, ENTIRE, OPERATIONS
from rsym.program.row import Clauses
from rsym.verify.boxes.domains import is_defined, is_legal, meets, switch_of
from rsym.verify.boxes.local import Local
from rsym.verify.boxes.locus import chosen


@dataclass(frozen=True)
class Generators:
    """What may be zero on a box, of a node's live generators.

    switches: the nodes that switch, and the operations that they are switches of (`switched`); hard: operations that
    are not analytic somewhere on the box and that no switch resolves.
    """

    switches: tuple[int, ...]
    hard: frozenset[int]
    switched: tuple[int, ...] = ()

    @property
    def analytic(self) -> bool:
        """Whether the node is analytic on the whole box."""
        return not self.switches and not self.hard


ANALYTIC = Generators((), frozenset())


class _Part(NamedTuple):
    """What a node says of its generators on any box: itself, and where to look below it."""

    entire: bool
    choosing: bool
    below: tuple[int, ...]
    clauses: Clauses | None


def _part(builder: Builder, number: int) -> _Part:
    """The nodes below that are not entire, past those that are, in the order in which a walk finds them."""
    operation, arguments, _ = builder.nodes[number]
    stack, seen, found = list(arguments), set(), []
    while stack:
        part = stack.pop()
        if part in seen:
            continue
        seen.add(part)
        if builder.nodes[part].operation in ENTIRE:
            stack.extend(builder.nodes[part].arguments)
        else:
            found.append(part)
    return _Part(operation in ENTIRE, operation in CHOOSING, tuple(reversed(found)), analytic_clauses(builder, number))


def generators(local: Local, number: int) -> Generators:
    """The live generators of a node that the box does not exclude."""
    model = local.model
    if model.uses_only(number, ENTIRE):
        return ANALYTIC
    switches: dict[int, None] = {}  # in the order of the walk
    switched: list[int] = []
    hard: set[int] = set()
    seen: set[int] = set()
    stack = [number]
    local.value(number)
    while stack:
        number = stack.pop()
        if number in seen:
            continue
        seen.add(number)
        part = model.made(_part, number)
        if part.choosing and (branch := chosen(local, number)) is not None:
            stack.append(branch[0])
            continue
        stack.extend(part.below)
        if part.entire or _is_analytic_at(local, number, part.clauses):
            continue
        switch = _switch(local, number)
        if switch is None:
            hard.add(number)
        else:
            switches[switch] = None
            switched.append(number)
    return Generators(tuple(switches), frozenset(hard), tuple(switched))


def is_analytic_at(local: Local, number: int) -> bool:
    """Whether an operation is analytic at all arguments that it takes on the box."""
    return _is_analytic_at(local, number, analytic_clauses(local.model.builder, number))


def _is_analytic_at(local: Local, number: int, clauses: Clauses | None) -> bool:
    return clauses is not None and meets(local, number, clauses) and is_legal(local, number, analytic=True)


def analytic_clauses(builder: Builder, number: int) -> Clauses | None:
    """Where an operation is analytic in its arguments, by its parameter if that is an even number; None is nowhere."""
    row = OPERATIONS[builder.nodes[number].operation]
    if row.analytic_even is None:
        return row.analytic
    order = builder.value(builder.nodes[number].arguments[-1])
    even = order is not None and order > 0 and order.denominator == 1 and order % 2 == 0
    return row.analytic_even if even else row.analytic


def _switch(local: Local, number: int) -> int | None:
    """The node whose zeros part the analytic sides of an operation, up to a constant factor."""
    builder = local.model.builder
    operation, arguments, _ = builder.nodes[number]
    if operation in BRANCHING:
        switch = switch_of(builder, number)
        return bare(builder, switch) if is_defined(local, switch) else None
    if operation == "atan2" and local.sign(arguments[1]) < 0 and is_defined(local, arguments[0]):
        return bare(builder, arguments[0])
    if operation == "trimming" and local.sign(arguments[1]) > 0:
        node = builder.nodes[arguments[0]]
        return bare(builder, node.arguments[0]) if is_square(builder, arguments[0]) else None
    if operation in {"absolute_power", "signed_power"}:
        exponent = builder.value(arguments[1])
        return bare(builder, arguments[0]) if exponent is not None and exponent > 0 else None
    if operation in {"sqrt", "pow"} and root_order(builder, number) is not None:
        return bare(builder, builder.nodes[arguments[0]].arguments[0])
    return None


def root_order(builder: Builder, number: int) -> Fraction | None:
    """The exponent of a root or a positive power of an absolute value, sqrt(|u|) or |u|**a."""
    operation, arguments, _ = builder.nodes[number]
    exponent = Fraction(1, 2) if operation == "sqrt" else builder.value(arguments[1])
    if builder.nodes[arguments[0]].operation != "abs" or exponent is None or exponent <= 0:
        return None
    return exponent


def square_roots(builder: Builder, number: int) -> list[int]:
    """The nodes whose squares are terms of a sum of which nothing is negative: all vanish where the sum does."""
    roots, stack = [], [number]
    while stack:
        part = stack.pop()
        operation, arguments, _ = builder.nodes[part]
        if not builder.nonnegative[part]:
            return []
        if operation == "add":
            stack.extend(reversed(arguments))
        elif operation == "powi" or (operation == "mul" and arguments[0] == arguments[1]):
            roots.append(arguments[0])
        elif operation == "mul" and (factor := builder.value(arguments[0])) is not None and factor > 0:
            stack.append(arguments[1])
    return roots


def is_square(builder: Builder, number: int) -> bool:
    """Whether a node is the product of a node with itself."""
    operation, arguments, _ = builder.nodes[number]
    return operation == "mul" and arguments[0] == arguments[1]
