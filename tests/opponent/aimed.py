"""Shapes that are each aimed at one step of the proofs, small and quick, with their truth derived by hand."""

from __future__ import annotations

import functools

import sympy as sp
from sympy import Abs, Max, Min, Piecewise, sign, sqrt

import rsym
from opponent.judge import smoothness
from opponent.kinks import Q
from opponent.truth import Case, Spot
from rsym import R0, R0m, RAlpha, Rp, Shape, conjunction, disjunction, x, y, z
from rsym.model.powers import AbsolutePower
from rsym.model.symmetry.waves import SawtoothWave

WIDE = ((-2, 2.1), (-2.2, 2))
SPACE = ((-1, 1.1), (-1.2, 1), (-1.1, 1.3))
DISC = 1 - x**2 - y**2
BALL = 1 - x**2 - y**2 - z**2
CUSP = (-x - 1) ** 3 + 3 * x**2 + 3 * x + 1 - y**2
r = sqrt(x**2 + y**2)
HIDDEN = (x - y) ** 2 + 2 * x * y + z**2 + Q(1, 1000)  # positive, but not by its form

CUBE = ((-1.5, 1.5),) * 3
SPIRAL, FOLDED = DISC + sp.atan2(y, x) / 4, DISC + sp.atan2(y, x) ** 2 / 20
ROW = y - SawtoothWave(x, sp.S.One) / 4
LEFT_CUT, WAIST = conjunction(BALL, x + Q(1, 2)), 1 - Abs(z) - x**2 - 2 * y**2
SLIVER = conjunction(sqrt(x) - 400 * x - y, sqrt(x) + y)  # arcs that leave one end and meet again at x = 1/40000
BEAK = conjunction(sqrt(x) * x - y, sqrt(x) * x + y)
LEAP = (sign(x) + sign(x) ** 2) / 2  # 1 where x > 0, else 0; no gate, as sign might have a value of its own there
NO_SCREW = 1 - x**2 - y**2 - sp.sin(z) / 4 - Abs(z - Q(1, 2)) / 8

# A letter, its value, and its range.
C = sp.Symbol("c", real=True)
LETTERS = {C: Q(3, 2)}
RANGES = {"c": (1, 2)}

