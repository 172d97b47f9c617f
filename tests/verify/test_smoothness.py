"""Verdicts on shapes whose truth is known by construction or by hand."""

import math
from fractions import Fraction

import mpmath as mp
import numpy as np
import pytest
import sympy as sp
from oracles.closeness import assert_close

import rsym
from rsym import RsymError, Shape, conjunction, disjunction, x, y, z

SQUARE = ((-2, 2), (-2, 2))
DISC = 1 - x**2 - y**2
Q = sp.Rational


def verdict(expression, bounds=SQUARE, **options):
    return rsym.verify_smoothness(Shape(expression, (x, y), bounds=bounds), **options)


def points(report):
    return sorted(tuple(round(value, 9) + 0.0 for value in defect.point) for defect in report.defects)


# The body of Fig. 11.

PAPER = rsym.paper.skeleton_body()


@pytest.mark.slow
def test_the_paper_s_own_body_has_a_corner():
    """The tip is where g = (a1 - x)(a2 + x)/p1 - p2 vanishes on the segment: its angle is 2 atan |g'|."""
    report = rsym.verify_smoothness(PAPER)
    assert (report.verdict, report.continuity) == ("REFUTED", "G0")
    (corner,) = report.defects
    assert corner.proved
    with mp.workdps(40):
        tip = mp.findroot(lambda t: (8 - t) * (mp.mpf(53) / 10 + t) / 40 - mp.mpf(1) / 10, -5)
        slope = (mp.mpf(27) / 10 - 2 * tip) / 40
        turn = 180 - 2 * mp.degrees(mp.atan(slope))
    assert_close(corner.point, (float(tip), 0), atol=1e-12)
    assert_close(corner.point[0], -4.992121096289474, atol=1e-12)
    assert_close(corner.tangent_jump, float(turn), atol=1e-10)
    assert_close(corner.tangent_jump, 144.811726903, atol=1e-8)
    # What a picture of curvature shows: the same value on both sides.
    assert_close(corner.curvatures, (0.0433063556,) * 2, atol=1e-9)
    assert corner.curvature_jump < 1e-15


@pytest.mark.slow
@pytest.mark.parametrize(("a2", "sampled"), [(Fraction(107, 20), 60.0), (6, 4.3)])
def test_longer_bodies_are_certified_with_a_bound(a2, sampled):
    report = rsym.verify_smoothness(PAPER, letters={"a2": a2})
    assert (report.verdict, report.continuity, len(report.undecided)) == ("CERTIFIED", "analytic", 0)
    assert sampled < report.curvature_bound < 2 * sampled
    kernel = rsym.compile(PAPER, ("curvature",))
    lines = rsym.level_lines(PAPER, letters={"a2": a2}, resolution=1024)
    seen = max(np.nanmax(np.abs(kernel(*line.T, letters={"a2": a2})["curvature"])) for line in lines)
    assert seen <= report.curvature_bound


@pytest.mark.slow
def test_the_literal_reading_is_certified():
    report = rsym.verify_smoothness(rsym.paper.skeleton_body("literal"))
    assert (report.verdict, report.continuity) == ("CERTIFIED", "analytic")
    assert 6.31 < report.curvature_bound < 12


@pytest.mark.slow
def test_a_range_of_letters_is_certified_for_every_value():
    report = rsym.verify_smoothness(PAPER, letters={"a2": (Fraction(532, 100), 8)})
    assert (report.verdict, report.continuity) == ("CERTIFIED", "analytic")
    assert report.letters["a2"] == (5.32, 8.0)
    assert "for every a2 in [5.32, 8]" in str(report)


@pytest.mark.slow
def test_a_range_across_the_threshold_is_refuted():
    report = rsym.verify_smoothness(PAPER, letters={"a2": (5.25, 5.35)}, budget=3000)
    assert report.verdict == "REFUTED"
    assert report.defects[0].continuity == "G0"
    assert -5.05 < report.defects[0].point[0] < -4.94
    assert "for some a2 in [5.25, 5.35]" in str(report)


