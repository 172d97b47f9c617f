"""Singular points of plane curves: normal forms, rational motions of them, random products, known counts."""

import math
import random

import mpmath as mp
import pytest
import sympy as sp
from oracles.closeness import assert_close

from rsym.verify.points.newton_polygon import classify_polynomial, half_branches
from rsym.verify.points.probing import Sample, classify

x, y = sp.symbols("x y", real=True)
R = sp.Rational
NORMAL_FORMS = {
    "A1": (x**2 - y**2, "node", 4, "broken"),
    "A1*": (x**2 + y**2, "isolated point", 0, "broken"),
    "A2": (y**2 - x**3, "cusp", 2, "G0"),
    "A3": (y**2 - x**4, "node", 4, "broken"),
    "A3*": (y**2 + x**4, "isolated point", 0, "broken"),
    "A4": (y**2 - x**5, "cusp", 2, "G0"),
    "A7": (y**2 - x**8, "node", 4, "broken"),
    "A8": (x**9 - y**2, "cusp", 2, "G0"),
    "D4": (x * (x**2 - y**2), "node", 6, "broken"),
    "D4*": (x * (x**2 + y**2), "smooth joint", 2, "analytic"),
    "D5": (x * (y**2 - x**3), "node", 4, "broken"),
    "E6": (y**3 - x**4, "unbounded curvature", 2, "G1"),
    "E7": (y * (y**2 - x**3), "node", 4, "broken"),
    "E8": (y**3 - x**5, "unbounded curvature", 2, "G1"),
    "E12": (y**3 - x**7, "smooth joint", 2, "G2"),
    "E18": (y**3 - x**10, "smooth joint", 2, "G3"),
    "rhamphoid": ((y - x**2) ** 2 - x**5, "cusp", 2, "G0"),
    "bent": ((y - x**2) ** 3 - x**7, "smooth joint", 2, "G2"),
    "bent more": ((y - x - x**2) ** 3 - x**5, "unbounded curvature", 2, "G1"),
    "cubed": ((y - x**2) ** 3, "smooth joint", 2, "analytic"),
    "squared": ((y - x**2) ** 2, "no sign change", 2, "broken"),
    "one squared": (y * (y - x) ** 2, "node", 4, "broken"),
    "irrational cone": (y**2 - 2 * x**2 + x**3, "node", 4, "broken"),
    "irrational slope": (y**3 - 2 * x**3 + x**4, "smooth joint", 2, "analytic"),
    "quartic cross": (x**4 - 5 * x**2 * y**2 + 6 * y**4 + x**5, "node", 8, "broken"),
    "definite": (x**4 + x**2 * y**2 + y**4 - x**5, "isolated point", 0, "broken"),
    "tacnode bent": ((y - x**2) * (y - x**2 - x**7), "node", 4, "broken"),
    "two pairs": ((y - 2 * x**3) ** 4 - 2 * x**13, "cusp", 2, "G0"),
}


def moved(form):
    """Rotated by the angle with sine 4/5 and moved to (1/3, -2)."""
    u, v = x - R(1, 3), y + 2
    turned = {x: (3 * u + 4 * v) / 5, y: (-4 * u + 3 * v) / 5}
    return form.subs(turned, simultaneous=True)


def numerically(form, point):
    derivatives = [sp.diff(form, *by) for by in ((x,), (y,), (x, x), (x, y), (y, y))]
    value, *rest = (sp.lambdify((x, y), f, "mpmath", cse=True) for f in (form, *derivatives))

    def field(a, b):
        numbers = [f(a, b) + mp.mpf(0) for f in rest]
        return Sample(value(a, b), tuple(numbers[:2]), tuple(numbers[2:]))

    with mp.workdps(60):
        centre = tuple(mp.mpf(int(c.p)) / int(c.q) for c in map(sp.Rational, point))
    return classify(field, centre, 0.0, digits=40, value=value)


@pytest.mark.random
@pytest.mark.parametrize("name", NORMAL_FORMS)
@pytest.mark.parametrize("motion", ["as it stands", "exchanged", "moved"])
def test_normal_forms(name, motion):
    form, kind, branches, continuity = NORMAL_FORMS[name]
    point = (0, 0)
    if motion == "exchanged":
        form = form.subs({x: y, y: x}, simultaneous=True)
    elif motion == "moved":
        form, point = sp.expand(moved(form)), (R(1, 3), -2)
    joint = classify_polynomial(form, (x, y), point)
    assert (joint.kind, joint.branches, joint.continuity, joint.proved) == (kind, branches, continuity, True)
    if kind in ("cusp", "smooth joint", "unbounded curvature"):
        assert joint.tangent_jump == (180 if kind == "cusp" else 0)


