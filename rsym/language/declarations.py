"""What one statement declares: a letter, a variant, a box, an R-system."""

from __future__ import annotations

from collections.abc import Mapping

from rsym.errors import RsymError
from rsym.language.building import FormulaBuilder
from rsym.language.functions import FAMILIES, SYSTEMS, operations
from rsym.language.syntax import (
    BoundsStatement,
    Expression,
    LetterStatement,
    Name,
    Position,
    Range,
    Sum,
    SystemStatement,
    VariantStatement,
    names_in,
)
from rsym.language.syntax import Number as NumberWord
from rsym.model.letters import Letter, Number
from rsym.model.shape import Bounds
from rsym.model.symbols import real_symbol
from rsym.model.systems import R0, RSystem
from rsym.model.wording import listing, proposal


def letter(statement: LetterStatement, *, floats: bool = False) -> Letter:
    """The letter that a statement declares; decimals are exact, or floats; an end that is open is inf or -inf."""
    low, high = _range(statement.interval, floats)
    default = closed_number(statement.value, floats)
    return _in_range(statement.place, Letter(0, unit=statement.unit, doc=statement.doc), default, low, high)


def _range(interval: Range | None, floats: bool) -> tuple[Number | None, Number | None]:
    if interval is None:
        return None, None
    low = None if _is_endless(interval.low, -1) else closed_number(interval.low, floats)
    high = None if _is_endless(interval.high, 1) else closed_number(interval.high, floats)
    if low is not None and high is not None and not float(low) < float(high):
        if not (floats and float(low) == float(high)):
            raise _empty(interval, low, high, "letter-range")
    return low, high


def _is_endless(end: Expression, sign: int) -> bool:
    inner = end.parts[0] if sign < 0 and isinstance(end, Sum) and end.signs == (-1,) else end
    return (sign > 0 or inner is not end) and isinstance(inner, Name) and inner.name == "inf"


def variant(statement: VariantStatement, letters: Mapping[str, Letter]) -> dict[str, Letter]:
    """The letters that a variant changes, with their new defaults."""
    changed: dict[str, Letter] = {}
    for name, value in statement.values:
        if name.name not in letters:
            remedy = proposal(name.name, letters, f"declare it; the letters are {listing(letters)}")
            raise name.place.refuse(f"no letter '{name.name}'", "unknown-name", remedy)
        if name.name in changed:
            raise name.place.refuse(f"'{name.name}' is set twice", "redefinition", "keep one of the two values")
        old, default = letters[name.name], closed_number(value)
        changed[name.name] = _in_range(name.place, old, default, old.minimum, old.maximum)
    return changed


def _in_range(place: Position, like: Letter, default: Number, low: Number | None, high: Number | None) -> Letter:
    """Build a letter; one out of its range is refused at its place in the text."""
    try:
        return Letter(default, minimum=low, maximum=high, unit=like.unit, doc=like.doc)
    except RsymError as error:
        raise place.refuse(error.message, error.code, error.remedy) from None


def system(statement: SystemStatement, letters: Mapping[str, Letter], *, floats: bool = False) -> RSystem:
    """The R-system of that name, its parameter a number, as floats a decimal is one, or a letter."""
    name, parameter = statement.name, statement.parameter
    if name in SYSTEMS:
        if parameter is not None:
            raise parameter.place.refuse(f"the system {name} has no parameter", "parameter", f"write: system {name}")
        return SYSTEMS[name]
    if name not in FAMILIES:
        known = [*SYSTEMS, *FAMILIES]
        remedy = proposal(name, known, f"the systems are {listing(known)}")
        raise statement.place.refuse(f"no R-system '{name}'", "unknown-system", remedy)
    family, example = FAMILIES[name]
    remedy = f"for example: system {name} {example}"
    if parameter is None:
        raise statement.place.refuse(f"the system {name} needs its parameter", "parameter", remedy)
    spoken = letters.get(parameter.name) if isinstance(parameter, Name) else None
    try:
        checked = family(closed_number(parameter, floats) if spoken is None else spoken.default)
    except RsymError as error:
        raise parameter.place.refuse(error.message, error.code, error.remedy or remedy) from None
    return family(real_symbol(parameter.name)) if isinstance(parameter, Name) else checked


def bounds(statement: BoundsStatement, coordinates: tuple[str, ...]) -> Bounds:
    """The box, one range for each coordinate in their order."""
    box: dict[str, tuple[float, float]] = {}
    for name, interval in statement.intervals:
        if name.name not in coordinates or name.name in box:
            raise name.place.refuse(
                f"bounds want each coordinate once, got '{name.name}'",
                "bounds",
                f"the coordinates are {listing(coordinates)}",
            )
        low, high = closed_number(interval.low), closed_number(interval.high)
        if not float(low) < float(high):
            raise _empty(interval, low, high, "bounds")
        box[name.name] = (float(low), float(high))
    if missing := [name for name in coordinates if name not in box]:
        raise statement.place.refuse(
            f"bounds lack {listing(missing)}", "bounds", f"add {missing[0]} [low, high], or leave the statement out"
        )
    return tuple(box[name] for name in coordinates)


def _empty(interval: Range, low: Number, high: Number, code: str) -> RsymError:
    return interval.place.refuse(f"the range [{float(low):g}, {float(high):g}] is empty", code, "write [low, high]")


def closed_number(expression: Expression, floats: bool = False) -> Number:
    """The exact value of a closed rational expression; as floats a decimal is the float that it names."""
    bare = expression.parts[0] if isinstance(expression, Sum) and expression.signs == (-1,) else expression
    if floats and isinstance(bare, NumberWord) and bare.point:
        return float(bare.value) if bare is expression else -float(bare.value)
    for name in names_in(expression):
        remedy = "write a number such as -2.5 or 5/2, without names"
        if name.name == "pi":
            remedy += "; an angle may be a letter in degrees, which formulas take as: a deg"
        raise name.place.refuse(f"'{name.name}' cannot stand here", "letter-value", remedy)
    value = FormulaBuilder(operations(R0)).build(expression, {}).exact
    if value is None:
        raise expression.place.refuse(
            "expected a rational number", "letter-value", "write its decimal value, for example 1.4142"
        )
    return int(value) if value.denominator == 1 else value
