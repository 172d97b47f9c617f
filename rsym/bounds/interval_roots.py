"""Images over boxes of R_0 and of what else is made of one square root: exact, for they are monotone.

By the partial derivatives, r = sqrt(f**2 + g**2):

* R_0: 1 -+ f/r >= 0, so it grows with f and g.
* versine 1 - f/r falls with f, and moves away from 1 as |g| falls.
* gap (sqrt(t**2 + s**2) - t)/2 falls with t and grows with |s|; trimming sqrt(s + gap**2) too, for s >= 0.
* normalised f/sqrt(f**2 + q) grows with f, and goes towards 0 as q grows.

The ends are computed by the operations themselves, whose stable forms add, multiply and divide numbers of one sign
only: at most eight roundings, STABLE leaves thirty. Where squares leave the range of float64 that is not so:
below 1e-160 a root is wrong by as much, which ROOT_TINY adds, and quotients are unknown there; above 1e154 it is
infinite, and so is the radicand times 2**-960 in the margin: the end says nothing. Only the minimum that stands for
a conjunction there needs no such margin above, nor the maximum for a disjunction below: they bound them.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from typing import TypeAlias

from rsym.bounds.interval_arithmetic import (
    Interval,
    clipped,
    margin,
    nonnegative,
    only_nonnegative,
    root,
    sizes,
    square,
    total,
)
from rsym.program.builder import Builder
from rsym.program.program import Node

Rule: TypeAlias = Callable[[Builder, Node, Sequence[Interval]], Interval]

STABLE = Fraction(1, 2**48)
ROOT_TINY = Fraction(1, 2**530)  # 2.8e-160
RANGE = Fraction(1, 2**960)


def squares(b: Builder, f: int, g: int) -> int:
    """f**2 + g**2."""
    return b.add(b.square(f), b.square(g))


def guard(b: Builder, radicand: int) -> int:
    """ROOT_TINY; infinite where the radicand is."""
    return b.add(b.const(ROOT_TINY), b.mul(b.const(RANGE), radicand))


def where_in_range(b: Builder, value: int, radicand: int) -> int:
    """The value where the radicand has not lost its bits."""
    return b.select(radicand, b.const(RANGE), value, b.undefined())


def below(b: Builder, value: int, radicand: int) -> int:
    """A value moved down by its margin."""
    return b.sub(value, margin(b, value, STABLE, guard(b, radicand)))


def above(b: Builder, value: int, radicand: int) -> int:
    """A value moved up by its margin."""
    return b.add(value, margin(b, value, STABLE, guard(b, radicand)))


def versine(b: Builder, node: Node, operands: Sequence[Interval]) -> Interval:
    """1 - f/sqrt(f**2 + g**2)."""
    f, g, zero = operands[0], sizes(b, operands[1]), b.const(0)
    lower_g = b.select(f.upper, zero, g.lower, g.upper)
    upper_g = b.select(zero, f.lower, g.lower, g.upper)
    ends = []
    for along, across, moved in ((f.upper, lower_g, below), (f.lower, upper_g, above)):
        radicand = squares(b, along, across)
        ends.append(moved(b, where_in_range(b, b.make("versine", along, across), radicand), radicand))
    return clipped(b, Interval(ends[0], ends[1], True), 0, 2)


def _over_root(b: Builder, f: Interval, q: Interval) -> Interval:
    """f/sqrt(f**2 + q) for q >= 0."""
    zero = b.const(0)
    lower_q = b.select(zero, f.lower, q.lower, q.upper)
    upper_q = b.select(f.upper, zero, q.lower, q.upper)
    ends = []
    for end, rest, moved in ((f.lower, lower_q, below), (f.upper, upper_q, above)):
        radicand = b.add(b.square(end), rest)
        ends.append(moved(b, where_in_range(b, b.make("normalised", end, rest), radicand), radicand))
    return clipped(b, Interval(ends[0], ends[1]), -1, 1)


def cosine(b: Builder, f: Interval, g: Interval) -> Interval:
    """f/sqrt(f**2 + g**2)."""
    return _over_root(b, f, square(b, g))


def radius(b: Builder, f: Interval, g: Interval) -> Interval:
    """sqrt(f**2 + g**2)."""
    return root(b, nonnegative(b, total(b, square(b, f), square(b, g))))


def _normalised(b: Builder, node: Node, operands: Sequence[Interval]) -> Interval:
    return _over_root(b, operands[0], only_nonnegative(b, operands[1]))


ROOT_IMAGES: dict[str, Rule] = {
    "versine": versine,
    "normalised": _normalised,
}