# (omega, grade, bounds, a curvature if one is known): grade is what is true of the boundary within the bounds.
PLANE = [
    # kinks
    (y - Abs(x) / 3, "G0", WIDE),
    (y - x * Abs(x), "G1", WIDE),
    (y - Max(x, 0) ** 3, "G2", WIDE),
    (y - sqrt(x**2 + y**2) / 2, "G0", WIDE),
    (y - Abs(x) ** Q(3, 2), "G1", WIDE),
    (y - Abs(x) ** Q(19, 10), "G1", WIDE),
    (x + y - 1 / (1 + Abs(x)), "G0", WIDE),
    (y - x**3 / Abs(x), "broken", WIDE),  # not defined at x = 0
    (y - sp.exp(-1 / x**2), "broken", WIDE),
    (y - sp.atan2(x, Abs(x) + 1) * Abs(x), "G1", WIDE),
    (conjunction(x, y), "G0", WIDE),
    (disjunction(x, y + x**2, system=Rp(3)), "G0", WIDE),
    (conjunction(x, y, system=RAlpha(Q(1, 2))) - Q(1, 10), "analytic", WIDE),
    (conjunction(x, y, system=RAlpha(1)), "G0", WIDE),
    (conjunction(x, y, x + y), "G0", WIDE),
    (1 - sp.exp(-conjunction(x, y)), "G0", WIDE),
    (y + conjunction(x, y) / 2, "G0", WIDE),
    # domains
    (DISC * (2 + sqrt(x)), "broken", WIDE),
    (DISC * ((x - 5) ** 2 + y**2 + sqrt(y)), "broken", WIDE),
    (DISC / sqrt(DISC**2 + sqrt(x)), "broken", WIDE),
    (Piecewise((DISC, x > 0)), "broken", WIDE),
    # edges of roots: noses, ends, two of them nose to nose
    (conjunction(sqrt(x) - y, sqrt(x) + y), "analytic", WIDE),
    (conjunction(sqrt(x) - x / 3 - y, sqrt(x) - x / 3 + y), "G2", WIDE),
    (conjunction(sqrt(x) - y, 2 * sqrt(x) + y), "G1", WIDE),
    (conjunction(sqrt(x) - y, y - sqrt(x) / 2), "G0", WIDE),
    (conjunction(sqrt(x) - y, sqrt(x) + y - Q(1, 9)), "G0", WIDE),  # they meet at x = 1/324, before their ends
    (SLIVER, "G0", WIDE),
    (BEAK, "G0", WIDE),
    (conjunction(sqrt(Abs(x)) - y, sqrt(Abs(x)) + y), "broken", WIDE),
    (conjunction(sqrt(Max(x, 0)) - y, sqrt(Max(x, 0)) + y), "broken", WIDE),
    (sqrt(x) - y, "broken", WIDE),
    (sqrt(x) ** 2 * (1 + sqrt(x)) - y**2, "G2", WIDE),
    # signs and products
    (DISC**2, "broken", WIDE),
    (-(DISC**2) * (2 + Abs(x)), "broken", WIDE),
    (x * (x - y / 7), "broken", WIDE),
    (x * (y - x**2), "broken", WIDE),
    (DISC * Abs(DISC), "analytic", WIDE),
    (DISC * Abs(x), "broken", WIDE),
    (DISC * (x**2 + y**2 - 4), "analytic", ((-3, 3.1), (-3, 3.2))),
    (disjunction(DISC, -DISC), "broken", WIDE),
    (conjunction(DISC, -DISC), "broken", WIDE),
    # ends and jumps
    (y - LEAP, "broken", WIDE),
    (y - (3 + x) * LEAP, "broken", WIDE),
    (y + LEAP.subs(x, x - Q(1, 3)) / 8, "broken", WIDE),
    (Piecewise((y, x > 0), (y - 1, True)), "G0", WIDE),
    (y + sign(x - Q(1, 3)) / 8, "G0", WIDE),
    (Piecewise((y + Q(18, 100), x > 0), (y + Q(2, 10), True)), "broken", ((-1, 1), (-1, -0.19))),
    (Piecewise((y, x > 0), (y - Q(1, 10**30), True)), "broken", WIDE),
    # small defects
    (y - Q(1, 10**90) * Abs(x) - Abs(x) ** 3, "G0", WIDE),
    (y - Abs(x) ** 3 - Abs(x - Q(1, 10**6)) / 10**6, "G0", WIDE),
    (y - Abs(x) ** Q(19999999, 10000000), "G1", WIDE),
    (y - x**2 - Q(1, 10**40) * x * Abs(x), "G1", WIDE),
    (y - x**3 - Q(1, 10**40) * x**2 * Abs(x), "G2", WIDE),
    (y - Q(1, 10**90) * Abs(x - sqrt(2) / 2) - Abs(x - sqrt(2) / 2) ** 3, "G0", WIDE),
    (conjunction(sp.exp(2 * x) * sp.cos(2 * y) - 1, sp.exp(2 * x) * sp.sin(2 * y)), "G0", ((-0.6, 0.7), (-0.5, 0.6))),
    (conjunction(sp.exp(x) * sp.cos(y) - 1, sp.exp(x) * sp.sin(y)), "G0", ((-1.1, 1), (-1, 1.1))),
    (conjunction(x + 3 * y, x + 3 * y + Q(1, 10**90) * (x - y)), "G0", WIDE),
    (y + x / 3 - sqrt(x**2 - 4 * x * y + 4 * y**2) / 4, "G0", WIDE),
    # curvatures
    (DISC, "analytic", WIDE, 1.0),
    (y - 3 * x**2, "analytic", WIDE, 6.0),
    # singular points
    (y**2 - x**3, "G0", WIDE),
    (y**3 - x**4, "G1", WIDE),
    (y**3 - x**5, "G1", WIDE),
    (y**3 - x**7, "G2", WIDE),
    (y**3 - x**6, "analytic", WIDE),
    (y**2 - x**2 * (1 + x), "broken", WIDE),
    (x**2 + y**2, "broken", WIDE),
    (y**2 - x**4, "broken", WIDE),
    (disjunction(1 - (x - 1) ** 2 - y**2, Q(1, 4) - (x + Q(1, 2)) ** 2 - y**2), "broken", WIDE),
    (conjunction(1 - (x - 1) ** 2 - y**2, Q(1, 4) - (x + Q(1, 2)) ** 2 - y**2), "broken", WIDE),
    (conjunction(1 - (x - 1) ** 2 - y**2, (x + Q(1, 2)) ** 2 + y**2 - Q(1, 4)), "analytic", WIDE),
    (y * (x**2 + y**2), "analytic", WIDE),
    (y * (y - x**2) ** 2, "broken", WIDE),
    (disjunction(CUSP, -x), "analytic", WIDE),
    (x**2 - y**2 - Q(1, 10**30), "analytic", WIDE),
    (y - sqrt(x**2 + Q(1, 10**30)), "analytic", WIDE),
    # contact, cancelled kinks
    (disjunction(y, y + x**3), "G2", WIDE),
    (disjunction(y, y + x**2), "analytic", WIDE),
    (disjunction(y, y + 1 - sp.cos(x)), "analytic", WIDE),
    (conjunction(y, x**3 - y), "G0", WIDE),
    (Max(x, y) + Min(x, y), "analytic", WIDE),
    (y - sqrt(x**6), "G2", WIDE),
    (x + y - sqrt(x**2 + y**2 + Q(1, 10**40)), "analytic", WIDE),
    (y - sqrt(x**4), "analytic", WIDE),
    (y - sqrt((x - 1) ** 2 * (x + 1) ** 2) / 4, "G0", WIDE),
    (R0.conjunction(y, x) + R0.disjunction(y, x), "analytic", WIDE),
    # no boundary, or beside the bounds
    (DISC, "none", ((1.1, 2), (-1, 1))),
    (y**2 + x**4 + Q(1, 10**9), "none", WIDE),
    (conjunction(x, y + x / 3), "analytic", ((1e-12, 1), (-1, 1.2))),
    (conjunction(x - y / 3, y + x / 3 - x**2 / 8), "analytic", ((1e-5, 0.2), (-0.11, 0.2))),
    (y - Abs(x), "analytic", ((1e-9, 1), (-1, 1.2))),
    (conjunction(-x - Q(1, 1000), x + y / 10 - Q(1, 1000)), "analytic", ((-1, 1), (0.03, 1))),
    (R0m(1).conjunction(y, x + 5), "analytic", WIDE),
    (Piecewise((y - sqrt(2) / 2, x > 0), (y - sqrt(2) / 2 - sp.exp(x**6) / 10**90, True)), "broken", WIDE),
    (Piecewise((y - 3 - x, x > 0), (y, True)), "G0", WIDE),
    (y - x**2 - Q(1, 10**90) * Abs(x - sqrt(2) / 2), "G0", WIDE),
    (conjunction(x, y + x / 3), "analytic", ((1e-300, 1), (-1, 1.2))),
    (disjunction(r - Q(1, 2), Q(1, 4) - x**2 - 2 * y**2), "broken", WIDE),
    (2 + y - sqrt(x**2 + y**2), "analytic", ((-3, 3.1), (-2, 2.2))),
    # the cut of the angle, endless rows
    (SPIRAL, "broken", WIDE),
    (FOLDED, "G0", WIDE),
    (ROW, "broken", WIDE),
]
# What is less than analytic is so at the origin and nowhere else.
PLACED = [
    (y + Q(1, 10**30) * Abs(x) ** Q(19, 10), "G1", WIDE),
    (disjunction(y, y + 1 - sp.cos(x) + Q(1, 10**30) * x), "G0", WIDE),
    (y + Q(1, 10**26) * Abs(sp.sin(x)) ** Q(3, 2), "G1", WIDE),
    (y**5 - x**7, "G1", WIDE),
    ((y - Abs(x)) * (y - Abs(x) - 8 * x**2) * (y - Abs(x) + 8 * x**2), "broken", ((-0.1, 0.12), (-0.11, 0.1))),
    (conjunction(x + y, y - x) * (x - y / 3), "broken", WIDE),
    (z**4 - x**2 - y**2, "broken", SPACE),
]
# The same in several places; edges end on the faces of the bounds.
_ENDS = [((1.1, 0, 0), "G0"), ((-1, 0, 0), "G0")]
_AXES = [*_ENDS, ((0, 1, 0), "G0"), ((0, -1.2, 0), "G0"), ((0, 0, 1.3), "G0"), ((0, 0, -1.1), "G0")]
SPOTTED = [
    (disjunction(conjunction(x, y, z), conjunction(-x, -y, -z)), [((0, 0, 0), "broken"), *_AXES], SPACE),
    (conjunction(z, disjunction(conjunction(x, y), conjunction(-x, y))), [((0, 0, 0), "broken"), *_ENDS], SPACE),
]
# Bodies, by the meridian where they show one.
TURNED = [
    (z - r, "G0", SPACE),
    (z - r / 10**6 - r**2, "G0", SPACE),
    (z - r**3, "G2", SPACE),
    (z - r**5, "G3", SPACE),
    (z - r**2, "analytic", SPACE),
    (z - sp.cos(r), "analytic", SPACE),
    (z**2 - r**2 / 4, "broken", SPACE),
    (Q(1, 4) - z**2 - (r - Q(1, 4)) ** 2, "G0", SPACE),
    (1 - z**2 - sqrt(x**2 + y**2), "G0", SPACE),
    (z - Max(r - Q(1, 2), 0) ** 2, "G1", SPACE),
    (conjunction(Q(36, 25) - x**2 - y**2, Q(1, 4) - z**2), "G0", SPACE),
]
BODIES = [
    (BALL, "none", ((1.1, 2), (-1, 1), (-1, 1))),
    *TURNED,
    (BALL, "analytic", ((-1.3, 1.2), (-1.2, 1.3), (-1.1, 1.4)), 1.0),
    (z - 2 * x**2 - y**2, "analytic", SPACE, 4.0),
    (z - x * r, "G1", SPACE),
    (z - x * sp.sqrt(sp.sin(x) ** 2 + y**2), "G1", SPACE),
    (z - x * y * r, "G2", SPACE),
    (z - Abs(x) / 10, "G0", SPACE),
    (z - Abs(x) * y / 4, "G0", SPACE),
    (z - Max(x, 0) ** 2, "G1", SPACE),
    (z - Max(x, 0) ** 3 * (1 + y**2), "G2", SPACE),
    (conjunction(x, z + y / 3), "G0", SPACE),
    (conjunction(x, y, z), "G0", SPACE),
    (disjunction(x, y, z), "G0", SPACE),
    (conjunction(z, x**3 - z), "G0", SPACE),
    (disjunction(z, z + x**3), "G2", SPACE),
    (disjunction(z, z + x), "G0", SPACE),
    (disjunction(z, z + x**2), "analytic", SPACE),
    (disjunction(z, z + x**2 + y**2), "analytic", SPACE),
    (disjunction(z, -z - x**2 - y**2), "broken", SPACE),
    (conjunction(z, -z + x**2 - y**2), "broken", SPACE),
    (
        disjunction(Q(1, 4) - (x - Q(1, 2)) ** 2 - y**2 - z**2, Q(1, 4) - (x + Q(1, 2)) ** 2 - y**2 - z**2),
        "broken",
        SPACE,
    ),
    (disjunction(Q(1, 4) - (x - Q(1, 2)) ** 2 - y**2 - z**2, Q(1, 4) - (x + Q(4, 10)) ** 2 - y**2 - z**2), "G0", SPACE),
    (x**2 - y**2 - z**2, "broken", SPACE),
    (z - sqrt(x**2 + y**2 / 4), "G0", SPACE),
    (z**3 - x**2 - y**2, "G0", SPACE),
    (x**2 + y**2 + z**2, "broken", SPACE),
    (x * z, "broken", SPACE),
    (z**2 * (1 + x**2), "broken", SPACE),
    (-(z**2), "broken", SPACE),
    (BALL * (2 + sqrt(x)), "broken", ((-1.3, 1.2), (-1.2, 1.3), (-1.1, 1.4))),
    (conjunction(BALL, Piecewise((1, x > Q(1, 10)), (-1, True))), "G0", ((-1.3, 1.2), (-1.2, 1.3), (-1.1, 1.4))),
    (Piecewise((z, x > 0), (z - Q(1, 20), True)), "broken", SPACE),
    (
        conjunction(BALL, disjunction(Q(1, 4) - x**2 - y**2 - z**2, x**2 + y**2 + z**2 - Q(1, 4))),
        "broken",
        ((-1.3, 1.2), (-1.2, 1.3), (-1.1, 1.4)),
    ),
    (conjunction(x, z, system=rsym.Rho(Q(1, 2))), "G1", SPACE),
    (z - sp.sin(sqrt(x**2 + y**2)), "G0", SPACE),
    (z, "analytic", SPACE),
    (conjunction(BALL, disjunction(HIDDEN, -HIDDEN)), "analytic", ((-1.3, 1.2), (-1.2, 1.3), (-1.1, 1.4))),
    (conjunction(1 - z, conjunction(z, x, y)), "G0", SPACE),
    # related sheets, folds, classes, roots, jumps, letters
    (z + conjunction(x, z) / 2, "G0", SPACE),
    (disjunction(z, z + x**2 - Q(1, 100)), "G0", SPACE),
    (disjunction(z, z + x**2 * y), "G0", SPACE),
    (disjunction(conjunction(Q(1, 4) - x**2 - y**2, -z), Q(1, 4) - x**2 - y**2 - z**2), "G1", SPACE),
    (Max(x, y) * Min(x, y) - z**2, "broken", SPACE),
    (z - AbsolutePower(x, Q(3, 2)), "G1", SPACE),
    (z - Abs(x) * Abs(y) / 4, "G0", SPACE),
    (z + Piecewise((0, x < 0), (0, x > 0), (Q(1, 10), True)), "broken", SPACE),
    (z - Max(x + C - Q(27, 10), 0) / 4, "G0", SPACE),
    (z - C, "none", ((-1, 1.1), (-1.2, 1), (-1.1, 1.8))),
    # bodies that repeat themselves, and such that do not quite
    (LEFT_CUT, "G0", CUBE),
    (WAIST, "G0", CUBE),
    (NO_SCREW, "G0", CUBE),
    (1 - (x * sp.cos(z) + y * sp.sin(z)) ** 2 - 2 * (y * sp.cos(z) - x * sp.sin(z)) ** 2, "analytic", CUBE),
    (1 - x**2 - 2 * y**2, "analytic", CUBE),
]


