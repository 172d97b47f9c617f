"""Published values, with their sources: `pytest tests/published`."""

import math
from functools import cache

import numpy as np
import pytest
import sympy as sp

import rsym
from rsym import x, y

HALF = sp.Rational(1, 2)
HEAT, POISSON = "-laplacian(u) = 0", "-laplacian(u) = 1"


def plane(formula):
    return rsym.Shape(formula, (x, y))


def rect(left, right, bottom, top):
    """A rectangle by its sides."""
    return rsym.rectangle(right - left, top - bottom).translate(
        sp.Rational(left + right) / 2, sp.Rational(bottom + top) / 2
    )


def named(left, right, bottom, top):
    """A rectangle, its sides named."""
    across = plane(x - left).named("left") & plane(right - x).named("right")
    return across & plane(y - bottom).named("bottom") & plane(top - y).named("top")


def drum(shape, count=1, **given):
    return rsym.modes(shape, count, **given).values[count - 1]


ELL = rect(0, 1, 0, 2) | rect(1, 2, 0, 1)
# Gordon, Webb and Wolpert (1992), of seven half squares, as Driscoll has them.
FIRST = [(-3, -3), (-3, -1), (1, 3), (1, 1), (3, 1), (1, -1), (-1, -1), (-1, -3)]


# Dauge's domains A and D: Maxwell's eigenvalues of cavities are those of Neumann's problem, 0 left out.
CAVITY = rect(-1, 1, 0, 1) | rect(-1, 0, -1, 1)
EIGHTH = sp.pi / 8
RINGS = plane(9 - x**2 - y**2) & plane(x**2 + y**2 - 1) & plane(y) & plane(x - y)
CURVED = RINGS & (plane(x**2 + y**2 - 4) | plane(sp.cos(EIGHTH) * y - sp.sin(EIGHTH) * x))
# A square foot of side 1 under a half disc of radius 3/2.
MUSHROOM = plane(9 * HALF**2 - x**2 - y**2) & plane(y + 1) & (plane(y) | (plane(HALF - x) & plane(HALF + x)))


@cache
def cavity(shape):
    return rsym.modes(shape, 6, rsym.neumann(), cells=48, degree=6).values[1:]


@cache
def motz():
    """The coefficients of u about the point where conditions change."""
    box = named(-1, 1, 0, 1)
    given = {
        "right": 500,
        "left": rsym.neumann(),
        "top": rsym.neumann(),
        "bottom": rsym.switched(-x, 0, rsym.neumann()),
    }
    u = rsym.solve(box, HEAT, given, cells=32, degree=6)
    # u = sum of a_k r**(k - 1/2) cos(k - 1/2) theta: fitted on a half circle.
    angle = np.linspace(0.1, 3, 60)
    r, k = 0.5, np.arange(12) + 0.5
    table = r**k * np.cos(np.outer(angle, k))
    return np.linalg.lstsq(table, u(r * np.cos(angle), r * np.sin(angle)), rcond=None)[0]


def corner():
    """The harmonic function that is x**2 on the boundary of an L, near its corner that points inwards."""
    ell = plane(x) & plane(y) & plane(2 - x) & plane(2 - y) & (plane(1 - x) | plane(1 - y))
    return rsym.solve(ell, HEAT, x**2, cells=40, degree=6)(0.99, 0.99)


def kirsch():
    plate = plane(x).named("left") & plane(y).named("below") & plane(10 - x).named("pulled") & plane(10 - y)
    given = {"left": rsym.roller(), "below": rsym.roller(), "pulled": rsym.traction((1, 0))}
    return rsym.elasticity(plate - rsym.disc(1), given, young=1, poisson=0.3, cells=64, degree=6).stress(0, 1).xx


def membrane():
    """NAFEMS LE1, in metres and megapascals."""
    inner, outer = plane(x**2 / 4 + y**2 - 1), plane(1 - (x / sp.Rational(13, 4)) ** 2 - (y / sp.Rational(11, 4)) ** 2)
    body = inner & outer.named("outer") & plane(x).named("left") & plane(y).named("below")
    given = {"left": rsym.roller(), "below": rsym.roller(), "outer": rsym.pressure(-10)}
    return rsym.elasticity(body, given, young=210e3, poisson=0.3, cells=40, degree=5).stress(2, 0).yy


