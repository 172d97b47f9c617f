import json
import math

import mpmath as mp
import pytest
import sympy as sp
from oracles.closeness import assert_close

import rsym
from rsym import x, y
from rsym.verify.fairness.fairness import fairness

A, B = 2, 1
ELLIPSE = rsym.Shape(1 - x**2 / A**2 - y**2 / B**2, (x, y), bounds=((-3, 3), (-2, 2)))
DISC = rsym.Shape(1 - x**2 - y**2, (x, y), bounds=((-2, 2), (-2, 2)))
STADIUM = rsym.Shape(1 - sp.Max(sp.Abs(x) - 1, 0) ** 2 - y**2, (x, y), bounds=((-3, 3), (-2, 2)))


def speed(t):
    return mp.sqrt((A * mp.sin(t)) ** 2 + (B * mp.cos(t)) ** 2)


def bend(t):
    return A * B / speed(t) ** 3


def variation(t):
    return 3 * A * B * (B**2 - A**2) * mp.sin(t) * mp.cos(t) / speed(t) ** 6


@pytest.mark.slow
def test_an_ellipse_has_four_vertices_and_textbook_measures():
    report = fairness(ELLIPSE, tolerance=1e-3)
    (bounds,) = report.curvatures
    assert report.kind, report.verdict == ("curve", "CERTIFIED")
    assert report.complete
    assert report.inflections == ()
    vertices = sorted((round(one.point[0]), round(one.point[1]), one.kind) for one in report.extrema)
    assert vertices == [(-2, 0, "maximum"), (0, -1, "minimum"), (0, 1, "minimum"), (2, 0, "maximum")]
    for one in report.extrema:
        assert one.proved
        assert one.radius < 1e-9
        assert math.dist(one.point, tuple(map(round, one.point))) <= one.radius
        assert_close(one.curvature, 2 if one.kind == "maximum" else 0.25, rtol=1e-14)
    steepest = mp.findroot(lambda t: mp.diff(variation, t), 0.25)
    for peak, truth in (
        (bounds.least, 0.25),
        (bounds.greatest, 2.0),
        (bounds.variation, float(abs(variation(steepest)))),
    ):
        assert peak.proved
        assert_close(peak.bound, truth, atol=5e-3)
        assert (peak.bound - truth) * (-1 if peak is bounds.least else 1) >= 0
        assert_close(peak.attained, truth, atol=5e-3)
    sizes = {
        "length": 4 * A * mp.ellipe(1 - mp.mpf(B) ** 2 / A**2),
        "area": mp.pi * A * B,
        "bending_energy": mp.quad(lambda t: bend(t) ** 2 * speed(t), mp.linspace(0, 2 * mp.pi, 9)),
        "variation_energy": mp.quad(lambda t: variation(t) ** 2 * speed(t), mp.linspace(0, 2 * mp.pi, 9)),
    }
    for name, truth in sizes.items():
        measure = report.measures[name]
        assert_close(measure.value, float(truth), atol=10 * measure.error)
        assert measure.error < 1e-9


@pytest.mark.slow
def test_a_circle_has_constant_curvature():
    report = fairness(DISC)
    assert report.constant == (True,)
    assert report.extrema == ()
    assert report.complete
    assert report.curvatures[0].variation.bound == 0
    assert "constant" in str(report)


@pytest.mark.slow
def test_a_circle_by_a_root_looks_constant_and_is_not_called_proved():
    report = fairness(rsym.Shape(1 - sp.sqrt(x**2 + y**2), (x, y), bounds=((-2, 2), (-2, 2))), tolerance=0.2)
    assert report.constant == (False,)
    assert not report.complete
    assert any("constant" in sentence and not proved for sentence, proved in report.statements)


@pytest.mark.slow
def test_inflections_of_a_cassini_oval():
    # r1 r2 = b**2 with foci at +-1: for 1 < b < sqrt(2) it has four inflections, at r**2 = sqrt((b**4 - 1)/3).
    b4 = sp.Rational(6, 5)
    oval = rsym.Shape(b4 - ((x - 1) ** 2 + y**2) * ((x + 1) ** 2 + y**2), (x, y), bounds=((-2, 2), (-2, 2)))
    report = fairness(oval)
    assert report.complete
    assert len(report.inflections) == 4
    for one in report.inflections:
        assert one.proved
        assert_close(math.hypot(*one.point) ** 2, math.sqrt((float(b4) - 1) / 3), rtol=1e-13)
    assert sorted(one.kind for one in report.extrema) == ["maximum"] * 2 + ["minimum"] * 2


