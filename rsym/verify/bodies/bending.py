"""How much a boundary bends: enclosures of its principal curvatures, made tight by dividing the boxes that decide."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rsym.verify.bodies.images import Array, Boxes, Images
from rsym.verify.bodies.octree import Subdivision, halves

TIGHT = 0.05  # of the curvature: the enclosure may exceed what is attained by this share
FLAT = 0.002  # of the largest curvature: an end near 0 is not pursued beyond this
BUDGET = 3_000_000  # boxes, a microsecond or two each
STEPS = 4  # of Newton's method from the middle of a box to the sheet


@dataclass(frozen=True)
class Bending:
    """No principal curvature lies outside `enclosure`; the ends of `attained` are those of some points, rounded."""

    enclosure: tuple[float, float]
    attained: tuple[float, float]


def bending(images: Images, found: Subdivision) -> Bending:
    """The principal curvatures on all settled boxes of a subdivision."""
    parts = [_Part(images, node, np.concatenate(boxes)) for node, boxes in _by_node(found).items()]
    spent = sum(len(part.boxes) for part in parts)
    attained = np.array([np.inf, -np.inf])
    for part in parts:
        attained = part.sample(part.boxes, attained)
    while spent < BUDGET and (worst := _offending(parts, attained)):
        for part, own in worst:
            spent += 8 * int(own.sum())
            attained = part.refine(own, attained)
    low = min((float(part.low.min(initial=np.inf)) for part in parts), default=np.inf)
    high = max((float(part.high.max(initial=-np.inf)) for part in parts), default=-np.inf)
    if not np.isfinite(attained).all():
        attained = np.array([np.nan, np.nan])
    return Bending((low, high), (float(attained[0]), float(attained[1])))


def _by_node(found: Subdivision) -> Mapping[int, Sequence[Boxes]]:
    """The boxes by the sheets that they hold."""
    result: dict[int, list[Boxes]] = {node: list(boxes) for node, boxes in found.regular.items()}
    for meeting, boxes in found.joined.items():
        for arc in meeting.arcs:
            result.setdefault(arc.function, []).extend(boxes)
    for box, corner in found.corners:
        for node in corner.sheets:
            result.setdefault(node, []).append(np.array([box]))
    return result


def _offending(parts: Sequence[_Part], attained: Array) -> list[tuple[_Part, NDArray[np.bool_]]]:
    """The boxes whose bounds reach too far beyond what is attained."""
    if not np.isfinite(attained).all():
        ends = np.array([np.inf, -np.inf])
    else:
        slack = np.maximum(TIGHT * np.abs(attained), FLAT * np.abs(attained).max())
        ends = attained + [-1, 1] * slack
    marked = [(part, (part.low < ends[0]) | (part.high > ends[1])) for part in parts]
    return [(part, own) for part, own in marked if own.any()]


class _Part:
    """The boxes of one sheet, with bounds of its curvatures."""

    def __init__(self, images: Images, node: int, boxes: Boxes) -> None:
        self.images, self.node = images, node
        self.boxes, self.low, self.high = self._bounded(boxes)

    def _bounded(self, boxes: Boxes) -> tuple[Boxes, Array, Array]:
        """The boxes that the sheet may meet, and the bounds."""
        (low, high), value = self.images.curvatures(self.node, boxes)
        met = (value[0] <= 0) & (value[1] >= 0)
        return boxes[met], low[met], high[met]

    def refine(self, own: NDArray[np.bool_], attained: Array) -> Array:
        """Divide some boxes; what is attained in the parts is added."""
        parts = halves(self.boxes[own])
        alive = self.images.alive(parts)[0].any(axis=0)
        boxes, low, high = self._bounded(parts[alive])
        attained = self.sample(boxes, attained)
        self.boxes = np.concatenate([self.boxes[~own], boxes])
        self.low = np.concatenate([self.low[~own], low])
        self.high = np.concatenate([self.high[~own], high])
        return attained

    def sample(self, boxes: Boxes, attained: Array) -> Array:
        """The extremes with those at points of the sheet in these boxes, where it is the boundary."""
        points = boxes.mean(axis=-1)
        for _ in range(STEPS):
            _, value = self.images.curvatures(self.node, _at(points))
            low, high, _ = self.images.slopes(self.node, _at(points))
            slope = ((low + high) / 2).T
            with np.errstate(all="ignore"):
                step = (value[0] + value[1]) / 2 / np.square(slope).sum(axis=1)
            points = points - np.where(np.isfinite(step), step, np.inf)[:, None] * slope
            kept = ((points >= boxes[..., 0]) & (points <= boxes[..., 1])).all(axis=1)
            points, boxes = points[kept], boxes[kept]
        points = points[self._is_boundary(points)]
        (low, high), _ = self.images.curvatures(self.node, _at(points))
        finite = np.isfinite(low) & np.isfinite(high)
        found = np.array([low[finite].min(initial=np.inf), high[finite].max(initial=-np.inf)])
        result: Array = np.array([min(found[0], attained[0]), max(found[1], attained[1])])
        return result

    def _is_boundary(self, points: Array) -> NDArray[np.bool_]:
        """Whether omega changes its sign near a point: of the sheets in a box one may be cut off there."""
        low, high, _ = self.images.slopes(self.node, _at(points))
        slope = ((low + high) / 2).T
        length = np.linalg.norm(slope, axis=1, keepdims=True)
        scale = np.abs(points).max(initial=1.0) * 2.0**-30
        with np.errstate(all="ignore"):
            step = scale * slope / length
        inside, outside = (self.images.sign(_at(points + side * step)) for side in (1, -1))
        result: NDArray[np.bool_] = inside * outside < 0
        return result


def _at(points: Array) -> Boxes:
    """Points as boxes without extent."""
    return np.stack([points, points], axis=-1)
