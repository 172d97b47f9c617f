"""The sign of a shape on a plane lattice: most of it known by boxes, the rest by what matters in small ones."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import lru_cache, partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rsym.arrays import Floats, Ints
from rsym.backends.kernel import checked_threads, lasting_threads
from rsym.logic.sign_form import SignForm, sign_form
from rsym.model.blends.gates import with_gates
from rsym.model.shape import Shape
from rsym.program.builder import Builder
from rsym.program.lowering import lower
from rsym.sampling.lattice import Lattice
from rsym.sampling.regions.region_kernels import RegionKernels, Run, region_kernels
from rsym.sampling.regions.regions import INSIDE, KEPT, Regions
from rsym.sampling.sharp.loops import in_threads

# Points along a side of the boxes: of a text of 7 900 operations 334 matter in the large ones and 35 in the small.
LARGE, SMALL = 64, 8
GRAIN = 256  # small boxes
ACROSS = "across it"  # kernels have three coordinates; no user has one of this name


def plane_form(shape: Shape) -> SignForm:
    """The sign form of a plane shape, in space."""
    names = (*(symbol.name for symbol in shape.coordinates), ACROSS)
    builder = Builder(names, tuple(shape.letters))
    return sign_form(builder, lower(builder, with_gates(shape.expression)))


@lru_cache(maxsize=8)
def _kernels(shape: Shape) -> RegionKernels:
    return region_kernels(plane_form(shape))


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
    kernels = _kernels(shape).copy()
    kernels.set(shape.letters.values_with(letters), (*_box(lattice), (0.0, 0.0)))
    count = checked_threads(threads)
    pool = lasting_threads("rsym-plane", count) if count > 1 else None
    run = partial(in_threads, pool=pool)
    flat = np.array([*lattice.origin, 0.0, *lattice.spacing, 0.0])
    shape_of = tuple(-(-points // SMALL) for points in lattice.counts)
    tiles = np.full((shape_of[0], SMALL, shape_of[1], SMALL), -1, np.int8)
    corner = _corners([np.arange(0, points, LARGE) for points in lattice.counts])
    sides, regions = kernels.sides(
        _ends(flat, corner, LARGE, lattice.counts), np.zeros(corner.shape[1], np.int64), None, run
    )
    for place in (corner[:, sides == INSIDE] // SMALL).T:
        tiles[place[0] : place[0] + LARGE // SMALL, :, place[1] : place[1] + LARGE // SMALL] = 1
    kept = np.flatnonzero(sides == KEPT)
    within = _corners([np.arange(0, LARGE, SMALL)] * 2)
    small = (corner[:, kept, None] + within[:, None, :]).reshape(2, -1)
    parent = np.repeat(np.arange(len(kept)), within.shape[1])
    some = (small < np.array(lattice.counts)[:, None]).all(axis=0)
    small, parent = small[:, some], parent[some]
    sides, regions = kernels.sides(_ends(flat, small, SMALL, lattice.counts), parent, regions[kept], run)
    inside = small[:, sides == INSIDE] // SMALL
    tiles[inside[0], :, inside[1]] = 1
    last = sides == KEPT
    _fill(kernels, small[:, last], regions[last], flat, tiles, run)
    points = tiles.reshape(SMALL * shape_of[0], SMALL * shape_of[1])
    return points[: lattice.counts[0], : lattice.counts[1]]


def _box(lattice: Lattice) -> Sequence[tuple[float, float]]:
    ends = zip(lattice.origin, lattice.spacing, lattice.counts, strict=True)
    return [(origin, origin + spacing * (count - 1)) for origin, spacing, count in ends]


def _corners(axes: Sequence[Ints]) -> Ints:
    """The corners of boxes (2, n), by rows."""
    return np.stack(np.meshgrid(*axes, indexing="ij")).reshape(2, -1)


def _ends(flat: Floats, corner: Ints, size: int, counts: Sequence[int]) -> Floats:
    """The ends (6, n) of what the points of boxes fill."""
    ends = np.zeros((6, corner.shape[1]))
    for k in range(2):
        ends[2 * k] = flat[k] + flat[3 + k] * corner[k]
        ends[2 * k + 1] = flat[k] + flat[3 + k] * np.minimum(corner[k] + size - 1, counts[k] - 1)
    return ends


def _fill(
    kernels: RegionKernels, corner: Ints, regions: Regions, flat: Floats, tiles: NDArray[np.int8], run: Run
) -> None:
    """The signs at the points of small boxes, each by its region."""
    places = np.zeros((3, corner.shape[1]))
    places[:2] = corner
    offsets = np.zeros((3, SMALL * SMALL))
    offsets[:2] = _corners([np.arange(SMALL)] * 2)

    def part(first: int, last: int) -> None:
        bits, undefined = np.zeros((last - first, SMALL), np.uint8), np.zeros(last - first, np.uint8)
        own = np.ascontiguousarray(places[:, first:last])
        kernels.signs(0, last - first, own, regions[first:last], flat, offsets, bits, undefined)
        positive = np.unpackbits(bits, axis=1, bitorder="little").reshape(-1, SMALL, SMALL)
        tile = corner[:, first:last] // SMALL
        tiles[tile[0], :, tile[1]] = 2 * positive.astype(np.int8) - 1

    run(part, corner.shape[1], GRAIN)
