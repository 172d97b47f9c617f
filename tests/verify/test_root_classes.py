"""Leaves with roots whose squares vanish on an axis: their class there, and the jump where it is 1."""

import math

import pytest
import sympy as sp

import rsym
from rsym import x, y, z

R = sp.sqrt(x**2 + y**2)
THIRD = sp.Rational(1, 3)


def body(expression):
    return rsym.Shape(expression, (x, y, z), bounds=((-1, 1),) * 3)


def plane(expression):
    return rsym.Shape(expression, (x, y), bounds=((-1, 1),) * 2)


@pytest.mark.random
@pytest.mark.parametrize(
    "second",
    [
        x * y * R,
        R**3,
        x**2 * R,
        (x**2 - 3 * y**2) * R * (2 + z),
        sp.sin(x * y) * R + x,
        x * y * (x**2 + y**2) ** sp.Rational(1, 4),
        x * (x + y) * sp.sqrt(x**2 + x * y + 2 * y**2),
        abs(x) ** sp.Rational(5, 2),
        abs(x + y) ** sp.Rational(7, 3),
    ],
)
def test_a_graph_with_a_homogeneous_term_of_degree_above_two_is_g2(second):
    report = rsym.verify_smoothness(body(z - second), method="space")
    assert (report.verdict, report.continuity) == ("CERTIFIED", "G2")


@pytest.mark.random
@pytest.mark.parametrize(
    ("second", "point", "jump"),
    [
        (x * R, (0, 0, 0), 4),
        (3 * y * R - x, (0, 0, 0), None),
        ((x - THIRD) * sp.sqrt((x - THIRD) ** 2 + y**2), (1 / 3, 0, 0), 4),
        (x * sp.sqrt(x**2 + x * y + 2 * y**2), (0, 0, 0), 4),
        (sp.sin(x * R), (0, 0, 0), 4),
        (x * sp.sin(R), (0, 0, 0), 4),
        ((x + z) * sp.sqrt(x**2 + y**2 + z**2), (0, 0, 0), 4),
    ],
)
def test_a_graph_with_a_homogeneous_term_of_degree_two_is_g1(second, point, jump):
    """z = x r: along the x axis z = x|x|, whose second derivatives are 2 and -2."""
    report = rsym.verify_smoothness(body(z - second), method="space")
    assert (report.verdict, report.continuity) == ("REFUTED", "G1")
    (found,) = report.points
    assert found.kind == "curvature jump"
    assert found.point == pytest.approx(point, abs=1e-12)
    assert jump is None or found.reason.endswith(f"differ by {jump:.4g}")


@pytest.mark.random
@pytest.mark.parametrize(
    ("second", "expected"),
    [(x * R, ("REFUTED", "G1")), (x**2 * R, ("CERTIFIED", "G2")), (R**3, ("CERTIFIED", "G2")), (R, ("REFUTED", "G0"))],
)
def test_the_same_in_the_plane(second, expected):
    report = rsym.verify_smoothness(plane(y - second / 2))
    assert (report.verdict, report.continuity) == expected


@pytest.mark.slow
@pytest.mark.parametrize(
    "expression",
    [
        z - x * y * R + R / 9,  # a cone
        z - x * (x**2 + y**2) ** sp.Rational(1, 4),  # of class 1 alone
        z - (x**2 + y**2) ** sp.Rational(3, 4),
        z - x * sp.sqrt(x**4 + y**2),  # not homogeneous: second derivatives along y = 0 jump
        z - abs(x) ** sp.Rational(3, 2),
        z - x * abs(x),
    ],
)
def test_less_is_never_certified(expression):
    assert rsym.verify_smoothness(body(expression), method="space").verdict != "CERTIFIED"


@pytest.mark.slow
@pytest.mark.parametrize(
    "second", [x * y * sp.cos(R), R * sp.sin(R), (x**2 + y**2) ** 2, x * R - (x - y) * R - y * R, z * R / 2, z * x * R]
)
def test_what_is_analytic_is_never_refuted(second):
    assert rsym.verify_smoothness(body(z - second), method="space").verdict in {"CERTIFIED", "UNDECIDED"}


HALVES = sp.Rational(3, 2)


@pytest.mark.parametrize(
    ("omega", "where"),
    [
        (1 - y - abs(x) ** HALVES, (0, 1)),
        (1 - y - (x**2) ** sp.Rational(199, 200), (0, 1)),
        (1 - y - abs(x - sp.sqrt(2)) ** HALVES, (math.sqrt(2), 1)),
        (1 - y - abs(x - y**2) ** HALVES, (1, 1)),
        (1 - y - abs(x) ** HALVES + abs(x) ** sp.Rational(5, 2), (0, 1)),
        (1 - y - x * sp.sqrt(abs(x)) / 10**9, (0, 1)),
        (1 - z - (x**2 + y**2) ** sp.Rational(3, 4), (1, 0)),  # (axis, radius)
    ],
    ids=str,
)
def test_a_power_below_two_of_the_distance_bends_without_bound(omega, where):
    coordinates = (x, y, z) if omega.has(z) else (x, y)
    report = rsym.verify_smoothness(rsym.Shape(omega, coordinates, bounds=((-2, 2),) * len(coordinates)))
    assert (report.verdict, report.continuity) == ("REFUTED", "G1")
    bent = [defect for defect in report.defects if defect.kind == "unbounded curvature" and defect.proved]
    assert any(math.dist(defect.point, where) <= defect.radius + 1e-12 for defect in bent)


@pytest.mark.parametrize(
    ("omega", "verdict"),
    [
        (1 - y - abs(x) ** sp.Rational(201, 100), "CERTIFIED"),
        (1 - y - x * abs(x) ** HALVES, "CERTIFIED"),
        (1 - y - (1 - y) * abs(x) ** HALVES, "UNDECIDED"),  # the plane y = 1, and more
        (1 - y - abs(x) ** HALVES + (1 - x) * abs(x) ** HALVES, "UNDECIDED"),  # of order 5/2
        (1 - y - abs(x) ** HALVES + abs(sp.sin(x)) ** HALVES, "UNDECIDED"),  # of order 7/2
    ],
    ids=str,
)
def test_a_power_that_bends_nothing_without_bound_is_not_refuted(omega, verdict):
    report = rsym.verify_smoothness(rsym.Shape(omega, (x, y), bounds=((-0.5, 0.75), (-2, 2))))
    assert report.verdict == verdict
