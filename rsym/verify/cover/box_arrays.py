"""Arrays of boxes in space, (n, k, 2) as ((xmin, xmax), (ymin, ymax), (zmin, zmax)), then the ranges of letters."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise, product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rsym.arrays import Flags, Floats
from rsym.verify.boxes.local import GROWN, Box
from rsym.verify.cover.covering import OFF_CENTRE
from rsym.verify.cover.images import Boxes


def listed(boxes: Boxes) -> list[Box]:
    """The boxes one by one."""
    return [tuple((low, high) for low, high in box) for box in boxes.tolist()]


def grown(boxes: Boxes) -> Boxes:
    """Each box a little larger on every side in space."""
    margin = GROWN * (boxes[..., 1] - boxes[..., 0])
    margin[:, 3:] = 0.0
    return np.stack([boxes[..., 0] - margin, boxes[..., 1] + margin], axis=-1)


def eighths(region: Box) -> Iterator[Boxes]:
    """The region cut in eight in space, off its planes of symmetry."""
    cuts = [(low, low + OFF_CENTRE * (high - low), high) for low, high in region[:3]]
    for box in product(*(pairwise(cut) for cut in cuts)):
        yield np.array([*box, *region[3:]])


def halves(boxes: Boxes) -> Boxes:
    """Each box cut in two across its sides in space of at least 0.7 of the longest; parts of one follow each other."""
    width = boxes[..., 1] - boxes[..., 0]
    across = width >= 0.7 * width[:, :3].max(axis=1, keepdims=True, initial=0)
    across[:, 3:] = False
    return cut(boxes, across)


def cut(boxes: Boxes, sides: Flags) -> Boxes:
    """Each box cut in two across the marked of its sides (n, k)."""
    low, high = boxes[..., 0], boxes[..., 1]
    middle = low + (high - low) / 2
    parts = []
    axes = np.flatnonzero(sides.any(axis=0))
    for corner in product((0, 1), repeat=len(axes)):
        take = np.zeros(boxes.shape[1], bool)
        take[axes] = corner
        start = np.where(sides & take, middle, low)
        end = np.where(sides & ~take, middle, high)
        parts.append(np.where((sides | ~take)[..., None], np.stack([start, end], axis=-1), np.nan))
    stacked = np.stack(parts, axis=1).reshape(-1, *boxes.shape[1:])
    kept: Boxes = stacked[~np.isnan(stacked).any(axis=(1, 2))]
    return kept


def widths_of(boxes: Boxes) -> Floats:
    """The longest side (n,) of each box in space."""
    widths: Floats = (boxes[:, :3, 1] - boxes[:, :3, 0]).max(axis=1, initial=0)
    return widths


def area(boxes: Boxes) -> float:
    """The area of one side of each box in space, times the ranges of its letters, added up."""
    return float((np.square(widths_of(boxes)) * (boxes[:, 3:, 1] - boxes[:, 3:, 0]).prod(axis=1)).sum())


def at(points: Floats, boxes: Boxes) -> Boxes:
    """Points (n, 3) as boxes without extent in space, with the ranges of letters of some boxes.

    Examples
    --------
    >>> at(np.zeros((1, 3)), np.array([[(0.0, 1.0), (0.0, 1.0), (0.0, 1.0), (5.0, 6.0)]])).tolist()
    [[[0.0, 0.0], [0.0, 0.0], [0.0, 0.0], [5.0, 6.0]]]
    """
    return np.concatenate([np.stack([points, points], axis=-1), boxes[:, 3:]], axis=1)


def reach_from(points: Floats, boxes: Boxes) -> Floats:
    """How far each box reaches from a point (n, 3) in it along each axis in space (3, n), rounded up.

    Examples
    --------
    >>> reach = reach_from(np.zeros((1, 3)), np.array([[(0.0, 1.0), (-2.0, 1.0), (0.0, 0.0)]]))
    >>> reach.ravel().round(9).tolist()
    [1.0, 2.0, 0.0]
    """
    # The subtractions are rounded: a unit more is outward.
    reach: Floats = np.maximum(points - boxes[:, :3, 0], boxes[:, :3, 1] - points).T * (1 + 2.0**-51)
    return reach


def patterns(rows: NDArray[Any], own: NDArray[np.int64]) -> Iterator[tuple[NDArray[np.int64], NDArray[Any]]]:
    """The columns of an array that are equal: their places among `own`, and what they are."""
    if len(own):
        found, inverse = np.unique(rows[:, own], axis=1, return_inverse=True)
        order = np.argsort(inverse.ravel(), kind="stable")
        ends = np.cumsum(np.bincount(inverse.ravel(), minlength=found.shape[1]))
        for k, places in enumerate(np.split(own[order], ends[:-1])):
            yield places, found[:, k]
