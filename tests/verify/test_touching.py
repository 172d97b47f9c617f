"""Leaves that have a face in common, absorb each other, or touch: what is proved of the boundary that they make."""

import pytest
import sympy as sp
from oracles.tiers import of_the_day

import rsym
from rsym import conjunction, disjunction, x, y, z

DISC = 1 - x**2 - y**2


def plane(expression, reach=2):
    return rsym.Shape(expression, (x, y), bounds=((-reach, reach),) * 2)


def body(expression, reach=2):
    return rsym.Shape(expression, (x, y, z), bounds=((-reach, reach),) * 3)


def word(report):
    return report.verdict, report.continuity


# --- absorption in the plane: x and (x or y) is x -------------------------------------------------------------------


@pytest.mark.random
@pytest.mark.parametrize(
    "expression",
    [
        conjunction(x, disjunction(x, y)),
        disjunction(x, conjunction(x, y)),
        conjunction(DISC, disjunction(DISC, x - y)),
        disjunction(conjunction(DISC, y), DISC),
        -disjunction(-DISC, conjunction(-DISC, x)),
    ],
)
def test_what_the_logic_absorbs_leaves_no_corner(expression):
    assert word(rsym.verify_smoothness(plane(expression))) == ("CERTIFIED", "analytic")


@pytest.mark.slow
def test_what_is_not_absorbed_keeps_its_corner():
    report = rsym.verify_smoothness(plane(conjunction(x, disjunction(-x, y))))
    assert report.verdict != "CERTIFIED"


@pytest.mark.slow
@pytest.mark.parametrize("second", [sp.sqrt(y) + 1, sp.log(y) + 9])
def test_a_leaf_that_is_not_absorbed_ends_the_line_with_its_domain(second):
    """For y < 0 true and unknown is unknown, the line x = 0 ends; true or unknown is true, there it goes on."""
    ends, goes_on = conjunction(x, second), conjunction(x, disjunction(x, second))
    assert rsym.verify_smoothness(plane(ends)).verdict != "CERTIFIED"
    assert rsym.verify_smoothness(plane(goes_on)).verdict == "CERTIFIED"


# --- leaves that touch from outside in a point ----------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize(
    ("place", "direction"),
    of_the_day(
        [((0, 0), (sp.Rational(3, 5), sp.Rational(4, 5))), ((sp.Rational(1, 2), sp.Rational(-1, 3)), (1, 0))], 1
    ),
)
def test_curves_that_touch_from_outside(place, direction):
    """n > a t**2 or n < b t**2: four half-branches if a > b, else all but one point; of "and" the other way round."""
    (p, q), (c, s) = place, direction
    n, t = c * (x - p) + s * (y - q), c * (y - q) - s * (x - p)
    for a, b in ((2, -1), (2, 1), (1, 2), (-1, 2)):
        f, g = (n - a * t**2) * sp.exp(x), b * t**2 - n + n * t
        for joined, apart in ((disjunction(f, g), a > b), (conjunction(f, g), a < b)):
            report = rsym.verify_smoothness(
                rsym.Shape(joined, (x, y), bounds=((p - 0.1, p + 0.09), (q - 0.08, q + 0.1)))
            )
            (found,) = report.defects
            assert (report.verdict, found.proved, found.branches) == ("DEGENERATE", True, 4 if apart else 0)
            assert found.kind == ("node" if apart else "isolated point")


def test_discs_and_balls_that_touch():
    first, second = (1 - (x - shift) ** 2 - y**2 for shift in (1, -1))
    assert rsym.verify_smoothness(plane(disjunction(first, second), 3)).verdict == "DEGENERATE"
    assert rsym.verify_smoothness(plane(disjunction(first, -x), 3)).verdict == "DEGENERATE"
    turned = rsym.verify_smoothness(body(disjunction(first - z**2, second - z**2), 3))
    assert (turned.verdict, turned.body) == ("DEGENERATE", True)


# --- the axis of a body of revolution ------------------------------------------------------------------------------


@pytest.mark.parametrize("slope", [1, 2, sp.Rational(1, 3), sp.sqrt(2)])
def test_a_cone_tip_exactly_on_the_axis_is_refuted_by_the_meridian(slope):
    report = rsym.verify_smoothness(body(z - slope * sp.sqrt(x**2 + y**2), 1))
    assert word(report) == ("REFUTED", "G0")
    assert report.defects[0].kind == "corner"
    assert report.defects[0].point == (0, 0)


def test_a_cubed_radius_is_of_class_two_on_the_axis():
    assert word(rsym.verify_smoothness(body(z - sp.sqrt(x**2 + y**2) ** 3, 1))) == ("CERTIFIED", "G2")


# --- sheets that touch along a whole curve ---------------------------------------------------------------------------

