"""A tape: an expanded program as rows of numbers, for an executor that is compiled once and runs any of them.

A row is a pattern, the register that it fills and the places of its operands. A place is the number of a register,
or for what is the same at all points ~k of the k-th uniform number. A register is used again as soon as its value is
no longer needed, so that what a tape works on stays in the nearest memory.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from rsym.program.operations import OPERATIONS, PRIMITIVES
from rsym.program.program import Program

Rows: TypeAlias = NDArray[np.int32]
# An operation and what its arguments are: operands of the row by their numbers, or patterns again.
Pattern: TypeAlias = tuple[Any, ...]

END = 0  # instead of a pattern, behind the last row
WIDTH = 8  # numbers of a row: pattern, register, operands
# What has no rows: its values are there before.
GIVEN = frozenset({"const", "input", "undefined"})
# Operations that feed each other and nothing else, in one row: no register between them. First the parts of R_0.
# With single operations alone the car's value and gradient took 1.7 times as long.
JOINED: tuple[Pattern, ...] = (
    ("select", 0, 1, ("mul", ("mul", 2, 3), ("div", 4, ("add", 5, 0))), ("add", 0, ("neg", 5))),
    ("select", 0, 1, 2, ("select", 3, 0, 2, 4)),
    ("select", 0, 1, ("mul", 2, 3), ("add", 4, ("neg", 5))),
    ("sqrt", ("add", ("mul", 0, 0), ("mul", 1, 1))),
    ("add", ("add", 0, 1), ("add", 2, 3)),
    ("add", ("mul", 0, 1), ("mul", 2, 3)),
    ("add", ("mul", 0, 1), ("neg", ("mul", 2, 3))),
    ("add", ("mul", 0, 1), ("neg", 2)),
    ("add", ("mul", ("add", 0, 1), 2), 3),
    ("add", 0, ("neg", ("mul", 1, 2))),
    ("mul", ("add", 0, 1), ("add", 2, 3)),
    ("neg", ("mul", 0, ("mul", 1, 2))),
    ("mul", 0, ("div", 1, ("add", 2, 3))),
    ("add", ("mul", 0, 1), 2),
    ("add", ("neg", 0), 1),
    ("add", ("add", 0, 1), 2),
    ("mul", ("mul", 0, 1), 2),
    ("mul", ("add", 0, 1), 2),
    ("mul", ("div", 0, 1), 2),
    ("neg", ("mul", 0, 1)),
    ("neg", ("add", 0, 1)),
    ("neg", ("div", 0, 1)),
    ("div", 0, ("add", 1, 2)),
    ("div", ("mul", 0, 1), 2),
    ("sqrt", ("add", 0, 1)),
)


def patterns() -> tuple[Pattern, ...]:
    """What a row may be, in the order of the numbers, which begin at 1: the single operations, and what is joined."""
    single = [(name, *range(OPERATIONS[name].arity)) for name in sorted(PRIMITIVES - GIVEN)]
    return *single, *JOINED


def operands_of(pattern: Pattern) -> int:
    """How many operands a pattern has.

    Examples
    --------
    >>> operands_of(("add", ("mul", 0, 0), 1))
    2
    """
    return 1 + max(part if isinstance(part, int) else operands_of(part) - 1 for part in pattern[1:])


@dataclass(frozen=True, repr=False)
class Tape:
    """The rows of a program, the last one `END`.

    Attributes
    ----------
    rows : (n + 1, WIDTH) int32
        Pattern, register, operands.
    registers : int
        How many there are; the coordinates lie in the first ones, in their order, before the first row.
    uniform : tuple of int
        The nodes of the program that are the uniform numbers.
    outputs : tuple of int
        The places of the outputs behind the last row.
    names : tuple of str
        What they are called.

    Examples
    --------
    >>> from rsym.program.builder import Builder
    >>> b = Builder(("x", "y"), ("r",))
    >>> value = b.sub(b.input("r"), b.add(b.square(b.input("x")), b.square(b.input("y"))))
    >>> print(tape_of(b.program({"value": value})))
    r2 = add(mul(r0, r0), mul(r1, r1))
    r2 = add(neg(r2), u0)
    value = r2
    """

    rows: Rows
    registers: int
    uniform: tuple[int, ...]
    outputs: tuple[int, ...]
    names: tuple[str, ...]

    def __len__(self) -> int:
        return len(self.rows) - 1

    def __str__(self) -> str:
        known = patterns()
        lines = [f"r{row[1]} = {_text(known[row[0] - 1], row[2:])}" for row in self.rows[:-1].tolist()]
        ends = zip(self.names, self.outputs, strict=True)
        return "\n".join([*lines, *(f"{name} = {_place(place)}" for name, place in ends)])


def _text(pattern: Pattern, operands: Sequence[int]) -> str:
    parts = [_place(operands[part]) if isinstance(part, int) else _text(part, operands) for part in pattern[1:]]
    return f"{pattern[0]}({', '.join(parts)})"


def _place(number: int) -> str:
    return f"r{number}" if number >= 0 else f"u{~number}"


def tape_of(program: Program) -> Tape:
    """The tape of an expanded program.

    It leaves the coordinates as they are, and each output has a register of its own: so it may be part of another.
    """
    return _Making(program).tape()


class _Making:
    """Which pattern ends at each node, then the registers."""

    def __init__(self, program: Program) -> None:
        self.program = program
        self.uses = [0] * len(program.nodes)
        for number, node in enumerate(program.nodes):
            for argument in node.arguments if not program.uniform[number] else ():
                self.uses[argument] += 1
        for _, number in program.outputs:
            self.uses[number] += 2
        every = list(enumerate(patterns(), 1))
        self.candidates: dict[str, list[tuple[int, Pattern]]] = {}
        for number, pattern in sorted(every, key=lambda one: one[0] <= len(every) - len(JOINED)):
            self.candidates.setdefault(pattern[0], []).append((number, pattern))

    def tape(self) -> Tape:
        """The rows in the order of the program."""
        program, nodes = self.program, self.program.nodes
        chosen: dict[int, tuple[int, list[int]]] = {}
        inside: set[int] = set()
        for number in range(len(nodes) - 1, -1, -1):
            if not program.uniform[number] and nodes[number].operation not in GIVEN and number not in inside:
                chosen[number] = self._pattern(number, inside)
        last = dict.fromkeys((number for _, number in program.outputs), len(nodes))  # by number: the last that needs it
        for number, (_, operands) in chosen.items():
            for operand in operands:
                last[operand] = max(number, last.get(operand, 0))
        last.update((number, len(nodes)) for number, node in enumerate(nodes) if node.operation == "input")
        uniform: dict[int, int] = {}
        given = {name: register for register, name in enumerate(program.coordinates)}
        places = {
            number: given[str(node.data)]
            for number, node in enumerate(nodes)
            if node.operation == "input" and not program.uniform[number]
        }

        def place(number: int) -> int:
            return ~uniform.setdefault(number, len(uniform)) if program.uniform[number] else places[number]

        rows: list[tuple[int, ...]] = []
        free: list[int] = []
        count = len(program.coordinates)
        for number in sorted(chosen):
            pattern, operands = chosen[number]
            row = [place(operand) for operand in operands]
            free += {places[o] for o in operands if not program.uniform[o] and last[o] == number}
            if not free:
                free.append(count)
                count += 1
            places[number] = free.pop()
            rows.append((pattern, places[number], *row, *[0] * (WIDTH - 2 - len(row))))
        ends = [place(number) for _, number in program.outputs]
        taken = set(range(len(program.coordinates)))
        for k, end in enumerate(ends):
            if end < 0 or end in taken:
                # The smaller of two that are one is this.
                rows.append((self.candidates["min"][0][0], count, end, end, *[0] * (WIDTH - 4)))
                ends[k], count = count, count + 1
            taken.add(ends[k])
        made = np.array([*rows, (END, *[0] * (WIDTH - 1))], np.int32)
        return Tape(made, count, tuple(uniform), tuple(ends), tuple(name for name, _ in program.outputs))

    def _pattern(self, number: int, inside: set[int]) -> tuple[int, list[int]]:
        """The first pattern that ends at a node, and its operands; what lies inside of it is noted."""
        for candidate, pattern in self.candidates[self.program.nodes[number].operation]:
            for operands, within in self._matches(pattern, number, {}, frozenset()):
                inside |= within
                return candidate, [operands[k] for k in range(len(operands))]
        raise AssertionError(number)

    def _matches(
        self, pattern: Pattern, number: int, operands: dict[int, int], within: frozenset[int]
    ) -> Iterator[tuple[dict[int, int], frozenset[int]]]:
        """The ways in which a pattern ends at a node; sums and products are the same exchanged."""
        operation, arguments, _ = self.program.nodes[number]
        if operation == pattern[0]:
            yield from self._matching(pattern[1:], arguments, operands, within)
            if operation in ("add", "mul") and arguments[0] != arguments[1] and len(set(map(repr, pattern[1:]))) > 1:
                yield from self._matching(pattern[1:], arguments[::-1], operands, within)

    def _matching(
        self, parts: Sequence[Any], arguments: Sequence[int], operands: dict[int, int], within: frozenset[int]
    ) -> Iterator[tuple[dict[int, int], frozenset[int]]]:
        """The ways in which arguments are the first, second, ... part of a pattern."""
        if not parts:
            yield operands, within
            return
        part, argument = parts[0], arguments[0]
        if isinstance(part, int):
            if operands.get(part, argument) == argument:
                yield from self._matching(parts[1:], arguments[1:], {**operands, part: argument}, within)
        elif self.uses[argument] == 1 and not self.program.uniform[argument]:
            for found, inner in self._matches(part, argument, operands, within | {argument}):
                yield from self._matching(parts[1:], arguments[1:], found, inner)
