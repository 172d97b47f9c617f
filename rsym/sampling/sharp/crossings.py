"""Signs at the points of blocks, and the points where lattice edges cross the surface, each with its active leaf."""

from __future__ import annotations

from concurrent.futures import Executor
from dataclasses import dataclass
from functools import cache
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from rsym.arrays import Flags, Floats, Ints, Shorts
from rsym.errors import RsymError
from rsym.sampling.kernels.mesher_kernels import MesherKernels, columns, padded
from rsym.sampling.sharp.loops import in_threads, loop
from rsym.sampling.sharp.signs import BLOCK, Blocks, list_edges
from rsym.sampling.sharp.topology import GRAIN, Topology

BYTES = 96  # for the bits of 9x9x9 points, whole words
# Cells: a crossing lies closer to its leaf; and how far from it signs are looked at.
ZERO, ASIDE = 1e-6, 1e-9
HALVINGS = 53  # of an edge: to the last bit


@dataclass(frozen=True)
class Crossings:
    """Where lattice edges cross the surface: points (3, m), gradients (3, m) of the active leaf, its number (m,).

    The arrays are padded; the first `count` columns count.
    """

    points: Floats
    gradients: Floats
    leaf: NDArray[np.int16]
    count: int


def sample_signs(kernels: MesherKernels, blocks: Blocks, lattice: Floats, pool: Executor | None) -> NDArray[np.uint8]:
    """A bit for each point of each block, 1 where the form is not negative.

    Raises
    ------
    RsymError
        Where the form is undefined at a point.
    """
    count = blocks.corner.shape[1]
    corner = np.ascontiguousarray(blocks.corner, np.float64)
    bits, undefined = np.zeros((count, BYTES), np.uint8), np.zeros(count, np.uint8)
    arrays = (corner, blocks.words, lattice, _offsets(), bits, undefined)
    in_threads(lambda first, last: kernels.signs(first, last, *arrays), count, GRAIN, pool)
    if undefined.any():
        place = lattice[:3] + lattice[3:] * (corner[:, undefined.argmax()] + BLOCK / 2)
        raise RsymError(
            f"the shape has no value near {tuple(float(f'{c:.4g}') for c in place)}, where its boundary may be",
            code="undefined",
            remedy="give bounds inside the domain of the formula",
        )
    return bits


@cache
def _offsets() -> Floats:
    """The points of a block, in the order of their bits, padded."""
    side = BLOCK + 1
    offsets = np.zeros((3, padded(side**3)))
    offsets[:, : side**3] = np.indices((side, side, side)).reshape(3, -1)
    return offsets


def find_crossings(
    kernels: MesherKernels, blocks: Blocks, surface: Topology, lattice: Floats, pool: Executor | None
) -> Crossings:
    """Every crossing of the surface, and what it lies on."""
    points, leaf = _on_edges(kernels, blocks, surface, lattice, pool)
    gradients, value = np.zeros(points.shape), np.empty(points.shape[1])
    evaluate(kernels, leaf, points, value, gradients, surface.crossings, pool)
    doubtful = np.flatnonzero(_away(surface.crossings, value, gradients, lattice[3:]))
    if len(doubtful):
        axis, leaves = np.searchsorted(surface.axes[1:-1], doubtful, "right"), CompiledLeaves(kernels)
        points[:, doubtful] = _halved(leaves, points[:, doubtful], axis, lattice)
        leaf[doubtful] = _crossed(leaves, points[:, doubtful], leaf[doubtful], axis, lattice)
        evaluate(kernels, leaf, points, value, gradients, surface.crossings, pool)
        # At a jump slopes say nothing of the surface.
        gradients[:, np.flatnonzero(_away(surface.crossings, value, gradients, lattice[3:]))] = 0.0
    return Crossings(points, gradients, leaf, surface.crossings)


@loop
def _away(count: int, value: Floats, gradients: Floats, spacing: Floats) -> Any:
    """Whether the leaf of each crossing is not 0 there, to first order: then it may be one that only is active."""
    away = np.zeros(count, np.bool_)
    for e in range(count):
        steep = 0.0
        for axis in range(3):
            steep += abs(gradients[axis, e]) * spacing[axis]
        away[e] = not abs(value[e]) <= ZERO * steep
    return away


def _halved(leaves: CompiledLeaves, points: Floats, axis: Ints, lattice: Floats) -> Floats:
    """Crossings by halving their edges: between values of very unlike size false position comes to a halt."""
    index, which = (points - lattice[:3, None]) / lattice[3:, None], np.arange(len(axis))
    ends, along = np.rint(index), np.zeros(points.shape)
    ends[axis, which], along[axis, which] = np.floor(index[axis, which] + ZERO), 1.0

    def inside(step: Floats) -> Flags:
        return np.asarray(leaves.active(lattice[:3, None] + lattice[3:, None] * (ends + step * along))[0] >= 0)

    low, high = np.zeros(len(axis)), np.ones(len(axis))
    above = inside(low) == inside(high)  # a crossing at the upper end of its edge, the lower one of the next
    low, high = low - above, high - above
    first = inside(low)
    found = first != inside(high)
    for _ in range(HALVINGS):
        middle = (low + high) / 2
        same = inside(middle) == first
        low, high = np.where(same, middle, low), np.where(same, high, middle)
    halved = lattice[:3, None] + lattice[3:, None] * (ends + high * along)
    return np.where(found, halved, points)


