"""How far the sides of a choice part the values of an operation: the bounds that rows give to `jumps`."""

from __future__ import annotations

from collections.abc import Sequence

from rsym.program.program import Node
from rsym.program.row import Nodes, Rule


def summed(b: Nodes, jumps: Sequence[int]) -> int:
    """The sum of jumps."""
    total = b.const(0)
    for jump in jumps:
        total = b.add(total, jump)
    return total


def lipschitz(factor: int) -> Rule:
    """An operation of which no partial derivative is larger in size."""
    return lambda b, number, node, jumps: b.mul(b.const(factor), summed(b, jumps[:2]))


def unbounded(b: Nodes, number: int, node: Node, jumps: Sequence[int]) -> int:
    """Nothing is known of the other sides where an argument jumps."""
    return b.select(summed(b, jumps), b.const(0), b.make("exp", b.const(10**5)), b.const(0))


def within(b: Nodes, size: int, total: int, most: int) -> int:
    """4 total/size where that is below 1, else `most` where there is a jump at all."""
    wide = b.mul(b.const(4), total)
    some = b.select(total, b.const(0), b.const(most), b.const(0))
    return b.select(size, wide, b.make("div", wide, size), some)


def of_power(b: Nodes, number: int, node: Node, jumps: Sequence[int]) -> int:
    """A (|u| + j)**(a - 1) j for a constant exponent a >= 1, 2 j**a for 0 < a < 1."""
    base, exponent = node.arguments
    value = b.value(exponent)
    if value is None or value <= 0:
        return unbounded(b, number, node, jumps)
    if value < 1:
        return b.mul(b.const(2), b.absolute_power(jumps[0], exponent))
    reach = b.absolute_power(b.add(b.abs(base), jumps[0]), b.sub(exponent, b.const(1)))
    return b.mul(b.mul(exponent, reach), jumps[0])
