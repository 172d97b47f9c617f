"""Whether there is a boundary at all: what the boxes of a proof say of it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import islice, product

from rsym.bounds.balls import arb, ctx
from rsym.verify.answers.report import Joint
from rsym.verify.boxes.local import PRECISION, Box, Model, side
from rsym.verify.cover.arcs import ArcInspector
from rsym.verify.cover.covering import Covering, halves
from rsym.verify.cover.inspection import Inspection

PARTS, LOOKED_AT = 256, 64  # of the ranges of letters, and boxes over each, in search of a boundary for all of them
DIVIDED, MOST_DIVIDED = 8, 500  # times that boxes are divided in search of a point of the boundary, and how many
NOWHERE = ("no point of the boundary was found within the bounds for every value of the letters", False)


def has_boundary(model: Model, found: Covering, joints: Sequence[Joint], extent: float) -> bool | None:
    """Whether there is a point of the boundary: True and False are proved, None is neither.

    Where omega has both signs on a settled box it has a zero there, as it has the sign of a continuous function; of
    a double zero the inner function counts. Settled boxes without a change of sign are divided a few times: either
    one appears, or all are discarded. A leap over zero is no zero.
    """
    if joints:
        return True
    boxes = [pair for pair in found.settled if pair[1].kind != "leap"]
    inspector = ArcInspector(extent)
    with ctx.workprec(PRECISION):
        for _ in range(DIVIDED):
            if any(_changes_sign(model, box, finding) for box, finding in boxes) or len(boxes) > MOST_DIVIDED:
                break
            halved = [half for box, _ in boxes for half in halves(model, box)]
            findings = [inspector.inspect(model.over(half)) for half in halved]
            boxes = [pair for pair in zip(halved, findings, strict=True) if pair[1].kind not in {"empty", "leap"}]
        if any(_changes_sign(model, box, finding) for box, finding in boxes):
            return True
    leaps = any(finding.kind == "leap" for _, finding in found.settled)
    return None if boxes or leaps or found.left else False


def has_boundary_for_every_value(model: Model, found: Covering, ranges: Box) -> bool:
    """Whether it is proved that there is a point of the boundary whatever the letters are in their ranges.

    Where omega has both signs at points of a settled box, for all letters in a part of the ranges of the box, it has a
    zero in the box for each of them. The ranges are halved until there is such a box for every part.
    """
    cells, tried = [ranges], 0
    with ctx.workprec(PRECISION):
        while cells and tried < PARTS:
            cell = cells.pop()
            tried += 1
            if not any(_changes_sign(model, box, finding, _sides(cell)) for box, finding in _over(found, cell)):
                widths = [(high - low) / (b - a) for (low, high), (a, b) in zip(cell, ranges, strict=True)]
                axis = widths.index(max(widths))
                low, high = cell[axis]
                middle = low + (high - low) / 2
                cells += [(*cell[:axis], half, *cell[axis + 1 :]) for half in ((low, middle), (middle, high))]
    return not cells


def _over(found: Covering, cell: Box) -> Iterator[tuple[Box, Inspection]]:
    """Some of the settled boxes that hold a part of the ranges, evenly chosen."""
    own = [
        (box, finding)
        for box, finding in found.settled
        if all(low <= a and b <= high for (low, high), (a, b) in zip(box[2:], cell, strict=True))
    ]
    return islice(own, 0, None, max(1, len(own) // LOOKED_AT))


def _sides(cell: Box) -> list[arb]:
    return [side(*ends) for ends in cell]


def _changes_sign(model: Model, box: Box, finding: Inspection, ranges: Sequence[arb] | None = None) -> bool:
    number = finding.locus.nodes[0] if finding.locus.kind in {"leaf", "double"} else model.root
    ranges = [one.mid() for one in _sides(box[2:])] if ranges is None else ranges
    points = product(*((low, low + (high - low) / 2, high) for low, high in box[:2]))
    return {1, -1} <= {model.on([arb(x), arb(y), *ranges]).sign(number) for x, y in points}
