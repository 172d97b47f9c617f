"""Germs of curves about the origin, whose grade is known by construction."""

from __future__ import annotations

import math
from random import Random

import sympy as sp
from sympy import Abs, Max, Piecewise, sign, sqrt

import rsym
from opponent.kinks import SYSTEMS, ZERO, Q, kink, whole
from opponent.truth import Germ, Spot, grade_of, u, v
from rsym import R0, R1

ORIGIN = (ZERO, ZERO)


def coefficient(random: Random) -> sp.Rational:
    return random.choice([Q(1), Q(1, 2), Q(-1, 2), Q(random.randint(1, 60), 64), Q(1, 10**6), -Q(3, 7)])


def _switch(random: Random) -> tuple[sp.Expr, sp.Rational]:
    """What is zero across the boundary at the origin: u, or a slanted line, or a curve; and its slant."""
    a = random.choice([ZERO, ZERO, Q(1, 2), Q(-1, 4)])
    return u + a * v + random.choice([0, 0, v**2, Q(1, 4) * u**2]), a


def kinked(random: Random) -> Germ:
    """The graph of a kink of order k: G^(k-1) exactly."""
    k, c = random.choice([1, 1, 2, 2, 2, 3, 3, 4, 5]), coefficient(random)
    t, a = _switch(random)
    f, left, right = kink(random, t, k)
    size = max(abs(float(left)), abs(float(right)))
    c = c / sp.Integer(math.ceil(size * 2)) if size > 1 else c
    turn = jump = None
    if k == 1:
        ends = [float(c * right / (1 - a * c * right)), float(-c * left / (1 + a * c * left * 1))]
        turn = abs(math.degrees(math.atan(ends[0]) - math.atan(ends[1])))
    if k == 2:
        jump = 2 * abs(float(c * (right - left)))
    shift = random.choice([0, 0, Q(1, 5) * u**2, sp.sin(u) ** 2 / 3])
    return Germ("kink", v - c * f - shift, (Spot(ORIGIN, grade_of(k - 1), turn, jump),), 0.3)


def two_kinks(random: Random) -> Germ:
    """A weak kink near a strong one, or two of them: none may hide the other."""
    gap = random.choice([Q(1, 10), Q(1, 1000), Q(1, 10**6), Q(1, 10**9)])
    j, k = random.choice([(1, 3), (2, 3), (2, 2), (1, 2), (3, 5)])
    f, *_ = kink(random, u, j)
    g, *_ = kink(random, u - gap, k)
    omega = v - coefficient(random) * f / 32 - coefficient(random) * g / 32
    places = [((at, -omega.subs({u: at, v: 0})), order) for at, order in ((ZERO, j), (gap, k))]
    return Germ("two kinks", omega, tuple(Spot(p, grade_of(n - 1)) for p, n in places), 0.3)


def power(random: Random) -> Germ:
    """|u|^q for q that is no whole number."""
    q = random.choice(
        [Q(1, 2), Q(3, 2), Q(4, 3), Q(5, 3), Q(5, 2), Q(7, 3), Q(7, 2), Q(10, 3), Q(199, 100), Q(201, 100)]
    )
    form = random.choice([Abs(u) ** q, Max(u, 0) ** q, (u**2) ** (q / 2), sqrt(u**2) ** q])
    if q < 1 and form.has(Max):
        form = Abs(u) ** q
    grade = "G0" if q < 1 else grade_of(math.floor(q))
    return Germ("power", v - coefficient(random) * form, (Spot(ORIGIN, grade),), 0.3)


def thin(random: Random) -> Germ:
    """A value taken on a line alone: the boundary has a hole there."""
    t = u if random.random() < 0.7 else u - Q(1, 3) * v
    base = random.choice([v, v - u**2 / 2, v + sp.sin(u) / 3])
    omega = random.choice(
        [
            base - Piecewise((0, t < 0), (0, t > 0), (1, True)),
            base - Piecewise((1, sp.And(t <= 0, t >= 0)), (0, True)),
            base - 1 + sign(t) ** 2,
            Piecewise((base, t < 0), (base, t > 0), (-1, True)),
            Piecewise((base, t < 0), (base, t > 0), (1, True)),
            Piecewise((base, t > 0), (-1, t >= 0), (base, True)),
            base + Piecewise((Q(1, 10**6), sp.And(t <= 0, t >= 0)), (0, True)),
            Piecewise((-1, sp.And(t <= 0, t >= 0)), (base, True)),
            base + 1 - Abs(sign(t)),
        ]
    )
    return Germ("thin", omega, (Spot(ORIGIN, "broken"),), 0.3, loose=True)


def thin_smooth(random: Random) -> Germ:
    """A value taken on a line alone that does not matter for the boundary."""
    base = random.choice([v, v - u**2 / 2])
    omega = random.choice(
        [
            base * Piecewise((1, u < 0), (1, u > 0), (2, True)),
            Piecewise((base, u < 0), (base, u > 0), (2 * base, True)),
            base * (2 - sign(u) ** 2),
            base - Piecewise((0, u < 0), (0, u > 0), (0, True), evaluate=False),
            base + Piecewise((1, sp.And(v > 2, u >= 0, u <= 0)), (0, True)),
        ]
    )
    return Germ("thin, smooth", omega, (), 0.3)