@pytest.mark.slow
def test_flat_points_are_no_inflections():
    report = fairness(rsym.Shape(1 - x**4 - y**4, (x, y), bounds=((-2, 2), (-2, 2))))
    flat = [one for one in report.extrema if one.flat]
    assert report.complete
    assert report.inflections == ()
    assert sorted(one.point for one in flat) == [(-1, 0), (0, -1), (0, 1), (1, 0)]
    assert all(one.proved and one.kind == "minimum" for one in flat)
    peaks = [one for one in report.extrema if not one.flat]
    assert len(peaks) == 4
    assert_close([one.curvature for one in peaks], [3 * 2**-0.25] * 4, rtol=1e-14)


def paper_omega(x0, r):
    """The paper's body at a2 = 6, written out."""
    t = (25 - x0**2) / 10
    gap = (mp.sqrt(t**2 + r**4) - t) / 2
    return (8 - x0) * (6 + x0) / 40 - mp.mpf(1) / 10 - mp.sqrt(r**2 + gap**2)


def bend_of_the_meridian(point):
    """The curvature at a point by differences of the meridian as a graph, with no formula of implicit curves."""
    x0, r0 = map(mp.mpf, point)
    if abs(r0) < 1e-9:
        return abs(mp.diff(lambda r: mp.findroot(lambda s: paper_omega(s, r), x0), 0, 2))

    def radius(s):
        return mp.findroot(lambda r: paper_omega(s, r), r0)

    return -mp.diff(radius, x0, 2) / (1 + mp.diff(radius, x0) ** 2) ** mp.mpf("1.5")


@pytest.mark.slow
def test_the_body_of_the_paper_as_a_body_of_revolution():
    report = fairness(rsym.revolve(rsym.paper.skeleton_body()), letters={"a2": 6})
    along, across = report.curvatures
    assert report.kind, report.verdict == ("body of revolution", "CERTIFIED")
    assert report.complete
    assert report.inflections == ()
    own = [one for one in report.extrema if one.quantity == along.name]
    assert [one.kind[:3] for one in own] == ["min", "max", "min", "max", "min", "max", "min"]
    with mp.workdps(40):
        for one in own:
            assert_close(one.curvature, float(bend_of_the_meridian(one.point)), rtol=1e-10)
    tip = own[0]
    assert_close(tip.point, [float(mp.findroot(lambda s: paper_omega(s, 0), -5.1)), 0], atol=1e-12)
    assert_close(tip.curvature, 4.3007, atol=5e-5)
    at_the_tip = [one.curvature for one in report.extrema if one.quantity == across.name and one.point[0] < -5.17]
    assert_close(at_the_tip, [tip.curvature], rtol=1e-14)  # an umbilic
    for bounds in (along, across):
        assert bounds.least.bound <= bounds.least.attained
        assert bounds.greatest.attained <= bounds.greatest.bound <= 1.01 * bounds.greatest.attained
        assert bounds.variation.attained <= bounds.variation.bound <= 1.011 * bounds.variation.attained


def test_a_stadium_is_broken_at_its_joints_and_constant_between():
    report = fairness(STADIUM)
    assert (report.verdict, report.continuity) == ("REFUTED", "G1")
    assert report.constant == (True,)
    (bounds,) = report.curvatures
    assert (bounds.least.bound, bounds.variation.bound) == (0, 0)
    assert 1 <= bounds.greatest.bound < 1.02
    assert "broken at 4 places" in str(report)
    assert_close(report.measures["length"].value, 4 + 2 * math.pi, rtol=1e-13)
    assert_close(report.measures["area"].value, 4 + math.pi, rtol=1e-13)
    assert_close(report.measures["bending_energy"].value, 2 * math.pi, rtol=1e-13)


@pytest.mark.slow
def test_a_torus_and_an_ellipsoid():
    # A torus of radii 2 and 1: k1 = 1, k2 = cos/(2 + cos), between -1 and 1/3; (k2)' = -2 sin/(2 + cos)**2.
    ring = rsym.Shape(16 * y**2 - (x**2 + y**2 + 3) ** 2, (x, y), bounds=((-2, 2), (-4, 4)))
    report = fairness(rsym.revolve(ring), tolerance=1e-3)
    along, across = report.curvatures
    assert report.constant == (True, False)
    assert report.complete
    steepest = mp.findroot(lambda t: mp.diff(lambda s: 2 * mp.sin(s) / (2 + mp.cos(s)) ** 2, t), 2)
    for peak, truth in (
        (along.least, 1.0),
        (along.greatest, 1.0),
        (across.least, -1.0),
        (across.greatest, 1 / 3),
        (across.variation, float(2 * mp.sin(steepest) / (2 + mp.cos(steepest)) ** 2)),
    ):
        assert_close(peak.bound, truth, atol=2e-3)
        assert_close(peak.attained, truth, atol=2e-3)
    assert sorted((one.kind, one.point[1]) for one in report.extrema) == [("maximum", 3.0), ("minimum", 1.0)]
    assert sorted(one.point for one in report.inflections) == [(-1.0, 2.0), (1.0, 2.0)]
    sizes = [report.measures[name].value for name in ("area", "volume", "bending_energy")]
    willmore = mp.quad(lambda t: (1 + (mp.cos(t) / (2 + mp.cos(t))) ** 2) * 2 * mp.pi * (2 + mp.cos(t)), [0, 2 * mp.pi])
    assert_close(sizes, [8 * math.pi**2, 4 * math.pi**2, float(willmore)], rtol=1e-12)
    oval = fairness(rsym.revolve(ELLIPSE))
    assert oval.complete
    found = {
        (bounds.name.split()[1], peak.attained)
        for bounds in oval.curvatures
        for peak in (bounds.least, bounds.greatest)
    }
    assert found == {("of", 0.25), ("of", 2.0), ("across", 1.0), ("across", 2.0)}
    assert_close(oval.measures["volume"].value, 4 / 3 * math.pi * A * B**2, rtol=1e-13)