@pytest.mark.slow
def test_the_threshold_of_the_paper_s_body():
    found = rsym.smoothness_threshold(PAPER, "a2", between=(5.3, 5.35), tolerance=1e-4)
    assert found.refuted < 5 + 4 / 13 < found.certified
    assert found.certified - found.refuted < 1e-3
    words = dict(found.trials)
    assert words[found.refuted] == "REFUTED"
    assert words[found.certified] == "CERTIFIED"


def test_no_threshold_is_an_error():
    disc = Shape(sp.Symbol("r", real=True) - x**2 - y**2, (x, y), letters={"r": 1}, bounds=SQUARE)
    with pytest.raises(RsymError, match="no change from REFUTED to CERTIFIED"):
        rsym.smoothness_threshold(disc, "r", between=(0.5, 1.5))


# Known curves.


def test_the_stadium_has_four_jumps_of_curvature():
    report = verdict(1 - sp.Max(abs(x) - 1, 0) ** 2 - y**2, ((-3, 3), (-2, 2)))
    assert (report.verdict, report.continuity) == ("REFUTED", "G1")
    assert points(report) == [(-1, -1), (-1, 1), (1, -1), (1, 1)]
    for defect in report.defects:
        assert defect.proved
        assert_close(defect.curvature_jump, 1, atol=1e-12)
        assert defect.tangent_jump == 0


@pytest.mark.random
@pytest.mark.parametrize(
    ("power", "continuity", "answer"), [(2, "G1", "REFUTED"), (3, "G2", "CERTIFIED"), (4, "G3", "CERTIFIED")]
)
@pytest.mark.parametrize("angle", [0, 1])
def test_powers_of_max_join_with_one_order_less(power, continuity, answer, angle):
    """y = max(x, 0)**k, as it stands and turned by the angle of the triangle 3, 4, 5."""
    along, across = (x, y) if angle == 0 else ((3 * x + 4 * y) / 5 - Q(1, 7), (3 * y - 4 * x) / 5)
    report = verdict(across - sp.Max(along, 0) ** power)
    assert (report.verdict, report.continuity) == (answer, continuity)
    (joint,) = report.defects + report.joints
    assert joint.proved
    assert_close(joint.point, (0, 0) if angle == 0 else (3 / 35, 4 / 35), atol=1e-12)
    assert_close(joint.curvature_jump, 2 if power == 2 else 0, atol=1e-12)
    assert_close(joint.derivative_jump, 6 if power == 3 else 0, atol=1e-12)


def test_a_kink_of_omega_need_not_be_one_of_the_boundary():
    report = verdict(DISC * (2 + abs(x)))
    assert (report.verdict, report.continuity) == ("CERTIFIED", "analytic")
    assert 1 <= report.curvature_bound < 1.1


@pytest.mark.parametrize("factor", [x**2 + y**2, x**2 + y**4, sp.exp(x), 3 + sp.Max(x, y)])
def test_a_smooth_omega_does_not_heal_a_corner(factor):
    report = verdict(factor * conjunction(x, y))
    assert (report.verdict, report.continuity) == ("REFUTED", "G0")
    assert points(report) == [(0, 0)]
    assert_close(report.defects[0].tangent_jump, 90, atol=1e-10)


def test_a_factor_that_is_zero_at_the_corner_alone_drops_at_any_point():
    """(f**2 + g**2)(f and g): at a fraction, and at irrational points, where f and g vanish by definition."""
    for f, g in ((x - Q(1, 7), y + Q(3, 11)), (x**2 - 2, x + y - Q(1, 3))):
        report = verdict((f**2 + g**2) * conjunction(f, g))
        assert (report.verdict, report.continuity) == ("REFUTED", "G0")
        assert all(defect.proved for defect in report.defects)