BALL = 1 - x**2 - y**2 - z**2
TORUS = 36 * (x**2 + y**2) - (x**2 + y**2 + z**2 + 8) ** 2  # around a circle of radius 3, its tube of radius 1
ROUND = sp.sqrt((sp.sqrt(x**2 + y**2) - 3) ** 2 + z**2)
SPACE = "space"


@pytest.mark.random
@pytest.mark.parametrize(
    ("expression", "reach", "expected"),
    [
        (disjunction(TORUS, 1 - (x - 3) ** 2 - y**2 - z**2), 5, ("CERTIFIED", "analytic")),  # a ball in the tube
        (disjunction(1 - ROUND, 1 - sp.sqrt((x - 3) ** 2 + y**2 + z**2)), 5, ("CERTIFIED", "analytic")),
        (disjunction(TORUS, 16 - x**2 - y**2 - z**2), 5, ("CERTIFIED", "analytic")),  # the tube in a ball
        (conjunction(BALL, BALL * (1 + z**2) + x**2), 2, ("CERTIFIED", "analytic")),
        (conjunction(BALL, BALL * (1 + z**2) - x**2), 2, ("CERTIFIED", "analytic")),
        (conjunction(BALL, BALL + x**3), 2, ("CERTIFIED", "G2")),
        (disjunction(BALL, 2 * BALL - (x + y) ** 3), 2, ("CERTIFIED", "G2")),
        (conjunction(z - x**2, z - x**2 - x**5), 1, ("CERTIFIED", "G3")),
    ],
)
def test_sheets_that_touch_along_a_curve(expression, reach, expected):
    """f and q f + h u**k: for even k one of both is the boundary, for odd k its derivatives of order k jump."""
    assert word(rsym.verify_smoothness(body(expression, reach), method=SPACE)) == expected


def capsule(axis, middle=0, radius=1, half=1):
    """A cylinder and two balls, in three directions: G1, the curvature across the circles jumps by 1/radius."""
    across = [s for s in (x, y, z) if s != axis]
    tube = radius**2 - sum(s**2 for s in across)
    along = axis - middle
    balls = [radius**2 - sum(s**2 for s in across) - (along + end) ** 2 for end in (half, -half)]
    return disjunction(conjunction(tube, half - along, half + along), *balls)


@pytest.mark.slow
@pytest.mark.parametrize("method", ["auto", SPACE])
@pytest.mark.parametrize(("axis", "radius"), [(x, 1), (z, sp.Rational(1, 2))])
def test_a_capsule_as_a_union_of_three(method, axis, radius):
    report = rsym.verify_smoothness(body(capsule(axis, radius=radius), 3), method=method)
    assert word(report) == ("REFUTED", "G1")
    assert len(report.defects) == 2
    assert all(abs(one.curvature_jump - 1 / float(radius)) < 1e-9 for one in report.defects)


@pytest.mark.slow
def test_the_primitives_make_a_capsule_too():
    whole = rsym.cylinder(1, 2)
    for end in (1, -1):
        whole = whole | rsym.sphere(1, (0, 0, end))
    report = rsym.verify_smoothness(whole.replace(bounds=((-3, 3),) * 3), method=SPACE)
    assert word(report) == ("REFUTED", "G1")


def test_a_stadium_as_a_union_of_three():
    strip = conjunction(1 - y**2, 1 - x**2)
    whole = disjunction(strip, 1 - (x - 1) ** 2 - y**2, 1 - (x + 1) ** 2 - y**2)
    report = rsym.verify_smoothness(plane(whole, 3))
    assert word(report) == ("REFUTED", "G1")
    assert sorted((round(a, 9), round(b, 9)) for a, b in (one.point for one in report.defects)) == [
        (-1, -1),
        (-1, 1),
        (1, -1),
        (1, 1),
    ]
    assert {round(one.curvature_jump, 12) for one in report.defects} == {1}


@pytest.mark.random
@pytest.mark.parametrize(
    ("expression", "reach"),
    [
        (disjunction(TORUS, 4 - x**2 - y**2 - z**2), 5),  # the ball fills the hole and touches the tube from outside
        (conjunction(16 - x**2 - y**2 - z**2, -TORUS), 5),  # what is left of the ball is pinched along a circle
        (conjunction(BALL, x**2 - BALL), 2),  # thin lenses, pinched along x = 0
        (disjunction(conjunction(1 - x**2 - y**2, sp.Rational(9, 10) - z), 1 - x**2 - y**2 - (z - 1) ** 2), 2),
        (conjunction(BALL, BALL + x**3 * y), 2),  # they cross along y = 0
        (conjunction(z - x**2, z - 2 * x**2, y), 2),
    ],
)
def test_what_touches_otherwise_is_never_certified(expression, reach):
    """Within bounds no wider than the touching asks, so that the boxes get as small as they can."""
    assert rsym.verify_smoothness(body(expression, reach), method=SPACE, budget=8_000).verdict != "CERTIFIED"
