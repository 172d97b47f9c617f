"""Germs of surfaces about the origin, whose grade is known by construction."""

from __future__ import annotations

import math
from random import Random

import sympy as sp
from sympy import Abs, Max, Piecewise, sign, sqrt

from opponent.germs_plane import coefficient
from opponent.kinks import SYSTEMS, ZERO, Q, kink, whole
from opponent.truth import Germ, Spot, grade_of, t, u, v, w
from rsym import R0, R1

ORIGIN = (ZERO, ZERO, ZERO)
ALONG = (Q(-1, 10), ZERO, Q(1, 10))


def _on(omega: sp.Expr, places, grade: str, turn=None, jump=None) -> tuple[Spot, ...]:
    """Spots on w = h(u, v) over places (u, v), for omega = w - h."""
    return tuple(Spot((*place, -omega.subs({u: place[0], v: place[1], w: 0})), grade, turn, jump) for place in places)


def _line(omega: sp.Expr, where: sp.Expr = ZERO) -> tuple[sp.Expr, ...]:
    """The curve over u = where(t), v = t, for omega = w - h."""
    return where, t, -omega.subs({w: 0}).subs({u: where, v: t}, simultaneous=True)


def creased(random: Random) -> Germ:
    """A kink of order k along a line or a curve of the graph."""
    k, c = random.choice([1, 1, 2, 2, 3, 4, 5]), coefficient(random)
    bend = random.choice([ZERO, ZERO, Q(1, 4)])
    f, left, right = kink(random, u - bend * v**2, k)
    size = max(abs(float(left)), abs(float(right)))
    c = c / sp.Integer(math.ceil(size * 2)) if size > 1 else c
    factor = random.choice([1, 1, 1 + v**2, sp.exp(v)])
    shift = random.choice([0, u**2 / 5, (u**2 - v**2) / 4, v / 3])
    omega = w - c * factor * f - shift
    spots = _on(omega, [(bend * a**2, a) for a in ALONG], grade_of(k - 1))
    return Germ("crease", omega, spots, 0.3, loose=True, curve=_line(omega, bend * t**2))


def dying(random: Random) -> Germ:
    """A crease whose strength is zero at the origin, and is there elsewhere."""
    k, c = random.choice([1, 2, 3]), coefficient(random) / 4
    f, *_ = kink(random, u, k)
    omega = w - c * f / 2**k * random.choice([v, v**2, sp.sin(v)])
    spots = _on(omega, [(ZERO, Q(1, 10)), (ZERO, -Q(1, 10))], grade_of(k - 1))
    return Germ("dying crease", omega, spots, 0.3, loose=True, curve=_line(omega))


def tip(random: Random) -> Germ:
    """The graph of something homogeneous in u and v that is no polynomial."""
    a = random.choice([1, 1, Q(1, 4), 2])
    rho = sqrt(u**2 + a * v**2)
    c = coefficient(random)
    form, degree = random.choice(
        [
            (rho, 1),
            (rho**3, 3),
            (rho**5, 5),
            (u * rho, 2),
            (u * v * rho, 3),
            (u**2 * rho, 3),
            (rho ** Q(3, 2), Q(3, 2)),
            (rho ** Q(5, 2), Q(5, 2)),
            (u**3 / rho, 2),
            (u**2 * v**2 / rho**2, 2),
            (sqrt(u**4 + v**4), 2),
        ]
    )
    whole_degree = degree == int(degree)
    grade = grade_of(int(degree) - 1 if whole_degree else math.floor(degree))
    hole = form.has(sp.Pow(rho, -1)) or form.has(sp.Pow(rho, -2))
    omega = w - c * form - random.choice([0, u**2 / 4, (u + v) / 5])
    spots = (Spot(ORIGIN, "broken" if hole else grade),)
    return Germ("tip", omega, spots, 0.3)


def smooth_tip(random: Random) -> Germ:
    """Powers of the distance from an axis that are polynomials, or analytic."""
    rho = sqrt(u**2 + v**2)
    form = random.choice([rho**2, rho**4, sp.cos(rho), Abs(rho) ** 2, rho**6 / (1 + rho**2), sp.exp(rho**2) - 1])
    return Germ("smooth tip", w - coefficient(random) * form, (), 0.3)


def cone(random: Random) -> Germ:
    a, b = random.choice([1, 2, Q(1, 3)]), random.choice([1, 1, Q(1, 2)])
    q = u**2 + b * v**2
    omega, grade = random.choice(
        [
            (w - a * sqrt(q), "G0"),
            (w**2 - a * q, "broken"),
            (w + a * sqrt(q), "G0"),
            (R1.conjunction(w**2 - a * q, w), "G0"),
            (R0.conjunction(w**2 - a * q, w), "G0"),
            (w**3 - q, "G0"),
            (w**2 - q**2, "broken"),
            (w**2 + q, "broken"),
            (w**3 - q**2, "G1"),
            (w * Abs(w) - a * q, "G0"),
            (w**3 - u**3 - v**3, "G0"),
            (u**2 - v**2 * w, "broken"),
        ]
    )
    loose = omega == u**2 - v**2 * w
    if omega == w**3 - u**3 - v**3:
        loose = True
    return Germ("cone", omega, (Spot(ORIGIN, grade),), 0.3, loose=loose)


