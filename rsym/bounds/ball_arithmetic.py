"""Balls for real arithmetic: exact images of the elementary operations on intervals, held by python-flint's `arb`.

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
