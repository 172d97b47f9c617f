"""Loops unrolled: a statement for each turn, and for a name that every turn defines anew a name for each of them."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from fractions import Fraction
from itertools import count

from rsym.language.syntax import Assignment, Expression, ForStatement, Name, Number, Position, Statement, Sum, postorder

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
