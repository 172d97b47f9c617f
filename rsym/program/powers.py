"""Roots, powers and extrema in primitive operations, which R-operations share; rows of |u|**a and sign(u)*|u|**a."""

from __future__ import annotations

from collections.abc import Sequence

from rsym.model.powers import absolute_power, signed_power
from rsym.program.program import Node
from rsym.program.row import Nodes, Operation, nonnegative, nonzero, of_power, positive


def largest(b: Nodes) -> int:
    """The largest finite number of the format that a backend computes in."""
    return b.make("const", data="largest")


def smallest(b: Nodes) -> int:
    """The smallest positive number of that format."""
    return b.make("const", data="smallest")


def root(b: Nodes, f: int, g: int) -> int:
    """sqrt(f**2 + g**2)."""
    return b.sqrt(b.add(b.square(f), b.square(g)))


def where_fails(b: Nodes, size: int, instead: int, value: int) -> int:
    """Take `instead` where the size is 0 or infinite: squares have left the range there. NaN stays."""
    return b.select(size, largest(b), instead, b.select(smallest(b), size, instead, value))


def signed_like(b: Nodes, near: int, value: int) -> int:
    """The value, or `near` where the value has lost the sign of that: what rounds to 0 below the normal numbers."""
    zero, tiny = b.const(0), smallest(b)
    positive = b.select(tiny, value, near, value)
    negative = b.select(value, b.neg(tiny), near, value)
    return b.select(near, zero, positive, b.select(zero, near, negative, value))


def where_above(b: Nodes, number: int, low: int, value: int) -> int:
    """The value where the number is above `low`, else NaN."""
    return b.select(number, b.const(low), value, b.undefined())


def at_most(b: Nodes, number: int, high: int) -> int:
    """The number, NaN above `high`."""
    return b.select(number, b.const(high), b.undefined(), number)


def at_least_one(b: Nodes, order: int, value: int) -> int:
    """The value where the order is 1 or more, else NaN."""
    return b.select(b.const(1), order, b.undefined(), value)


def sizes(b: Nodes, f: int, g: int) -> tuple[int, int]:
    """The smaller and the larger absolute value; both NaN if one is."""
    return b.make("min", b.abs(f), b.abs(g)), b.make("max", b.abs(f), b.abs(g))


def low(b: Nodes, f: int, g: int) -> int:
    """The smaller."""
    return b.select(g, f, f, g)


def high(b: Nodes, f: int, g: int) -> int:
    """The larger."""
    return b.select(f, g, f, g)


def whole_power(b: Nodes, base: int, exponent: int) -> int:
    """Repeated squaring, in an order that depends on the exponent alone."""
    if exponent < 0:
        return b.make("div", b.const(1), whole_power(b, base, -exponent))
    result, power = None, base
    while exponent:
        if exponent & 1:
            result = power if result is None else b.mul(result, power)
        exponent >>= 1
        if exponent:
            power = b.square(power)
    return b.const(1) if result is None else result


def whole(b: Nodes, number: int) -> int | None:
    """The integer that a node is, if it is one that repeated squaring serves."""
    value = b.value(number)
    return int(value) if value is not None and value.denominator == 1 and abs(value) <= 64 else None


def power(b: Nodes, base: int, exponent: int) -> int:
    """base**exponent for a base that is not negative."""
    integer = whole(b, exponent)
    return b.make("pow", base, exponent) if integer is None else whole_power(b, base, integer)


def radical(b: Nodes, base: int, degree: int) -> int:
    """base**(1/degree) for a base that is not negative; square roots where the degree is a power of two."""
    integer = whole(b, degree)
    if integer is None or integer < 1 or integer & (integer - 1):
        return b.make("pow", base, b.div(b.const(1), degree))
    while integer > 1:
        base, integer = b.sqrt(base), integer // 2
    return base


def log1p(b: Nodes, u: int) -> int:
    """log(1 + u) for u >= 0, exact to rounding: log(v) u/(v - 1) with v = 1 + u as rounded (Kahan)."""
    rounded = b.make("add", b.const(1), u)
    change = b.make("add", rounded, b.const(-1))
    return b.select(change, b.const(0), b.mul(b.make("log", rounded), b.make("div", u, change)), u)


def expm1(b: Nodes, u: int) -> int:
    """exp(u) - 1, exact to rounding: (w - 1) u/log(w) with w = exp(u) as rounded (Kahan)."""
    rounded = b.make("exp", u)
    logarithm = b.make("log", rounded)
    quotient = b.mul(b.make("add", rounded, b.const(-1)), b.make("div", u, logarithm))
    return b.select(b.abs(logarithm), b.const(0), quotient, u)


def _signed_expansion(b: Nodes, node: Node) -> int:
    """At u = 0 zero where a > 0, NaN elsewhere."""
    base, exponent = node.arguments
    size, zero = power(b, b.abs(base), exponent), b.const(0)
    at_zero = b.add(b.select(exponent, zero, zero, b.undefined()), base)
    return b.select(base, zero, size, b.select(zero, base, b.neg(size), at_zero))


def _by_exponent(b: Nodes, number: int, node: Node, slope: int, found: int) -> int:
    """What is found, and the power times log|u| a' where the exponent varies: with a letter, say."""
    if b.value(slope) == 0:
        return found
    return b.add(found, b.mul(b.mul(number, b.make("log", b.abs(node.arguments[0]))), slope))


def _absolute(b: Nodes, number: int, node: Node, d: Sequence[int]) -> int:
    base, exponent = node.arguments
    slope = b.mul(exponent, b.signed_power(base, b.sub(exponent, b.const(1))))
    return _by_exponent(b, number, node, d[1], b.mul(slope, d[0]))


def _signed(b: Nodes, number: int, node: Node, d: Sequence[int]) -> int:
    base, exponent = node.arguments
    slope = b.mul(exponent, b.absolute_power(base, b.sub(exponent, b.const(1))))
    return _by_exponent(b, number, node, d[1], b.mul(slope, d[0]))


SIGNED_POWERS: dict[str, Operation] = {
    "absolute_power": Operation(
        2,
        lambda np, u, a: np.float_power(np.abs(u), a),
        lambda b, node: power(b, b.abs(node.arguments[0]), node.arguments[1]),
        _absolute,
        of_power,
        formula=absolute_power,
        domain=((*nonzero(0), *nonnegative(1)),),
        analytic=(nonzero(0),),
        nonnegative=True,
        parity="even",
        zeros=("0+",),
    ),
    "signed_power": Operation(
        2,
        # for a = 0 undefined at u = 0
        lambda np, u, a: np.where(u == 0, np.where(a > 0, 0.0, np.nan), np.sign(u) * np.float_power(np.abs(u), a)),
        _signed_expansion,
        _signed,
        of_power,
        formula=signed_power,
        domain=((*nonzero(0), *positive(1)),),
        analytic=(nonzero(0),),
        strict=True,
        parity="odd",
        zeros=("0+",),
    ),
}
