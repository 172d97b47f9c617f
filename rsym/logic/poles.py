"""Leaves with poles, as gates: a change of sign through infinity is no zero.

A sum w + k*n/q has the sign of (w*q + k*n)/q, so of max(min(a, q), min(-a, -q)) with a = w*q + k*n: the zeros are those
of a, and where q changes its sign the body ends without one, as at the end of a domain (`domains`).
"""

from __future__ import annotations

from collections.abc import Callable

from rsym.logic.domains import ended, lowest, terms_of
from rsym.program.builder import Builder


def without_pole(builder: Builder, leaf: int, whole: Callable[[int], int]) -> int | None:
    """A leaf that has a pole in one of its terms by what has none; None of others. `whole` does that for what is made.

    Examples
    --------
    >>> b = Builder(("x", "y"), ())
    >>> x, y = b.input("x"), b.input("y")
    >>> made = without_pole(b, b.sub(b.div(b.const(1), x), y), lambda node: node)
    >>> made == b.make("max", *(b.make("min", *pair) for pair in _both(b, x, b.sub(b.const(1), b.mul(x, y)))))
    True
    """
    terms = terms_of(builder, leaf)
    pole = next((number for number, _ in terms if _has_pole(builder, number)), None)
    if pole is None:
        return None
    _, (_, under), _ = builder.nodes[pole]
    over = builder.const(0)
    for number, times in terms:
        above, below = builder.nodes[number].arguments if _is_quotient(builder, number) else (number, None)
        if below != under:
            above = builder.mul(above, under)
        product = above if below in (None, under) else builder.div(above, below)
        over = builder.add(over, builder.mul(builder.const(times), product))
    if lowest(builder, under) >= 0:
        return whole(over)
    if lowest(builder, builder.neg(under)) >= 0:
        return whole(builder.neg(over))
    for side in (under, builder.neg(under)):
        builder.walls.setdefault(side, {})
    sides = [ended(builder, whole(domain), whole(value)) for domain, value in _both(builder, under, over)]
    return builder.make("max", *sides)


def _both(builder: Builder, under: int, over: int) -> tuple[tuple[int, int], tuple[int, int]]:
    return (under, over), (builder.neg(under), builder.neg(over))


def _is_quotient(builder: Builder, number: int) -> bool:
    operation, arguments, _ = builder.nodes[number]
    return operation == "div" and not builder.uniform[arguments[1]]


def _has_pole(builder: Builder, number: int) -> bool:
    """Whether a node is a quotient whose divisor may be zero."""
    if not _is_quotient(builder, number):
        return False
    under = builder.nodes[number].arguments[1]
    return lowest(builder, under) <= 0 and lowest(builder, builder.neg(under)) <= 0
