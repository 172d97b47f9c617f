"""Derivatives of a program, to any order, at linear cost.

One rule an operation; all rules avoid cancellation, and where a derivative
does not exist its value is NaN, never a Dirac impulse. Choices, sign and the cut
of atan2 are differentiated side by side: whether the sides agree is asked by `Jumps`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction

from rsym.program.builder import HALF, Builder
from rsym.program.program import Node, live
from rsym.program.system_rules import SYSTEM_RULES, Rule


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


def _undefined(b: Builder, number: int, node: Node, d: Sequence[int]) -> int:
    return b.undefined()


def _add(b: Builder, number: int, node: Node, d: Sequence[int]) -> int:
    return b.add(d[0], d[1])


def _mul(b: Builder, number: int, node: Node, d: Sequence[int]) -> int:
    u, v = node.arguments
    if u == v:
        return b.mul(b.const(2), b.mul(u, d[0]))
    for first, second, slope in ((u, v, d[0]), (v, u, d[1])):
        if b.nodes[second] == ("abs", (first,), None):
            return b.mul(b.const(2), b.mul(second, slope))  # w|w| has a derivative at w = 0 too
    return b.add(b.mul(d[0], v), b.mul(u, d[1]))


def _div(b: Builder, number: int, node: Node, d: Sequence[int]) -> int:
    return b.div(b.sub(d[0], b.mul(number, d[1])), node.arguments[1])


def _neg(b: Builder, number: int, node: Node, d: Sequence[int]) -> int:
    return b.neg(d[0])


def _powi(b: Builder, number: int, node: Node, d: Sequence[int]) -> int:
    assert isinstance(node.data, int)
    return b.mul(b.mul(b.const(node.data), b.powi(node.arguments[0], node.data - 1)), d[0])


def _pow(b: Builder, number: int, node: Node, d: Sequence[int]) -> int:
    base, exponent = node.arguments
    lowered = b.make("pow", base, b.sub(exponent, b.const(1)))
    result = b.mul(b.mul(exponent, lowered), d[0])
    if b.value(d[1]) == 0:
        return result
    return b.add(result, b.mul(b.mul(number, b.make("log", base)), d[1]))


def _sqrt(b: Builder, number: int, node: Node, d: Sequence[int]) -> int:
    return b.div(b.mul(b.const(HALF), d[0]), number)


def _abs(b: Builder, number: int, node: Node, d: Sequence[int]) -> int:
    """U' u/|u|: NaN at 0."""
    return b.mul(d[0], b.div(node.arguments[0], number))


def _sign(b: Builder, number: int, node: Node, d: Sequence[int]) -> int:
    return b.const(0)


def _min(b: Builder, number: int, node: Node, d: Sequence[int]) -> int:
    u, v = node.arguments
    return b.select(v, u, d[0], b.select(u, v, d[1], b.undefined()))


def _max(b: Builder, number: int, node: Node, d: Sequence[int]) -> int:
    u, v = node.arguments
    return b.select(u, v, d[0], b.select(v, u, d[1], b.undefined()))


def _select(b: Builder, number: int, node: Node, d: Sequence[int]) -> int:
    return b.select(node.arguments[0], node.arguments[1], d[2], d[3])


def _sin(b: Builder, number: int, node: Node, d: Sequence[int]) -> int:
    return b.mul(b.make("cos", node.arguments[0]), d[0])


def _cos(b: Builder, number: int, node: Node, d: Sequence[int]) -> int:
    return b.neg(b.mul(b.make("sin", node.arguments[0]), d[0]))


def _exp(b: Builder, number: int, node: Node, d: Sequence[int]) -> int:
    return b.mul(number, d[0])


def _log(b: Builder, number: int, node: Node, d: Sequence[int]) -> int:
    return b.div(d[0], node.arguments[0])


