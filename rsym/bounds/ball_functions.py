"""Balls for powers and the transcendental functions: exact images from values at the ends of the intervals."""

from __future__ import annotations

from rsym.bounds.ball_arithmetic import NARROW, ONE, UNIT, WHOLE, ZERO, arb, ball, either, quotient


def whole_power(a: arb, exponent: int) -> arb | None:
    """The exact image of a**exponent for an integer exponent."""
    if exponent <= 0:
        below = whole_power(a, -exponent) if exponent else ONE
        return below if exponent == 0 or below is None else quotient(ONE, below)
    if exponent % 2:
        return ball(a.lower() ** exponent, a.upper() ** exponent)
    return ball(a.abs_lower() ** exponent, a.abs_upper() ** exponent)


def power(a: arb, exponent: arb) -> arb | None:
    """The image of a**exponent: for negative a only integers among the exponents count, and 0**0 is 1."""
    if a >= ZERO:
        return power_of_size(a, exponent)
    positive = None if a < ZERO else power_of_size(ball(ZERO, a.upper()), exponent)
    if not exponent.contains_integer():
        return positive
    mirrored = power_of_size(-a if a < ZERO else ball(ZERO, (-a).upper()), exponent)
    integer = exponent.unique_fmpz() if exponent.is_exact() else None
    if integer is not None:
        return either(positive, mirrored if int(integer) % 2 == 0 else -mirrored)
    return either(positive, either(mirrored, -mirrored))


def power_of_size(a: arb, exponent: arb) -> arb:
    """The exact image of |a|**exponent.

    exponent*log|a| is linear in either variable, so the extremes lie at the corners of the box.
    """
    low, high = a.abs_lower(), a.abs_upper()
    if exponent.is_exact():
        return (
            ball(_power_at(low, exponent), _power_at(high, exponent))
            if exponent >= ZERO
            else ball(_power_at(high, exponent), _power_at(low, exponent))
        )
    corners = [_power_at(base, end) for base in (low, high) for end in (exponent.lower(), exponent.upper())]
    return hull(corners)


def hull(corners: list[arb]) -> arb:
    """The ball around several balls; it reaches beyond 0 only if one of them does."""
    low, high = corners[0], corners[0]
    for corner in corners[1:]:
        low, high = low.min(corner), high.max(corner)
    return ball(low, high)


def _power_at(base: arb, exponent: arb) -> arb:
    """base**exponent of points, base >= 0; infinite where a negative power of 0 is asked for."""
    if not base.is_zero():
        return base**exponent
    if exponent > ZERO:
        return ZERO
    return ONE if exponent.is_zero() else WHOLE


def signed_power(a: arb, exponent: arb) -> arb | None:
    """The image of sign(a)*|a|**exponent: odd in a, at a = 0 the limit 0 for positive exponents, else undefined."""
    if a >= ZERO or a <= ZERO:
        if a.is_zero():
            return ZERO if exponent.upper() > ZERO else None
        return power_of_size(a, exponent) if a >= ZERO else -power_of_size(a, exponent)
    return ball(-power_of_size(ball(ZERO, (-a).upper()), exponent), power_of_size(ball(ZERO, a.upper()), exponent))


def exponential(a: arb) -> arb:
    """The exact image of exp(a)."""
    plain = a.exp()
    return plain if plain.rel_accuracy_bits() >= NARROW else ball(a.lower().exp(), a.upper().exp())


def logarithm(a: arb) -> arb | None:
    """The exact image of log(a); the whole line where a straddles or touches 0, nothing where it is negative."""
    if a > ZERO:
        return ball(a.lower().log(), a.upper().log())
    return None if a < ZERO else WHOLE


def sine(a: arb) -> arb:
    """The exact image of sin(a); the extremes in between are at pi/2 + k*pi, k integer."""
    turns = a / arb.pi() - ONE / 2
    return _wave(turns, a.lower().sin(), a.upper().sin())


def cosine(a: arb) -> arb:
    """The exact image of cos(a); the extremes in between are at k*pi, k integer."""
    return _wave(a / arb.pi(), a.lower().cos(), a.upper().cos())


def _wave(turns: arb, first: arb, last: arb) -> arb:
    """The range of a wave with the extreme (-1)**k at every integer k of `turns` and these values at the ends."""
    if not turns.contains_integer():
        return ball(first.min(last), first.max(last))
    extreme = turns.unique_fmpz()
    if extreme is None:
        return UNIT
    peak = ONE if int(extreme) % 2 == 0 else -ONE
    return ball(first.min(last).min(peak), first.max(last).max(peak))


def angle(a: arb, b: arb) -> arb:
    """The exact image of atan2(a, b); [-pi, pi] where the box meets the cut a = 0, b <= 0.

    Elsewhere the box is convex and within a half-plane of the origin or clear of the cut: the polar angle has
    its extremes at corners. On the cut both +pi and -pi count, for the sign of 0 decides.
    """
    if a.contains(ZERO) and not b > ZERO:
        turn = arb.pi()
        return ball(-turn, turn)
    if not (a.is_finite() and b.is_finite()):
        turn = arb.pi()
        return ball(-turn, turn)
    return hull([arb.atan2(y, x) for y in (a.lower(), a.upper()) for x in (b.lower(), b.upper())])
