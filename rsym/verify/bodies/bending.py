"""How much a boundary bends: enclosures of its principal curvatures, made tight by dividing the boxes that decide."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from rsym.verify.bodies.curvature_bounds import bent
from rsym.verify.bodies.images import Array, Boxes, Flags, Images
from rsym.verify.bodies.octree import Subdivision, halves

TIGHT = 0.05  # of an end of what is attained: the enclosure may exceed it by this share
FLAT = 0.002  # of the largest curvature: an end nearer to 0 than this is taken for 0, and not pursued further
BUDGET = 400_000  # boxes, some 30 microseconds each
FINEST = 2.0**-20  # of the extent: where curvature grows beyond all bounds narrower boxes say no more
BESIDE = 2.0**-30  # of the largest coordinate: so far from a point of the boundary omega is looked at


@dataclass(frozen=True)
class Bending:
    """No principal curvature lies outside `enclosure`; the ends of `attained` are those of some points, rounded."""

    enclosure: tuple[float, float]
    attained: tuple[float, float]


def bending(images: Images, found: Subdivision) -> Bending:
    """The principal curvatures on all settled boxes of a subdivision."""
    sheets = _by_node(found)
    search = _Search(images)
    parts = [_Part(search, node, np.concatenate(boxes)) for node, boxes in sheets.items()]
    extent = max((float(np.ptp(part.boxes, axis=(0, 2)).max()) for part in parts if len(part.boxes)), default=0.0)
    while search.spent < BUDGET:
        marked = [part.offending(search.ends, FINEST * extent) for part in parts]
        if not any(own.any() for own in marked):
            break
        for part, own in zip(parts, marked, strict=True):
            part.refine(own)
    low = min((float(part.low.min(initial=np.inf)) for part in parts), default=np.inf)
    high = max((float(part.high.max(initial=-np.inf)) for part in parts), default=-np.inf)
    attained = search.attained if np.isfinite(search.attained).all() else np.array([np.nan, np.nan])
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


class _Search:
    """Bounds over boxes, the extremes at points in them, and how many boxes were bounded."""

    def __init__(self, images: Images) -> None:
        self.images = images
        self.attained = np.array([np.inf, -np.inf])
        self.spent = 0

    @property
    def ends(self) -> Array:
        """What bounds may reach to: a little beyond what is attained."""
        if not np.isfinite(self.attained).all():
            return np.array([np.inf, -np.inf])
        size = np.abs(self.attained)
        slack = np.where(size > FLAT * size.max(), TIGHT * size, FLAT * size.max())
        result: Array = self.attained + [-1, 1] * slack
        return result

    def bounded(self, node: int, boxes: Boxes) -> tuple[Boxes, Array, Array]:
        """The parts of boxes that a sheet may meet, and bounds of its principal curvatures there."""
        self.spent += len(boxes)
        found = bent(self.images, node, boxes)
        new = (found.curvatures[:, 1] < self.attained[0]) | (found.curvatures[:, 0] > self.attained[1])
        new[new] = self._is_boundary(found.points[new], found.normals[new])
        low, high = found.curvatures[new, 1], found.curvatures[new, 0]
        self.attained = np.array([low.min(initial=self.attained[0]), high.max(initial=self.attained[1])])
        return found.boxes, found.low, found.high

    def _is_boundary(self, points: Array, normals: Array) -> Flags:
        """Whether omega changes its sign near points: of the sheets in a box one may be cut off there."""
        step = BESIDE * np.abs(points).max(initial=1.0) * normals
        inside, outside = (self.images.sign(np.stack([points + side, points + side], -1)) for side in (step, -step))
        result: Flags = inside * outside < 0
        return result


class _Part:
    """The boxes of one sheet, with bounds of its curvatures."""

    def __init__(self, search: _Search, node: int, boxes: Boxes) -> None:
        self.search, self.node = search, node
        self.boxes, self.low, self.high = search.bounded(node, boxes)

    def offending(self, ends: Array, finest: float) -> Flags:
        """The boxes whose bounds reach beyond these ends, the finest left out."""
        wide = (self.boxes[..., 1] - self.boxes[..., 0]).max(axis=1, initial=0) > finest
        result: Flags = ((self.low < ends[0]) | (self.high > ends[1])) & wide
        return result

    def refine(self, own: Flags) -> None:
        """Divide these boxes."""
        if own.any():
            parts = halves(self.boxes[own])
            parts = parts[self.search.images.alive(parts)[0].any(axis=0)]
            boxes, low, high = self.search.bounded(self.node, parts)
            self.boxes = np.concatenate([self.boxes[~own], boxes])
            self.low = np.concatenate([self.low[~own], low])
            self.high = np.concatenate([self.high[~own], high])
