"""Vertices on the surface within their cells: by Newton's method, and by signs where it carries them away.

Far from its zeros a steep function is flat, or so large that a step says nothing: of tanh(1e4 D) a step leads beyond
all bounds, of 1 - x**200 - y**200 - z**200 out of the cell. Between the middle of the crossings of a patch and an end
of their edges with the other sign there is a zero, whatever the slopes are.
"""

from __future__ import annotations

from concurrent.futures import Executor
from typing import Any

import numpy as np

from rsym.arrays import Flags, Floats, Integers, Ints, Shorts
from rsym.sampling.kernels.mesher_kernels import MesherKernels, columns, padded
from rsym.sampling.sharp.corners import is_inside, is_zero, off_surface, on_surface
from rsym.sampling.sharp.crossings import HALVINGS, ZERO, Crossings, evaluate
from rsym.sampling.sharp.faces import ranges
from rsym.sampling.sharp.loops import in_threads, loop
from rsym.sampling.sharp.topology import Topology

# From a hundredth of a cell off, four steps end at rounding: 1e-2, 1e-4, 1e-8, 1e-16.
STEPS = 4
AT_ONCE = 1024  # edges and corners
AWAY = 1.0  # cells beyond its own: there no vertex of one leaf has to be
# Cells of the last of Newton's steps. From a hundredth of a cell off, the fourth is far shorter.
SETTLED = 1e-6
GRAIN = 1024


def slid(
    kernels: MesherKernels,
    single: Shorts,
    points: Floats,
    surface: Topology,
    crossings: Crossings,
    lattice: Floats,
    pool: Executor | None,
) -> Ints:
    """Newton's method on the leaf of each vertex that has one, in place; which of them it may have carried away."""
    count, astray = surface.vertices, np.zeros(surface.vertices, np.bool_)
    rings = surface.ring_start, surface.ring, crossings.points

    def piece(first: int, last: int) -> None:
        kernels.slide(last - first, single, points, STEPS - 1, first=first)
        own = np.full(padded(last - first), -1, np.int16)
        own[: last - first] = single[first:last]
        places = columns(points[:, first:last])
        value, gradient = np.zeros(len(own)), np.zeros(places.shape)
        kernels.leaf(last - first, own, places, value, gradient)
        _last_step(first, last, *rings, single, value, gradient, lattice[3:], points, astray)

    in_threads(piece, count, GRAIN, pool)
    return np.flatnonzero(astray)


def bring_back(
    kernels: MesherKernels,
    lost: Ints,
    features: Ints,
    points: Floats,
    surface: Topology,
    crossings: Crossings,
    lattice: Floats,
    pool: Executor | None,
) -> None:
    """Put vertices that are off the surface, or `lost` ones away from their cells, on it in their cells, in place."""
    which = np.concatenate([lost, features])
    if not len(which):
        return
    where = points[:, which]
    on = is_zero(kernels, where, lattice, pool) | on_surface(off_surface(kernels, where, lattice, pool), lattice)
    low = lattice[:3, None] + lattice[3:, None] * (cells_of(which, surface) - AWAY)
    near = np.asarray(((low <= where) & (where <= low + lattice[3:, None] * (1 + 2 * AWAY))).all(axis=0))
    # Edges and corners may lie beside the cell whose crossings show them, on a leaf of these.
    near[len(lost) :] = _on_own(kernels, features, where[:, len(lost) :], surface, crossings, lattice, pool)
    bad = which[~(on & near)]
    if len(bad):
        points[:, bad] = bracketed(kernels, bad, surface, crossings, lattice, pool)


