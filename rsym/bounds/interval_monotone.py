"""Images over boxes of what is monotone, by the rows of the table: the values at two corners, moved outwards.

The ends are computed by the operations themselves, so what rounding costs is said for each kind of value:

* "none": the ends are values of the operation, exact.
* "elementary": a function that is right to units in the last place.
* "powers": some sixty units in the last place; powers, logarithms and roots in them count for at most twenty.
* "root": stable forms with one square root add, multiply and divide numbers of one sign only: at most eight roundings,
  STABLE leaves thirty. Where squares leave the range of float64 that is not so: below 1e-160 a root is wrong by as
  much, which ROOT_TINY adds, and quotients are unknown there; above 1e154 it is infinite, and so is the radicand times
  2**-960 in the margin: the end says nothing. Only the minimum that stands for a conjunction there needs no such margin
  above, nor the maximum for a disjunction below: they bound them.
* "sum": numbers of both signs are added, so the error is a share of |f| + |g|; of "sum over 1 + parameter" that over
  1 + alpha: (f + g - r)/(1 + alpha) loses that, and 2 f g/(f + g + r), being as large, no more.

Monotone by their partial derivatives, r = sqrt(f**2 + g**2) and n = (|f|**p + |g|**p)**(1/p), are:

* R_0: 1 -+ f/r >= 0, so it grows with f and g.
* versine 1 - f/r falls with f, and moves away from 1 as |g| falls.
* gap (sqrt(t**2 + s**2) - t)/2 falls with t and grows with |s|; trimming sqrt(s + gap**2) too, for s >= 0.
* normalised f/sqrt(f**2 + q) grows with f, and goes towards 0 as q grows.
* R_alpha and R_p grow with f and g: 1 -+ (f - alpha g)/r, r >= |f - alpha g|, and 1 -+ (|f|/n)**(p - 1) are >= 0.
  A conjunction grows with its parameter. R_p: n falls as p grows, for its logarithm has the derivative -(entropy of
  the two shares)/p**2. R_alpha: it is 2 f g/(f + g + r), and r**2 = f**2 + g**2 - 2 alpha f g falls where f g > 0 and
  grows where f g < 0; where f + g + r = 0 both are negative, and (f + g - r)/(1 + alpha) becomes shorter. A
  disjunction is -conjunction(-f, -g): it falls with its parameter.
* R_0**m, its derivatives and monomials of f, g, r are products of the images of their parts.
* 1 - sign(f) (|f|/n)**(p - 1) falls with f, and moves away from 1 as |g| falls; as p grows the share |f|/n grows,
  and its power falls with the exponent: each takes the end of p that bounds.
* joining |f||g|/n grows with |f|, |g| and the order; equivalence, joining with signs, is monotone in each alone.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from functools import partial
from typing import TypeAlias

from rsym.bounds.interval_arithmetic import (
    ELEMENTARY,
    Interval,
    clipped,
    constant,
    corners,
    greatest,
    least,
    margin,
    nonnegative,
    only_nonnegative,
    outward,
    product,
    root,
    size_power,
    sizes,
    square,
    total,
    whole_power,
)
from rsym.program.builder import Builder
from rsym.program.operations import OPERATIONS
from rsym.program.powers import power
from rsym.program.program import Node
from rsym.program.row import DOWN, UP_IN_SIZE, Admissible

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


_r0_conjunction = partial(monotone, "r0_conjunction")
_r0_disjunction = partial(monotone, "r0_disjunction")


def _r0m(plain: Rule) -> Rule:
    def rule(b: Builder, node: Node, operands: Sequence[Interval]) -> Interval:
        f, g, m = operands
        return product(b, plain(b, node, operands[:2]), size_power(b, radius(b, f, g), between(b, m, 1)))

    return rule


def _r0m_partial(b: Builder, node: Node, operands: Sequence[Interval]) -> Interval:
    """(1 - f/r) r**m + m (f/r) (f + g - r) r**(m - 1)."""
    f, g, order = operands
    m, size = between(b, order, 1), radius(b, f, g)
    first = product(b, versine(b, node, operands), size_power(b, size, m))
    second = product(b, _r0_conjunction(b, node, operands[:2]), size_power(b, size, _shifted(b, m, -1)))
    return total(b, first, product(b, m, product(b, cosine(b, f, g), second)))


def _shifted(b: Builder, u: Interval, number: int) -> Interval:
    """The sum of u and a number, a constant again for a constant."""
    value = b.value(u.lower)
    if u.lower == u.upper and value is not None:
        return constant(b, value + number)
    return total(b, u, constant(b, Fraction(number)))


def _monomial(b: Builder, node: Node, operands: Sequence[Interval]) -> Interval:
    """(f/r)**a (g/r)**b r**(m + a + b + c)."""
    assert isinstance(node.data, tuple)
    (f, g, m), (first, second, _) = operands, node.data
    angular = product(b, whole_power(b, cosine(b, f, g), first), whole_power(b, cosine(b, g, f), second))
    return product(b, angular, size_power(b, radius(b, f, g), _shifted(b, m, sum(node.data))))


def _norm(b: Builder, node: Node, operands: Sequence[Interval]) -> Interval:
    """Only for p > 1/4: towards 0 the error grows like 1/p."""
    f, g, p = sizes(b, operands[0]), sizes(b, operands[1]), operands[2]
    p = p.each(lambda end: b.select(p.lower, b.const(Fraction(1, 4)), end, b.undefined()))
    ends = Interval(b.make("norm", f.lower, g.lower, p.upper), b.make("norm", f.upper, g.upper, p.lower))
    return nonnegative(b, outward(b, ends, POWERS))


def _rp_versine(b: Builder, node: Node, operands: Sequence[Interval]) -> Interval:
    """1 - sign(f) share**(p - 1), share = |f|/n; its error is that of the share, p - 1 times."""
    f, g, p = operands[0], sizes(b, operands[1]), between(b, operands[2], 1)
    one, error = b.const(1), b.mul(b.const(POWERS), b.add(b.const(1), p.upper))
    less = p.each(lambda end: b.sub(end, one))
    longest, n = _signed_share(b, f.upper, (f.upper, b.const(0)), g, p, less)
    lower = b.sub(b.sub(one, longest), b.add(error, guard(b, n)))
    shortest, n = _signed_share(b, f.lower, (b.const(0), f.lower), g, p, less)
    upper = b.add(b.sub(one, shortest), b.add(error, guard(b, n)))
    return clipped(b, Interval(lower, upper, True), 0, 2)


def norm_share(b: Builder, node: Node, operands: Sequence[Interval]) -> Interval:
    """f/n, within [-1, 1]."""
    f, g, p = operands[0], sizes(b, operands[1]), between(b, operands[2], 1)
    error, exponent = b.const(POWERS), constant(b, Fraction(1))
    shortest, n = _signed_share(b, f.lower, (b.const(0), f.lower), g, p, exponent)
    lower = b.sub(shortest, b.add(error, guard(b, n)))
    longest, n = _signed_share(b, f.upper, (f.upper, b.const(0)), g, p, exponent)
    return clipped(b, Interval(lower, b.add(longest, b.add(error, guard(b, n)))), -1, 1)


def _signed_share(
    b: Builder, f: int, long: tuple[int, int], g: Interval, p: Interval, exponent: Interval
) -> tuple[int, int]:
    """sign(f) (|f|/n)**exponent and n: at its longest where the first of `long` is larger, else at its shortest."""

    def pick(yes: int, no: int) -> int:
        return b.select(*long, yes, no)

    n = b.make("norm", f, pick(g.lower, g.upper), pick(p.upper, p.lower))
    raised = power(b, b.make("div", b.abs(f), n), pick(exponent.lower, exponent.upper))
    share = where_in_range(b, raised, n)
    return b.select(f, b.const(0), share, b.neg(share)), n


def _equivalence(b: Builder, node: Node, operands: Sequence[Interval]) -> Interval:
    f, g, m = operands
    return corners(b, lambda *ends: b.make("equivalence", *ends), f, g, between(b, m, 1), error=POWERS)


def _absolute_power(b: Builder, node: Node, operands: Sequence[Interval]) -> Interval:
    return size_power(b, sizes(b, operands[0]), operands[1])


def _signed_power(b: Builder, node: Node, operands: Sequence[Interval]) -> Interval:
    """sign(u)|u|**a: monotone in each alone, but for a pole or a jump at u = 0 where a <= 0."""
    u, a = operands
    plain = corners(b, lambda *ends: b.make("signed_power", *ends), u, a, error=POWERS)
    zero, unknown = b.const(0), b.undefined()
    one_sided = b.select(u.lower, zero, zero, b.select(zero, u.upper, zero, unknown))
    shift = b.select(a.lower, zero, zero, one_sided)
    return plain.each(lambda end: b.add(end, shift))


SYSTEM_IMAGES: dict[str, Rule] = {
    "r0m_conjunction": _r0m(_r0_conjunction),
    "r0m_disjunction": _r0m(_r0_disjunction),
    "r0m_partial": _r0m_partial,
    "monomial": _monomial,
    "norm": _norm,
    "rp_versine": _rp_versine,
    "equivalence": _equivalence,
    "absolute_power": _absolute_power,
    "signed_power": _signed_power,
}
