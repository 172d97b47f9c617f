"""Images over boxes of what is monotone, by the rows of the table: the values at two corners, moved outwards.

The ends are computed by the operations themselves, so what rounding costs is said for each kind of value:

* "none": the ends are values of the operation, exact.
* "elementary": a function that is right to units in the last place.
* "powers": some sixty units in the last place; powers, logarithms and roots in them count for at most twenty.
* "root": stable forms with one square root, which add, multiply and divide numbers of one sign only; `interval_roots`
  says what happens where squares leave the range of float64. Only the minimum that stands for a conjunction there
  needs no margin above, nor the maximum for a disjunction below: they bound them.
* "sum": numbers of both signs are added, so the error is a share of |f| + |g|; of "sum over 1 + parameter" that over
  1 + alpha: (f + g - r)/(1 + alpha) loses that, and 2 f g/(f + g + r), being as large, no more.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

from rsym.bounds.interval_arithmetic import (
    ELEMENTARY,
    Interval,
    greatest,
    least,
    margin,
    nonnegative,
    only_nonnegative,
    outward,
    sizes,
)
from rsym.bounds.interval_roots import ROOT_TINY, STABLE, above, below, guard, squares
from rsym.program.builder import Builder
from rsym.program.operations import OPERATIONS
from rsym.program.program import Node
from rsym.program.row import DOWN, UP_IN_SIZE, Admissible

POWERS = Fraction(1, 2**46)


def monotone(name: str, b: Builder, node: Node, operands: Sequence[Interval]) -> Interval:
    """The image of a monotone operation."""
    row = OPERATIONS[name]
    inner = [sizes(b, u) if way == UP_IN_SIZE else u for u, way in zip(operands, row.grows, strict=True)]
    for clause in row.domain:
        for kind, place in clause:
            inner[place] = only_nonnegative(b, inner[place]) if kind == "nonnegative" else inner[place]
    if row.parameter is not None:
        inner[-1] = within(b, inner[-1], row.parameter)
    least_at = [u.upper if way == DOWN else u.lower for u, way in zip(inner, row.grows, strict=True)]
    most_at = [u.lower if way == DOWN else u.upper for u, way in zip(inner, row.grows, strict=True)]
    lower, upper = b.make(name, *least_at), b.make(name, *most_at)
    if row.rounding == "none":
        return Interval(lower, upper, row.nonnegative)
    if row.rounding in {"elementary", "powers"}:
        ends = outward(b, Interval(lower, upper), ELEMENTARY if row.rounding == "elementary" else POWERS)
    elif row.rounding == "root":
        ends = _of_root(b, row.logic, (lower, upper), least_at, most_at)
    else:
        over = {"sum": False, "sum over 1 + parameter": True}[row.rounding]
        ends = Interval(
            b.sub(lower, _share(b, least_at, over=over)),
            b.add(upper, _share(b, most_at, over=over)),
        )
    return nonnegative(b, ends) if row.nonnegative else ends


def _of_root(
    b: Builder, logic: str, ends: tuple[int, int], least_at: Sequence[int], most_at: Sequence[int]
) -> Interval:
    lower, upper = ends
    if logic == "or":
        lower = b.sub(lower, margin(b, lower, STABLE, b.const(ROOT_TINY)))
    else:
        lower = below(b, lower, squares(b, *least_at[::-1]))
    if logic == "and":
        upper = b.add(upper, margin(b, upper, STABLE, b.const(ROOT_TINY)))
    else:
        upper = above(b, upper, squares(b, *most_at[::-1]))
    return Interval(lower, upper)


def _share(b: Builder, at: Sequence[int], *, over: bool) -> int:
    """2**-46 of |f| + |g|, over 1 + the parameter, and infinite where squares are."""
    one = b.const(1)
    divisor = b.add(one, at[-1]) if over else one
    scale = b.add(b.abs(at[0]), b.abs(at[1]))
    share = b.mul(scale, b.make("div", one, divisor))
    return b.add(b.mul(b.const(POWERS), share), guard(b, b.square(scale)))


def within(b: Builder, u: Interval, legal: Admissible) -> Interval:
    """The part of a parameter within its range."""
    return between(b, u, legal.low, legal.high)


def between(b: Builder, u: Interval, low: int, high: int | None = None) -> Interval:
    """The part of a parameter within two numbers; nothing if there is none."""
    floor = b.const(low)
    part = Interval(greatest(b, u.lower, floor), u.upper, low >= 0)
    outside = b.select(floor, u.upper, b.undefined(), b.const(0))
    if high is not None:
        ceiling = b.const(high)
        part = Interval(part.lower, least(b, u.upper, ceiling), part.nonnegative)
        outside = b.select(u.lower, ceiling, b.undefined(), outside)
    return part.each(lambda end: b.add(end, outside), part.nonnegative)
