"""Subdivision: the boxes into which a region falls until each is settled, or too small to go on."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field

from flint import arb, ctx

from rsym.codegen.balls import ball
from rsym.verify.examination import Finding, examine
from rsym.verify.local import Model

Box = tuple[tuple[float, float], ...]

PRECISION = 80  # bits of the balls: 53 would do, a few more keep corners from being decided by rounding
# The first cut is off centre, so that no side of a box lies on the planes of symmetry of a model.
OFF_CENTRE = 0.4375 + 1 / 64
Discard = Callable[[Sequence[Box]], Sequence[bool]]


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
    discard: Discard | None = None,
    progress: Callable[[int, int], bool] | None = None,
) -> Covering:
    """Subdivide the bounds, breadth first, until every box is settled, narrower than `smallest`, or too many.

    `discard` says of many boxes at once which certainly hold no zero; the others are examined one by one.
    """
    extent = max(high - low for low, high in bounds[:2])
    result = Covering()
    level = list(_first(bounds))
    with ctx.workprec(PRECISION):
        while level:
            if discard is not None:
                level = [box for box, empty in zip(level, discard(level), strict=True) if not empty]
            following: list[Box] = []
            for box in level:
                if result.examined >= budget:
                    result.left.append((box, Finding("open")))
                    continue
                result.examined += 1
                finding = examine(model.on([side(*ends) for ends in box]), extent)
                if finding.kind == "open":
                    if max(high - low for low, high in box[:2]) <= smallest:
                        result.left.append((box, finding))
                    else:
                        following.extend(halves(model, box, bounds))
                elif finding.kind != "empty":
                    result.settled.append((box, finding))
            if progress is not None:
                progress(result.examined, budget)
            level = following
    return result


def side(low: float, high: float) -> arb:
    """The ball around an interval of floats."""
    return ball(arb(low), arb(high))


def _first(bounds: Box) -> Iterator[Box]:
    boxes: list[Box] = [bounds]
    for axis in range(2):
        low, high = bounds[axis]
        boxes = [half for box in boxes for half in _cut(box, axis, low + OFF_CENTRE * (high - low))]
    return iter(boxes)


def _cut(box: Box, axis: int, at: float) -> tuple[Box, Box]:
    low, high = box[axis]
    return (*box[:axis], (low, at), *box[axis + 1 :]), (*box[:axis], (at, high), *box[axis + 1 :])


def halves(model: Model, box: Box, bounds: Box) -> list[Box]:
    """The box cut in two across both coordinates; letters that range are cut like the widest coordinate."""
    boxes = [box]
    for axis, (low, high) in enumerate(box):
        if axis >= 2 and not _letter_is_wide(box, bounds, axis):
            continue
        middle = low + (high - low) / 2
        boxes = [half for one in boxes for half in _cut(one, axis, middle)]
    return boxes


def _letter_is_wide(box: Box, bounds: Box, axis: int) -> bool:
    """Whether a letter's share of its range exceeds the coordinates' share of theirs."""
    share = max((box[k][1] - box[k][0]) / (bounds[k][1] - bounds[k][0]) for k in range(2))
    return (box[axis][1] - box[axis][0]) / (bounds[axis][1] - bounds[axis][0]) > 16 * share
