"""What a subdivision of a region in space found: settled boxes by what they hold, and those left over."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from rsym.verify.answers.account import Balance
from rsym.verify.answers.singular import SingularPoint
from rsym.verify.boxes.joints import Meeting
from rsym.verify.boxes.local import Box
from rsym.verify.cover.box_arrays import listed
from rsym.verify.cover.images import Boxes
from rsym.verify.cover.inspection import OPEN, Inspection
from rsym.verify.points.corners import Corner


@dataclass
class Subdivision:
    """Settled boxes by what was found on them, and those left over."""

    regular: dict[int, list[Boxes]] = field(default_factory=dict)  # by the node of the sheet
    order: float = np.inf  # the lowest of the regular sheets
    joined: dict[Meeting, list[Boxes]] = field(default_factory=dict)
    corners: list[tuple[Box, Corner]] = field(default_factory=list)
    broken: dict[Meeting, list[tuple[Box, SingularPoint]]] = field(default_factory=dict)
    double: list[Box] = field(default_factory=list)
    leaps: list[Box] = field(default_factory=list)  # omega changes its sign, and is not zero
    left: list[tuple[Box, Inspection]] = field(default_factory=list)
    late: list[Box] = field(default_factory=list)  # regular, but found so only afterwards
    examined: int = 0
    inspected: int = 0
    unsettled: int = 0  # boxes that no step had settled: they count as left, and as a defect of the search

    def note(self, box: Box, inspected: Inspection) -> bool:
        """Note what was found on a box; whether there was a place for it."""
        if inspected.kind == "regular":
            self.regular.setdefault(inspected.nodes[0], []).append(np.array([box]))
            self.order = min(self.order, inspected.order)
        elif inspected.meeting is not None and isinstance(inspected.place, SingularPoint):
            self.broken.setdefault(inspected.meeting, []).append((box, inspected.place))
        elif inspected.meeting is not None:
            self.joined.setdefault(inspected.meeting, []).append(np.array([box]))
        elif inspected.corner is not None:
            self.corners.append((box, inspected.corner))
        elif inspected.kind in {"double", "leap"}:
            (self.double if inspected.kind == "double" else self.leaps).append(box)
        else:
            return inspected.kind == "empty"
        return True

    def leave(self, boxes: Boxes) -> None:
        """Note boxes on which nothing is proved."""
        self.left.extend((box, OPEN) for box in listed(boxes))

    @property
    def breaks(self) -> list[tuple[Box, SingularPoint]]:
        """The boxes in which the boundary is no surface where omega jumps, with such a point in or beside each."""
        return [pair for pairs in self.broken.values() for pair in pairs]

    @property
    def has_gaps(self) -> bool:
        """Whether there are boxes on which the boundary is not known to be a surface, or was found so only later."""
        return bool(self.left or self.late or self.double or self.broken or self.leaps)

    @property
    def has_more(self) -> bool:
        """Whether there are boxes that hold more than regular sheets, which may meet in curves."""
        return bool(self.has_gaps or self.corners)

    @property
    def balance(self) -> Balance:
        """The boxes that were examined, and those of which it is known what became of them."""
        return Balance(self.examined, self.examined - self.unsettled)

    def without_crossings(self) -> Subdivision:
        """The same, with corners left over that three sheets have along their edges alone.

        Where such an edge is in the report, that is the defect; else nobody has followed the edge.
        """
        open_boxes = [(box, OPEN) for box, one in self.corners if one.point is None]
        corners = [(box, one) for box, one in self.corners if one.point is not None]
        return replace(self, left=[*self.left, *open_boxes], corners=corners)

    def with_late(self, regular: Sequence[Box], corners: Sequence[tuple[Box, Corner]]) -> Subdivision:
        """The same, with some boxes that were left over found to be regular after all, or to hold a corner."""
        settled = {*regular, *(box for box, _ in corners)}
        left = [pair for pair in self.left if pair[0] not in settled]
        return replace(self, left=left, late=list(regular), corners=[*self.corners, *corners])


def joined_boxes(found: Subdivision) -> Sequence[Boxes]:
    """All boxes in which sheets meet."""
    corners = [np.array([box]) for box, _ in found.corners]
    return [*(boxes for group in found.joined.values() for boxes in group), *corners]


def settled_boxes(found: Subdivision) -> Sequence[Boxes]:
    """All boxes of which it is known what they hold, but for those left over and zeros without a change of sign."""
    return [*(part for parts in found.regular.values() for part in parts), *joined_boxes(found)]
