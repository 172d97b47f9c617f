"""How much a boundary bends: enclosures of its principal curvatures, made tight by dividing the boxes that decide."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from rsym.arrays import Flags, Floats
from rsym.sampling.progress import Effort
from rsym.verify.cover.box_arrays import at, cut
from rsym.verify.cover.centred import Centred, contracted
from rsym.verify.cover.curvature_forms import Jet, frames, principal_bounds
from rsym.verify.cover.images import Boxes, Images
from rsym.verify.cover.simplest import simplest
from rsym.verify.cover.subdivision import Subdivision

TIGHT = 0.05  # of an end of what is attained: the enclosure may exceed it by this share
FLAT = 0.002  # of the largest curvature: an end nearer to 0 than this is taken for 0, and not pursued further
BUDGET = 150_000  # boxes, some 15 microseconds each; a torus takes 36 000, a skeleton body 106 000
RANGING = 40_000  # where letters range: what is attained is for their middles, and no bound comes near it
FINEST = 2.0**-20  # of the extent: narrower boxes are not divided, smaller curvatures than its inverse are 0
AT_ONCE = 10_000  # boxes divided at a time, the worst first: where the budget does not reach it goes to what matters
MATTERS = 0.3  # of the largest share of a side: a fillet between planes takes 3 500 boxes, not 86 000
BESIDE = 2.0**-30  # of the extent: so far from a point of the boundary omega is looked at
WHOLE, PART = -1, -2  # in place of a node: the sheet is the boundary all over the box, or somewhere in it


@dataclass(frozen=True)
class Bending:
    """No principal curvature lies outside `enclosure`; the ends of `attained` are those of some points, rounded."""

    enclosure: tuple[float, float]
    attained: tuple[float, float]


class KeptBoxes(NamedTuple):
    """Boxes (n, k, 2) of one sheet, and for each where in it the sheet is the boundary.

    That is where the node `sides` (n,) is not negative, if it is not WHOLE or PART.
    """

    boxes: Boxes
    sides: NDArray[np.int64]


UNBOUNDED = Bending((-np.inf, np.inf), (np.nan, np.nan))


def bending(images: Images, found: Subdivision, effort: Effort | None = None) -> Bending:
    """The principal curvatures on all settled boxes of a subdivision; if time ends, bounds that could be tighter."""
    effort = effort or Effort()
    if effort.is_over:
        return UNBOUNDED
    sheets = _simplest(images, held(found))
    extent = max((float(np.ptp(sheet.boxes[:, :3], axis=(0, 2)).max()) for sheet in sheets.values()), default=1.0)
    search = _Search(images, extent)
    parts = [_Sheet(search, node, sheet) for node, sheet in sheets.items()]
    budget = RANGING if any(low != high for low, high in images.letters.values()) else BUDGET
    while search.spent < budget and not effort.is_over:
        effort.reach(search.spent / budget)
        excess = [part.excess(search.ends) for part in parts]
        worst = np.sort(np.concatenate(excess or [np.zeros(1)]))[-AT_ONCE:]
        if not worst.max(initial=0.0) > 0:
            break
        for part, own in zip(parts, excess, strict=True):
            part.refine((own >= worst[0]) & (own > 0))
    low = min((float(part.low.min(initial=np.inf)) for part in parts), default=np.inf)
    high = max((float(part.high.max(initial=-np.inf)) for part in parts), default=-np.inf)
    attained = search.attained if np.isfinite(search.attained).all() else np.array([np.nan, np.nan])
    return Bending((low + 0.0, high + 0.0), (float(attained[0]), float(attained[1])))


def held(found: Subdivision) -> Mapping[int, KeptBoxes]:
    """The boxes by the sheets that they hold."""
    listed: dict[int, list[tuple[Boxes, int]]] = {}
    for node, groups in found.regular.items():
        listed.setdefault(node, []).extend((group, WHOLE) for group in groups)
    for meeting, groups in found.joined.items():
        for arc in meeting.arcs:
            listed.setdefault(arc.function, []).extend((group, arc.side) for group in groups)
    for box, corner in found.corners:
        for node in corner.sheets:
            listed.setdefault(node, []).append((np.array([box]), PART))
    return {
        node: KeptBoxes(
            np.concatenate([boxes for boxes, _ in groups]),
            np.concatenate([np.full(len(boxes), side) for boxes, side in groups]),
        )
        for node, groups in listed.items()
    }


def _simplest(images: Images, sheets: Mapping[int, KeptBoxes]) -> Mapping[int, KeptBoxes]:
    """The boxes by the simplest functions that are zero on the sheets."""
    listed: dict[int, list[KeptBoxes]] = {}
    for node, sheet in sheets.items():
        for simple, places in simplest(images, node, sheet.boxes):
            listed.setdefault(simple, []).append(KeptBoxes(sheet.boxes[places], sheet.sides[places]))
    return {node: KeptBoxes(*map(np.concatenate, zip(*parts, strict=True))) for node, parts in listed.items()}


class _Search:
    """Bounds over boxes, the extremes at points in them, and how many boxes were bounded."""

    def __init__(self, images: Images, extent: float) -> None:
        self.images, self.extent = images, extent
        self.attained = np.array([np.inf, -np.inf])
        self.spent = 0

    @property
    def ends(self) -> Floats:
        """What bounds may reach to: a little beyond what is attained."""
        if not np.isfinite(self.attained).all():
            return np.array([np.inf, -np.inf])
        size = np.abs(self.attained)
        slack = np.where(size > FLAT * size.max(), TIGHT * size, FLAT * size.max()) + FINEST / self.extent
        result: Floats = self.attained + [-1, 1] * slack
        return result

    def bounded(self, node: int, sheet: KeptBoxes) -> tuple[KeptBoxes, Bent]:
        """The boxes that the boundary may meet, and its curvatures there; what is attained at points is noted."""
        kept = self._meets(*sheet)
        boxes, sides = sheet.boxes[kept], sheet.sides[kept]

        found = bent(self.images, node, boxes)
        self.spent += len(found.boxes)
        sides = sides[found.places]
        new = (found.attained[:, 1] < self.attained[0]) | (found.attained[:, 0] > self.attained[1])
        new[new] = self._is_boundary(found.points[new], found.normals[new], sides[new])
        low, high = found.attained[new, 1], found.attained[new, 0]
        self.attained = np.array([low.min(initial=self.attained[0]), high.max(initial=self.attained[1])]) + 0.0
        return KeptBoxes(found.boxes, sides), found

    def _meets(self, boxes: Boxes, sides: NDArray[np.int64]) -> Flags:
        """Whether a sheet may be the boundary somewhere in boxes."""
        result = np.ones(len(boxes), bool)
        for side in np.unique(sides):
            own = sides == side
            if side == PART:
                result[own] = self.images.alive(boxes[own])[0].any(axis=0)
            elif side != WHOLE:
                result[own] = self.images.value(side, boxes[own])[1] >= 0
        return result

    def _is_boundary(self, points: Floats, normals: Floats, sides: NDArray[np.int64]) -> Flags:
        """Whether points of a sheet are on the boundary: in a part of it, where omega changes its sign nearby."""
        result = np.ones(len(points), bool)
        for side in np.unique(sides):
            own = sides == side
            at, along = points[own], np.zeros_like(points[own])
            along[:, :3] = BESIDE * self.extent * normals[own]
            if side == PART:
                inside, outside = (self.images.sign(np.stack([at + step, at + step], -1)) for step in (along, -along))
                result[own] = inside * outside < 0
            elif side != WHOLE:
                result[own] = self.images.value(side, np.stack([at, at], -1))[0] > 0
        return result


class _Sheet:
    """The boxes of one sheet, with bounds of its curvatures."""

    def __init__(self, search: _Search, node: int, sheet: KeptBoxes) -> None:
        self.search, self.node = search, node
        self.held, found = search.bounded(node, sheet)
        self.low, self.high, self.shares = found.low, found.high, found.shares

    def excess(self, ends: Floats) -> Floats:
        """How far the bounds of boxes reach beyond these ends; 0 for the finest."""
        beyond = np.maximum(0.0, np.maximum(ends[0] - self.low, self.high - ends[1]))
        return np.where(self._wide(self.held.boxes).any(axis=1), beyond, 0.0)

    def _wide(self, boxes: Boxes) -> Flags:
        """The sides in space that may be divided."""
        result: Flags = boxes[:, :3, 1] - boxes[:, :3, 0] > FINEST * self.search.extent
        return result

    def refine(self, own: Flags) -> None:
        """Divide these boxes across the sides that matter; where none is known to, across the longest."""
        if not own.any():
            return
        boxes = self.held.boxes[own]
        shares = np.where(self._wide(boxes), self.shares[own], 0.0)
        largest = shares.max(axis=1, keepdims=True)
        shares = np.where((largest > 0) & (largest < np.inf), shares, boxes[:, :3, 1] - boxes[:, :3, 0])
        most = shares.max(axis=1, keepdims=True)
        shares = np.concatenate([shares, most * self.search.images.influence_on(self.node, boxes)], axis=1)
        across = shares >= MATTERS * shares.max(axis=1, keepdims=True)
        sides = np.repeat(self.held.sides[own], 2 ** across.sum(axis=1))
        held, found = self.search.bounded(self.node, KeptBoxes(cut(boxes, across), sides))
        kept = *self.held, self.low, self.high, self.shares
        pairs = zip(kept, (*held, found.low, found.high, found.shares), strict=True)
        boxes, sides, self.low, self.high, self.shares = (np.concatenate([old[~own], new]) for old, new in pairs)
        self.held = KeptBoxes(boxes, sides)


# Bounds of the curvatures of one sheet over boxes that hold it, with points of the sheet in them.
STEPS = 3  # of Newton's method from the middle of a box to the sheet: off by h, then h**2, h**4, h**8
BLOCK = 4096  # boxes at once: their tensors fit into the cache


class Bent(NamedTuple):
    """The parts (n, k, 2) of boxes that a sheet may meet, bounds there, and rounded values at points of the sheet.

    `places` (n,) are the numbers of the boxes. `low`, `high` (n,) bound the principal curvatures, and each side adds
    in space its share (n, 3) to their distance. At the points (n, k), letters that range at their middles, with their
    unit normals (n, 3) the curvatures are `attained` (n, 2), the larger first; NaN where no point of the sheet was
    found in the box.
    """

    places: NDArray[np.int64]
    boxes: Boxes
    low: Floats
    high: Floats
    shares: Floats
    points: Floats
    normals: Floats
    attained: Floats


def bent(images: Images, node: int, boxes: Boxes) -> Bent:
    """The principal curvatures of the zero set of a node f in boxes, positive where f > 0 is convex.

    Examples
    --------
    >>> import rsym
    >>> from rsym.verify.cover.forming import formation
    >>> from rsym.verify.boxes.local import Model
    >>> model = Model(rsym.sphere(2), {})
    >>> images = Images(model, formation(model, lambda node: True), {})
    >>> found = bent(images, model.root, np.array([[(1.9, 2.1), (-0.1, 0.1), (-0.1, 0.1)]]))
    >>> bool(0.49 < found.low[0] <= 0.5 <= found.high[0] < 0.51), found.attained.round(9).tolist()
    (True, [[0.5, 0.5]])
    """
    numbers = np.arange(len(boxes))
    blocks = [numbers[start : start + BLOCK] for start in range(0, len(boxes), BLOCK)] or [numbers]
    found = [_block(images, node, boxes[block], block) for block in blocks]
    return Bent(*map(np.concatenate, zip(*found, strict=True)))


def _block(images: Images, node: int, boxes: Boxes, numbers: NDArray[np.int64]) -> Bent:
    boxes, met = contraction(images, node, boxes)
    points, reached = _nearest(images, node, boxes)
    _, gradient, _ = _first(images, node, _at(points))
    frame = frames(gradient.middle, images.bends(node, _at(points))[0].middle)
    here = at(points[:, :3], boxes)
    value, gradient, _ = _first(images, node, here)
    point = Jet(gradient, *images.bends(node, here))
    offset = _seen(boxes, points)
    bounds = principal_bounds(frame, value, point, _over(images, node, boxes, point, offset), offset)
    attained = np.where(reached[:, None], frame.curvatures.T, np.nan)
    return Bent(numbers[met], boxes, *bounds[:2], bounds.shares.T, points, frame.vectors[2].T, attained)


def contraction(images: Images, node: int, boxes: Boxes) -> tuple[Boxes, Flags]:
    """What is left of boxes around a sheet f = 0, and which these were: those that it does not meet are left out.

    With c the middle, x_k = c_k - (f(c) + the sum over i != k of g_i(B)(x_i - c_i))/g_k(B) on the sheet: a step of
    the interval Newton method, for each coordinate k along which the gradient g does not vanish. Along the normal a
    box becomes as narrow as the sheet is curved in it.
    """
    value, slope, analytic = _first(images, node, boxes)
    low, high = value.ends
    kept = (low <= 0) & (high >= 0)
    boxes, slope, analytic = boxes[kept], slope[:, kept], analytic[kept]
    centres = boxes[:, :3].mean(axis=-1)
    value, _, _ = _first(images, node, at(centres, boxes))
    offset = _seen(boxes, centres)
    result = boxes.copy()
    for k in range(3):
        others = [i for i in range(3) if i != k]
        rest = value + contracted("kn,kn->n", slope[others], offset[others])
        turned = Centred(np.where(slope.middle[k] < 0, -1.0, 1.0), np.zeros(len(boxes)))
        inverse = contracted("n,n->n", slope[k], turned).reciprocal()
        step = contracted("n,n->n", contracted("n,n->n", rest, turned), inverse)
        low, high = (Centred.exact(centres[:, k]) - step).ends
        result[:, k, 0] = np.where(analytic, np.maximum(low, boxes[:, k, 0]), boxes[:, k, 0])
        result[:, k, 1] = np.where(analytic, np.minimum(high, boxes[:, k, 1]), boxes[:, k, 1])
    left = np.logical_and.reduce(result[..., 0] <= result[..., 1], axis=1)
    kept[kept] = left
    return result[left], kept


def _nearest(images: Images, node: int, boxes: Boxes) -> tuple[Floats, Flags]:
    """A point of each box, and whether it is one of the sheet: Newton's method from the middle."""
    points = boxes.mean(axis=-1)
    for _ in range(STEPS):
        value, gradient, _ = _first(images, node, _at(points))
        with np.errstate(all="ignore"):
            step = (gradient.middle * value.middle / np.square(gradient.middle).sum(axis=0)).T
        points[:, :3] -= np.where(np.isfinite(step), step, 0.0)
    inside = np.clip(points, boxes[..., 0], boxes[..., 1])
    return inside, (inside == points).all(axis=1)


