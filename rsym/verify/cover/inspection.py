"""What one box holds of a boundary: nothing, a regular piece, two pieces that meet, a singular place, or no answer.

The way is the same in the plane and in space: the leaf that is left, or what joins those that are. Only whether a piece
is regular, where two of them meet, and what else may be tried, are questions of the dimension.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass

from rsym.verify.answers.report import Joint
from rsym.verify.answers.singular import SingularPoint
from rsym.verify.boxes.breaks import Break, are_empty, changes_sign, emptiness, find_break
from rsym.verify.boxes.classes import CURVED, PARTED, parted, pieces
from rsym.verify.boxes.generators import Generators, generators
from rsym.verify.boxes.joints import Meeting, is_transversal, meeting
from rsym.verify.boxes.local import Local
from rsym.verify.boxes.locus import NONE, Locus
from rsym.verify.boxes.root_classes import root_order
from rsym.verify.boxes.sheets import locus_of, sheets
from rsym.verify.boxes.touching import touching
from rsym.verify.points.corners import Corner


@dataclass(frozen=True)
class Inspection:
    """What is proved on a box.

    kind: "empty"; "regular", a curve or surface of class C^j, j < order, analytic if the order is infinite; "joined",
    two that meet: in the joint `place` in the plane, in the curve of `meeting` in space; "corner", of three sheets;
    "broken", there is no curve or surface at `place`; "double", zeros without a change of sign; "leap", a change of
    sign without zeros; "open", nothing is proved.

    Of a regular sheet in space `nodes` are the functions that it is a zero set of. In the plane no curvature is larger
    in size than `curvature`, of which at most the share `slack` is due to the enclosure.
    """

    kind: str
    nodes: tuple[int, ...] = ()
    order: float = math.inf
    locus: Locus = NONE
    meeting: Meeting | None = None
    place: Joint | SingularPoint | None = None
    corner: Corner | None = None
    curvature: float = math.inf
    slack: float = math.inf


EMPTY, OPEN = Inspection("empty"), Inspection("open")


class Inspector(ABC):
    """Asks what the zero set of a node is on one box."""

    def inspect(self, local: Local, number: int | None = None) -> Inspection:
        """What is proved of the zero set of a node, of the root if none is named, on a box."""
        number = local.model.root if number is None else number
        locus = locus_of(local, number)
        if locus.kind == "none":
            return EMPTY
        finding = Inspection("open", locus=locus)
        if locus.kind == "double":
            # Proved where the inner node changes sign on the box.
            finding = Inspection("double" if changes_sign(local, locus.nodes[0]) else "open", locus=locus)
        elif locus.kind == "leaf":
            finding = self._leaf(local, number, locus)
        elif locus.kind in {"conjunction", "disjunction", "several"}:
            finding = self._joined(local, number, locus)
        return self.further(local, number, finding) if finding.kind == "open" else finding

    def _leaf(self, local: Local, number: int, locus: Locus) -> Inspection:
        """One leaf: analytic, or with switches, across which it is smooth enough, or two pieces of one switch."""
        (leaf,) = locus.nodes
        found = generators(local, leaf)
        if found.analytic:
            return self.regular(local, locus, (leaf,), math.inf)
        if not found.hard:
            made = pieces(local, leaf)
            if math.isinf(made.order):  # folds that cancel
                return self.regular(local, Locus("leaf", made.nodes[:1]), made.nodes[:1], math.inf)
            finding = self._joined(local, number, locus) if len(found.switches) <= PARTED else OPEN
            if finding.kind == "open" and made.order > CURVED:
                return self.regular(local, locus, made.nodes, made.order)
            if finding.kind != "open":
                return finding
        elif len(found.switches) == 1 and (finding := self._joined(local, number, locus)).kind != "open":
            return finding
        order = root_order(local, leaf)
        return self.regular(local, locus, (leaf,), order) if order > CURVED else Inspection("open", locus=locus)

    def _joined(self, local: Local, number: int, locus: Locus) -> Inspection:
        """Two pieces on the grown box, analytic and nowhere tangent to what ends them; or one that is all."""
        around = local.surroundings
        outer = locus_of(around, number)
        if outer.kind == "none":
            return EMPTY
        found: Generators | None = generators(around, outer.nodes[0]) if outer.kind == "leaf" else None
        if found is not None and found.analytic:
            return Inspection("open", locus=locus)
        pair = meeting(around, outer, found)
        if pair is None and found is not None:
            pair = parted(around, outer.nodes[0], found)
        if pair is not None and pair.continuous and are_empty(around, pair):
            return EMPTY
        if pair is not None and not pair.continuous:
            finding = self.jumping(local, around, pair, locus)
            if finding.kind != "open":
                return finding
        if (pair is None or not is_transversal(around, pair)) and outer.kind != "leaf":
            alone = sheets(around, number)
            touched = None if alone is None else touching(around, alone)
            if isinstance(touched, int):
                return self.regular(local, Locus("leaf", (touched,)), (touched,), math.inf)
            pair = touched
        if pair is None or not is_transversal(around, pair):
            return Inspection("open", locus=locus)
        return self.meeting(local, around, pair, outer)

    def jumping(self, local: Local, around: Local, pair: Meeting, locus: Locus) -> Inspection:
        """Sides of a switch between which omega may jump."""
        kind = emptiness(local, around, pair)
        if kind is not None:
            return Inspection(kind, locus=Locus("double", (pair.arcs[0].side,)))
        found = find_break(local, around, pair)
        if found is None:
            return Inspection("open", locus=locus)
        return Inspection("broken", locus=locus, meeting=pair, place=self.broken(found))

    @abstractmethod
    def regular(self, local: Local, locus: Locus, nodes: tuple[int, ...], order: float) -> Inspection:
        """Whether a leaf, whose gradient is everywhere that of one of some nodes, is regular on the box."""

    @abstractmethod
    def meeting(self, local: Local, around: Local, pair: Meeting, locus: Locus) -> Inspection:
        """What two pieces make of a box, transversal on one a little larger."""

    @abstractmethod
    def broken(self, found: Break) -> Joint | SingularPoint:
        """The place of a break."""

    def further(self, local: Local, number: int, finding: Inspection) -> Inspection:
        """What else may be tried on a box that is open."""
        return finding
