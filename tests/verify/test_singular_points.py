"""Corners and other singular points of bodies, against normals and angles worked out by hand."""

from __future__ import annotations

import math
from fractions import Fraction
from itertools import product
from random import Random

import numpy as np
import pytest
import sympy as sp
from oracles.closeness import assert_close

import rsym
from rsym import x, y, z
from rsym.bounds.balls import exact
from rsym.logic.kleene import ternary
from rsym.sampling.progress import Effort
from rsym.verify.answers.conclusions import is_degenerate
from rsym.verify.answers.singular import SingularPoint
from rsym.verify.boxes.local import Model, side
from rsym.verify.boxes.sheets import sheets
from rsym.verify.curves.components import narrowed
from rsym.verify.curves.continuation import ZeroCurve
from rsym.verify.points.clusters import clusters
from rsym.verify.points.corners import Corner, corner
from rsym.verify.points.even_roots import is_regular_through_root
from rsym.verify.points.space import Classified, classify_points


def model_of(expression):
    return Model(rsym.Shape(expression, (x, y, z)), {})


def box_around(point, width, shift=0.1):
    """A box that holds a point off its middle."""
    return tuple((float(c) - width * (0.5 + shift), float(c) + width * (0.5 - shift)) for c in point)


def corner_of(expression, point=(0, 0, 0), width=0.25) -> Corner | None:
    model = model_of(expression)
    return corner(model.over(box_around(point, width)), names=lambda node: f"node {node}")


def proved_corner(expression, point=(0, 0, 0), width=0.25) -> tuple[Corner, SingularPoint]:
    found = corner_of(expression, point, width)
    assert found is not None
    assert found.exists
    assert found.point is not None
    assert found.point.proved
    return found, found.point


def turned(vector, point):
    """A linear form with this normal that vanishes at the point."""
    return sum(sp.sympify(a) * (c - p) for a, c, p in zip(vector, (x, y, z), point, strict=True))


ROTATION = sp.Matrix([[2, -1, 2], [2, 2, -1], [-1, 2, 2]]) / 3
PLACES = [(sp.Rational(3, 7), sp.Rational(-2, 5), sp.Rational(11, 13)), (sp.sqrt(2), sp.sqrt(3) / 3, -sp.sqrt(5))]


@pytest.mark.parametrize("place", PLACES)
def test_the_corner_of_a_cube_anywhere(place):
    rows = [list(ROTATION.row(k)) for k in range(3)]
    found, point = proved_corner(rsym.conjunction(*(turned(row, place) for row in rows)), place)
    assert (point.kind, point.continuity, found.exists, len(point.names)) == ("corner", "G0", True, 3)
    assert_close(point.point, [float(c) for c in place], atol=1e-15)
    assert point.radius < 1e-14
    assert_close(point.tangent_jump, 90, atol=1e-12)
    assert found.edges == ((0, 1), (0, 2), (1, 2))
    assert (found.pinched, found.cracked) == ((), False)
    assert_close(np.array(found.normals), -np.array(rows, float), atol=1e-15)


def test_two_reentrant_edges_and_a_convex_one():
    # A quarter x, y > 0 joined to the half space z < 0: the edge x = y = 0 is convex above z = 0, the others reentrant.
    found, point = proved_corner(rsym.disjunction(rsym.conjunction(x, y), -z))
    assert (point.kind, point.tangent_jump) == ("corner", 90.0)
    assert_close(np.array(found.normals), [[-1, 0, 0], [0, -1, 0], [0, 0, 1]], atol=1e-15)
    assert found.edges == ((0, 1), (0, 2), (1, 2))


OPPOSITE = rsym.disjunction(rsym.conjunction(x, y, z), rsym.conjunction(-x, -y, -z))
TWO_OF_THREE = rsym.disjunction(rsym.conjunction(x, y), rsym.conjunction(y, z), rsym.conjunction(z, x))


@pytest.mark.parametrize(
    ("expression", "kind", "edges", "pinched"),
    [
        (rsym.exclusive_or(rsym.exclusive_or(x, y), z), "node", 0, 3),  # four octants, no two with a common face
        (OPPOSITE, "node", 3, 0),
        (rsym.conjunction(rsym.exclusive_or(x, y), z), "node", 2, 1),  # two opposite wedges cut off
        (TWO_OF_THREE, "corner", 3, 0),  # +++ and its three neighbours: a surface, for all grows along (1, 1, 1)
    ],
)
def test_octants(expression, kind, edges, pinched):
    found, point = proved_corner(expression)
    assert (point.kind, len(found.edges), len(found.pinched)) == (kind, edges, pinched)
    assert point.continuity == ("G0" if kind == "corner" else "broken")


