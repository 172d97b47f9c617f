"""Tokens to statements; loops are unrolled.

A loop is a statement for each turn, and for a name that every turn defines anew a name for each of them.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from fractions import Fraction
from itertools import count

from rsym.language.conditions import conditioned, part_named
from rsym.language.equations import sides
from rsym.language.expressions import ExpressionParser
from rsym.language.model import closed_number
from rsym.language.scanner import UNSUPPORTED, Cursor, Token, scan
from rsym.language.syntax import (
    KEYWORDS,
    Assignment,
    BoundsStatement,
    CoordinatesStatement,
    EquationStatement,
    Expression,
    ForStatement,
    LetterStatement,
    Name,
    Number,
    PartStatement,
    Position,
    Range,
    Statement,
    Sum,
    SystemStatement,
    VariantStatement,
    VerbatimStatement,
    postorder,
)

MOST_LOOPS = 8  # in one another


def parse(text: str, notes: list[str] | None = None) -> tuple[Statement, ...]:
    """The statements of a model text, loops unrolled; what was passed over is added to `notes`.

    Examples
    --------
    >>> [type(statement).__name__ for statement in parse("letter r = 1; omega = r - x^2 - y^2")]
    ['LetterStatement', 'Assignment']
    """
    parser = _StatementParser(Cursor(scan(text, notes)))
    statements: list[Statement] = []
    while statement := parser.next_statement():
        statements.append(statement)
    return unrolled(tuple(statements), lambda end: Fraction(closed_number(end)))


class _StatementParser:
    """One method for each kind of statement."""

    def __init__(self, cursor: Cursor) -> None:
        self._cursor = cursor
        self._expressions = ExpressionParser(cursor)
        self._kinds: dict[str, Callable[[Token], Statement]] = {
            "letter": self._letter,
            "variant": self._variant,
            "coordinates": self._coordinates,
            "bounds": self._bounds,
            "system": self._system,
            "part": self._part,
            "equation": self._equation,
            "on": lambda word: conditioned(self._cursor, word.place, part_named(self._cursor)),
            "verbatim": lambda word: VerbatimStatement(word.place),
            "for": self._for,
        }
        self._loops = 0

    def next_statement(self) -> Statement | None:
        """The next statement, or None when the text is over."""
        while self._cursor.statement_over:
            if self._cursor.at_end:
                return None
            self._cursor.read()
        word = self._cursor.expect_kind(
            "name",
            "a statement, which begins with a word",
            "write name = expression; a formula goes on in the next line only after an operator, a comma or '('",
        )
        assigns = self._cursor.token.text == "="
        if word.text in UNSUPPORTED and not assigns:
            message = f"{word.shown} of MATLAB is no statement of a model"
            raise word.place.refuse(message, "matlab", "a loop over numbers is: for k = 0:5 ... end")
        statement = self._assignment(word) if assigns else self._kinds.get(word.text, self._assignment)(word)
        if not self._cursor.statement_over:
            raise self._cursor.unexpected(
                "the end of the statement", "write * for a product, and one statement per line or a ';' between two"
            )
        return statement

    def _assignment(self, word: Token) -> Statement:
        keywords = ", ".join((*KEYWORDS[:-1], "part", "for", "equation", "on"))
        self._cursor.expect("=", f"write {word.text} = expression, or begin with one of {keywords}")
        return Assignment(word.place, word.text, self._expressions.expression(), self._doc())

    def _letter(self, word: Token) -> Statement:
        name = self._name("a letter's name", "for example: letter a = 5 in [1, 10]")
        self._cursor.expect("=", "every letter needs a value, for example: letter a = 5")
        value = self._expressions.expression()
        interval = self._interval() if self._cursor.accept("in") else None
        unit = ""
        if self._cursor.token.text == "unit":
            self._cursor.read()
            unit = self._cursor.expect_kind("text", "a unit in quotation marks", 'for example: unit "mm"').quoted
        return LetterStatement(name.place, name.name, value, interval, self._doc(), unit)

    def _part(self, word: Token) -> Statement:
        example = 'for example: part "wheel" = f1'
        name = self._cursor.expect_kind("text", "the name of a part in quotation marks", example)
        if not name.quoted.strip():
            raise name.place.refuse("a part needs a name", "part-name", example)
        self._cursor.expect("=", example)
        return PartStatement(name.place, name.quoted, self._expressions.expression())

    def _equation(self, word: Token) -> Statement:
        start = self._cursor.mark()
        left, right = sides(self._cursor)
        return EquationStatement(word.place, left, right, self._cursor.written(start))

    def _for(self, word: Token) -> Statement:
        """A loop up to its end, in which there may be others."""
        example = "for example: for k = 0:5, w = rfOR(w, 1 - (x - k)^2); end"
        name = self._name("the counter of the loop", example)
        if name.name in ("x", "y", "z"):
            raise name.place.refuse(f"'{name.name}' is a coordinate, no counter", "loop", example)
        self._cursor.expect("=", example)
        run = [self._expressions.expression()]
        while self._cursor.accept(":"):
            run.append(self._expressions.expression())
        if not 2 <= len(run) <= 3:
            raise name.place.refuse("a loop runs over numbers low:high or low:step:high", "loop", example)
        self._cursor.accept(",")
        self._loops += 1
        if self._loops > MOST_LOOPS:
            raise word.place.refuse(f"more than {MOST_LOOPS} loops in one another", "too-deep", "take fewer")
        body: list[Statement] = []
        while True:
            while self._cursor.statement_over and not self._cursor.at_end:
                self._cursor.read()
            if self._cursor.at_end:
                raise word.place.refuse("this loop has no end", "unclosed", "write end behind its last statement")
            if self._cursor.token.text == "end" and self._cursor.following.text != "=":
                self._cursor.read()
                break
            statement = self.next_statement()
            assert statement is not None
            body.append(statement)
        self._loops -= 1
        return ForStatement(word.place, name.name, tuple(run), tuple(body))

    def _variant(self, word: Token) -> Statement:
        example = "for example: variant b: a1 = 9, b1 = 4"
        name = self._name("a variant's name", example)
        self._cursor.expect(":", example)
        values = [self._variant_value(example)]
        while self._cursor.accept(","):
            if comma := self._cursor.decimal_comma():
                raise comma
            values.append(self._variant_value(example))
        return VariantStatement(name.place, name.name, tuple(values))

    def _variant_value(self, example: str) -> tuple[Name, Expression]:
        name = self._name("a letter", example)
        self._cursor.expect("=", example)
        return name, self._expressions.expression()

    def _coordinates(self, word: Token) -> Statement:
        names = []
        while self._cursor.token.kind == "name":
            names.append(self._name("a coordinate", "for example: coordinates x y z"))
        return CoordinatesStatement(word.place, tuple(names))

    def _bounds(self, word: Token) -> Statement:
        intervals = []
        while self._cursor.token.kind == "name":
            intervals.append((self._name("a coordinate", "for example: bounds x [-8, 8]"), self._interval()))
        return BoundsStatement(word.place, tuple(intervals))

    def _system(self, word: Token) -> Statement:
        name = self._name("the name of an R-system", "for example: system R0")
        parameter = None if self._cursor.statement_over else self._expressions.expression()
        return SystemStatement(name.place, name.name, parameter)

    def _interval(self) -> Range:
        start = self._cursor.mark()
        opening = self._cursor.expect("[", "a range is written [low, high]")
        low = self._expressions.expression()
        self._cursor.expect(",", "a range has two ends: [low, high]")
        high = self._expressions.expression()
        if self._cursor.token.text == ",":
            raise self._cursor.decimal_comma(start) or self._cursor.unexpected("']'", "a range has two ends")
        self._cursor.close(opening, "]")
        return Range(opening.place, low, high)

    def _doc(self) -> str:
        return self._cursor.read().quoted if self._cursor.token.kind == "text" else ""

    def _name(self, what: str, remedy: str) -> Name:
        token = self._cursor.expect_kind("name", what, remedy)
        return Name(token.place, token.text)


MOST_STATEMENTS = 1000  # that loops may make

Value = Callable[[Expression], Fraction]


def unrolled(statements: tuple[Statement, ...], value: Value) -> tuple[Statement, ...]:
    """The statements without loops; `value` is that of a number that is written out.

    Raises
    ------
    RsymError
        For a loop without end or with anything but formulas in it, at its place.

    Examples
    --------
    >>> from rsym.language.parser import parse
    >>> [statement.name for statement in parse("w = -1; for k = 0:2, w = rfOR(w, 1 - (x - k)^2); end")]
    ['w_1', 'w_2', 'w_3', 'w']
    """
    if not any(isinstance(statement, ForStatement) for statement in statements):
        return statements
    budget = iter(range(MOST_STATEMENTS))
    flat = [one for statement in statements for one in _turns(statement, {}, value, budget)]
    return tuple(_renamed(flat))


def _turns(
    statement: Statement, values: Mapping[str, Expression], value: Value, budget: Iterator[int]
) -> Iterator[tuple[Statement, bool]]:
    """The statements that one makes, and whether they are of a loop."""
    if isinstance(statement, ForStatement):
        for number in _run(statement, values, value):
            given = {**values, statement.name: _written(number, statement.place)}
            for inner in statement.body:
                yield from _turns(inner, given, value, budget)
    elif values:
        if not isinstance(statement, Assignment):
            raise statement.place.refuse("a loop holds formulas only", "loop", "move this statement out of the loop")
        if statement.name in values:
            raise statement.place.refuse(f"'{statement.name}' counts the turns", "loop", "choose another name")
        if next(budget, None) is None:
            raise statement.place.refuse(f"loops make more than {MOST_STATEMENTS} formulas", "too-large", "take fewer")
        yield replace(statement, value=substituted(statement.value, values)), True
    else:
        yield statement, False


def _run(loop: ForStatement, values: Mapping[str, Expression], value: Value) -> Iterator[Fraction]:
    """The values of the counter, exact."""
    numbers = [value(substituted(end, values)) for end in loop.run]
    low, step, high = numbers if len(numbers) == 3 else (numbers[0], Fraction(1), numbers[1])
    if step == 0 or (high - low) / step >= MOST_STATEMENTS:
        message = "the step is 0" if step == 0 else f"a loop of more than {MOST_STATEMENTS} turns"
        raise loop.place.refuse(message, "loop", "for example: for k = 0:5")
    return (low + k * step for k in range(int((high - low) // step) + 1))


def _written(number: Fraction, place: Position) -> Expression:
    size = Number(place, abs(number))
    return size if number >= 0 else Sum(place, (-1,), (size,))


def substituted(expression: Expression, values: Mapping[str, Expression]) -> Expression:
    """The expression with others in the place of names."""
    done: list[Expression] = []
    for node in postorder(expression):
        first = len(done) - len(node.parts)
        parts = tuple(done[first:])
        if isinstance(node, Name):
            done.append(values.get(node.name, node))
        else:
            done[first:] = [replace(node, parts=parts) if parts else node]
    return done[0]


def _renamed(flat: list[tuple[Statement, bool]]) -> Iterator[Statement]:
    """Each name that a loop defines again under a name of its own; the last keeps the name."""
    times = Counter(one.name for one, _ in flat if isinstance(one, Assignment))
    again = {one.name for one, looped in flat if looped and isinstance(one, Assignment) and times[one.name] > 1}
    taken = {getattr(one, "name", "") for one, _ in flat}
    seen: Counter[str] = Counter()
    current: dict[str, Expression] = {}
    for statement, _ in flat:
        if not isinstance(statement, Assignment):
            yield statement
            continue
        value, name = substituted(statement.value, current), statement.name
        if name in again:
            seen[name] += 1
            if seen[name] < times[name]:
                name = next(word for k in count(seen[name]) if (word := f"{statement.name}_{k}") not in taken)
                taken.add(name)
            current[statement.name] = Name(statement.place, name)
        yield replace(statement, name=name, value=value, inner=name != statement.name)
