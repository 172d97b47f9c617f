"""Arrays of boxes in space, (n, 3, 2) as ((xmin, xmax), (ymin, ymax), (zmin, zmax))."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise, product

import numpy as np

from rsym.verify.bodies.images import Boxes, Flags
from rsym.verify.bodies.inspection import GROWN
from rsym.verify.covering import OFF_CENTRE
from rsym.verify.local import Box


def listed(boxes: Boxes) -> list[Box]:
    """The boxes one by one."""
    return [tuple((low, high) for low, high in box) for box in boxes.tolist()]


def grown(boxes: Boxes) -> Boxes:
    """Each box a little larger on every side."""
    margin = GROWN * (boxes[..., 1] - boxes[..., 0])
    return np.stack([boxes[..., 0] - margin, boxes[..., 1] + margin], axis=-1)


def eighths(region: Box) -> Iterator[Boxes]:
    """The region cut in eight, off its planes of symmetry."""
    cuts = [(low, low + OFF_CENTRE * (high - low), high) for low, high in region[:3]]
    for box in product(*(pairwise(cut) for cut in cuts)):
        yield np.array(box)


def halves(boxes: Boxes) -> Boxes:
    """Each box cut in two across all sides of at least 0.7 of its longest; the parts of one box follow each other."""
    width = boxes[..., 1] - boxes[..., 0]
    return cut(boxes, width >= 0.7 * width.max(axis=1, keepdims=True, initial=0))


def cut(boxes: Boxes, sides: Flags) -> Boxes:
    """Each box cut in two across the marked of its sides (n, 3)."""
    low, high = boxes[..., 0], boxes[..., 1]
    middle = low + (high - low) / 2
    parts = []
    for corner in product((0, 1), repeat=3):
        take = np.array(corner, bool)
        start = np.where(sides & take, middle, low)
        end = np.where(sides & ~take, middle, high)
        parts.append(np.where((sides | ~take)[..., None], np.stack([start, end], axis=-1), np.nan))
    stacked = np.stack(parts, axis=1).reshape(-1, 3, 2)
    kept: Boxes = stacked[~np.isnan(stacked).any(axis=(1, 2))]
    return kept


def area(boxes: Boxes) -> float:
    """The area of one side of each box, added up."""
    return float(np.square((boxes[..., 1] - boxes[..., 0]).max(axis=1, initial=0)).sum())
