"""How much a boundary bends: enclosures of its principal curvatures, made tight by dividing the boxes that decide."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from rsym.verify.bodies.boxes import cut
from rsym.verify.bodies.curvature_bounds import Bent, bent
from rsym.verify.bodies.images import Array, Boxes, Flags, Images
from rsym.verify.bodies.octree import Subdivision

TIGHT = 0.05  # of an end of what is attained: the enclosure may exceed it by this share
FLAT = 0.002  # of the largest curvature: an end nearer to 0 than this is taken for 0, and not pursued further
BUDGET = 400_000  # boxes, some 30 microseconds each
FINEST = 2.0**-20  # of the extent: narrower boxes are not divided, smaller curvatures than its inverse are 0
MATTERS = 0.3  # of the largest share of a side: a fillet between planes takes 3 500 boxes, not 86 000
BESIDE = 2.0**-30  # of the largest coordinate: so far from a point of the boundary omega is looked at


@dataclass(frozen=True)
class Bending:
    """No principal curvature lies outside `enclosure`; the ends of `attained` are those of some points, rounded."""

    enclosure: tuple[float, float]
    attained: tuple[float, float]


def bending(images: Images, found: Subdivision) -> Bending:
    """The principal curvatures on all settled boxes of a subdivision."""
    sheets = {node: np.concatenate(boxes) for node, boxes in _by_node(found).items()}
    search = _Search(images, max((float(np.ptp(boxes, axis=(0, 2)).max()) for boxes in sheets.values()), default=1.0))
    parts = [_Part(search, node, boxes) for node, boxes in sheets.items()]
    while search.spent < BUDGET:
        marked = [part.offending(search.ends) for part in parts]
        if not any(own.any() for own in marked):
            break
        for part, own in zip(parts, marked, strict=True):
            part.refine(own)
    low = min((float(part.low.min(initial=np.inf)) for part in parts), default=np.inf)
    high = max((float(part.high.max(initial=-np.inf)) for part in parts), default=-np.inf)
    attained = search.attained if np.isfinite(search.attained).all() else np.array([np.nan, np.nan])
    return Bending((low + 0.0, high + 0.0), (float(attained[0]), float(attained[1])))


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

    def __init__(self, images: Images, extent: float) -> None:
        self.images, self.extent = images, extent
        self.attained = np.array([np.inf, -np.inf])
        self.spent = 0

    @property
    def ends(self) -> Array:
        """What bounds may reach to: a little beyond what is attained."""
        if not np.isfinite(self.attained).all():
            return np.array([np.inf, -np.inf])
        size = np.abs(self.attained)
        slack = np.where(size > FLAT * size.max(), TIGHT * size, FLAT * size.max()) + FINEST / self.extent
        result: Array = self.attained + [-1, 1] * slack
        return result

    def bounded(self, node: int, boxes: Boxes) -> Bent:
        """Bounds of the principal curvatures of a sheet; what is attained at points of it is noted."""
        self.spent += len(boxes)
        found = bent(self.images, node, boxes)
        new = (found.curvatures[:, 1] < self.attained[0]) | (found.curvatures[:, 0] > self.attained[1])
        new[new] = self._is_boundary(found.points[new], found.normals[new])
        low, high = found.curvatures[new, 1], found.curvatures[new, 0]
        self.attained = np.array([low.min(initial=self.attained[0]), high.max(initial=self.attained[1])]) + 0.0
        return found

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
        found = search.bounded(node, boxes)
        self.boxes, self.low, self.high, self.shares = found[:4]

    def offending(self, ends: Array) -> Flags:
        """The boxes whose bounds reach beyond these ends, the finest left out."""
        result: Flags = ((self.low < ends[0]) | (self.high > ends[1])) & self._wide(self.boxes).any(axis=1)
        return result

    def _wide(self, boxes: Boxes) -> Flags:
        """The sides that may be divided."""
        result: Flags = boxes[..., 1] - boxes[..., 0] > FINEST * self.search.extent
        return result

    def refine(self, own: Flags) -> None:
        """Divide these boxes across the sides that matter; where none is known to, across the longest."""
        if not own.any():
            return
        boxes = self.boxes[own]
        shares = np.where(self._wide(boxes), self.shares[own], 0.0)
        largest = shares.max(axis=1, keepdims=True)
        shares = np.where((largest > 0) & (largest < np.inf), shares, boxes[..., 1] - boxes[..., 0])
        parts = cut(boxes, shares >= MATTERS * shares.max(axis=1, keepdims=True))
        found = self.search.bounded(self.node, parts[self.search.images.alive(parts)[0].any(axis=0)])
        kept = self.boxes[~own], self.low[~own], self.high[~own], self.shares[~own]
        joined = (np.concatenate(pair) for pair in zip(kept, found[:4], strict=True))
        self.boxes, self.low, self.high, self.shares = joined
