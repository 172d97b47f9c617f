"""Interval rules: the ends of an image as expressions in the ends of the operands.

Nothing is evaluated: SymPy's own Min, Max and Piecewise would compare long
expressions. An end without a value, NaN once compiled, says nothing.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import sympy as sp

from rsym.analysis.contracts.promises import Ends
from rsym.model.choices import Choice
from rsym.model.rnodes import R1Conjunction, R1Disjunction


def least(*values: sp.Expr) -> sp.Expr:
    """The smallest, as a node that nothing evaluates; undefined if one is.

    Examples
    --------
    >>> from rsym import x, y
    >>> least(x, y)
    conjunction(x, y, system=R1)
    """
    return sp.nan if sp.nan in values else R1Conjunction(*values)


def greatest(*values: sp.Expr) -> sp.Expr:
    """The largest, as a node that nothing evaluates; undefined if one is."""
    return sp.nan if sp.nan in values else R1Disjunction(*values)


def rising(function: Callable[..., sp.Expr]) -> Callable[..., Ends]:
    """The image under a function that grows with every operand."""
    return lambda *ends: (function(*(low for low, _ in ends)), function(*(high for _, high in ends)))


def falling(function: Callable[..., sp.Expr]) -> Callable[..., Ends]:
    """The image under a function that falls with every operand."""
    return lambda *ends: (function(*(high for _, high in ends)), function(*(low for low, _ in ends)))


def at_corners(function: Callable[[sp.Expr, sp.Expr], sp.Expr]) -> Callable[[Ends, Ends], Ends]:
    """The image under a function that is monotone in each of two operands, either way."""

    def image(first: Ends, second: Ends) -> Ends:
        values = list(dict.fromkeys(function(u, v) for u in first for v in second))
        return (values[0], values[0]) if len(values) == 1 else (least(*values), greatest(*values))

    return image


def size(ends: Ends) -> Ends:
    """The image of the absolute value."""
    low, high = ends
    if low is high:
        return (greatest(low, -low),) * 2
    return greatest(low, -high, sp.S.Zero), greatest(-low, high)


def total(*ends: Ends) -> Ends:
    """The image of a sum."""
    return sp.Add(*(low for low, _ in ends)), sp.Add(*(high for _, high in ends))


def product(*ends: Ends) -> Ends:
    """The image of a product; a number turns or stretches the ends, other factors are taken two by two."""
    result, *rest = ends
    for factor in rest:
        if _is_number(result):
            result, factor = factor, result
        result = _scaled(result, factor[0]) if _is_number(factor) else _pair(result, factor)
    return result


def _is_number(ends: Ends) -> bool:
    return bool(ends[0] == ends[1] and ends[0].is_Rational)


_pair = at_corners(sp.Mul)


def _scaled(ends: Ends, number: sp.Rational) -> Ends:
    low, high = ends
    return (number * low, number * high) if number >= 0 else (number * high, number * low)


def whole_power(ends: Ends, exponent: sp.Integer) -> Ends:
    """The image of u**n; undefined where n < 0 and u may be zero."""
    low, high = size(ends) if exponent % 2 == 0 else ends
    if exponent > 0:
        return low**exponent, high**exponent
    return _apart(ends, high**exponent), _apart(ends, low**exponent)


def _apart(ends: Ends, value: sp.Expr) -> sp.Expr:
    """A value where zero lies outside."""
    return Choice(ends[0], 0, value, Choice(0, ends[1], value, sp.nan))


def real_power(ends: Ends, exponent: sp.Expr) -> Ends:
    """The image of u**a for u >= 0, a the same number everywhere; what is below zero does not count."""
    low, high = (greatest(ends[0], sp.S.Zero) ** exponent, ends[1] ** exponent)
    if exponent.is_positive:
        return low, high
    return (high, low) if exponent.is_negative else (least(low, high), greatest(low, high))


def turned(ends: Ends, shift: sp.Expr) -> Ends:
    """The image of cos(u + shift)."""
    angle = ends[0] + shift, ends[1] + shift
    values = [sp.cos(end, evaluate=False) for end in angle]
    return _between_crests(angle, (least(*values), greatest(*values)), sp.S.One)


def triangle(place: Ends, period: sp.Expr, wave: Callable[..., sp.Expr]) -> Ends:
    """The image of a triangle wave: its crests are those of sin(pi t/h)."""
    angle = tuple(sp.pi * end / period - sp.pi / 2 for end in place)
    values = [wave(end, period) for end in place]
    return _between_crests((angle[0], angle[1]), (least(*values), greatest(*values)), period / 2)


def sawtooth(place: Ends, period: sp.Expr, wave: Callable[..., sp.Expr]) -> Ends:
    """The image of a sawtooth: growing, all of it where a jump may be inside."""
    centre, reach, half = _crests([2 * sp.pi * end / period for end in place])
    low, high = (wave(end, period) for end in place)
    return _short_of(-centre, reach, half, low, -period / 2), _short_of(-centre, reach, half, high, period / 2)


def _between_crests(angle: Ends, values: Ends, crest: sp.Expr) -> Ends:
    """The ends of a wave; a crest is inside where half the width is beyond the angle from the middle to it."""
    centre, reach, half = _crests(angle)
    return _short_of(-centre, reach, half, values[0], -crest), _short_of(centre, reach, half, values[1], crest)


def _crests(angle: Sequence[sp.Expr]) -> tuple[sp.Expr, sp.Expr, sp.Expr]:
    """The cosines of the middle and of half the width, and that half."""
    half, middle = (angle[1] - angle[0]) / 2, (angle[0] + angle[1]) / 2
    return sp.cos(middle, evaluate=False), sp.cos(half, evaluate=False), half


def _short_of(centre: sp.Expr, reach: sp.Expr, half: sp.Expr, value: sp.Expr, crest: sp.Expr) -> sp.Expr:
    """The value where no crest is inside."""
    return Choice(sp.pi, half, Choice(reach, centre, value, crest), crest)


def tangent(ends: Ends) -> Ends:
    """The image of tan, undefined where a pole may be inside."""
    centre, _, half = _crests(ends)
    size = greatest(centre, -centre)

    def inside(end: sp.Expr) -> sp.Expr:
        clear = Choice(size, sp.sin(half, evaluate=False), sp.tan(end, evaluate=False), sp.nan)
        return Choice(sp.pi / 2, half, clear, sp.nan)

    return inside(ends[0]), inside(ends[1])


def angle(ordinate: Ends, abscissa: Ends) -> Ends:
    """The image of atan2: the angles of the corners, or the whole turn where the box meets the cut y = 0, x <= 0."""
    low, high = at_corners(lambda v, u: sp.atan2(v, u, evaluate=False))(ordinate, abscissa)

    def apart(value: sp.Expr, otherwise: sp.Expr) -> sp.Expr:
        below = Choice(0, ordinate[1], value, otherwise)
        return Choice(abscissa[0], 0, value, Choice(ordinate[0], 0, value, below))

    return apart(low, -sp.pi), apart(high, sp.pi)


def hull(*ends: Ends) -> Ends:
    """An interval around several."""
    return least(*(low for low, _ in ends)), greatest(*(high for _, high in ends))
