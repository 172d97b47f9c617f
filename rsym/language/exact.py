"""Exact rational numbers of bounded size: a hostile literal or tower is refused before it is computed.

Magnitudes stay within what float64 can hold with room to spare.
"""

from __future__ import annotations

from fractions import Fraction

import sympy as sp

from rsym.language.syntax import Position
from rsym.model.symbols import postorder

ONE = Fraction(1)
LARGEST = Fraction(10) ** 300
MOST_BITS = 4096  # of a numerator or a denominator; about 1200 decimal digits
LONGEST_LITERAL = 100  # characters


def literal(text: str, place: Position) -> Fraction:
    """The exact value of a decimal such as 1, 1., .5 or 2.5e-3.

    Examples
    --------
    >>> literal("2.5e-3", Position(1, 1))
    Fraction(1, 400)
    """
    if len(text) > LONGEST_LITERAL:
        raise place.refuse(
            f"a number of {len(text)} characters; {LONGEST_LITERAL} are the most",
            "number-too-large",
            "shorten it: float64 keeps 17 digits",
        )
    mantissa, _, exponent = text.lower().partition("e")
    value, power = Fraction(mantissa + ("0" if mantissa.endswith(".") else "")), int(exponent or 0)
    if value == 0:
        return value
    if abs(power) <= 500:
        return checked(value * Fraction(10) ** power, place, text)
    raise _too_large(place, text) if power > 0 else _too_small(place, text)


def checked(value: Fraction, place: Position, text: str = "this constant") -> Fraction:
    """The value, if it is of a size that computing can handle."""
    if abs(value) > LARGEST:
        raise _too_large(place, text)
    if value and abs(value) * LARGEST < 1:
        raise _too_small(place, text)
    if _bits(value) > MOST_BITS:
        raise place.refuse(
            f"the exact value of {text} has more than {MOST_BITS} bits",
            "number-too-large",
            "use fewer digits, or simpler fractions",
        )
    return value


def check_numbers(expression: sp.Expr, place: Position) -> None:
    """Refuse a formula with a number in it that would not have been accepted as a constant."""
    for part in postorder(expression):
        if isinstance(part, sp.Rational):
            checked(Fraction(int(part.p), int(part.q)), place, "a number in this formula")


def power(base: Fraction, exponent: int, place: Position) -> Fraction:
    """base**exponent, refused before it is computed if it would be too long."""
    if base == 0 and exponent < 0:
        raise division_by_zero(place)
    if abs(base) in (0, 1):
        return base if exponent % 2 else base * base if exponent else Fraction(1)
    if _bits(base) * abs(exponent) > 2 * MOST_BITS:
        grows = (abs(base) > 1) == (exponent > 0)
        raise _too_large(place, "this power") if grows else _too_small(place, "this power")
    return checked(base**exponent, place, "this power")


def division_by_zero(place: Position) -> Exception:
    """The error for a divisor that is the constant zero."""
    return place.refuse("division by zero", "division-by-zero", "the divisor is the constant 0; correct the formula")


def _bits(value: Fraction) -> int:
    return max(value.numerator.bit_length(), value.denominator.bit_length())


def _too_large(place: Position, text: str) -> Exception:
    return place.refuse(f"{text} is too large", "number-too-large", "numbers up to 1e300 are accepted; change the unit")


def _too_small(place: Position, text: str) -> Exception:
    return place.refuse(
        f"{text} is too small", "number-too-small", "numbers from 1e-300 on are accepted; change the unit, or write 0"
    )
