"""Balls for real arithmetic, powers and functions: exact images of intervals, held by python-flint's `arb`.

A ball is a midpoint and a radius of 30 bits, so an interval is kept to 2**-30 of its width. The images here
are the exact ranges up to that and to the working precision `flint.ctx.prec`, which the caller sets. Of an
interval that touches 0 the ball ends exactly at 0; one that ends nearer to 0 than 2**-30 of its width is
widened to 0, never beyond it. What is unbounded or unknown is the whole line; NaN never leaves `enclose_nodes`.
"""

from __future__ import annotations

from fractions import Fraction

from rsym.errors import RsymError
from rsym.program.program import Data

try:
    from flint import arb, ctx, fmpq
except ImportError as error:
    raise RsymError(
        "proofs need the package python-flint, which cannot be imported",
        code="missing-package",
        remedy="pip install python-flint",
    ) from error

__all__ = ["arb", "ctx"]

ZERO, ONE, TWO = arb(0), arb(1), arb(2)
WHOLE = arb(0, float("inf"))
UNIT = arb(0, 1)  # [-1, 1]
# Midpoint-radius arithmetic is wider than the exact image by about the relative radius of its operands; below
# 2**-12 that is less than what the radius is worth, and it is ten times as fast as arithmetic on the ends.
NARROW = 12


def exact(value: Fraction) -> arb:
    """The ball of a rational number: a point where the working precision can hold it.

    Examples
    --------
    >>> exact(Fraction(1, 4)).is_exact(), exact(Fraction(1, 3)).is_exact()
    (True, False)
    """
    return arb(fmpq(value.numerator, value.denominator))


def constant(data: Data) -> arb:
    """The ball of a constant of a program: a fraction, pi or e."""
    if isinstance(data, Fraction):
        return exact(data)
    return {"pi": arb.pi, "e": arb.const_e}[str(data)]()


def ball(low: arb, high: arb) -> arb:
    """The ball around two balls; it reaches beyond 0 only if one of them does.

    Examples
    --------
    >>> hull = ball(arb(0), arb(0.7))
    >>> hull.contains(arb(0.7)), hull >= 0
    (True, True)
    """
    hull = low.union(high)
    if hull >= ZERO or hull <= ZERO:
        return hull
    if not hull.is_finite():
        return WHOLE
    if low >= ZERO and high >= ZERO:
        return hull.nonnegative_part()
    if low <= ZERO and high <= ZERO:
        return -((-hull).nonnegative_part())
    return hull


def product(a: arb, b: arb) -> arb:
    """The exact image of a*b for operands that vary independently.

    Examples
    --------
    >>> product(arb(1, 0.5), arb(1, 0.5)) > 0.24, arb(1, 0.5) * arb(1, 0.5) > 0
    (True, False)
    """
    plain = a * b
    if plain.rel_accuracy_bits() >= NARROW or a.is_exact() or b.is_exact():
        return plain
    if a >= ZERO:
        return _scaled(a, b)
    if a <= ZERO:
        return -_scaled(-a, b)
    if b >= ZERO:
        return _scaled(b, a)
    if b <= ZERO:
        return -_scaled(-b, a)
    low_a, high_a, low_b, high_b = a.lower(), a.upper(), b.lower(), b.upper()
    return ball((low_a * high_b).min(high_a * low_b), (low_a * low_b).max(high_a * high_b))


def _scaled(a: arb, b: arb) -> arb:
    """The image of a*b for a >= 0."""
    if b >= ZERO:
        return ball(a.lower() * b.lower(), a.upper() * b.upper())
    high = a.upper()
    return ball(high * b.lower(), (a.lower() if b <= ZERO else high) * b.upper())


def quotient(a: arb, b: arb) -> arb | None:
    """The exact image of a/b; the whole line where b contains 0, nothing where both are 0."""
    if b > ZERO:
        plain = a / b
        return plain if plain.rel_accuracy_bits() >= NARROW else _quotient(a, b)
    if b < ZERO:
        return quotient(-a, -b)
    if a.is_zero():
        return None if b.is_zero() else ZERO
    return WHOLE


