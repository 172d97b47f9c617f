"""Lattices: one global integer lattice for everything that is sampled.

A coordinate is always origin + spacing*index, whoever computes it, so blocks
and neighbours agree to the last bit. The lattice is shifted by a fixed fraction
of a cell: a symmetric model is then not sampled on its own planes, axes and
skeleton, where derivatives do not exist and exact zeros lie.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from rsym.arrays import Flags, Floats, Ints
from rsym.errors import RsymError
from rsym.model.shape import Bounds, Shape

# Unequal and irrational to six digits: at 50, 64, 100 and 128 cells no sample of the paper's models is an exact zero.
SHIFTS = (0.381966, 0.414214, 0.442777)
# Meshing holds 13 bytes a sample (float64, float32 and a sign): this many fill 8 GB.
MOST_POINTS = 600_000_000
AROUND = np.indices((3, 3)).reshape(2, -1).T - 1  # a cell of a plane and its neighbours
TOGETHER = 3  # cells that one place is told for, along each axis


@dataclass(frozen=True)
class Lattice:
    """Points origin + spacing*index, index from 0 to counts - 1 along each axis."""

    origin: tuple[float, ...]
    spacing: tuple[float, ...]
    counts: tuple[int, ...]

    def axis(self, k: int) -> Floats:
        """The coordinates along axis k."""
        return self.origin[k] + self.spacing[k] * np.arange(self.counts[k], dtype=np.float64)

    def open_axes(self) -> list[Floats]:
        """All axes, shaped to broadcast against each other."""
        size = len(self.counts)
        return [self.axis(k).reshape([-1 if j == k else 1 for j in range(size)]) for k in range(size)]

    def points(self, index: NDArray[Any]) -> Floats:
        """The coordinates of (fractional) indices (n, dim)."""
        places: Floats = np.asarray(self.origin) + np.asarray(self.spacing) * index
        return places


def lattice_over(bounds: Bounds, resolution: int | Sequence[int], most_points: float = MOST_POINTS) -> Lattice:
    """The shifted lattice that covers the bounds.

    `resolution` is the number of cubical cells along the longest side, or the number of cells along each axis.

    Examples
    --------
    >>> lattice_over(((0.0, 4.0), (0.0, 1.0)), 4).counts
    (6, 3)
    """
    sides = [high - low for low, high in bounds]
    if isinstance(resolution, Sequence):
        cells = [checked_cells(cell) for cell in resolution]
        if len(cells) != len(sides):
            raise RsymError(
                f"resolution must be an integer or {len(sides)} integers, got {resolution}", code="resolution"
            )
        spacing = [side / cell for side, cell in zip(sides, cells, strict=True)]
    else:
        step = max(sides) / checked_cells(resolution)
        cells = [max(1, math.ceil(side / step - 1e-9)) for side in sides]
        spacing = [step] * len(sides)
    counts = tuple(cell + 2 for cell in cells)
    if math.prod(counts) > most_points:
        raise RsymError(
            f"resolution {resolution} needs {math.prod(counts):.3g} samples, more than {most_points:.3g}",
            code="resolution",
            remedy="take a smaller resolution or tighter bounds",
        )
    origin = tuple(low - shift * step for (low, _), shift, step in zip(bounds, SHIFTS, spacing, strict=False))
    return Lattice(origin, tuple(spacing), counts)


def check_in_space(shape: Shape) -> None:
    """Raise unless a shape has three coordinates."""
    if shape.dimension != 3:
        raise RsymError(
            "mesh needs a shape in space, got one in the plane", code="dimension", remedy="use revolve(shape) first"
        )


def checked_cells(cells: Any) -> int:
    """A number of cells, if it is one."""
    if isinstance(cells, bool) or not isinstance(cells, int | np.integer) or cells < 2:
        raise RsymError(f"resolution must be an integer of at least 2, got {cells!r}", code="resolution")
    return int(cells)


def numbers_of(cells: Ints, wanted: Ints) -> Ints:
    """Which of the cells (n, 2) those that are wanted are; -1 for others.

    Examples
    --------
    >>> numbers_of(np.array([(0, 1), (5, 5)]), np.array([(5, 5), (0, 0)])).tolist()
    [1, -1]
    """
    if not len(cells):
        return np.full(len(wanted), -1)
    low, width = cells.min(axis=0) - 1, int(np.ptp(cells[:, 1])) + 3
    wanted = np.clip(wanted, low, cells.max(axis=0) + 1)
    key, asked = ((some - low) @ np.array([width, 1]) for some in (cells, wanted))
    order = np.argsort(key)
    place = np.minimum(np.searchsorted(key[order], asked), len(key) - 1)
    return np.asarray(np.where(key[order[place]] == asked, order[place], -1))


def grown(some: Flags, cells: Ints) -> Flags:
    """Some of the cells (n, 2), and those around them.

    Examples
    --------
    >>> grown(np.array([True, False, False]), np.array([(0, 1), (1, 2), (1, 3)])).tolist()
    [True, True, False]
    """
    found = some.copy()
    near = numbers_of(cells, (cells[some][:, None] + AROUND).reshape(-1, 2))
    found[near[near >= 0]] = True
    return found


def heaps(index: Floats) -> Floats:
    """Of places (n, 2) in indices the first of each heap of cells side by side, then one in each TOGETHER cells of it.

    Examples
    --------
    >>> heaps(np.array([(0.5, 0.5), (7.5, 3.5), (1.5, 1.5)])).tolist()
    [[0.5, 0.5], [7.5, 3.5]]
    >>> heaps(np.array([(0.5, 0.5), (1.5, 0.5), (2.5, 0.5), (3.5, 1.5), (4.5, 1.5)])).tolist()
    [[0.5, 0.5], [3.5, 1.5]]
    """
    cells, own = np.unique(np.floor(index).astype(np.int64), axis=0, return_inverse=True)
    near = numbers_of(cells, (cells[:, None] + AROUND).reshape(-1, 2))
    pairs = np.stack([np.repeat(np.arange(len(cells)), len(AROUND)), near])[:, near >= 0]
    links = coo_matrix((np.ones(pairs.shape[1]), pairs), shape=(len(cells), len(cells)))
    count, heap = connected_components(links, directed=False)
    low = np.full((count, 2), np.iinfo(np.int64).max)
    np.minimum.at(low, heap, cells)
    part = np.column_stack([heap, (cells - low[heap]) // TOGETHER])[own.ravel()]
    first, apart = (np.unique(some, axis=0, return_index=True)[1] for some in (part[:, :1], part))
    return np.asarray(index[np.concatenate([np.sort(first), np.setdiff1d(apart, first)])])


@dataclass(frozen=True)
class BoundsSide:
    """A side of the bounds: its name, as "the upper end of x", the axis across it and the coordinate there."""

    name: str
    axis: int
    value: float


def sides_of(names: Sequence[str], bounds: Sequence[Sequence[float]]) -> tuple[BoundsSide, ...]:
    """The sides of bounds ((low, high), ...), in the order of the coordinates.

    Examples
    --------
    >>> [side.name for side in sides_of("xyz", ((0, 1),) * 3)][:2]
    ['the lower end of x', 'the upper end of x']
    """
    return tuple(
        BoundsSide(f"the {word} end of {name}", axis, float(value))
        for axis, (name, ends) in enumerate(zip(names, bounds, strict=True))
        for word, value in zip(("lower", "upper"), ends, strict=True)
    )
