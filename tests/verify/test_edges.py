"""Where a root ends: the nose of an airfoil, and what else is written with sqrt(x) at x = 0."""

import pytest
import sympy as sp
from oracles.closeness import assert_close

import rsym
from rsym import conjunction, disjunction, x, y

R = sp.Rational
root, disc = sp.sqrt(x), sp.sqrt(1 - x**2)
BOX = ((R(-3, 2), R(3, 2)),) * 2


def verdict(omega, bounds=BOX, **options):
    return rsym.verify_smoothness(rsym.Shape(omega, (x, y), bounds=bounds), **options)


def between(half, middle=0):
    """What lies between two curves y = middle +- half."""
    return conjunction(half - y + middle, half + y - middle)


@pytest.mark.random
@pytest.mark.parametrize(
    ("omega", "continuity"),
    [
        (between(root), "analytic"),  # x = y**2
        (between(root, x**2), "analytic"),  # y = t**4 +- t
        (between(root + x * root), "analytic"),
        (between(root - x / 3), "G2"),  # x = y**2 + 2/3 |y|**3 + ...
        (between(disc), "analytic"),
        (between(disc * (1 + x / 2)), "analytic"),
        (between(root * sp.sqrt(1 - x) * (1 + x / 2)), "analytic"),
        ((root * sp.sqrt(1 - x)) ** 2 - y**2, "analytic"),
        (conjunction(between(sp.sqrt(sp.Max(x, 0)) - x / 4), x), "G2"),
    ],
)
def test_a_nose_is_as_smooth_as_its_two_halves(omega, continuity):
    report = verdict(omega)
    assert (report.verdict, report.continuity) == ("CERTIFIED", continuity)


def test_the_nose_of_a_naca_profile_has_a_jump_in_the_slope_of_its_curvature():
    """x = y**2/a**2 + 2 b/a**4 |y|**3 + ...: curvature 2/a**2 on both sides, its derivatives +-12 b/a**4."""
    a, b, c = R(178, 100), R(76, 100), R(2, 10)
    report = verdict(between(a * root - b * x - c * x**2), ((-R(1, 2), R(1, 2)), (-1, 1)))
    (joint,) = report.joints
    assert (report.verdict, report.continuity, joint.proved) == ("CERTIFIED", "G2", True)
    assert_close(joint.curvatures, (float(2 / a**2),) * 2, atol=1e-12)
    assert_close(joint.derivative_jump, float(24 * b / a**4), atol=1e-12)


@pytest.mark.parametrize(
    ("omega", "kind", "jump"),
    [
        (conjunction(root - y, 2 * root + y), "curvature jump", 1.5),  # 2 above, 2/4 below
        (conjunction(root - y, y - root / 2), "cusp", 10.0),  # convex 2 and concave 8
    ],
)
def test_two_halves_of_a_nose_that_do_not_fit(omega, kind, jump):
    (joint,) = verdict(omega).defects
    assert (joint.kind, joint.proved) == (kind, True)
    assert_close(joint.curvature_jump, jump, atol=1e-12)


@pytest.mark.parametrize(
    ("omega", "kind"),
    [
        (root - y, "end"),
        (conjunction(y - root, -y - root), "isolated point"),
        (between(sp.sqrt(abs(x))), "node"),  # x = y**2 and x = -y**2
    ],
)
def test_no_curve_where_a_root_ends(omega, kind):
    report = verdict(omega)
    (defect,) = report.defects
    assert (report.verdict, defect.kind, defect.point, defect.proved) == ("DEGENERATE", kind, (0.0, 0.0), True)


@pytest.mark.slow
@pytest.mark.parametrize(
    "omega",
    [
        disjunction(y - root, -y - root),  # the inside is beside the nose, and omega has no value before it
        between(sp.sqrt(sp.Max(x, 0))),  # for x < 0 it is zero on the axis
        (1 - x**2 - y**2) * (2 + root),  # half of a circle
    ],
)
def test_nothing_is_certified_that_is_no_nose(omega):
    assert verdict(omega, budget=300).verdict in {"UNDECIDED", "DEGENERATE"}


@pytest.mark.slow
def test_a_nose_that_is_moved_and_turned():
    shape = rsym.Shape(between(root * sp.sqrt(1 - x) * (1 + x / 2)), (x, y), bounds=BOX)
    moved = shape.translate((R(-1, 2), R(1, 10))).rotate(sp.pi / 6)
    report = rsym.verify_smoothness(moved)
    assert (report.verdict, report.continuity) == ("CERTIFIED", "analytic")
    profile = rsym.Shape(between(root - x / 3), (x, y), bounds=((-1, 1), (-1, 1))).rotate(sp.pi / 7)
    report = rsym.verify_smoothness(profile, bounds=((-R(1, 2), R(1, 2)),) * 2)
    assert (report.verdict, report.continuity) == ("CERTIFIED", "G2")


def test_a_body_of_revolution_with_a_nose():
    """r**2 = x (1 - x) (1 + x/2)**2, a polynomial."""
    profile = rsym.Shape(root * sp.sqrt(1 - x) * (1 + x / 2) - y, (x, y), bounds=BOX)
    assert rsym.verify_smoothness(rsym.revolve(profile)).continuity == "analytic"
