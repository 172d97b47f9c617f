"""Boxes in arrays: points, faces, grids, slabs and halves."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rsym.arrays import Floats


@dataclass(frozen=True)
class Boxes:
    """n boxes: their lower and their upper ends, (dim, n) each."""

    lower: Floats
    upper: Floats

    def __len__(self) -> int:
        return int(self.lower.shape[1])

    def __getitem__(self, which: NDArray[Any]) -> Boxes:
        return Boxes(self.lower[:, which], self.upper[:, which])

    @property
    def sides(self) -> Floats:
        """The lengths of the sides, (dim, n)."""
        return self.upper - self.lower

    @property
    def centres(self) -> Floats:
        """The middle points, (dim, n)."""
        return self.lower / 2 + self.upper / 2

    def hull(self) -> Boxes:
        """The one box around them all."""
        return Boxes(self.lower.min(axis=1, keepdims=True), self.upper.max(axis=1, keepdims=True))

    def followed_by(self, other: Boxes) -> Boxes:
        """These boxes, then the others."""
        return Boxes(np.hstack([self.lower, other.lower]), np.hstack([self.upper, other.upper]))


def points(places: Floats) -> Boxes:
    """Boxes of one point each, (dim, n)."""
    return Boxes(places, places)


def cube(dimension: int, size: float) -> Boxes:
    """The cube max|x_i| <= size."""
    return Boxes(np.full((dimension, 1), -size), np.full((dimension, 1), size))


def slabs(box: Boxes, thickness: Floats) -> Boxes:
    """At the lower and the upper side of each axis of a box a slab of the thickness (dim, 2).

    Examples
    --------
    >>> sides = slabs(cube(2, 1.0), np.array([[0.0, 0.0], [0.5, 1.0]]))
    >>> sides.lower.tolist(), sides.upper.tolist()
    ([[-1.0, 1.0, -1.0, -1.0], [-1.0, -1.0, -1.0, 0.0]], [[-1.0, 1.0, 1.0, 1.0], [1.0, 1.0, -0.5, 1.0]])
    """
    dimension = len(box.lower)
    lower, upper = (np.repeat(end, 2 * dimension, axis=1) for end in (box.lower, box.upper))
    axes = np.arange(dimension)
    upper[axes, 2 * axes] = box.lower[:, 0] + thickness[:, 0]
    lower[axes, 2 * axes + 1] = box.upper[:, 0] - thickness[:, 1]
    return Boxes(lower, upper)


def grid(box: Boxes, count: int) -> Boxes:
    """A box in `count` equal parts along each axis; neighbours share their ends."""
    dimension = len(box.lower)
    ends = box.lower + box.sides * (np.arange(count + 1) / count)
    ends[:, -1] = box.upper[:, 0]
    index = np.indices((count,) * dimension).reshape(dimension, -1)
    return Boxes(np.take_along_axis(ends, index, axis=1), np.take_along_axis(ends, index + 1, axis=1))


def halves(boxes: Boxes) -> tuple[Boxes, NDArray[np.intp]]:
    """The boxes cut in two across every side longer than half the longest, and which box each part comes from.

    Examples
    --------
    >>> parts, origin = halves(Boxes(np.zeros((2, 1)), np.array([[4.0], [1.0]])))
    >>> parts.lower.tolist(), parts.upper.tolist(), origin.tolist()
    ([[0.0, 2.0], [0.0, 0.0]], [[2.0, 4.0], [1.0, 1.0]], [0, 0])
    """
    lower, upper, origin = boxes.lower, boxes.upper, np.arange(len(boxes))
    long = boxes.sides > boxes.sides.max(axis=0) / 2
    for axis in range(len(lower)):
        cut = np.flatnonzero(long[axis, origin])
        lower, upper = np.hstack([lower, lower[:, cut]]), np.hstack([upper, upper[:, cut]])
        upper[axis, cut] = lower[axis, len(origin) :] = lower[axis, cut] / 2 + upper[axis, cut] / 2
        origin = np.concatenate([origin, origin[cut]])
    return Boxes(lower, upper), origin
