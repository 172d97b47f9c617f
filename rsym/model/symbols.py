"""Expressions in coordinates and letters: one meaning for one name, and walks that see every shared part once.

Every quantity of a model is real. A symbol written without ``real=True`` is
replaced by the real one of the same name, so that x is x wherever it came from.

SymPy's own walks recurse and forget sharing; a nest of five hundred
R-operations, or a definition used in twenty places, must cost what it is.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Hashable, Iterable, Iterator, Mapping, Sequence
from typing import Any, TypeVar

import sympy as sp

from rsym.errors import RsymError

x: sp.Symbol = sp.Symbol("x", real=True)
y: sp.Symbol = sp.Symbol("y", real=True)
z: sp.Symbol = sp.Symbol("z", real=True)
PLANE = (x, y)
SPACE = (x, y, z)


def real_symbol(name: str) -> sp.Symbol:
    """The real symbol of that name."""
    return sp.Symbol(name, real=True)


def real_replacements(expressions: Iterable[sp.Basic]) -> dict[sp.Symbol, sp.Symbol]:
    """What each symbol becomes so that a name stands for one real symbol.

    A symbol that is already real and alone with its name (a positive letter,
    say) keeps what it knows of itself.
    """
    by_name: dict[str, list[sp.Symbol]] = defaultdict(list)
    for symbol in symbols_of(*expressions):
        by_name[symbol.name].append(symbol)
    return {
        symbol: real_symbol(name)
        for name, alike in by_name.items()
        for symbol in alike
        if len(alike) > 1 or not symbol.is_real
    }


def as_expression(value: Any) -> sp.Expr:
    """A real SymPy expression; text is refused, since turning text into SymPy would run it."""
    try:
        expression = sp.sympify(value, strict=True)
    except (sp.SympifyError, TypeError) as error:
        raise RsymError(
            f"expected a SymPy expression or a number, got {type(value).__name__} {value!r}",
            code="expression",
            remedy="build it from symbols; for text use rsym.loads",
        ) from error
    if not isinstance(expression, sp.Expr):
        raise RsymError(f"expected a real expression, got {type(expression).__name__}", code="expression")
    return expression


T = TypeVar("T")


def postorder(*roots: sp.Basic) -> list[sp.Basic]:
    """Every distinct part of the roots, arguments before their users.

    Examples
    --------
    >>> from rsym import x
    >>> postorder(x + 1)
    [1, x, x + 1]
    """
    order: list[sp.Basic] = []
    seen: set[int] = set()
    stack: list[tuple[sp.Basic, bool]] = [(root, False) for root in reversed(roots)]
    while stack:
        part, arguments_done = stack.pop()
        if id(part) in seen:
            continue
        if arguments_done or not part.args:
            seen.add(id(part))
            order.append(part)
        else:
            stack.append((part, True))
            stack.extend((argument, False) for argument in reversed(part.args) if id(argument) not in seen)
    return order


def with_operands(
    root: T, operands: Callable[[T], Sequence[T]], key: Callable[[T], Hashable] = id
) -> Iterator[tuple[T, Sequence[T]]]:
    """Every distinct item after its operands, and these; what is an operand is for the caller to say.

    Examples
    --------
    >>> list(with_operands(4, lambda number: [number // 2] * (number > 1), key=int))
    [(1, []), (2, [1]), (4, [2])]
    """
    seen: set[Hashable] = set()
    stack = [(root, False)]
    while stack:
        item, ready = stack.pop()
        if key(item) in seen:
            continue
        inside = operands(item)
        if ready or not inside:
            seen.add(key(item))
            yield item, inside
        else:
            stack.append((item, True))
            stack.extend((operand, False) for operand in reversed(inside))


def rebuild(expression: sp.Basic, replace: Callable[[sp.Basic], sp.Basic | None]) -> sp.Basic:
    """Rebuild bottom-up; `replace` returns the new form of a part whose arguments are already new, or None."""
    done: dict[int, sp.Basic] = {}
    for part in postorder(expression):
        arguments = tuple(done[id(argument)] for argument in part.args)
        unchanged = all(new is old for new, old in zip(arguments, part.args, strict=True))
        candidate = part if unchanged else with_arguments(part, arguments)
        # What has collapsed to a symbol, -(-x) to x, has its new form already.
        replacement = replace(candidate) if unchanged or candidate.args else None
        done[id(part)] = candidate if replacement is None else replacement
    return done[id(expression)]


def with_arguments(part: sp.Basic, arguments: tuple[sp.Basic, ...]) -> sp.Basic:
    """The same part over other arguments; SymPy's evaluation of Abs, Min or sin can take for ever."""
    if isinstance(part, sp.Function | sp.Min | sp.Max):
        return part.func(*arguments, evaluate=False)
    return part.func(*arguments)


def substitute(expression: sp.Basic, values: Mapping[sp.Basic, sp.Basic]) -> sp.Basic:
    """Replace symbols, all at once.

    Examples
    --------
    >>> import sympy as sp
    >>> from rsym import x, y, z
    >>> substitute(x**2 + y**2, {y: sp.sqrt(y**2 + z**2)})
    x**2 + y**2 + z**2
    """
    return rebuild(expression, lambda part: values.get(part) if part.is_Symbol else None)


def symbols_of(*expressions: sp.Basic) -> tuple[sp.Symbol, ...]:
    """The distinct symbols, sorted by name."""
    return tuple(sorted(symbols_inside(expressions), key=lambda symbol: symbol.name))


def symbols_inside(parts: Iterable[sp.Basic]) -> frozenset[sp.Symbol]:
    """The symbols of parts: nodes of rsym know theirs, and what is shared is looked at once."""
    found: set[sp.Symbol] = set()
    seen: set[int] = set()
    stack = list(parts)
    while stack:
        part = stack.pop()
        if id(part) in seen:
            continue
        seen.add(id(part))
        if part.is_Symbol:
            found.add(part)
        elif (known := getattr(part, "_free_symbols", None)) is not None:
            found |= known
        else:
            stack.extend(part.args)
    return frozenset(found)
