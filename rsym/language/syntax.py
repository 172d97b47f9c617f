"""What a model file says, as frozen data: places, expressions and statements, and the words with a meaning.

Sums, products and powers are n-ary, so a long chain is wide and never deep.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from typing import TypeAlias

from rsym.errors import RsymError
from rsym.model.functions import FUNCTIONS

KEYWORDS = ("letter", "variant", "coordinates", "bounds", "system", "in")

# Fewest and most arguments; None: any number.
ARITIES: dict[str, tuple[int, int | None]] = {
    "rfAND": (2, None),
    "rfOR": (2, None),
    "rfNOT": (1, 1),
    "conjunction": (2, None),
    "disjunction": (2, None),
    "negation": (1, 1),
    "difference": (2, None),
    "implication": (2, 2),
    "exclusive_or": (2, 2),
    "equivalence": (2, None),
    "joining": (2, None),
    "trimming": (2, 2),
    "sqrt": (1, 1),
    **{name: row.arity for name, row in FUNCTIONS.items()},
}

RESERVED = frozenset((*KEYWORDS, *ARITIES, "pi"))


@dataclass(frozen=True, slots=True)
class Position:
    """A line and a column, both counted from one."""

    line: int
    column: int

    def __str__(self) -> str:
        return f"line {self.line}, column {self.column}"

    def refuse(self, message: str, code: str, remedy: str) -> RsymError:
        """The error for this place, to be raised."""
        return RsymError(message, code=code, where=str(self), remedy=remedy)


@dataclass(frozen=True, slots=True)
class Number:
    """An exact number; `point` says that it was written with a point or an exponent."""

    place: Position
    value: Fraction
    parts: tuple[Expression, ...] = ()
    point: bool = False


@dataclass(frozen=True, slots=True)
class Name:
    """A letter, a coordinate, an assigned name or pi."""

    place: Position
    name: str
    parts: tuple[Expression, ...] = ()


@dataclass(frozen=True, slots=True)
class Sum:
    """s1*p1 + s2*p2 + ... with signs s = 1 or -1."""

    place: Position
    signs: tuple[int, ...]
    parts: tuple[Expression, ...]


@dataclass(frozen=True, slots=True)
class Product:
    """p1^s1 * p2^s2 * ... with s = 1 for a factor and -1 for a divisor."""

    place: Position
    signs: tuple[int, ...]
    parts: tuple[Expression, ...]


@dataclass(frozen=True, slots=True)
class Power:
    """((base ^ exponent) ^ exponent) ...: the base first, then the exponents; MATLAB's power is left-associative."""

    place: Position
    parts: tuple[Expression, ...]


@dataclass(frozen=True, slots=True)
class Call:
    """A function of some arguments; `keywords` name the last of them."""

    place: Position
    function: str
    parts: tuple[Expression, ...]
    keywords: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Vector:
    """[p1, p2, ...], an argument of a piece."""

    place: Position
    parts: tuple[Expression, ...]


@dataclass(frozen=True, slots=True)
class Quoted:
    """A quoted choice, an argument of a piece."""

    place: Position
    value: str
    parts: tuple[Expression, ...] = ()


Expression: TypeAlias = Number | Name | Sum | Product | Power | Call | Vector | Quoted


@dataclass(frozen=True, slots=True)
class Range:
    """[low, high]."""

    place: Position
    low: Expression
    high: Expression


@dataclass(frozen=True, slots=True)
class LetterStatement:
    """``letter a = 5 in [1, 10] unit "mm" "what it is"``."""

    place: Position
    name: str
    value: Expression
    interval: Range | None
    doc: str
    unit: str = ""


@dataclass(frozen=True, slots=True)
class VariantStatement:
    """``variant b: a1 = 9, b1 = 4``."""

    place: Position
    name: str
    values: tuple[tuple[Name, Expression], ...]


@dataclass(frozen=True, slots=True)
class CoordinatesStatement:
    """``coordinates x y z``."""

    place: Position
    names: tuple[Name, ...]


@dataclass(frozen=True, slots=True)
class BoundsStatement:
    """``bounds x [-8, 8] y [-4, 4]``."""

    place: Position
    intervals: tuple[tuple[Name, Range], ...]


@dataclass(frozen=True, slots=True)
class SystemStatement:
    """``system R0`` or ``system Ralpha 0.5``."""

    place: Position
    name: str
    parameter: Expression | None


@dataclass(frozen=True, slots=True)
class Assignment:
    """``name = expression "what it is"``."""

    place: Position
    name: str
    value: Expression
    doc: str = ""
    inner: bool = False  # one that a loop has made, before the last


@dataclass(frozen=True, slots=True)
class ForStatement:
    """``for k = low:step:high ... end``: its statements once for each value of k."""

    place: Position
    name: str
    run: tuple[Expression, ...]  # low, high or low, step, high
    body: tuple[Statement, ...]


@dataclass(frozen=True, slots=True)
class PartStatement:
    """``part "bonnet" = expression``: what pictures and meshes call the surface of a formula."""

    place: Position
    name: str
    value: Expression


@dataclass(frozen=True, slots=True)
class EquationStatement:
    """``equation -laplacian(u) = 1``: what a function u on the shape is to meet; `text` is how it is written."""

    place: Position
    left: Expression
    right: Expression
    text: str


@dataclass(frozen=True, slots=True)
class ConditionStatement:
    """``on rim = 0``, ``on "wheel arch" = robin(2, 1)``, ``on others = 0``: what u is to meet on a part.

    part : its name, None for the rest; kind : the function that is called, "" for a bare value.
    """

    place: Position
    part: str | None
    kind: str
    values: tuple[Expression, ...]


@dataclass(frozen=True, slots=True)
class VerbatimStatement:
    """``verbatim``: operations stay as they are written, decimals are floats, and all letters are kept."""

    place: Position


Statement: TypeAlias = (
    LetterStatement
    | VariantStatement
    | CoordinatesStatement
    | BoundsStatement
    | SystemStatement
    | Assignment
    | PartStatement
    | EquationStatement
    | ConditionStatement
    | VerbatimStatement
    | ForStatement
)


def postorder(expression: Expression) -> Iterator[Expression]:
    """Every part before the expression that it is a part of, without recursion."""
    stack: list[tuple[Expression, bool]] = [(expression, False)]
    while stack:
        part, parts_done = stack.pop()
        if parts_done or not part.parts:
            yield part
        else:
            stack.append((part, True))
            stack.extend((inner, False) for inner in reversed(part.parts))


def names_in(expression: Expression) -> Iterator[Name]:
    """The names that an expression mentions, in the order of the text."""
    return (part for part in postorder(expression) if isinstance(part, Name))