def corner(random: Random) -> Germ:
    """Two regular curves under an R-operation."""
    half = random.choice([Q(1, 4), Q(1, 2), Q(3, 4), Q(3, 2), Q(1, 2000), Q(1, 10**6)])
    c, s = (1 - half**2) / (1 + half**2), 2 * half / (1 + half**2)
    bend = random.choice([0, Q(1, 8)])
    f, g = v - bend * u**2, -s * u + c * v - bend * (v**2 + u**2) * random.choice([0, 1])
    if bend and g != -s * u + c * v and half < Q(1, 10):
        f, g = v, -s * u + c * v
    if half < Q(1, 10):
        f, g = v, -s * u + c * v
    system = random.choice(SYSTEMS)
    join = random.choice([system.conjunction, system.disjunction])
    scale = random.choice([1, 3, Q(1, 7)])
    turn = math.degrees(2 * math.atan(half))
    return Germ("corner", join(f, scale * g), (Spot(ORIGIN, "G0", turn),), 0.3)


def contact(random: Random) -> Germ:
    """Two curves with contact of order k, united or cut: for even k the boundary is one of them all along."""
    k = random.choice([1, 2, 2, 3, 3, 4, 5])
    h = random.choice([Q(1), Q(1, 2) + u**2, 1 + v**2 / 4, sp.exp(u) / 2, -Q(1, 3)])
    system = random.choice(SYSTEMS)
    join = random.choice([system.conjunction, system.disjunction])
    base = v - random.choice([0, u**2 / 4])
    omega = join(base, base + u**k * h / 2)
    return Germ("contact", omega, (Spot(ORIGIN, grade_of(k - 1)),) if k % 2 else (), 0.3)


def crossing_contact(random: Random) -> Germ:
    """The two sides of the curves face each other: between them a region ends in a cusp or in a double point."""
    k = random.choice([2, 3, 4, 5])
    system = random.choice(SYSTEMS)
    join = random.choice([system.conjunction, system.disjunction])
    omega = join(v, u**k - v)
    union = omega == system.disjunction(v, u**k - v)
    if k % 2:
        return Germ("cusp of contact", omega, (Spot(ORIGIN, "G0", 180.0),), 0.3)
    if union:  # v > 0 or v < u^k: everything
        return Germ("everything", omega, (Spot(ORIGIN, "broken"),), 0.3)
    return Germ("touching", omega, (Spot(ORIGIN, "broken"),), 0.3)


def cusp(random: Random) -> Germ:
    """v^p = u^q."""
    p, q = random.choice(
        [(2, 3), (2, 5), (3, 4), (3, 5), (3, 7), (3, 8), (3, 10), (5, 6), (5, 12), (5, 18), (3, 6), (3, 2)]
    )
    omega = v**p - coefficient(random) ** (0 if p == 3 else 1) * u**q
    if p == 2:
        return Germ("cusp", omega, (Spot(ORIGIN, "G0", 180.0),), 0.3)
    if q % p == 0:
        return Germ("cusp, smooth", omega, (), 0.3)
    grade = "G0" if q < p else grade_of(q // p)
    return Germ("root", omega, (Spot(ORIGIN, grade),), 0.3)


def broken(random: Random) -> Germ:
    """Nodes, isolated points, sheets without a change of sign, ends, jumps."""
    c = abs(coefficient(random))
    omega = random.choice(
        [
            u * v,
            v**2 - c * u**2,
            v**2 - u**2 * (1 + u),
            c * u**2 + v**2,
            -(u**2) - v**4,
            v**2 - c * u**4,
            v**2 + c * u**4,
            v + sign(u) * c / 8,
            Piecewise((v, u > 0), (v - c / 8, True)),
            v - c * sqrt(u),
            v - u * sqrt(u),
            v**3 - u**2 * v,
            Abs(u * v),
            Abs(v) + Abs(u),
            Max(Abs(u), Abs(v)),
            v * sign(u),
        ]
    )
    return Germ("broken", omega, (Spot(ORIGIN, "broken"),), 0.3, loose=True)


def sheet(random: Random) -> Germ:
    """omega is zero along a whole curve without changing its sign."""
    base = random.choice([v, v - u**2 / 3])
    omega = random.choice(
        [base**2, -(base**2), Abs(base), base**2 * (1 + u**2), -sqrt(base**2), R0.conjunction(base, -base), -(base**4)]
    )
    spots = tuple(Spot((at, -base.subs({u: at, v: 0})), "broken") for at in (Q(-1, 20), ZERO, Q(1, 20)))
    return Germ("sheet", omega, spots, 0.3, loose=True)


def disguised(random: Random) -> Germ:
    """A smooth curve under a function that is not."""
    base = random.choice([v, v - u**2 / 3, v - sp.sin(u) / 3, v - whole(random, u, random.choice([2, 3, 4])) / 4])
    t = random.choice([u, v, u + v, u - Q(1, 8)])
    omega = random.choice(
        [
            base,
            base * (2 + Abs(t)),
            base * (1 + Max(t, 0)),
            base * (2 + sign(t)),
            base * Abs(base),
            base + Abs(base) / 2,
            base**3,
            Piecewise((base, t > 0), (3 * base, True)),
            Piecewise((base, base > 0), (3 * base, True)),
            R1.disjunction(base, 2 * base),
            R1.conjunction(base, base + Abs(base)) + base,
            R0.disjunction(R0.conjunction(base, t), base),
            R0.conjunction(base, 1 + v),
            base / (2 - Abs(t)),
            base * sqrt(t**2 + 1),
            sp.exp(base * (1 + Abs(t))) - 1,
            base + base**2 * Abs(t),
            rsym.normalise(rsym.Shape(base, (u, v))).expression if not base.has(sp.Function) else base,
        ]
    )
    return Germ("disguised", omega, (), 0.3)


GERMS = (
    kinked,
    kinked,
    kinked,
    two_kinks,
    power,
    thin,
    thin_smooth,
    corner,
    corner,
    contact,
    contact,
    crossing_contact,
    cusp,
    broken,
    sheet,
    disguised,
    disguised,
)
