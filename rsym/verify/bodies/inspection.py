"""What one box in space holds of a boundary: nothing, a regular sheet, two sheets that meet, a corner, or no answer."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import product

from rsym.codegen.balls import arb
from rsym.codegen.builder import Builder
from rsym.verify.bodies.corners import Corner, corner
from rsym.verify.bodies.formulas import as_gate
from rsym.verify.bodies.sheets import sheets
from rsym.verify.generators import Generators, generators
from rsym.verify.joints import Meeting, meeting
from rsym.verify.local import Local
from rsym.verify.locus import NONE, Locus, reduce
from rsym.verify.resolution import contact

GROWN = 0.25  # of the width of a box, on every side: what is proved of two sheets holds a little beyond the box
SMOOTH = 3  # sheets that agree to this order have one curvature
FINE = 1 / 4096  # of the extent: below it a leaf of finite class is accepted as it is


@dataclass(frozen=True)
class Inspection:
    """What is proved on a box.

    kind: "empty"; "regular", a sheet of class C^j, j < order; "joined", the two sheets of `meeting`; "corner";
    "double", zeros without a change of sign; "open", nothing is proved. `nodes` are the functions of the sheets.
    """

    kind: str
    nodes: tuple[int, ...] = ()
    order: float = math.inf
    meeting: Meeting | None = None
    corner: Corner | None = None
    locus: Locus = NONE


EMPTY, OPEN = Inspection("empty"), Inspection("open")


def inspect(local: Local, extent: float, number: int, *, corners: bool = True) -> Inspection:
    """What is proved of the zero set of a node on a box; `extent` is the size of the whole."""
    locus = locus_of(local, number)
    if locus.kind == "none":
        return EMPTY
    if locus.kind == "leaf":
        return _leaf(local, extent, number, locus)
    if locus.kind in {"conjunction", "disjunction"}:
        return _joined(local, number, locus)
    if locus.kind == "double":
        return _double(local, locus)
    if locus.kind == "several" and corners:
        found = corner(local, number)
        return Inspection("corner", corner=found) if found is not None else Inspection("open", locus=locus)
    return Inspection("open", locus=locus)


def locus_of(local: Local, number: int) -> Locus:
    """The locus of a node on a box; of several leaves only those count that the logic needs."""
    locus = reduce(local, number)
    if locus.kind not in {"several", "conjunction", "disjunction", "product"}:
        return locus
    found = sheets(local, number)
    if found is None or len(found.leaves) > 2:
        return locus
    b, leaves, single = local.model.builder, found.leaves, as_gate(found.formula)
    if not leaves:
        return NONE
    if single is None:
        return Locus("double", leaves) if len(leaves) == 1 else locus
    operation, signs = single
    nodes = tuple(leaf if sign > 0 else b.neg(leaf) for leaf, sign in zip(leaves, signs, strict=True))
    return Locus("leaf" if len(leaves) == 1 else "conjunction" if operation == "min" else "disjunction", nodes)


def _leaf(local: Local, extent: float, number: int, locus: Locus) -> Inspection:
    """One leaf: analytic, or with one switch, across which it may be two sheets or smooth enough."""
    (leaf,) = locus.nodes
    found = generators(local, leaf)
    if found.analytic:
        return _regular(local, locus, math.inf)
    if found.hard or len(found.switches) > 1:
        return Inspection("open", locus=locus)
    inspected = _joined(local, number, locus)
    if inspected.kind == "open" and all(float(arb(side.rad())) < extent * FINE for side in local.sides[:3]):
        order = contact(local, leaf, found.switches[0])
        return _regular(local, locus, order) if order >= SMOOTH else inspected
    return inspected


def _regular(local: Local, locus: Locus, order: float) -> Inspection:
    """A regular sheet where a component of the gradient excludes zero, by the implicit function theorem."""
    slopes = local.gradient(locus.nodes[0])
    if not any(slope > 0 or slope < 0 for slope in slopes):
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
    sheets = meeting(around, outer, found)
    if sheets is None or sheets.contact < 1 or not _is_transversal(around, sheets):
        return Inspection("open", locus=locus)
    return Inspection("joined", tuple(arc.function for arc in sheets.arcs), meeting=sheets, locus=outer)


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


def is_even(builder: Builder, number: int) -> bool:
    """Whether a node shows by its operation that it is zero without a change of sign, if at all."""
    operation, arguments, data = builder.nodes[number]
    while operation == "neg" or (operation == "mul" and builder.value(arguments[0]) is not None):
        operation, arguments, data = builder.nodes[arguments[-1]]
    return (operation == "mul" and arguments[0] == arguments[1]) or (operation == "powi" and int(str(data)) % 2 == 0)


def _double(local: Local, locus: Locus) -> Inspection:
    """A zero without a change of sign is proved where the inner node changes sign on the box."""
    model, (inner,) = local.model, locus.nodes
    ends = [(side.lower(), side.upper()) for side in local.sides[:3]]
    signs = {model.on([*point, *local.sides[3:]]).sign(inner) for point in product(*ends)}
    proved = {1, -1} <= signs and generators(local, inner).analytic
    return Inspection("double" if proved else "open", locus=locus)
