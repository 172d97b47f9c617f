"""Curvatures on a box: of the level lines in the plane, of a body of revolution both principal ones."""

from __future__ import annotations

import math

from rsym.bounds.balls import arb, hypotenuse
from rsym.verify.generators import generators
from rsym.verify.local import Local


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
