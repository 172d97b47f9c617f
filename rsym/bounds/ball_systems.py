"""Balls for R_0, trimming and normalisation: the exact image of each operation as a whole.

Every operation here is monotone in each argument, or in its size, so its range over a box is spanned by two
corners. The values at corners are those of points, in forms that keep the sign where a sum would cancel.
At infinite corners, those of the whole line, they are limits or NaN, which stands for the whole line too.
"""

from __future__ import annotations

from rsym.bounds.ball_arithmetic import ONE, TWO, UNIT, WHOLE, ZERO, arb, ball, square

FROM_0_TO_2 = ball(ZERO, TWO)


def r0_conjunction(f: arb, g: arb) -> arb:
    """The image of f + g - sqrt(f**2 + g**2): increasing in f and g, for |f| and |g| are at most the root."""
    return ball(_r0_at(f.lower(), g.lower()), _r0_at(f.upper(), g.upper()))


def _r0_at(f: arb, g: arb) -> arb:
    """At a point; 2 f g/(f + g + r) does not cancel where f + g > 0."""
    total, radius = f + g, (f * f + g * g).sqrt()
    return TWO * f * g / (total + radius) if total > ZERO else total - radius


def r0_disjunction(f: arb, g: arb) -> arb:
    """The image of f + g + sqrt(f**2 + g**2), the dual of the conjunction."""
    return -r0_conjunction(-f, -g)


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


def gap(s: arb, t: arb) -> arb:
    """(sqrt(t**2 + s**2) - t)/2: increasing in |s|, decreasing in t."""
    return ball(_gap_at(s.abs_lower(), t.upper()), _gap_at(s.abs_upper(), t.lower()))


def _gap_at(s: arb, t: arb) -> arb:
    radius = (t * t + s * s).sqrt()
    return s * s / (TWO * (radius + t)) if t > ZERO else (radius - t) / TWO


def trimming(s: arb, t: arb) -> arb:
    """sqrt(s + gap(s, t)**2) for s >= 0, the square of a function: increasing in s, decreasing in t, as the gap is."""
    if s < ZERO:
        return WHOLE
    return ball(_trimming_at(s.lower().max(ZERO), t.upper()), _trimming_at(s.upper(), t.lower()))


def _trimming_at(s: arb, t: arb) -> arb:
    excess = _gap_at(s, t)
    return (s + excess * excess).sqrt()


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