def test_a_sheet_without_a_change_of_sign_is_a_crack():
    whole = rsym.disjunction(rsym.conjunction(x, y), rsym.conjunction(x, -y))  # x > 0 but for y = 0
    found, point = proved_corner(rsym.conjunction(whole, z))
    assert found.cracked
    assert point.kind == "node"


def test_three_planes_of_a_prism_have_no_common_point():
    # Nearly parallel to one line: they meet at z = 20 alone.
    sides = (x - z / 100 + 0.2, y - x - z / 100 + 0.2, -y - z / 100 + 0.2)
    found = corner_of(rsym.conjunction(*sides), width=1)
    assert found is not None
    assert (found.exists, found.point, found.normals) == (False, None, ())
    parallel = (x + 0.2, y - x + 0.2, 0.2 - y)
    assert corner_of(rsym.conjunction(*parallel), width=1) is None  # dependent: the octree divides on


def test_sheets_that_do_not_count_are_dropped():
    # Absorbed: x | (x & y) is x; so there are two sheets only, and no corner.
    absorbed = rsym.disjunction(x, rsym.conjunction(x, y))
    assert corner_of(rsym.conjunction(absorbed, z)) is None
    # A fourth sheet far away, a positive factor and normalisation are dropped too.
    body = rsym.conjunction(x * (2 + sp.exp(y)), y / (3 + z), z**3, 5 - x)
    _, point = proved_corner(body)
    assert point.tangent_jump == 90


def test_pieces_of_absolute_values_are_sheets():
    # The ridge of the roof z = 1 - |x| ends in the wall y = 0: normals (1, 0, 1), (-1, 0, 1) and (0, -1, 0).
    found, point = proved_corner(rsym.conjunction(1 - abs(x) - z, y), (0, 0, 1))
    assert_close(point.point, (0, 0, 1), atol=1e-15)
    assert_close(point.tangent_jump, 90, atol=1e-12)
    assert found.edges == ((0, 1), (0, 2), (1, 2))
    assert len(set(found.origins)) == 2  # the roof is one definition


def random_body(random):
    """Two or three pieces of planes under |u|, min and max, joined; and its sign at a rational point."""

    def plane():
        a, b, c = (random.randint(-3, 3) for _ in range(3))
        d = Fraction(random.randint(-4, 4), 7)
        return a * x + b * y + c * z + sp.Rational(
            d.numerator, d.denominator
        ), lambda p: a * p[0] + b * p[1] + c * p[2] + d

    def piece():
        (f, u), (g, v) = plane(), plane()
        return random.choice(
            [
                (sp.Min(f, g) - abs(g) / 2, lambda p: min(u(p), v(p)) - abs(v(p)) / 2),
                (3 * abs(f) - 2 * sp.Max(g, -f), lambda p: 3 * abs(u(p)) - 2 * max(v(p), -u(p))),
                ((g - abs(f)) * (2 + z), lambda p: v(p) - abs(u(p))),
                (f, u),
            ]
        )

    (f, u), (g, v) = piece(), piece()
    return random.choice(
        [
            (rsym.conjunction(f, -g), lambda p: min(u(p), -v(p))),
            (-rsym.conjunction(f, rsym.disjunction(g, x - y)), lambda p: -min(u(p), max(v(p), p[0] - p[1]))),
            (rsym.exclusive_or(f, g), lambda p: -u(p) * v(p)),
        ]
    )


@pytest.mark.slow
def test_the_formula_of_sheets_has_the_sign_of_omega():
    random = Random(2)
    for _ in range(25):
        expression, oracle = random_body(random)
        model = model_of(expression)
        found = sheets(model.over(((-1.0, 1.0),) * 3), model.root)
        assert found is not None
        for _ in range(20):
            point = [Fraction(random.randint(-999, 999), 1000) for _ in range(3)]
            at, expected = model.on([exact(part) for part in point]), oracle(point)
            signs = {leaf: at.sign(leaf) for leaf in found.leaves}
            assert ternary(found.formula, signs) == (expected > 0) - (expected < 0)


