"""Shapes made to deceive `verify_smoothness`: each broke a step of the proof once, or was meant to."""

import math

import pytest
import sympy as sp
from oracles.closeness import assert_close
from sympy import Abs, Max, Min, Piecewise, sqrt

import rsym
from rsym import R1, RAlpha, Shape, conjunction, disjunction, x, y, z

DISC = 1 - x**2 - y**2
CUSP = (-x - 1) ** 3 + 3 * x**2 + 3 * x + 1 - y**2  # (-x)**3 - y**2 with wide enclosures
WIDE = ((-2, 2), (-2, 2))
NOT_SMOOTH = {"REFUTED", "UNDECIDED", "DEGENERATE"}
SMOOTH = {"CERTIFIED", "UNDECIDED"}
SPACE = ((-1, 1),) * 3


def verdict(omega, bounds=WIDE, **options):
    coordinates = (x, y) if len(bounds) == 2 else (x, y, z)
    return rsym.verify_smoothness(Shape(omega, coordinates, bounds=bounds), budget=3000, **options).verdict


@pytest.mark.random
@pytest.mark.parametrize(
    ("omega", "bounds"),
    [
        # The boundary breaks off: two arcs, of which only one ends in the point.
        (Piecewise((y, x > 0), (y - 1, True)), WIDE),
        (y + sp.sign(x - sp.Rational(1, 3)) / 8, WIDE),
        (Piecewise((y + 0.18, x > 0), (y + 0.2, True)), ((-1, 1), (-1, -0.19))),
        (Piecewise((DISC, x > 0)), WIDE),
        # What drops is not defined everywhere.
        (DISC * (2 + sqrt(x)), WIDE),
        (DISC * ((x - 5) ** 2 + y**2 + sqrt(y)), WIDE),
        (DISC / sqrt(DISC**2 + sqrt(x)), WIDE),
        (DISC + sp.atan2(y, x) / 10, WIDE),
        # A defect that 25 digits do not show, and one that a smooth joint nearby could hide.
        (y - sp.Rational(1, 10**90) * Abs(x) - Abs(x) ** 3, WIDE),
        (y - Abs(x) ** 3 - Abs(x - sp.Rational(1, 10**6)) / 10**6, WIDE),
        (y - Abs(x) ** sp.Rational(19999999, 10000000), WIDE),
        # Several operations that are not smooth vanish together.
        (conjunction(x, y, x + y), WIDE),
        (conjunction(x, y) ** 3 * (x**2 + y**2), WIDE),
        (1 - sp.exp(-conjunction(x, y)), WIDE),
        (y + conjunction(x, y) / 2, WIDE),
        (conjunction(x, y, system=RAlpha(1)), WIDE),
        # The bounds of a body reach farther from the axis than to their sides.
        (conjunction(sp.Rational(36, 25) - y**2 - z**2, sp.Rational(1, 4) - x**2), SPACE),
        (1 - x**2 - sqrt(y**2 + z**2), SPACE),
    ],
)
def test_what_is_not_smooth_is_not_certified(omega, bounds):
    assert verdict(omega, bounds) in NOT_SMOOTH


@pytest.mark.random
@pytest.mark.parametrize(
    ("omega", "bounds"),
    [
        # Defects beside the bounds are none of ours.
        (conjunction(-x - 0.001, x + y / 10 - 0.001), ((-1, 1), (0.03, 1))),
        (y**2 - x**3, ((1e-7, 1), (-1, 1))),
        # Singular points of an operand where it does not make the boundary.
        (disjunction(CUSP, -x), WIDE),
        (disjunction(CUSP, -x, system=R1), WIDE),
        (-conjunction(-CUSP, x), WIDE),
        # Kinks that cancel, or that are flat enough.
        (disjunction(conjunction(x, y), x), WIDE),
        (conjunction(x, y) + disjunction(x, y), WIDE),
        (Max(x, y) + Min(x, y), WIDE),
        (y - sqrt(x**6), WIDE),
        (y - sp.cos(Abs(x)), WIDE),
        (y - Abs(x) ** sp.Rational(7, 3), WIDE),
        (disjunction(DISC, 4 - (x + 1) ** 2 - y**2), ((-4, 3), (-3, 3))),
        # Branches so near each other, or parts so small, that numbers do not tell them apart.
        (x**2 - y**2 - sp.Rational(1, 10**30), WIDE),
        ((x**2 + y**2) ** 2 - x**2 + y**2 + sp.Rational(1, 10**40), WIDE),
        (disjunction(DISC, sp.Rational(1, 10**18) - (x - 1.5) ** 2 - (y - 0.3) ** 2), WIDE),
        (y - sqrt(x**2 + sp.Rational(1, 10**100)), WIDE),
        (x + y - sqrt(x**2 + y**2 + sp.Rational(1, 10**40)), WIDE),
    ],
)
def test_what_is_smooth_is_not_refuted(omega, bounds):
    assert verdict(omega, bounds) in SMOOTH


