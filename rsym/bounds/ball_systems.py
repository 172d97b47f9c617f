"""Balls of monotone operations, of R_0, trimming and normalisation: the exact image of each operation as a whole.

Every operation here is monotone in each argument, or in its size, so its range over a box is spanned by two
corners. The values at corners are those of points, in forms that keep the sign where a sum would cancel.
At infinite corners, those of the whole line, they are limits or NaN, which stands for the whole line too.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from rsym.bounds.ball_arithmetic import ONE, TWO, UNIT, ZERO, arb, ball, square
from rsym.program.row import DOWN, UP_IN_SIZE, Admissible, Operation

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
