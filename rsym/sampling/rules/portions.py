"""The rule of integration in some cells of a grid."""

from __future__ import annotations

import math
import time
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from rsym.arrays import Floats, Ints
from rsym.sampling.rules.bases import PlaneBases
from rsym.sampling.rules.columns import CellRule, LeftOpen, rules_together, tensor_rule, tensor_rules
from rsym.sampling.rules.deadlines import require_time
from rsym.sampling.rules.division import (
    INSIDE,
    OPEN,
    CutPieces,
    Divided,
    Grading,
    Limits,
    close,
    divide,
    together_at_once,
    undivided,
)
from rsym.sampling.rules.sampled import sampled_rule
from rsym.sampling.rules.space import SpaceBases

SAMPLED_AT_ONCE = 512  # of those of which nothing is proved
BOXES = 2**17  # of leaves, that are looked at at once where only boxes tell
# Sides that run along an axis but for 1e-4 lose up to 4e-12 of their length where leaves may be 3e4 times as steep, at
# 1e3 nothing; next to cusps 2e-6 of a length is left open then, and 7e-5 at 1e3. In space the cells along a spike grow
# in number with the cube root of their fineness: of 64 in a cell 2e-6 of its surface is left open, of 128 2e-7.
LIMITS = {2: Limits(6, 44, 2.0, 256, 3e4), 3: Limits(5, 24, 3.0, 128, turning=2.0)}


@dataclass(frozen=True)
class CellGrid:
    """Cubical cells; cell (i, j) has the number i*counts[1] + j.

    Attributes
    ----------
    lower : (dim,)
        The corner of the first cell.
    size : float
        The side of a cell.
    counts : tuple of int
        Cells along each axis.

    Examples
    --------
    >>> grid = CellGrid(np.array([0.0, 1.0]), 0.5, (4, 3))
    >>> grid.corners(np.array([4]))
    (array([[0.5],
           [1.5]]), array([[1.],
           [2.]]))
    """

    lower: Floats
    size: float
    counts: tuple[int, ...]

    def corners(self, cells: Ints) -> tuple[Floats, Floats]:
        """The lower and the upper corners (dim, n) of cells; neighbours share them to the last bit."""
        index = np.array(np.unravel_index(cells, self.counts))
        return self.lower[:, None] + index * self.size, self.lower[:, None] + (index + 1) * self.size


@dataclass(frozen=True)
class RulePortion:
    """The rule in some cells, those of them that are full, and what is not resolved."""

    rule: CellRule
    full: Ints
    unresolved: LeftOpen


def boxed_portion(functions: Any, grid: CellGrid, until: float) -> RulePortion:
    """What boxes alone tell by a time: all that is proved inside, and of what is left open a half; of boundary nothing.

    The squares of coordinates are summed exactly on boxes, so that sums of them bound what is open.
    """
    cells, dimension = np.arange(math.prod(grid.counts)), functions.dimension
    pieces = undivided(*grid.corners(cells), cells, functions.count)
    rules: list[CellRule] = []
    while True:
        value, gradient = functions.enclose(pieces.leaf, pieces.lower[:, pieces.piece], pieces.upper[:, pieces.piece])
        pieces = replace(pieces, gradient=gradient)
        signs, verdict, kept = functions.judge(pieces, value)
        full = verdict == INSIDE
        rules.append(tensor_rule(pieces.lower[:, full], pieces.upper[:, full], pieces.owner[full], 2))
        pieces = replace(pieces, signs=signs).chosen(verdict == OPEN, kept)
        if not len(pieces) or len(pieces.leaf) << dimension > BOXES or time.monotonic() > until:
            break
        pieces = pieces.halved()
    half = tensor_rule(pieces.lower, pieces.upper, pieces.owner, 2)
    half = replace(half, weights=half.weights / 2)
    return RulePortion(rules_together([*rules, half]), cells[:0], LeftOpen(float(half.weights.sum()), math.inf))


@dataclass(frozen=True)
class DividedCells:
    """Some cells of a grid, divided towards points near: what is the same for rules of any order.

    Attributes
    ----------
    found : Divided
    pieces : list of (CutPieces, bases)
        Those that have a height, together, and what a rule on them is made of.
    sampled : list of CellRule
        The rules where nothing is proved.
    unresolved : LeftOpen
        What is not resolved, of any rule.
    """

    functions: Any
    grid: CellGrid
    cells: Ints
    near: Grading
    until: float
    found: Divided
    pieces: list[tuple[CutPieces, PlaneBases | SpaceBases]]
    sampled: list[CellRule]
    unresolved: LeftOpen

    @classmethod
    def of(cls, functions: Any, grid: CellGrid, cells: Ints, near: Grading, until: float = math.inf) -> DividedCells:
        """Of some cells, `until` a time of the monotonic clock."""
        require_time(until)
        whole = undivided(*grid.corners(cells), cells, functions.count)
        found = divide(functions, whole, LIMITS[functions.dimension], near)
        sampled, unresolved, cut = [], LeftOpen(), found.cut
        if functions.dimension == 3:
            last = [pieces.chosen(~pieces.proved) for pieces in cut]
            cut = [pieces.chosen(pieces.proved) for pieces in cut]
            for pieces in (some for part in last for some in _few(part, SAMPLED_AT_ONCE)):
                require_time(until)
                rule, part = sampled_rule(functions, pieces)
                sampled.append(rule)
                unresolved += part
        parts: list[tuple[CutPieces, PlaneBases | SpaceBases]] = []
        for pieces in together_at_once(cut):
            require_time(until)
            plane = functions.dimension == 2
            bases = PlaneBases.of(functions, pieces) if plane else SpaceBases.of(functions, pieces, near.falling, until)
            parts.append((pieces, bases))
            unresolved += bases.unresolved
        return cls(functions, grid, cells, near, until, found, parts, sampled, unresolved)

    def rule(self, order: int) -> RulePortion:
        """The rule of so many points along each direction."""
        near, found, cells, size = self.near, self.found, self.cells, self.grid.size
        inner = tensor_rules(found.lower, found.upper, found.owner, near.orders(found.lower, found.upper, size, order))
        rules, unresolved = [*inner, *self.sampled], self.unresolved
        for pieces, bases in self.pieces:
            require_time(self.until)
            rule, part = bases.rule(near.orders(pieces.lower, pieces.upper, size, order))
            rules.append(rule)
            unresolved += part
        rule = rules_together(rules)
        lower, upper = self.grid.corners(cells)
        counts = np.searchsorted(rule.owner, cells, "right") - np.searchsorted(rule.owner, cells)
        content = np.bincount(np.repeat(np.arange(len(cells)), counts), rule.weights, len(cells))
        full = np.abs(content / np.prod(upper - lower, axis=0) - 1) < 1e-12
        # A cell whose boundary is its own side came out in another order.
        whole = undivided(lower, upper, cells, self.functions.count)
        plain = (counts == order**self.functions.dimension) & ~close(whole, near.points)
        other = full & ~np.isin(cells, found.whole) & plain
        if other.any():
            keep = ~np.repeat(other, counts)
            made = tensor_rule(lower[:, other], upper[:, other], cells[other], order)
            points, weights, owner = rule.points[:, keep], rule.weights[keep], rule.owner[keep]
            rule = rules_together([replace(rule, points=points, weights=weights, owner=owner), made])
        return RulePortion(rule, cells[full], unresolved)


def _few(pieces: CutPieces, most: int) -> Iterator[CutPieces]:
    """Pieces, so many at once at most."""
    for first in range(0, len(pieces), most):
        yield pieces.chosen(np.arange(len(pieces)) // most == first // most)