def _case(kind: str, number: int, row: tuple, method: str | None) -> Case:
    omega, grade, bounds, *bend = row
    coordinates = (x, y) if len(bounds) == 2 else (x, y, z)
    if isinstance(grade, str):
        grade = [] if grade in ("analytic", "none") else [((0,) * len(bounds), grade)]
    spots = tuple(Spot(tuple(map(sp.sympify, point)), word) for point, word in grade)
    letters = {letter: value for letter, value in LETTERS.items() if omega.has(letter)}
    options = {} if method is None else {"method": method}
    options |= {"letters": RANGES} if C in letters else {}
    return Case(
        f"aimed {kind} {number}",
        Shape(omega, coordinates, bounds=bounds, letters=letters),
        spots,
        loose=kind not in ("placed", "spotted"),
        options=options,
        placed=kind in ("placed", "spotted"),
        bend=sum(bend),
        empty=row[1] == "none",
    )


@functools.cache
def cases() -> list[Case]:
    """All of them; a body of revolution both by its meridian and by boxes in space."""
    plane = [_case("plane", n, row, None) for n, row in enumerate(PLANE)]
    turned = [_case("turned", n, row, "auto") for n, row in enumerate(TURNED)]
    placed = [_case("placed", n, row, None if len(row[2]) == 2 else "space") for n, row in enumerate(PLACED)]
    spotted = [_case("spotted", n, row, "space") for n, row in enumerate(SPOTTED)]
    return [*plane, *placed, *spotted, *turned, *(_case("space", n, row, "space") for n, row in enumerate(BODIES))]


def asked(case: Case) -> tuple[str, list[str]]:
    """The verdict, and what is false in it."""
    if case.shape.dimension == 2:
        return smoothness(case, 600)
    return smoothness(case, 4_000 if "spotted" in case.family else 20_000)  # whose points are met early
