"""Vertices on edges and corners: Newton's method on two or three leaves at once, without thresholds.

Which leaves meet in a patch is known from its crossings. A solution counts if it lies on the surface and within
reach: a feature may pass beside the cell whose crossings show it. Vertices that are not on the surface in the end, the
strays, are found with the same measure.
"""

from __future__ import annotations

from concurrent.futures import Executor
from itertools import combinations
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rsym.arrays import Flags, Floats, Ints, Shorts
from rsym.sampling.kernels.mesher_kernels import MesherKernels, columns, padded
from rsym.sampling.sharp.crossings import Crossings, evaluate
from rsym.sampling.sharp.faces import smallest
from rsym.sampling.sharp.loops import in_threads, loop
from rsym.sampling.sharp.topology import Topology
from rsym.sampling.status import OffSurface

# A fixed number, so that no point depends on the others. Planes take one step, the edges of the car at most five.
STEPS = 8
# Cells. Leaves that meet at 14 degrees have their edge four cells beyond the last lattice point between them: with a
# reach of two the headlights of the car have horns at 360 and 512 cells, with five there are folds at 200.
REACH = 4.0
# From a kink, in cells: far enough for a gradient.
ASIDE = 1e-7 * np.array([[3.0], [4.0], [5.0]])
MOST_LEAVES = 6  # of a patch that are told apart

# Leaves have gradients of length 1 to 2, by and large: a value below this share of what counts needs no second look.
CLEARLY = 1e-3


def settle(
    kernels: MesherKernels,
    which: Ints,
    start: Floats,
    surface: Topology,
    crossings: Crossings,
    lattice: Floats,
    pool: Executor | None,
) -> Floats:
    """The places (3, n) of the vertices `which`, from where they start.

    First all leaves of a patch at once, of more than three each three; then pairs; then whichever leaf is active.
    Of several solutions the nearest counts.
    """
    leaves, kinds = np.full((MOST_LEAVES, len(which)), -1, np.int16), np.zeros(len(which), np.int8)
    distinct_leaves(which, surface.ring_start, surface.ring, crossings.leaf, leaves, kinds)
    result, open_ = start.copy(), np.ones(len(which), np.bool_)
    for size in (3, 2):
        owner, chosen = _subsets(leaves, kinds, size, open_)
        if len(owner):
            solutions = solve(kernels, chosen, start[:, owner], lattice, pool)
            best = _best(kernels, owner, solutions, start, lattice, pool)
            result[:, owner[best]] = solutions[:, best]
            open_[owner[best]] = False
    rest = np.flatnonzero(open_)
    result[:, rest] = on_active_leaf(kernels, start[:, rest], lattice, pool)
    return result


@loop
def distinct_leaves(which: Any, ring_start: Any, ring: Any, leaf: Shorts, leaves: Shorts, kinds: Any) -> None:
    """The different leaves among the crossings of some patches (rows of a column), and how many."""
    for w in range(len(which)):
        for at in range(ring_start[which[w]], ring_start[which[w] + 1]):
            one, known = leaf[ring[at]], False
            for k in range(kinds[w]):
                known |= leaves[k, w] == one
            if not known and kinds[w] < MOST_LEAVES:
                leaves[kinds[w], w] = one
                kinds[w] += 1


def _subsets(leaves: Shorts, kinds: NDArray[np.int8], size: int, open_: Flags) -> tuple[Ints, Shorts]:
    """The subsets of `size` leaves of each open vertex: whose they are, and the leaves (3, m), -1 for none."""
    owners, chosen = [], []
    for kind in range(size, MOST_LEAVES + 1):
        some = np.flatnonzero(open_ & (kinds == kind))
        for subset in combinations(range(kind), size):
            owners.append(some)
            rows = np.full((3, len(some)), -1, np.int16)
            rows[:size] = leaves[np.array(subset)[:, None], some]
            chosen.append(rows)
    return np.concatenate(owners), np.concatenate(chosen, axis=1)


def solve(kernels: MesherKernels, leaves: Shorts, start: Floats, lattice: Floats, pool: Executor | None) -> Floats:
    """Newton's method on up to three leaves for each point, least norm."""
    points, cell = start.copy(), float(lattice[3:].max())
    size = int((leaves >= 0).any(axis=1).sum())

    def piece(first: int, last: int) -> None:
        """All leaves of all points in one call: `width` of the first leaves, then of the second ones."""
        which, own, matrix = np.arange(first, last), points[:, first:last].copy(), np.empty((3, 4))
        count = 0
        for _ in range(STEPS):
            if len(which) != count:
                count, width = len(which), padded(len(which))
                ids, values = np.full((size, width), -1, np.int16), np.zeros((size, width))
                places, gradients = np.zeros((3, size, width)), np.zeros((3, size, width))
                ids[:, :count] = leaves[:size, which]
            before = own.copy()
            places[:, :, :count] = own[:, None]
            given, found = places.reshape(3, -1), gradients.reshape(3, -1)
            kernels.leaf(given.shape[1], ids.ravel(), given, values.ravel(), found)
            newton_step(ids, values, gradients, cell, own, matrix)
            which, own = _moving(which, own, before, points)
            if not len(which):
                return
        points[:, which] = own

    if size:
        in_threads(piece, points.shape[1], kernels.grain, pool)
    return points