def test_curved_sheets_meet_at_the_angles_of_their_normals():
    # A sphere about 0 through (1, 2, 2)/3*s with the planes x = 1 and y = 2: normals (1, 2, 2)/3, -e1, -e2.
    _, point = proved_corner(rsym.conjunction(9 - x**2 - y**2 - z**2, x - 1, y - 2), (1, 2, 2))
    assert_close(point.point, (1, 2, 2), atol=1e-15)
    assert_close(point.tangent_jump, math.degrees(math.acos(-2 / 3)), atol=1e-12)
    assert point.tangent_jump_error < 1e-12


def test_a_corner_outside_the_box_is_known_but_not_its_own():
    model = model_of(rsym.conjunction(x, y, z))
    found = corner(model.over(((0.01, 0.11), (-0.05, 0.05), (-0.05, 0.05))))
    assert found is not None
    assert (found.exists, found.point) == (True, None)


def classified(expression, point=(0, 0, 0), width=2.0**-12) -> Classified:
    """What 64 boxes around a point are taken for, the point off their sides."""
    model = model_of(expression)
    steps = [(width * (k - 1.7), width * (k - 0.7)) for k in range(4)]
    ends = [[(float(c) + low, float(c) + high) for low, high in steps] for c in point]
    return classify_points(model, [(box, None) for box in product(*ends)], 4.0, names=lambda node: f"node {node}")


def the_point(expression, point=(0, 0, 0), regular=0) -> SingularPoint:
    found = classified(expression, point)
    assert (len(found.points), found.curves, len(found.regular)) == (1, (), regular)
    assert_close(found.points[0].point, [float(c) for c in point], atol=1e-12)
    assert found.points[0].proved
    return found.points[0]


def ball(centre, radius):
    return radius**2 - sum((c - m) ** 2 for c, m in zip((x, y, z), centre, strict=True))


ALGEBRAIC = rsym.disjunction(ball((-sp.sqrt(2), 0, 0), sp.sqrt(2)), ball((sp.sqrt(3), 0, 0), sp.sqrt(3)))
APART = rsym.disjunction(ball((-1, 0, 0), 1), ball((1, 0, 0), 1))
COMMON = rsym.conjunction(ball((-1, 0, 0), 1), ball((1, 0, 0), 1))
WITHIN = rsym.disjunction(ball((-1, 0, 0), 1), ball((-2, 0, 0), 2))
BETWEEN = rsym.conjunction(ball((-2, 0, 0), 2), -ball((-1, 0, 0), 1))  # a crescent, closed to a horn in the point
RADIUS = sp.sqrt(x**2 + y**2)


@pytest.mark.parametrize(
    ("expression", "kind", "continuity", "degenerate"),
    [
        (z**2 - x**2 - y**2, "node", "broken", True),
        (x**2 + y**2 - z**2, "node", "broken", True),
        (x * y - z**2 + x**3, "node", "broken", True),
        (x * y * z, "node", "broken", True),
        (-(x**2) - y**2 - z**2, "isolated point", "broken", True),
        (x**2 + 2 * y**2 + z**2 - x * y, "isolated point", "broken", True),
        (-sp.sqrt(x**2 + y**2 + z**2), "isolated point", "broken", True),
        (RADIUS - abs(z), "node", "broken", True),
        (APART, "tangency", "broken", True),
        (COMMON, "isolated point", "broken", True),
        (ALGEBRAIC, "tangency", "broken", True),
        (WITHIN, "tangency", "analytic", False),
        (BETWEEN, "tangency", "broken", True),
        (rsym.conjunction(z - x**2 + y**2, z + x**2 - y**2), "tangency", "G0", False),  # edges cross in a saddle
        (rsym.conjunction(z - x**2 + y**2, -z - x**2 + 2 * y**2), "tangency", "broken", True),
    ],
)
def test_points_without_a_tangent_plane_of_one_sheet(expression, kind, continuity, degenerate):
    # Where the boundary is one of two sheets that touch, they are proved to meet nowhere else in the boxes.
    found = the_point(expression, regular=64 if continuity == "analytic" else 0)
    assert (found.kind, found.continuity, is_degenerate(found)) == (kind, continuity, degenerate)


def test_sheets_that_touch_at_two_points_in_a_box_are_not_taken_for_one():
    wave = z - x**2 * (x - sp.Rational(1, 1000)) ** 2 - y**2  # touches z = 0 at x = 0 and at x = 1/1000
    far, near = (classified(rsym.disjunction(z, wave), width=width) for width in (2.0**-12, 2.0**-14))
    assert (len(far.points), len(far.regular)) == (1, 0)
    assert (len(near.points), len(near.regular)) == (1, 64)


