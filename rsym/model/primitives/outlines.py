"""Closed outlines of straight edges, refused where they are not simple, and the monotone formula of what is inside.

Corners come in counterclockwise order; every edge's half-plane stands in the formula once, without a complement.

A chain of edges whose first and last run on to infinity bounds a region. At a
corner on its convex hull it falls into two such chains: if it turns left there
(counterclockwise) the region is what both of theirs have in common, if right
it is both together.

Edges on one line would let operands vanish together along an edge, where
normalisation is lost. Where such a line carries a side of the hull, the region lies on
one side of it (or the other side lies in the region), so its half-plane is taken out
of the branches and joined once to the whole.

Source: Dobkin, Guibas, Hershberger, Snoeyink, "An efficient algorithm for
finding the CSG representation of a simple polygon" (1988), after Peterson (1984).
"""

from __future__ import annotations

import math
from collections.abc import Hashable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import TypeAlias

from rsym.errors import RsymError

Place: TypeAlias = tuple[float, float]
# What is nearer to a line than this was meant to be on it, in parts of the extent and of the largest coordinate, to
# which coordinates are rounded (1e-16) and so their sums and turned copies (a few times that).
NEAR = 1e-12
ROUNDED = 2e-15


def cross(a: Place, b: Place, c: Place) -> float:
    """Twice the area of the triangle a, b, c, positive counterclockwise."""
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def nearness(places: Sequence[Place]) -> float:
    """The distance below which a point is on a line."""
    extent: float = max(max(axis) - min(axis) for axis in zip(*places, strict=True))
    largest = max(abs(coordinate) for place in places for coordinate in place)
    return NEAR * extent + ROUNDED * largest


def area(places: Sequence[Place]) -> float:
    """The area inside, negative where the corners go clockwise.

    Examples
    --------
    >>> area([(0, 0), (2, 0), (0, 3)])
    3.0
    """
    total: float = sum(cross(places[0], b, c) for b, c in pairwise(places[1:]))
    return total / 2


def aligned(a: Place, b: Place, c: Place, near: float) -> bool:
    """Whether three points lie on one line."""
    return abs(cross(a, b, c)) <= near * max(math.dist(a, b), math.dist(b, c))


def ahead(a: Place, b: Place, c: Place, d: Place) -> bool:
    """Whether the ways from a to b and from c to d have a common direction."""
    return (b[0] - a[0]) * (d[0] - c[0]) + (b[1] - a[1]) * (d[1] - c[1]) > 0


def straight(a: Place, b: Place, c: Place, near: float) -> bool:
    """Whether the way from a over b to c does not turn at b; a way that turns back is refused.

    Examples
    --------
    >>> straight((0, 0), (1, 1), (3, 3), 1e-12)
    True
    """
    if not aligned(a, b, c, near):
        return False
    if not ahead(a, b, b, c):
        raise RsymError(
            f"the outline turns back on itself at {shown(b)}",
            code="polygon",
            remedy="leave out the spike",
        )
    return True


def check_simple(places: Sequence[Place]) -> None:
    """Refuse an outline that crosses or touches itself.

    Raises
    ------
    RsymError
        With the two edges that meet.

    Examples
    --------
    >>> check_simple([(0, 0), (2, 0), (2, 1), (0, 1)])
    """
    near = nearness(places)
    for first, second in _close_edges(places, near):
        a, b, c, d = (places[(edge + step) % len(places)] for edge in (first, second) for step in (0, 1))
        if _meet(a, b, c, d, near):
            raise RsymError(
                f"the outline must not cross or touch itself, but the edges from {shown(a)} to {shown(b)} "
                f"and from {shown(c)} to {shown(d)} meet",
                code="polygon",
                remedy="give the corners in their order along the boundary; two shapes that touch are two polygons",
            )


def _close_edges(places: Sequence[Place], near: float) -> Iterator[tuple[int, int]]:
    """Pairs of edges without a common corner whose boxes overlap, met from left to right."""
    count = len(places)
    boxes = []
    for edge, (a, b) in enumerate(zip(places, (*places[1:], places[0]), strict=True)):
        (left, right), (low, high) = (sorted(axis) for axis in zip(a, b, strict=True))
        boxes.append((left, right + near, low, high + near, edge))
    boxes.sort()
    for position, (_, right, low, high, edge) in enumerate(boxes):
        for left, _, other_low, other_high, other in boxes[position + 1 :]:
            if left > right:
                break
            apart = other_low > high or low > other_high
            if not apart and (edge - other) % count not in (1, count - 1):
                yield edge, other


def _meet(a: Place, b: Place, c: Place, d: Place, near: float) -> bool:
    if cross(a, b, c) * cross(a, b, d) < 0 and cross(c, d, a) * cross(c, d, b) < 0:
        return True
    ends = ((a, c, d), (b, c, d), (c, a, b), (d, a, b))
    return any(_distance(*three) <= near for three in ends)


