"""Sign or value of a shape on a plane lattice, by what matters in large boxes and in small ones inside.

Most of a sign is known by boxes. A value needs all points, but of a minimum only the part that may be the smallest.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rsym.arrays import Floats, Ints, Shorts
from rsym.backends.kernel import checked_threads, lasting_threads
from rsym.logic.gates import Gate
from rsym.logic.lifting import TURNED, lifted, opened
from rsym.logic.sign_form import SignForm, shape_builder, shape_form
from rsym.logic.stripping import Signed
from rsym.model.recent import recently, written
from rsym.model.shape import Bounds, Shape
from rsym.model.symbols import with_operands
from rsym.program.builder import Builder
from rsym.program.lowering import lower
from rsym.sampling.kernels.mesher_kernels import backend_for
from rsym.sampling.lattice import Lattice
from rsym.sampling.regions.own_leaves import ACROSS, FLAT, OwnLeaves, across, unscaled
from rsym.sampling.regions.region_code import AT_ONCE
from rsym.sampling.regions.region_kernels import RegionKernels, Run, region_kernels
from rsym.sampling.regions.regions import INSIDE, KEPT, Regions, of_leaves
from rsym.sampling.sharp.loops import in_threads

# Points along a side of the boxes: of a text of 7 900 operations 334 matter in the large ones and 35 in the small.
LARGE, SMALL = 64, math.isqrt(AT_ONCE)
GRAIN = 256  # small boxes
GROUPS = (4096, 256, 16)  # of boxes that lie anywhere
PLANE: tuple[int, int] = (0, 1)
_POINT = Lattice((0.0, 0.0), (1.0, 1.0), (1, 1))


@recently(8, written)
def _form(shape: Shape) -> SignForm:
    """The sign form, which kernels want in space."""
    return opened(shape_form(shape, *across(shape)))


@recently(8, written)
def _sign_kernels(shape: Shape) -> RegionKernels:
    return region_kernels(_form(shape))


@recently(8, written)
def value_kernels(shape: Shape) -> RegionKernels | None:
    """Those of a plane shape, its minima and maxima the gates; None where it has so few that nothing is gained."""
    builder = shape_builder(shape, ACROSS)
    form = choice_form(builder, lifted(builder, lower(builder, shape.expression)))
    return region_kernels(form) if backend_for(form) == "tape" else None


def choice_form(builder: Builder, number: int) -> SignForm:
    """A node as a min and max of leaves, with its value everywhere; what is negated is so in its leaves.

    Examples
    --------
    >>> b = Builder(("x", "y"), ())
    >>> choice_form(b, b.neg(b.make("min", b.input("x"), b.input("y")))).gates
    (Gate(operation='max', first=0, second=1),)
    """

    def operands(part: Signed) -> Sequence[Signed]:
        operation, arguments, _ = builder.nodes[part.number]
        return [_without_neg(builder, Signed(a, part.sign)) for a in arguments] if operation in TURNED else ()

    root = _without_neg(builder, Signed(number))
    leaves: dict[Signed, int] = {}
    gates: dict[Signed, Sequence[Signed]] = {}
    for part, below in with_operands(root, operands, tuple):
        if below:
            gates.setdefault(part, below)
        else:
            leaves.setdefault(part, len(leaves))
    places = leaves | {part: len(leaves) + k for k, part in enumerate(gates)}
    joined = (
        Gate(operation if part.sign > 0 else TURNED[operation], *(places[one] for one in below))
        for part, below in gates.items()
        for operation in (builder.nodes[part.number].operation,)
    )
    return SignForm(builder, tuple(part.made(builder) for part in leaves), tuple(joined))


def _without_neg(builder: Builder, part: Signed) -> Signed:
    while builder.nodes[part.number].operation == "neg":
        part = Signed(builder.nodes[part.number].arguments[0], -part.sign)
    return part


class PlaneBoxes:
    """A lattice in boxes of `SMALL` points a side, and what kernels say of them; `fixed` places it in space."""

    def __init__(
        self,
        kernels: RegionKernels,
        lattice: Lattice,
        free: tuple[int, ...] = PLANE,
        fixed: Mapping[int, float] = FLAT,
        threads: int | None = None,
    ) -> None:
        self.kernels, self.counts, self.free = kernels, lattice.counts, free
        count = checked_threads(threads)
        self.run: Run = partial(in_threads, pool=lasting_threads("rsym-plane", count) if count > 1 else None)
        self.flat = np.zeros(6)
        self.flat[list(fixed)] = list(fixed.values())
        self.flat[list(free)], self.flat[[3 + k for k in free]] = lattice.origin, lattice.spacing
        self.large = _corners([np.arange(0, points, LARGE) for points in self.counts])
        self.rows = tuple(-(-points // SMALL) for points in self.counts)

    def first(self) -> tuple[Floats, Ints]:
        """The ends of the large boxes, and that they are of one parent."""
        return self.ends(self.large, LARGE), np.zeros(self.large.shape[1], np.int64)

    def inside(self, kept: Ints) -> tuple[Ints, Ints]:
        """The small boxes in large ones, and in which of them each lies."""
        within = _corners([np.arange(0, LARGE, SMALL)] * 2)
        small = (self.large[:, kept, None] + within[:, None, :]).reshape(2, -1)
        parent = np.repeat(np.arange(len(kept)), within.shape[1])
        some = (small < np.array(self.counts)[:, None]).all(axis=0)
        return small[:, some], parent[some]

    def ends(self, corner: Ints, size: int) -> Floats:
        """The ends (6, n) of what the points of boxes fill."""
        ends = np.repeat(self.flat[:3], 2)[:, None] * np.ones(corner.shape[1])
        for axis, index, count in zip(self.free, corner, self.counts, strict=True):
            for k, at in enumerate((index, np.minimum(index + size - 1, count - 1))):
                ends[2 * axis + k] = self.flat[axis] + self.flat[3 + axis] * at
        return ends

    def in_space(self, index: Ints) -> Floats:
        """Indices (2, n) among those in space (3, n); there is one plane."""
        places = np.zeros((3, index.shape[1]))
        places[list(self.free)] = index
        return places

    def tiles(self, filled: Any, kind: Any) -> NDArray[Any]:
        """An array with the points of each small box."""
        return np.full((self.rows[0], SMALL, self.rows[1], SMALL), filled, kind)

    def joined(self, tiles: NDArray[Any]) -> NDArray[Any]:
        """The lattice."""
        points = tiles.reshape(SMALL * self.rows[0], SMALL * self.rows[1])
        return points[: self.counts[0], : self.counts[1]]


def signs_on(
    shape: Shape, lattice: Lattice, letters: Mapping[Any, float] | None = None, threads: int | None = None
) -> NDArray[np.int8]:
    """The sign of a plane shape at the points of a lattice, (nx, ny): 1 inside and on the boundary, -1 elsewhere.

    Examples
    --------
    >>> import math, rsym
    >>> from rsym import x, y
    >>> from rsym.sampling.lattice import lattice_over
    >>> disc = rsym.Shape(1 - x**2 - y**2, (x, y))
    >>> print(signs_on(disc, lattice_over(((-1.5, 1.5), (-1.5, 1.5)), 4, math.inf))[2])
    [-1 -1  1  1 -1 -1]
    """
    kernels = _sign_kernels(shape).copy()
    kernels.set(shape.letters.values_with(letters), (*_box(lattice), (0.0, 0.0)))
    return _signs(PlaneBoxes(kernels, lattice, threads=threads))[0]


def _signs(boxes: PlaneBoxes) -> tuple[NDArray[np.int8], bool]:
    """The signs at the points of a lattice, and whether the form is undefined at some, where the sign is -1."""
    kernels, tiles = boxes.kernels, boxes.tiles(-1, np.int8)
    sides, regions = kernels.sides(*boxes.first(), None, boxes.run)
    each = LARGE // SMALL
    for row, column in (boxes.large[:, sides == INSIDE] // SMALL).T:
        tiles[row : row + each, :, column : column + each] = 1
    kept = np.flatnonzero(sides == KEPT)
    small, parent = boxes.inside(kept)
    sides, regions = kernels.sides(boxes.ends(small, SMALL), parent, regions[kept], boxes.run)
    inside = small[:, sides == INSIDE] // SMALL
    tiles[inside[0], :, inside[1]] = 1
    last = sides == KEPT
    undefined = _fill_signs(boxes, small[:, last], regions[last], tiles)
    return boxes.joined(tiles), undefined


def _fill_signs(boxes: PlaneBoxes, corner: Ints, regions: Regions, tiles: NDArray[np.int8]) -> bool:
    """The signs at the points of small boxes, each by its region, and whether one of them may be undefined."""
    places, offsets = boxes.in_space(corner), boxes.in_space(_corners([np.arange(SMALL)] * 2))

    def part(first: int, last: int) -> bool:
        bits, undefined = np.zeros((last - first, SMALL * SMALL // 8), np.uint8), np.zeros(last - first, np.uint8)
        own = np.ascontiguousarray(places[:, first:last])
        boxes.kernels.signs(0, last - first, own, regions[first:last], boxes.flat, offsets, bits, undefined)
        positive = np.unpackbits(bits, axis=1, bitorder="little").reshape(-1, SMALL, SMALL)
        tile = corner[:, first:last] // SMALL
        tiles[tile[0], :, tile[1]] = 2 * positive.astype(np.int8) - 1
        return bool(undefined.any())

    return any(boxes.run(part, corner.shape[1], GRAIN))


def values_on(kernels: RegionKernels, lattice: Lattice, letters: Mapping[str, float]) -> Floats:
    """The value at the points of a lattice, (nx, ny), NaN where it is infinite; `letters` are all of the shape's."""
    boxes = PlaneBoxes(unscaled(kernels, letters), lattice)
    large = boxes.kernels.valued(*boxes.first(), None, boxes.run)
    small, parent = boxes.inside(np.arange(boxes.large.shape[1]))
    regions = boxes.kernels.valued(boxes.ends(small, SMALL), parent, large, boxes.run)
    places, offsets = boxes.in_space(small), boxes.in_space(_corners([np.arange(SMALL)] * 2))
    values = np.empty((SMALL * boxes.rows[0], SMALL * boxes.rows[1]))
    starts = values.shape[1] * small[0] + small[1]

    def part(first: int, last: int) -> None:
        own = slice(first, last)
        boxes.kernels.fill(places[:, own], regions[own], boxes.flat, offsets, starts[own], values)

    boxes.run(part, small.shape[1], GRAIN)
    return values[: boxes.counts[0], : boxes.counts[1]]


