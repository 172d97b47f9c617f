"""Images of the elementary operations over boxes."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from functools import partial

from rsym.bounds.interval_arithmetic import (
    ELEMENTARY,
    Interval,
    clipped,
    constant,
    corners,
    hull,
    negative,
    nothing,
    only_nonnegative,
    outward,
    product,
    quotient,
    root,
    size_power,
    sizes,
    square,
    total,
    whole_power,
    within_domain,
)
from rsym.bounds.interval_monotone import monotone
from rsym.bounds.interval_roots import ROOT_IMAGES, Rule, cosine, versine
from rsym.bounds.interval_systems import SYSTEM_IMAGES, norm_share
from rsym.program.builder import HALF, Builder
from rsym.program.operations import OPERATIONS
from rsym.program.program import Node

# Below this a constant that float64 does not hold loses more than a share of 2**-53 when it is rounded.
_SUBNORMAL = Fraction(1, 2**1000)


def scaled(b: Builder, factor: Fraction, u: Interval) -> Interval:
    """A constant times u, rounding of the constant included."""
    if abs(factor) < _SUBNORMAL:
        return product(b, constant(b, factor), u)
    turned = u if factor > 0 else Interval(u.upper, u.lower)
    return outward(b, turned.each(lambda end: b.mul(b.const(factor), end)))


def _powi(b: Builder, node: Node, operands: Sequence[Interval]) -> Interval:
    assert isinstance(node.data, int)
    return whole_power(b, operands[0], node.data)


def _pow(b: Builder, node: Node, operands: Sequence[Interval]) -> Interval:
    """A negative base has powers with integer exponents: where those may occur nothing is known."""
    base, exponent = operands
    if base.nonnegative:
        return size_power(b, base, exponent)
    value = b.value(exponent.lower)
    if exponent.lower == exponent.upper and value is not None and value.denominator > 1:
        return size_power(b, within_domain(b, base), exponent)
    return size_power(b, only_nonnegative(b, base), exponent)


def _log(b: Builder, node: Node, operands: Sequence[Interval]) -> Interval:
    return outward(b, within_domain(b, operands[0]).each(lambda end: b.make("log", end)), ELEMENTARY)


def _wave(name: str) -> Rule:
    """Sin and cos: a peak lies inside where the slope turns from rising to falling; from a width of 3 on, all."""

    def rule(b: Builder, node: Node, operands: Sequence[Interval]) -> Interval:
        (u,) = operands
        zero, one = b.const(0), b.const(1)
        slopes = [b.make("cos", end) if name == "sin" else b.neg(b.make("sin", end)) for end in u[:2]]
        plain = corners(b, lambda end: b.make(name, end), u, error=ELEMENTARY)
        width = b.sub(u.upper, u.lower)

        def turning(first: tuple[int, int], last: tuple[int, int], extreme: int, otherwise: int) -> int:
            inside = b.select(*first, b.select(*last, extreme, otherwise), otherwise)
            return b.select(width, b.const(3), extreme, inside)

        rising, falling = (slopes[0], zero), (zero, slopes[1])
        upper = turning(rising, falling, one, plain.upper)
        lower = turning((zero, slopes[0]), (slopes[1], zero), b.const(-1), plain.lower)
        return clipped(b, Interval(lower, upper), -1, 1)

    return rule


def _atan2(b: Builder, node: Node, operands: Sequence[Interval]) -> Interval:
    """Monotone in each alone, but for the cut u = 0, v <= 0; a u that is not negative only touches the cut."""
    u, v = operands
    plain = corners(b, lambda *ends: b.make("atan2", *ends), u, v, error=ELEMENTARY)
    if u.nonnegative:
        return plain
    zero, spread = b.const(0), b.sub(plain.upper, plain.lower)
    # A little above pi; NaN where an end of u or v is, which must not look like the cut.
    turn = b.select(b.abs(spread), b.const(-1), b.const(Fraction(22, 7)), b.undefined())

    def unless_cut(end: int, extreme: int) -> int:
        right = b.select(v.lower, zero, end, extreme)
        return b.select(u.lower, zero, end, b.select(zero, u.upper, end, right))

    return Interval(unless_cut(plain.lower, b.neg(turn)), unless_cut(plain.upper, turn))


def chosen(b: Builder, operands: Sequence[Interval], decisive: bool) -> Interval:
    """`yes` where a > b, `no` where not, both where that is open.

    `decisive`: no value at all comes of an undefined a or b, so a > b over the box leaves `yes` alone;
    otherwise an undefined a or b gives `no`.
    """
    first, second, yes, no = operands
    both = hull(b, yes, no)
    reach = b.sub(first.upper, second.lower)  # not above 0: never a > b

    def end(sure: int, refused: int, either: int) -> int:
        known = b.select(b.abs(reach), b.const(-1), refused, either)
        maybe = b.select(reach, b.const(0), either, known)
        return b.select(first.lower, second.upper, sure, maybe) if decisive else maybe

    return Interval(end(yes.lower, no.lower, both.lower), end(yes.upper, no.upper, both.upper))


def _zero_with(b: Builder, node: Node, operands: Sequence[Interval]) -> Interval:
    """The image of g, with 0 where f may be."""
    f, g = operands
    zero = b.const(0)
    both = hull(b, g, Interval(zero, zero))

    def end(own: int, wider: int) -> int:
        return b.select(f.lower, zero, own, b.select(zero, f.upper, own, wider))

    return Interval(end(g.lower, both.lower), end(g.upper, both.upper))


def _gap_share(b: Builder, node: Node, operands: Sequence[Interval]) -> Interval:
    """Half the versine of (t, s)."""
    return scaled(b, HALF, versine(b, node, operands[::-1]))


class IntervalImages(dict[str, Rule]):
    """By operation, or by the name of a relation; what is monotone is left to its row."""

    def __missing__(self, name: str) -> Rule:
        if not OPERATIONS[name].grows:
            raise KeyError(name)
        return partial(monotone, name)


IMAGES = IntervalImages(
    {
        "const": lambda b, node, operands: constant(b, node.data),
        "undefined": lambda b, node, operands: nothing(b),
        "add": lambda b, node, operands: total(b, *operands),
        "mul": lambda b, node, operands: product(b, *operands),
        "div": lambda b, node, operands: quotient(b, *operands),
        "neg": lambda b, node, operands: negative(b, *operands),
        "powi": _powi,
        "pow": _pow,
        "sqrt": lambda b, node, operands: root(b, *operands),
        "abs": lambda b, node, operands: sizes(b, *operands),
        "sin": _wave("sin"),
        "cos": _wave("cos"),
        "log": _log,
        "atan2": _atan2,
        "zero_with": _zero_with,
        **ROOT_IMAGES,
        **SYSTEM_IMAGES,
        # Products and quotients of related operands.
        "square": lambda b, node, operands: square(b, *operands),
        "direction": partial(monotone, "sign"),
        "share": lambda b, node, operands: cosine(b, *operands),
        "norm_share": norm_share,
        "gap_share": _gap_share,
    }
)