def test_pieces_that_join_at_a_fraction_are_arcs_that_join():
    """Neither piece is a polynomial, so that only the point itself tells: sin(0) = 0."""
    report = verdict(sp.Piecewise((y - sp.sin(x - Q(1, 3)), x > Q(1, 3)), (y, True)))
    assert (report.verdict, report.continuity) == ("REFUTED", "G0")
    assert_close(report.defects[0].point, (1 / 3, 0), atol=1e-12)
    assert_close(report.defects[0].tangent_jump, 45, atol=1e-10)


@pytest.mark.slow
def test_an_operand_that_ends_takes_the_boundary_with_it():
    """2 + sqrt(x) is positive where it is defined, and for x < 0 nothing is: the boundary is half a circle."""
    assert verdict(conjunction(DISC, 2 + sp.sqrt(x))).verdict == "UNDECIDED"
    assert verdict(conjunction(DISC, 2 + sp.sqrt(x + 2))).verdict == "CERTIFIED"


def test_a_third_line_through_a_corner_changes_nothing_where_it_lies_outside():
    report = verdict(conjunction(1 - abs(x) - y, 1 - y + x / 10))
    assert report.verdict == "REFUTED"
    (corner,) = [defect for defect in report.defects if defect.proved]
    assert_close(corner.point, (0, 1), atol=1e-9)
    assert_close(corner.tangent_jump, 90, atol=1e-9)
    assert corner.tangent_jump_error < 1e-9


def test_a_smooth_function_with_a_zero_gradient_is_not_a_smooth_curve():
    """|x|**(5/2) is twice differentiable, but y = +-|x|**(5/4) are two curves through the origin."""
    assert verdict(y**2 - abs(x) ** Q(5, 2)).verdict == "UNDECIDED"


@pytest.mark.random
@pytest.mark.parametrize("system", [rsym.R0, rsym.R1, rsym.RAlpha(Q(1, 2)), rsym.R0m(2), rsym.Rp(4)])
def test_corners_of_every_system(system):
    """Two discs of radius 1 at distance 1 meet in (0, +-sqrt(3)/2) at 60 degrees."""
    left, right = 1 - (x + Q(1, 2)) ** 2 - y**2, 1 - (x - Q(1, 2)) ** 2 - y**2
    for operation in (rsym.conjunction, rsym.disjunction):
        report = verdict(operation(left, right, system=system))
        assert report.verdict == "REFUTED"
        assert points(report) == [(0, round(-math.sqrt(3) / 2, 9)), (0, round(math.sqrt(3) / 2, 9))]
        assert_close([defect.tangent_jump for defect in report.defects], [60, 60], atol=1e-10)


def test_level_of_a_conjunction_is_smooth():
    report = verdict(conjunction(x, y) - Q(3, 10), ((-1, 3), (-1, 3)))
    assert (report.verdict, report.continuity) == ("CERTIFIED", "analytic")


@pytest.mark.parametrize(
    ("expression", "answer", "kind", "branches"),
    [
        (y**2 - x**3, "REFUTED", "cusp", 2),
        (y**3 - x**5, "REFUTED", "unbounded curvature", 2),
        (x**2 - y**2 - (x**2 + y**2) ** 2, "DEGENERATE", "node", 4),
        (x**2 * (x - 1) - y**2, "DEGENERATE", "isolated point", 0),
    ],
    ids=["cusp", "unbounded", "lemniscate", "isolated"],
)
def test_singular_points_of_polynomials_are_proved(expression, answer, kind, branches):
    report = verdict(expression)
    assert report.verdict == answer
    (defect,) = report.defects
    assert (defect.point, defect.kind, defect.branches, defect.proved) == ((0, 0), kind, branches, True)