IRRATIONAL = (sp.sqrt(2), sp.sqrt(3), sp.sqrt(5))
SHIFTED = sp.sqrt((x - sp.sqrt(2)) ** 2 + (y - sp.sqrt(3)) ** 2)


@pytest.mark.random
@pytest.mark.parametrize(
    ("expression", "point", "turn"),
    [
        (z - 2 * RADIUS, (0, 0, 0), 2 * math.atan(2)),  # opposite normals (2, 0, -1) and (-2, 0, -1)
        (z - sp.sqrt(5) - sp.sqrt(3) * SHIFTED, IRRATIONAL, 2 * math.pi / 3),
        # The slope along the root is 2 z - sqrt(5) = sqrt(5); omega vanishes as z - sqrt(5) does, where the root is 0.
        (z * (1 + 2 * SHIFTED) - sp.sqrt(5) * sp.exp(SHIFTED), IRRATIONAL, 2 * math.atan(math.sqrt(5))),
        (2 * RADIUS - z, (0, 0, 0), 2 * math.atan(2)),  # a pit
        (1 - z - sp.sqrt(x**2 + 4 * y**2), (0, 0, 1), 2 * math.atan(2)),  # elliptic: the steepest generators
        (3 - x - rsym.trimming(sp.sqrt(y**2 + z**2), 4 - x), (3, 0, 0), math.pi / 2),  # a trimmed nose
        # Oblique: normals d/2 - (1/2, 0, 1), d a unit vector, lie within asin(1/2 / sqrt(5/4)) of their axis.
        (z + x / 2 - sp.sqrt(x**2 + y**2 + z**2) / 2, (0, 0, 0), 2 * math.asin(1 / math.sqrt(5))),
    ],
)
def test_tips_of_cones(expression, point, turn):
    found = the_point(expression, point)
    assert (found.kind, found.continuity, is_degenerate(found)) == ("cone tip", "G0", False)
    assert_close(found.tangent_jump, math.degrees(turn), atol=1e-9)
    assert found.names


def pyramid(sides, slope):
    turns = [2 * sp.pi * k / sides for k in range(sides)]
    return rsym.conjunction(*(1 - z - slope * (sp.cos(turn) * x + sp.sin(turn) * y) for turn in turns))


@pytest.mark.parametrize(
    ("expression", "turn"),
    [
        (pyramid(4, 1), math.acos(1 / 2)),  # normals (1, 0, 1), (0, 1, 1)
        (pyramid(6, 2), math.acos((4 * math.cos(math.pi / 3) + 1) / 5)),
        (1 - abs(x) - abs(y) - z, math.acos(1 / 3)),  # normals (1, 1, 1), (1, -1, 1)
        (-pyramid(4, 1), math.acos(1 / 2)),
    ],
)
def test_apices_of_pyramids(expression, turn):
    found = the_point(expression, (0, 0, 1))
    assert (found.kind, found.continuity) == ("corner", "G0")
    assert_close(found.tangent_jump, math.degrees(turn), atol=1e-12)


def test_three_dependent_planes_do_not_matter_away_from_the_boundary():
    # x = 0, y = 0 and x + y = z**2 share a tangent, the z axis: above all is inside there, below it is outside.
    wedge = rsym.conjunction(x, y, x + y - z**2, z + 3 * x + y)
    found = the_point(rsym.disjunction(z, wedge))
    assert (found.kind, found.continuity) == ("corner", "G0")
    assert found.reason.startswith("5 analytic sheets")


def test_two_pyramids_that_share_an_apex_make_a_node():
    sides = [z - x, z + x, z - y, z + y]
    found = the_point(rsym.disjunction(rsym.conjunction(*sides), rsym.conjunction(*(-side for side in sides))))
    assert (found.kind, is_degenerate(found)) == ("node", True)


def test_what_is_even_in_a_root_is_smooth():
    for meridian in (RADIUS**2, sp.cos(RADIUS), sp.sqrt(1 + RADIUS**4), RADIUS * sp.sin(RADIUS)):
        found = classified(z - meridian.subs({x: 0, y: 0}) - meridian, (0, 0, float(2 * meridian.subs({x: 0, y: 0}))))
        assert (found.points, found.curves, len(found.regular)) == ((), (), 64)
    for meridian in (sp.sin(RADIUS), RADIUS**3 + RADIUS):
        assert not classified(z - meridian).regular


