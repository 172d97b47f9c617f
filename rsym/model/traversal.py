"""Walking an expression without recursion, every shared part once.

SymPy's own walks recurse and forget sharing; a nest of five hundred
R-operations, or a definition used in twenty places, must cost what it is.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterator, Mapping, Sequence
from typing import TypeVar

import sympy as sp

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
    return tuple(sorted({part for part in postorder(*expressions) if part.is_Symbol}, key=lambda symbol: symbol.name))