def _distance(p: Place, a: Place, b: Place) -> float:
    """From a point to an edge."""
    along = (b[0] - a[0], b[1] - a[1])
    share = ((p[0] - a[0]) * along[0] + (p[1] - a[1]) * along[1]) / (along[0] ** 2 + along[1] ** 2)
    share = min(1.0, max(0.0, share))
    return math.dist(p, (a[0] + share * along[0], a[1] + share * along[1]))


def shown(place: Place) -> str:
    """A point for a message."""
    return f"({place[0]:g}, {place[1]:g})"


Branch: TypeAlias = "int | Junction"


@dataclass(frozen=True)
class Junction:
    """What branches have in common, or all of them together; a number is the half-plane of the edge from that corner.

    Branches never are junctions of the same kind.
    """

    common: bool
    branches: tuple[Branch, ...]


def monotone_formula(corners: Sequence[Place]) -> tuple[Junction, tuple[tuple[int, int], ...]]:
    """The formula of a simple polygon, and the pairs of edges of which it has the first for both.

    Corners are counterclockwise, none of them straight; edges are numbered by the corner where they begin.

    Examples
    --------
    >>> monotone_formula([(0, 0), (4, 0), (4, 4), (2, 1), (0, 4)])
    (Junction(common=True, branches=(0, 1, Junction(common=False, branches=(2, 3)), 4)), ())
    """
    chains = _Chains(corners)
    return chains.polygon(), tuple(chains.shared)


Permutation: TypeAlias = Sequence[int]  # of the edges


def mirrors(corners: Sequence[Place]) -> list[Permutation]:
    """The half turn and the reflection in x, or the one reflection in a coordinate, that map the outline onto itself.

    They are about the middle of its extent, and say which edge becomes which.

    Examples
    --------
    >>> mirrors([(0, 0), (2, 0), (2, 1), (0, 1)])
    [(2, 3, 0, 1), (0, 3, 2, 1)]
    """
    near, count = 10 * nearness(corners), len(corners)
    middle = [(min(axis) + max(axis)) / 2 for axis in zip(*corners, strict=True)]
    found: list[Permutation] = []
    for axis in (1, 0):
        images = [tuple(2 * middle[k] - c if k == axis else c for k, c in enumerate(corner)) for corner in corners]
        places = [[k for k, corner in enumerate(corners) if math.dist(image, corner) <= near] for image in images]
        if all(len(place) == 1 for place in places):  # a reflection turns round: an edge begins at the image of its end
            found.append(tuple(places[(edge + 1) % count][0] for edge in range(count)))
    if len(found) < 2:
        return found
    return [tuple(found[0][edge] for edge in found[1]), found[1]]


def in_symmetric_pairs(formula: Branch, symmetries: Sequence[Permutation]) -> Branch:
    """The same branches, joined so that each symmetry only exchanges operands: no operation of R_0 is associative.

    Every symmetry normalises the group of those before it and has its square in it. One that does not map the formula
    onto itself is left out.

    Examples
    --------
    >>> in_symmetric_pairs(Junction(True, (0, 1, 2, 3)), [(2, 3, 0, 1), (0, 3, 2, 1)])
    Junction(common=True, branches=(Junction(common=True, branches=(0, 2)), Junction(common=True, branches=(1, 3))))
    """
    whole = _key(formula)
    kept = [symmetry for symmetry in symmetries if _key(_image(formula, symmetry)) == whole]
    if not isinstance(formula, Junction) or not kept:
        return formula
    done: set[Hashable] = set()
    joined: list[Branch] = []
    for branch in formula.branches:
        if _key(branch) in done:
            continue
        orbit = {_key(branch): branch}
        for made in (stack := [branch]):
            images = [_image(made, symmetry) for symmetry in kept]
            stack += [image for image in images if _key(image) not in orbit]
            orbit.update((_key(image), image) for image in images)
        done |= orbit.keys()
        group = in_symmetric_pairs(branch, [*kept, *(tuple(kept[0][edge] for edge in other) for other in kept[1:])])
        for symmetry in kept:
            image = _image(group, symmetry)
            if _key(image) != _key(group):
                group = Junction(formula.common, (group, image))
        joined.append(group)
    return joined[0] if len(joined) == 1 else Junction(formula.common, tuple(joined))


def _image(branch: Branch, symmetry: Permutation) -> Branch:
    if not isinstance(branch, Junction):
        return symmetry[branch]
    return Junction(branch.common, tuple(_image(part, symmetry) for part in branch.branches))


def _key(branch: Branch) -> Hashable:
    """The same for branches that differ in the order of operands alone."""
    if not isinstance(branch, Junction):
        return branch
    return branch.common, frozenset(map(_key, branch.branches))


