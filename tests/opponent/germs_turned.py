"""Germs of bodies of revolution about the axis of w through the origin, whose grade is known by construction."""

from __future__ import annotations

import math
from random import Random

import sympy as sp
from sympy import Abs, Max, sqrt

import rsym
from opponent.germs_plane import coefficient
from opponent.kinks import SYSTEMS, ZERO, Q, kink
from opponent.truth import Germ, Spot, grade_of, u, v, w

ORIGIN = (ZERO, ZERO, ZERO)
RADIUS = sqrt(u**2 + v**2)
AROUND = ((1, 0), (0, 1), (Q(-3, 5), Q(4, 5)))


def tip(random: Random) -> Germ:
    """A function of the radius alone: an odd power makes a tip."""
    r, c = RADIUS, coefficient(random)
    form, grade = random.choice(
        [
            (r, "G0"),
            (sp.sin(r), "G0"),
            (sp.exp(r) - 1, "G0"),
            (r - r**2, "G0"),
            (r / (1 + r**2), "G0"),
            (r**2 + r / 10**6, "G0"),
            (r**3, "G2"),
            (sqrt((u**2 + v**2) ** 3), "G2"),
            (r * (u**2 + v**2), "G2"),
            (Abs(r) ** 3, "G2"),
            (sp.sin(r) ** 3, "G2"),
            (r**2 + r**3, "G2"),
            (r**2 * sp.sin(r), "G2"),
            (r**5, "G3"),
            (r**2 * sp.sin(r) ** 3, "G3"),
            (r**7, "G3"),
            (r ** Q(3, 2), "G1"),
            (r ** Q(5, 2), "G2"),
            (r ** Q(1, 2), "G0"),
            (r ** Q(5, 3), "G1"),
            (r**2, "analytic"),
            (r**4 - r**2, "analytic"),
            (sp.cos(r), "analytic"),
            (r * sp.sin(r), "analytic"),
            (sp.exp(r**2) - 1, "analytic"),
            (Max(r, 0), "G0"),
            (Max(r, -r) ** 3, "G2"),
        ]
    )
    top = form.subs({u: 0, v: 0})
    spots = () if grade == "analytic" else (Spot((ZERO, ZERO, c * top), grade),)
    return Germ("tip on the axis", w - c * form, spots, 0.3)


def tilted(random: Random) -> Germ:
    """The same tip under an R-operation, a power, a product with what is positive."""
    a = random.choice([Q(1), Q(2), Q(1, 3)])
    system = random.choice(SYSTEMS)
    base = w - a * RADIUS
    omega = random.choice(
        [
            base * (1 + w**2),
            base * (2 + Abs(w)),
            base**3,
            base * Abs(base),
            system.conjunction(base, 1 - w),
            system.disjunction(base, -1 - w),
            system.conjunction(w**2 - a * RADIUS**2, w),
            rsym.normalise(rsym.Shape(base, (u, v, w))).expression,
            w**3 - a * RADIUS**3,
            sp.exp(base) - 1,
        ]
    )
    return Germ("cone on the axis", omega, (Spot(ORIGIN, "G0"),), 0.3)


def implicit(random: Random) -> Germ:
    """Spindles, horns, spikes."""
    r = RADIUS
    omega, grade = random.choice(
        [
            (w**2 - r**2, "broken"),
            (w**2 - r**3, "broken"),
            (r**2 - w**3, "G0"),
            (w**3 - r**4, "G1"),
            (w**3 - r**2, "G0"),
            (w**3 - r**5, "G1"),
            (w**3 - r**7, "G2"),
            (w**3 - r**6, "analytic"),
            (w**2 + r**2, "broken"),
            (-(w**2) - r, "broken"),
            (w**2 - r**4, "broken"),
        ]
    )
    return Germ("singular on the axis", omega, () if grade == "analytic" else (Spot(ORIGIN, grade),), 0.3)


def spindle(random: Random) -> Germ:
    """The inside of a circle that crosses the axis, turned about it: a lemon, or an apple, with two tips."""
    a = random.choice([Q(3, 20), Q(1, 10), Q(1, 5)])
    sign = random.choice([1, -1])
    reach = random.choice([Q(1, 4), Q(13, 60)])
    omega = reach**2 - w**2 - (RADIUS + sign * a) ** 2
    height = sqrt(reach**2 - a**2)
    turn = 2 * math.degrees(math.atan(float(a / height)))
    spots = tuple(Spot((ZERO, ZERO, s * height), "G0", turn) for s in (1, -1))
    return Germ("spindle", omega, spots, 0.45)


def ring(random: Random) -> Germ:
    """A kink off the axis: a circle of defects."""
    k, c, a = random.choice([1, 2, 2, 3, 4]), coefficient(random) / 4, random.choice([Q(1, 10), Q(1, 20), sqrt(2) / 20])
    left = 1
    while left:  # inside the circle the profile is to be a polynomial in the square of the radius
        f, left, _ = kink(random, RADIUS - a, k)
    omega = w - c * f / 2**k - random.choice([0, RADIUS**2 / 3])
    top = -omega.subs({u: a, v: 0, w: 0})
    return Germ("ring", omega, tuple(Spot((p * a, q * a, top), grade_of(k - 1)) for p, q in AROUND), 0.3, loose=True)


def balls(random: Random) -> Germ:
    """Two balls on the axis that overlap, or touch."""
    system = random.choice(SYSTEMS)
    touching = random.random() < 0.4
    a, b = Q(1, 8), random.choice([Q(1, 8), Q(1, 10)])
    gap = a + b if touching else Q(3, 20)
    f, g = a**2 - RADIUS**2 - (w + a) ** 2, b**2 - RADIUS**2 - (w + a - gap) ** 2
    join = system.disjunction
    if touching:
        return Germ("touching balls", join(f, g), (Spot(ORIGIN, "broken"),), 0.5)
    # f = g on the plane w = t.
    t = sp.solve(sp.expand(f - g), w)[0]
    rim = sqrt(a**2 - (t + a) ** 2)
    spots = tuple(Spot((p * rim, q * rim, t), "G0") for p, q in AROUND)
    return Germ("overlapping balls", join(f, g), spots, 0.5, loose=True)


GERMS = (tip, tip, tip, tilted, implicit, spindle, ring, balls)