def _over(images: Images, node: int, boxes: Boxes, point: Jet, offset: Centred) -> Jet:
    """The derivatives over the boxes: their images, and the mean-value forms where the node is analytic."""
    _, gradient, analytic = _first(images, node, boxes)
    hessian, third = images.bends(node, boxes)
    third = Centred(third.middle, np.where(analytic, third.radius, np.inf))
    hessian = hessian.meet(point.hessian + contracted("ijkn,kn->ijn", third, offset))
    mean = point.gradient + contracted("ijn,jn->in", hessian, offset)
    mean = Centred(mean.middle, np.where(analytic, mean.radius, np.inf))
    return Jet(gradient.meet(mean), hessian, third)


def _first(images: Images, node: int, boxes: Boxes) -> tuple[Centred, Centred, Flags]:
    value, (low, high), analytic = images.first(node, boxes)
    return Centred.between(*value), Centred.between(low, high), analytic


def _seen(boxes: Boxes, points: Floats) -> Centred:
    """The boxes in space (3, n) seen from points of them."""
    return Centred.between(boxes[:, :3, 0].T, boxes[:, :3, 1].T) - Centred.exact(points[:, :3].T)


def _at(points: Floats) -> Boxes:
    """Points as boxes without extent."""
    return np.stack([points, points], axis=-1)
