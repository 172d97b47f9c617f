"""Quadratic models along a segment of a ray: arithmetic on them, as nodes.

On the segment s runs from -1 to 1, and of a function f is known that

    f(s) = linear*s + quadratic*s**2 + e,  low <= e <= high.

A number, and what is nothing but a range, have linear = quadratic = 0. Along a beam the same holds for every point of
it: the radius is part of low and high of the coordinates. Quadrics are exact; of higher powers

    s**3 = 3/4*s + [-1/4, 1/4],  s**4 = s**2 + [-1/4, 0].

Smooth functions are composed by Taylor's formula of order 2 with its remainder, where that is narrower than a range.

Every end is finite: what is beyond `huge` counts as that large, so no quotient makes a NaN, and languages whose min,
max and comparisons of NaN are undefined compute the same. Values beyond it lie closer to a pole than 1/huge; what is
smaller than that counts as 0.

Rounding is part of each result: a share `slack` of the largest term moves low and high outwards; of functions of libm,
of powers and what else is not basic arithmetic, a share `elementary` of the value.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import NamedTuple

from rsym.program.builder import HALF, Builder
from rsym.program.program import FLOAT32, FLOAT64, Precision

QUARTER = Fraction(1, 4)


class RayModel(NamedTuple):
    """The nodes of low, high, linear, quadratic."""

    low: int
    high: int
    linear: int
    quadratic: int


class RayRange(NamedTuple):
    """The nodes of both ends."""

    low: int
    high: int


@dataclass(frozen=True)
class RayRounding:
    """What rounding may cost in a precision.

    No operation here has more than eight roundings of its largest term one after the other: `slack` holds sixteen.
    Functions are right to a few units in the last place, in float32 on graphics processors to some dozens.
    The square of `huge` is finite; exp(`largest_exponent`) is about as large as that.
    """

    slack: Fraction
    elementary: Fraction
    huge: Fraction
    largest_exponent: int


ROUNDINGS = {
    FLOAT64.name: RayRounding(Fraction(1, 2**49), Fraction(1, 2**44), Fraction(10**100), 230),
    FLOAT32.name: RayRounding(Fraction(1, 2**20), Fraction(1, 2**16), Fraction(10**18), 41),
}


class RayArithmetic:
    """Makes the nodes of models of a precision.

    Examples
    --------
    >>> from rsym.backends.interpreter import interpret
    >>> b = Builder(("k",), ())
    >>> models = RayArithmetic(b)
    >>> line = RayModel(b.const(3), b.const(3), b.input("k"), b.const(0))
    >>> low, high, linear, quadratic = interpret(b.program(models.square(line)._asdict()), {"k": 0.5}).values()
    >>> round(float(low), 9), round(float(high), 9), float(linear), float(quadratic)
    (9.0, 9.0, 3.0, 0.25)
    """

    def __init__(self, builder: Builder, precision: Precision = FLOAT64) -> None:
        self.b = builder
        self.rounding = ROUNDINGS[precision.name]
        self.zero, self.one = builder.const(0), builder.const(1)
        self.huge, self.tiny = builder.const(self.rounding.huge), builder.const(1 / self.rounding.huge)
        self.slack, self.elementary = builder.const(self.rounding.slack), builder.const(self.rounding.elementary)

    # What models are made of

    def number(self, k: int) -> RayModel:
        """A number as it stands."""
        return RayModel(k, k, self.zero, self.zero)

    def constant(self, value: Fraction | int) -> RayModel:
        """A rational number."""
        return self.number(self.b.const(value))

    def hull(self, low: int, high: int) -> RayModel:
        """A range alone."""
        return RayModel(self.greater(low, self.b.neg(self.huge)), self.lesser(high, self.huge), self.zero, self.zero)

    def unknown(self) -> RayModel:
        """Nothing is known."""
        return RayModel(self.b.neg(self.huge), self.huge, self.zero, self.zero)

    def lesser(self, *nodes: int) -> int:
        """The smallest; a number that stands twice is compared once."""
        first, *rest = dict.fromkeys(nodes)
        for node in rest:
            first = self.b.make("min", first, node)
        return first

    def greater(self, *nodes: int) -> int:
        """The largest."""
        first, *rest = dict.fromkeys(nodes)
        for node in rest:
            first = self.b.make("max", first, node)
        return first

    def sum(self, *nodes: int) -> int:
        """The sum."""
        total = self.zero
        for node in nodes:
            total = self.b.add(total, node)
        return total

    def chosen(self, a: int, b: int, yes: RayModel, no: RayModel) -> RayModel:
        """`yes` where a > b."""
        return RayModel(*(self.b.select(a, b, *ends) for ends in zip(yes, no, strict=True)))

    def outward(self, u: RayModel, size: int) -> RayModel:
        """Low and high moved outwards by the share `slack` of a size."""
        margin = self.b.mul(self.slack, size)
        return RayModel(self.b.sub(u.low, margin), self.b.add(u.high, margin), u.linear, u.quadratic)

    def settled(self, u: RayModel, size: int) -> RayModel:
        """The same of what may be next to unknown, and as steep as a pole: where it is, the range alone."""
        moved, reach = self.outward(u, size), self.reach(u)
        low, high = self.b.sub(moved.low, reach), self.b.add(moved.high, reach)
        return self.chosen(
            self.b.mul(self.b.const(QUARTER), self.huge), self.b.sub(high, low), moved, self.hull(low, high)
        )

    def lowered(self, u: RayModel, by: int) -> RayModel:
        """Low moved down by that much."""
        return u._replace(low=self.b.sub(self.b.sub(u.low, by), self.b.mul(self.slack, self.b.abs(u.low))))

    # What is known of them

    def reach(self, u: RayModel) -> int:
        """|linear| + |quadratic|: how far the function moves from low and high."""
        return self.b.add(self.b.abs(u.linear), self.b.abs(u.quadratic))

    def size(self, u: RayModel) -> int:
        """At least the size of the function, and of each of the four numbers."""
        return self.b.add(self.greater(self.b.abs(u.low), self.b.abs(u.high)), self.reach(u))

    def centre(self, u: RayModel) -> int:
        """The middle of low and high."""
        return u.low if u.low == u.high else self.b.mul(self.b.const(HALF), self.b.add(u.low, u.high))

    def radius(self, u: RayModel, centre: int) -> int:
        """How far low and high are from it."""
        if u.low == u.high:
            return self.zero
        return self.greater(self.b.sub(u.high, centre), self.b.sub(centre, u.low))

    def range(self, u: RayModel) -> RayRange:
        """The least and the greatest value: at the ends of the segment, and at the vertex if it lies between."""
        b = self.b
        if u.linear == self.zero and u.quadratic == self.zero:
            return RayRange(u.low, u.high)
        slope, bend = b.abs(u.linear), b.abs(u.quadratic)
        if u.quadratic == self.zero:
            below, above = b.neg(slope), slope
        else:
            twice = b.mul(b.const(2), bend)
            divisor = b.select(twice, slope, u.quadratic, self.one)
            vertex = b.mul(b.const(-QUARTER), b.make("div", b.square(u.linear), divisor))
            inside = b.select(twice, slope, vertex, u.quadratic)
            below = self.lesser(b.sub(u.quadratic, slope), inside)
            above = self.greater(b.add(u.quadratic, slope), inside)
        low, high, reach = b.add(u.low, below), b.add(u.high, above), b.add(slope, bend)
        return RayRange(
            b.sub(low, b.mul(self.slack, b.add(b.abs(u.low), reach))),
            b.add(high, b.mul(self.slack, b.add(b.abs(u.high), reach))),
        )

    # Sums and products

    def add(self, u: RayModel, v: RayModel) -> RayModel:
        """U + v."""
        total = RayModel(*(self.b.add(p, q) for p, q in zip(u, v, strict=True)))
        return self.outward(total, self.size(total))

    def negative(self, u: RayModel) -> RayModel:
        """-u."""
        return RayModel(self.b.neg(u.high), self.b.neg(u.low), self.b.neg(u.linear), self.b.neg(u.quadratic))

    def subtract(self, u: RayModel, v: RayModel) -> RayModel:
        """U - v."""
        return self.add(u, self.negative(v))

    def times(self, u: RayModel, value: Fraction | int) -> RayModel:
        """A rational number times u."""
        return self.product(u, self.constant(value))

    def product(self, u: RayModel, v: RayModel) -> RayModel:
        """U*v; of two ranges the product of their ends, which a middle and a radius would lose."""
        b = self.b
        for one, other in ((u, v), (v, u)):
            if one == self.number(one.low):
                return self.scaled(other, one.low)
        c, d = self.centre(u), self.centre(v)
        ends = [b.mul(p, q) for p in dict.fromkeys(u[:2]) for q in dict.fromkeys(v[:2])]
        cubic = b.add(b.mul(u.linear, v.quadratic), b.mul(u.quadratic, v.linear))
        quartic = b.mul(u.quadratic, v.quadratic)
        linear = self.sum(b.mul(c, v.linear), b.mul(d, u.linear), b.mul(b.const(3 * QUARTER), cubic))
        quadratic = self.sum(b.mul(c, v.quadratic), b.mul(d, u.quadratic), b.mul(u.linear, v.linear), quartic)
        wide = self.sum(
            b.mul(self.reach(u), self.radius(v, d)),
            b.mul(self.reach(v), self.radius(u, c)),
            b.mul(b.const(QUARTER), b.abs(cubic)),
        )
        rest = b.mul(b.const(-QUARTER), quartic)
        low = b.add(b.sub(self.lesser(*ends), wide), self.lesser(rest, self.zero))
        high = b.add(b.add(self.greater(*ends), wide), self.greater(rest, self.zero))
        return self.settled(RayModel(low, high, linear, quadratic), b.mul(self.size(u), self.size(v)))

    def scaled(self, u: RayModel, k: int) -> RayModel:
        """A number times u."""
        ends = [self.b.mul(k, end) for end in u[:2]]
        scaled = RayModel(self.lesser(*ends), self.greater(*ends), *(self.b.mul(k, part) for part in u[2:]))
        return self.outward(scaled, self.size(scaled))

    def square(self, u: RayModel) -> RayModel:
        """U*u."""
        b, c, reach = self.b, self.centre(u), self.reach(u)
        least = u.low if u.low == u.high else self.greater(u.low, b.neg(u.high), self.zero)
        most = u.low if u.low == u.high else self.greater(b.neg(u.low), u.high)
        cubic, quartic = b.mul(b.const(2), b.mul(u.linear, u.quadratic)), b.square(u.quadratic)
        twice = b.mul(b.const(2), c)
        linear = b.add(b.mul(twice, u.linear), b.mul(b.const(3 * QUARTER), cubic))
        quadratic = self.sum(b.mul(twice, u.quadratic), b.square(u.linear), quartic)
        wide = b.mul(b.const(2), b.mul(reach, self.radius(u, c)))
        wide = b.add(wide, b.mul(b.const(QUARTER), b.abs(cubic)))
        low = self.sum(b.square(least), b.neg(wide), b.mul(b.const(-QUARTER), quartic))
        high = b.add(b.square(most), wide)
        return self.settled(RayModel(low, high, linear, quadratic), b.square(b.add(most, reach)))

    # Smooth functions

    def composed(self, u: RayModel, taylor: Sequence[int], bound: int) -> RayModel:
        """Taylor's formula f + g d + h d**2, |remainder| <= bound |d|**3, d the difference from the middle of u.

        `taylor` are f, g and h at the middle.
        """
        b, (f, g, h) = self.b, taylor
        reach, radius = self.reach(u), self.radius(u, self.centre(u))
        cubic, quartic = b.mul(b.const(2), b.mul(u.linear, u.quadratic)), b.square(u.quadratic)
        linear = b.add(b.mul(g, u.linear), b.mul(h, b.mul(b.const(3 * QUARTER), cubic)))
        quadratic = b.add(b.mul(g, u.quadratic), b.mul(h, b.add(b.square(u.linear), quartic)))
        distance = b.add(reach, radius)
        crossed = b.mul(b.add(reach, distance), radius)
        wide = self.sum(
            b.mul(b.abs(g), radius),
            b.mul(b.abs(h), b.add(crossed, b.mul(b.const(QUARTER), b.abs(cubic)))),
            b.mul(bound, b.mul(distance, b.square(distance))),
        )
        rest = b.mul(h, b.mul(b.const(-QUARTER), quartic))
        low = b.add(b.sub(f, wide), self.lesser(rest, self.zero))
        high = b.add(b.add(f, wide), self.greater(rest, self.zero))
        # What a rounded middle costs, and rounded values of the function and its derivatives.
        scale = self.sum(
            b.abs(f),
            b.mul(b.abs(g), b.add(distance, b.abs(self.centre(u)))),
            b.mul(b.abs(h), b.square(distance)),
        )
        ratio = b.const(self.rounding.elementary / self.rounding.slack)
        return self.settled(RayModel(low, high, linear, quadratic), b.mul(ratio, scale))

    def better(self, u: RayModel, low: int, high: int) -> RayModel:
        """The model, or the range where that is not twice as wide as low and high leave open."""
        b = self.b
        open_ = b.mul(b.const(2), b.sub(u.high, u.low))
        return self.chosen(b.sub(high, low), open_, u, self.hull(low, high))

    def widened(self, low: int, high: int, *sizes: int) -> RayRange:
        """Ends moved outwards by the share `elementary` of their size, and of what else they were made of."""
        b, below = self.b, self.b.neg(self.huge)
        low, high = (self.lesser(self.greater(end, below), self.huge) for end in (low, high))
        margins = (b.add(self.tiny, b.mul(self.elementary, self.sum(b.abs(end), *sizes))) for end in (low, high))
        return RayRange(b.sub(low, next(margins)), b.add(high, next(margins)))

    def root(self, u: RayModel) -> RayModel:
        """The square root of u over the part of its range that is not negative."""
        b, (low, high) = self.b, self.range(u)
        ends = self.widened(*(b.sqrt(self.greater(end, self.zero)) for end in (low, high)))
        ends = RayRange(self.greater(ends.low, self.zero), ends.high)
        clear = (low, b.mul(b.const(Fraction(1, 1000)), high))
        least = b.select(*clear, b.select(low, self.zero, low, self.one), self.one)
        c = self.greater(self.centre(u), least)
        f = b.sqrt(c)
        g = b.make("div", b.const(HALF), f)
        h = b.mul(b.const(-QUARTER), b.make("div", g, c))
        bound = b.make("div", b.const(Fraction(1, 16)), b.mul(b.square(least), b.sqrt(least)))
        smooth = self.better(self.composed(u, (f, g, h), bound), *ends)
        near = self.hull(*ends)
        return self.chosen(*clear, self.chosen(low, self.zero, smooth, near), near)

    def inverse(self, u: RayModel) -> RayModel:
        """1/u; beyond all bounds on the side where u may be 0."""
        b, (low, high) = self.b, self.range(u)
        above, below = (low, self.zero), (self.zero, high)

        def unless_zero(value: int, otherwise: int) -> int:
            return b.select(*above, value, b.select(*below, value, otherwise))

        p, q = unless_zero(low, self.one), unless_zero(high, self.one)
        c = unless_zero(self.centre(u), self.one)
        inverse = b.make("div", self.one, c)
        square = b.square(inverse)
        nearest = b.make("div", self.one, self.lesser(b.abs(p), b.abs(q)))
        ends = self.widened(b.make("div", self.one, q), b.make("div", self.one, p))
        smooth = self.better(
            self.composed(u, (inverse, b.neg(square), b.mul(square, inverse)), b.square(b.square(nearest))), *ends
        )
        # Of one sign up to 0 itself, or unknown.
        least = b.select(self.zero, low, b.neg(self.huge), b.make("div", self.one, self.greater(high, self.tiny)))
        most = b.select(high, self.zero, self.huge, b.make("div", self.one, self.lesser(low, b.neg(self.tiny))))
        return self.chosen(*above, smooth, self.chosen(*below, smooth, self.hull(least, most)))
