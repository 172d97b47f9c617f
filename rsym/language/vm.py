"""Texts of fidget and MPR to a shape: a line is a name, an operation and its arguments; text is never run.

Equal lines are one part, and what the text shares the formula shares. Nothing recurses, and nothing is simplified but
constants, so the time is linear in the lines and every operation stays as it is written.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Sequence
from fractions import Fraction
from functools import lru_cache
from typing import NamedTuple

import sympy as sp

from rsym.errors import RsymError
from rsym.language import exact
from rsym.language.building import Built, FormulaBuilder, exact_part
from rsym.language.exact import division_by_zero
from rsym.language.functions import operations
from rsym.language.model import ModelFile
from rsym.language.syntax import Call, Expression, Name, Number, Position, Power, Product, Sum
from rsym.model.rnodes import R1Conjunction, R1Disjunction
from rsym.model.shape import Shape
from rsym.model.symbols import PLANE, SPACE
from rsym.model.systems import R1
from rsym.model.unevaluated import unevaluated
from rsym.model.wording import listing, proposal

SUFFIX = ".vm"
LONGEST_TEXT = 4_000_000  # characters; 160 000 lines in 3.3 million were measured to take 2 s and 180 MB
_AXES = dict(zip(("var-x", "var-y", "var-z"), SPACE, strict=True))
_GATES = {"min": R1Conjunction, "max": R1Disjunction}
_LACKING = frozenset(("mod", "and", "or", "not", "round", "rand", "mix"))  # of fidget's reader
_NUMBER = re.compile(r"([+-]?)((?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)", re.ASCII)
_NOT_FINITE = re.compile(r"[+-]?(nan|inf|infinity)", re.IGNORECASE)
_HALF = sp.Rational(1, 2)


class Meaning(NamedTuple):
    """An operation of the format: how many names it takes, and what it is as a node and as a formula of constants."""

    names: int
    node: Callable[..., sp.Expr]
    formula: Callable[..., Expression]


def _sum(a: sp.Expr, b: sp.Expr) -> sp.Expr:
    return unevaluated(sp.Add, a, b)


def _opposite(a: sp.Expr) -> sp.Expr:
    return -a if a.is_Rational else unevaluated(sp.Mul, sp.S.NegativeOne, a)


def _difference(a: sp.Expr, b: sp.Expr) -> sp.Expr:
    return _sum(a, _opposite(b))


def _product(a: sp.Expr, b: sp.Expr) -> sp.Expr:
    return unevaluated(sp.Mul, b, a) if b.is_Rational else unevaluated(sp.Mul, a, b)


def _quotient(a: sp.Expr, b: sp.Expr) -> sp.Expr:
    return _product(a, 1 / b if b.is_Rational else unevaluated(sp.Pow, b, sp.S.NegativeOne))


def _power(exponent: sp.Rational) -> Meaning:
    value = Fraction(int(exponent.p), int(exponent.q))
    return Meaning(
        1, lambda a: unevaluated(sp.Pow, a, exponent), lambda at, a: Power(at, (a, Number(at, value, point=False)))
    )


def _call(kind: type[sp.Expr], name: str, count: int = 1) -> Meaning:
    return Meaning(count, lambda *parts: unevaluated(kind, *parts), lambda at, *parts: Call(at, name, parts))


OPERATIONS: dict[str, Meaning] = {
    "add": Meaning(2, _sum, lambda at, *parts: Sum(at, (1, 1), parts)),
    "sub": Meaning(2, _difference, lambda at, *parts: Sum(at, (1, -1), parts)),
    "mul": Meaning(2, _product, lambda at, *parts: Product(at, (1, 1), parts)),
    "div": Meaning(2, _quotient, lambda at, *parts: Product(at, (1, -1), parts)),
    "neg": Meaning(1, _opposite, lambda at, *parts: Sum(at, (-1,), parts)),
    "square": _power(sp.Integer(2)),
    "sqrt": _power(_HALF),
    "recip": _power(sp.S.NegativeOne),
    "floor": _call(sp.floor, "floor"),
    "min": _call(R1Conjunction, "min", 2),
    "max": _call(R1Disjunction, "max", 2),
    "abs": _call(sp.Abs, "abs"),
    "exp": _call(sp.exp, "exp"),
    "ln": _call(sp.log, "log"),
    "log": _call(sp.log, "log"),
    **{name: _call(getattr(sp, name), name) for name in ("sin", "cos", "tan", "asin", "acos", "atan")},
    "atan2": _call(sp.atan2, "atan2", 2),
    # -1, 0 or 1, by which argument is larger.
    "compare": Meaning(
        2,
        lambda a, b: unevaluated(sp.sign, _difference(a, b)),
        lambda at, *parts: Call(at, "sign", (Sum(at, (1, -1), parts),)),
    ),
}
_KNOWN = ("const", *_AXES, *OPERATIONS)


class Instruction(NamedTuple):
    """A distinct line: its operation on earlier rows, the value of a constant, and the number of the line."""

    operation: str
    arguments: tuple[int, ...]
    value: Fraction | None
    line: int


class Instructions:
    """The distinct rows of a text, in order; equal lines are one row."""

    def __init__(self, text: str) -> None:
        if len(text) > LONGEST_TEXT:
            message = f"the text has {len(text)} characters; {LONGEST_TEXT} are the most"
            raise Position(1, 1).refuse(message, "too-large", "split the model")
        self.texts = text.removeprefix("\ufeff").split("\n")
        self.rows: list[Instruction] = []
        self._numbers: dict[tuple[str, tuple[int, ...], Fraction | None], int] = {}
        self._names: dict[str, tuple[int, int]] = {}  # the row, and the line that defines it
        self.last = -1
        for line, content in enumerate(self.texts, 1):
            if words := content.partition("#")[0].split():
                self.last = self._add(line, words)
        if self.last < 0:
            raise Position(1, 1).refuse("the text has no line with an operation", "empty", "add one, such as: _0 var-x")

    def place(self, line: int, word: int = 1) -> Position:
        """Where a word of a line begins."""
        starts = [match.start() for match in re.finditer(r"\S+", self.texts[line - 1])]
        return Position(line, starts[min(word, len(starts) - 1)] + 1)

    def _add(self, line: int, words: Sequence[str]) -> int:
        name, operation, *rest = *words, *([""] if len(words) == 1 else [])
        if name in self._names:
            raise self.place(line, 0).refuse(
                f"'{name[:40]}' is defined already, in line {self._names[name][1]}",
                "redefinition",
                "a name is defined once; rename",
            )
        wanted = 1 if operation == "const" else 0 if operation in _AXES else self._operation(line, operation).names
        if len(rest) != wanted:
            some = f"{wanted} argument{'s' * (wanted != 1)}" if wanted else "no argument"
            remedy = "a line is a name, an operation and its arguments, such as: _3 add _1 _2"
            raise self.place(line).refuse(f"'{operation}' takes {some}, got {len(rest)}", "arity", remedy)
        value = self._number(line, rest[0]) if operation == "const" else None
        arguments = () if operation == "const" else tuple(self._row(line, k, word) for k, word in enumerate(rest, 2))
        if operation in _GATES and arguments[0] == arguments[1]:
            number = arguments[0]
        else:
            key = (operation, arguments, value)
            number = self._numbers.setdefault(key, len(self.rows))
            if number == len(self.rows):
                self.rows.append(Instruction(*key, line))
        self._names[name] = (number, line)
        return number

    def _operation(self, line: int, word: str) -> Meaning:
        found = OPERATIONS.get(word)
        if found is not None:
            return found
        if word in _LACKING:
            remedy = f"write the model with {listing(OPERATIONS)}"
            raise self.place(line).refuse(f"rsym has no operation like '{word}'", "unsupported-function", remedy)
        message = f"no operation '{word[:40]}'" if word else "a name without an operation"
        remedy = proposal(word, _KNOWN, f"the operations are {listing(_KNOWN)}")
        raise self.place(line).refuse(message, "unknown-operation", remedy)

    def _number(self, line: int, word: str) -> Fraction:
        if match := _NUMBER.fullmatch(word):
            sign, digits = match.groups()
            value = exact.literal(digits, self.place(line, 2))
            return -value if sign == "-" else value
        what = "is not finite" if _NOT_FINITE.fullmatch(word) else "is not a number"
        raise self.place(line, 2).refuse(f"the constant '{word[:40]}' {what}", "number", "write a decimal, as -2.5e-3")

    def _row(self, line: int, word: int, name: str) -> int:
        known = self._names.get(name)
        if known is None:
            message, remedy = f"'{name[:40]}' is not defined above", "define it in an earlier line"
            raise self.place(line, word).refuse(message, "unknown-name", remedy)
        return known[0]


def is_vm(path: object) -> bool:
    """Whether a file is of this format, by its suffix.

    Examples
    --------
    >>> is_vm("prospero.vm"), is_vm("car.rf")
    (True, False)
    """
    return str(path).lower().endswith(SUFFIX)


def chosen_shape(text: str, shape: str | None = None, variant: str | None = None) -> Shape:
    """The shape of a text; it has no name and no variants to choose by."""
    for what, asked in (("shape", shape), ("variant", variant)):
        if asked is not None:
            message = f"no {what} {asked!r}: a text of this format is one function, without names and letters"
            raise RsymError(message, code=f"unknown-{what}", remedy=f"leave out the {what}")
    return shape_of_lines(text)


def declared(made: Shape) -> ModelFile:
    """What a model file of the language would declare of such a shape: coordinates, and min and max as its system."""
    return ModelFile({}, {}, tuple(symbol.name for symbol in made.coordinates), None, R1, ())


# What is read again is the same object: of equal ones SymPy finds that they are by recursion, sharing forgotten.
@lru_cache(maxsize=8)
def shape_of_lines(text: str) -> Shape:
    """The shape of a text, its last line with the opposite sign: there inside is negative.

    Raises
    ------
    RsymError
        For any text that is none of this format, with line, column and remedy.

    Examples
    --------
    >>> shape_of_lines("a var-x; b square a; c const 1; d sub b c".replace(";", chr(10))).expression
    -(x**2 - 1)
    """
    lines = Instructions(text)
    made = _Nodes(lines)
    if not made.inside[lines.last]:
        where, remedy = str(lines.place(lines.rows[lines.last].line)), "its last line is the function"
        raise RsymError("the function depends on no coordinate", code="constant", where=where, remedy=remedy)
    operation, arguments, _, _ = lines.rows[lines.last]
    expression = made.part(arguments[0]) if operation == "neg" else _opposite(made.part(lines.last))
    return Shape(expression, SPACE if any(row.operation == "var-z" for row in lines.rows) else PLANE)


class _Nodes:
    """The rows that the last one needs, as parts of a formula."""

    def __init__(self, lines: Instructions) -> None:
        self._lines, self._rows = lines, lines.rows
        self._constants: dict[int, Built] = {}
        self._parts: dict[int, sp.Expr] = {}
        self._chains: dict[int, list[sp.Expr]] = {}  # operands of a min or max that is no node yet
        self._folding = FormulaBuilder(operations(R1))
        self.inside: dict[int, frozenset[sp.Symbol]] = {}
        needed = _needed(self._rows, lines.last)
        self._uses = Counter(argument for number in needed for argument in self._rows[number].arguments)
        for number in needed:
            self._add(number, self._rows[number])

    def _add(self, number: int, row: Instruction) -> None:
        operation, arguments, value, line = row
        self.inside[number] = frozenset().union(*(self.inside[argument] for argument in arguments))
        if value is not None:
            self._constants[number] = exact_part(value)
        elif operation in _AXES:
            self._parts[number] = _AXES[operation]
            self.inside[number] = frozenset((_AXES[operation],))
        elif not self.inside[number]:
            self._constants[number] = self._constant(row)
        elif operation in _GATES:
            self._chains[number] = self._chain(row)
        else:
            if operation == "div" and self.part(arguments[1]) is sp.S.Zero:
                raise division_by_zero(self._lines.place(line, 3))
            self._parts[number] = OPERATIONS[operation].node(*map(self.part, arguments))

    def part(self, number: int) -> sp.Expr:
        """The part that a row is."""
        found = self._parts.get(number)
        if found is None:
            found = self._gate(number) if number in self._chains else self._constants[number].outer
            self._parts[number] = found
        return found

    def _constant(self, row: Instruction) -> Built:
        place = self._lines.place(row.line)
        names = [Name(place, str(argument)) for argument in row.arguments]
        formula = OPERATIONS[row.operation].formula(place, *names)
        return self._folding.build(formula, {str(argument): self._constants[argument] for argument in row.arguments})

    def _chain(self, row: Instruction) -> list[sp.Expr]:
        """The operands: those of a like operation that nothing else needs join, for grouping does not matter."""
        for head, other in (row.arguments, row.arguments[::-1]):
            if self._uses[head] == 1 and self._rows[head].operation == row.operation and head in self._chains:
                chain = self._chains.pop(head)
                chain.append(self.part(other))
                return chain
        return [self.part(argument) for argument in row.arguments]

    def _gate(self, number: int) -> sp.Expr:
        kind = _GATES[self._rows[number].operation]
        operands = self._chains.pop(number)
        if type(operands[0]) is kind:  # a fold is flat on its left: one that others need too stands further right
            first = next((k for k, operand in enumerate(operands) if type(operand) is not kind), None)
            if first is None:  # or -max(-u, -v) for min(u, v): copied, its operands could be without end
                opposite = next(one for one in _GATES.values() if one is not kind)
                return _opposite(unevaluated(opposite, *map(_opposite, operands), symbols=self.inside[number]))
            operands.insert(0, operands.pop(first))
        return unevaluated(kind, *operands, symbols=self.inside[number])


def _needed(rows: Sequence[Instruction], last: int) -> list[int]:
    """The rows that one needs, in order."""
    needed = {last}
    for number in range(last, -1, -1):
        if number in needed:
            needed.update(rows[number].arguments)
    return sorted(needed)