def test_what_no_proof_settles_is_called_numerical():
    # Four sheets through one irrational point: no rational arithmetic proves that the fourth does.
    moved = pyramid(4, 1).subs(x, x - sp.sqrt(2))
    (point,) = classified(moved, (sp.sqrt(2), 0, 1)).points
    assert (point.kind, point.proved) == ("corner", False)
    assert_close(point.tangent_jump, 60, atol=1e-9)
    # Balls whose radii are floats touch up to rounding.
    (point,) = classified(rsym.disjunction(ball((-0.75, 0, 0), 0.75), ball((0.8, 0, 0), 0.8))).points
    assert (point.kind, point.continuity, point.proved) == ("tangency", "broken", False)
    # Two spikes without a regular quadratic form, sharper than the lattice of directions sees.
    (point,) = classified(z**4 - x**2 - y**2).points
    assert (point.kind, point.proved) == ("unresolved", False)
    # A double cone and a plane, where the third derivatives decide.
    (point,) = classified(sp.expand(z * (z**2 - x**2 - y**2)) + x**4).points
    assert (point.kind, point.proved) == ("node", False)
    # Three sheets that miss each other by 1e-30 make corners of their own.
    off = sp.Rational(1, 10**30)
    (point,) = classified(rsym.conjunction(1 - z - x, 1 - z + x, 1 - z - y + off, 1 - z + y), (0, 0, 1)).points
    assert (point.kind, point.proved) == ("corner", True)
    assert point.reason.startswith("3 analytic sheets")


THIN = rsym.disjunction(z - 3 * RADIUS, -z - 3 * RADIUS, sp.sqrt(x**2 + z**2) / 1000 - abs(y))


@pytest.mark.slow
@pytest.mark.parametrize(
    "expression",
    [
        THIN,  # two cones, joined by a plate too thin for the cells of directions
        sp.Min(z - RADIUS / 2, abs(x)),  # a cone with a crack in it
        rsym.disjunction(rsym.conjunction(x, y, z**2 - x - y), rsym.conjunction(z, z + x + 3 * y)),  # a spike as z**2
    ],
)
def test_what_the_one_sided_derivative_does_not_show_is_not_proved(expression):
    (point,) = classified(expression).points
    assert not point.proved


def test_a_gradient_may_vanish_beside_the_zero_of_a_root():
    model = model_of(z / 10 + sp.cos(sp.sqrt(x**2 + y**2 + z**2)) - 1)  # grad omega = 0 at (0, 0, 0.1002)
    assert is_regular_through_root(model.over(((-0.05, 0.05),) * 3), model.root)
    assert not is_regular_through_root(model.over(((-0.2, 0.2),) * 3), model.root)


def test_thousands_of_boxes_fall_into_clusters():
    width = 2.0**-10
    line = [((k * width, (k + 1) * width), (0.0, width), (0.0, width)) for k in range(3000)]
    apart = [tuple((2.0 * n, 2.0 * n + w) for _ in range(3)) for n, w in ((2, width), (3, 4 * width))]
    small = ((4.0 - width / 4, 4.0),) * 3  # touches the first of them in a corner, and is smaller
    found = list(clusters([*line, *apart, small], 3, Effort()))
    assert [len(one.boxes) for one in found] == [3000, 2, 1]
    assert found[0].is_long
    assert not found[1].is_long
    points = found[0].ordered()
    assert (np.diff(points[:, 0]) > 0).all()
    assert_close(points[[0, -1], 0], [width / 2, 2999.5 * width], atol=3 * width)


def test_beside_a_contact_sheets_are_told_apart():
    # They touch in (2, -1, 2)/3. At a distance of 0.068 either passes through a box of a width of 0.02.
    model = model_of(rsym.disjunction(ball((0, 0, 0), 1), ball((1, -sp.Rational(1, 2), 1), sp.Rational(1, 2))))
    first, second = model.builder.nodes[model.root].arguments[:2]
    curve = ZeroCurve(model, (first, second), [], 2.0)
    apart, around = (
        tuple(side(low, low + 0.02) for low in corner) for corner in ((0.63, -0.31, 0.71), (0.66, -0.34, 0.66))
    )
    assert all(value.contains(0) for value in curve.values(curve.on(apart)))
    assert narrowed(curve, apart) is None
    assert narrowed(curve, around) is not None
