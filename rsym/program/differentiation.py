"""Derivatives of a program, to any order, at linear cost.

One rule an operation; all rules avoid cancellation, and where a derivative
does not exist its value is NaN, never a Dirac impulse. Choices, sign and the cut
of atan2 are differentiated side by side: whether the sides agree is asked by `Jumps`.

At corners gradients are also those of one side: that from which both operands of an operation grow alike. The
operations of R-systems are homogeneous of degree 1 (those with r**m, of a higher degree: their derivatives go to
0). Their partial derivatives are constant along rays from the corner f = g = 0, so the limit along the ray
f = g > 0 is the derivative at (1, 1), of R_0 that is (1 - 1/sqrt(2)) (grad f + grad g). |f| counts as f, of a tie of
min or max the first operand. Each is an element of Clarke's generalised gradient of the operation.

Source: F. H. Clarke (1983), Optimization and nonsmooth analysis, chapter 2, for the generalised gradient.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import reduce

from rsym.program.builder import Builder
from rsym.program.operations import Cells
from rsym.program.program import Node, live
from rsym.program.row import Nodes, Operation, Rule


def derivative(
    builder: Builder,
    output: int,
    name: str,
    *,
    rules: Mapping[str, Rule] | None = None,
    known: dict[tuple[int, str], int] | None = None,
) -> int:
    """The node of d(output)/d(name); parts already differentiated are not differentiated again.

    Rules of one's own have results of their own: `known` keeps them.
    """
    rules = RULES if rules is None else rules
    known = builder.derivatives if known is None else known
    if (output, name) in known:
        return known[output, name]
    zero = builder.const(0)
    for number in live(builder.nodes, [output]):
        if (number, name) in known:
            continue
        node = builder.nodes[number]
        inner = [known[argument, name] for argument in node.arguments]
        if node.operation == "input":
            result = builder.const(int(node.data == name))
        elif all(number == zero for number in inner) and node.operation != "undefined":
            result = zero
        else:
            result = rules[node.operation](builder, number, node, inner)
        known[number, name] = result
    return known[output, name]


def gradient(builder: Builder, output: int) -> list[int]:
    """The derivatives with respect to the coordinates."""
    return [derivative(builder, output, name) for name in builder.coordinates]


def dot(builder: Builder, a: Sequence[int], b: Sequence[int]) -> int:
    """The scalar product."""
    total = builder.mul(a[0], b[0])
    for p, q in zip(a[1:], b[1:], strict=True):
        total = builder.add(total, builder.mul(p, q))
    return total


RULES: Cells[Rule] = Cells(lambda name, row: row.derivative)


def gradient_of_one_side(builder: Builder, output: int) -> list[int]:
    """The derivatives with respect to the coordinates; at corners those of one side."""
    known: dict[tuple[int, str], int] = {}
    return [derivative(builder, output, name, rules=ONE_SIDED, known=known) for name in builder.coordinates]


def _aside(rule: Rule, operands: int) -> Rule:
    """The rule of an operation, its operands 1 where all of them are 0."""

    def one_sided(b: Nodes, number: int, node: Node, d: Sequence[int]) -> int:
        own, rest = node.arguments[:operands], node.arguments[operands:]
        size = reduce(b.add, [b.abs(operand) for operand in own])
        # The sum keeps what is undefined, a choice between the operands and 1 would not.
        step = b.select(size, b.const(0), b.const(0), b.const(1))
        moved = Node(node.operation, (*(b.add(operand, step) for operand in own), *rest), node.data)
        return rule(b, b.make(moved.operation, *moved.arguments, data=moved.data), moved, d)

    return one_sided


def _first_of_equals(rule: Rule) -> Rule:
    """The rule of min or max; where both operands are equal, the derivative of the first."""

    def one_sided(b: Nodes, number: int, node: Node, d: Sequence[int]) -> int:
        gap = b.abs(b.sub(*node.arguments))
        return unless_equal(b, gap, rule(b, number, node, d), d[0])

    return one_sided


def unless_equal(b: Nodes, gap: int, value: int, equal: int) -> int:
    """The value; where a gap >= 0 is 0, the other; where it is undefined, the value."""
    return b.select(gap, b.const(0), value, b.select(b.const(1), gap, equal, value))


def _one_sided(name: str, row: Operation) -> Rule | None:
    if row.derivative is None or not row.homogeneous:
        return row.derivative
    if row.branching and row.arity == 2:
        return _first_of_equals(row.derivative)
    return _aside(row.derivative, min(row.arity, 2))


ONE_SIDED: Cells[Rule] = Cells(_one_sided)