def test_a_corner_breaks_the_curve_and_nothing_beyond_it_counts():
    half = fairness(rsym.Shape(rsym.conjunction(1 - x**2 / 4 - y**2, x + y / 3), (x, y), bounds=((-3, 3), (-2, 2))))
    assert (half.verdict, half.continuity, len(half.smoothness.defects)) == ("REFUTED", "G0", 2)
    assert sorted((one.kind, *one.point) for one in half.extrema) == [("maximum", 2.0, 0.0), ("minimum", 0.0, 1.0)]
    # The chord goes through the centre: half the ellipse and a diameter.
    assert_close(half.measures["area"].value, math.pi, rtol=1e-9)
    end = 1 / math.sqrt(1 / 36 + 1)
    length = 2 * float(mp.ellipe(1 - mp.mpf(B) ** 2 / A**2)) * A + 2 * end * math.hypot(1, 1 / 3)
    assert_close(half.measures["length"].value, length, rtol=1e-9)


@pytest.mark.parametrize(("height", "kept"), [("1/10000", [(0, 1)]), ("-1/10000", [(-2, 0), (0, 1), (2, 0)])])
def test_a_vertex_next_to_a_joint_counts_on_its_own_side_only(height, kept):
    cut = rsym.conjunction(1 - x**2 / 4 - y**2, y - sp.Rational(height))
    report = fairness(rsym.Shape(cut, (x, y), bounds=((-3, 3), (-2, 2))))
    assert report.complete
    assert sorted((round(one.point[0]), round(one.point[1])) for one in report.extrema) == kept


@pytest.mark.slow
def test_a_circle_is_known_when_its_equation_has_another_factor():
    product = sp.expand((1 - x**2 - y**2) * (x + 3))
    assert fairness(rsym.Shape(product, (x, y), bounds=((-2, 2), (-2, 2)))).constant == (True,)
    assert fairness(ELLIPSE, tolerance=0.5).constant == (False,)


def test_words_and_records():
    report = fairness(ELLIPSE, tolerance=0.2)
    record = json.loads(report.to_json())
    assert record["format"] == "rsym-fairness-report"
    assert record["complete"] is True
    assert len(record["extrema"]) == 4
    assert record["curvatures"][0]["greatest"]["bound"] >= 2
    assert record["measures"]["length"]["estimated_error"] < 1e-9
    text = str(report)
    assert "2 maxima, 2 minima and no inflection; these are all, which is proved" in text
    assert "greatest curvature" in text
    assert "<table>" in report._repr_html_()


@pytest.mark.parametrize(
    ("arguments", "meant"),
    [
        ({"tolerance": 0}, "tolerance"),
        ({"letters": {"a": (1, 2)}}, "ranges"),
        ({"bounds": ((5, 6), (5, 6))}, "no regular boundary"),
    ],
)
def test_what_is_refused(arguments, meant):
    a = sp.Symbol("a", real=True)
    oval = rsym.Shape(1 - x**2 / a**2 - y**2, (x, y), letters={a: 2}, bounds=((-3, 3), (-2, 2)))
    with pytest.raises(rsym.RsymError, match=meant):
        fairness(oval, **arguments)


@pytest.mark.slow
def test_a_spent_budget_is_admitted():
    report = fairness(rsym.paper.skeleton_body(), letters={"a2": 6}, budget=150)
    assert not report.complete
    assert any(not proved for _, proved in report.statements)
    assert report.curvatures[0].greatest.bound >= 4.42600989


def test_progress_can_cancel():
    with pytest.raises(rsym.RsymError, match="cancelled"):
        fairness(ELLIPSE, progress=lambda done, total: False)
