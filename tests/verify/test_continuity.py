"""Joints of parametric curves against textbook values, and against finite differences along the arc."""

import math

import pytest
import sympy as sp
from oracles.closeness import assert_close

import rsym
from rsym import Curve, RsymError, continuity
from rsym.verify.boxes.constants import vanishes

t = sp.Symbol("t", real=True)
R = sp.Rational


def arc(radius, centre, first, last):
    return Curve((centre[0] + radius * sp.cos(t), centre[1] + radius * sp.sin(t)), t, first, last)


def bezier(*points):
    degree = len(points) - 1
    weights = [math.comb(degree, k) * t**k * (1 - t) ** (degree - k) for k in range(degree + 1)]
    return Curve([sum(w * p[i] for w, p in zip(weights, points, strict=True)) for i in range(len(points[0]))], t, 0, 1)


def reparametrised(curve, by):
    """by(0) = 0, by(1) = 1, rising, for a curve on [0, 1]."""
    return Curve([e.subs(curve.parameter, by) for e in curve.expressions], t, 0, 1)


def continued(curve, lam, mu, nu=0, change=(0, 0)):
    """A cubic that leaves the end of a curve on [0, 1] with q' = lam p', q'' = lam^2 p'' + mu p', and the third so."""
    p = [[sp.diff(e, t, k).subs(t, 1) for e in curve.expressions] for k in range(4)]
    jets = [
        p[0],
        [lam * a for a in p[1]],
        [lam**2 * b + mu * a for a, b in zip(p[1], p[2], strict=True)],
        [lam**3 * c + 3 * lam * mu * b + nu * a for a, b, c in zip(*p[1:], strict=True)],
    ]
    order, size = change
    if order:
        jets[order][0] += size
        jets[order][1] -= size
    return Curve([sum(jets[k][i] * t**k / sp.factorial(k) for k in range(4)) for i in range(len(p[0]))], t, 0, 1)


PLANE = bezier((0, 0), (1, 2), (3, 1), (4, 3))
SPACE = bezier((0, 0, 0), (1, 2, 1), (3, 1, -1), (4, 3, 2))


def test_a_line_into_an_arc_jumps_by_one_over_the_radius():
    for radius in (2, R(1, 3), sp.sqrt(2)):
        line = Curve((t, 0), t, -1, 0)
        report = continuity([line, arc(radius, (0, radius), -sp.pi / 2, 0)])
        (joint,) = report.joints
        assert (report.verdict, report.continuity, joint.kind, joint.proved) == (
            "REFUTED",
            "G1",
            "curvature jump",
            True,
        )
        assert_close([joint.curvature_jump, *joint.curvatures], [float(1 / radius), 0, float(1 / radius)], atol=1e-15)
        assert continuity([line, arc(radius, (0, radius), -sp.pi / 2, 0)], claim="G1").verdict == "CERTIFIED"


def test_the_stadium_closed_has_four_jumps():
    pieces = [
        Curve((t, -1), t, -1, 1),
        arc(1, (1, 0), -sp.pi / 2, sp.pi / 2),
        Curve((t, 1), t, 1, -1),
        arc(1, (-1, 0), sp.pi / 2, 3 * sp.pi / 2),
    ]
    report = continuity(pieces, closed=True)
    assert len(report.joints) == len(report.defects) == 4
    assert all(joint.proved and joint.curvature_jump == 1 for joint in report.joints)
    assert len(continuity(pieces).joints) == 3


@pytest.mark.random
@pytest.mark.parametrize("curve", [PLANE, SPACE], ids=["plane", "space"])
@pytest.mark.parametrize(("order", "grade"), [(1, "G0"), (2, "G1"), (3, "G2"), (0, "G3")])
def test_pieces_joined_by_beta_constraints(curve, order, grade):
    """G^k and not C^k: the speed changes by the factor 2/3 and the pieces share no further derivative."""
    second = continued(curve, R(2, 3), R(-1, 4), R(5, 7), (order, R(1, 1000)))
    report = continuity([curve, second])
    assert report.continuity == grade
    assert report.joints[0].proved
    assert report.verdict == ("CERTIFIED" if grade in ("G2", "G3") else "REFUTED")
    assert continuity([curve, second], claim="G3").verdict == ("CERTIFIED" if grade == "G3" else "REFUTED")


@pytest.mark.random
@pytest.mark.parametrize("by", [t**2 / 3 + 2 * t / 3, sp.tan(sp.pi * t / 4), sp.log(1 + t) / sp.log(2)])
@pytest.mark.parametrize("curve", [PLANE, SPACE], ids=["plane", "space"])
def test_nothing_depends_on_the_parameter(curve, by):
    second = continued(curve, 1, 0, 0, (3, R(1, 2)))
    plain, bent = continuity([curve, second]).joints[0], continuity([curve, reparametrised(second, by)]).joints[0]
    assert bent.continuity == plain.continuity == "G2"
    assert_close(bent.derivative_jump, plain.derivative_jump, rtol=1e-12)
    assert_close(bent.curvatures, plain.curvatures, rtol=1e-12)


