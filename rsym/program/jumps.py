"""Where the two sides of a switch differ: at such a point a derivative does not exist.

A program differentiates each branch of a choice on its own, which is right wherever no choice is on its border. At a
point of a border let a node have the values v_s on the sides s, each side a formula that is smooth there. Here every
node u gets a companion J(u), also a node of the program, with

    |v_s - v| <= J(u) on all sides s, v the value that the program computes,

and J(u) = 0 where no choice below u is on its border. If J(f) = 0 and J(D) = 0 for the formula D = df/dx, then all
f_s(p + h) = f(p) + h D + o(h), whichever side p + h lies on: df/dx exists and is D. Where J(f) > 0 the function jumps,
where J(D) > 0 it has a kink. The argument repeats for D in the place of f, to any order.

J follows from bounds of the slopes of the operations: what is bounded times what vanishes has no jump, so
x**2 sign(x) has the gradient 0 at 0, and no second derivative.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

from rsym.program.builder import Builder
from rsym.program.elementary import bearing
from rsym.program.operations import JUMPING, OPERATIONS
from rsym.program.program import Node, live
from rsym.program.sides import unbounded

Companions = Sequence[int]


class Jumps:
    """The companions J of nodes, made when they are asked for; the constant 0 where no choice matters.

    Examples
    --------
    >>> builder = Builder(("x",), ())
    >>> x, zero = builder.input("x"), builder.const(0)
    >>> positive = builder.select(x, zero, x, zero)
    >>> jumps = Jumps(builder)
    >>> builder.value(jumps[x]), builder.value(jumps[positive])
    (Fraction(0, 1), None)
    """

    def __init__(self, builder: Builder) -> None:
        self.builder = builder
        self._known: dict[int, int] = {}

    def __getitem__(self, number: int) -> int:
        b = self.builder
        zero = b.const(0)
        for part in live(b.nodes, [number]):
            if part not in self._known:
                node = b.nodes[part]
                inner = [self._known[argument] for argument in node.arguments]
                smooth = node.operation not in JUMPING and all(jump == zero for jump in inner)
                self._known[part] = zero if smooth or b.uniform[part] else self._companion(part, node, inner)
        return self._known[number]

    def _companion(self, number: int, node: Node, inner: Companions) -> int:
        if node.operation in {"sin", "cos"}:
            return self._without_turns(node.arguments[0], Fraction(1))
        return (OPERATIONS[node.operation].jump or unbounded)(self.builder, number, node, inner)

    def _without_turns(self, number: int, factor: Fraction) -> int:
        """J of an angle of which whole turns do not count: the cut of atan2, times a whole number, is none."""
        b = self.builder
        operation, arguments, _ = b.nodes[number]
        if operation == "neg":
            return self._without_turns(arguments[0], factor)
        if operation == "add":
            return b.add(*(self._without_turns(argument, factor) for argument in arguments))
        value = b.value(arguments[0]) if operation == "mul" else None
        if value is not None:
            return b.mul(b.const(abs(value)), self._without_turns(arguments[1], factor * value))
        if operation == "atan2" and factor.denominator == 1:
            return bearing(b, number, b.nodes[number], [self[argument] for argument in arguments])
        return self[number]

    def borders(self, number: int) -> int:
        """A node that is positive where a choice below a node is on its border, else 0."""
        b = self.builder
        total = b.const(0)
        for part in live(b.nodes, [number]):
            operation, arguments, _ = b.nodes[part]
            if operation in JUMPING and self[part] != b.const(0):
                apart = b.sub(*arguments[:2]) if operation == "select" else arguments[0]
                total = b.add(total, b.select(b.abs(apart), b.const(0), b.const(0), b.const(1)))
        return total


def doubt(b: Builder, jump: int, size: int, share: Fraction) -> int:
    """1 where a jump is more than this share of the size, or unknown, else 0: what is less is rounding."""
    zero, one = b.const(0), b.const(1)
    if jump == zero:
        return zero
    unknown = b.select(jump, b.const(-1), zero, one)
    return b.select(b.mul(b.const(share), size), jump, zero, b.select(jump, zero, one, unknown))


def unless(b: Builder, doubts: int, value: int) -> int:
    """The value, or NaN where there is a doubt."""
    return value if b.value(doubts) == 0 else b.select(doubts, b.const(0), b.undefined(), value)