def _atan2(b: Builder, number: int, node: Node, d: Sequence[int]) -> int:
    u, v = node.arguments
    turn = _turn(b, u, v, d[0])
    if turn is not None:
        return turn
    return b.div(b.sub(b.mul(v, d[0]), b.mul(u, d[1])), b.add(b.square(u), b.square(v)))


def _turn(b: Builder, u: int, v: int, slope: int) -> int | None:
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


def _without(b: Builder, product: int, factor: int) -> int | None:
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


def _r0_conjunction(b: Builder, number: int, node: Node, d: Sequence[int]) -> int:
    """(1 - f/r) f' + (1 - g/r) g'."""
    f, g = node.arguments
    return b.add(b.mul(b.make("versine", f, g), d[0]), b.mul(b.make("versine", g, f), d[1]))


def _r0_disjunction(b: Builder, number: int, node: Node, d: Sequence[int]) -> int:
    """(1 + f/r) f' + (1 + g/r) g'."""
    f, g = node.arguments
    return b.add(b.mul(b.make("versine", b.neg(f), g), d[0]), b.mul(b.make("versine", b.neg(g), f), d[1]))


def _versine(b: Builder, number: int, node: Node, d: Sequence[int]) -> int:
    """G (f g' - g f')/r**3, written with f/r and g/r, which cannot overflow."""
    f, g = node.arguments
    inverse = b.div(b.const(1), b.sqrt(b.add(b.square(f), b.square(g))))
    cosine, sine = b.mul(f, inverse), b.mul(g, inverse)
    return b.mul(b.mul(sine, inverse), b.sub(b.mul(cosine, d[1]), b.mul(sine, d[0])))


def _gap(b: Builder, number: int, node: Node, d: Sequence[int]) -> int:
    """(s s'/2 - u t')/q with q = sqrt(t**2 + s**2), u the node."""
    s, t = node.arguments
    root = b.sqrt(b.add(b.square(t), b.square(s)))
    return b.div(b.sub(b.mul(b.mul(b.const(HALF), s), d[0]), b.mul(number, d[1])), root)


def _trimming(b: Builder, number: int, node: Node, d: Sequence[int]) -> int:
    """((1 + u s/q) s'/2 - (u**2/q) t')/rho with q = sqrt(t**2 + s**2), u = (q - t)/2, rho the node."""
    s, t = node.arguments
    gap = b.make("gap", s, t)
    ratio = b.div(gap, b.sqrt(b.add(b.square(t), b.square(s))))
    along_s = b.mul(b.mul(b.const(HALF), b.add(b.const(1), b.mul(ratio, s))), d[0])
    return b.div(b.sub(along_s, b.mul(b.mul(ratio, gap), d[1])), number)


def _normalised(b: Builder, number: int, node: Node, d: Sequence[int]) -> int:
    """(q f' - f q'/2)/(f**2 + q)**(3/2)."""
    f, q = node.arguments
    inverse = b.div(b.const(1), b.sqrt(b.add(b.square(f), q)))
    change = b.sub(b.mul(q, d[0]), b.mul(b.mul(b.const(Fraction(1, 2)), f), d[1]))
    return b.mul(change, b.powi(inverse, 3))


def _zero_with(b: Builder, number: int, node: Node, d: Sequence[int]) -> int:
    """That of the second, defined or not."""
    return d[1]


RULES: dict[str, Rule] = {
    "undefined": _undefined,
    "add": _add,
    "mul": _mul,
    "div": _div,
    "neg": _neg,
    "powi": _powi,
    "pow": _pow,
    "sqrt": _sqrt,
    "abs": _abs,
    "sign": _sign,
    "min": _min,
    "max": _max,
    "select": _select,
    "sin": _sin,
    "cos": _cos,
    "exp": _exp,
    "log": _log,
    "atan2": _atan2,
    "r0_conjunction": _r0_conjunction,
    "r0_disjunction": _r0_disjunction,
    "versine": _versine,
    "gap": _gap,
    "trimming": _trimming,
    "normalised": _normalised,
    "zero_with": _zero_with,
    **SYSTEM_RULES,
}