def test_the_measures_against_differences_along_the_arc():
    """Curvature, its derivative and the torsion of a helix on a growing cylinder, from points at equal arc lengths."""
    curve = Curve(((1 + t / 5) * sp.cos(t), (1 + t / 5) * sp.sin(t), t / 2 + t**2 / 7), t, 0, R(1, 2))
    straight = Curve((t, 0, 0), t, -1, 0)
    joint = continuity([curve, straight]).joints[0]
    p = [sp.lambdify(t, [sp.diff(e, t, k) for e in curve.expressions], "mpmath") for k in range(4)]
    v, a, j = (sp.Matrix([sp.Float(c, 40) for c in f(sp.Float("0.5", 40))]) for f in p[1:])
    area = v.cross(a)
    assert_close(joint.curvatures[0], float(area.norm() / v.norm() ** 3), rtol=1e-12)
    assert_close(joint.torsions[0], float(area.dot(j) / area.dot(area)), rtol=1e-12)
    assert math.isnan(joint.torsions[1])


def test_torsion_alone_breaks_the_third_order():
    """Two helices of one curvature 1/2 and of torsion 1/2 and -1/2 share a point, a tangent and a normal."""
    right = Curve((sp.cos(t), sp.sin(t), t), t, -1, 0)
    # Turned about its principal normal, the x axis, the tangent (0, 1, -1) becomes (0, 1, 1).
    left = Curve((sp.cos(t), t, sp.sin(t)), t, 0, 1)
    joint = continuity([right, left]).joints[0]
    assert (joint.continuity, joint.kind) == ("G2", "smooth joint")
    assert_close(joint.torsions, [0.5, -0.5], atol=1e-15)
    assert_close([joint.curvature_jump, joint.derivative_jump], [0, 0.5], atol=1e-15)


def test_a_square_a_gap_and_a_reversal():
    corners = [(0, 0), (1, 0), (1, 1), (0, 1)]
    sides = [bezier(a, b) for a, b in zip(corners, corners[1:] + corners[:1], strict=True)]
    report = continuity(sides, closed=True, claim="G1")
    assert_close([joint.tangent_jump for joint in report.joints], [90] * 4, rtol=1e-15)
    assert report.verdict == "REFUTED"
    assert continuity(sides, closed=True, claim="G0").verdict == "CERTIFIED"
    apart = continuity([sides[0], bezier((1, R(1, 1000)), (2, 0))]).joints[0]
    assert (apart.continuity, apart.kind, apart.gap) == ("broken", "end", 0.001)
    back = continuity([sides[0], bezier((1, 0), (0, 0))]).joints[0]
    assert (back.kind, back.continuity, back.tangent_jump, back.proved) == ("cusp", "G0", 180, True)


def test_a_curve_run_backwards_is_left_as_it_is_entered():
    curve = Curve(PLANE.expressions, t, R(1, 3), 1)
    back = Curve(PLANE.expressions, t, R(1, 3), 0)
    joint = continuity([Curve(PLANE.expressions, t, 1, R(1, 3)), back], claim="G3").joints[0]
    forth = continuity([Curve(PLANE.expressions, t, 0, R(1, 3)), curve], claim="G3").joints[0]
    assert joint.continuity == forth.continuity == "G3"
    assert_close(joint.curvatures, [-k for k in forth.curvatures], rtol=1e-14)


@pytest.mark.parametrize(
    ("coordinates", "kind", "continuity_", "curvature"),
    [
        ((t**2, t**4), "smooth joint", "G3", 2),  # a parabola
        ((t**3, t**6 + t**7), "smooth joint", "G2", 2),
        ((t**2, t**3), "unbounded curvature", "G1", math.inf),
        ((t**3, t**5), "unbounded curvature", "G1", math.inf),
        ((t**2 + t**3, t**5), "curvature jump", "G1", 0),
        ((t**4, t**8), "smooth joint", "G3", 2),
        ((t**5, t**10), "unresolved", "G0", math.nan),  # a parabola too, which is not found out
    ],
)
def test_a_velocity_that_vanishes_is_seen_through(coordinates, kind, continuity_, curvature):
    before = Curve((t, t**2), t, -1, 0)
    report = continuity([before, Curve(coordinates, t, 0, 1)])
    joint = report.joints[0]
    assert (joint.kind, joint.continuity) == (kind, continuity_)
    assert joint.curvatures[1] == curvature or math.isnan(curvature)
    assert report.verdict == {"unresolved": "UNDECIDED", "smooth joint": "CERTIFIED"}.get(kind, "REFUTED")
    if kind == "smooth joint":
        # The other way round it is entered by a standing end, and leaves by a parabola.
        after = continuity([Curve((-coordinates[0], coordinates[1]), t, 1, 0), Curve((t, t**2), t, 0, 1)])
        assert after.verdict == "CERTIFIED"


