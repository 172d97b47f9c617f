"""Leaves that have a face in common, absorb each other, or touch: what is proved of the boundary that they make."""

import pytest
import sympy as sp
from oracles.tiers import of_the_day

import rsym
from rsym import conjunction, disjunction, x, y, z
from rsym.verify.boxes.local import Model
from rsym.verify.points.space import classify_points

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


# --- contacts where no coordinate is rational: by resultants --------------------------------------------------------

HALF_ROOT = sp.sqrt(2) / 2
TINY = sp.Rational(1, 10**9)


def disc(radius, a=0, b=0):
    return rsym.Shape(radius**2 - (x - a) ** 2 - (y - b) ** 2, (x, y), bounds=((-4, 4), (-4, 4)))


@pytest.mark.parametrize("direction", [(HALF_ROOT, HALF_ROOT), (sp.sqrt(3) / 2, -sp.S.Half), (sp.Rational(3, 5), 0.8)])
def test_circles_that_touch_anywhere(direction):
    a, b = (sp.nsimplify(part) for part in direction)
    inside, outside = disc(1, a, b), disc(1, 3 * a, 3 * b)
    assert word(rsym.verify_smoothness(disc(2) | inside)) == ("CERTIFIED", "analytic")
    report = rsym.verify_smoothness(disc(2) | outside)
    assert (report.verdict, report.defects[0].kind, report.defects[0].proved) == ("DEGENERATE", "node", True)


@pytest.mark.parametrize("more", [TINY, 1000 * TINY, 10**6 * TINY])
def test_circles_that_nearly_touch_are_not_said_to(more):
    assert word(rsym.verify_smoothness(disc(2) | disc(1 + more, HALF_ROOT, HALF_ROOT))) == ("REFUTED", "G0")
    apart = rsym.verify_smoothness(disc(2) | disc(1 - more, 3 * HALF_ROOT, 3 * HALF_ROOT))
    assert apart.verdict in {"CERTIFIED", "UNDECIDED"}


@pytest.mark.parametrize(
    "shape",
    [
        rsym.sphere(3) | rsym.torus(2, 1),
        rsym.Shape((1 + sp.sqrt(5)) ** 2 - x**2 - y**2 - (z - 1) ** 2, (x, y, z)) | rsym.torus(2, 1),
        rsym.torus(2, 1) - rsym.Shape(z - 1, (x, y, z)),
        rsym.sphere(1 + sp.sqrt(2)) | rsym.torus(sp.sqrt(2), 1),
    ],
    ids=["equator", "irrational circle", "lid", "irrational radius"],
)
def test_bodies_that_touch_along_circles_from_inside(shape):
    assert word(rsym.verify_smoothness(shape)) == ("CERTIFIED", "analytic")


@pytest.mark.parametrize("more", [-TINY, TINY, 10**6 * TINY])
def test_bodies_that_nearly_touch_along_circles_are_not_said_to(more):
    report = rsym.verify_smoothness(rsym.sphere(3) | rsym.torus(2, 1 + more))
    assert report.verdict in ({"REFUTED", "UNDECIDED"} if more > 0 else {"CERTIFIED", "UNDECIDED"})


def test_a_point_stands_for_the_line_along_which_cylinders_touch_from_outside():
    pair = body(disjunction(DISC, 1 - (x - sp.sqrt(2)) ** 2 - (y - sp.sqrt(2)) ** 2))
    middle, width = float(HALF_ROOT), 2.0**-9
    box = ((middle - width / 3, middle + width / 2),) * 2
    left = [((*box, (k * width, (k + 1) * width)), None) for k in range(60)]
    found = classify_points(Model(pair, {}), left, 2.0)
    (point,) = found.points
    assert (point.kind, point.continuity, point.proved) == ("tangency", "broken", True)
    one = body(disjunction(DISC, conjunction(DISC, x + y - sp.sqrt(2))))  # the plane touches what the disc covers
    assert not [p for p in classify_points(Model(one, {}), left, 2.0).points if p.continuity == "broken"]
