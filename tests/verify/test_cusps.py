"""Points of a leaf without a gradient whose second derivatives vanish along one line."""

import pytest
import sympy as sp

import rsym
from rsym import x, y, z

Q = sp.Rational


def body(expression):
    return rsym.Shape(expression, (x, y, z), bounds=((-1, 1.25),) * 3)


@pytest.mark.slow
def test_taubins_heart_has_two_cusps():
    """Near (0, 0, 1), with u = z - 1, it is 8 u**3 = x**2 + 9/80 y**2 + ...: u grows like the 2/3rd power."""
    heart = (x**2 + Q(9, 4) * y**2 + z**2 - 1) ** 3 - (x**2 + Q(9, 80) * y**2) * z**3
    report = rsym.verify_smoothness(rsym.Shape(-heart, (x, y, z), bounds=((-1.5, 1.5),) * 3))
    assert (report.verdict, report.continuity) == ("REFUTED", "G0")
    cusps = [point for point in report.points if point.kind == "cusp"]
    assert {point.point for point in cusps} == {(0, 0, 1), (0, 0, -1)}
    assert all(point.proved for point in cusps)


@pytest.mark.random
@pytest.mark.parametrize(
    ("expression", "kind"),
    [
        (z**3 - x**2 - y**2, "cusp"),
        ((z + x) ** 3 - 2 * x**2 - x * y - y**2 + y**4, "cusp"),
        (z**3 - x**2 + y**2, None),  # the form has both signs
        (z**5 - x**2 - y**2, None),  # A_4: not looked at
        (z**2 - x**2 - y**2 - z**3, "node"),
        (z**4 - x**2 - y**2, None),  # two horns
    ],
)
def test_cusps_by_construction(expression, kind):
    report = rsym.verify_smoothness(body(expression), method="space")
    assert {point.kind for point in report.points if point.proved} == ({kind} if kind else set())
    assert report.verdict != "CERTIFIED"
    if kind == "cusp":
        assert (report.verdict, report.continuity) == ("REFUTED", "G0")