def reversed_(curve):
    return Curve(curve.expressions, t, curve.end, curve.start)


@pytest.mark.slow
def test_a_standing_end_is_proved_to_any_class_that_is_claimed():
    """(t**3, 0) is a straight line: nothing that is certified rests on a joint that is not proved."""
    line = Curve((t, 0), t, -1, 0)
    report = continuity([line, Curve((t**3, 0), t, 0, 1)], claim="G3")
    assert (report.verdict, report.proved, [joint.proved for joint in report.joints]) == ("CERTIFIED", "G3", [True])
    # y = x**2 + 5 x**3 in another parameter, and entered too; then with a power of x between the second and third.
    for m in (2, 3, 4):
        before = Curve((t, t**2 + 5 * t**3, t**3), t, R(-1, 10), 0)
        x = t**m * (1 + t)
        after = Curve((x, x**2 + 5 * x**3, x**3), t, 0, R(1, 2))
        assert continuity([before, after], claim="G3").verdict == "CERTIFIED"
        assert continuity([reversed_(after), reversed_(before)], claim="G3").verdict == "CERTIFIED"
        bent = Curve((x, x**2 + R(50001, 10000) * x**3, x**3), t, 0, R(1, 2))
        (joint,) = continuity([before, bent], claim="G3").joints
        assert (joint.continuity, joint.proved) == ("G2", True)
        assert_close(joint.derivative_jump, 6e-4, rtol=1e-9)
        rough = Curve((x, x**2 + 5 * x**3 + t ** (2 * m + 1), x**3), t, 0, R(1, 2))
        (joint,) = continuity([before, rough], claim="G3").joints
        assert (joint.continuity, joint.proved, joint.derivative_jump) == ("G2", True, math.inf)


@pytest.mark.random
@pytest.mark.parametrize(
    ("coordinates", "low", "high", "verdict"),
    [
        ((t**2, t**3), -1, 1, "REFUTED"),
        ((t**3, t**6), -1, 1, "CERTIFIED"),
        ((t**3, t**5), -1, 1, "REFUTED"),  # the curvature is unbounded at 0
        ((t - sp.sin(t), 1 - sp.cos(t)), 1, 7, "REFUTED"),  # a cycloid's cusp at 2 pi
        (((t**2 - 2) ** 2, (t**2 - 2) ** 3), 1, 2, "REFUTED"),
        (((t**2 - 2) ** 3, t * (t**2 - 2) ** 3), 1, 2, "REFUTED"),  # y = sqrt(2 + x**(1/3)) x
        ((t, 1 / t), -1, 1, "UNDECIDED"),
        ((t, (9 * t**2 - 6 * t + 1) ** R(3, 2)), -1, 1, "UNDECIDED"),
        ((t, sp.sqrt(t)), 0, 1, "UNDECIDED"),
        ((t**2, t**3), 0, 1, "UNDECIDED"),  # at the free end the curvature is unbounded
        ((t**2 / 10**9, t**2), R(1, 10**6), 1, "CERTIFIED"),
    ],
)
def test_what_lies_between_the_joints_counts(coordinates, low, high, verdict):
    """The curve goes on smoothly where it ends; only its inside differs."""
    curve = Curve(coordinates, t, low, high)
    jets = [[sp.diff(e, t, k).subs(t, high) / math.factorial(k) for k in range(4)] for e in curve.expressions]
    beyond = Curve([sum(c * t**k for k, c in enumerate(jet)) for jet in jets], t, 0, R(1, 100))
    report = continuity([curve, beyond])
    assert report.joints[0].continuity == "G3"
    assert report.verdict == verdict
    assert (verdict == "CERTIFIED") == (report.proved == "G3")
    assert (verdict == "REFUTED") == bool(report.inside) == bool(report.defects) or verdict == "CERTIFIED"
    assert (verdict == "UNDECIDED") == ("not proved" in str(report))


def test_a_curve_that_is_a_point_is_degenerate():
    assert continuity([Curve((t, 0), t, -1, 0), Curve((0, 0), t, 0, 1)]).verdict == "DEGENERATE"


