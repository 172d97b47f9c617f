"""Breaks: points of a switch at which a boundary ends, or has a point of its own, because omega jumps there.

Let omega be F+ where u > 0, F- where u < 0 and T where u = 0, all four analytic on a box, the gradients of F+ and u
nowhere parallel, and p a common zero of both: {F+ = 0, u > 0} is an arc that ends in p, or a sheet that ends in a curve
through p.
- If T(p) is not 0, p is no point of the boundary, though the arc or sheet leads to it.
- If F-(p) is not 0, and T is F+ or F- where u = 0 or its gradient is nowhere parallel to that of u there, no other one
  leaves p.
Either way the boundary is no curve or surface at p: it ends. So it is with F- and F+ exchanged. And if p is such a
common zero of T and u, at which F+ and F- are not 0, it is a point of the boundary that no arc or sheet leads to: in
the plane alone in its surroundings; in space, if F+ and F- have one sign, omega is zero without changing its sign.

In the plane p is the only common zero in the box, by Krawczyk's operator; in space one on a line across the box, with
the coordinate that grows along the curve fixed.

If u divides T, omega is zero wherever u is; where F+ and F- have the same sign, it is so on both sides.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

from rsym.bounds.balls import arb, ctx
from rsym.verify.boxes.borders import is_within
from rsym.verify.boxes.generators import generators
from rsym.verify.boxes.joints import BoundaryArc, Meeting, is_crossed, steepest
from rsym.verify.boxes.krawczyk import common_zero, narrowed_zero, refined, unique_zero
from rsym.verify.boxes.local import PRECISE, Local
from rsym.verify.boxes.polynomials import multiplicity

NARROW = 256  # of the extent: what share of it a box is that is not divided in search of a switch that may be zero


def are_empty(around: Local, meeting: Meeting) -> bool:
    """Whether all functions that omega is around a box have one sign: a choice of numbers alone may hide it."""
    thin = () if meeting.thin is None else (meeting.thin,)
    signs = {around.sign(arc.function) for arc in (*meeting.arcs, *thin)}
    return signs in ({1}, {-1})


def emptiness(local: Local, around: Local, meeting: Meeting) -> str | None:
    """What a box is that no sheet of the boundary meets; None where that is open.

    "empty": all functions that omega is around it have one sign; "leap": each has a sign, and omega jumps from one to
    the other in the box, or may do so in one so narrow that nothing is lost by giving it up; "double": omega is zero
    where the side of a meeting is, at a point of the box at least, and of one sign around.
    """
    thin = meeting.thin
    signs = [around.sign(arc.function) for arc in meeting.arcs]
    signs += [] if thin is None else [around.sign(thin.function)]
    if are_empty(around, meeting):
        return "empty"
    if 0 not in signs:
        return "leap" if _is_narrow(local) or changes_sign(local, meeting.arcs[0].side) else None
    if thin is None or signs[0] != signs[1] or not multiplicity(local.model, thin.function, thin.side):
        return None
    return "double" if signs[0] and changes_sign(local, thin.side) else None


def _is_narrow(local: Local) -> bool:
    bounds = (local.model.bounds or ())[: local.model.dimension]
    widest = max((high - low for low, high in bounds), default=0.0)
    return all(2 * float(arb(side.rad())) < widest / NARROW for side in local.sides[: local.model.dimension])


def changes_sign(local: Local, number: int) -> bool:
    """Whether a node is continuous on a box and has both signs at its corners, so that it is zero in between."""
    size = local.model.dimension
    corners = product(*((side.lower(), side.upper()) for side in local.sides[:size]))
    found = {local.model.on([*corner, *local.sides[size:]]).sign(number) for corner in corners}
    return {1, -1} <= found and generators(local, number).analytic


@dataclass(frozen=True)
class Break:
    """A place at which a boundary is proved to be no curve or surface, known to lie in the box of `at`, and why."""

    at: Local
    kind: str
    reason: str


def find_break(local: Local, around: Local, meeting: Meeting) -> Break | None:
    """A point of a box at which the boundary is proved to be no curve or surface, because omega jumps there.

    Parameters
    ----------
    local, around : Local
        The box, and a little more of what surrounds it, in which the functions are examined.
    meeting : Meeting
        Of the two sides of a switch.
    """
    first, second = meeting.arcs
    thin, plane = meeting.thin, local.model.dimension == 2
    end, one, the = (_end, "an arc", "one arc") if plane else (_end_of_sheet, "a sheet", "one sheet")
    single = thin is None or is_crossed(around, thin)
    for own, other in ((first, second), (second, first)):
        at = end(local, around, own)
        if at is None:
            continue
        if thin is not None and at.nonzero(thin.function):
            return Break(at, "end", f"{one} leads here, but omega is not zero at the point itself")
        if single and generators(around, other.function).analytic and at.nonzero(other.function):
            return Break(at, "end", f"{the} leads here, and omega jumps over zero")
    if thin is None or not all(generators(around, arc.function).analytic for arc in meeting.arcs):
        return None
    at = end(local, around, thin)
    signs = 0 if at is None else at.sign(first.function) * at.sign(second.function)
    if at is not None and plane and signs:
        return Break(at, "isolated point", "omega is zero here, but jumps away from zero on both sides")
    if at is not None and signs > 0:
        return Break(at, "no sign change", "omega is zero here, but jumps to one sign on both sides")
    return None


def _end(local: Local, around: Local, arc: BoundaryArc) -> Local | None:
    """The only common zero of a function and its side around a box, if it is proved and lies in the box."""
    zero = common_zero(around, arc.ends) if is_crossed(around, arc) else None
    if zero is None or not zero.meets(local):
        return None
    at = narrowed_zero(around, arc.ends, zero)
    with ctx.workprec(PRECISE):
        # On the axis of a body the other side of the meridian is an image of this one.
        on_axis = local.model.body and not at.sides[1] != 0
        return at if not on_axis and is_within(at, arc.ends) else None


def _end_of_sheet(local: Local, around: Local, arc: BoundaryArc) -> Local | None:
    """A point in or beside a box, within the bounds, at which a function and its side vanish, if one is proved."""
    axis = steepest(around, arc) if is_crossed(around, arc) else None
    if axis is None:
        return None
    model, others = around.model, [k for k in range(3) if k != axis]

    def spread(point: Sequence[arb]) -> Local:
        sides = list(around.sides)
        sides[axis] = around.sides[axis].mid()
        for k, side in zip(others, point, strict=True):
            sides[k] = side
        return model.on(sides)

    def values(point: Sequence[arb]) -> list[arb]:
        return spread(point).balls(arc.ends)

    def jacobian(point: Sequence[arb]) -> list[list[arb]]:
        at = spread(point)
        return [[at.gradient(number)[k] for k in others] for number in arc.ends]

    zero = unique_zero(values, jacobian, tuple(around.sides[k] for k in others))
    if zero is None or not zero.exists:
        return None
    with ctx.workprec(PRECISE):
        at = spread(refined(values, jacobian, zero.box))
        return at if is_within(at) else None
