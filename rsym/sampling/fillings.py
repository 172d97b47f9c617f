"""Fillings: the inside of a shape as triangles, or as tetrahedra, that end at its boundary.

Squares or cubes of a lattice that are whole inside are divided into simplices. In the plane each square that the
boundary cuts is cut along the outline, corners of which are exact, and what is inside is divided by ears (Meisters
1975); the triangles fill the polygons of the outline, to rounding. In space each cube is divided into six tetrahedra
about its diagonal (Freudenthal 1942), alike in all cubes, so faces of neighbours agree; a tetrahedron that the boundary
cuts ends at the places on its edges where omega is 0; a wedge that is left is divided by the least of the numbers of
its points (Dompierre et al. 1999). Edges of a body are blunt there, by less than a cell.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise, product

import numpy as np

from rsym.arrays import Flags, Floats, Ints
from rsym.errors import RsymError
from rsym.logic.inside import inside_kernel
from rsym.model.shape import Bounds, Shape
from rsym.sampling.lattice import Lattice, lattice_over
from rsym.sampling.outlines import outline_on_edges
from rsym.sampling.plane import plane_sampler
from rsym.sampling.plane_leaves import leaves_of
from rsym.sampling.roots import bracketed_roots

# A point of the lattice inside that is nearer to the boundary along an edge moves onto it: no slivers there.
NEAR = 0.25  # of a cell
FLAT = 0.01  # area of a triangle as a share of the square on its longest side: where it is less no point moves
MOST_POINTS = 20_000_000

# The corners of a square, counter-clockwise, and of a cube by rows; the simplices of a cube along its diagonal.
_AROUND = np.array([(0, 0), (1, 0), (1, 1), (0, 1)])
_CUBE = np.array(list(product((0, 1), repeat=3)))
_SIMPLICES = np.array([
    [0, 4, 6, 7], [0, 2, 3, 7], [0, 1, 5, 7],
    [0, 6, 2, 7], [0, 3, 1, 7], [0, 5, 4, 7],
])  # fmt: skip
# What is left of a tetrahedron abcd of which 1, 2, or 3 corners are inside, the first ones: ends of edges, of a corner
# twice the same. A tetrahedron, or a wedge: a triangle, and the one opposite it, which its normal points to.
_LEFT = {
    1: [(0, 0), (0, 1), (0, 2), (0, 3)],
    2: [(0, 0), (0, 2), (0, 3), (1, 1), (1, 2), (1, 3)],
    3: [(0, 0), (1, 1), (2, 2), (0, 3), (1, 3), (2, 3)],
}
# Turns of a wedge that bring each of its points to the first place; its tetrahedra by either diagonal of the far side.
_TURNS = np.array(
    [
        [0, 1, 2, 3, 4, 5],
        [1, 2, 0, 4, 5, 3],
        [2, 0, 1, 5, 3, 4],
        [3, 5, 4, 0, 2, 1],
        [4, 3, 5, 1, 0, 2],
        [5, 4, 3, 2, 1, 0],
    ]
)
_BY_1_5 = [(0, 1, 2, 5), (0, 1, 5, 4), (0, 4, 5, 3)]
_BY_2_4 = [(0, 1, 2, 4), (0, 4, 2, 5), (0, 4, 5, 3)]


@dataclass(frozen=True)
class Filling:
    """The inside of a shape: points (n, dimension), and cells (m, dimension + 1), which are rows of their numbers.

    Triangles run counter-clockwise; the fourth corner of a tetrahedron is where the normal of the others points.

    Examples
    --------
    >>> import rsym
    >>> half = filling(rsym.half_plane((0, 1), 0) & rsym.disc(1), ((-1.1, 1.1), (-0.1, 1.1)), 64)
    >>> round(float(half.sizes.sum()), 2), bool((half.points[:, 1] > -1e-12).all())
    (1.57, True)
    >>> round(float(filling(rsym.sphere(1), ((-1.1, 1.1),) * 3, 16).sizes.sum()), 1)
    4.2
    """

    points: Floats
    cells: Ints

    @property
    def sizes(self) -> Floats:
        """The area or volume of each cell."""
        return _sizes(self.points[self.cells])


def filling(shape: Shape, bounds: Bounds, resolution: int | Sequence[int]) -> Filling:
    """The inside of a shape within bounds, on a lattice of so many cells along the longest side.

    Raises
    ------
    RsymError
        For a shape that has nothing inside on this lattice, or whose outline in the plane is open within the bounds.
    """
    made = _in_plane(shape, bounds, resolution) if shape.dimension == 2 else _in_space(shape, bounds, resolution)
    if not len(made.cells):
        raise RsymError(
            "the shape has nothing inside on the lattice", code="empty", remedy="take a finer one, resolution="
        )
    return made


# -- in the plane --------------------------------------------------------------------------------------------------


def _in_plane(shape: Shape, bounds: Bounds, resolution: int | Sequence[int]) -> Filling:
    sampler = plane_sampler(shape, "value", resolution=resolution, bounds=bounds)
    leaves = leaves_of(sampler.shape, sampler.free, sampler.fixed, None, sampler.bounds)
    signs = sampler.signs()
    lines, edges = outline_on_edges(sampler, leaves, signs)
    if not all((line[0] == line[-1]).all() for line in lines):
        raise RsymError(
            "the outline of the shape is not closed", code="open-lines", remedy="give the shape wider bounds"
        )
    inside = signs > 0
    # Points of the lattice first, then those of the outline, without the last of each line, which is the first.
    starts = inside.size + np.cumsum([0, *(len(line) - 1 for line in lines)])
    points = np.concatenate([sampler.lattice.points(np.argwhere(np.ones(inside.shape))), *(one[:-1] for one in lines)])
    whole = inside[:-1, :-1] & inside[1:, :-1] & inside[1:, 1:] & inside[:-1, 1:]
    squares = _corner_numbers(np.argwhere(whole), inside.shape)
    chains = [chain for line, start in zip(edges, starts, strict=False) for chain in _chains(line, int(start))]
    while True:
        made = _divided(chains, squares, points, sampler.lattice, inside)
        turned = set(made.cells[made.sizes <= 0].ravel().tolist())
        blunt = [one.blunt() if turned.intersection(one.points) else one for one in chains]
        if blunt == chains:
            return _without_idle(made)
        chains = blunt


def _divided(chains: Sequence[_Chain], squares: Ints, points: Floats, lattice: Lattice, inside: Flags) -> Filling:
    """What is inside of the squares that chains cut, and of those whole inside, in triangles."""
    polygons, squares = _disentangled([*_cut_squares(chains, inside)], squares, points)
    onto = _moved(chains, points, lattice, inside)
    while True:
        places = np.where(onto < 0, np.arange(len(points)), onto)
        ears = [ear for polygon in polygons for ear in _ears(places[polygon].tolist(), points)]
        cells = np.concatenate([_halves(places[squares], points), np.array(ears, np.int64).reshape(-1, 3)])
        flat = np.unique(cells[_shares(points[cells]) < FLAT])
        stay = np.isin(onto, flat)
        if not stay.any():
            return Filling(points, cells)
        onto[stay] = -1


def _corner_numbers(low: Ints, counts: Sequence[int]) -> Ints:
    """The numbers (n, 4) of the corners of squares, counter-clockwise from the lower left ones."""
    return np.stack([np.ravel_multi_index(tuple((low + shift).T), tuple(counts)) for shift in _AROUND], axis=1)


@dataclass(frozen=True)
class _Chain:
    """A piece of an outline through one square, from edge to edge: indices of their middles, numbers of its points."""

    square: tuple[int, int]
    enters: float
    leaves: float
    points: tuple[int, ...]

    def blunt(self) -> _Chain:
        """Without the corners on it: tips of an outline finer than the lattice may cross each other."""
        return replace(self, points=(self.points[0], self.points[-1]))


def _chains(edges: Floats, start: int) -> Iterator[_Chain]:
    """The pieces of a closed line whose points have numbers from `start` on."""
    count = len(edges) - 1
    on_edge = np.flatnonzero(~np.isnan(edges[:, 0]))
    for first, last in pairwise(on_edge.tolist()):
        one, other = edges[first], edges[last]
        square = np.floor((one + other) / 2).astype(int)
        numbers = tuple(start + k % count for k in range(first, last + 1))
        yield _Chain((int(square[0]), int(square[1])), _along(one - square), _along(other - square), numbers)


def _along(place: Floats) -> float:
    """How far round the unit square a middle of an edge is, counter-clockwise from the lower left corner."""
    return {(0.5, 0.0): 0.5, (1.0, 0.5): 1.5, (0.5, 1.0): 2.5, (0.0, 0.5): 3.5}[float(place[0]), float(place[1])]


def _cut_squares(chains: Sequence[_Chain], inside: Flags) -> Iterator[list[int]]:
    """What is inside of squares that the outline cuts, counter-clockwise: it has the inside to its left."""
    of_square: dict[tuple[int, int], list[_Chain]] = {}
    for chain in chains:
        of_square.setdefault(chain.square, []).append(chain)
    for square, own in of_square.items():
        (corners,) = _corner_numbers(np.array([square]), inside.shape).tolist()
        left = list(own)
        while left:
            polygon: list[int] = []
            first = here = left.pop()
            while True:
                polygon += here.points
                after = min((*left, first), key=lambda one: (one.enters - here.leaves) % 4)
                gap = (after.enters - here.leaves) % 4
                polygon += [corners[int(np.ceil(here.leaves) + k) % 4] for k in range(int(np.floor(gap + 0.5)))]
                if after is first:
                    break
                left.remove(after)
                here = after
            yield polygon


def _disentangled(polygons: list[list[int]], squares: Ints, points: Floats) -> tuple[list[list[int]], Ints]:
    """The same, but a polygon is joined to those, and to the squares, that a tip of its outline reaches into.

    The tip of a notch may lie beyond the square whose edges the notch crosses: what is there is not whole inside.
    """
    tangled = [number for number, ring in enumerate(polygons) if any(_crossed_sides(ring, points))]
    if not tangled:
        return polygons, squares
    rings: dict[int, list[int]] = dict(enumerate([*polygons, *squares.tolist()]))
    owners = {(b, a): number for number, ring in rings.items() for a, b in _sides(ring)}
    for number in tangled:
        while number in rings:
            across = ((a, b, owners.get((a, b), number)) for a, b in _crossed_sides(rings[number], points))
            a, b, other = next((one for one in across if one[2] != number), (0, 0, number))
            if other == number:
                break
            owners.update({(d, c): number for c, d in _sides(rings[other])})
            rings[number] = _joined(rings[number], rings.pop(other), a, b)
    count = len(polygons)
    whole = np.isin(np.arange(count, count + len(squares)), list(rings))
    return [ring for number, ring in rings.items() if number < count], squares[whole]


def _sides(ring: list[int]) -> list[tuple[int, int]]:
    return [(ring[k - 1], point) for k, point in enumerate(ring)]


def _crossed_sides(ring: list[int], points: Floats) -> Iterator[tuple[int, int]]:
    """Sides of a polygon that others of its sides cross."""
    ends = [(complex(*points[a]), complex(*points[b])) for a, b in _sides(ring)]
    for (a, b), side in zip(ends, _sides(ring), strict=True):
        if any(_turn(a, b, c) * _turn(a, b, d) < 0 and _turn(c, d, a) * _turn(c, d, b) < 0 for c, d in ends):
            yield side


def _joined(ring: list[int], other: list[int], a: int, b: int) -> list[int]:
    """Two polygons without the side ab of the first, which is ba in the other, and without other such pairs there."""
    at, its = _sides(ring).index((a, b)), _sides(other).index((b, a))
    made = [*ring[at:], *ring[:at], *other[its + 1 :], *other[:its]][:-1]
    while (spike := next((k for k in range(len(made)) if made[k - 2] == made[k]), None)) is not None:
        made = [point for k, point in enumerate(made) if k not in {(spike - 1) % len(made), spike}]
    return made


def _moved(chains: Sequence[_Chain], points: Floats, lattice: Lattice, inside: Flags) -> Ints:
    """For each point of the lattice the near point of the outline that takes its place, or -1."""
    onto, best = np.full(len(points), -1), np.full(len(points), NEAR)
    counts = inside.shape
    for chain in chains:
        (corners,) = _corner_numbers(np.array([chain.square]), counts).tolist()
        for along, point in ((chain.enters, chain.points[0]), (chain.leaves, chain.points[-1])):
            low, high = corners[int(along)], corners[(int(along) + 1) % 4]
            own = low if inside.flat[low] else high
            away = float(np.max(np.abs(points[point] - points[own]) / lattice.spacing))
            if away < best[own]:
                onto[own], best[own] = point, away
    return onto


def _halves(squares: Ints, points: Floats) -> Ints:
    """Two triangles (2n, 3) of each of (n, 4) squares, by the diagonal that leaves the larger smaller one."""
    one = np.stack([squares[:, [0, 1, 2]], squares[:, [0, 2, 3]]], axis=1)
    other = np.stack([squares[:, [1, 2, 3]], squares[:, [1, 3, 0]]], axis=1)
    least = [_sizes(points[pair.reshape(-1, 3)]).reshape(-1, 2).min(axis=1) for pair in (one, other)]
    return np.where((least[0] >= least[1])[:, None, None], one, other).reshape(-1, 3)


def _ears(polygon: list[int], points: Floats) -> Iterator[tuple[int, int, int]]:
    """Triangles of a simple polygon, counter-clockwise, the best ear first; of a point that is named twice, one."""
    ring = [k for number, k in enumerate(polygon) if k != polygon[number - 1]]
    at = dict(zip(ring, (complex(*points[k]) for k in ring), strict=True))
    while len(ring) > 2:
        best, found = -math.inf, 0
        for k, tip in enumerate(ring if len(ring) > 3 else ring[:1]):
            ear = at[ring[k - 1]], at[tip], at[ring[(k + 1) % len(ring)]]
            sides = [abs(ear[j] - ear[j - 1]) ** 2 for j in range(3)]
            quality = _turn(*ear) / (sum(sides) + sys.float_info.min)
            inner = (at[p] for p in ring if at[p] not in ear)
            if quality > best and (quality <= 0 or not any(_holds(ear, p) for p in inner)):
                best, found = quality, k
        yield ring[found - 1], ring[found], ring[(found + 1) % len(ring)]
        del ring[found]


def _turn(a: complex, b: complex, c: complex) -> float:
    """Twice the area of a triangle."""
    return ((b - a).conjugate() * (c - a)).imag


def _holds(ear: tuple[complex, complex, complex], p: complex) -> bool:
    return all(_turn(ear[k - 1], ear[k], p) >= 0 for k in range(3))


def _shares(corners: Floats) -> Floats:
    """The areas of triangles (n, 3, 2) as shares of the squares on their longest sides."""
    longest = np.max(np.sum((corners - np.roll(corners, 1, axis=1)) ** 2, axis=2), axis=1)
    found: Floats = _sizes(corners) / np.maximum(longest, sys.float_info.min)
    return found


# -- in space ------------------------------------------------------------------------------------------------------


def _in_space(shape: Shape, bounds: Bounds, resolution: int | Sequence[int]) -> Filling:
    lattice = lattice_over(bounds, resolution, MOST_POINTS)
    kernel = inside_kernel(shape)
    values = kernel(*lattice.open_axes())["value"]
    values = np.where(np.isnan(values), -np.inf, values)
    inside = values > 0
    corners = np.stack([_shifted(inside, shift) for shift in _CUBE])
    low = np.argwhere(corners.any(axis=0))
    numbers = np.stack([np.ravel_multi_index(tuple((low + shift).T), lattice.counts) for shift in _CUBE], axis=1)
    simplices = numbers[:, _SIMPLICES].reshape(-1, 4)
    count = inside.ravel()[simplices].sum(axis=1)
    left = {
        some: _inside_first(simplices[count == some], inside.ravel(), some)[:, np.array(_LEFT[some])] for some in _LEFT
    }
    pairs = np.sort(np.concatenate([rows.reshape(-1, 2) for rows in left.values()]), axis=1)
    ends, which = np.unique(pairs, axis=0, return_inverse=True)
    crossed = ends[:, 0] != ends[:, 1]
    number = np.where(crossed, values.size + np.cumsum(crossed) - 1, ends[:, 0])[which.ravel()]
    parts = np.split(number, np.cumsum([rows[..., 0].size for rows in left.values()])[:-1])
    rows = [part.reshape(one.shape[:2]) for part, one in zip(parts, left.values(), strict=True)]
    cells = [simplices[count == 4], rows[0], *map(_of_wedges, rows[1:])]
    grid = lattice.points(np.argwhere(np.ones(lattice.counts, np.bool_)))
    start, end = grid[ends[crossed, 0]], grid[ends[crossed, 1]]

    def at(t: Floats, edge: Ints) -> Floats:
        places = start[edge] + t[:, None] * (end[edge] - start[edge])
        return np.asarray(kernel(*places.T)["value"])

    share = bracketed_roots(at, *values.ravel()[ends[crossed]].T)
    points = np.concatenate([grid, start + share[:, None] * (end - start)])
    return _without_idle(Filling(points, np.concatenate(cells)))


def _shifted(values: Flags, shift: Ints) -> Flags:
    """Of each cube of a lattice the value at one of its corners."""
    return values[tuple(slice(k, n - 1 + k) for k, n in zip(shift.tolist(), values.shape, strict=True))]


def _inside_first(simplices: Ints, inside: Flags, count: int) -> Ints:
    """The same tetrahedra, so many corners inside first."""
    order = np.argsort(~inside[simplices], axis=1, kind="stable")
    found = np.take_along_axis(simplices, order, axis=1)
    turned = np.linalg.det(np.eye(4)[order]) < 0
    pair = [2, 3] if count == 1 else [0, 1]
    found[np.ix_(turned, pair)] = found[np.ix_(turned, pair[::-1])]
    return found


def _of_wedges(wedges: Ints) -> Ints:
    """The tetrahedra (3n, 4) of wedges (n, 6); wedges that share a side divide it alike."""
    turned = np.take_along_axis(wedges, _TURNS[np.argmin(wedges, axis=1)], axis=1)
    by = np.minimum(turned[:, 1], turned[:, 5]) < np.minimum(turned[:, 2], turned[:, 4])
    return np.where(by[:, None, None], turned[:, _BY_1_5], turned[:, _BY_2_4]).reshape(-1, 4)


def _sizes(corners: Floats) -> Floats:
    """The areas or volumes of simplices (n, dimension + 1, dimension)."""
    sides = corners[:, 1:] - corners[:, :1]
    found: Floats = np.linalg.det(sides) / math.factorial(sides.shape[2])
    return found


def _without_idle(made: Filling) -> Filling:
    """The same without points that are in no cell."""
    used = np.zeros(len(made.points), np.bool_)
    used[made.cells] = True
    return Filling(made.points[used], (np.cumsum(used) - 1)[made.cells])
