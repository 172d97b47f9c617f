"""What a boundary is at a point that is known exactly, proved in one of three ways.

By the arrangement of analytic sheets on small spheres, by second derivatives, or by the one-sided derivative of
omega along all rays.

The boundary at a tip is a graph over the plane across `upward` v. In each half plane that v bounds there is one
direction d = cos(t) v + sin(t) e in which H vanishes; the limit of the gradient along it is the normal there.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq, minimize

from rsym.bounds.balls import arb, ctx
from rsym.logic.kleene import ternary
from rsym.verify.answers.singular import SingularPoint
from rsym.verify.boxes.generators import generators
from rsym.verify.boxes.local import PRECISE, Local, Model
from rsym.verify.boxes.root_classes import GROWS, curvature_jump
from rsym.verify.boxes.sheets import Sheets, sheets
from rsym.verify.boxes.vectors import determinant, error, floats, radius_of, sign_of
from rsym.verify.points.candidates import across
from rsym.verify.points.contacts import Judgement, touching, touching_along, without_gradient
from rsym.verify.points.corners import describe, largest_angle, numbered, outward
from rsym.verify.points.cusps import KIND as CUSP
from rsym.verify.points.cusps import cusp
from rsym.verify.points.links import Link, link
from rsym.verify.points.locating import ZeroPlace
from rsym.verify.points.rays import FINE, FINEST, Rays, rays_at
from rsym.verify.points.zeros import Apparent, Known, known_at

Names: TypeAlias = Callable[[int], str]


def classify_place(
    model: Model, place: ZeroPlace, names: Names | None = None, *, apparent: int = 0
) -> SingularPoint | None:
    """What the boundary is at a point that is known exactly, proved; None where nothing is, or where it is regular.

    With `apparent`, what is zero to so many digits is taken for zero; then the result is not proved.
    """
    with ctx.workprec(PRECISE):
        known = known_at(model, place, apparent=apparent)
        found = sheets(known.local, model.root)
        if found is None or not all(generators(known.local, leaf).analytic for leaf in found.leaves):
            point = _of_root(place, known, found, names) or _of_rays(place, known, found, None, names, "cone tip")
        else:
            point = _of_sheets(place, known, found, names)
    if point is None or not apparent:
        return point
    away = max(point.radius, 10.0 ** (-apparent / 2))
    return replace(
        point, radius=away, proved=False, reason=f"if what vanishes to {apparent} digits is zero: {point.reason}"
    )


def _of_sheets(place: ZeroPlace, known: Known, found: Sheets, names: Names | None) -> SingularPoint | None:
    """One leaf without a gradient, two that touch, three or more through one point."""
    model, at, called = known.local.model, known.at, called_of(found, names)
    if not known.vanishes(*found.leaves):
        return None
    if len(found.leaves) == 1:
        (leaf,) = found.leaves
        judgement = None
        if known.vanishes(*model.gradient(leaf)):
            judgement = without_gradient(at, leaf, ternary(found.formula, {leaf: 1})) or cusp(known, at, leaf)
        if judgement is None:
            return None
        # Around a cusp the normals on both sides of its axis become opposite.
        return _point(place, judgement, called, arb(180 if judgement.kind == CUSP else math.nan))
    if len(found.leaves) == 2:
        f, g = found.leaves
        for k, slope in enumerate(at.gradient(f)):
            if not slope.contains(0) and known.vanishes(*across(model, f, g, k)):
                judgement = touching(at, f, g, numbered(found)) or touching_along(known, at, f, g, numbered(found))
                return None if judgement is None else _contact(place, judgement, called)
        return None
    arrangement = _arrangement(at, found)
    if arrangement is None or not arrangement[1]:
        return _of_rays(place, known, found, None if arrangement is None else arrangement[0], names, "corner")
    around = arrangement[0]
    if not around.edges:
        return None
    kind, continuity = ("corner", "G0") if around.is_disc else ("node", "broken")
    reason = describe(around, f"{len(found.leaves)} analytic sheets meet")
    return _point(place, Judgement(kind, continuity, reason), called, _jump(at, found, around))


def _contact(place: ZeroPlace, judgement: Judgement, called: tuple[str, ...]) -> SingularPoint:
    """The outward normals are opposite where the body or its outside is pinched."""
    turn = math.nan if judgement.kind != "tangency" else 180 if judgement.continuity == "broken" else 0
    return _point(place, judgement, called, arb(turn))


def _of_root(place: ZeroPlace, known: Known, found: Sheets | None, names: Names | None) -> SingularPoint | None:
    """One leaf of class 1, whose second derivatives differ along opposite tangents."""
    if found is None or len(found.leaves) != 1:
        return None
    jump = curvature_jump(known, known.at, found.leaves[0])
    if jump is None:
        return None
    if not jump.is_finite():
        growing = Judgement("unbounded curvature", "G1", f"the curvature{GROWS}")
        return _point(place, growing, called_of(found, names), arb(0))
    reason = f"the curvatures along some tangent and its opposite differ by {float(jump.mid()):.4g}"
    return _point(place, Judgement("curvature jump", "G1", reason), called_of(found, names), arb(0))


def _arrangement(at: Local, found: Sheets) -> tuple[Link, bool] | None:
    """Three or more sheets, and whether small spheres are proved to see what their tangent planes make."""
    gradients = [at.gradient(leaf) for leaf in found.leaves]

    def orientation(i: int, j: int, k: int) -> int:
        return sign_of(determinant([gradients[i], gradients[j], gradients[k]]))

    around = link(numbered(found), orientation, len(gradients))
    return None if around is None else (around, around.is_stable)


def _jump(at: Local, found: Sheets, around: Link) -> arb:
    return largest_angle(around, [outward(at, leaf, -1) for leaf in found.leaves])


def _of_rays(
    place: ZeroPlace, known: Known, found: Sheets | None, around: Link | None, names: Names | None, kind: str
) -> SingularPoint | None:
    """What the one-sided derivative proves, from coarse cells of directions or from fine ones."""
    called = called_of(found, names) if found is not None else ()
    for finest in (FINE,) if isinstance(known, Apparent) else (FINE, FINEST):
        rays = rays_at(known.local.model, known, finest)
        if rays is None:
            return None
        judgement = _judged(rays, kind)
        if judgement is None:
            continue
        if judgement.continuity == "broken":
            return _point(place, judgement, called, arb(math.nan))
        if found is not None and around is not None and around.edges:
            return _point(place, judgement, called, _jump(known.at, found, around))
        turn, off = largest_turn(rays)
        return replace(_point(place, judgement, called, arb(0)), tangent_jump=turn, tangent_jump_error=off)
    return None


def _judged(rays: Rays, kind: str) -> Judgement | None:
    """What the signs of the one-sided derivative say."""
    start = "the one-sided derivative of omega"
    if rays.signs.all() and len(set(rays.signs.tolist())) == 1:
        return Judgement("isolated point", "broken", f"{start} is zero in no direction")
    pieces = rays.components(1), rays.components(-1)
    if max(pieces) > 1:
        reason = f"small spheres see {pieces[0]} or more pieces of the inside and {pieces[1]} or more of the outside"
        return Judgement("node", "broken", reason)
    if rays.upward is not None and rays.is_bent:
        return Judgement(kind, "G0", f"a surface, as omega grows along one direction, but {start} has no tangent plane")
    return None


def _point(place: ZeroPlace, judgement: Judgement, called: tuple[str, ...], jump: arb) -> SingularPoint:
    return SingularPoint(
        point=floats(place.point),
        radius=radius_of(place.point),
        kind=judgement.kind,
        continuity=judgement.continuity,
        names=called,
        tangent_jump=float(jump.mid()),
        tangent_jump_error=error(jump),
        proved=True,
        reason=judgement.reason,
    )


def called_of(found: Sheets, names: Names | None) -> tuple[str, ...]:
    """The names of the definitions that some sheets belong to."""
    return tuple(dict.fromkeys(map(names, found.origins))) if names else ()


# The largest turn of the normal at a tip: numbers, from the limits of the gradient along generators.
AROUND = 48  # generators: opposite ones are among them
BITS = 64
OFF = 1e-9  # degrees: the search ends at steps of 1e-9 radians, where the angle hardly changes any more


def largest_turn(rays: Rays) -> tuple[float, float]:
    """The largest angle between two normals in degrees, and an estimate of its error; NaN where there is none.

    Examples
    --------
    >>> import sympy as sp
    >>> import rsym
    >>> from fractions import Fraction
    >>> from rsym import x, y, z
    >>> from rsym.verify.boxes.vanishing import exact_at
    >>> from rsym.verify.points.rays import rays_at
    >>> from rsym.verify.boxes.local import Model
    >>> model = Model(rsym.Shape(z - sp.sqrt(x**2 + y**2), (x, y, z)), {})
    >>> origin = [arb(0)] * 3
    >>> known = exact_at(model, origin, dict.fromkeys("xyz", Fraction(0)), frozenset())
    >>> round(largest_turn(rays_at(model, known))[0], 9)
    90.0
    """
    if rays.upward is None:
        return math.nan, math.nan
    with ctx.workprec(BITS):
        return _largest(_normals(rays, np.array(rays.upward)))


def _largest(normal: Callable[[float], NDArray[np.float64] | None]) -> tuple[float, float]:
    angles = np.arange(AROUND) * (2 * math.pi / AROUND)
    found = [normal(angle) for angle in angles]
    known = [(angle, own) for angle, own in zip(angles, found, strict=True) if own is not None]
    if len(known) < 3:
        return math.nan, math.nan
    normals = np.array([own for _, own in known])
    turns = np.linalg.norm(normals[:, None] - normals[None], axis=2)
    i, j = np.unravel_index(int(turns.argmax()), turns.shape)

    def shortfall(pair: NDArray[np.float64]) -> float:
        a, b = (normal(float(angle)) for angle in pair)
        return 0.0 if a is None or b is None else -float(np.linalg.norm(a - b))

    start = np.array([known[i][0], known[j][0]])
    step = 2 * math.pi / AROUND
    simplex = start + np.array([[0, 0], [step, 0], [0, step]])
    better = minimize(shortfall, start, method="Nelder-Mead", options={"initial_simplex": simplex, "xatol": 1e-9})
    chord = max(float(turns[i, j]), -float(better.fun))
    return math.degrees(2 * math.asin(min(chord / 2, 1.0))), OFF


def _normals(rays: Rays, upward: NDArray[np.float64]) -> Callable[[float], NDArray[np.float64] | None]:
    """The unit normal by the angle of the half plane."""
    v = upward / np.linalg.norm(upward)
    first = np.cross(v, np.eye(3)[int(np.abs(v).argmin())])
    first /= np.linalg.norm(first)
    second = np.cross(v, first)

    def normal(angle: float) -> NDArray[np.float64] | None:
        outwards = math.cos(angle) * first + math.sin(angle) * second
        # H > 0 upwards, H < 0 downwards
        down = brentq(lambda t: _height(rays, _balls(t, v, outwards)), 0, math.pi, xtol=1e-15)
        gradient = rays.slopes.gradient(_balls(down, v, outwards))
        if gradient is None or not all(part.is_finite() for part in gradient):
            return None
        found = np.array([float(part.mid()) for part in gradient])
        unit: NDArray[np.float64] = found / np.linalg.norm(found)
        return unit

    return normal


def _balls(angle: float, v: NDArray[np.float64], outwards: NDArray[np.float64]) -> tuple[arb, ...]:
    return tuple(arb(float(part)) for part in math.cos(angle) * v + math.sin(angle) * outwards)


def _height(rays: Rays, direction: tuple[arb, ...]) -> float:
    value = rays.slopes.at(direction)[rays.slopes.number]
    return math.nan if value is None else float(value.mid())