def _moving(which: Ints, own: Floats, before: Floats, points: Floats) -> tuple[Ints, Floats]:
    """The points `own` (3, n) that a step has moved, numbers and all; the others never move again, and go to `points`.

    Unless these are few: then all go on.
    """
    one, other = own.view(np.int64), before.view(np.int64)  # what is not a number does not differ from itself
    moved = np.logical_or.reduce(one != other)
    if 2 * np.count_nonzero(moved) > len(which):
        return which, own
    points[:, which] = own
    still = np.flatnonzero(moved)
    return which[still], own.take(still, axis=1)


@loop
def newton_step(ids: Shorts, values: Floats, gradients: Floats, cell: float, points: Floats, matrix: Floats) -> None:
    """The step of least norm to where the tangent planes of the leaves of each point meet; a cell at most.

    Of the points (3, n) the leaves (k, m), their values (k, m) and gradients (3, k, m); `matrix` (3, 4) is scratch.
    """
    for w in range(points.shape[1]):
        size = 0
        while size < len(ids) and ids[size, w] >= 0:
            size += 1
        for i in range(size):
            for j in range(size):
                matrix[i, j] = 0.0
                for a in range(3):
                    matrix[i, j] += gradients[a, i, w] * gradients[a, j, w]
            matrix[i, i] *= 1 + 1e-14
            matrix[i, 3] = -values[i, w]
        for i in range(size):
            for j in range(i + 1, size):
                factor = matrix[j, i] / matrix[i, i]
                for q in range(i, size):
                    matrix[j, q] -= factor * matrix[i, q]
                matrix[j, 3] -= factor * matrix[i, 3]
        for i in range(size - 1, -1, -1):
            for j in range(i + 1, size):
                matrix[i, 3] -= matrix[i, j] * matrix[j, 3]
            matrix[i, 3] /= matrix[i, i]
        for a in range(3):
            step = 0.0
            for i in range(size):
                step += matrix[i, 3] * gradients[a, i, w]
            step = -cell if -cell > step else step
            points[a, w] += cell if cell < step else step


def _best(
    kernels: MesherKernels, owner: Ints, points: Floats, start: Floats, lattice: Floats, pool: Executor | None
) -> Ints:
    """Which solution each owner takes, if any: on the surface, within reach, and the nearest of those."""
    away = ((points - start[:, owner]) / lattice[3:].max()) ** 2
    good: Flags = (away <= REACH**2).all(axis=0) & on_surface(off_surface(kernels, points, lattice, pool), lattice)
    order: Ints = np.lexsort((away.sum(axis=0), owner))
    order = order[good[order]]
    return order[np.flatnonzero(np.diff(owner[order], prepend=-1))]


def off_surface(kernels: MesherKernels, points: Floats, lattice: Floats, pool: Executor | None) -> Floats:
    """How far points are from the surface, to first order, in cells; NaN where that cannot be said."""
    count = points.shape[1]
    places = columns(points)
    value, gradient = np.empty(places.shape[1]), np.empty(places.shape)
    leaf = np.full(places.shape[1], -1, np.int16)
    in_threads(lambda a, b: kernels.value(b - a, places, value, leaf, first=a), count, kernels.grain, pool)
    evaluate(kernels, leaf, places, value, gradient, count, pool)
    with np.errstate(all="ignore"):
        cells: Floats = np.abs(value[:count]) / np.linalg.norm(gradient[:, :count] * lattice[3:, None], axis=0)
    return cells


def on_surface(cells: Floats, lattice: Floats) -> Flags:
    """Whether so many cells off the surface are none, to rounding."""
    return np.asarray(cells * lattice[3:].min() < smallest(lattice))


def is_inside(kernels: MesherKernels, points: Floats, pool: Executor | None) -> Flags:
    """Where the form is not negative."""
    count, places = points.shape[1], columns(points)
    value, leaf = np.empty(places.shape[1]), np.empty(places.shape[1], np.int16)
    in_threads(lambda a, b: kernels.value(b - a, places, value, leaf, first=a), count, kernels.grain, pool)
    return np.asarray(value[:count] >= 0)


