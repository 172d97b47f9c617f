"""Breaks in space: points of a switch at which a boundary ends, because omega jumps there.

As in the plane (`breaks`) omega is F+ where u > 0, F- where u < 0 and T where u = 0. Where the gradients
of F+ and u are independent, {F+ = 0, u > 0} is a sheet that ends in the curve F+ = u = 0. A point p of that curve is
proved by Krawczyk's operator in the two coordinates across it, the third one fixed.
- If T(p) is not 0, the sheet leads to p, but p is no point of the boundary.
- If F-(p) is not 0, and T is F+ or F- where u = 0 or has independent gradients with u there, no other sheet leaves p.
If p is such a common zero of T and u, at which F+ and F- have one sign, omega is zero at p and not around it but on
u = 0.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from rsym.bounds.balls import arb, ctx
from rsym.verify.answers.singular import SingularPoint
from rsym.verify.boxes.borders import is_within
from rsym.verify.boxes.generators import generators
from rsym.verify.boxes.joints import BoundaryArc, Meeting
from rsym.verify.boxes.krawczyk import refined, unique_zero
from rsym.verify.boxes.local import Local
from rsym.verify.points.corners import PRECISE, floats, radius_of


def broken(local: Local, sheets: Meeting) -> SingularPoint | None:
    """A point of a box at which the boundary is proved to be no surface, because omega is not continuous there."""
    first, second = sheets.arcs
    thin = sheets.thin
    single = thin is None or is_crossed(local, thin)
    for own, other in ((first, second), (second, first)):
        at = _end(local, own)
        if at is None:
            continue
        if thin is not None and at.nonzero(thin.function):
            return _point(at, "end", "a sheet leads here, but omega is not zero at the point itself")
        if single and generators(local, other.function).analytic and at.nonzero(other.function):
            return _point(at, "end", "one sheet leads here, and omega jumps over zero")
    if thin is None or not all(generators(local, arc.function).analytic for arc in sheets.arcs):
        return None
    at = _end(local, thin)
    if at is not None and at.sign(first.function) * at.sign(second.function) > 0:
        return _point(at, "no sign change", "omega is zero here, but jumps to one sign on both sides")
    return None


def is_crossed(local: Local, arc: BoundaryArc) -> bool:
    """Whether a function and its side are analytic, and their gradients independent, all over the box."""
    return _along(local, arc) is not None


def _along(local: Local, arc: BoundaryArc) -> int | None:
    """A coordinate that grows or falls all along the curve in which a function and its side vanish."""
    if not (generators(local, arc.function).analytic and generators(local, arc.side).analytic):
        return None
    p, q = local.gradient(arc.function), local.gradient(arc.side)
    cross = [p[i] * q[j] - p[j] * q[i] for i, j in ((1, 2), (2, 0), (0, 1))]
    steepness, axis = max((float(abs(part).lower()), -k) for k, part in enumerate(cross))
    return -axis if steepness > 0 else None


def _end(local: Local, arc: BoundaryArc) -> Local | None:
    """A point within the bounds at which a function and its side vanish, in a narrow box; None if none is proved."""
    axis = _along(local, arc)
    if axis is None:
        return None
    model, others = local.model, [k for k in range(3) if k != axis]

    def spread(point: Sequence[arb]) -> Local:
        sides = list(local.sides)
        sides[axis] = local.sides[axis].mid()
        for k, side in zip(others, point, strict=True):
            sides[k] = side
        return model.on(sides)

    def values(point: Sequence[arb]) -> list[arb]:
        found = (spread(point).value(number) for number in (arc.function, arc.side))
        return [arb(0, math.inf) if value is None else value for value in found]

    def jacobian(point: Sequence[arb]) -> list[list[arb]]:
        at = spread(point)
        return [[at.gradient(number)[k] for k in others] for number in (arc.function, arc.side)]

    zero = unique_zero(values, jacobian, tuple(local.sides[k] for k in others))
    if zero is None or zero.box is None or not zero.exists:
        return None
    with ctx.workprec(PRECISE):
        at = spread(refined(values, jacobian, zero.box))
        return at if is_within(at) else None


def _point(at: Local, kind: str, reason: str) -> SingularPoint:
    place = at.sides[:3]
    return SingularPoint(floats(place), radius_of(place), kind, "broken", proved=True, reason=reason)
