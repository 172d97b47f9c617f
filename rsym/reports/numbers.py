"""Numbers as text: the one place where they are printed, and bounds are rounded to the safe side."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from decimal import ROUND_CEILING, ROUND_FLOOR, Context, Decimal

# A double says nothing beyond so many digits, and an error below them is not worth a word.
DIGITS = 12
SHORT = 4  # digits where no error is known, or none matters
LEAST_SHARE = 0.001  # per cent
NOTHING = -9  # the power of ten of a scale that is nothing beside it
SLACK = 1e-6  # of a unit: what is so near a round number is that number
NOISE = 3  # digits beyond those shown of a point: a coordinate below them is zero beside the largest one
EXACT = Context(60, ROUND_CEILING)  # sums of a few doubles of like sizes are exact in it, others rounded up


def number(value: float, digits: int = DIGITS) -> str:
    """A number as short as it can be, without a negative zero.

    Examples
    --------
    >>> number(5.32), number(-1e-30), number(-4.992121096289474)
    ('5.32', '-1e-30', '-4.99212109629')
    """
    return f"{value + 0.0:.{digits}g}"


def short(value: float, scale: float = 0.0) -> str:
    """A number in few digits, 0 if it is nothing beside the scale.

    Examples
    --------
    >>> short(3.14159265), short(-1e-17), short(-1e-17, scale=1.0)
    ('3.142', '-1e-17', '0')
    """
    return "0" if abs(value) < 10.0**NOTHING * scale else number(value, SHORT)


def at_most(value: float, digits: int = SHORT) -> str:
    """An upper bound in few digits that is still one.

    Examples
    --------
    >>> at_most(108.7101), at_most(1.5), at_most(2.3e-13), at_most(0.0), at_most(-0.33339, 3)
    ('108.8', '1.5', '2.3e-13', '0', '-0.333')
    """
    return _directed(Decimal(value), digits, ROUND_CEILING)


def at_least(value: float, digits: int = SHORT) -> str:
    """A lower bound in few digits that is still one.

    Examples
    --------
    >>> at_least(4.42601, 3), at_least(-0.33339, 3)
    ('4.42', '-0.334')
    """
    return _directed(Decimal(value), digits, ROUND_FLOOR)


def _directed(value: Decimal, digits: int, rounding: str) -> str:
    return number(float(Context(digits, rounding).create_decimal(value)), digits)


def measured(value: float, error: float) -> str:
    """A value and its error, as many digits as the error leaves, the error rounded up.

    Examples
    --------
    >>> measured(144.8117269, 2.3e-4), measured(144.811726903428, 1e-23), measured(1.0, math.nan)
    ('144.8117 ± 0.0003', '144.811726903', '1')
    >>> measured(-1e-25, 5e-25)
    '0 ± 6e-25'
    """
    if not math.isfinite(error) or error <= significant(value):
        return number(value)
    if abs(value) <= error:
        return f"0 ± {_directed(EXACT.add(abs(Decimal(value)), Decimal(error)), 1, ROUND_CEILING)}"
    places = max(0, -math.floor(math.log10(error)))
    margin = EXACT.add(Decimal(error), Decimal(5).scaleb(-places - 1))
    return f"{value:.{places}f} ± {_directed(margin, 1, ROUND_CEILING)}"


def significant(*values: float, digits: int = DIGITS) -> float:
    """Half a unit in the last of the digits of the largest of some values.

    Examples
    --------
    >>> significant(0.5, -2.0), significant(1000.0, digits=3)
    (5e-12, 5.0)
    """
    largest = max((abs(value) for value in values if math.isfinite(value)), default=0.0)
    return 0.5 * 10.0 ** (math.floor(math.log10(largest)) + 1 - digits) if largest > 0 else 0.0


def point(coordinates: Iterable[float], digits: int = DIGITS, scale: float = 0.0) -> str:
    """A point; what is nothing beside its largest coordinate, or a scale, is 0.

    Examples
    --------
    >>> point((1.0, -0.5, 1 / 3)), point((1e-40, 0.0, 0.2)), point((1 / 3, 0, 0), 4), point(())
    ('(1, -0.5, 0.333333333333)', '(0, 0, 0.2)', '(0.3333, 0, 0)', '')
    >>> point((7e-11, -4e-10), 4, scale=1.0)
    '(0, 0)'
    """
    ends = [float(end) for end in coordinates]
    nothing = significant(*ends, scale, digits=min(DIGITS, digits + NOISE))
    shown = ", ".join(number(0.0 if abs(end) <= nothing else end, digits) for end in ends)
    return f"({shown})" if ends else ""


def about(coordinates: Sequence[float], radius: float) -> str:
    """A point that is known to within a radius, which is told where the digits do not say it.

    Examples
    --------
    >>> about((1.0, 0.5), 1e-15), about((0.0, 0.0), 0.0123)
    ('(1, 0.5)', '(0, 0) within 0.013')
    """
    return f"{point(coordinates)}{nearness(radius, *coordinates)}"


def nearness(radius: float, *coordinates: float) -> str:
    """How near what is printed of some coordinates is, where their digits do not say it."""
    return f" within {at_most(radius, 2)}" if radius > significant(*coordinates) else ""


def interval(low: float, high: float, scale: float = 0.0) -> str:
    """An enclosure in few digits that still encloses, none of them beyond a billionth of the scale and the ends.

    Examples
    --------
    >>> interval(-1.000001, 2.000001), interval(0.99999, 1.00001)
    ('[-1.001, 2.001]', '[0.9999, 1.001]')
    >>> interval(-3e-300, 0.5), interval(-2e-28, 1e-28, scale=1.0)
    ('[-1e-10, 0.5]', '[-1e-09, 1e-09]')
    """
    largest = max(abs(low), abs(high), scale)
    nothing = Decimal(10) ** (NOTHING + math.floor(math.log10(largest))) if largest > 0 else Decimal(0)
    first, last = _beyond(-Decimal(low), nothing), _beyond(Decimal(high), nothing)
    return f"[{_directed(-first, SHORT, ROUND_FLOOR)}, {_directed(last, SHORT, ROUND_CEILING)}]"


def _beyond(end: Decimal, nothing: Decimal) -> Decimal:
    """An upper end, its size `nothing` at least, or 0."""
    return end if abs(end) >= nothing else nothing if end > 0 else Decimal(0)


def enclosing(low: float, high: float, digits: int) -> tuple[str, str]:
    """The ends of a bracket: each reads back as the float that it is, or lies outside.

    Examples
    --------
    >>> enclosing(5.3, 5.3076923, 6)
    ('5.3', '5.3077')
    """
    exact = [number(end, digits) for end in (low, high)]
    outside = at_least(low, digits), at_most(high, digits)
    first, last = (
        text if float(text) == end else other for text, end, other in zip(exact, (low, high), outside, strict=True)
    )
    return first, last


def extents(low: Sequence[float], high: Sequence[float]) -> str:
    """A box, rounded outward to a hundredth of its size.

    Examples
    --------
    >>> extents((-0.8659, 0, 0.5), (0.8657, 0.1, 0.5))
    '[-0.87, 0.87] x [0, 0.1] x [0.5, 0.5]'
    """
    pairs = [(float(a), float(b)) for a, b in zip(low, high, strict=True)]
    # Far from the origin floats know no more.
    size = max(*(b - a for a, b in pairs), 1e-6 * max(max(abs(a), abs(b)) for a, b in pairs), 2.3e-308)
    places = 2 - math.floor(math.log10(size))
    unit = 10.0**places
    ends = [(math.floor(a * unit + SLACK) / unit, math.ceil(b * unit - SLACK) / unit) for a, b in pairs]
    return " x ".join(f"[{number(round(a, places))}, {number(round(b, places))}]" for a, b in ends)


def share(part: float) -> str:
    """A share in per cent, rounded up.

    Examples
    --------
    >>> share(0.00512), share(1e-14), share(0.9999)
    ('0.52 %', 'less than 0.001 %', '100 %')
    """
    if 100 * part < LEAST_SHARE:
        return f"less than {LEAST_SHARE} %"
    return f"{at_most(100 * part, 3 if 100 * part > 99 else 2)} %"


def tenths(part: float, *, up: bool) -> str:
    """A share in tenths of a per cent, rounded up or down; what is a ten-millionth of one off is that tenth.

    Examples
    --------
    >>> tenths(0.99999, up=False), tenths(1e-6, up=True), tenths(0.3, up=True)
    ('99.9 %', '0.1 %', '30.0 %')
    """
    tenth = math.ceil(1000 * part - SLACK) if up else math.floor(1000 * part + SLACK)
    return f"{tenth / 10:.1f} %"
