"""Sheets of a boundary in space on one box."""

from __future__ import annotations

from dataclasses import dataclass

from rsym.verify.answers.singular import SingularPoint
from rsym.verify.boxes.breaks import Break
from rsym.verify.boxes.joints import Meeting
from rsym.verify.boxes.local import Local
from rsym.verify.boxes.locus import Locus
from rsym.verify.boxes.vectors import floats, radius_of
from rsym.verify.cover.inspection import Inspection, Inspector
from rsym.verify.points.corners import corner


@dataclass(frozen=True)
class SheetInspector(Inspector):
    """Looks for one sheet, two that meet in a curve, or the corner of three, the last only with `corners`."""

    corners: bool = True

    def regular(self, local: Local, locus: Locus, nodes: tuple[int, ...], order: float) -> Inspection:
        """A regular sheet where a component of the gradient excludes zero, by the implicit function theorem.

        The gradient of the leaf is everywhere that of one of the nodes: one component has one sign in all of them.
        """
        columns = list(zip(*map(local.gradient, nodes), strict=True))
        if not any(all(slope > 0 for slope in column) or all(slope < 0 for slope in column) for column in columns):
            return Inspection("open", locus=locus)
        return Inspection("regular", locus.nodes, order, locus=locus)

    def jumping(self, local: Local, around: Local, pair: Meeting, locus: Locus) -> Inspection:
        """Where a letter ranges, omega may jump for some values only: a box is empty, or open."""
        found = super().jumping(local, around, pair, locus)
        return found if found.kind == "empty" or len(local.sides) == 3 else Inspection("open", locus=locus)

    def meeting(self, local: Local, around: Local, pair: Meeting, locus: Locus) -> Inspection:
        """Two sheets that meet in a curve, if at all: others follow it."""
        if not pair.continuous:
            return Inspection("open", locus=locus)
        return Inspection("joined", tuple(arc.function for arc in pair.arcs), meeting=pair, locus=locus)

    def broken(self, found: Break) -> SingularPoint:
        """A point at which the boundary is no surface."""
        place = found.at.sides[:3]
        return SingularPoint(floats(place), radius_of(place), found.kind, "broken", proved=True, reason=found.reason)

    def further(self, local: Local, number: int, finding: Inspection) -> Inspection:
        """A corner of three sheets."""
        if finding.locus.kind != "several" or not self.corners:
            return finding
        found = corner(local, number)
        return finding if found is None else Inspection("corner", corner=found)
