"""Expansion: every operation in terms of the few that a backend must know.

R-nodes keep their meaning up to here; this is the one place that writes them
out, in the form that keeps the sign. Equal roots are shared by hash-consing.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from fractions import Fraction

from rsym.codegen.builder import HALF, Builder
from rsym.codegen.operations import PRIMITIVES
from rsym.codegen.program import Node, Program

_LARGEST = Fraction(sys.float_info.max)
_SMALLEST = Fraction(5e-324)


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


def _root(b: Builder, f: int, g: int) -> int:
    return b.sqrt(b.add(b.square(f), b.square(g)))


def _where_root_fails(b: Builder, root: int, instead: int, value: int) -> int:
    """Take `instead` where the root is 0 or infinite: squares have left the range of float64 there. NaN stays."""
    return b.select(root, b.const(_LARGEST), instead, b.select(b.const(_SMALLEST), root, instead, value))


def _low(b: Builder, f: int, g: int) -> int:
    return b.select(g, f, f, g)


def _high(b: Builder, f: int, g: int) -> int:
    return b.select(f, g, f, g)


def _r0_conjunction(b: Builder, node: Node) -> int:
    """2 m (M/(f + g + r)) where f + g > 0, with m the smaller and M the larger; else f + g - r."""
    f, g = node.arguments
    root, total, low, high = _root(b, f, g), b.add(f, g), _low(b, f, g), _high(b, f, g)
    product = b.mul(b.mul(b.const(2), low), b.make("div", high, b.add(total, root)))
    value = b.select(total, b.const(0), product, b.sub(total, root))
    return _where_root_fails(b, root, low, value)


def _r0_disjunction(b: Builder, node: Node) -> int:
    """2 M (m/(f + g - r)) where f + g < 0; else f + g + r."""
    f, g = node.arguments
    root, total, low, high = _root(b, f, g), b.add(f, g), _low(b, f, g), _high(b, f, g)
    product = b.mul(b.mul(b.const(2), high), b.make("div", low, b.sub(total, root)))
    value = b.select(b.const(0), total, product, b.add(total, root))
    return _where_root_fails(b, root, high, value)


def _versine(b: Builder, node: Node) -> int:
    """(g/r) (g/(r + f)) where f > 0, else 1 - f/r."""
    f, g = node.arguments
    root = _root(b, f, g)
    product = b.mul(b.make("div", g, root), b.make("div", g, b.add(root, f)))
    return b.select(f, b.const(0), product, b.sub(b.const(1), b.make("div", f, root)))


def _gap(b: Builder, node: Node) -> int:
    """s**2/(2 (q + t)) where t > 0, else (q - t)/2."""
    s, t = node.arguments
    root = _root(b, t, s)
    quotient = b.make("div", b.square(s), b.mul(b.const(2), b.add(root, t)))
    return b.select(t, b.const(0), quotient, b.mul(b.const(HALF), b.sub(root, t)))


def _trimming(b: Builder, node: Node) -> int:
    gap = _gap(b, node)
    return b.sqrt(b.add(node.arguments[0], b.square(gap)))


def _normalised(b: Builder, node: Node) -> int:
    f, q = node.arguments
    root = b.sqrt(b.add(b.square(f), q))
    return _where_root_fails(b, root, b.make("div", f, b.abs(f)), b.make("div", f, root))


def _powi(b: Builder, node: Node) -> int:
    """Repeated squaring, in an order that depends on the exponent alone."""
    assert isinstance(node.data, int)
    base, exponent = node.arguments[0], node.data
    result, power = None, base
    while exponent:
        if exponent & 1:
            result = power if result is None else b.mul(result, power)
        exponent >>= 1
        if exponent:
            power = b.square(power)
    assert result is not None
    return result


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
    "r0_conjunction": _r0_conjunction,
    "r0_disjunction": _r0_disjunction,
    "versine": _versine,
    "gap": _gap,
    "trimming": _trimming,
    "normalised": _normalised,
}
