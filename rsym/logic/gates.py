"""Minima and maxima in the order in which they are evaluated: what is made of leaves by two operands at a time."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from typing import NamedTuple, Protocol, TypeVar

from rsym.program.operations import CONJUNCTIONS, DISJUNCTIONS


class Gate(NamedTuple):
    """A min or max of two operands: the number of a leaf, or the number of leaves plus that of an earlier gate."""

    operation: str
    first: int
    second: int


class OfTwo(Protocol):
    """What joins two operands by their numbers."""

    @property
    def first(self) -> int:
        """The number of one."""

    @property
    def second(self) -> int:
        """The number of the other."""


T = TypeVar("T")
G = TypeVar("G", bound=OfTwo)


def gate_of(operation: str, sign: int = 1) -> str:
    """The "min" or "max" that an operation times 1 or -1 is for the sign; empty if it is none.

    Examples
    --------
    >>> gate_of("rp_conjunction"), gate_of("rp_conjunction", -1), gate_of("add")
    ('min', 'max', '')
    """
    if operation in CONJUNCTIONS:
        return "min" if sign > 0 else "max"
    return ("max" if sign > 0 else "min") if operation in DISJUNCTIONS else ""


def through(gates: Iterable[G], leaves: Iterable[T], join: Callable[[G, T, T], T]) -> list[T]:
    """The leaves, and what each gate makes of its operands.

    Examples
    --------
    >>> rules = {"min": min, "max": max}
    >>> through([Gate("min", 0, 1), Gate("max", 3, 2)], [1, 5, 2], lambda gate, a, b: rules[gate.operation](a, b))
    [1, 5, 2, 1, 2]
    """
    parts = list(leaves)
    for gate in gates:
        parts.append(join(gate, parts[gate.first], parts[gate.second]))
    return parts


def balanced(gates: Sequence[Gate], leaves: int) -> tuple[Gate, ...]:
    """The same function of so many leaves, a chain of one operation as a tree: what does not matter lies in subtrees.

    Examples
    --------
    >>> chain = [Gate("max", 0, 1), Gate("max", 4, 2), Gate("max", 5, 3)]
    >>> [(first, second) for _, first, second in balanced(chain, 4)]
    [(0, 1), (2, 3), (4, 5)]
    """
    uses = Counter(operand for gate in gates for operand in gate[1:])
    made: list[Gate] = []

    def joined(operation: str, operands: Sequence[int]) -> int:
        row = list(operands)
        while len(row) > 1:
            pairs = [row[k : k + 2] for k in range(0, len(row), 2)]
            row = []
            for pair in pairs:
                if len(pair) == 2:
                    made.append(Gate(operation, *pair))
                row.append(pair[0] if len(pair) == 1 else leaves + len(made) - 1)
        return row[0]

    # What a gate of a chain joins, until something else needs it.
    chains: dict[int, list[int]] = {}
    places = list(range(leaves))
    for number, (operation, *operands) in enumerate(gates, leaves):
        links: list[int] = []
        for operand in operands:
            inner = gates[operand - leaves] if operand >= leaves else None
            if inner is not None and inner.operation == operation and uses[operand] == 1:
                links += chains.pop(operand)
            else:
                links.append(operand)
        chains[number] = links
        places.append(-1)

    def place(number: int) -> int:
        """Where an operand is, its chain made after those of its operands."""
        stack = [number]
        while stack:
            top = stack[-1]
            if places[top] >= 0:
                stack.pop()
                continue
            missing = [operand for operand in chains[top] if places[operand] < 0]
            if missing:
                stack += missing
            else:
                places[top] = joined(gates[top - leaves].operation, [places[operand] for operand in chains[top]])
        return places[number]

    if gates:
        place(leaves + len(gates) - 1)
    return tuple(made)
