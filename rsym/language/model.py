"""The symbol table of a model: what each statement declares, every name once."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from rsym.language.declarations import bounds, letter, system, variant
from rsym.language.pieces import SPACE
from rsym.language.syntax import (
    Assignment,
    BoundsStatement,
    Call,
    CoordinatesStatement,
    Expression,
    LetterStatement,
    PartStatement,
    Position,
    Statement,
    SystemStatement,
    VariantStatement,
    Vector,
    VerbatimStatement,
    names_in,
    postorder,
)
from rsym.language.vocabulary import ARITIES, RESERVED
from rsym.model.letters import Letter
from rsym.model.shape import Bounds
from rsym.model.systems import R0, RSystem


@dataclass(frozen=True)
class ModelFile:
    """A model file after reading, before any formula is built."""

    letters: Mapping[str, Letter]
    variants: Mapping[str, Mapping[str, Letter]]
    coordinates: tuple[str, ...]
    bounds: Bounds | None
    system: RSystem
    assignments: tuple[Assignment, ...]
    parts: tuple[PartStatement, ...] = ()
    verbatim: bool = False


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
            case VerbatimStatement():
                self._first("verbatim", statement.place)

    def model(self) -> ModelFile:
        """What was declared, checked as a whole."""
        coordinates = self._coordinates or self._default_coordinates()
        return ModelFile(
            self._letters,
            {name: variant(statement, self._letters) for name, statement in self._variants.items()},
            coordinates,
            None if self._bounds is None else bounds(self._bounds, coordinates),
            R0 if self._system is None else system(self._system, self._letters, floats=self._verbatim),
            tuple(self._assignments),
            tuple(self._parts),
            self._verbatim,
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
