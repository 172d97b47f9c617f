"""The symbol table of a model: what each statement declares, every name once."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache

from rsym.errors import RsymError
from rsym.language.building import FormulaBuilder
from rsym.language.functions import FAMILIES, SYSTEMS, TextFunction, operations
from rsym.language.pieces import SPACE
from rsym.language.syntax import (
    ARITIES,
    RESERVED,
    Assignment,
    BoundsStatement,
    Call,
    ConditionStatement,
    CoordinatesStatement,
    EquationStatement,
    Expression,
    LetterStatement,
    Name,
    PartStatement,
    Position,
    Range,
    Statement,
    Sum,
    SystemStatement,
    VariantStatement,
    Vector,
    VerbatimStatement,
    names_in,
    postorder,
)
from rsym.language.syntax import Number as NumberWord
from rsym.model.bounding import Exact
from rsym.model.letters import Letter, Number
from rsym.model.symbols import real_symbol
from rsym.model.systems import R0, RSystem
from rsym.model.wording import listing, proposal


@dataclass(frozen=True)
class ModelFile:
    """A model file after reading, before any formula is built."""

    letters: Mapping[str, Letter]
    variants: Mapping[str, Mapping[str, Letter]]
    coordinates: tuple[str, ...]
    bounds: Exact | None
    system: RSystem
    assignments: tuple[Assignment, ...]
    parts: tuple[PartStatement, ...] = ()
    verbatim: bool = False
    equation: EquationStatement | None = None
    conditions: tuple[ConditionStatement, ...] = ()


def collect(statements: tuple[Statement, ...]) -> ModelFile:
    """The model that the statements declare."""
    table = _Declarations(verbatim=any(isinstance(statement, VerbatimStatement) for statement in statements))
    for statement in statements:
        table.declare(statement)
    return table.model()


class _Declarations:
    """Declarations in the order of the file."""

    def __init__(self, *, verbatim: bool = False) -> None:
        self._verbatim = verbatim
        self._parts: list[PartStatement] = []
        self._places: dict[str, Position] = {}  # of every name
        self._once: dict[str, Position] = {}  # of statements that come once
        self._letters: dict[str, Letter] = {}
        self._variants: dict[str, VariantStatement] = {}
        self._coordinates: tuple[str, ...] = ()
        self._bounds: BoundsStatement | None = None
        self._system: SystemStatement | None = None
        self._assignments: list[Assignment] = []
        self._equation: EquationStatement | None = None
        self._conditions: list[ConditionStatement] = []

    def declare(self, statement: Statement) -> None:
        """Add what one statement declares."""
        match statement:
            case LetterStatement():
                self._define(statement.name, statement.place)
                self._letters[statement.name] = letter(statement, floats=self._verbatim)
            case VariantStatement():
                self._first(f"the variant {statement.name}", statement.place)
                self._variants[statement.name] = statement
            case CoordinatesStatement():
                self._set_coordinates(statement)
            case BoundsStatement():
                self._first("bounds", statement.place)
                self._bounds = statement
            case SystemStatement():
                self._first("system", statement.place)
                self._system = statement
            case Assignment():
                self._define(statement.name, statement.place)
                self._assignments.append(statement)
            case PartStatement():
                self._parts.append(statement)
            case EquationStatement():
                self._first("the equation", statement.place)
                self._equation = statement
            case ConditionStatement():
                self._first("the condition on " + (statement.part or "others"), statement.place)
                self._conditions.append(statement)
            case VerbatimStatement():
                self._first("verbatim", statement.place)

    def model(self) -> ModelFile:
        """What was declared, checked as a whole."""
        coordinates = self._coordinates or self._default_coordinates()
        return ModelFile(
            self._letters,
            {name: variant(statement, self._letters) for name, statement in self._variants.items()},
            coordinates,
            None if self._bounds is None else bounds(self._bounds, coordinates, floats=self._verbatim),
            R0 if self._system is None else system(self._system, self._letters, floats=self._verbatim),
            tuple(self._assignments),
            tuple(self._parts),
            self._verbatim,
            self._equation,
            tuple(self._conditions),
        )

    def _define(self, name: str, place: Position) -> None:
        if name in RESERVED:
            kind = "function" if name in ARITIES else "word"
            raise place.refuse(f"'{name}' is a {kind} of the language", "reserved", "choose another name")
        if name in self._places:
            raise place.refuse(
                f"'{name}' is defined already, at {self._places[name]}",
                "redefinition",
                "a name is defined once; rename",
            )
        self._places[name] = place

    def _first(self, what: str, place: Position) -> None:
        if what in self._once:
            raise place.refuse(
                f"{what} is given already, at {self._once[what]}", "redefinition", "keep one of the two statements"
            )
        self._once[what] = place

    def _set_coordinates(self, statement: CoordinatesStatement) -> None:
        self._first("coordinates", statement.place)
        if len(statement.names) not in (2, 3):
            raise statement.place.refuse(
                f"a shape has two or three coordinates, got {len(statement.names)}",
                "coordinates",
                "for example: coordinates x y z",
            )
        for name in statement.names:
            self._define(name.name, name.place)
        self._coordinates = tuple(name.name for name in statement.names)

    def _default_coordinates(self) -> tuple[str, ...]:
        """Return x y, and z if the file speaks of it."""
        for name in ("x", "y"):
            if name in self._places:
                raise self._places[name].refuse(
                    f"'{name}' is a coordinate already",
                    "redefinition",
                    "rename it, or name other coordinates, for example: coordinates u v",
                )
        spoken = {name.name for name, _ in self._bounds.intervals} if self._bounds else set()
        formulas = [assignment.value for assignment in self._assignments]
        spoken.update(name.name for formula in formulas for name in names_in(formula))
        spoken.update("z" for formula in formulas for part in postorder(formula) if _is_in_space(part))
        return ("x", "y", "z") if "z" in spoken and "z" not in self._places else ("x", "y")


def _is_in_space(part: Expression) -> bool:
    """A piece that makes a body, or a point with three coordinates."""
    if isinstance(part, Vector):
        return len(part.parts) == 3 and not any(isinstance(item, Vector) for item in part.parts)
    return isinstance(part, Call) and part.function in SPACE


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


def bounds(statement: BoundsStatement, coordinates: tuple[str, ...], *, floats: bool) -> Exact:
    """The box, one range for each coordinate in their order."""
    box: dict[str, tuple[Number, Number]] = {}
    for name, interval in statement.intervals:
        if name.name not in coordinates or name.name in box:
            raise name.place.refuse(
                f"bounds want each coordinate once, got '{name.name}'",
                "bounds",
                f"the coordinates are {listing(coordinates)}",
            )
        low, high = closed_number(interval.low, floats), closed_number(interval.high, floats)
        if not float(low) < float(high):
            raise _empty(interval, low, high, "bounds")
        box[name.name] = (low, high)
    if missing := [name for name in coordinates if name not in box]:
        raise statement.place.refuse(
            f"bounds lack {listing(missing)}", "bounds", f"add {missing[0]} [low, high], or leave the statement out"
        )
    return tuple(box[name] for name in coordinates)


def _empty(interval: Range, low: Number, high: Number, code: str) -> RsymError:
    return interval.place.refuse(f"the range [{float(low):g}, {float(high):g}] is empty", code, "write [low, high]")


@cache
def _plain_operations() -> Mapping[str, TextFunction]:
    return operations(R0)  # to make them for each number took a tenth of reading the car


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
    value = FormulaBuilder(_plain_operations()).build(expression, {}).exact
    if value is None:
        raise expression.place.refuse(
            "expected a rational number", "letter-value", "write its decimal value, for example 1.4142"
        )
    return int(value) if value.denominator == 1 else value
