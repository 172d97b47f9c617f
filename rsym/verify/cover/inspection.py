"""What one box in space holds of a boundary: nothing, a regular sheet, two sheets that meet, a corner, or no answer."""

from __future__ import annotations

import math
from dataclasses import dataclass

from rsym.bounds.balls import arb
from rsym.verify.answers.singular import SingularPoint
from rsym.verify.boxes.body_breaks import broken
from rsym.verify.boxes.breaks import are_empty, changes_sign, emptiness
from rsym.verify.boxes.classes import CURVED, PARTED, parted, pieces
from rsym.verify.boxes.generators import Generators, generators
from rsym.verify.boxes.joints import Meeting, meeting
from rsym.verify.boxes.local import Local
from rsym.verify.boxes.locus import NONE, Locus
from rsym.verify.boxes.root_classes import root_order
from rsym.verify.boxes.sheets import locus_of, sheets
from rsym.verify.boxes.touching import touching
from rsym.verify.points.corners import Corner, corner

GROWN = 0.25  # of the width of a box, on every side: what is proved of two sheets holds a little beyond the box


@dataclass(frozen=True)
class Inspection:
    """What is proved on a box.

    kind: "empty"; "regular", a sheet of class C^j, j < order; "joined", the two sheets of `meeting`; "corner";
    "broken", there is no surface at `point`; "double", zeros without a change of sign; "leap", a change of sign
    without zeros; "open", nothing is proved. `nodes` are the functions of the sheets.
    """

    kind: str
    nodes: tuple[int, ...] = ()
    order: float = math.inf
    meeting: Meeting | None = None
    corner: Corner | None = None
    point: SingularPoint | None = None
    locus: Locus = NONE


EMPTY, OPEN = Inspection("empty"), Inspection("open")


def inspect(local: Local, number: int, *, corners: bool = True) -> Inspection:
    """What is proved of the zero set of a node on a box."""
    locus = locus_of(local, number)
    if locus.kind == "none":
        return EMPTY
    if locus.kind == "leaf":
        return _leaf(local, number, locus)
    if locus.kind in {"conjunction", "disjunction"}:
        inspected = _joined(local, number, locus)
        return inspected if inspected.kind != "open" else _touching(local, number, locus)
    if locus.kind == "double":
        return _double(local, locus)
    if locus.kind == "several" and (inspected := _touching(local, number, locus)).kind != "open":
        return inspected
    if locus.kind == "several" and corners:
        found = corner(local, number)
        return Inspection("corner", corner=found) if found is not None else Inspection("open", locus=locus)
    return Inspection("open", locus=locus)


def _leaf(local: Local, number: int, locus: Locus) -> Inspection:
    """One leaf: analytic, or with switches, across which it is smooth enough, or two sheets of one switch."""
    (leaf,) = locus.nodes
    found = generators(local, leaf)
    if found.analytic:
        return _regular(local, locus, (leaf,), math.inf)
    if not found.hard:
        made = pieces(local, leaf)
        if math.isinf(made.order):
            return _regular(local, Locus("leaf", made.nodes[:1]), made.nodes[:1], math.inf)
        inspected = _joined(local, number, locus) if len(found.switches) <= PARTED else OPEN
        if inspected.kind == "open" and made.order > CURVED:
            return _regular(local, locus, made.nodes, made.order)
        if inspected.kind != "open":
            return inspected
    elif len(found.switches) == 1 and (inspected := _joined(local, number, locus)).kind != "open":
        return inspected
    order = root_order(local, leaf)
    return _regular(local, locus, (leaf,), order) if order > CURVED else Inspection("open", locus=locus)


def _regular(local: Local, locus: Locus, parts: tuple[int, ...], order: float) -> Inspection:
    """A regular sheet where a component of the gradient excludes zero, by the implicit function theorem.

    The gradient of the leaf is everywhere that of one of its parts: one component has one sign in all of them.
    """
    columns = list(zip(*(local.gradient(part) for part in parts), strict=True))
    if not any(all(slope > 0 for slope in column) or all(slope < 0 for slope in column) for column in columns):
        return Inspection("open", locus=locus)
    return Inspection("regular", locus.nodes, order, locus=locus)


def grown(local: Local) -> Local:
    """What is known on a box a little larger."""
    sides = [side + arb(0, 2 * GROWN) * arb(side.rad()) for side in local.sides[: local.model.dimension]]
    return local.model.on([*sides, *local.sides[local.model.dimension :]])


def _joined(local: Local, number: int, locus: Locus) -> Inspection:
    """Two sheets on the grown box, analytic and nowhere tangent to their common curve's other side."""
    around = grown(local)
    outer = locus_of(around, number)
    if outer.kind == "none":
        return EMPTY
    found: Generators | None = generators(around, outer.nodes[0]) if outer.kind == "leaf" else None
    if found is not None and found.analytic:
        return Inspection("open", locus=locus)
    pair = meeting(around, outer, found)
    if pair is None and found is not None:
        pair = parted(around, outer.nodes[0], found)
    if pair is None:
        return Inspection("open", locus=locus)
    if pair.continuous and are_empty(around, pair):
        return EMPTY
    if not pair.continuous:
        return _jumping(local, around, pair, locus)
    if not _is_transversal(around, pair):
        return Inspection("open", locus=locus)
    return Inspection("joined", tuple(arc.function for arc in pair.arcs), meeting=pair, locus=outer)


def _touching(local: Local, number: int, locus: Locus) -> Inspection:
    """Sheets that touch along a whole curve: one of them is the boundary, or both continue each other."""
    around = grown(local)
    found = sheets(around, number)
    result = None if found is None else touching(around, found)
    if isinstance(result, int):
        return _regular(local, Locus("leaf", (result,)), (result,), math.inf)
    if result is None or not _is_transversal(around, result):
        return Inspection("open", locus=locus)
    return Inspection("joined", tuple(arc.function for arc in result.arcs), meeting=result, locus=locus)


def _jumping(local: Local, around: Local, sheets: Meeting, locus: Locus) -> Inspection:
    """Sides of a switch between which omega may jump."""
    kind = emptiness(local, around, sheets)
    if len(local.sides) > 3 and kind != "empty":
        return Inspection("open", locus=locus)  # a letter that ranges: it may be so for some values only
    if kind is not None:
        return Inspection(kind, locus=Locus("double", (sheets.arcs[0].side,)))
    point = broken(around, sheets)
    return Inspection("open" if point is None else "broken", meeting=sheets, point=point, locus=locus)


def _is_transversal(local: Local, sheets: Meeting) -> bool:
    """Whether all functions are analytic on the box and no sheet is tangent to its side anywhere on it."""
    for arc in sheets.arcs:
        if not (generators(local, arc.function).analytic and generators(local, arc.side).analytic):
            return False
        p, q = local.gradient(arc.function), local.gradient(arc.side)
        cross = (p[i] * q[j] - p[j] * q[i] for i, j in ((1, 2), (2, 0), (0, 1)))
        if not any(component > 0 or component < 0 for component in cross):
            return False
    return True


def _double(local: Local, locus: Locus) -> Inspection:
    """A zero without a change of sign is proved where the inner node changes sign on the box."""
    return Inspection("double" if changes_sign(local, locus.nodes[0]) else "open", locus=locus)
