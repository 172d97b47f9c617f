"""Singular points of a curve: what subdivision could not settle, gathered into points, located and classified.

A point is proved by its Newton polygon, by one-sided derivatives in all directions, or by the curvatures of what meets
in it; what none of them decides is described by one-sided limits and called so.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from itertools import islice

import mpmath as mp
import sympy as sp

from rsym.bounds.balls import arb, ctx
from rsym.sampling.progress import Effort
from rsym.verify.answers.report import Joint
from rsym.verify.boxes.local import PRECISE, Box, Model
from rsym.verify.boxes.locus import Locus
from rsym.verify.boxes.polynomials import polynomial_of
from rsym.verify.boxes.root_classes import GROWS, curvature_jump
from rsym.verify.boxes.vanishing import exact_at
from rsym.verify.boxes.vectors import error, floats, radius_of
from rsym.verify.points.candidates import systems_in_plane
from rsym.verify.points.clusters import Cluster, clusters
from rsym.verify.points.directions import classify_by_directions
from rsym.verify.points.locating import LOCATED, ZeroPlace, at_fractions, away, located, vanishes_at
from rsym.verify.points.newton_polygon import classify_polynomial
from rsym.verify.points.probing import Sample, classify
from rsym.verify.points.tangencies import classify_tangency

CROWD = 400  # boxes: points that resist leave one to thirty
MOST_PLACES = 6  # guesses of what vanishes at a point, tried until one of them proves something
MOST_PROBED = 8  # points classified by one-sided limits, which takes a second each
LEAST = 1e-20  # of a value that may be zero at a point that was found
ROUND = 64  # the largest denominator of a point that is guessed where no equations find it
DIGITS = 40  # of the limits; the field is evaluated to twice as many


def classify_joints(
    model: Model,
    left: Sequence[tuple[Box, Locus]],
    extent: float,
    effort: Effort | None = None,
    settles: Callable[[Cluster], bool] = lambda cluster: False,
) -> list[Joint]:
    """One joint for each cluster of boxes that are left over; none if there are too many to be points.

    Of a cluster of which no point is proved `settles` is asked: it may hold none, but a part smaller than its boxes.
    When time is over the others are not looked at: of these nothing is said.
    """
    if len(left) > CROWD:
        return []
    loci = {box[:2]: locus for box, locus in left}
    joints = []
    for number, cluster in enumerate(clusters(list(loci), 2, effort or Effort())):
        probe = number < MOST_PROBED
        proved, near = _proved(model, cluster, loci)
        if proved is not None:
            joints.append(proved)
        elif len(model.axes) > 2 or not (probe and settles(cluster)):
            joints.append(_unproved(model, cluster, near, extent, probe=probe))
    return joints


def _proved(
    model: Model, cluster: Cluster, loci: Mapping[Box, Locus]
) -> tuple[Joint, ZeroPlace] | tuple[None, ZeroPlace | None]:
    """What a cluster is by the first place that proves something, and that place, or the first one."""
    near = None
    if len(model.axes) > 2:
        return None, None
    for place in islice(_places(model, cluster, loci), MOST_PLACES):
        locus = next((loci[box] for box in cluster.boxes if _holds(box, place)), None)
        if locus is None:
            continue  # what vanishes there is not what is left over here
        near = place if near is None else near
        proved = _polygon(model, locus, place) or _directed(model, place) or _of_leaves(model, locus, place)
        if proved is not None:
            return proved, place
    return None, near


def _unproved(model: Model, cluster: Cluster, near: ZeroPlace | None, extent: float, *, probe: bool) -> Joint:
    """What a cluster may be, by one-sided limits."""
    unresolved = Joint(cluster.centre, cluster.radius, "unresolved", "unknown", reason="nothing is proved here")
    if near is None:
        return unresolved
    if not probe:
        return replace(unresolved, point=(float(near.point[0]), float(near.point[1])))
    return _probed(model, near, extent)


def _places(model: Model, cluster: Cluster, loci: Mapping[Box, Locus]) -> Iterator[ZeroPlace]:
    """Where equations that the boxes suggest have a zero, then the point with small fractions next to the middle."""
    for box in cluster.boxes:
        yield from located(model, systems_in_plane(model, box, loci[box]), cluster.centre, 4 * cluster.radius, LEAST)
        with ctx.workprec(LOCATED):
            place = at_fractions(model, [Fraction(value).limit_denominator(ROUND) for value in cluster.centre])
            found = away(place.point, cluster.centre) <= cluster.radius and vanishes_at(model, place.point, LEAST)
        if found:
            yield place


def _holds(box: Box, place: ZeroPlace) -> bool:
    """Whether the box certainly contains the place."""
    return all(low <= value and value <= high for value, (low, high) in zip(place.point, box, strict=True))


def _fractions(place: ZeroPlace) -> list[Fraction]:
    return [part for part in place.coordinates.values() if part is not None]


def _polygon(model: Model, locus: Locus, place: ZeroPlace) -> Joint | None:
    """By the Newton polygon of a polynomial leaf, at a rational point."""
    polynomial = polynomial_of(model, locus.nodes[0]) if place.exact and locus.kind == "leaf" else None
    if polynomial is None:
        return None
    symbols = tuple(sp.Symbol(name, real=True) for name in model.builder.coordinates)
    x, y = (sp.Rational(part.numerator, part.denominator) for part in _fractions(place))
    return classify_polynomial(polynomial, symbols, (x, y))


def _directed(model: Model, place: ZeroPlace) -> Joint | None:
    """By directions: at a rational point, or at the only common zero of a pair of analytic nodes in a small box."""
    if not place.proved:
        return None
    point = _fractions(place) if place.exact else place.point
    return classify_by_directions(model, (point[0], point[1]), place.zeros)


def _of_leaves(model: Model, locus: Locus, place: ZeroPlace) -> Joint | None:
    """Two leaves that touch, or one with a root of class 1, whose curvatures differ."""
    if not place.proved:
        return None
    known = exact_at(model, place.point, place.coordinates, place.zeros)
    with ctx.workprec(PRECISE):
        if locus.kind != "leaf":
            return classify_tangency(known, model.on(place.point))
        jump = curvature_jump(known, model.on(place.point), locus.nodes[0])
    if jump is None:
        return None
    x, y = floats(place.point)
    grows = not jump.is_finite()
    return Joint(
        (x, y),
        radius_of(place.point),
        "unbounded curvature" if grows else "curvature jump",
        "G1",
        tangent_jump=0.0,
        tangent_jump_error=0.0,
        curvature_jump=math.inf if grows else float(jump.mid()),
        curvature_jump_error=0.0 if grows else error(jump),
        proved=True,
        reason=f"the curvature{GROWS if grows else 's along the tangent and its opposite differ'}",
    )


def _probed(model: Model, place: ZeroPlace, extent: float) -> Joint:
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
        centre = (_mpf(place.point[0]), _mpf(place.point[1]))
        return classify(
            field, centre, 0.0, digits=DIGITS, value=lambda x, y: numbers(x, y, (root,))[0], reach=extent / 400
        )


def _mpf(value: arb | None) -> mp.mpf:
    """The middle of a ball, NaN where there is none or it says nothing."""
    if value is None or not value.is_finite():
        return mp.nan
    mantissa, exponent = value.mid().man_exp()
    return mp.ldexp(mp.mpf(int(mantissa)), int(exponent))
