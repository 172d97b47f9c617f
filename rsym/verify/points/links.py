"""The link of a point: what small spheres around it see of sheets that pass through it.

Sheets through a point cut a small sphere along curves, near great circles, into cells on which their signs are
constant; arcs between the cells lie on one sheet, vertices on two or more. Where the gradients of three sheets at
the point are independent, all combinations of signs occur. In general they are the covectors of the oriented
matroid of the gradients: cocircuits are the signs of all sheets along the cross products of two gradients, and
every covector is a composition of them. If no three gradients are dependent, the arrangement on small spheres is
that of the tangent planes, for crossings at angles stay when the circles are bent a little; a vertex of three circles
may fall apart, which does not matter away from the boundary.
Source: Bjorner, Las Vergnas, Sturmfels, White and Ziegler, Oriented Matroids (1999), section 3.7.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations, product
from typing import TypeAlias

from rsym.logic.kleene import Formula, ternary

Covector: TypeAlias = tuple[int, ...]


@dataclass(frozen=True)
class Edge:
    """A direction in which two or more sheets meet: their signs along it, and the arcs of the boundary that end in it.

    An arc is a sheet with the sign that it has inside. Two arcs of different sheets make an edge; four or more pinch
    the body along the curve.
    """

    covector: Covector
    arcs: tuple[tuple[int, int], ...]


@dataclass(frozen=True)
class Link:
    """The arrangement on a small sphere, with the sign of the formula in each of its parts.

    No two sheets have one tangent plane: a cell lies on none of them, an arc on one, a vertex on two or more.
    """

    covectors: tuple[Covector, ...]
    formula: Formula

    def sign(self, covector: Covector) -> int:
        """The sign of the formula in a part."""
        return ternary(self.formula, dict(enumerate(covector)))

    @cached_property
    def _parts(self) -> dict[int, list[Covector]]:
        """The vertices, arcs and cells by their dimensions."""
        parts: dict[int, list[Covector]] = {0: [], 1: [], 2: []}
        for covector in self.covectors:
            parts[2 - min(covector.count(0), 2)].append(covector)
        return parts

    @cached_property
    def _sides(self) -> dict[Covector, tuple[Covector, Covector]]:
        """The two cells on either side of each arc."""
        cells = self._parts[2]
        found = {}
        for arc in self._parts[1]:
            first, second = (cell for cell in cells if _agrees(arc, cell))
            found[arc] = first, second
        return found

    @cached_property
    def boundary(self) -> tuple[Covector, ...]:
        """The arcs with the inside on one side and the outside on the other."""
        return tuple(arc for arc, (a, b) in self._sides.items() if self.sign(a) != self.sign(b))

    @cached_property
    def cracked(self) -> bool:
        """Whether the formula is zero somewhere without a change of sign."""
        arcs = any(self.sign(arc) == 0 for arc in self._sides if arc not in self.boundary)
        ends = {vertex for arc in self.boundary for vertex in self._parts[0] if _agrees(vertex, arc)}
        return arcs or any(self.sign(vertex) == 0 for vertex in self._parts[0] if vertex not in ends)

    def components(self, sign: int) -> int:
        """How many pieces the inside (1) or the outside (-1) of the sphere has, cells being joined across arcs."""
        joined = [pair for pair in self._sides.values() if {self.sign(cell) for cell in pair} == {sign}]
        return _count([cell for cell in self._parts[2] if self.sign(cell) == sign], joined)

    @property
    def is_disc(self) -> bool:
        """Whether the boundary is a surface: one closed curve on the sphere, inside and outside in one piece each.

        If both are connected no two cells of one touch at a vertex alone: a loop through both would part the others.
        """
        return not self.cracked and self.components(1) == 1 == self.components(-1)

    @cached_property
    def is_stable(self) -> bool:
        """Whether the boundary avoids all vertices of three sheets or more, which curved sheets may part anyhow.

        There the formula must have one sign, whatever the signs of these sheets are.
        """
        for vertex in self._parts[0]:
            if vertex.count(0) > 2:
                choices = product(*((sign,) if sign else (-1, 0, 1) for sign in vertex))
                if {self.sign(choice) for choice in choices} not in ({1}, {-1}):
                    return False
        return True

    @cached_property
    def edges(self) -> tuple[Edge, ...]:
        """The vertices at which arcs of different sheets end, or more than two."""
        found = []
        for vertex in self._parts[0]:
            arcs = tuple(self._arc(arc) for arc in self.boundary if _agrees(vertex, arc))
            if len(arcs) > 2 or len({sheet for sheet, _ in arcs}) > 1:
                found.append(Edge(vertex, arcs))
        return tuple(found)

    def _arc(self, arc: Covector) -> tuple[int, int]:
        inside = next(cell for cell in self._sides[arc] if self.sign(cell) > 0)
        sheet = arc.index(0)
        return sheet, inside[sheet]


def _agrees(part: Covector, other: Covector) -> bool:
    """Whether the other part has this one on its rim."""
    return all(own in (0, sign) for own, sign in zip(part, other, strict=True))


def _count(cells: Sequence[Covector], joined: Iterable[tuple[Covector, Covector]]) -> int:
    parents = {cell: cell for cell in cells}

    def top(cell: Covector) -> Covector:
        while parents[cell] != cell:
            cell = parents[cell]
        return cell

    for first, second in joined:
        parents[top(first)] = top(second)
    return sum(parent == cell for cell, parent in parents.items())


def octants(formula: Formula) -> Link:
    """The link where the gradients of three sheets, the leaves 0, 1 and 2 of the formula, are independent.

    Examples
    --------
    >>> from rsym.logic.kleene import Literal, joined
    >>> link = octants(joined("min", Literal(0), Literal(1), Literal(2)))
    >>> link.is_disc, len(link.edges)
    (True, 3)
    """
    signs = (covector for covector in product((-1, 0, 1), repeat=3) if any(covector))
    return Link(tuple(signs), formula)


def link(formula: Formula, orientation: Callable[[int, int, int], int], count: int) -> Link | None:
    """The link of `count` sheets, no two of which touch; None where they have no three independent gradients.

    `orientation(i, j, k)` is the sign of the determinant of three gradients, i < j < k.

    Examples
    --------
    >>> from rsym.logic.kleene import Literal, joined
    >>> sides = joined("min", *(Literal(k) for k in range(4)))  # a pyramid: the signs of the minors of its normals
    >>> link(sides, lambda i, j, k: 1, 4).is_disc
    True
    """
    signs = {triple: orientation(*triple) for triple in combinations(range(count), 3)}
    cocircuits = _cocircuits(signs, count)
    if cocircuits is None:
        return None
    found = dict.fromkeys(cocircuits)
    for _ in range(2):
        found |= dict.fromkeys(_composed(base, other) for base in found for other in cocircuits)
    return Link(tuple(found), formula)


def _cocircuits(signs: Mapping[tuple[int, int, int], int], count: int) -> list[Covector] | None:
    """The signs of all sheets along the cross product of two gradients, either way; None where that is zero."""
    found: dict[Covector, None] = {}
    for i, j in combinations(range(count), 2):
        along = tuple(_permuted(signs, i, j, k) for k in range(count))
        if not any(along):
            return None
        found[along] = None
        found[tuple(-sign for sign in along)] = None
    return list(found)


def _permuted(signs: Mapping[tuple[int, int, int], int], i: int, j: int, k: int) -> int:
    if k in (i, j):
        return 0
    first, second, third = sorted((i, j, k))
    return signs[first, second, third] * (-1 if i < k < j else 1)


def _composed(first: Covector, second: Covector) -> Covector:
    """The part that is met when one starts in the first and goes a little towards the second."""
    return tuple(a or b for a, b in zip(first, second, strict=True))
