"""Images over boxes of the systems with a parameter, of equivalence and joining; the parameter an interval too.

n = (|f|**p + |g|**p)**(1/p) falls as p grows: its logarithm has the derivative -(entropy of the two shares)/p**2.

* R_alpha and R_p grow with f and g: 1 -+ (f - alpha g)/r, r >= |f - alpha g|, and 1 -+ (|f|/n)**(p - 1) are >= 0.
  A conjunction grows with its parameter. R_p: n falls. R_alpha: it is 2 f g/(f + g + r), and r**2 = f**2 + g**2
  - 2 alpha f g falls where f g > 0 and grows where f g < 0; where f + g + r = 0 both are negative, and
  (f + g - r)/(1 + alpha) becomes shorter. A disjunction is -conjunction(-f, -g): it falls with its parameter.
* R_0**m, its derivatives and monomials of f, g, r are products of the images of their parts.
* 1 - sign(f) (|f|/n)**(p - 1) falls with f, and moves away from 1 as |g| falls; as p grows the share |f|/n grows,
  and its power falls with the exponent: each takes the end of p that bounds.
* joining |f||g|/n grows with |f|, |g| and the order; equivalence, joining with signs, is monotone in each alone.

R_alpha and R_p add numbers of both signs, so their error is a share of |f| + |g|, for R_alpha over 1 + alpha:
(f + g - r)/(1 + alpha) loses that, and 2 f g/(f + g + r), being as large, no more. POWERS covers some sixty units in
the last place, the powers, logarithms and roots in them count for at most twenty.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from functools import partial

from rsym.bounds.interval_arithmetic import (
    Interval,
    clipped,
    constant,
    corners,
    nonnegative,
    outward,
    product,
    size_power,
    sizes,
    total,
    whole_power,
)
from rsym.bounds.interval_monotone import POWERS, between, monotone
from rsym.bounds.interval_roots import Rule, cosine, guard, radius, versine, where_in_range
from rsym.program.builder import Builder
from rsym.program.powers import power
from rsym.program.program import Node

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