def on_active_leaf(kernels: MesherKernels, start: Floats, lattice: Floats, pool: Executor | None) -> Floats:
    """Newton's method on the leaf that is active where a point is.

    What does not end on the surface starts once more, from a little beside a kink; where leaves take turns, as beside
    an edge that no crossing shows, it goes on with all of them at once.
    """
    points = _slid(kernels, start, pool)
    for again in (_from_beside, _on_all_active):
        stuck = np.flatnonzero(~is_zero(kernels, points, lattice, pool))
        if len(stuck):
            other = again(kernels, start[:, stuck], points[:, stuck], lattice, pool)
            good = is_zero(kernels, other, lattice, pool)
            good &= (np.abs(other - start[:, stuck]) <= REACH * lattice[3:].max()).all(axis=0)
            points[:, stuck[good]] = other[:, good]
    return points


def _from_beside(
    kernels: MesherKernels, start: Floats, points: Floats, lattice: Floats, pool: Executor | None
) -> Floats:
    return _slid(kernels, start + ASIDE * lattice[3:, None], pool)


def _on_all_active(
    kernels: MesherKernels, start: Floats, points: Floats, lattice: Floats, pool: Executor | None
) -> Floats:
    """Newton's method on the three leaves that are active first, from where points came to."""
    count = points.shape[1]
    places, value = columns(points), np.empty(padded(count))
    leaf, visited = np.full(places.shape[1], -1, np.int16), np.empty((STEPS, count), np.int16)
    for row in visited:
        kernels.value(count, places, value, leaf)
        kernels.slide(count, leaf, places, 1)
        row[:] = leaf[:count]
    leaves = np.full((3, count), -1, np.int16)
    for k, column in enumerate(visited.T.tolist()):
        distinct = list(dict.fromkeys(column))[:3]
        leaves[: len(distinct), k] = distinct
    return solve(kernels, leaves, points, lattice, pool)


def is_zero(kernels: MesherKernels, points: Floats, lattice: Floats, pool: Executor | None) -> Flags:
    """Whether the form is zero, to rounding: also on kinks. Leaves have gradients of length 1 or so."""
    count, places = points.shape[1], columns(points)
    value, leaf = np.empty(places.shape[1]), np.empty(places.shape[1], np.int16)
    in_threads(lambda a, b: kernels.value(b - a, places, value, leaf, first=a), count, kernels.grain, pool)
    return np.asarray(np.abs(value[:count]) < smallest(lattice))


def _slid(kernels: MesherKernels, start: Floats, pool: Executor | None) -> Floats:
    """Newton steps; a point that comes to a kink, where there is no gradient, stays there."""
    points = start.copy()

    def piece(first: int, last: int) -> None:
        which, own = np.arange(first, last), points[:, first:last].copy()
        for _ in range(STEPS):
            count, places = len(which), columns(own)
            leaf = np.full(places.shape[1], -1, np.int16)
            kernels.value(count, places, np.empty(places.shape[1]), leaf)
            kernels.slide(count, leaf, places, 1)
            lost = ~np.isfinite(places[:, :count]).all(axis=0)
            which, own = _moving(which, np.where(lost, own, places[:, :count]), own, points)
            if not len(which):
                return
        points[:, which] = own

    in_threads(piece, points.shape[1], kernels.grain, pool)
    return points


def stray_vertices(
    kernels: MesherKernels, vertices: Floats, lattice: Floats, pool: Executor | None
) -> OffSurface | None:
    """How many of the vertices (n, 3) are off the surface, and the worst of them."""
    count = len(vertices)
    points = columns(vertices.T)
    value, leaf = np.empty(padded(count)), np.empty(padded(count), np.int16)
    in_threads(lambda a, b: kernels.value(b - a, points, value, leaf, first=a), count, kernels.grain, pool)
    doubtful = np.flatnonzero(~(np.abs(value[:count]) < CLEARLY * smallest(lattice)))
    if not len(doubtful):
        return None
    cells = np.nan_to_num(off_surface(kernels, points[:, doubtful], lattice, pool), nan=np.inf)
    strays = ~on_surface(cells, lattice)
    # Of leaves so steep that a rounding is more than the distance of others, signs tell.
    strays[strays] = ~_between_signs(kernels, points[:, doubtful[strays]], lattice, pool)
    if not strays.any():
        return None
    cells = np.where(strays, cells, 0.0)
    worst = int(cells.argmax())
    x, y, z = (float(f"{coordinate:.4g}") for coordinate in points[:, doubtful[worst]])
    return OffSurface(int(strays.sum()), float(cells[worst]), (x, y, z))


def _between_signs(kernels: MesherKernels, points: Floats, lattice: Floats, pool: Executor | None) -> Flags:
    """Whether the form has both signs next to points, as near as makes no difference."""
    aside = smallest(lattice) * np.concatenate([np.eye(3), -np.eye(3)])
    signs = np.stack([is_inside(kernels, points + step[:, None], pool) for step in aside])
    return np.asarray(signs.any(axis=0) & ~signs.all(axis=0))