@pytest.mark.random
@pytest.mark.parametrize("name", ["A2", "A1*", "E8", "rhamphoid", "one squared"])
def test_the_numerical_classification_agrees(name):
    form, point = moved(NORMAL_FORMS[name][0]), (R(1, 3), -2)
    proved, found = classify_polynomial(form, (x, y), point), numerically(form, point)
    assert (found.kind, found.branches) == (proved.kind, proved.branches)
    assert found.continuity == proved.continuity.replace("analytic", "G3")
    finite = [not math.isnan(k) and math.isfinite(k) for k in proved.curvatures]
    assert finite == [not math.isnan(k) and math.isfinite(k) for k in found.curvatures]
    if all(finite):
        assert_close(found.curvatures, proved.curvatures, atol=1e-9)


@pytest.mark.parametrize("sign", [1, -1])
def test_curvature_is_positive_where_the_inside_is_convex(sign):
    for form, curvature in [(1 - x**2 - y**2, 1), (4 - x**2 - y**2, 0.5), (25 - (3 * x + 4 * y) ** 2, 0)]:
        radius = sp.sqrt(form.subs({x: 0, y: 0}))
        for direction in [(R(3, 5), R(4, 5)), (1, 0), (0, -1)]:
            point = [radius * c for c in direction]
            if form.subs(dict(zip((x, y), point, strict=True))) == 0:
                # (x - 9)^3 is negative here, the even power counts for nothing.
                joint = classify_polynomial(-sign * (x - 9) ** 3 * (y - 9) ** 2 * form, (x, y), point)
                assert joint.continuity == "analytic"
                assert_close(joint.curvatures, [sign * curvature] * 2, atol=1e-15)


@pytest.mark.slow
def test_random_products_of_smooth_branches():
    rng = random.Random(4)
    for _ in range(10):
        number = rng.randint(1, 4)
        bends = rng.sample([(s, b) for s in range(-2, 3) for b in (-3, -1, R(1, 2), 2)], number)
        branches = [y - s * x - b * x**2 + rng.randint(-2, 2) * x**3 for s, b in bends]
        definite = [1 + x, 2 - y + x * y, x**2 + 3 * y**2 + x**3][: rng.randint(0, 3)]
        joint = classify_polynomial(moved(sp.Mul(*branches, *definite)), (x, y), (R(1, 3), -2))
        assert joint.branches == 2 * number
        if number == 1:
            slope, bend = bends[0]
            assert joint.continuity == "analytic"
            assert_close(abs(joint.curvatures[0]), float(2 * abs(bend) / (1 + slope**2) ** 1.5), rtol=1e-12)
        else:
            assert joint.kind == "node"


@pytest.mark.parametrize("n", range(3, 9))
@pytest.mark.parametrize("m", range(2, 6))
def test_coprime_powers_have_two_half_branches_and_others_what_their_factors_have(n, m):
    """y^m = x^n is (t^m, t^n) if m and n are coprime, else as many of that kind as it has real factors."""
    divisor = math.gcd(m, n)
    a, b = m // divisor, n // divisor
    # Real factors y^a = +- x^b; the one with the minus sign is real if the divisor is even.
    expected = 2 if divisor % 2 else (4 if a % 2 or b % 2 else 8)
    assert len(half_branches(sp.Poly(y**m - x**n, x, y, domain=sp.QQ))) == expected


@pytest.mark.parametrize(
    ("form", "point"),
    [
        ((y**2 - 2 * x**2) ** 2 - x**7, (0, 0)),
        (moved((y**2 - x**3) ** 2 - x**7 * y), (R(1, 3), -2)),
        (1 + x, (0, 0)),
        (sp.sqrt(2) * x + y, (0, 0)),
        (sp.Abs(x) - y, (0, 0)),
        (sp.Integer(0), (0, 0)),
        (x - sp.Symbol("a") * y, (0, 0)),
    ],
)
def test_what_is_not_proved_is_not_claimed(form, point):
    assert classify_polynomial(form, (x, y), point) is None


def test_the_curvatures_of_a_rhamphoid_cusp_have_the_signs_of_its_sides():
    joint = classify_polynomial((y - x**2) ** 2 - x**5, (x, y), (0, 0))
    outside = classify_polynomial(x**5 - (y - x**2) ** 2, (x, y), (0, 0))
    assert joint.curvatures == (-2, 2)
    assert outside.curvatures == (-2, 2)
    assert joint.curvature_jump == 4


def test_a_power_series_after_a_fractional_exponent_is_not_smooth():
    pair = ((y - x**2) ** 2 - x**3) * ((y - 2 * x**2) ** 2 - x**3)
    found = half_branches(sp.Poly(pair, x, y, domain=sp.QQ))
    assert sorted(branch.terms[:2] for branch in found) == [
        ((R(3, 2), sign), (2, bend)) for sign in (-1, 1) for bend in (1, 2)
    ]
    assert not any(branch.smooth for branch in found)
