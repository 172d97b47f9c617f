"""The monotone formula of a simple polygon: every edge's half-plane once, no complement.

A chain of edges whose first and last run on to infinity bounds a region. At the
corners on its convex hull it falls into shorter such chains: if the hull
turns left there the region is what all of theirs have in common, if right it is all of them together.
Every corner that lies on the hull splits, also one within a side of the hull:
then edges on one line end up side by side, and no half-plane's boundary runs
along an edge of another branch.

Source: Dobkin, Guibas, Hershberger, Snoeyink, "An efficient algorithm for
finding the CSG representation of a simple polygon" (1988), after Peterson (1984).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import TypeAlias

from rsym.model.primitives.outlines import Place, cross, nearness

_PARALLEL = 1e-12  # the sine of the angle of two rays, rounded to 1e-16, below which they are parallel

Branch: TypeAlias = "int | Junction"


@dataclass(frozen=True)
class Junction:
    """What branches have in common, or all of them together; a number is the half-plane of the edge from that corner.

    Neighbours among the branches never are junctions of the same kind.
    """

    common: bool
    branches: tuple[Branch, ...]


def monotone_formula(corners: Sequence[Place]) -> Junction:
    """The formula of a simple polygon, corners counterclockwise, none of them straight.

    Examples
    --------
    >>> monotone_formula([(0, 0), (4, 0), (4, 4), (2, 1), (0, 4)])
    Junction(common=True, branches=(0, 1, Junction(common=False, branches=(2, 3)), 4))
    """
    first = min(range(len(corners)), key=lambda index: corners[index])
    formula = _Chains((*corners[first:], *corners[: first + 1])).polygon()
    return _renumbered(formula, first, len(corners))


class _Chains:
    """Chains of one polygon: the way from corner to corner, the first given again as the last."""

    def __init__(self, way: Sequence[Place]) -> None:
        self.way = way
        self.near = nearness(way)

    def polygon(self) -> Junction:
        hull = [0]
        while hull[-1] < len(self.way) - 1:
            hull.append(self._next(hull[-1], len(self.way), 1))
        return self._junction(True, hull)

    def region(self, start: int, end: int) -> Branch:
        """Of the chain from one corner to another."""
        if end == start + 1:
            return start
        side = self._side(start, end)
        return self._junction(side > 0, [start, *self._hull(start, end, side), end])

    def _junction(self, common: bool, cuts: list[int]) -> Junction:
        branches: list[Branch] = []
        for start, end in pairwise(cuts):
            branch = self.region(start, end)
            alike = isinstance(branch, Junction) and branch.common == common
            branches.extend(branch.branches if isinstance(branch, Junction) and alike else (branch,))
        return Junction(common, tuple(branches))

    def _heading(self, edge: int) -> Place:
        a, b = self.way[edge], self.way[edge + 1]
        length = math.dist(a, b)
        return (b[0] - a[0]) / length, (b[1] - a[1]) / length

    def _side(self, start: int, end: int) -> int:
        """1 if the hull of an endless chain is on the left of its boundary, -1 on the right."""
        first, last = self._heading(start), self._heading(end - 1)
        turn = cross((0, 0), first, last)
        if abs(turn) < _PARALLEL and first[0] * last[0] + first[1] * last[1] < 0:
            a, b = self.way[start + 1], self.way[end - 1]
            turn = cross((0, 0), first, (b[0] - a[0], b[1] - a[1]))
        return 1 if turn >= 0 else -1

    def _hull(self, start: int, end: int, side: int) -> list[int]:
        """The corners of an endless chain that lie on its hull, in their order."""
        first, last = self._heading(start), self._heading(end - 1)
        corner = start + 1
        for other in range(start + 2, end):
            if side * self._beside(corner, first, other) < -self.near:
                corner = other
        hull = [corner]
        while corner < end - 1:
            corner = self._next(corner, end, side)
            if side * self._beside(hull[-1], last, corner) > self.near:
                break
            hull.append(corner)
        return hull

    def _next(self, corner: int, end: int, side: int) -> int:
        """The corner that comes next on the hull: all later ones lie on one side of the line to it."""
        origin, best = self.way[corner], corner + 1
        for other in range(corner + 2, end):
            a, b = self.way[best], self.way[other]
            reach = max(math.dist(origin, a), math.dist(origin, b))
            if side * cross(origin, a, b) < -self.near * reach:
                best = other
        return best

    def _beside(self, corner: int, heading: Place, other: int) -> float:
        """How far to the left of the line through a corner another one lies."""
        a, b = self.way[corner], self.way[other]
        return heading[0] * (b[1] - a[1]) - heading[1] * (b[0] - a[0])


def _renumbered(formula: Junction, first: int, count: int) -> Junction:
    branches = (
        _renumbered(branch, first, count) if isinstance(branch, Junction) else (branch + first) % count
        for branch in formula.branches
    )
    return Junction(formula.common, tuple(branches))
