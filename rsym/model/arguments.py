"""What pieces of shapes are given: numbers, points and directions, each a number or an expression in letters.

Bounds and decisions (is this corner reflex, is this radius positive) are made at
the default values of the letters; formulas keep the letters.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from decimal import Decimal
from typing import Any, TypeAlias

import sympy as sp

from rsym.errors import RsymError, warn
from rsym.model.letters import Letter, as_letters
from rsym.model.symbols import as_expression, real_replacements, substitute, symbols_of
from rsym.model.vectors import norm

LetterMapping: TypeAlias = Mapping[Any, Letter | float] | None
LONGEST_DECIMAL = 8  # digits: what people type; measured and computed numbers have 15 to 17
Point: TypeAlias = tuple[sp.Expr, ...]

_COORDINATES = ("x", "y", "z")


def number(value: Any, what: str) -> sp.Expr:
    """A finite real number or an expression in letters, symbols real; decimals are exact.

    Examples
    --------
    >>> number(2, "the radius"), number(0.6, "the radius")
    (2, 3/5)
    """
    try:
        expression = as_expression(_typed(value) if isinstance(value, float) else value)
    except RsymError as error:
        raise RsymError(f"{what} must be a number or an expression in letters, got {value!r}", code="number") from error
    real = real_replacements([expression])
    expression = substitute(expression, real) if real else expression
    if not isinstance(expression, sp.Expr) or expression.has(sp.nan, sp.zoo, sp.oo, -sp.oo, sp.I):
        raise RsymError(f"{what} must be finite and real, got {value!r}", code="number")
    return expression


def angle(value: Any, what: str, *, degrees: bool) -> sp.Expr:
    """An angle in radians, given in radians or in degrees.

    Examples
    --------
    >>> angle(30, "the angle", degrees=True), angle(2, "the angle", degrees=False)
    (pi/6, 2)
    """
    if not isinstance(degrees, int) or degrees not in (0, 1):
        raise RsymError(f"degrees must be True or False, got {degrees!r}", code="switch", remedy="degrees=True")
    given = number(value, what)
    return given * sp.pi / 180 if degrees else given


def turn(value: Any, what: str, *, degrees: bool) -> sp.Expr:
    """An angle that may be any: a warning says what to do, if a rational number of radians is beyond a whole turn.

    Examples
    --------
    >>> turn(90, "an angle", degrees=True)
    pi/2
    """
    given = angle(value, what, degrees=degrees)
    if given.is_Rational and abs(given) > 2 * sp.pi:
        remedy = f"give degrees=True, or math.radians({given})"
        warn(f"{what} of {given} radians is more than a whole turn; if degrees are meant, {remedy}")
    return given


def _typed(value: float) -> Any:
    """A float of a few digits is the decimal that was typed, so that formulas stay exact; others are what they are."""
    text = repr(float(value))
    short = math.isfinite(value) and len(Decimal(text).as_tuple().digits) <= LONGEST_DECIMAL
    return sp.Rational(text) if short else float(value)


def default(expression: sp.Expr, letters: LetterMapping, what: str = "a parameter") -> float:
    """The value of an expression where every letter has its default.

    Examples
    --------
    >>> import sympy as sp
    >>> r = sp.Symbol("r", real=True)
    >>> default(2 * r, {r: 1.5})
    3.0
    """
    known = as_letters(letters)
    unknown = [symbol.name for symbol in symbols_of(expression) if symbol.name not in known]
    if unknown and unknown[0] in _COORDINATES:
        raise RsymError(
            f"{what} contains {unknown[0]}, a coordinate, but must be the same everywhere",
            code="unknown-letter",
            remedy="for a shape that varies from place to place use transform, or sweep",
        )
    if unknown:
        raise RsymError(
            f"{what} contains {', '.join(unknown)}, which has no value",
            code="unknown-letter",
            remedy=f"give letters={{{unknown[0]}: value}}",
        )
    values = {symbol: sp.sympify(known[symbol.name].default) for symbol in symbols_of(expression)}
    value = sp.N(substitute(expression, values))
    if (not value.is_Float and not value.is_Rational) or not math.isfinite(value):
        raise RsymError(f"{what} must be finite and real, got {expression}", code="number")
    return float(value)


def positive(value: Any, what: str, letters: LetterMapping = None) -> sp.Expr:
    """A number that is above zero where letters have their defaults."""
    expression = number(value, what)
    size = default(expression, letters, what)
    if size <= 0:
        raise RsymError(f"{what} must be positive, got {shown(expression, size)}", code="positive")
    return expression


def shown(expression: sp.Expr, size: float) -> str:
    """A number for a message; of an expression in letters its value too.

    Examples
    --------
    >>> import sympy as sp
    >>> shown(sp.Symbol("a") - 2, -1)
    'a - 2 = -1'
    """
    return str(expression) if expression.is_number else f"{expression} = {size:g}"


def whole(value: Any, what: str, least: int) -> int:
    """An integer, at least `least`."""
    given = sp.sympify(value) if isinstance(value, int | float | sp.Number) and not isinstance(value, bool) else None
    if given is None or not given.is_finite or given != int(given) or given < least:
        raise RsymError(f"{what} must be an integer from {least} on, got {value!r}", code="integer")
    return int(given)


def point(value: Any, dimension: int, what: str) -> Point:
    """As many numbers as there are coordinates.

    Examples
    --------
    >>> point((1, 2), 2, "the centre")
    (1, 2)
    """
    items = list(value) if isinstance(value, Sequence | sp.MatrixBase | sp.Tuple) or hasattr(value, "tolist") else []
    if isinstance(value, str) or len(items) != dimension:
        raise RsymError(f"{what} needs {dimension} numbers, got {value!r}", code="point")
    return tuple(number(item, what) for item in items)


def unit_vector(value: Any, dimension: int, what: str, letters: LetterMapping = None) -> Point:
    """A direction as a vector of length 1: the given one over its length, which must not be zero.

    Examples
    --------
    >>> unit_vector((3, 4), 2, "the normal")
    (3/5, 4/5)
    """
    given = point(value, dimension, what)
    if all(default(component, letters, what) == 0 for component in given):
        raise RsymError(f"{what} must not be the zero vector", code="direction")
    length = norm(given)
    return tuple(component / length for component in given)


def coordinate(value: Any, coordinates: Sequence[sp.Symbol], what: str = "the axis") -> int:
    """Which of the coordinates a symbol, a name or a number from 0 on is.

    Examples
    --------
    >>> from rsym import x, y
    >>> coordinate("y", (x, y))
    1
    """
    names = [symbol.name for symbol in coordinates]
    if isinstance(value, int) and not isinstance(value, bool) and 0 <= value < len(names):
        return value
    if str(value) not in names:
        raise RsymError(f"{what} must be one of the coordinates {', '.join(names)}, got {value}", code="axis")
    return names.index(str(value))
