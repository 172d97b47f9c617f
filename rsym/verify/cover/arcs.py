"""Arcs of a boundary in the plane on one box, with a bound of their curvature."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from rsym.bounds.balls import arb, ctx, hypotenuse
from rsym.verify.answers.report import Joint
from rsym.verify.boxes.borders import is_within
from rsym.verify.boxes.breaks import Break
from rsym.verify.boxes.domains import is_defined
from rsym.verify.boxes.edges import edge, has_edges
from rsym.verify.boxes.generators import generators, square_roots
from rsym.verify.boxes.joints import Meeting, joint
from rsym.verify.boxes.krawczyk import common_zero, narrowed_zero
from rsym.verify.boxes.local import PRECISE, Local
from rsym.verify.boxes.locus import Locus
from rsym.verify.boxes.vanishing import vanishes_with
from rsym.verify.boxes.vectors import floats, radius_of
from rsym.verify.cover.inspection import EMPTY, OPEN, Inspection, Inspector

FINE = 1 / 4096  # of the extent: on smaller boxes an arc may be regular though its curvature has no bound there


@dataclass(frozen=True)
class ArcInspector(Inspector):
    """Looks for one arc, or two that meet in a joint; `extent` is the size of the whole.

    Where not `bounded`, one arc need not have a bound of its curvature: the box is divided in any case.
    """

    extent: float
    bounded: bool = True

    def regular(self, local: Local, locus: Locus, nodes: tuple[int, ...], order: float) -> Inspection:
        """A regular arc where one component of the gradient excludes zero, by the implicit function theorem."""
        slopes = [local.gradient(node) for node in nodes]
        if len(nodes) == 1 and _centred_excludes_zero(local, nodes[0], slopes[0]):
            return EMPTY
        columns = list(zip(*slopes, strict=True))
        if not any(all(slope > 0 for slope in column) or all(slope < 0 for slope in column) for column in columns):
            return Inspection("open", locus=locus)
        if not self.bounded and not has_edges(local, local.model.root):
            return Inspection("regular", nodes, order, locus)
        bounds = [curvature_bound(local, node) for node in nodes]
        if None in bounds and not (order < math.inf and self._is_small(local)):
            return Inspection("open", locus=locus)
        # Derivatives of |u|**a with a fractional a have no enclosure at 0.
        bound = max((math.inf, 0.0) if bound is None else bound for bound in bounds)
        return Inspection("regular", nodes, order, locus, curvature=bound[0], slack=bound[1])

    def _is_small(self, local: Local) -> bool:
        return all(float(arb(side.rad())) < self.extent * FINE for side in local.sides[:2])

    def meeting(self, local: Local, around: Local, pair: Meeting, locus: Locus) -> Inspection:
        """Two arcs on the grown box: they meet in one point there, or do not meet at all."""
        bounds = [curvature_bound(around, arc.function) for arc in pair.arcs]
        zero = common_zero(around, pair.arcs[0].ends)
        on_axis = local.model.body and around.sides[1].contains(0)  # where a cone has no bound
        if zero is None or (None in bounds and not (on_axis and zero.exists)):
            return Inspection("open", locus=locus)
        curvature, slack = max((math.inf, 0.0) if bound is None else bound for bound in bounds)
        place, within = None, None
        if zero.meets(local):
            place = narrowed_zero(around, pair.arcs[0].ends, zero)
            within = is_within(place, pair.arcs[0].ends)
        if place is None or within is False:  # what meets outside a neighbour will find, if it is within the bounds
            return Inspection("regular", locus=locus, curvature=curvature, slack=slack) if pair.continuous else OPEN
        found = joint(around, pair, place)
        if found is None or (within is None and len(local.sides) > 2):
            return Inspection("open", locus=locus)
        if within is None:
            doubt = f"{found.reason}; whether within the bounds or beside them is not decided"
            found = replace(found, proved=False, reason=doubt)
        return Inspection("joined", (), pair.contact, locus, pair, found, curvature=curvature, slack=slack)

    def broken(self, found: Break) -> Joint:
        """A point at which the boundary is no curve."""
        place = found.at.sides[:2]
        branches = 0 if found.kind == "isolated point" else 1
        where, radius = floats(place), radius_of(place)
        return Joint(where, radius, found.kind, "broken", branches=branches, proved=True, reason=found.reason)

    def further(self, local: Local, number: int, finding: Inspection) -> Inspection:
        """A factor that is zero in one point only, or the edge of a root."""
        if finding.locus.kind == "product":
            finding = self._product(local, finding.locus)
        if finding.kind != "open" or not has_edges(local, number):
            return finding
        found = edge(local, local.grown(), number)
        if found is None:
            return finding
        return Inspection(found.kind, place=found.joint, curvature=found.curvature, slack=found.slack)

    def _product(self, local: Local, locus: Locus) -> Inspection:
        """A factor that is zero in one point only, a sum of squares, where the other factor is zero too, drops."""
        for factor, other in (locus.nodes, locus.nodes[::-1]):
            roots = tuple(square_roots(local.model.builder, factor)[:2])
            if len(roots) < 2 or not all(generators(local, root).analytic for root in roots):
                continue
            around = local.grown()
            zero = common_zero(around, roots)
            if zero is None or not is_defined(local, factor):
                continue
            if not zero.exists:
                return self.inspect(local, other)
            with ctx.workprec(PRECISE):
                if vanishes_with(narrowed_zero(around, roots, zero), roots, other):
                    return self.inspect(local, other)
        return Inspection("open", locus=locus)


def _centred_excludes_zero(local: Local, leaf: int, slopes: list[arb]) -> bool:
    """Whether the mean value form f(m) + grad f (B - m) excludes zero."""
    middle = [side.mid() for side in local.sides[:2]]
    value = local.model.on([*middle, *local.sides[2:]]).ball(leaf)
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
    slopes = local.balls(gradient)
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