class _Chains:
    """Chains of one polygon, named by the numbers of their edges; numbers beyond the last begin again."""

    def __init__(self, corners: Sequence[Place]) -> None:
        self.corners = corners
        self.near = nearness(corners)
        self.lines = _common_lines(corners, self.near)
        self.shared: list[tuple[int, int]] = []

    def polygon(self) -> Junction:
        """Cut at the leftmost and the rightmost corner: the rays of each half never meet."""
        count = len(self.corners)
        first = min(range(count), key=lambda corner: self.corners[corner])
        last = max(range(count), key=lambda corner: self.corners[corner])
        whole = range(first, first + count)
        formula = self._joined(True, whole, first + (last - first) % count, {})
        assert isinstance(formula, Junction)
        return formula

    def region(self, chain: range, settled: Mapping[int, bool]) -> Branch | bool:
        """Of an endless chain; what is settled is the same on all of its branches."""
        if len(chain) == 1:
            edge = chain[0] % len(self.corners)
            return settled.get(edge, edge)
        side = self._side(chain)
        return self._joined(side > 0, chain, self._outermost(chain, side), settled)

    def _joined(self, common: bool, chain: range, cut: int, settled: Mapping[int, bool]) -> Branch | bool:
        carried = [line for line in self._carried(common, chain) if line[0] not in settled]
        self.shared.extend((line[0], edge) for line in carried for edge in line[1:])
        settled = {**settled, **{edge: common for line in carried for edge in line}}
        parts = (self.region(range(chain.start, cut), settled), self.region(range(cut, chain.stop), settled))
        if any(part is (not common) for part in parts):
            return not common
        branches: list[Branch] = [line[0] for line in carried]
        for part in parts:
            if not isinstance(part, bool):
                alike = isinstance(part, Junction) and part.common == common
                branches.extend(part.branches if isinstance(part, Junction) and alike else (part,))
        if not branches:
            return common
        return Junction(common, tuple(branches)) if len(branches) > 1 else branches[0]

    def _carried(self, common: bool, chain: range) -> Iterator[list[int]]:
        """Edges of the chain on one line that the hull does not cross, two or more."""
        edges = {edge % len(self.corners) for edge in chain}
        for line in self.lines:
            inside = [edge for edge in line if edge in edges]
            if len(inside) > 1 and self._supports(inside[0], common, chain):
                yield inside

    def _supports(self, edge: int, common: bool, chain: range) -> bool:
        """Whether the chain lies on one side of the line through an edge: on the left if its region does."""
        heading, origin = self._heading(edge), self._corner(edge)
        side = 1 if common else -1
        for number in (*chain, chain.stop):
            x, y = self._corner(number)
            if side * (heading[0] * (y - origin[1]) - heading[1] * (x - origin[0])) < -self.near:
                return False
        if len(chain) == len(self.corners):
            return True
        rays = ((chain.start, -1), (chain.stop - 1, 1))
        return all(self._turn(edge, ray) * way * side >= 0 for ray, way in rays)

    def _corner(self, number: int) -> Place:
        return self.corners[number % len(self.corners)]

    def _heading(self, edge: int) -> Place:
        a, b = self._ends(edge)
        length = math.dist(a, b)
        return (b[0] - a[0]) / length, (b[1] - a[1]) / length

    def _ends(self, edge: int) -> tuple[Place, Place]:
        return self._corner(edge), self._corner(edge + 1)

    def _turn(self, first: int, second: int) -> float:
        """The sine of the angle from one edge to another, 0 where they are parallel but for rounding."""
        turn = cross((0, 0), self._heading(first), self._heading(second))
        shortest = min(math.dist(*self._ends(edge)) for edge in (first, second))
        return 0 if abs(turn) * shortest <= self.near else turn

    def _side(self, chain: range) -> int:
        """1 if the chain as a whole turns left, -1 if right.

        It turns by less than half a turn: the first two chains go from left to right, and a cut at the corner that is
        farthest out leaves two that go outwards, or inwards, at both of their ends.
        """
        return 1 if self._turn(chain.start, chain.stop - 1) >= 0 else -1

    def _outermost(self, chain: range, side: int) -> int:
        """A corner on the hull: the farthest in the direction that halves the turn, the middle one of several."""
        first, last = self._heading(chain.start), self._heading(chain.stop - 1)
        if ahead((0, 0), first, (0, 0), last):
            out = (side * (first[1] + last[1]), -side * (first[0] + last[0]))
        else:
            out = (first[0] - last[0], first[1] - last[1])
        places = {corner: self._corner(corner) for corner in chain[1:]}
        far = {corner: out[0] * place[0] + out[1] * place[1] for corner, place in places.items()}
        level = max(far.values()) - self.near
        outermost = [corner for corner, reach in far.items() if reach >= level]
        return outermost[len(outermost) // 2]


def _common_lines(corners: Sequence[Place], near: float) -> list[list[int]]:
    """Edges with the same half-plane, where there are several."""
    lines: list[list[int]] = []
    for edge, (a, b) in enumerate(zip(corners, (*corners[1:], corners[0]), strict=True)):
        for line in lines:
            c, d = corners[line[0]], corners[(line[0] + 1) % len(corners)]
            if aligned(c, d, a, near) and aligned(c, d, b, near) and ahead(a, b, c, d):
                line.append(edge)
                break
        else:
            lines.append([edge])
    return [line for line in lines if len(line) > 1]
