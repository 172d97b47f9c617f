"""The table of operations: one row each, and the sets that follow from the rows.

The plain meanings are the truth: the interpreter evaluates with them, every backend is tested against them, and every
kernel is checked against them when it is built.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Set
from typing import Any, TypeVar

from rsym.errors import RsymError
from rsym.program.arithmetic import ARITHMETIC
from rsym.program.elementary import ELEMENTARY, SMOOTH_STEPS, STEPS
from rsym.program.joining import JOINING
from rsym.program.powers import SIGNED_POWERS
from rsym.program.r0 import R0
from rsym.program.r0m import R0M
from rsym.program.r_alpha import R_ALPHA
from rsym.program.row import Operation
from rsym.program.rp import RP

Value = TypeVar("Value")


class Rows(dict[str, Operation]):
    """Rows by name; `generation` counts the changes, so that what follows from the rows is worked out once."""

    generation = 0

    def __setitem__(self, name: str, row: Operation) -> None:
        self.generation += 1
        super().__setitem__(name, row)

    def __delitem__(self, name: str) -> None:
        self.generation += 1
        super().__delitem__(name)


OPERATIONS = Rows(
    {**ARITHMETIC, **ELEMENTARY, **R0, **R_ALPHA, **R0M, **RP, **JOINING, **SIGNED_POWERS, **SMOOTH_STEPS, **STEPS},
)


class Those(Set[str]):
    """The names of the operations of which something is true, now: rows may be added.

    Examples
    --------
    >>> "min" in BRANCHING, "min" in BRANCHING - {"min"}, "exp" in BRANCHING | NONNEGATIVE
    (True, False, True)
    """

    def __init__(self, test: Callable[[str], bool]) -> None:
        self._test = test
        self._generation = -1
        self._names: frozenset[str] = frozenset()

    def _now(self) -> frozenset[str]:
        if self._generation != OPERATIONS.generation:
            self._generation = OPERATIONS.generation
            self._names = frozenset(name for name in OPERATIONS if self._test(name))
        return self._names

    def __contains__(self, name: object) -> bool:
        return name in self._now()

    def __iter__(self) -> Iterator[str]:
        return iter(self._now())

    def __len__(self) -> int:
        return len(self._now())

    __hash__ = object.__hash__  # by identity, as the keys of what is kept of nodes need it, and fast

    def __or__(self, other: Set[Any]) -> Those:
        return Those(lambda name: name in self or name in other)

    def __sub__(self, other: Set[Any]) -> Those:
        return Those(lambda name: name in self and name not in other)


def those(test: Callable[[Operation], bool]) -> Those:
    """The names of the operations whose rows pass a test."""
    return Those(lambda name: test(OPERATIONS[name]))


class Cells(Mapping[str, Value]):
    """What the rows say in one respect, by name; rows that say nothing are left out.

    Examples
    --------
    >>> meanings = Cells(lambda name, row: row.texts.get("c"))
    >>> meanings["add"], "trimming" in meanings
    ('{} + {}', False)
    """

    def __init__(self, cell: Callable[[str, Operation], Value | None]) -> None:
        self._cell = cell

    def __getitem__(self, name: str) -> Value:
        value = self._cell(name, OPERATIONS[name])
        if value is None:
            raise KeyError(name)
        return value

    def __iter__(self) -> Iterator[str]:
        return (name for name, row in OPERATIONS.items() if self._cell(name, row) is not None)

    def __len__(self) -> int:
        return sum(1 for _ in self)


def register(rows: Mapping[str, Operation]) -> None:
    """Add the rows of new operations.

    Raises
    ------
    RsymError
        For a name that is taken.
    """
    for name in rows:
        if name in OPERATIONS:
            raise RsymError(f"there is an operation {name!r} already", code="operation", remedy="choose another name")
    for name, row in rows.items():
        OPERATIONS[name] = row


# What a backend must be able to do; expansion rewrites everything else into these.
PRIMITIVES = those(lambda row: row.expansion is None)
NONNEGATIVE = those(lambda row: row.nonnegative)
BRANCHING = those(lambda row: row.branching)
JUMPING = those(lambda row: row.jumping)
TORN = those(lambda row: row.torn)
CHOOSING = BRANCHING - {"sign"}  # equal to one of their arguments or to its opposite
ENTIRE = those(lambda row: row.analytic == ())
SMOOTH = those(lambda row: row.smooth)
KINKED = those(lambda row: row.kinked)
HOMOGENEOUS = those(lambda row: row.homogeneous)
SYMMETRIC = those(lambda row: row.symmetric)
CONJUNCTIONS = those(lambda row: row.logic == "and")
DISJUNCTIONS = those(lambda row: row.logic == "or")
LOGICAL = those(lambda row: bool(row.logic))
POWERS = frozenset(SIGNED_POWERS)
PARTIAL = those(lambda row: not row.total)
THICK = those(lambda row: not row.total and not row.thin)