def corner(random: Random) -> Germ:
    """An edge or a corner of two or three sheets under R-operations."""
    system = random.choice(SYSTEMS)
    join = random.choice([system.conjunction, system.disjunction])
    bend = random.choice([0, 0, Q(1, 8)])
    half = random.choice([Q(1, 4), Q(1, 2), Q(3, 2), Q(1, 2000)])
    c, s = (1 - half**2) / (1 + half**2), 2 * half / (1 + half**2)
    if half < Q(1, 10):
        bend = 0
    f, g = w - bend * v**2, -s * u + c * w - c * bend * v**2
    turn = math.degrees(2 * math.atan(half)) if not bend else None
    spots = tuple(Spot((ZERO, a, bend * a**2), "G0", turn) for a in ALONG)
    omega = join(f, random.choice([1, 3]) * g)
    if random.random() < 0.3 and not bend:
        omega = join(omega, v - Q(1, 50) * u)
        return Germ("corner", omega, (Spot(ORIGIN, "G0"),), 0.3, loose=True)
    return Germ("edge", omega, spots, 0.3, loose=True, curve=_line(w - bend * v**2))


def contact(random: Random) -> Germ:
    """Two sheets with contact of order k along a curve, or at a point, united or cut."""
    k = random.choice([1, 2, 2, 3, 3, 4])
    h = random.choice([Q(1), Q(1, 2) + u**2, 1 + v**2 / 4, -Q(1, 3), sp.exp(v) / 2])
    system = random.choice(SYSTEMS)
    join = random.choice([system.conjunction, system.disjunction])
    base = w - random.choice([0, v**2 / 4, (u**2 + v**2) / 6])
    if random.random() < 0.25:
        return Germ("contact at a point", join(base, base + (u**2 + v**2) / 2), (), 0.3)
    omega = join(base, base + u**k * h / 2)
    spots = _on(base, [(ZERO, a) for a in ALONG], grade_of(k - 1)) if k % 2 else ()
    return Germ("contact", omega, spots, 0.3, loose=True, curve=_line(base))


def facing(random: Random) -> Germ:
    """Sheets that face one another: bodies that touch along a curve or at a point."""
    h = random.choice([u**2, u**2 + v**2, u**4])
    system = random.choice(SYSTEMS)
    join = random.choice([system.conjunction, system.disjunction])
    return Germ("facing", join(w, h - w), (Spot(ORIGIN, "broken"),), 0.3, loose=True)


def thin(random: Random) -> Germ:
    base = random.choice([w, w - u**2 / 2, w - v**2 / 3])
    side = random.choice([u, u - v / 3])
    omega = random.choice(
        [
            base - Piecewise((0, side < 0), (0, side > 0), (1, True)),
            base - 1 + sign(side) ** 2,
            Piecewise((base, side < 0), (base, side > 0), (-1, True)),
            base - Piecewise((1, sp.And(side <= 0, side >= 0)), (0, True)),
        ]
    )
    return Germ("thin", omega, (Spot(ORIGIN, "broken"),), 0.3, loose=True)


def broken(random: Random) -> Germ:
    omega = random.choice(
        [
            u * w,
            w**2 - u**2 * (1 + v**2),
            u**2 + v**2 + w**2,
            -(w**2) * (1 + u**2),
            Abs(w - u**2 / 3),
            w + sign(u) / 8,
            Piecewise((w, u > 0), (w - Q(1, 20), True)),
            w * u * v,
            w - sqrt(u),
            w**2 + u**2,
        ]
    )
    return Germ("broken", omega, (Spot(ORIGIN, "broken"),), 0.3, loose=True)


def disguised(random: Random) -> Germ:
    """A smooth sheet under a function that is not."""
    base = random.choice([w, w - u**2 / 3, w - (u**2 + v**2) / 4, w - sp.sin(u) * v / 3])
    base = random.choice([base, base, base - whole(random, u, random.choice([2, 3])) / 4])
    side = random.choice([u, w, u + v, v - Q(1, 8)])
    omega = random.choice(
        [
            base * (2 + Abs(side)),
            base * (1 + Max(side, 0)),
            base * (2 + sign(side)),
            base + Abs(base) / 2,
            base * Abs(base),
            Piecewise((base, side > 0), (3 * base, True)),
            Piecewise((base, base > 0), (3 * base, True)),
            R1.disjunction(base, 2 * base),
            R0.disjunction(R0.conjunction(base, side), base),
            base / (2 - Abs(side)),
            sp.exp(base * (1 + Abs(side))) - 1,
            base + base**2 * Abs(side),
            base * (2 - sqrt(u**2 + v**2)),
            base**3,
        ]
    )
    return Germ("disguised", omega, (), 0.3)


GERMS = (
    creased,
    creased,
    dying,
    tip,
    tip,
    smooth_tip,
    cone,
    corner,
    corner,
    contact,
    contact,
    facing,
    thin,
    broken,
    disguised,
    disguised,
)
