"""How far around corners no other part of the boundary lies, and leaf coordinates are one to one.

They are one to one on a disc where the symmetric part of their Jacobian is positive definite. For a leaf that is 0 on
a line stands the distance from that; where it is 0 again something else is. Boxes around each corner
are divided, the nearest in which that or the rest is not known first, until the nearest is small against its distance.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from rsym.arrays import Flags, Floats, Ints
from rsym.problems.corners.leaf_boxes import LeafBoxes
from rsym.sampling.form_signs import Boxes, grid, halves

LEAST_STRETCH = 0.1  # leaf coordinates turn no direction so far that less of it is left
NEAR_ENOUGH = 0.02  # of the distance: how large the nearest box is in the end
AROUND = 1.2  # of the distance of the nearest box: those that are divided with it
MOST = 64  # boxes of a corner that are divided at once
FINEST = 1e-7  # of the whole: where leaves through a corner are not looked at
STEPS = 300


class Tips(NamedTuple):
    """Corners: points (n, 2), both leaves, their gradients (n, 2, 2), angles, and all leaves that vanish there.

    straight : (n, 2), for which of both leaves its tangent stands, on which it is 0.
    """

    points: Floats
    leaves: Ints
    gradients: Floats
    angles: Floats
    straight: Flags
    met: Sequence[Ints]


class _Pool(NamedTuple):
    """Boxes, the corner that each belongs to, and how far from that it is."""

    boxes: Boxes
    owner: Ints
    distance: Floats

    def take(self, which: Ints) -> _Pool:
        return _Pool(self.boxes[which], self.owner[which], self.distance[which])


def reaches(leaves: LeafBoxes, tips: Tips, size: float) -> Floats:
    """A distance for each corner, at most the size."""
    count = len(tips.angles)
    found = np.full(count, size)
    if not count:
        return found
    beyond, through = _others(leaves, tips)
    fresh = _around(tips, size)
    pool = fresh.take(np.empty(0, np.int64))
    for _ in range(STEPS):
        bad = _unknown(leaves, tips, fresh, (beyond, through), FINEST * size)
        pool = _together(pool, fresh.take(np.flatnonzero(bad)))
        order = np.lexsort((pool.distance, pool.owner))
        pool = pool.take(order)
        first = np.searchsorted(pool.owner, np.arange(count))
        present = np.flatnonzero(np.searchsorted(pool.owner, np.arange(count), side="right") > first)
        nearest = first[present]
        small = pool.boxes.sides.max(axis=0)[nearest] <= NEAR_ENOUGH * pool.distance[nearest]
        found[present] = np.minimum(size, pool.distance[nearest])
        going = np.zeros(count, np.bool_)
        going[present[~small]] = True
        pool = pool.take(np.flatnonzero(going[pool.owner]))
        if not len(pool.owner):
            return found
        first = np.searchsorted(pool.owner, np.arange(count))
        place = np.arange(len(pool.owner)) - first[pool.owner]
        least = pool.distance[np.minimum(first, len(pool.owner) - 1)][pool.owner]
        chosen = (place < MOST) & (pool.distance <= AROUND * least)
        divided = pool.take(np.flatnonzero(chosen))
        pool = pool.take(np.flatnonzero(~chosen))
        boxes, origin = halves(divided.boxes)
        owner = divided.owner[origin]
        fresh = _Pool(boxes, owner, _distance(boxes, tips.points[owner].T))
    return found


def _around(tips: Tips, size: float) -> _Pool:
    """A few boxes around each corner."""
    one = grid(Boxes(np.full((2, 1), -size), np.full((2, 1), size)), 4)
    owner = np.repeat(np.arange(len(tips.angles)), len(one))
    centre = tips.points[owner].T
    boxes = Boxes(*(np.tile(end, len(tips.angles)) + centre for end in (one.lower, one.upper)))
    return _Pool(boxes, owner, _distance(boxes, centre))


def _together(one: _Pool, other: _Pool) -> _Pool:
    return _Pool(
        one.boxes.followed_by(other.boxes),
        np.concatenate([one.owner, other.owner]),
        np.concatenate([one.distance, other.distance]),
    )


def _others(leaves: LeafBoxes, tips: Tips) -> tuple[Flags, Flags]:
    """Which leaves bound something else than the edges of each corner, (leaves, n): away from it, and through it."""
    lines = np.array(leaves.lines)
    other = (lines[:, None, None] != lines[tips.leaves]).all(axis=2)
    through = np.zeros_like(other)
    for k, met in enumerate(tips.met):
        through[met, k] = True
    return other & ~through, other & through


def _unknown(leaves: LeafBoxes, tips: Tips, pool: _Pool, others: tuple[Flags, Flags], finest: float) -> Flags:
    """Whether something else may be in boxes, or leaf coordinates may fold there."""
    bounds = leaves.over(pool.boxes)
    matter = leaves.matter(bounds)
    beyond, through = others
    every, owner = np.arange(len(pool.owner)), pool.owner
    own = np.stack([bounds[tips.leaves[owner, k], :, :, every] for k in (0, 1)])  # (2, boxes, 3, 2)
    top = own[:, :, 0, 1] >= 0
    between = np.where(tips.angles[owner] < math.pi, top.all(axis=0), top.any(axis=0))
    coarse = pool.boxes.sides.max(axis=0) > finest
    # Leaves through the corner itself, away from it and between the edges.
    met: Flags = (matter & through[:, owner]).any(axis=0) & between & coarse
    inverse = np.asarray(np.linalg.inv(tips.gradients), np.float64)[owner]
    slopes, straight, tangents = own[:, :, 1:].transpose(1, 0, 2, 3), tips.straight[owner], tips.gradients[owner]
    # Of a leaf that is 0 on a line, and grows across it wherever it may be 0, there is no other zero.
    grows = (tangents[..., None] * slopes).min(axis=-1).sum(axis=-1) > 0
    # What stands for the second leaf of a flat corner goes along the edge.
    checked = straight & (np.array([True, False]) | (tips.leaves[owner, :1] != tips.leaves[owner, 1:]))
    again: Flags = (checked & ~grows & ~(own[:, :, 0, 0] > 0).T & ~(own[:, :, 0, 1] < 0).T).any(axis=1)
    slopes = np.where(straight[:, :, None, None], tangents[..., None], slopes)
    return (matter & beyond[:, owner]).any(axis=0) | met | again | _folds(inverse, slopes)


def _distance(boxes: Boxes, centre: Floats) -> Floats:
    gap = np.maximum(np.maximum(boxes.lower - centre, centre - boxes.upper), 0.0)
    distance: Floats = np.hypot(*gap)
    return distance


def _folds(inverse: Floats, slopes: Floats) -> Flags:
    """Whether A^-1 (n, 2, 2) times leaves, whose gradients have bounds (n, 2, 2, 2), may fold."""
    with np.errstate(all="ignore"):
        low, high = slopes[..., 0], slopes[..., 1]
        middle = inverse @ (low / 2 + high / 2)
        radius = np.abs(inverse) @ (high / 2 - low / 2)
        (a, b), (c, d) = middle.transpose(1, 2, 0)
        least = (a + d) / 2 - np.hypot((a - d) / 2, (b + c) / 2)
        folds: Flags = ~(least - np.sqrt((radius**2).sum(axis=(1, 2))) >= LEAST_STRETCH)
    return folds
