"""What one box holds of a boundary: nothing, a regular arc, two arcs that meet, or something to look at closer."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from rsym.bounds.balls import arb, ctx, hypotenuse
from rsym.program.builder import Builder
from rsym.verify.answers.report import Joint
from rsym.verify.boxes.borders import is_within
from rsym.verify.boxes.breaks import are_empty, broken, changes_sign, emptiness
from rsym.verify.boxes.classes import NOTHING, pieces
from rsym.verify.boxes.domains import is_defined
from rsym.verify.boxes.edges import edge, has_edges
from rsym.verify.boxes.generators import Generators, generators
from rsym.verify.boxes.joints import PRECISE, BoundaryArc, Meeting, is_transversal, joint, locate, located, meeting
from rsym.verify.boxes.local import Local
from rsym.verify.boxes.locus import NONE, Locus
from rsym.verify.boxes.resolution import resolved
from rsym.verify.boxes.root_classes import root_order
from rsym.verify.boxes.sheets import locus_of, sheets
from rsym.verify.boxes.touching import touching
from rsym.verify.boxes.vanishing import vanishes_with

# A joint on a side of a box lies inside the box grown by this share of its width; where letters range, it moves.
GROWN = 0.25
GROWN_FOR_RANGES = 1.5


@dataclass(frozen=True)
class BoxFinding:
    """What is proved on a box.

    kind: "empty"; "regular", an arc of class C^j, j < order, analytic if the order is infinite; "joined", two arcs
    that meet in `joint`; "broken", there is no curve at `joint`; "double", zeros without a change of sign; "leap", a
    change of sign without zeros; "open", nothing is proved. No curvature is larger in size than `curvature`, of which
    at most the share `slack` is due to the enclosure.
    """

    kind: str
    order: float = math.inf
    curvature: float = math.inf
    slack: float = math.inf
    joint: Joint | None = None
    locus: Locus = NONE


EMPTY, OPEN = BoxFinding("empty"), BoxFinding("open")


def examine(local: Local, extent: float, number: int | None = None) -> BoxFinding:
    """What is proved of the zero set of a node (of the root) on a box; `extent` is the size of the whole."""
    number = local.model.root if number is None else number
    finding = _examined(local, extent, number)
    found = edge(local, _grown(local), number) if finding.kind == "open" and has_edges(local, number) else None
    return finding if found is None else BoxFinding(found.kind, math.inf, found.curvature, found.slack, found.joint)


def _examined(local: Local, extent: float, number: int) -> BoxFinding:
    locus = locus_of(local, number)
    if locus.kind == "none":
        return EMPTY
    if locus.kind == "double":
        return _double(local, locus)
    if locus.kind == "leaf":
        return _leaf(local, extent, number, locus)
    if locus.kind in {"conjunction", "disjunction", "several"}:
        return _joined(local, number, extent)
    if locus.kind == "product":
        return _product(local, extent, locus)
    return BoxFinding("open", locus=locus)


def _leaf(local: Local, extent: float, number: int, locus: Locus) -> BoxFinding:
    """One leaf: analytic, or with one switch, across which it may be two arcs or smooth enough."""
    (leaf,) = locus.nodes
    found = generators(local, leaf)
    if found.analytic:
        return _regular(local, locus, math.inf, extent)
    made = NOTHING if found.hard else pieces(local, leaf)
    if math.isinf(made.order):  # folds that cancel
        return _regular(local, Locus("leaf", made.nodes[:1]), math.inf, extent)
    finding = _joined(local, number, extent) if len(found.switches) == 1 else BoxFinding("open", locus=locus)
    if finding.kind == "open" and (found.hard or len(found.switches) > 1):
        order = root_order(local, leaf)
        return _regular(local, locus, order, extent) if order > 2 else finding
    if finding.kind == "open" and _is_small(local, extent):
        order = resolved(local, leaf, found.switches[0]).order
        return _regular(local, locus, order, extent) if order > 2 else finding
    return finding


def _regular(local: Local, locus: Locus, order: float, extent: float) -> BoxFinding:
    """A regular arc where one component of the gradient excludes zero, by the implicit function theorem."""
    model, (leaf,) = local.model, locus.nodes
    found = [local.value(node) for node in model.gradient(leaf)]
    slopes = [slope for slope in found if slope is not None]
    if len(slopes) < 2:
        return BoxFinding("open", locus=locus)
    if _centred_excludes_zero(local, leaf, slopes):
        return EMPTY
    if not any(slope > 0 or slope < 0 for slope in slopes):
        return BoxFinding("open", locus=locus)
    bound = curvature_bound(local, leaf)
    if bound is None and order < math.inf and _is_small(local, extent):
        bound = (math.inf, 0.0)  # continuous, but derivatives of |u|**a with a fractional a have no enclosure at 0
    return BoxFinding("open", locus=locus) if bound is None else BoxFinding("regular", order, *bound, locus=locus)


def _centred_excludes_zero(local: Local, leaf: int, slopes: list[arb]) -> bool:
    """Whether the mean value form f(m) + grad f (B - m) excludes zero."""
    middle = [side.mid() for side in local.sides[:2]]
    value = local.model.on([*middle, *local.sides[2:]]).value(leaf)
    if value is None:
        return False
    for slope, side, centre in zip(slopes, local.sides, middle, strict=False):
        value += slope * (side - centre)
    return value.is_finite() and not value.contains(0)


def curvature_bound(local: Local, leaf: int) -> tuple[float, float] | None:
    """(bound, slack) of the size of the curvatures on the box; None where an enclosure has no end."""
    bounds = []
    for value in curvatures(local, leaf):
        if not value.is_finite():
            return None
        radius, middle = float(arb(value.rad())), abs(float(value.mid()))
        bounds.append((float(abs(value).upper()), radius / (radius + middle or 1)))
    return max(bounds)


def _is_small(local: Local, extent: float) -> bool:
    return all(float(arb(side.rad())) < extent / 4096 for side in local.sides[:2])


def _product(local: Local, extent: float, locus: Locus) -> BoxFinding:
    """A factor that is zero in one point only, a sum of squares, where the other factor is zero too, drops."""
    model = local.model
    for factor, other in (locus.nodes, locus.nodes[::-1]):
        roots = square_roots(model.builder, factor)
        if len(roots) < 2 or not all(generators(local, root).analytic for root in roots[:2]):
            continue
        zero = locate(_grown(local), BoundaryArc(roots[0], roots[1]))
        if zero is None or not is_defined(local, factor):
            continue
        if zero.box is None:
            return examine(local, extent, other)
        with ctx.workprec(PRECISE):
            found = locate(model.on([*zero.box, *local.sides[2:]]), BoundaryArc(roots[0], roots[1]), precise=True)
            if found is None or found.box is None:
                continue
            at = model.on([*found.box, *local.sides[2:]])
            if vanishes_with(at, (roots[0], roots[1]), other):
                return examine(local, extent, other)
    return BoxFinding("open", locus=locus)


def square_roots(builder: Builder, number: int) -> list[int]:
    """The nodes whose squares are terms of a sum of which nothing is negative: all vanish where the sum does."""
    roots, stack = [], [number]
    while stack:
        part = stack.pop()
        operation, arguments, _ = builder.nodes[part]
        if not builder.nonnegative[part]:
            return []
        if operation == "add":
            stack.extend(arguments)
        elif operation == "mul" and arguments[0] == arguments[1]:
            roots.append(arguments[0])
        elif operation == "powi":
            roots.append(arguments[0])
    return roots


def _grown(local: Local) -> Local:
    share = GROWN if len(local.sides) == 2 else GROWN_FOR_RANGES
    sides = [side + arb(0, share * 2) * arb(side.rad()) for side in local.sides[:2]]
    return local.model.on([*sides, *local.sides[2:]])


def _touching(local: Local, number: int, locus: Locus) -> int | Meeting | None:
    """What sheets that touch make of a node: one of them, or two that continue each other."""
    found = None if locus.kind == "leaf" else sheets(local, number)
    return None if found is None else touching(local, found)


def _joined(local: Local, number: int, extent: float) -> BoxFinding:
    """Two arcs on the grown box: they meet in one point there, or do not meet at all."""
    grown = _grown(local)
    locus = locus_of(grown, number)
    if locus.kind == "none":
        return EMPTY
    found: Generators | None = generators(grown, locus.nodes[0]) if locus.kind == "leaf" else None
    if found is not None and found.analytic:
        return OPEN
    arcs = meeting(grown, locus, found)
    if arcs is not None and arcs.continuous and are_empty(grown, arcs):
        return EMPTY
    if arcs is not None and not arcs.continuous:
        kind = emptiness(local, grown, arcs)
        if kind is not None:
            return BoxFinding(kind, locus=Locus("double", (arcs.arcs[0].side,)))
        end = broken(local, grown, arcs)
        if end is not None:
            return BoxFinding("broken", joint=end, locus=locus)
    if arcs is None or not is_transversal(grown, arcs):
        alone = _touching(grown, number, locus)
        if isinstance(alone, int):
            return _regular(local, Locus("leaf", (alone,)), math.inf, extent)
        arcs = alone
    if arcs is None or not is_transversal(grown, arcs):
        return BoxFinding("open", locus=locus)
    bounds = [curvature_bound(grown, arc.function) for arc in arcs.arcs]
    zero = locate(grown, arcs.arcs[0])
    on_axis = local.model.body and grown.sides[1].contains(0)  # where a cone has no bound
    if zero is None or (None in bounds and not (on_axis and zero.exists)):
        return BoxFinding("open", locus=locus)
    bound = max((math.inf, 0.0) if bound is None else bound for bound in bounds)
    place, within = None, None
    if zero.exists and zero.box and all(a.overlaps(b) for a, b in zip(zero.box, local.sides, strict=False)):
        place = located(grown, arcs, zero)
        within = is_within(place, (arcs.arcs[0].function, arcs.arcs[0].side))
    if place is None or within is False:  # what meets outside a neighbour will find, if it is within the bounds
        return BoxFinding("regular", math.inf, *bound, locus=locus) if arcs.continuous else OPEN
    found_joint = joint(grown, arcs, place)
    if found_joint is None or (within is None and len(local.sides) > 2):
        return BoxFinding("open", locus=locus)
    if within is None:
        doubt = f"{found_joint.reason}; whether within the bounds or beside them is not decided"
        found_joint = replace(found_joint, proved=False, reason=doubt)
    return BoxFinding("joined", arcs.contact, *bound, found_joint, locus)


def _double(local: Local, locus: Locus) -> BoxFinding:
    """A zero without a change of sign is proved where the inner node changes sign on the box."""
    return BoxFinding("double" if changes_sign(local, locus.nodes[0]) else "open", locus=locus)


# Curvatures on a box: of the level lines in the plane, of a body of revolution both principal ones.
def curvatures(local: Local, number: int) -> list[arb]:
    """Balls around the curvatures of the boundary described by a node; the whole line where there is no bound."""
    along = local.value(local.model.curvature(number))
    whole = arb(0, math.inf)
    return [whole if along is None else along, *([_across(local, number)] if local.model.body else [])]


def _across(local: Local, number: int) -> arb:
    """The curvature of the circle of latitude, -F_r/(r |grad F|).

    Where F is even in r and analytic down to the axis, F_r/r is F_rr at some radius in between.
    """
    model, radius = local.model, local.sides[1]
    gradient = model.gradient(number)
    slopes = [arb(0, math.inf) if ball is None else ball for ball in map(local.value, gradient)]
    ratio = slopes[1] / radius
    if _is_even(local, number):
        inner = model.on([local.sides[0], radius.union(-radius), *local.sides[2:]])
        second = inner.value(model.gradient(gradient[1])[1])
        if second is not None and second.is_finite() and generators(inner, number).analytic:
            ratio = second.intersection(ratio) if ratio.is_finite() and ratio.overlaps(second) else second
    return -ratio / hypotenuse(*slopes)


def _is_even(local: Local, number: int) -> bool:
    """Whether a node contains the radius through even powers alone."""
    builder = local.model.builder
    radius = builder.input(builder.coordinates[1])
    return all(
        (operation == "mul" and arguments == (radius, radius)) or (operation == "powi" and int(str(data)) % 2 == 0)
        for operation, arguments, data in (builder.nodes[part] for part in local.model.order(number))
        if radius in arguments
    )
