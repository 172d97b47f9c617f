import math

import mpmath as mp
import sympy as sp
from closeness import assert_close

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


def test_a_circle_has_constant_curvature():
    report = fairness(DISC)
    assert report.constant == (True,)
    assert report.extrema == ()
    assert report.complete
    assert report.curvatures[0].variation.bound == 0
    assert "constant" in str(report)


def test_a_circle_by_a_root_looks_constant_and_is_not_called_proved():
    report = fairness(rsym.Shape(1 - sp.sqrt(x**2 + y**2), (x, y), bounds=((-2, 2), (-2, 2))), tolerance=0.2)
    assert report.constant == (False,)
    assert not report.complete
    assert any("constant" in sentence and not proved for sentence, proved in report.statements)


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