@pytest.mark.random
@pytest.mark.parametrize("scale", [1e-100, 1e-6, 1e6, 1e100])
def test_the_scales_of_omega_and_of_space_do_not_matter(scale):
    r = sp.Rational(scale)
    far = ((-2 * scale, 2 * scale),) * 2
    assert verdict(r * DISC) == verdict(r**2 - x**2 - y**2, far) == "CERTIFIED"
    assert verdict(r * conjunction(DISC, x)) == verdict(conjunction(r**2 - x**2 - y**2, x), far) == "REFUTED"


def test_an_extrusion_is_no_body_of_revolution():
    edges = conjunction(DISC, y + sp.Rational(1, 2))
    with pytest.raises(rsym.RsymError, match="body of revolution"):
        rsym.verify_smoothness(Shape(edges, (x, y, z), bounds=SPACE), method="meridian")
    assert verdict(edges, SPACE) == "REFUTED"  # judged in space
    assert verdict(DISC, ((-2, 2),) * 3) == "CERTIFIED"


@pytest.mark.slow
def test_a_letter_that_ranges_may_be_a_parameter_or_move_the_boundary():
    a = sp.Symbol("a", real=True)
    for omega in (conjunction(x, y) - a, conjunction(x, y, system=RAlpha(a)) - 0.1, DISC + a):
        shape = Shape(omega, (x, y), letters={a: 0.5}, bounds=WIDE)
        assert rsym.verify_smoothness(shape, letters={"a": (0.25, 0.75)}, budget=3000).verdict in SMOOTH
    kinked = Shape(y - a * Abs(x) - Abs(x) ** 3, (x, y), letters={a: 0}, bounds=WIDE)
    assert rsym.verify_smoothness(kinked, letters={"a": (0, 1e-30)}, budget=3000).verdict in NOT_SMOOTH


def test_the_curvature_across_a_meridian_is_bounded():
    a, b = sp.Rational(1, 2), 1
    ellipsoid = rsym.revolve(Shape(1 - (x / a) ** 2 - (y / b) ** 2, (x, y), bounds=((-1, 1), (-1.5, 1.5))))
    assert 4 <= rsym.verify_smoothness(ellipsoid).curvature_bound < 4.4
    torus = rsym.revolve(Shape(1 - x**2 - (Abs(y) - 1.25) ** 2, (x, y), bounds=((-2, 2), (-3, 3))))
    assert 4 <= rsym.verify_smoothness(torus).curvature_bound < 4.4
    assert rsym.verify_smoothness(rsym.revolve(Shape(1 - Abs(y) - x**2, (x, y), bounds=WIDE))).curvature_bound > 1e9


@pytest.mark.parametrize("bounds", [((-1.3, 1.3), (-1.1, 1.2)), ((-2, 2), (-2, 2)), ((-1, 1), (-1.2, 1.2))])
def test_a_joint_first_enclosed_in_a_wide_box_is_located_all_the_same(bounds):
    omega = 3 * x / 2 - y - Max(0, 1 - 3 * x**2 / 2 - 2 * (y - sp.Rational(1, 2)) ** 2) - sp.Rational(1, 4)
    report = rsym.verify_smoothness(Shape(omega, (x, y), bounds=bounds))
    expected = [(9 + 10 * sign * math.sqrt(0.69)) / 24 for sign in (-1, 1)]  # 6 x**2 - 4.5 x + 1/8 = 0
    assert_close(sorted(joint.point[0] for joint in report.defects), expected, atol=1e-14)
    assert max(joint.radius for joint in report.defects) < 1e-14