def conduction():
    """NAFEMS T4: 0.6 m by 1 m, 100 degrees below, losses to the right and above, nothing on the left."""
    box = named(0, sp.Rational(3, 5), 0, 1)
    loss = rsym.robin(sp.Rational(750, 52), 0)
    given = {"bottom": 100, "right": loss, "top": loss}
    return rsym.solve(box, HEAT, given, cells=40, degree=5)(0.6, 0.2)


def cylinder():
    """NAFEMS, a hollow cylinder: 0 outside and on both ends, 500 kW/m**2 into the middle of the bore, 52 W/(m K)."""
    height = sp.Rational(7, 50)
    body = plane(sp.Rational(1, 10) - x) & plane(x - sp.Rational(1, 50)).named("bore") & plane(y) & plane(height - y)
    middle = (y - height * 2 / 7) * (height * 5 / 7 - y)
    heated = rsym.switched(middle, rsym.neumann(sp.Rational(500000, 52)), rsym.neumann())
    return rsym.solve(body, HEAT, {"bore": heated, ...: 0}, axis=y, cells=40, degree=5)(0.04, 0.04)


def cook():
    """Cook's membrane, plane stress: how far the middle of its right side goes up."""
    corners = [(0, 0), (48, 44), (48, 60), (0, 44)]
    sides = []
    for (a, b), (c, d) in zip(corners, corners[1:] + corners[:1], strict=True):
        sides.append(plane((c - a) * (y - b) - (d - b) * (x - a)))
    body = sides[0] & sides[1].named("pulled") & sides[2] & sides[3].named("wall")
    given = {"wall": rsym.fixed(), "pulled": rsym.traction((0, sp.Rational(1, 16)))}
    return rsym.elasticity(body, given, young=1, poisson=sp.Rational(1, 3), cells=48, degree=5).displacement(48, 52)[1]


def bar(cells=400):
    """SIAM's hundred digits, problem 10."""
    return rsym.solve(named(-5, 5, -HALF, HALF), HEAT, {"left": 1, "right": 1, ...: 0}, cells=cells)(0, 0)


def plate():
    return rsym.solve(rsym.rectangle(1, 1), "bilaplacian(u) = 1", rsym.clamped(), cells=24, degree=6)(0, 0)


DAUGE = "Dauge, Benchmark computations for Maxwell equations (2003)"
MOTZ = [(401.162453745234, 2e-8), (87.6559201950879, 1e-7), (17.2379150794468, 2e-6), (-8.0712152596988, 2e-5)]

