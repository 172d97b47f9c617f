"""Interval arithmetic on nodes: each function takes the ends of intervals and makes the ends of a result.

A lower end lies below every value, an upper end above; an end that is NaN says
nothing. Every operation keeps NaN: min and max do, and where a select chooses by
an end that may be NaN, the value of each branch is NaN then or does not need it.

Rounded results move outwards by `error` times their size and by `tiny`:

* Rounding to nearest costs 2**-53 of the result, moving the end as much again;
  2**-50 leaves six such steps. It covers the two steps behind one node: a factor
  that is a constant rounded to float64 and the product itself, a division written
  as a product with the inverse being two nodes of their own.
* Below the normal numbers an operation is off by at most 2**-1075; TINY is far above.
* A result that overflows is infinite: as an upper end that holds, as a lower
  end inf - 2**-50*inf is NaN, so it says nothing.
* sin, cos, exp, log, pow and atan2 are right to 2 units in the last place in
  `llvm` and to 4 in NumPy's vector code: ELEMENTARY is 2**-47 for 32 such units.
* A power by repeated squaring takes n - 1 products: n times 2**-52 more.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from fractions import Fraction
from itertools import product as combinations
from typing import NamedTuple

from rsym.program.builder import Builder
from rsym.program.powers import power
from rsym.program.program import Data, constant_value

ROUNDING = Fraction(1, 2**50)
ELEMENTARY = Fraction(1, 2**47)
TINY = Fraction(1, 2**996)  # 1.5e-300


class Interval(NamedTuple):
    """Nodes of the ends. `nonnegative`: so is what it encloses, and its lower end is then at least 0 (or NaN)."""

    lower: int
    upper: int
    nonnegative: bool = False

    def each(self, change: Callable[[int], int], nonnegative: bool = False) -> Interval:
        """The same change at both ends."""
        return Interval(change(self.lower), change(self.upper), nonnegative)


def neighbours(number: Fraction) -> tuple[float, float]:
    """The nearest float64 below and above, twice the number itself if it is one.

    Examples
    --------
    >>> low, high = neighbours(Fraction(1, 3))
    >>> Fraction(low) < Fraction(1, 3) < Fraction(high), neighbours(Fraction(1, 2))
    (True, (0.5, 0.5))
    """
    nearest = constant_value(number)
    exact = Fraction(nearest)
    low = nearest if exact <= number else math.nextafter(nearest, -math.inf)
    high = nearest if exact >= number else math.nextafter(nearest, math.inf)
    return low, high


def constant(b: Builder, data: Data) -> Interval:
    """A number between its neighbours; pi and e lie above the nearest float64."""
    if isinstance(data, str):
        nearest = constant_value(data)
        low, high = nearest, math.nextafter(nearest, math.inf) if data in {"pi", "e"} else nearest
    else:
        assert isinstance(data, Fraction)
        low, high = neighbours(data)
    return Interval(b.const(Fraction(low)), b.const(Fraction(high)), low >= 0)


def margin(b: Builder, v: int, error: Fraction, tiny: int) -> int:
    """error*|v| + tiny."""
    return b.add(b.mul(b.const(error), b.abs(v)), tiny)


def outward(b: Builder, u: Interval, error: Fraction = ROUNDING, tiny: Fraction = TINY) -> Interval:
    """Both ends moved outwards."""
    below, above = (margin(b, end, error, b.const(tiny)) for end in (u.lower, u.upper))
    return Interval(b.sub(u.lower, below), b.add(u.upper, above))


def least(b: Builder, *nodes: int) -> int:
    """The smallest; NaN if one is."""
    first, *rest = dict.fromkeys(nodes)
    for node in rest:
        first = b.make("min", first, node)
    return first


def greatest(b: Builder, *nodes: int) -> int:
    """The largest; NaN if one is."""
    first, *rest = dict.fromkeys(nodes)
    for node in rest:
        first = b.make("max", first, node)
    return first


def hull(b: Builder, u: Interval, v: Interval) -> Interval:
    """The smallest interval that contains both."""
    return Interval(least(b, u.lower, v.lower), greatest(b, u.upper, v.upper))


def corners(b: Builder, function: Callable[..., int], *operands: Interval, error: Fraction = ROUNDING) -> Interval:
    """The range of a function that is monotone in each operand alone, whatever the others are."""
    values = [function(*ends) for ends in combinations(*((u.lower, u.upper) for u in operands))]
    return outward(b, Interval(least(b, *values), greatest(b, *values)), error)


def clipped(b: Builder, u: Interval, low: int, high: int) -> Interval:
    """Within what the function can take at all."""
    return Interval(greatest(b, u.lower, b.const(low)), least(b, u.upper, b.const(high)), u.nonnegative)


def nothing(b: Builder) -> Interval:
    """No bound."""
    return Interval(b.undefined(), b.undefined())


def negative(b: Builder, u: Interval) -> Interval:
    """-u."""
    return Interval(b.neg(u.upper), b.neg(u.lower))


def sizes(b: Builder, u: Interval) -> Interval:
    """|u|."""
    if u.nonnegative:
        return u
    least_size = greatest(b, u.lower, b.neg(u.upper), b.const(0))
    return Interval(least_size, greatest(b, b.neg(u.lower), u.upper), True)


def total(b: Builder, u: Interval, v: Interval) -> Interval:
    """The sum u + v; below the normal numbers sums are exact."""
    return outward(b, Interval(b.add(u.lower, v.lower), b.add(u.upper, v.upper)), tiny=Fraction(0))


def product(b: Builder, u: Interval, v: Interval) -> Interval:
    """u*v of different functions; where one cannot be negative two products do."""
    if u.nonnegative and v.nonnegative:
        return outward(b, Interval(b.mul(u.lower, v.lower), b.mul(u.upper, v.upper)))
    if not u.nonnegative and not v.nonnegative:
        return corners(b, b.mul, u, v)
    size, other = (u, v) if u.nonnegative else (v, u)
    zero = b.const(0)
    lower = b.mul(other.lower, b.select(other.lower, zero, size.lower, size.upper))
    upper = b.mul(other.upper, b.select(other.upper, zero, size.upper, size.lower))
    return outward(b, Interval(lower, upper))


def square(b: Builder, u: Interval) -> Interval:
    """u*u."""
    return nonnegative(b, outward(b, sizes(b, u).each(b.square)))


def whole_power(b: Builder, u: Interval, exponent: int) -> Interval:
    """u**exponent for an integer."""
    if exponent < 0:
        return quotient(b, Interval(b.const(1), b.const(1), True), whole_power(b, u, -exponent))
    if exponent == 0:
        return Interval(b.const(1), b.const(1), True)
    base = u if exponent % 2 else sizes(b, u)
    if exponent == 1:
        return base
    power = outward(b, base.each(lambda end: b.powi(end, exponent)), ROUNDING + exponent * Fraction(1, 2**52))
    return nonnegative(b, power) if base.nonnegative else power


def nonnegative(b: Builder, u: Interval) -> Interval:
    """What is known not to be negative."""
    return Interval(greatest(b, u.lower, b.const(0)), u.upper, True)


def quotient(b: Builder, u: Interval, v: Interval) -> Interval:
    """u/v; nothing where v contains 0. A negative v changes the signs of both."""
    zero, unknown = b.const(0), b.undefined()

    def by_sign(positive: int, otherwise: int) -> int:
        return b.select(v.lower, zero, positive, otherwise)

    if v.nonnegative:
        near, far, top = by_sign(v.lower, unknown), by_sign(v.upper, unknown), u
    else:
        near = by_sign(v.lower, b.select(zero, v.upper, b.neg(v.upper), unknown))
        far = by_sign(v.upper, b.select(zero, v.upper, b.neg(v.lower), unknown))
        top = Interval(by_sign(u.lower, b.neg(u.upper)), by_sign(u.upper, b.neg(u.lower)))
    if u.nonnegative and v.nonnegative:
        divisors = far, near
    else:
        divisors = b.select(top.lower, zero, far, near), b.select(top.upper, zero, near, far)
    return outward(b, Interval(b.make("div", top.lower, divisors[0]), b.make("div", top.upper, divisors[1])))


def within_domain(b: Builder, u: Interval) -> Interval:
    """The part of u that is not negative; nothing if there is none."""
    if u.nonnegative:
        return u
    return Interval(least(b, greatest(b, u.lower, b.const(0)), u.upper), u.upper, True)


def only_nonnegative(b: Builder, u: Interval) -> Interval:
    """The interval u if none of it is negative; nothing where some is."""
    if u.nonnegative:
        return u
    return u.each(lambda end: b.select(b.const(0), u.lower, b.undefined(), end), True)


def root(b: Builder, u: Interval) -> Interval:
    """sqrt(u) over the part of u that is not negative."""
    return nonnegative(b, outward(b, within_domain(b, u).each(b.sqrt)))


def size_power(b: Builder, u: Interval, exponent: Interval) -> Interval:
    """u**exponent for u >= 0: monotone in u, and in the exponent; nothing at the pole u = 0 of a negative one."""
    if exponent.lower == exponent.upper:
        value = b.value(exponent.lower)
        if value is not None and value.denominator == 1 and abs(value) <= 64:
            return whole_power(b, u, int(value))
    plain = corners(b, lambda *ends: power(b, *ends), u, exponent, error=ELEMENTARY)
    pole = b.select(b.const(0), exponent.lower, b.undefined(), b.const(0))
    shift = b.select(u.lower, b.const(0), b.const(0), pole)
    return nonnegative(b, plain.each(lambda end: b.add(end, shift)))
