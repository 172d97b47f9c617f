"""Measuring what is thin: points on the surface, what lies across from them, and where two leaves come closest.

Lengths count in cells: along a unit vector n a cell is |n*spacing| long.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from rsym.arrays import Flags, Floats, Ints, Shorts
from rsym.sampling.sharp.crossings import Leaves

# Newton's method halves the distance to a double zero, so 40 turns take a cell to 1e-12; a simple zero takes six.
TURNS = 40
# Probes of a ray, in cells: nothing thinner than the first has a thickness, nothing beyond the last is thin.
FIRST, LAST, PROBES = 1e-6, 2.0, 24
# Differences of gradients: their error, the square of this, only slows Newton's method down.
STEP = 1e-4
# Steps at such a rate: five do, and twenty come from where a starting point may lie. They end where all are this short.
STEPS, STILL = 20, 1e-13
# Singular values below these shares of the largest are zero: curvature is one over a radius in cells, and planes have
# none; the unit normals of two leaves are known to the last digits.
CURVED, STRAIGHT = 1e-6, 1e-9


@dataclass(frozen=True)
class ThinRays:
    """What lies across from points of the surface.

    Attributes
    ----------
    source : (n,)
        The number of the seed.
    inward : (n,)
        Whether the ray runs through the body (a wall) or outside of it (a gap).
    place : (3, n)
        The middle between the two sides.
    cells : (n,)
        The thickness; 0 where the sign does not change at the surface.
    leaves : (2, n)
        The leaves of the two sides, the smaller number first.
    """

    source: Ints
    inward: Flags
    place: Floats
    cells: Floats
    leaves: Shorts


def project(leaves: Leaves, ids: Shorts, points: Floats, spacing: Floats) -> tuple[Floats, Floats, Flags]:
    """Newton's method onto the zero sets of leaves: points, unit normals, and which got there.

    A step is at most a cell long.
    """
    points = points.copy()
    normal, moved = np.zeros_like(points), np.full(len(ids), np.inf)
    active = np.arange(len(ids))
    for _ in range(TURNS):
        value, gradient = leaves.evaluate(ids[active], points[:, active])
        size = np.linalg.norm(gradient, axis=0)
        with np.errstate(divide="ignore", invalid="ignore"):
            normal[:, active] = gradient / size
            step = -value / size * normal[:, active]
        cells = np.linalg.norm(step / spacing[:, None], axis=0)
        usable = np.isfinite(cells)
        active, step, cells = active[usable], step[:, usable], cells[usable]
        points[:, active] += step / np.maximum(cells, 1)
        moved[active] = cells
        active = active[cells > 1e-13]
        if not len(active):
            break
    return points, normal, (moved < FIRST) & np.isfinite(normal).all(axis=0)


def across(leaves: Leaves, ids: Shorts, seeds: Floats, spacing: Floats, opposed: float) -> ThinRays:
    """From each seed to the surface on its leaf, and from there straight through the body and away from it.

    Kept are sides that face each other, the cosine of their normals below `opposed`.
    """
    points, normal, arrived = project(leaves, ids, seeds, spacing)
    near = np.abs((points - seeds) / spacing[:, None]).max(axis=0) < 1
    reached = np.flatnonzero(arrived & near)
    reached = reached[_on_surface(leaves, ids[reached], points[:, reached], spacing)]
    source, inward = np.tile(reached, 2), np.repeat([True, False], len(reached))
    start, along = points[:, source], normal[:, source] * np.where(inward, 1, -1)
    ray = along * np.linalg.norm(along * spacing[:, None], axis=0)
    cells = _first_change(leaves, start, ray, inward)
    hit = np.isfinite(cells)
    source, inward, cells = source[hit], inward[hit], cells[hit]
    start, along, ray = start[:, hit], along[:, hit], ray[:, hit]
    beyond = start + np.maximum(cells * (1 + FIRST), FIRST) * ray
    _, other = leaves.active(beyond)
    _, gradient = leaves.evaluate(other, beyond)
    cosine = np.where(inward, 1, -1) * (gradient * along).sum(axis=0)
    facing = cosine < opposed * np.linalg.norm(gradient, axis=0)
    pair = np.sort(np.stack([ids[source], other]), axis=0)
    place = start + cells / 2 * ray
    return ThinRays(source[facing], inward[facing], place[:, facing], cells[facing], pair[:, facing])


def _on_surface(leaves: Leaves, ids: Shorts, points: Floats, spacing: Floats) -> Flags:
    """Whether the form vanishes where a leaf does."""
    value, which = leaves.active(points)
    _, gradient = leaves.evaluate(ids, points)
    small = FIRST * np.linalg.norm(gradient * spacing[:, None], axis=0)
    return np.asarray((which == ids) | (np.abs(value) <= small))


def _first_change(leaves: Leaves, start: Floats, ray: Floats, inside: Flags) -> Floats:
    """How far along each ray the form first has the other sign; infinite where nowhere near."""

    def turned(which: Any, distance: Floats) -> Flags:
        value, _ = leaves.active(start[:, which] + distance * ray[:, which])
        return np.where(inside[which], value < 0, value >= 0)

    count = start.shape[1]
    probes = np.geomspace(FIRST, LAST, PROBES)
    every = np.repeat(np.arange(count), PROBES)
    changed = turned(every, np.tile(probes, count)).reshape(count, PROBES)
    first = changed.argmax(axis=1)
    hit = np.flatnonzero(changed.any(axis=1) & (first > 0))
    low, high = probes[first[hit] - 1], probes[first[hit]]
    for _ in range(30):
        middle = (low + high) / 2
        beyond = turned(hit, middle)
        low, high = np.where(beyond, low, middle), np.where(beyond, middle, high)
    distance = np.where(changed[:, 0], 0.0, np.inf)
    distance[hit] = (low + high) / 2
    return distance


def closest(leaves: Leaves, pair: Shorts, points: Floats, spacing: Floats) -> tuple[Floats, Floats, Flags]:
    """Where two leaves come closest: the middle, by Gauss and Newton from given points, the distance, and if found.

    The equations for three coordinates are f/|f'| = g/|g'| and f'/|f'| = -g'/|g'|. From where they hold both leaves
    are reached along one normal. The distance counts in cells; it is negative where both are negative between them.
    """
    for _ in range(STEPS):
        equations = _facing(leaves, pair, _around(points, spacing), spacing)
        step, _ = _least_step(_differences(equations), equations[:, :, 0].T, CURVED)
        points = points + spacing[:, None] * step
        if np.abs(step).max(initial=0) < STILL:
            break
    equations = _facing(leaves, pair, points[:, :, None], spacing)
    one, normal, reached = project(leaves, pair[0], points, spacing)
    other, _, too = project(leaves, pair[1], points, spacing)
    found = (np.linalg.norm(equations[:, :, 0], axis=0) < FIRST) & reached & too
    between = (normal * (other - one)).sum(axis=0) / np.linalg.norm(normal * spacing[:, None], axis=0)
    return (one + other) / 2, between, found


def _facing(leaves: Leaves, pair: Shorts, points: Floats, spacing: Floats) -> Floats:
    """The equations of `closest` at points (3, n, m), in cells."""
    _, count, many = points.shape
    flat = points.reshape(3, -1)
    (f, u), (g, v) = (_signed_distance(leaves, np.repeat(ids, many), flat, spacing) for ids in pair)
    return np.concatenate([[f - g], u + v]).reshape(4, count, many)


def _signed_distance(leaves: Leaves, ids: Shorts, points: Floats, spacing: Floats) -> tuple[Floats, Floats]:
    """A Newton step in cells, and the unit normal."""
    value, gradient = leaves.evaluate(ids, points)
    with np.errstate(divide="ignore", invalid="ignore"):
        normal = gradient / np.linalg.norm(gradient, axis=0)
        return value / np.linalg.norm(gradient * spacing[:, None], axis=0), normal


def common(leaves: Leaves, pair: Shorts, points: Floats, spacing: Floats) -> tuple[Floats, Flags]:
    """The nearest points where two leaves vanish together, by Newton's shortest steps, and where they exist."""
    for _ in range(STEPS):
        values, rows = [], []
        for ids in pair:
            cells, normal = _signed_distance(leaves, ids, points, spacing)
            slope = normal * spacing[:, None]
            values.append(cells)
            rows.append(slope / np.linalg.norm(slope, axis=0))
        right = np.stack(values, axis=1)
        step, good = _least_step(np.stack(rows).transpose(2, 0, 1), right, STRAIGHT)
        points = points + spacing[:, None] * step
        if np.abs(step).max(initial=0) < STILL:
            break
    with np.errstate(invalid="ignore"):
        return points, good & np.asarray(np.abs(right).max(axis=1) < FIRST)


