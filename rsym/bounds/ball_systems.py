"""Balls of monotone operations, R-operations first: the exact image of each as a whole.

Every operation here is monotone in each argument, or in its size, so its range over a box is spanned by two
corners. The values at corners are those of points, in forms that keep the sign where a sum would cancel.
At infinite corners, those of the whole line, they are limits or NaN, which stands for the whole line too.

Systems with a parameter, equivalence and joining are monotone so for every admissible parameter; a corner evaluated
with the whole ball of the parameter bounds all values, and where the operation is monotone in the parameter too its
end is taken. Where the whole ball of a parameter is inadmissible the operation is undefined; where it straddles
the edge of the admissible range, the closure of that range counts.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from rsym.bounds.ball_arithmetic import (
    ONE,
    TWO,
    UNIT,
    WHOLE,
    ZERO,
    arb,
    ball,
    hull,
    hypotenuse,
    power_of_size,
    product,
    square,
    whole_power,
)
from rsym.program.operations import OPERATIONS
from rsym.program.row import DOWN, UP_IN_SIZE, Admissible, Operation
from rsym.program.rp import stretch

FROM_0_TO_2 = ball(ZERO, TWO)


def monotone(row: Operation) -> Callable[..., Any]:
    """The image of an operation by its row: its values at the two corners that span the range.

    Where the whole ball of a parameter is inadmissible there is none; where it straddles the edge of the admissible
    range, the closure of that range counts. What must not be negative counts from 0 on.
    """
    at, ways, legal = row.at, row.grows, row.parameter
    assert at is not None
    ends = [(arb.lower, arb.upper) if way != UP_IN_SIZE else (arb.abs_lower, arb.abs_upper) for way in ways]
    lows = [pair[way == DOWN] for pair, way in zip(ends, ways, strict=True)]
    highs = [pair[way != DOWN] for pair, way in zip(ends, ways, strict=True)]
    floored = [place for clause in row.domain for kind, place in clause if kind == "nonnegative"]

    def image(*operands: arb) -> arb:
        return ball(
            at(*[end(operand) for end, operand in zip(lows, operands, strict=True)]),
            at(*[end(operand) for end, operand in zip(highs, operands, strict=True)]),
        )

    def restricted(*operands: arb) -> arb | None:
        low = [end(operand) for end, operand in zip(lows, operands, strict=True)]
        high = [end(operand) for end, operand in zip(highs, operands, strict=True)]
        for place in floored:
            low[place] = low[place].max(ZERO)
        if legal is not None:
            if legal.excludes(operands[-1]):
                return None
            low[-1], high[-1] = (_clipped(end, legal) for end in (low[-1], high[-1]))
        return ball(at(*low), at(*high))

    return restricted if floored or legal is not None else image


def _clipped(end: arb, legal: Admissible) -> arb:
    raised = end.max(arb(legal.low))
    return raised if legal.high is None else raised.min(arb(legal.high))


def versine(f: arb, g: arb) -> arb | None:
    """1 - f/sqrt(f**2 + g**2): decreasing in f; increasing in |g| for f > 0, decreasing for f < 0."""
    if f.is_zero() and g.is_zero():
        return None
    near, far = g.abs_lower(), g.abs_upper()
    low, high = f.lower(), f.upper()
    value = ball(_versine_at(high, near if high > ZERO else far), _versine_at(low, near if low < ZERO else far))
    return value if value.is_finite() else FROM_0_TO_2


def _versine_at(f: arb, g: arb) -> arb:
    """At a point with g >= 0; NaN at f = g = 0."""
    radius = (f * f + g * g).sqrt()
    if f > ZERO:
        return g * g / (radius * (radius + f))
    return ONE - f / radius


def share(f: arb, g: arb) -> arb | None:
    """f/sqrt(f**2 + g**2), the cosine of the polar angle of (f, g)."""
    return normalised(f, square(g))


def gap_share(s: arb, t: arb) -> arb | None:
    """The gap over sqrt(t**2 + s**2): half the versine of (t, s)."""
    value = versine(t, s)
    return None if value is None else value / TWO


def normalised(f: arb, q: arb) -> arb | None:
    """f/sqrt(f**2 + q) for q >= 0, a sum of squares: increasing in f, towards 0 as q grows."""
    if f.is_zero() and q.is_zero():
        return None
    near, far = q.lower().max(ZERO), q.upper()
    low, high = f.lower(), f.upper()
    value = ball(_normalised_at(low, near if low < ZERO else far), _normalised_at(high, near if high > ZERO else far))
    return value if value.is_finite() else UNIT


def zero_with(f: arb, g: arb) -> arb:
    """The value of g, and 0 where f is."""
    if f.is_zero():
        return ZERO
    return ball(g, ZERO) if f.contains(ZERO) else g


def _normalised_at(f: arb, q: arb) -> arb:
    return ZERO if f.is_zero() else f / (f * f + q).sqrt()


_r0_conjunction = monotone(OPERATIONS["r0_conjunction"])
_r0_disjunction = monotone(OPERATIONS["r0_disjunction"])


def _above(parameter: arb, low: arb) -> arb | None:
    """The part of a parameter from `low` on."""
    if parameter >= low:
        return parameter
    return None if parameter < low else ball(low, parameter.upper())


def _r0m(plain: Callable[..., arb]) -> Callable[[arb, arb, arb], arb | None]:
    """The image of the operation of R_0 times that of r**m; for m >= 1."""

    def image(f: arb, g: arb, m: arb) -> arb | None:
        order = _above(m, ONE)
        return None if order is None else product(plain(f, g), power_of_size(hypotenuse(f, g), order))

    return image


def r0m_partial(f: arb, g: arb, m: arb) -> arb | None:
    """(1 - f/r) r**m + m (f/r) (f + g - r) r**(m - 1), by the images of its parts; 0 at r = 0."""
    order = _above(m, ONE)
    if order is None:
        return None
    first, cosine = versine(f, g), share(f, g)
    if first is None or cosine is None:
        return ZERO
    radius = hypotenuse(f, g)
    second = product(product(cosine, _r0_conjunction(f, g)), power_of_size(radius, _less_one(order)))
    return product(first, power_of_size(radius, order)) + product(order, second)


def _less_one(order: arb) -> arb:
    """The order less 1, where it is at least 1: never below 0."""
    less = order - ONE
    return less if less >= ZERO else ball(ZERO, less.upper())


def monomial(f: arb, g: arb, m: arb, powers: tuple[int, int, int]) -> arb | None:
    """f**a g**b r**(m + c); where r has a negative exponent, (f/r)**a (g/r)**b r**(m + a + b + c)."""
    a, b, c = powers
    degree, rest = m + (a + b + c), m + c
    if f.is_zero() and g.is_zero():
        return ZERO if degree.upper() > ZERO else None
    plain = rest >= ZERO and a >= 0 and b >= 0
    first, second = (f, g) if plain else (share(f, g), share(g, f))
    if first is None or second is None:
        return WHOLE
    along_f, along_g = whole_power(first, a), whole_power(second, b)
    if along_f is None or along_g is None:
        return WHOLE
    return product(product(along_f, along_g), power_of_size(hypotenuse(f, g), rest if plain else degree))


def norm(f: arb, g: arb, p: arb) -> arb:
    """(|f|**p + |g|**p)**(1/p) for p > 0: increasing in |f| and |g|, decreasing in p."""
    if not p > ZERO:
        return WHOLE
    return ball(_norm_at(f.abs_lower(), g.abs_lower(), p.upper()), _norm_at(f.abs_upper(), g.abs_upper(), p.lower()))


def _norm_at(f: arb, g: arb, p: arb) -> arb:
    """At a point with f, g >= 0: M (1 + (m/M)**p)**(1/p), M the larger and m the smaller."""
    small, large = f.min(g), f.max(g)
    return large if small.is_zero() else large * stretch(small / large, p).exp()


def rp_versine(f: arb, g: arb, p: arb) -> arb | None:
    """1 - sign(f)(|f|/n)**(p - 1), n the norm, p > 1: decreasing in f; in |g| increasing for f > 0, else decreasing."""
    if p <= ONE or (f.is_zero() and g.is_zero()):
        return None
    degree = p if p >= ONE else ball(ONE, p.upper())
    near, far = g.abs_lower(), g.abs_upper()
    low, high = f.lower(), f.upper()
    value = ball(
        _rp_versine_at(high, near if high > ZERO else far, degree),
        _rp_versine_at(low, near if low < ZERO else far, degree),
    )
    return value if value.is_finite() else FROM_0_TO_2


def _rp_versine_at(f: arb, g: arb, p: arb) -> arb:
    """At a point with g >= 0; (|f|/n)**(p - 1) = exp(-(p - 1) log(n/|f|)), and for |f| < g by way of |f|/g."""
    if f.is_zero():
        return ONE
    if g.is_zero():
        return ZERO if f > ZERO else TWO
    ratio = g / abs(f)
    logarithm: arb = stretch(ratio, p) if ratio <= ONE else ratio.log() + stretch(ONE / ratio, p)
    less = -(_less_one(p) * logarithm)
    return -less.expm1() if f > ZERO else ONE + less.exp()


def joining(f: arb, g: arb, m: arb) -> arb | None:
    """|f||g|/(|f|**m + |g|**m)**(1/m) for m >= 1: increasing in |f|, |g| and m; the smaller bounds it."""
    order = _above(m, ONE)
    if order is None:
        return None
    low = _joining_at(f.abs_lower(), g.abs_lower(), order.lower())
    return ball(low, _joining_at(f.abs_upper(), g.abs_upper(), order.upper()))


def _joining_at(f: arb, g: arb, m: arb) -> arb:
    """At a point with f, g >= 0: the smaller over (1 + (m/M)**k)**(1/k)."""
    small, large = f.min(g), f.max(g)
    return ZERO if small.is_zero() else small * (-stretch(small / large, m)).exp()


def equivalence(f: arb, g: arb, m: arb) -> arb | None:
    """The image of f g/(|f|**m + |g|**m)**(1/m): the joining with the sign of f g, monotone in f and in g.

    Where neither operand changes sign it is the joining or its negative; else the extremes are at the corners,
    of either sign or 0, and largest at the largest m.
    """
    value = joining(f, g, m)
    if value is None or f.is_zero() or g.is_zero():
        return value
    if (f >= ZERO or f <= ZERO) and (g >= ZERO or g <= ZERO):
        return value if (f >= ZERO) == (g >= ZERO) else -value
    order = m.upper()
    return hull([_equivalence_at(u, v, order) for u in (f.lower(), f.upper()) for v in (g.lower(), g.upper())])


def _equivalence_at(f: arb, g: arb, m: arb) -> arb:
    value = _joining_at(abs(f), abs(g), m)
    return value if (f >= ZERO) == (g >= ZERO) else -value


def norm_share(f: arb, g: arb, p: arb) -> arb | None:
    """f/(|f|**p + |g|**p)**(1/p) for p > 0: increasing in f, towards 0 as |g| grows."""
    if f.is_zero() and g.is_zero():
        return None
    if not p > ZERO:
        return WHOLE
    near, far = g.abs_lower(), g.abs_upper()
    low, high = f.lower(), f.upper()
    value = ball(
        _norm_share_at(low, near if low < ZERO else far, p), _norm_share_at(high, near if high > ZERO else far, p)
    )
    return value if value.is_finite() else UNIT


def _norm_share_at(f: arb, g: arb, p: arb) -> arb:
    """At a point with g >= 0, p a ball."""
    if f.is_zero():
        return ZERO
    return f / _norm_at(abs(f), g, p)


r0m_conjunction = _r0m(_r0_conjunction)
r0m_disjunction = _r0m(_r0_disjunction)
