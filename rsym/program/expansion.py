"""Expansion: every operation in terms of the few that a backend must know.

R-nodes keep their meaning up to here; this is the one place that writes them
out, in the form that keeps the sign. Equal roots are shared by hash-consing.
"""

from __future__ import annotations

from collections.abc import Callable

from rsym.program.builder import HALF, Builder
from rsym.program.operations import PRIMITIVES
from rsym.program.powers import root, where_fails, whole_power
from rsym.program.program import Node, Program
from rsym.program.system_expansions import SYSTEM_EXPANSIONS


def expand(program: Program) -> Program:
    """The same functions from primitive operations alone."""
    builder = Builder(program.coordinates, program.letters)
    done: list[int] = []
    for node in program.nodes:
        arguments = tuple(done[argument] for argument in node.arguments)
        if node.operation in SIMPLE:
            done.append(SIMPLE[node.operation](builder, *arguments))
        elif node.operation in PRIMITIVES:
            done.append(builder.make(node.operation, *arguments, data=node.data))
        else:
            done.append(EXPANSIONS[node.operation](builder, Node(node.operation, arguments, node.data)))
    return builder.program({name: done[number] for name, number in program.outputs})


def _gap(b: Builder, node: Node) -> int:
    """s**2/(2 (q + t)) where t > 0, else (q - t)/2."""
    s, t = node.arguments
    size = root(b, t, s)
    quotient = b.make("div", b.square(s), b.mul(b.const(2), b.add(size, t)))
    return b.select(t, b.const(0), quotient, b.mul(b.const(HALF), b.sub(size, t)))


def _trimming(b: Builder, node: Node) -> int:
    gap = _gap(b, node)
    return b.sqrt(b.add(node.arguments[0], b.square(gap)))


def _normalised(b: Builder, node: Node) -> int:
    f, q = node.arguments
    size = b.sqrt(b.add(b.square(f), q))
    return where_fails(b, size, b.make("div", f, b.abs(f)), b.make("div", f, size))


def _zero_with(b: Builder, node: Node) -> int:
    f, g = node.arguments
    return b.select(b.abs(f), b.const(0), g, f)


def _powi(b: Builder, node: Node) -> int:
    assert isinstance(node.data, int)
    return whole_power(b, node.arguments[0], node.data)


def _sign(b: Builder, node: Node) -> int:
    """1, -1, or the argument itself: 0 stays 0 and NaN stays NaN."""
    (u,) = node.arguments
    return b.select(u, b.const(0), b.const(1), b.select(b.const(0), u, b.const(-1), u))


SIMPLE: dict[str, Callable[..., int]] = {
    "add": Builder.add,
    "mul": Builder.mul,
    "neg": Builder.neg,
    "sqrt": Builder.sqrt,
    "abs": Builder.abs,
    "select": Builder.select,
}
EXPANSIONS: dict[str, Callable[[Builder, Node], int]] = {
    "powi": _powi,
    "sign": _sign,
    "gap": _gap,
    "trimming": _trimming,
    "normalised": _normalised,
    "zero_with": _zero_with,
    **SYSTEM_EXPANSIONS,
}