# What it is, how it is found, the value, a relative error, the source.
TABLE = [
    ("drum, disc", lambda: drum(rsym.disc(1)), 5.783185962946785, 1e-9, "j_0,1 squared: Abramowitz and Stegun (1964)"),
    ("drum, disc, 4th", lambda: drum(rsym.disc(1), 4), 26.374616427163, 1e-7, "j_2,1 squared: the same"),
    (
        "drum, L",
        lambda: drum(ELL, cells=40),
        9.639723844021941,
        1e-8,
        "Fox, Henrici and Moler (1967); Betcke and Trefethen (2005)",
    ),
    ("drum, L, 3rd", lambda: drum(ELL, 3, cells=32), 2 * math.pi**2, 1e-8, "sin pi x sin pi y: the same"),
    (
        "drum, hexagon",
        lambda: drum(rsym.regular_polygon(6, 1), cells=24),
        7.155339133925,
        1e-8,
        "Jones (1993); Cureton and Kuttler (1999)",
    ),
    (
        "drum, equilateral",
        lambda: drum(rsym.polygon([(0, 0), (1, 0), (HALF, sp.sqrt(3) / 2)]), cells=24),
        16 * math.pi**2 / 3,
        1e-9,
        "Lame (1833)",
    ),
    ("drum, half disc", lambda: drum(rsym.disc(1) & plane(x), cells=24), 3.831705970207512**2, 1e-8, "j_1,1 squared"),
    ("drums of one sound", lambda: drum(rsym.polygon(FIRST), cells=40), 2.537943999798, 2e-7, "Driscoll (1997)"),
    ("drum, mushroom", lambda: drum(MUSHROOM, cells=40, degree=5), 5.497868889097, 2e-9, "Barnett and Betcke (2007)"),
    *(
        (f"cavity, L, {k + 1}", lambda k=k: cavity(CAVITY)[k], value, 2e-10, DAUGE)
        for k, value in enumerate([1.47562182408, 3.53403136678, 9.86960440109, 9.86960440109, 11.3894793979])
    ),
    *(
        (f"cavity, curved L, {k + 1}", lambda k=k: cavity(CURVED)[k], value, 2e-9, DAUGE)
        for k, value in enumerate([1.81857115231, 3.49057623279, 10.0656015004, 10.1118862307, 12.4355372484])
    ),
    ("drum, ball", lambda: drum(rsym.sphere(1), cells=8), math.pi**2, 1e-8, "sin(pi r)/r"),
    (
        "plate drum, disc",
        lambda: rsym.modes(rsym.disc(1), 1, rsym.clamped(), equation="bilaplacian(u) = 0", cells=12).values[0],
        104.3631055588,
        1e-8,
        "Leissa (1969)",
    ),
    (
        "torsion, square",
        lambda: float(rsym.torsion(rsym.rectangle(1, 1))),
        0.140577014955155,
        1e-8,
        "de Saint-Venant (1855); Timoshenko and Goodier (1951)",
    ),
    (
        "torsion, L",
        lambda: float(rsym.torsion(ELL, cells=48)),
        0.856303208882184,
        1e-8,
        "Bammer: 4 * 0.214075802220546",
    ),
    (
        "torsion, ellipse",
        lambda: float(rsym.torsion(rsym.ellipse(2, 1), cells=8)),
        8 * math.pi / 5,
        1e-9,
        "de Saint-Venant (1855)",
    ),
    (
        "torsion, triangle",
        lambda: float(rsym.torsion(rsym.polygon([(0, 0), (1, 0), (HALF, sp.sqrt(3) / 2)]), cells=16)),
        math.sqrt(3) / 80,
        1e-8,
        "de Saint-Venant (1855)",
    ),
    ("clamped square, middle", plate, 0.00126531908, 1e-7, "Taylor and Govindjee (2004)"),
    *(
        (f"Motz, {k + 1}", lambda k=k: motz()[k], value, error, "Georgiou, Olson and Smyrlis (1996); Li and Lu (2000)")
        for k, (value, error) in enumerate(MOTZ)
    ),
    (
        "bar of Brownian motion",
        bar,
        3.8375879792512e-7,
        3e-4,
        "Bornemann and others, The SIAM 100-digit challenge (2004)",
    ),
    ("L, near its corner", corner, 1.0267919261073, 1e-6, "Trefethen, NA Digest (2018); Gopal and Trefethen (2019)"),
    ("NAFEMS LE1", membrane, 92.7, 1e-3, "NAFEMS, The standard NAFEMS benchmarks (1990)"),
    ("NAFEMS T4", conduction, 18.25, 1e-3, "NAFEMS, the same"),
    ("NAFEMS, hollow cylinder", cylinder, 59.82, 1e-4, "NAFEMS, Benchmark tests for thermal analyses (1986)"),
    ("Cook's membrane", cook, 23.96, 1e-3, "Cook (1974); 23.96 in Simo and Rifai (1990)"),
    ("Kirsch's hole, wide plate", kirsch, 3.0, 0.03, "Kirsch (1898), of an endless plate"),
]


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::rsym.RsymWarning")
@pytest.mark.parametrize(("found", "value", "error"), [row[1:4] for row in TABLE], ids=[row[0] for row in TABLE])
def test_published(found, value, error):
    assert found() == pytest.approx(value, rel=error)


def test_all_have_sources():
    assert len(TABLE) >= 36
    assert all(row[4] for row in TABLE)
