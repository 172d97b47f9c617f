"""Suspects: what subdivision could not settle, gathered into points, located and classified."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from itertools import chain, islice

import mpmath as mp
import sympy as sp

from rsym.bounds.balls import arb, ctx, exact
from rsym.sampling.progress import Effort
from rsym.verify.answers.report import Joint
from rsym.verify.boxes.generators import generators
from rsym.verify.boxes.krawczyk import common_zero
from rsym.verify.boxes.local import PRECISE, Box, Model
from rsym.verify.boxes.polynomials import polynomial_of
from rsym.verify.boxes.root_classes import curvature_jump
from rsym.verify.boxes.vanishing import SIMPLE, Exact, as_fraction
from rsym.verify.cover.covering import Covering
from rsym.verify.cover.inspection import Inspection
from rsym.verify.points.directions import AROUND, classify_by_directions
from rsym.verify.points.locating import LOCATED, Place, places
from rsym.verify.points.newton_polygon import classify_polynomial
from rsym.verify.points.probing import Sample, classify
from rsym.verify.points.tangencies import classify_tangency

CROWD = 400  # boxes: points that resist leave one to thirty
MOST_PLACES = 6  # guesses of what vanishes at a point, tried until one of them proves something
PINNED = 2.0**-90  # half the width of the box in which a pair of nodes must have just one zero
MOST_PROBED = 8  # points classified by one-sided limits, which takes a second each
DIGITS = 40  # of the limits; the field is evaluated to twice as many


def classify_suspects(model: Model, found: Covering, extent: float, effort: Effort | None = None) -> list[Joint]:
    """One joint for each cluster of boxes that are left; none if there are too many to be points.

    When time is over the others are not looked at: of these nothing is said.
    """
    effort = effort or Effort()
    if len(found.left) > CROWD or effort.is_over:
        return []
    groups, joints = clusters(found.left), []
    for number, group in enumerate(groups):
        if effort.is_over:
            break
        effort.reach(number / len(groups))
        joints.append(_classified(model, group, extent, probe=number < MOST_PROBED))
    return joints


def clusters(boxes: Sequence[tuple[Box, Inspection]]) -> list[list[tuple[Box, Inspection]]]:
    """The boxes in groups of those that touch."""
    groups: list[list[tuple[Box, Inspection]]] = []
    for box in boxes:
        touching = [group for group in groups if any(_touch(box[0], other[0]) for other in group)]
        groups = [group for group in groups if not any(group is one for one in touching)]
        groups.append([box, *(other for group in touching for other in group)])
    return groups


def _touch(a: Box, b: Box) -> bool:
    return all(a[k][0] <= b[k][1] and b[k][0] <= a[k][1] for k in range(2))


def _classified(model: Model, group: Sequence[tuple[Box, Inspection]], extent: float, *, probe: bool) -> Joint:
    """What a cluster is: by its Newton polygon or by directions, which are proofs, else by one-sided limits."""
    boxes = [box for box, _ in group]
    centre = [math.fsum(box[k][0] + box[k][1] for box in boxes) / (2 * len(boxes)) for k in range(2)]
    radius = max(math.dist(centre, corner) for box in boxes for corner in zip(*box[:2], strict=True))
    unresolved = Joint((centre[0], centre[1]), radius, "unresolved", "unknown", reason="nothing is proved here")
    if len(boxes[0]) > 2:
        return unresolved
    found = chain.from_iterable(places(model, box, finding, centre, radius) for box, finding in group)
    point = None
    for place in islice(found, MOST_PLACES):
        finding = next((finding for box, finding in group if _holds(box, place.point)), None)
        if finding is None:
            continue  # what vanishes there is not what is left over here
        point = place.point if point is None else point
        proved = _polygon(model, finding, place.point) or _directed(model, place) or _at_rational(model, finding, place)
        if proved is not None:
            return proved
    if point is None:
        return unresolved
    return _probed(model, point, extent) if probe else replace(unresolved, point=(float(point[0]), float(point[1])))


def _holds(box: Box, point: tuple[arb, arb]) -> bool:
    """Whether the box certainly contains the point."""
    return all(low <= value and value <= high for value, (low, high) in zip(point, box, strict=False))


def _rational(point: tuple[arb, arb]) -> tuple[Fraction, Fraction] | None:
    """The simple fractions of a point that was snapped to them."""
    x, y = (as_fraction(value).limit_denominator(SIMPLE) for value in point)
    with ctx.workprec(2 * LOCATED):  # a third is a ball too, narrower than that of the point
        return (x, y) if point[0].contains(exact(x)) and point[1].contains(exact(y)) else None


def _directed(model: Model, place: Place) -> Joint | None:
    """By directions: at a rational point, or at the only common zero of a pair of analytic nodes in a small box."""
    rational = _rational(place.point)
    if rational is not None:
        return classify_by_directions(model, rational, frozenset())
    if place.pair is None:
        return None
    with ctx.workprec(LOCATED):
        local = model.on([value + arb(0, PINNED) for value in place.point])
        if not all(generators(local, number).analytic for number in place.pair):
            return None
        zero = common_zero(local, place.pair)
    if zero is None or not zero.exists:
        return None
    return classify_by_directions(model, (zero.box[0], zero.box[1]), frozenset(place.pair))


def _at_rational(model: Model, finding: Inspection, place: Place) -> Joint | None:
    """At a rational point: two leaves that touch, or one with a root of class 1, whose curvatures differ."""
    rational = _rational(place.point)
    if rational is None:
        return None
    with ctx.workprec(PRECISE):
        balls = [exact(part) for part in rational]
        local = model.on([part + arb(0, AROUND) for part in balls])
        known = Exact(local, dict(zip(model.builder.coordinates, rational, strict=True)), frozenset())
        if finding.locus.kind != "leaf":
            return classify_tangency(known, model.on(balls))
        jump = curvature_jump(known, model.on(balls), finding.locus.nodes[0])
    if jump is None:
        return None
    return Joint(
        (float(rational[0]), float(rational[1])),
        1e-15 * sum(abs(float(part)) for part in rational),
        "curvature jump",
        "G1",
        tangent_jump=0.0,
        tangent_jump_error=0.0,
        curvature_jump=float(jump.mid()),
        curvature_jump_error=float(arb(jump.rad()).upper()) + 2.0**-52 * float(jump.upper()),
        proved=True,
        reason="the curvatures along the tangent and its opposite differ",
    )


def _polygon(model: Model, finding: Inspection, point: tuple[arb, arb]) -> Joint | None:
    fractions = _rational(point)
    if fractions is None or finding.locus.kind != "leaf":
        return None
    polynomial = polynomial_of(model, finding.locus.nodes[0])
    if polynomial is None:
        return None
    symbols = tuple(sp.Symbol(name, real=True) for name in model.builder.coordinates)
    return classify_polynomial(polynomial, symbols, tuple(sp.Rational(f.numerator, f.denominator) for f in fractions))


def _probed(model: Model, point: tuple[arb, arb], extent: float) -> Joint:
    """By limits along the branches, from samples of omega itself."""
    root = model.root
    first = model.gradient(root)
    (xx, xy), (_, yy) = (model.gradient(node) for node in first)
    third = (*model.gradient(xx), model.gradient(xy)[1], model.gradient(yy)[1])

    def numbers(x: mp.mpf, y: mp.mpf, nodes: Sequence[int]) -> list[mp.mpf]:
        with ctx.workprec(round(DIGITS * 6.7)):
            at = model.on([arb(x), arb(y)])
            return [_mpf(at.value(node)) for node in nodes]

    def field(x: mp.mpf, y: mp.mpf) -> Sample:
        value, gx, gy, hxx, hxy, hyy, *rest = numbers(x, y, (root, *first, xx, xy, yy, *third))
        return Sample(value, (gx, gy), (hxx, hxy, hyy), (rest[0], rest[1], rest[2], rest[3]))

    with mp.workdps(2 * DIGITS):
        centre = (_mpf(point[0]), _mpf(point[1]))
        return classify(
            field, centre, 0.0, digits=DIGITS, value=lambda x, y: numbers(x, y, (root,))[0], reach=extent / 400
        )


def _mpf(value: arb | None) -> mp.mpf:
    """The middle of a ball, NaN where there is none or it says nothing."""
    if value is None or not value.is_finite():
        return mp.nan
    mantissa, exponent = value.mid().man_exp()
    return mp.ldexp(mp.mpf(int(mantissa)), int(exponent))
