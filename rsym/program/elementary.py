"""Rows of the elementary functions."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

import sympy as sp

from rsym.program.program import Node
from rsym.program.row import UP, Nodes, Operation, nonzero, positive
from rsym.program.sides import of_power, summed, unbounded, within

Given = Sequence[int]
TURN = Fraction(44, 7)  # a little more than 2 pi


def _sin(b: Nodes, number: int, node: Node, d: Given) -> int:
    return b.mul(b.make("cos", node.arguments[0]), d[0])


def _cos(b: Nodes, number: int, node: Node, d: Given) -> int:
    return b.neg(b.mul(b.make("sin", node.arguments[0]), d[0]))


def _exp(b: Nodes, number: int, node: Node, d: Given) -> int:
    return b.mul(number, d[0])


def _jump_of_exponential(b: Nodes, number: int, node: Node, jumps: Given) -> int:
    return b.mul(b.mul(number, b.make("exp", jumps[0])), jumps[0])


def _log(b: Nodes, number: int, node: Node, d: Given) -> int:
    return b.div(d[0], node.arguments[0])


def _jump_of_logarithm(b: Nodes, number: int, node: Node, jumps: Given) -> int:
    (u,), (p,) = node.arguments, jumps
    return b.select(u, p, b.make("div", p, b.sub(u, p)), unbounded(b, number, node, jumps))


def _pow(b: Nodes, number: int, node: Node, d: Given) -> int:
    base, exponent = node.arguments
    lowered = b.make("pow", base, b.sub(exponent, b.const(1)))
    result = b.mul(b.mul(exponent, lowered), d[0])
    if b.value(d[1]) == 0:
        return result
    return b.add(result, b.mul(b.mul(number, b.make("log", base)), d[1]))


def _atan2(b: Nodes, number: int, node: Node, d: Given) -> int:
    u, v = node.arguments
    turn = _turn(b, u, v, d[0])
    if turn is not None:
        return turn
    return b.div(b.sub(b.mul(v, d[0]), b.mul(u, d[1])), b.add(b.square(u), b.square(v)))


def _turn(b: Nodes, u: int, v: int, slope: int) -> int | None:
    """The angle of (cos w, sin w) is w but for whole turns, that of (|cos w|, sin w) is w back and forth: no quotient.

    Over boxes a quotient of sums of squares would undo every bound.
    """
    folded = b.nodes[v].operation == "abs"
    cosine = b.nodes[v].arguments[0] if folded else v
    sine = b.nodes[u].arguments[0] if b.nodes[u].operation == "neg" else u
    pair = b.nodes[sine].operation, b.nodes[cosine].operation
    if pair != ("sin", "cos") or b.nodes[sine].arguments != b.nodes[cosine].arguments:
        return None
    inner = _without(b, slope, cosine)
    return b.mul(inner, b.div(cosine, v)) if folded and inner is not None else inner


def _without(b: Nodes, product: int, factor: int) -> int | None:
    """The other factor of a product, signs and constants kept."""
    if product == factor:
        return b.const(1)
    operation, arguments, _ = b.nodes[product]
    if b.value(product) == 0:
        return product
    if operation == "neg":
        rest = _without(b, arguments[0], factor)
        return None if rest is None else b.neg(rest)
    if operation != "mul":
        return None
    if factor in arguments:
        return arguments[1 - arguments.index(factor)]
    rest = _without(b, arguments[1], factor) if b.value(arguments[0]) is not None else None
    return None if rest is None else b.mul(arguments[0], rest)


def bearing(b: Nodes, number: int, node: Node, jumps: Given) -> int:
    """The turn of a vector whose end moves by j, off the cut: at most 2 j/r."""
    u, v = node.arguments
    total = summed(b, jumps)
    if b.value(total) == 0:
        return total
    return within(b, b.sqrt(b.add(b.square(u), b.square(v))), total, 7)


def _jump_of_angle(b: Nodes, number: int, node: Node, jumps: Given) -> int:
    """A whole turn on the cut u = 0, v < 0; where u or v cannot be negative there is none."""
    u, v = node.arguments
    turned = bearing(b, number, node, jumps)
    if b.nonnegative[u] or b.nonnegative[v]:
        return turned
    behind = b.select(v, jumps[1], b.const(0), b.const(TURN))
    return b.add(turned, b.select(b.abs(u), jumps[0], b.const(0), behind))


def _texts(name: str, numpy: str, arguments: str = "{}") -> dict[str, str]:
    """A function of libm."""
    return {"numpy": f"numpy.{numpy}({arguments})", "c": f"{name}({arguments})", "llvm": "function"}


ELEMENTARY: dict[str, Operation] = {
    "sin": Operation(  # of jumps of its angle whole turns do not count: `jumps` bounds those of sine and cosine
        1,
        lambda np, u: np.sin(u),
        derivative=_sin,
        formula=sp.sin,
        texts=_texts("sin", "sin"),
        analytic=(),
        strict=True,
        parity="odd",
        zeros=("0",),
    ),
    "cos": Operation(
        1,
        lambda np, u: np.cos(u),
        derivative=_cos,
        formula=sp.cos,
        texts=_texts("cos", "cos"),
        analytic=(),
        strict=True,
        parity="even",
    ),
    "exp": Operation(
        1,
        lambda np, u: np.exp(u),
        derivative=_exp,
        jump=_jump_of_exponential,
        formula=sp.exp,
        texts=_texts("exp", "exp"),
        grows=(UP,),
        rounding="elementary",
        analytic=(),
        strict=True,
        nonnegative=True,
    ),
    "log": Operation(
        1,
        lambda np, u: np.log(u),
        derivative=_log,
        jump=_jump_of_logarithm,
        formula=sp.log,
        texts=_texts("log", "log"),
        domain=(positive(0),),
        analytic=(positive(0),),
        strict=True,
    ),
    "pow": Operation(
        2,
        lambda np, u, a: np.float_power(u, a),
        derivative=_pow,
        jump=of_power,
        formula=lambda u, a: u**a,
        texts=_texts("pow", "power", "{}, {}"),
        domain=(positive(0),),
        analytic=(positive(0),),
        zeros=("0+",),
    ),
    "atan2": Operation(
        2,
        lambda np, u, v: np.arctan2(u, v),
        derivative=_atan2,
        jump=_jump_of_angle,
        formula=sp.atan2,
        texts=_texts("atan2", "arctan2", "{}, {}"),
        analytic=((*nonzero(0), *positive(1)),),
        strict=True,
        jumping=True,
        zeros=("0+",),
    ),
}
