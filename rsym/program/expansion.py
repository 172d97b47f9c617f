"""Expansion: every operation in terms of the few that a backend must know.

R-nodes keep their meaning up to here; this is the one place that writes them
out, in the form that keeps the sign. Equal roots are shared by hash-consing.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

from rsym.program.builder import Builder
from rsym.program.operations import OPERATIONS
from rsym.program.program import Node, Program
from rsym.program.row import Expansion


def expand(program: Program, own: Mapping[str, Expansion] | None = None) -> Program:
    """The same functions from primitive operations alone; `own` expansions take the place of those of the rows."""
    rules = own or {}
    builder = Builder(program.coordinates, program.letters)
    done: list[int] = []
    for node in program.nodes:
        arguments = tuple(done[argument] for argument in node.arguments)
        if node.operation in rules:
            done.append(rules[node.operation](builder, Node(node.operation, arguments, node.data)))
        elif node.operation in SIMPLE:
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