@pytest.mark.parametrize("expression", [-((x**2 + y**2 - 1) ** 2), abs(DISC), -(sp.Abs(DISC) ** 3)])
def test_a_zero_without_a_change_of_sign_is_degenerate(expression):
    report = verdict(expression)
    assert (report.verdict, report.continuity) == ("DEGENERATE", "broken")
    assert ("omega is zero on a curve without changing its sign", True) in report.statements


@pytest.mark.parametrize(
    ("expression", "bounds"),
    [(-1 - x**2, SQUARE), (conjunction(-x - Q(1, 1000), x + y / 10 - Q(1, 1000)), ((-1, 1), (-1, -0.01)))],
)
def test_no_boundary_is_degenerate(expression, bounds):
    report = verdict(expression, bounds)
    assert report.verdict == "DEGENERATE"
    assert report.statements[0] == ("no point of the boundary lies within the bounds", True)


@pytest.mark.slow
def test_numerical_findings_are_called_so():
    """Two discs that touch at a point that no polynomial has: nothing is proved of it, so the verdict stays open."""
    u = x - sp.exp(1) / 2
    report = verdict(disjunction(1 - (u - 1) ** 2 - y**2, 1 - (u + 1) ** 2 - y**2), ((-1.1, 3.9), (-1.5, 1.5)))
    assert report.verdict == "UNDECIDED"
    (node,) = report.defects
    assert_close(node.point, (math.e / 2, 0), atol=1e-12)
    assert (node.kind, node.branches, node.proved) == ("node", 4, False)


def test_an_exhausted_budget_leaves_boxes_undecided():
    report = verdict(DISC, budget=4)
    assert report.verdict == "UNDECIDED"
    assert len(report.undecided) > 0


# Bodies of revolution.


def body(expression, bounds=((-2, 2),) * 3, **options):
    return rsym.verify_smoothness(Shape(expression, (x, y, z), bounds=bounds), **options)


RADIUS = sp.sqrt(y**2 + z**2)


def test_an_ellipsoid_is_certified():
    report = body(1 - x**2 / 4 - y**2 - z**2, ((-3, 3), (-2, 2), (-2, 2)))
    assert (report.verdict, report.continuity, report.body) == ("CERTIFIED", "analytic", True)
    assert 2 <= report.curvature_bound < 2.3  # a/b**2 at the tips


def test_a_capsule_has_two_circles_of_jumps():
    stadium = Shape(Q(1, 4) - sp.Max(abs(x) - 1, 0) ** 2 - y**2, (x, y), bounds=SQUARE)
    report = rsym.verify_smoothness(rsym.revolve(stadium))
    assert (report.verdict, report.continuity) == ("REFUTED", "G1")
    assert points(report) == [(-1, 0.5), (1, 0.5)]
    assert_close([defect.curvature_jump for defect in report.defects], [2, 2], atol=1e-12)


def test_an_even_meridian_may_revolve_into_a_cone():
    report = body(1 - RADIUS - x**2)
    assert (report.verdict, report.continuity) == ("REFUTED", "G0")
    assert points(report) == [(-1, 0), (1, 0)]
    assert_close(
        [defect.tangent_jump for defect in report.defects], [180 - 2 * math.degrees(math.atan(2))] * 2, atol=1e-9
    )
    assert report.curvature_bound == math.inf


@pytest.mark.parametrize(
    ("power", "answer", "continuity"),
    [(2, "CERTIFIED", "analytic"), (3, "CERTIFIED", "G2"), (4, "CERTIFIED", "analytic")],
)
def test_powers_of_the_radius_at_the_axis(power, answer, continuity):
    report = body(1 - x - RADIUS**power, ((-2, 2), (-1, 1), (-1, 1)))
    assert (report.verdict, report.continuity) == (answer, continuity)


def test_the_bodies_of_fig_12_have_a_conical_tip():
    report = rsym.verify_smoothness(rsym.revolve(PAPER))
    assert (report.verdict, report.continuity) == ("REFUTED", "G0")
    assert_close(report.defects[0].point, (-4.992121096289474, 0), atol=1e-9)


