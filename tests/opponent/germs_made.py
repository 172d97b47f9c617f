"""Shapes made by the constructions of the package from profiles of known grade."""

from __future__ import annotations

import math
from random import Random

import sympy as sp

import rsym
from opponent.germs_plane import GERMS as PLANE
from opponent.kinks import SYSTEMS, ZERO, Q
from opponent.truth import Germ, Spot, u, v, w
from rsym import Shape

ORIGIN = (ZERO, ZERO)


def _odd_profile(random: Random) -> tuple[sp.Expr, str, float | None]:
    """S(u), and the grade of S(|u|): that of the lowest odd power, and the turn of a corner."""
    a, b, c = random.choice(
        [
            (Q(1, 2), 0, 0),
            (Q(-1, 3), Q(1, 2), 0),
            (0, Q(1, 2), 0),
            (0, 0, Q(1, 2)),
            (0, Q(1, 3), Q(1, 4)),
            (Q(1, 10**6), 1, 1),
        ]
    )
    s = a * u + b * u**2 + c * u**3
    if random.random() < 0.3:
        s = {True: sp.sin(u) / 2, False: sp.cos(u) / 2}[random.random() < 0.5]
        return s, "G0" if s.has(sp.sin) else "analytic", 2 * math.degrees(math.atan(0.5)) if s.has(sp.sin) else None
    if a:
        return s, "G0", 2 * math.degrees(math.atan(abs(float(a))))
    return (s, "G2", None) if c else (s, "analytic", None)


def mirrored(random: Random) -> Germ:
    """A graph and its mirror image: |u| in place of u."""
    s, grade, turn = _odd_profile(random)
    shape = rsym.mirrored(Shape(v - s, (u, v)))
    top = s.subs(u, 0)
    return Germ(
        "mirrored", shape.expression.subs(v, v + top), () if grade == "analytic" else (Spot(ORIGIN, grade, turn),), 0.3
    )


def polygon(random: Random) -> Germ:
    """A half plane in the sectors of a kaleidoscope: a corner of a regular polygon at the origin."""
    n = random.choice([2, 3, 4, 5, 6])
    shape = rsym.kaleidoscope(Shape(1 - u, (u, v)), n)
    if n == 2:
        return Germ("kaleidoscope", shape.expression.subs(u, u + 1), (), 0.3)  # two parallel sides
    # Sides at the angles 2 k pi/n, corners at pi/n.
    at = (1, sp.tan(sp.pi / n))
    omega = shape.expression.subs({u: u + at[0], v: v + at[1]}, simultaneous=True)
    return Germ("kaleidoscope", omega, (Spot(ORIGIN, "G0", 360 / n),), 0.3)


def waves(random: Random) -> Germ:
    """A graph again and again along u: on the border of two cells as smooth as its odd derivatives there are zero."""
    h = Q(1)
    s, grade = random.choice(
        [
            (u**2 / 4, "G0"),
            ((u**2 - h**2 / 4) ** 2, "G2"),
            (sp.cos(2 * sp.pi * u) / 10, "analytic"),
            (u**2 / 10**6, "G0"),
            (ZERO, "analytic"),
        ]
    )
    shape = rsym.row(Shape(v - s, (u, v)), h, axis=u, count=random.choice([None, 2, 3]))
    border = (h / 2, s.subs(u, h / 2))
    omega = shape.expression.subs({u: u + border[0], v: v + border[1]}, simultaneous=True)
    return Germ("row", omega, () if grade == "analytic" else (Spot(ORIGIN, grade),), 0.3)


def fan(random: Random) -> Germ:
    """Balls around a circle: where two overlap there is a corner on the border of the sectors."""
    n, distance = random.choice([(3, 1), (4, 1), (6, 2), (5, 1)])
    half = distance * sp.sin(sp.pi / n)  # from a centre to the border
    wide = sp.sqrt(half**2 + Q(1, 4))
    shape = rsym.cyclic(Shape(wide**2 - u**2 - v**2, (u, v)), n, radius=distance)
    reach = distance * sp.cos(sp.pi / n) + Q(1, 2)
    place = (reach * sp.cos(sp.pi / n), reach * sp.sin(sp.pi / n))
    omega = shape.expression.subs({u: u + place[0], v: v + place[1]}, simultaneous=True)
    turn = 2 * math.degrees(math.atan(float(2 * half)))
    return Germ("cyclic", omega, (Spot(ORIGIN, "G0", turn),), 0.2)


