"""Expansion: every operation in terms of the few that a backend must know.

R-nodes keep their meaning up to here; this is the one place that writes them
out, in the form that keeps the sign. Equal roots are shared by hash-consing.
"""

from __future__ import annotations

from collections.abc import Callable

from rsym.program.builder import Builder
from rsym.program.operations import OPERATIONS
from rsym.program.program import Node, Program


def expand(program: Program) -> Program:
    """The same functions from primitive operations alone."""
    builder = Builder(program.coordinates, program.letters)
    done: list[int] = []
    for node in program.nodes:
        arguments = tuple(done[argument] for argument in node.arguments)
        if node.operation in SIMPLE:
            done.append(SIMPLE[node.operation](builder, *arguments))
        else:
            expansion = OPERATIONS[node.operation].expansion
            if expansion is None:
                done.append(builder.make(node.operation, *arguments, data=node.data))
            else:
                done.append(expansion(builder, Node(node.operation, arguments, node.data)))
    return builder.program({name: done[number] for name, number in program.outputs})


SIMPLE: dict[str, Callable[..., int]] = {
    "add": Builder.add,
    "mul": Builder.mul,
    "neg": Builder.neg,
    "sqrt": Builder.sqrt,
    "abs": Builder.abs,
    "select": Builder.select,
}
