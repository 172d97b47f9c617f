"""Subdivision: the boxes into which a region falls until each is settled, or too small to go on."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field

from rsym.codegen.balls import ctx
from rsym.codegen.differentiation import derivative
from rsym.sampling.progress import Progress, report
from rsym.verify.examination import OPEN, Finding, examine
from rsym.verify.local import Box, Model
from rsym.verify.pruning import Prune

PRECISION = 80  # bits of the balls: 53 would do, a few more keep corners from being decided by rounding
COARSEST = 1 / 24  # of the extent: larger regular boxes are divided, so that the cover follows the boundary
REPORTED = 64  # boxes between two reports of progress
# The first cut is off centre, so that no side of a box lies on the planes of symmetry of a model.
OFF_CENTRE = 0.4375 + 1 / 64


@dataclass
class Covering:
    """Settled boxes with what was found on them, and the boxes left over."""

    settled: list[tuple[Box, Finding]] = field(default_factory=list)
    left: list[tuple[Box, Finding]] = field(default_factory=list)
    examined: int = 0


def cover(
    model: Model,
    bounds: Box,
    *,
    smallest: float,
    budget: int,
    prune: Prune | None = None,
    progress: Progress | None = None,
) -> Covering:
    """Subdivide the bounds, breadth first, until every box is settled, narrower than `smallest`, or too many.

    `prune` says of many boxes at once which certainly hold no zero; the others are examined one by one.
    """
    result, extent = Covering(), extent_of(bounds)
    level = list(_first(bounds))
    with ctx.workprec(PRECISION):
        while level:
            if prune is not None:
                level = [box for box, empty in zip(level, prune(level), strict=True) if not empty]
            following: list[Box] = []
            for box in level:
                if result.examined >= budget:
                    result.left.append((box, OPEN))
                    continue
                following.extend(_settled(model, box, extent, smallest, result))
                if result.examined % REPORTED == 0:
                    report(progress, result.examined, budget)
            level = following
    report(progress, budget, budget)
    return result


def _settled(model: Model, box: Box, extent: float, smallest: float, result: Covering) -> list[Box]:
    """Examine a box and note what is found on it; what is still open is returned in parts."""
    result.examined += 1
    finding = examine(model.over(box), extent)
    width = max(high - low for low, high in box[:2])
    if finding.kind == "regular" and width > extent * COARSEST and len(box) == 2:
        return halves(model, box)
    if finding.kind == "open":
        if width > smallest:
            return halves(model, box)
        result.left.append((box, finding))
    elif finding.kind != "empty":
        result.settled.append((box, finding))
    return []


def extent_of(bounds: Box) -> float:
    """The longer side of the region."""
    return max(high - low for low, high in bounds[:2])


def _first(bounds: Box) -> Iterator[Box]:
    boxes: list[Box] = [bounds]
    for axis in range(2):
        low, high = bounds[axis]
        boxes = [half for box in boxes for half in _cut(box, axis, low + OFF_CENTRE * (high - low))]
    return iter(boxes)


def _cut(box: Box, axis: int, at: float) -> tuple[Box, Box]:
    low, high = box[axis]
    return (*box[:axis], (low, at), *box[axis + 1 :]), (*box[:axis], (at, high), *box[axis + 1 :])


def halves(model: Model, box: Box) -> list[Box]:
    """The box cut in two across both coordinates, or across the letter to which the model is most sensitive on it."""
    axis = _widest_letter(model, box)
    if axis is not None:
        return list(_cut(box, axis, _middle(box, axis)))
    return [half for one in _cut(box, 0, _middle(box, 0)) for half in _cut(one, 1, _middle(box, 1))]


def _middle(box: Box, axis: int) -> float:
    low, high = box[axis]
    return low + (high - low) / 2


def _widest_letter(model: Model, box: Box) -> int | None:
    """The letter whose range on the box changes omega more than the coordinates do."""
    if len(box) == 2:
        return None
    local = model.over(box)
    balls = [local.value(derivative(model.builder, model.root, axis)) for axis in model.axes]
    slopes = [math.inf if ball is None else float(abs(ball).upper()) for ball in balls]
    known = max((slope for slope in slopes if math.isfinite(slope)), default=1.0)  # at a kink a slope has no bound
    smears = [min(slope, known) * (high - low) for slope, (low, high) in zip(slopes, box, strict=True)]
    widest = max(range(2, len(box)), key=smears.__getitem__)
    return widest if smears[widest] > max(smears[:2]) else None
