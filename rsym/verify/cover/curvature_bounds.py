"""Bounds of the principal curvatures of one sheet over boxes that hold it, with points of the sheet in them."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from rsym.arrays import Flags, Floats
from rsym.verify.cover.box_arrays import at
from rsym.verify.cover.centred import Centred, contracted
from rsym.verify.cover.curvature_forms import Jet, frames, principal_bounds
from rsym.verify.cover.images import Boxes, Images

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
