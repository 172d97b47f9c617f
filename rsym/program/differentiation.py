"""Derivatives of a program, to any order, at linear cost.

One rule an operation; all rules avoid cancellation, and where a derivative
does not exist its value is NaN, never a Dirac impulse. Choices, sign and the cut
of atan2 are differentiated side by side: whether the sides agree is asked by `Jumps`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from rsym.program.builder import Builder
from rsym.program.operations import Cells
from rsym.program.program import live
from rsym.program.row import Rule


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