def test_only_a_body_of_revolution_has_a_meridian():
    for expression in (1 - x**2 - 2 * y**2 - 3 * z**2, conjunction(DISC, y + Q(1, 2))):
        shape = Shape(expression, (x, y, z), bounds=((-2, 2),) * 3)
        with pytest.raises(RsymError, match="not seen to be a body of revolution"):
            rsym.verify_smoothness(shape, method="meridian")
    with pytest.raises(RsymError, match="no method 'axis'"):
        rsym.verify_smoothness(shape, method="axis")
    with pytest.raises(RsymError, match="this shape is plane"):
        rsym.verify_smoothness(Shape(DISC, (x, y), bounds=SQUARE), method="space")


# Input.


def test_bad_input_is_refused():
    shape = Shape(sp.Symbol("r", real=True) - x**2 - y**2, (x, y), letters={"r": 1}, bounds=SQUARE)
    with pytest.raises(RsymError, match="no letter 'q'"):
        rsym.verify_smoothness(shape, letters={"q": 1})
    with pytest.raises(RsymError, match="range of r is empty"):
        rsym.verify_smoothness(shape, letters={"r": (2, 1)})
    with pytest.raises(RsymError, match="must be a pair"):
        rsym.verify_smoothness(shape, letters={"r": (1, 2, 3)})
    with pytest.raises(RsymError, match="bounds"):
        rsym.verify_smoothness(Shape(y, (x, y)))
    with pytest.raises(RsymError, match="expected a Shape"):
        rsym.verify_smoothness(DISC)


@pytest.mark.slow
def test_the_report_is_the_same_every_time():
    first, second = (rsym.verify_smoothness(PAPER) for _ in range(2))
    assert first.to_json(boxes=True) == second.to_json(boxes=True)


def test_progress_can_cancel():
    hard, seen = Shape(y**3 - x**5, (x, y), bounds=SQUARE), []
    with pytest.raises(RsymError, match="cancelled"):
        rsym.verify_smoothness(hard, progress=lambda done, total: seen.append((done, total)) or len(seen) < 3)
    assert [total for _, total in seen] == [1000] * 3
    assert 0 <= seen[0][0] <= seen[1][0] <= seen[2][0] < 1000


STEEP = {
    "tanh": sp.tanh(1000 * x),
    "tanh, steeper": sp.tanh(10**6 * x) / 3,
    "two steps": sp.tanh(1000 * (x - 1)) - sp.tanh(1000 * (x + 1)),
    "logistic": 3 / (2 + 5 * sp.exp(1000 - 3000 * x)),
}


@pytest.mark.parametrize("height", STEEP.values(), ids=list(STEEP))
def test_a_steep_profile_is_analytic_and_takes_no_more_boxes_than_a_flat_one(height):
    report = rsym.verify_smoothness(rsym.Shape(y - height, (x, y), bounds=((-2, 2), (-2, 2))), budget=400)
    assert (report.verdict, report.continuity) == ("CERTIFIED", "analytic")


def test_a_steep_profile_times_a_modulus_keeps_its_jump_of_curvature():
    report = rsym.verify_smoothness(rsym.Shape(y - sp.tanh(1000 * x) * abs(x), (x, y), bounds=((-1, 1), (-1, 1))))
    assert (report.verdict, report.continuity, report.defects[0].proved) == ("REFUTED", "G1", True)
    assert report.defects[0].curvature_jump == pytest.approx(4000, rel=1e-9)


def test_conditions_whose_products_overflow_are_asked_without_a_warning():
    inside = sp.Piecewise((1, abs(sp.exp(x**2 + y**2 - 1) - 1) < sp.Rational(1, 2)), (-1, True))
    report = rsym.verify_smoothness(rsym.Shape(inside, (x, y), bounds=((-2, 2), (-2, 2))))
    assert (report.verdict, report.continuity) == ("CERTIFIED", "analytic")