def _crossed(leaves: CompiledLeaves, points: Floats, leaf: Shorts, axis: Ints, lattice: Floats) -> Shorts:
    """Of crossings the leaf whose sign changes, of those that are active right before and behind; else the known one.

    A leaf may be so steep that next to its zero another one is the smaller: which of them is crossed its sign tells.
    """
    step = np.zeros(points.shape)
    step[axis, np.arange(len(axis))] = ASIDE * lattice[3:][axis]
    sides = points - step, points + step
    (before, first), (_, second) = (leaves.active(side) for side in sides)
    result = leaf.copy()
    for candidate in (np.where(before < 0, second, first), np.where(before < 0, first, second)):
        values = [leaves.evaluate(candidate, side)[0] for side in sides]
        result = np.where((values[0] < 0) != (values[1] < 0), candidate, result)
    return np.asarray(result, np.int16)


def _on_edges(
    kernels: MesherKernels, blocks: Blocks, surface: Topology, lattice: Floats, pool: Executor | None
) -> tuple[Floats, NDArray[np.int16]]:
    """Point and leaf of each crossing."""
    edges = np.empty((3, padded(surface.crossings)), np.float32)
    points, leaf = np.zeros(edges.shape), np.full(edges.shape[1], -1, np.int16)
    for axis in range(3):
        fields, before = surface.edges[axis], surface.edges_before[axis]
        starts = np.ascontiguousarray(before[:, 0], np.int64)
        direction = np.eye(3)[axis]

        def piece(first: int, last: int, fields=fields, before=before, starts=starts, direction=direction) -> None:  # type: ignore[no-untyped-def]
            list_edges(surface.corner, fields, before, first, last, *edges)
            kernels.crossings(first, last, starts, blocks.words, edges, direction, lattice, points, leaf)

        in_threads(piece, blocks.corner.shape[1], GRAIN, pool)
    return points, leaf


def evaluate(
    kernels: MesherKernels,
    leaf: NDArray[np.int16],
    points: Floats,
    value: Floats,
    gradients: Floats,
    count: int,
    pool: Executor | None,
) -> None:
    """Value and gradient of the leaf of each point."""
    in_threads(lambda a, b: kernels.leaf(b - a, leaf, points, value, gradients, first=a), count, kernels.grain, pool)


class Leaves(Protocol):
    """What certificates, and the measures of what is thin, need of a sign form; arrays are of any layout."""

    def enclose(self, leaf: Shorts, lower: Floats, upper: Floats) -> tuple[Floats, Floats]:
        """Bounds (2, n) of leaf[k] over box k of (3, n), and (3, 2, n) of its gradient; infinite where it may fail."""

    def evaluate(self, leaf: Shorts, points: Floats) -> tuple[Floats, Floats]:
        """Values (n,) of leaf[k] at point k of (3, n), and gradients (3, n)."""

    def active(self, points: Floats) -> tuple[Floats, Shorts]:
        """Values (n,) of the form at points (3, n), and the number of the leaf that gives each."""


class CompiledLeaves:
    """The leaves of compiled kernels."""

    def __init__(self, kernels: MesherKernels) -> None:
        self._kernels = kernels

    def enclose(self, leaf: Shorts, lower: Floats, upper: Floats) -> tuple[Floats, Floats]:
        """Bounds of leaves and gradients over boxes."""
        count = len(leaf)
        bounds = np.empty((8, padded(count)))
        self._kernels.enclose(count, _numbers(leaf), columns(lower), columns(upper), bounds)
        # Contiguous whatever the padding: loops are compiled for each layout of their arrays.
        return bounds[:2, :count].copy(), bounds[2:, :count].copy().reshape(3, 2, count)

    def evaluate(self, leaf: Shorts, points: Floats) -> tuple[Floats, Floats]:
        """Values and gradients of leaves at points."""
        count = len(leaf)
        value, gradient = np.empty(padded(count)), np.empty((3, padded(count)))
        self._kernels.leaf(count, _numbers(leaf), columns(points), value, gradient)
        return value[:count], gradient[:, :count]

    def active(self, points: Floats) -> tuple[Floats, Shorts]:
        """The form at points, and its active leaf."""
        count = points.shape[1]
        value, leaf = np.empty(padded(count)), np.empty(padded(count), np.int16)
        self._kernels.value(count, columns(points), value, leaf)
        return value[:count], leaf[:count]


def _numbers(leaf: Shorts) -> Shorts:
    """Shorts of leaves, and behind them -1, which asks for nothing."""
    array = np.full(padded(len(leaf)), -1, np.int16)
    array[: len(leaf)] = leaf
    return array
