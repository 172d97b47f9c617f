"""The formation of a body: leaves joined by gates, and which leaves can be the boundary on each of many boxes.

As in the sign form a conjunction is a min, a disjunction a max, positive factors drop; a choice between two
formulas is a gate of its own. Blends stay whole: their fillets are no edges.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from rsym.arrays import Flags, Floats
from rsym.logic.gates import Gate, through
from rsym.logic.kleene import Formula, Literal, joined, without_idle
from rsym.program.builder import Builder

# What joins the leaves of a box: a min or a max of two, anything else, or a leaf and its negative, zero at most.
MIN, MAX, OPEN, DOUBLE = 1, 2, 3, 4


class Fork(NamedTuple):
    """The first of two operands, numbered as those of gates, where a test is positive, the second where it is not."""

    first: int
    second: int
    test: int


@dataclass(frozen=True)
class Formation:
    """Leaves and tests as nodes of a builder, and the gates that join them; the last gate has the sign of omega.

    `definitions` are the leaves as they are written; of a leaf that is a factor of some, `origins` are these.
    """

    builder: Builder
    leaves: tuple[int, ...]
    gates: tuple[Gate | Fork, ...]
    tests: tuple[int, ...] = ()
    definitions: tuple[int, ...] = ()
    origins: Mapping[int, Sequence[int]] = field(default_factory=dict)

    @cached_property
    def value(self) -> int:
        """The node of the last gate, which has the sign of omega wherever omega is defined."""
        b, zero = self.builder, self.builder.const(0)

        def join(gate: Gate | Fork, first: int, second: int) -> int:
            if isinstance(gate, Fork):
                return b.select(self.tests[gate.test], zero, first, second)
            return b.make(gate.operation, first, second)

        return through(self.gates, self.leaves, join)[-1]

    @cached_property
    def _literals(self) -> list[Literal]:
        """Each leaf as one of the first of its kind, or its negative."""
        places: dict[int, Literal] = {}
        for place, leaf in enumerate(self.leaves):
            places.setdefault(leaf, Literal(place))
            places.setdefault(self.builder.neg(leaf), Literal(place, -1))
        return [places[leaf] for leaf in self.leaves]

    def logic(self, signs: Sequence[int]) -> Formula | None:
        """The sign of omega by those leaves, by place, on which it depends; None where a choice is open.

        `signs` are those of the leaves and then of the tests, 0 where they are not known.
        """

        def join(gate: Gate | Fork, first: Formula | None, second: Formula | None) -> Formula | None:
            if first is None or second is None:
                return None
            if isinstance(gate, Gate):
                return joined(gate.operation, first, second)
            chosen = signs[len(self.leaves) + gate.test]
            return None if not chosen and first != second else first if chosen >= 0 else second

        known: list[Formula | None] = [a or b for a, b in zip(signs, self._literals, strict=False)]
        formula = through(self.gates, known, join)[-1]
        return None if formula is None else without_idle(formula)

    def alive(self, low: Floats, high: Floats, tests: tuple[Floats, Floats]) -> tuple[Flags, NDArray[np.int8]]:
        """Which leaves can be zero on the boundary in each box, and what joins them.

        Parameters
        ----------
        low, high : (leaves, n) float64
            Bounds of the leaves over the boxes.
        tests : two (tests, n) float64
            Bounds of the tests.

        Returns
        -------
        (leaves, n) bool, (n,) int8
            The second is MIN or MAX where two leaves are alive that one such gate joins, 0 where none or one is, OPEN
            where more can be said only by looking closer: a choice may change the sign where no leaf is zero.
        """
        leaf = np.eye(len(self.leaves), dtype=bool)[:, :, None]
        parts = [
            _Part(a, b, own & (a <= 0) & (b >= 0), np.zeros(a.shape, np.int8), np.zeros(a.shape, bool))
            for a, b, own in zip(low, high, leaf, strict=True)
        ]

        def join(gate: Gate | Fork, first: _Part, second: _Part) -> _Part:
            if isinstance(gate, Fork):
                return _choice(first, second, tests[0][gate.test], tests[1][gate.test])
            return _smaller(first, second) if gate.operation == "min" else _larger(first, second)

        whole = through(self.gates, parts, join)[-1]
        return whole.alive, np.where(whole.forked, OPEN, whole.joined).astype(np.int8)


class _Part(NamedTuple):
    """Bounds of a gate, the leaves alive in it (leaves, n), what joins them, and whether a choice is open."""

    low: Floats
    high: Floats
    alive: Flags
    joined: NDArray[np.int8]
    forked: Flags


def _smaller(f: _Part, g: _Part) -> _Part:
    low, high = np.minimum(f.low, g.low), np.minimum(f.high, g.high)
    first, second = (g.low > 0) | (f.high < g.low), (f.low > 0) | (g.high < f.low)
    return _joined(f, g, low, high, (first, second), MIN)


def _larger(f: _Part, g: _Part) -> _Part:
    low, high = np.maximum(f.low, g.low), np.maximum(f.high, g.high)
    first, second = (g.high < 0) | (f.low > g.high), (f.high < 0) | (g.low > f.high)
    return _joined(f, g, low, high, (first, second), MAX)


def _joined(f: _Part, g: _Part, low: Floats, high: Floats, only: tuple[Flags, Flags], operation: int) -> _Part:
    """Of both operands, or of one where the other does not count."""
    undecided = (low <= 0) & (high >= 0)
    both = ~only[0] & ~only[1]
    alive = (f.alive & ~only[1] | g.alive & ~only[0]) & undecided
    plain = (f.joined == 0) & (g.joined == 0)
    joined = np.where(both, np.where(plain, operation, OPEN), np.where(only[0], f.joined, g.joined))
    joined = np.where(undecided & (alive.sum(axis=0) > 1), joined, 0).astype(np.int8)
    return _Part(low, high, alive, joined, (f.forked & ~only[1] | g.forked & ~only[0]) & undecided)


def _choice(f: _Part, g: _Part, low: Floats, high: Floats) -> _Part:
    """The first where the test is positive, the second where it is not."""
    first, second = low > 0, high < 0
    bounds = (
        np.where(first, f.low, np.where(second, g.low, np.minimum(f.low, g.low))),
        np.where(first, f.high, np.where(second, g.high, np.maximum(f.high, g.high))),
    )
    undecided = (bounds[0] <= 0) & (bounds[1] >= 0)
    alive = (f.alive & ~second | g.alive & ~first) & undecided
    joined = np.where(first, f.joined, g.joined)
    forked = np.where(first, f.forked, second & g.forked | ~second) & undecided
    return _Part(*bounds, alive, np.where(alive.any(axis=0), joined, 0).astype(np.int8), forked)