def steps(random: Random) -> Germ:
    """A graph carried along cell by cell: on a border it is as smooth as both ends of a cell agree, or it jumps."""
    h = Q(1)
    s, grade = random.choice(
        [
            (u / 10, "broken"),
            (-u / 10**4, "broken"),
            (u**2 / 4, "G0"),
            (u**3 - u / 4, "G1"),
            (u * (u**2 - h**2 / 4) ** 3, "G3"),
            (sp.sin(2 * sp.pi * u) / 10, "analytic"),
        ]
    )
    shape = rsym.row(Shape(v - s, (u, v)), h, axis=u, count=random.choice([None, 2, 3]), motif="any")
    before, behind = s.subs(u, h / 2), s.subs(u, -h / 2)
    omega = shape.expression.subs({u: u + h / 2, v: v + before}, simultaneous=True)
    ends = (ORIGIN, (ZERO, behind - before)) if grade == "broken" else (ORIGIN,)
    spots = () if grade == "analytic" else tuple(Spot(end, grade) for end in ends)
    return Germ("row of any motif", omega, spots, 0.3)


def saw(random: Random) -> Germ:
    """A slanting half plane turned from sector to sector: its edges are cut on the border, each at its own height."""
    n, slant = random.choice([2, 3, 4, 5, 6]), random.choice([Q(1, 10), Q(-1, 5), Q(1, 1000)])
    shape = rsym.cyclic(Shape(1 - u + slant * v, (u, v)), n, motif="any")
    c, s = sp.cos(sp.pi / n), sp.sin(sp.pi / n)
    radii = [1 / (c - side * slant * s) for side in (1, -1)]
    if n == 2:  # the borders are parallel to the edges, nearly
        return Germ("cyclic of any motif", shape.expression.subs(u, u + 1), (), 0.3)
    omega = shape.expression.subs({u: u + radii[0] * c, v: v + radii[0] * s}, simultaneous=True)
    spots = tuple(Spot(((radius - radii[0]) * c, (radius - radii[0]) * s), "broken") for radius in radii)
    return Germ("cyclic of any motif", omega, spots, 0.2)


PLANE_MADE = (mirrored, polygon, waves, fan, steps, saw)


def _profile(random: Random) -> Germ:
    while True:
        germ = random.choice(PLANE)(random)
        if not germ.omega.has(sp.pi) or True:
            return germ


def extruded(random: Random) -> Germ:
    """A prism, far from its ends."""
    germ = _profile(random)
    system = random.choice(SYSTEMS)
    shape = rsym.extrude(Shape(germ.omega, (u, v)), -3, 3, system=system)
    omega = shape.expression.subs({symbol: w for symbol in shape.expression.free_symbols - {u, v}})
    return Germ(f"extruded {germ.family}", omega, _lifted(germ, ZERO), germ.reach, loose=True)


def _lifted(germ: Germ, slope) -> tuple[Spot, ...]:
    heights = (Q(-1, 10), ZERO, Q(1, 10))
    return tuple(Spot((s.point[0], s.point[1] + slope * t, t), s.grade) for s in germ.spots for t in heights)


def swept(random: Random) -> Germ:
    """A profile that rises with the height."""
    germ = _profile(random)
    p, slope = sp.Symbol("p", real=True), random.choice([Q(1, 5), Q(-1, 7)])
    profile = Shape(germ.omega.subs(v, v - p), (u, v), letters={p: 0})
    third = sp.Symbol("z", real=True)
    shape = rsym.sweep(profile, {p: slope * third}, -3, 3)
    omega = shape.expression.subs({symbol: w for symbol in shape.expression.free_symbols - {u, v}})
    return Germ(f"swept {germ.family}", omega, _lifted(germ, slope), germ.reach, loose=True)


def turned_profile(random: Random) -> Germ:
    """A profile far from the axis, turned about it: every defect becomes a circle."""
    germ = _profile(random)
    far = Q(2)
    moved = Shape(germ.omega.subs(v, v - far), (u, v))
    shape = rsym.revolve(moved, axis=u)
    third = next(iter(shape.expression.free_symbols - {u, v}), w)
    omega = shape.expression.subs(third, w).subs(v, v + far)
    return Germ(
        f"turned {germ.family}",
        omega,
        tuple(Spot((*s.point, ZERO), s.grade) for s in germ.spots),
        germ.reach,
        loose=True,
    )


SPACE_MADE = (extruded, swept, turned_profile)
