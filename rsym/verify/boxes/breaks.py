"""Breaks: points of a switch at which a boundary ends, or has a point of its own, because omega jumps there.

Let omega be F+ where u > 0, F- where u < 0 and T where u = 0, all four analytic on a box. Let p be the only common
zero of F+ and u in it, and the gradients of F+ and u nowhere parallel: one arc of {F+ = 0, u > 0} ends in p.
- If T(p) is not 0, p is no point of the boundary, though the arc leads to it.
- If F-(p) is not 0, and T is F+ or F- where u = 0 or has no zeros but simple ones there, then no other arc leaves p.
Either way the boundary is no curve at p: it ends. So it is with F- and F+ exchanged. And if p is a simple common zero
of T and u at which neither F+ nor F- is 0, it is a point of the boundary with no other one near it.

If u divides T, omega is zero wherever u is; where F+ and F- have the same sign, it is so on both sides.
"""

from __future__ import annotations

from itertools import product

from rsym.bounds.balls import arb, ctx, hypotenuse
from rsym.verify.answers.report import Joint
from rsym.verify.boxes.borders import is_within
from rsym.verify.boxes.generators import generators
from rsym.verify.boxes.joints import PRECISE, BoundaryArc, Meeting, crosses, locate
from rsym.verify.boxes.krawczyk import Point
from rsym.verify.boxes.local import Local
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


def broken(local: Local, around: Local, meeting: Meeting) -> Joint | None:
    """A point of the box at which the boundary is proved to be no curve, because omega is not continuous there.

    Parameters
    ----------
    local, around : Local
        The box, and a little more of what surrounds it, in which the functions are examined.
    meeting : Meeting
        Of the two sides of a switch.
    """
    first, second = meeting.arcs
    thin = meeting.thin
    single = thin is None or _is_simple(around, thin)
    for own, other in ((first, second), (second, first)):
        at = _end(local, around, own)
        if at is None:
            continue
        if thin is not None and at.nonzero(thin.function):
            return _joint(at, "end", "an arc leads here, but omega is not zero at the point itself")
        if single and _is_known(around, other) and at.nonzero(other.function):
            return _joint(at, "end", "one arc leads here, and omega jumps over zero")
    if thin is None or not (_is_known(around, first) and _is_known(around, second)):
        return None
    at = _end(local, around, thin)
    if at is not None and at.nonzero(first.function) and at.nonzero(second.function):
        return _joint(at, "isolated point", "omega is zero here, but jumps away from zero on both sides")
    return None


def _is_known(local: Local, arc: BoundaryArc) -> bool:
    return generators(local, arc.function).analytic


def _is_simple(local: Local, arc: BoundaryArc) -> bool:
    """Whether the function of an arc has no zeros on those of its side but simple ones."""
    return _is_known(local, arc) and _is_known(local, BoundaryArc(arc.side, arc.side)) and crosses(local, arc)


def _end(local: Local, around: Local, arc: BoundaryArc) -> Local | None:
    """The only common zero of a function and its side around a box, if it is proved and lies in the box."""
    if not _is_simple(around, arc):
        return None
    zero = locate(around, arc)
    if zero is None or zero.box is None or not zero.exists:
        return None
    if not all(a.overlaps(b) for a, b in zip(zero.box, local.sides, strict=False)):
        return None
    model, rest = local.model, local.sides[2:]
    with ctx.workprec(PRECISE):
        found = locate(model.on([*zero.box, *rest]), arc, precise=True)
        if found is None or found.box is None:
            return None
        at = model.on([*found.box, *rest])
        # On the axis of a body the other side of the meridian is an image of this one.
        on_axis = model.body and not at.sides[1] != 0
        return at if not on_axis and is_within(at, (arc.function, arc.side)) else None


def _joint(at: Local, kind: str, reason: str) -> Joint:
    point: Point = (at.sides[0], at.sides[1])
    place = float(point[0].mid()), float(point[1].mid())
    radius = float(hypotenuse(point[0] - point[0].mid(), point[1] - point[1].mid()).upper())
    radius += 1e-15 * (abs(place[0]) + abs(place[1]))
    branches = 0 if kind == "isolated point" else 1
    return Joint(place, radius, kind, "broken", branches=branches, proved=True, reason=reason)