def _on_own(
    kernels: MesherKernels,
    which: Ints,
    where: Floats,
    surface: Topology,
    crossings: Crossings,
    lattice: Floats,
    pool: Executor | None,
) -> Flags:
    """Whether points (3, n) lie on a leaf of the crossings around some vertices: not where one has a kink far away.

    Some at a time: there are several crossings around each, which no claim of memory knows of.
    """
    found = np.zeros(len(which), np.bool_)
    for first in range(0, len(which), AT_ONCE):
        some = slice(first, first + AT_ONCE)
        begin = surface.ring_start[which[some]]
        owner, at = ranges(begin, surface.ring_start[which[some] + 1] - begin)
        leaf, places = np.full(padded(len(at)), -1, np.int16), columns(where[:, some][:, owner])
        leaf[: len(at)] = crossings.leaf[surface.ring[at]]
        value, gradient = np.zeros(len(leaf)), np.zeros(places.shape)
        evaluate(kernels, leaf, places, value, gradient, len(at), pool)
        steep = np.abs(crossings.gradients[:, surface.ring[at]]).T @ lattice[3:]  # at a kink it may be without bound
        on = (np.abs(value[: len(at)]) <= ZERO * steep) | (steep == 0)  # at a jump slopes say nothing
        found[some] = np.bincount(owner, on, len(begin)) > 0
    return found


@loop
def _last_step(
    first: int,
    last: int,
    ring_start: Any,
    ring: Any,
    crossing: Floats,
    single: Shorts,
    value: Floats,
    gradient: Floats,
    spacing: Floats,
    points: Floats,
    astray: Flags,
) -> None:
    """Newton's last step of those of one leaf; those are astray that it moves far, or that are away from crossings.

    Of the points from `first` on `value` (n,) and `gradient` (3, n) of their leaves.
    """
    for v in range(first, last):
        if single[v] < 0:
            continue
        f, begin, end = value[v - first], ring_start[v], ring_start[v + 1]
        gx, gy, gz = gradient[0, v - first], gradient[1, v - first], gradient[2, v - first]
        share = f / (gx * gx + gy * gy + gz * gz + 1e-300)
        near = abs(f) <= SETTLED * (abs(gx) * spacing[0] + abs(gy) * spacing[1] + abs(gz) * spacing[2])
        for axis in range(3):
            middle = 0.0
            for at in range(begin, end):
                middle += crossing[axis, ring[at]]
            near &= abs(points[axis, v] - middle / (end - begin)) <= AWAY * spacing[axis]
            points[axis, v] -= share * gradient[axis, v - first]
        astray[v] = not near


def bracketed(
    kernels: MesherKernels,
    which: Ints,
    surface: Topology,
    crossings: Crossings,
    lattice: Floats,
    pool: Executor | None,
) -> Floats:
    """A point (3, n) of the surface in the cell of each of some vertices."""
    begin, count = surface.ring_start[which], surface.ring_start[which + 1] - surface.ring_start[which]
    owner, at = ranges(begin, count)
    ring, starts = surface.ring[at], np.cumsum(count) - count
    on, first = crossings.points[:, ring], cells_of(which, surface)[:, owner]
    index = np.rint((on - lattice[:3, None]) / lattice[3:, None])
    axis, columns_ = np.searchsorted(surface.axes[1:-1], ring, "right"), np.arange(len(ring))
    ends = np.stack([index, index])
    ends[0, axis, columns_] = first[axis, columns_]
    ends[1, axis, columns_] = first[axis, columns_] + 1
    ends = lattice[:3, None] + lattice[3:, None] * ends
    lower = is_inside(kernels, ends[0], pool)
    inner, outer = np.where(lower, ends[0], ends[1]), np.where(lower, ends[1], ends[0])

    def mean(places: Floats) -> Floats:
        return np.asarray(np.add.reduceat(places, starts, axis=1) / count)

    here = mean(on)
    inside = is_inside(kernels, here, pool)
    there = np.where(inside, mean(outer), mean(inner))
    alike = is_inside(kernels, there, pool) == inside
    there = np.where(alike, np.where(inside, outer[:, starts], inner[:, starts]), there)
    for _ in range(HALVINGS):
        middle = (here + there) / 2
        same = is_inside(kernels, middle, pool) == inside
        here, there = np.where(same, middle, here), np.where(same, there, middle)
    return here


def cells_of(which: Integers, surface: Topology) -> Floats:
    """The cells (3, n) of vertices, counted from the first of the lattice."""
    cell = np.searchsorted(surface.start, which, "right") - 1
    place = surface.place[cell].astype(np.int64)
    return np.asarray(surface.corner[:, place >> 9] + np.stack([place >> 6 & 7, place >> 3 & 7, place & 7]))