def test_parts_that_nobody_examined_are_told(monkeypatch):
    from rsym.verify.continuity import continuity as module
    from rsym.verify.continuity.interiors import arcs_of

    line, arc_ = Curve((t, 0), t, -1, 0), arc(1, (0, 1), -sp.pi / 2, 0)
    assert continuity([line, arc_], claim="G1").verdict == "CERTIFIED"
    lost = [
        lambda curve: [],
        lambda curve: [type(one)(one.curve, one.proved[1:], one.open) for one in arcs_of(curve)],
        lambda curve: [type(one)(one.curve, (*one.proved, *one.proved), one.open) for one in arcs_of(curve)],
    ]
    for arcs in lost:
        monkeypatch.setattr(module, "arcs_of", arcs)
        report = continuity([line, arc_], claim="G1")
        assert report.verdict == "UNDECIDED"
        assert any("please report" in one for one in report.doubts)


def test_a_velocity_of_odd_order_at_the_end_points_forwards():
    cubic = Curve((t**3, t**6), t, -1, 0)
    assert continuity([cubic, Curve((t, t**2), t, 0, 1)]).verdict == "CERTIFIED"
    even = Curve((t**2, t**4), t, -1, 0)
    assert continuity([even, Curve((t, t**2), t, 0, 1)]).joints[0].kind == "cusp"


def test_what_cannot_be_proved_is_called_numerical():
    """Machin's formula is beyond the algebra; a difference of 1e-40 is not zero."""
    line = Curve((t, 0), t, -1, 0)
    near = continuity([line, Curve((t, t / 10**40), t, 0, 1)])
    assert (near.verdict, near.continuity, near.joints[0].proved) == ("REFUTED", "G0", True)
    machin = 4 * sp.atan(R(1, 5)) - sp.atan(R(1, 239)) - sp.pi / 4
    report = continuity([line, Curve((t, machin * t), t, 0, 1)])
    (joint,) = report.joints
    assert (report.verdict, report.continuity, joint.proved, joint.tangent_jump) == ("UNDECIDED", "G3", False, 0)
    assert joint.reason.startswith("G1 only numerically")
    assert 0 < joint.tangent_jump_error < 1e-70
    back = continuity([line, Curve((-t, machin * t), t, 0, 1)])
    assert (back.verdict, back.continuity, back.joints[0].tangent_jump) == ("UNDECIDED", "G0", 180)


def test_arcs_of_any_angle_and_speed_are_proved_to_be_one_circle():
    first = Curve((sp.cos(t), sp.sin(t)), t, 0, 0.1)
    second = Curve((sp.cos(t) ** 2 - sp.sin(t) ** 2, sp.sin(2 * t)), t, R(0.1) / 2, 1)
    assert continuity([first, second], claim="G3").verdict == "CERTIFIED"


def test_a_root_at_the_end_is_not_differentiated():
    report = continuity([Curve((t, 0), t, -1, 0), Curve((t, sp.sqrt(t**5)), t, 0, 1)])
    assert report.verdict == "UNDECIDED"
    assert "analytic" in report.joints[0].reason


@pytest.mark.parametrize(
    ("number", "answer"),
    [
        (sp.sqrt(2 + sp.sqrt(3)) - (sp.sqrt(6) + sp.sqrt(2)) / 2, True),
        (sp.sqrt(10**10 + 1) - 10**5 - R(1, 2 * 10**5), False),
        (sp.cos(sp.pi / 5) - (1 + sp.sqrt(5)) / 4, True),
        (sp.exp(sp.pi * sp.sqrt(163)) - 262537412640768744, False),
        (sp.cos(R(3, 7)) - 4 * sp.cos(R(1, 7)) ** 3 + 3 * sp.cos(R(1, 7)), True),
        (sp.cos(sp.pi / 7) - sp.cos(2 * sp.pi / 7) + sp.cos(3 * sp.pi / 7) - R(1, 2), True),
        (4 * sp.atan(R(1, 5)) - sp.atan(R(1, 239)) - sp.pi / 4, None),
    ],
)
def test_zero_is_proved_and_disproved(number, answer):
    assert vanishes(number) is answer


@pytest.mark.parametrize(
    "given",
    [
        lambda: Curve((t,), t, 0, 1),
        lambda: Curve((t, sp.Symbol("a")), t, 0, 1),
        lambda: Curve((t, sp.Abs(t)), t, 0, 1),
        lambda: Curve((t, sp.Max(t, 0)), t, 0, 1),
        lambda: Curve((t, t), t, 1, 1),
        lambda: continuity([PLANE]),
        lambda: continuity([PLANE, SPACE]),
        lambda: continuity([PLANE, PLANE], claim="C2"),
    ],
)
def test_bad_input_is_refused_with_a_remedy(given):
    with pytest.raises(RsymError) as caught:
        given()
    assert caught.value.remedy


def test_the_report_in_words():
    text = str(continuity([Curve((t, 0), t, -1, 0), arc(2, (0, 2), -sp.pi / 2, 0)]))
    assert text.startswith("REFUTED: the joints are G1, G2 was claimed.\n  1. curvature jump at (0, 0): ")
    assert rsym.Curve is Curve
