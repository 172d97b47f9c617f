"""What boxes with sides along letters say for every value: they certify, and what else they hold is left open.

On such a box the curve in which two sheets meet, or the corner of three, has another place for each value, perhaps
beyond the bounds; so a jump on it refutes nothing, and a smooth joint counts only where its class is that of the
sheets by their structure, all along the curve whatever its place is.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import product

import numpy as np

from rsym.bounds.balls import ctx
from rsym.sampling.progress import Effort
from rsym.verify.boxes.classes import CURVED
from rsym.verify.boxes.joints import Meeting
from rsym.verify.boxes.local import PRECISION, Box, Model, side
from rsym.verify.cover.box_arrays import at, listed
from rsym.verify.cover.images import Boxes, Images
from rsym.verify.cover.inspection import OPEN
from rsym.verify.cover.subdivision import Subdivision, joined_boxes
from rsym.verify.curves.components import halves_of, narrowed
from rsym.verify.curves.continuation import ZeroCurve

PARTS = 64  # into which a box may fall in the proof that a curve does not pass it
CELLS = 2_000  # parts of the ranges that are looked at in that proof
HALVINGS = 12  # of the range of a letter, in the proof that there is a boundary for every value


def for_every_value(model: Model, found: Subdivision, extent: float, effort: Effort) -> Subdivision:
    """The same boxes, those left over on which a jump is not excluded for some value of the letters.

    Two sheets whose functions differ by h u**k, u the side, have contact of order k - 1 all along the curve u = 0 in
    which they meet, transversally: there the boundary is of class G^(k-1), whichever the curve is. With k < 3 it must
    be proved that no curve passes the boxes at all. A corner is left over.
    """
    joined: dict[Meeting, list[Boxes]] = {}
    left, order = [*found.left, *((box, OPEN) for box, _ in found.corners)], found.order
    for meeting, groups in found.joined.items():
        boxes = [box for group in groups for box in listed(group)]
        if meeting.contact > CURVED:
            order = min(order, meeting.contact)
        elif not _never_meet(model, meeting, boxes, extent, effort):
            left += [(box, OPEN) for box in boxes]
            continue
        joined[meeting] = groups
    return replace(found, joined=joined, corners=[], left=left, order=order)


def _never_meet(model: Model, meeting: Meeting, boxes: Sequence[Box], extent: float, effort: Effort) -> bool:
    """Whether the curve of two sheets passes none of the boxes, for no value of the letters."""
    arc = meeting.arcs[0]
    with ctx.workprec(PRECISION):
        for box in boxes:
            curve = ZeroCurve(model, (arc.function, arc.side), [side(*ends) for ends in box[3:]], extent)
            parts = [tuple(side(*ends) for ends in box[:3])]
            for _ in range(PARTS):
                if not parts:
                    break
                part = narrowed(curve, parts.pop())
                if part is not None:
                    parts += halves_of(part)
            if parts or effort.is_over:
                return False
            effort.reach(0.0)
    return True


def exists_for_every_value(images: Images, found: Subdivision, most: int) -> bool | None:
    """Whether there is a boundary for every value of the letters; False: there is none for any value.

    Where omega has both signs at corners of a settled box, for all letters in a range inside that of the box, it has
    a zero in it for each of them. The ranges are halved until there is such a box for every part.
    """
    late = [np.array([box]) for box in found.late]
    boxes = [*(part for parts in found.regular.values() for part in parts), *joined_boxes(found), *late]
    if not boxes:
        return None if found.left or found.double else False
    settled = np.concatenate(boxes)
    settled = settled[np.argsort(-(settled[:, 3:, 1] - settled[:, 3:, 0]).sum(axis=1), kind="stable")]
    cells, tried = [(images.ranges, 0)], 0
    while cells:
        cell, depth = cells.pop()
        tried += 1
        own = settled[((settled[:, 3:, 0] <= cell[:, 0]) & (cell[:, 1] <= settled[:, 3:, 1])).all(axis=1)][:most]
        if len(own) and _changes_sign(images, own, cell):
            continue
        if depth == HALVINGS * len(cell) or tried > CELLS:
            return None
        axis = int(((cell[:, 1] - cell[:, 0]) / (images.ranges[:, 1] - images.ranges[:, 0])).argmax())
        middle = cell[axis, 0] + (cell[axis, 1] - cell[axis, 0]) / 2
        for end in (0, 1):
            half = cell.copy()
            half[axis, 1 - end] = middle
            cells.append((half, depth + 1))
    return True


def _changes_sign(images: Images, boxes: Boxes, cell: Boxes) -> bool:
    """Whether omega has both signs at corners of one of the boxes, for all letters in a cell."""
    sides = np.concatenate([boxes[:, :3], np.broadcast_to(cell, (len(boxes), *cell.shape))], axis=1)
    corners = (at(sides[:, range(3), list(ends)], sides) for ends in product((0, 1), repeat=3))
    signs = np.array([images.sign(points) for points in corners])
    return bool(((signs > 0).any(axis=0) & (signs < 0).any(axis=0)).any())
