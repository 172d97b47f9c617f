"""Gates: what R-operations are for the sign, a min or a max of two, and formulas of gates evaluated in order."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import NamedTuple, Protocol, TypeVar

from rsym.program.operations import CONJUNCTIONS, DISJUNCTIONS


class Gate(NamedTuple):
    """A min or max of two operands: the number of a leaf, or the number of leaves plus that of an earlier gate."""

    operation: str
    first: int
    second: int


class Operand(NamedTuple):
    """A gate or a leaf by its number among its kind."""

    is_gate: bool
    number: int

    def after(self, leaves: int) -> int:
        """The number among leaves and gates together."""
        return self.number + leaves * self.is_gate


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