def _quotient(a: arb, b: arb) -> arb:
    """The image of a/b for b > 0."""
    low, high = b.lower(), b.upper()
    return ball(a.lower() / (high if a >= ZERO else low), a.upper() / (high if a <= ZERO else low))


def square(a: arb) -> arb:
    """The exact image of a**2, never below 0.

    Examples
    --------
    >>> square(arb(0, 0.1)) >= 0, (arb(0, 0.1) ** 2).is_nan()
    (True, True)
    """
    plain = a * a
    if plain.rel_accuracy_bits() >= NARROW:
        return plain
    low, high = a.abs_lower(), a.abs_upper()
    return ball(low * low, high * high)


def root(a: arb) -> arb | None:
    """The exact image of sqrt(a): from 0 on where a straddles 0, nothing where a is negative.

    Examples
    --------
    >>> root(arb(-2, 1)) is None, root(arb(1, 3)).contains(arb(2)), root(arb(1, 3)) >= 0
    (True, True, True)
    """
    if a > ZERO:
        plain = a.sqrt()
        return plain if plain.rel_accuracy_bits() >= NARROW else ball(a.lower().sqrt(), a.upper().sqrt())
    high = a.upper()
    return None if high < ZERO else ball(ZERO, high.sqrt())


def hypotenuse(a: arb, b: arb) -> arb:
    """The exact image of sqrt(a**2 + b**2).

    Examples
    --------
    >>> hypotenuse(arb(3), arb(4)).contains(arb(5)), hypotenuse(arb(0, 1), arb(0, 1)) >= 0
    (True, True)
    """
    low_a, high_a, low_b, high_b = a.abs_lower(), a.abs_upper(), b.abs_lower(), b.abs_upper()
    low = (low_a * low_a + low_b * low_b).sqrt()
    return ball(low, (high_a * high_a + high_b * high_b).sqrt())


def size(a: arb) -> arb:
    """The exact image of |a|."""
    if a >= ZERO:
        return a
    return -a if a <= ZERO else ball(ZERO, a.abs_upper())


def sign(a: arb) -> arb:
    """The exact image of the sign; the sign of 0 is 0."""
    if a > ZERO:
        return ONE
    if a < ZERO:
        return -ONE
    if a >= ZERO:
        return ZERO if a.is_zero() else ball(ZERO, ONE)
    return ball(-ONE, ZERO) if a <= ZERO else UNIT


def direction(a: arb) -> arb | None:
    """The exact image of a/|a|: like the sign, but nowhere 0."""
    if a >= ZERO:
        return None if a.is_zero() else ONE
    return -ONE if a <= ZERO else UNIT


def smaller(a: arb, b: arb) -> arb:
    """The exact image of min(a, b)."""
    return a.min(b)


def larger(a: arb, b: arb) -> arb:
    """The exact image of max(a, b)."""
    return a.max(b)


def chosen(a: arb | None, b: arb | None, yes: arb | None, no: arb | None) -> arb | None:
    """`yes` where a > b, elsewhere `no`, both where a box has points of either kind.

    A comparison with something undefined is false. Where a and b are undefined at some points of the box only,
    a decided comparison decides for the others alone: `enclose_nodes` adds the value `no`.
    """
    if a is None or b is None or a <= b:
        return no
    return yes if a > b else either(yes, no)


def either(a: arb | None, b: arb | None) -> arb | None:
    """The ball around those of two balls that exist."""
    if a is None or b is None:
        return b if a is None else a
    return ball(a, b)


def degrees(sine: arb, cosine: arb) -> arb:
    """The angle in degrees, given multiples of its sine and cosine.

    Examples
    --------
    >>> degrees(arb(1), arb(-1)).contains(arb(135)), degrees(arb(0, 1), arb(-1)).is_finite()
    (True, True)
    """
    # A ball across the negative axis has all angles.
    angle = arb.pi() - arb.atan2(sine, -cosine) if cosine < 0 else arb.atan2(sine, cosine)
    return angle * 180 / arb.pi()


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
