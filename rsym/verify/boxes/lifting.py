"""Lifting: a leaf with a root as a function of the root too, and the arc that its zeros are up to the end of the root.

Let t = sqrt(u), u analytic with values of both signs, and let every leaf be G(x, y, t) with G analytic on B x T, B a
box and T all values of t on it. The zeros of G are then the projection of the curve M = {G = 0, t**2 = u, t >= 0},
whose tangent is grad G x grad(u - t**2) = W = (P, Q, R):

    P = 2 t G_y + G_t u_y,   Q = -(2 t G_x + G_t u_x),   R = G_y u_x - G_x u_y.

Where (P, Q) is not 0 the projection is a regular arc with the inside on its left, analytic up to its end; where R
is not 0 on B x T, t is strictly monotone along M, and M ends where t = 0, at the common zero p of G and u, if there is
one. With L = P d/dx + Q d/dy + R d/dt the curvature is (P LQ - Q LP)/|(P, Q)|**3.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from rsym.bounds.balls import arb, hypotenuse
from rsym.logic.stripping import bare
from rsym.program.differentiation import derivative
from rsym.verify.boxes.joints import ArcJet
from rsym.verify.boxes.local import Local, Model
from rsym.verify.boxes.polynomials import same_zeros
from rsym.verify.boxes.resolution import put

ROOT = "the root at an edge"  # no letter of a user has a space in its name


@dataclass(frozen=True)
class Lifted:
    """A leaf as a function of the root too: `function`, `flat` where the root is 0, and the nodes P, Q, R, G_t."""

    function: int
    flat: int
    tangent: tuple[int, int, int]
    slope: int
    curvature: int
    change: int


def lifted(model: Model, leaf: int, part: int, radicand: int) -> Lifted:
    """A leaf as a function of the coordinates and of the root `part`, and the nodes of its arc."""
    b = model.builder
    own, zero = b.input(ROOT), b.const(0)
    function = put(model, leaf, {part: own})
    gx, gy = model.gradient(function)
    ux, uy = model.gradient(radicand)
    gt, twice = derivative(b, function, ROOT), b.mul(b.const(2), own)
    p = b.add(b.mul(twice, gy), b.mul(gt, uy))
    q = b.neg(b.add(b.mul(twice, gx), b.mul(gt, ux)))
    r = b.sub(b.mul(gy, ux), b.mul(gx, uy))

    def along(number: int) -> int:
        nx, ny = model.gradient(number)
        return b.add(b.add(b.mul(nx, p), b.mul(ny, q)), b.mul(derivative(b, number, ROOT), r))

    size = b.sqrt(b.add(b.square(p), b.square(q)))
    curvature = b.div(b.sub(b.mul(p, along(q)), b.mul(q, along(p))), b.powi(size, 3))
    return Lifted(function, put(model, leaf, {part: zero}), (p, q, r), gt, curvature, b.div(along(curvature), size))


def with_root(local: Local, values: arb) -> Local:
    """The box with values of the root."""
    result = Local(local.model, local.sides)
    result.inputs[ROOT] = values
    return result


def is_regular(above: Local, arc: Lifted) -> bool:
    """Whether the arc has a tangent everywhere on the box."""
    return any(above.nonzero(node) for node in arc.tangent[:2])


def bound_of(above: Local, arcs: Sequence[Lifted]) -> tuple[float, float]:
    """(bound, slack) of the size of the curvatures of some arcs."""
    found = [above.value(arc.curvature) for arc in arcs]
    if any(value is None or not value.is_finite() for value in found):
        return math.inf, 0.0
    balls = [value for value in found if value is not None]
    largest = max(balls, key=lambda value: float(abs(value).upper()))
    radius, middle = float(arb(largest.rad())), abs(float(largest.mid()))
    return float(abs(largest).upper()), radius / (radius + middle or 1)


def across_of(above: Local, first: Lifted, second: Lifted) -> arb:
    """Grad G_1 . W_2 from enclosures of its entries alone: if it is not 0, no matrix of such is singular."""
    builder = above.model.builder
    slopes = (*above.gradient(first.function), above.ball(derivative(builder, first.function, ROOT)))
    return sum((a * b for a, b in zip(slopes, _tangent(above, second), strict=True)), arb(0))


def _tangent(above: Local, arc: Lifted) -> tuple[arb, arb, arb]:
    p, q, r = above.balls(arc.tangent)
    return p, q, r


def finite(value: arb | None) -> arb:
    """The ball, the whole line where there is none."""
    return arb(0, math.inf) if value is None else value


def continues(model: Model, first: Lifted, second: Lifted) -> bool:
    """Whether one leaf is the other with the root taken negative, up to a sign."""
    b = model.builder
    own = b.input(ROOT)
    mirrored = put(model, second.function, {own: b.neg(own)})
    same = bare(b, mirrored) == bare(b, first.function)
    return same or same_zeros(model, mirrored, first.function, free=True)


def jet_of(at: Local, arc: Lifted, sign: int) -> ArcJet:
    """Tangent and curvature of an arc at a point, of its leaf times a sign."""
    p, q, _ = _tangent(at, arc)
    size = hypotenuse(p, q)
    curvature, change = (finite(at.value(node)) for node in (arc.curvature, arc.change))
    return ArcJet((sign * p / size, sign * q / size), sign * curvature, change)