@dataclass(frozen=True)
class PlaneForm(OwnLeaves):
    """The sign form of a large shape in a plane of two free coordinates, and its leaves."""

    def without(self, leaves: Sequence[int]) -> PlaneForm:
        """The form in which these leaves are infinite."""
        return replace(self, kernels=self.kernels.without(leaves))

    def signs_on(self, lattice: Lattice) -> tuple[NDArray[np.int8], bool]:
        """The signs at the points of a lattice, 0 counts as positive, and whether the form is undefined somewhere."""
        return _signs(PlaneBoxes(self.kernels, lattice, self.free, self.fixed))

    def signs_over(self, ends: Floats) -> NDArray[np.int8]:
        """The sign that the form has all over boxes, lower and upper ends (2, dim, n), 0 where that is not known."""
        sides = self._sides(ends)[0]
        return np.where(sides == KEPT, 0, np.where(sides == INSIDE, 1, -1)).astype(np.int8)

    def mattering(self, ends: Floats) -> tuple[Ints, Ints]:
        """The leaves that the sign of the form hangs on in boxes: the number of a box, and of a leaf."""
        _, kept, regions = self._sides(ends)
        regions = of_leaves(regions)
        box, what = np.repeat(kept, np.diff(regions.start)), regions.entries[:, 0]
        return box[what >= 0], what[what >= 0].astype(np.int64)

    def slopes(self, ends: Floats, leaf: Ints) -> tuple[Floats, ...]:
        """Along each free coordinate the ends (2, n) of the slope of the leaf of each box."""
        bounds, every = np.empty((8, len(leaf))), self._in_space(ends)
        if len(leaf):
            self.kernels.enclose(len(leaf), leaf.astype(np.int16), every[::2], every[1::2], bounds)
        return tuple(bounds[2 * axis + 2 : 2 * axis + 4] for axis in self.free)

    def _sides(self, ends: Floats) -> tuple[NDArray[np.uint8], Ints, Regions]:
        """OUTSIDE, KEPT or INSIDE of boxes, which are kept, and the regions of those: of groups first."""
        order = _nearest_next(ends.mean(axis=0)[list(self.free)])
        every, run = self._in_space(ends[:, :, order]), PlaneBoxes(self.kernels, _POINT, self.free, self.fixed).run
        sides, own = np.full(len(order), KEPT, np.uint8), np.arange(len(order))
        parent, regions = np.zeros(len(order), np.int64), None
        for size in (*(size for size in GROUPS if size < len(order)), 1):
            _, first, group = np.unique(own // size, return_index=True, return_inverse=True)
            hull = np.empty((6, len(first)))
            for end, widest in ((0, np.minimum), (1, np.maximum)):
                hull[end::2] = widest.reduceat(every[end::2, own], first, axis=1) if len(first) else 0.0
            found, made = self.kernels.sides(hull, parent[first], regions, run)
            kept = found == KEPT
            sides[own], regions = found[group], made[kept]
            parent, own = (np.cumsum(kept) - 1)[group][kept[group]], own[kept[group]]
        result = np.empty_like(sides)
        result[order] = sides
        assert regions is not None
        return result, order[own], regions

    def _in_space(self, ends: Floats) -> Floats:
        """Boxes (6, n) as kernels take them."""
        every = np.zeros((6, ends.shape[2]))
        every[: 2 * ends.shape[1] : 2], every[1 : 2 * ends.shape[1] : 2] = ends
        for axis, value in self.fixed.items():
            every[2 * axis : 2 * axis + 2] = value
        return every

    def value(self, points: Floats) -> tuple[Floats, Shorts]:
        """The form at points (n, 2), and its active leaf."""
        places = self.in_space(points)
        value, leaf = np.empty(places.shape[1]), np.empty(places.shape[1], np.int16)
        self.kernels.value(len(points), places, value, leaf)
        return value[: len(points)], leaf[: len(points)]


def plane_form(
    shape: Shape,
    free: tuple[int, ...] = PLANE,
    fixed: Mapping[int, float] = FLAT,
    letters: Mapping[Any, float] | None = None,
    bounds: Bounds | None = None,
) -> PlaneForm | None:
    """The sign form of a shape in a plane; None where it is so small that nothing is gained.

    Most questions come from within the bounds (2 pairs) of the plane.
    """
    if backend_for(_form(shape)) != "tape":
        return None
    fixed = fixed or FLAT
    box = None
    if bounds is not None:
        ends = dict(zip(free, bounds, strict=True)) | {axis: (value, value) for axis, value in fixed.items()}
        box = tuple(ends[axis] for axis in range(3))
    return PlaneForm(unscaled(_sign_kernels(shape), shape.letters.values_with(letters), box), free, fixed)


def _nearest_next(places: Floats) -> Ints:
    """An order of places (2, n) in which those that follow one another are near: along the curve of Morton."""
    low, width = places.min(axis=1, initial=np.inf), np.ptp(places, axis=1) if places.size else 1.0
    cell = ((places.T - low) / np.where(width > 0, width, 1.0) * 1023).astype(np.int64)
    key = sum((cell[:, axis] >> bit & 1) << 2 * bit + axis for bit in range(10) for axis in range(2))
    return np.argsort(key, kind="stable")


def _box(lattice: Lattice) -> Sequence[tuple[float, float]]:
    ends = zip(lattice.origin, lattice.spacing, lattice.counts, strict=True)
    return [(origin, origin + spacing * (count - 1)) for origin, spacing, count in ends]


def _corners(axes: Sequence[Ints]) -> Ints:
    """The corners of boxes (2, n), by rows."""
    return np.stack(np.meshgrid(*axes, indexing="ij")).reshape(2, -1)