def level(leaves: Leaves, ids: Shorts, points: Floats, spacing: Floats) -> tuple[Floats, Flags]:
    """Where the gradients of leaves vanish, by Newton's method, and whether the leaf vanishes there too."""
    for _ in range(STEPS):
        around = _around(points, spacing)
        value, gradient = leaves.evaluate(np.repeat(ids, around.shape[2]), around.reshape(3, -1))
        slope = (gradient * spacing[:, None]).reshape(around.shape)
        matrix, right = _differences(slope), slope[:, :, 0].T
        step, good = _least_step(matrix, right, STRAIGHT)
        points = points + spacing[:, None] * step
        if np.abs(step).max(initial=0) < STILL:
            break
    size = np.abs(np.where(good[:, None, None], matrix, 0)).max(axis=(1, 2))
    with np.errstate(invalid="ignore"):
        flat = np.linalg.norm(right, axis=1) <= FIRST * size
        zero = np.abs(value.reshape(around.shape[1:])[:, 0]) <= FIRST * size
    return points, good & flat & zero & (size > 0)


def _around(points: Floats, spacing: Floats) -> Floats:
    """Points (3, n) and their neighbours a STEP away along each axis, forwards and backwards: (3, n, 7)."""
    offsets = np.concatenate([np.zeros((3, 1)), STEP * np.eye(3), -STEP * np.eye(3)], axis=1)
    around: Floats = points[:, :, None] + (spacing[:, None] * offsets)[:, None]
    return around


def _differences(values: Floats) -> Floats:
    """Derivatives (n, rows, 3), per cell, of values (rows, n, 7) at such neighbours."""
    return np.moveaxis((values[:, :, 1:4] - values[:, :, 4:]) / (2 * STEP), 0, 1)


def _least_step(matrix: Floats, right: Floats, rank: float) -> tuple[Floats, Flags]:
    """Solutions (3, n) of matrix*step = -right, the shortest, of at most a cell; none, and false, for what is NaN."""
    good = np.asarray(np.isfinite(right).all(axis=1) & np.isfinite(matrix).all(axis=(1, 2)))
    inverse = np.linalg.pinv(np.where(good[:, None, None], matrix, 0), rcond=rank)
    step = -(inverse @ np.where(good[:, None], right, 0)[:, :, None])[:, :, 0].T
    return step / np.maximum(np.linalg.norm(step, axis=0), 1), good
