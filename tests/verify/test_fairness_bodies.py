import math

import mpmath as mp
import numpy as np
import pytest
from oracles.closeness import assert_close

import rsym
from rsym import x, y, z
from rsym.verify.boxes.local import Model
from rsym.verify.fairness.bodies import CurvedSurface
from rsym.verify.fairness.fairness import fairness

TORUS = rsym.Shape(
    16 * (x**2 + y**2) - (x**2 + y**2 + z**2 + 3) ** 2, (x, y, z), bounds=((-3.2, 3.2), (-3.2, 3.2), (-1.2, 1.2))
)


def test_gradients_of_principal_curvatures_on_a_torus():
    # Radii 2 and 1: k1 = 1; k2 = cos t/(2 + cos t) with dk2/dt = -2 sin t/(2 + cos t)**2, t also the arc length.
    t, u = np.random.default_rng(7).uniform(-3, 3, (2, 40))
    ring = 2 + np.cos(t)
    found = CurvedSurface(Model(TORUS, {}))(np.stack([ring * np.cos(u), ring * np.sin(u), np.sin(t)], axis=1))
    assert_close(found.offset, np.zeros(40), atol=1e-13)
    assert_close(found.values, np.stack([np.cos(t) / ring, 1 + 0 * t, (1 + np.cos(t) / ring) / 2], axis=1), atol=1e-12)
    along = np.stack([-np.sin(t) * np.cos(u), -np.sin(t) * np.sin(u), np.cos(t)], axis=1)
    slope = (-2 * np.sin(t) / ring**2)[:, None] * along
    assert_close(found.gradients, np.stack([slope, 0 * slope, slope / 2], axis=1), atol=1e-11)


@pytest.mark.slow
def test_an_ellipsoid_with_three_axes():
    a, b, c = 3, 2, 1
    body = rsym.Shape(
        1 - (x / a) ** 2 - (y / b) ** 2 - (z / c) ** 2, (x, y, z), bounds=((-3.5, 3.5), (-2.5, 2.5), (-1.5, 1.5))
    )
    report = fairness(body)
    (bounds,) = report.curvatures
    assert (report.kind, report.verdict, report.complete) == ("body", "CERTIFIED", False)
    assert bounds.least.proved
    assert bounds.greatest.proved
    assert not bounds.variation.proved
    assert c / a**2 * 0.9 < bounds.least.bound <= c / a**2
    assert a / c**2 <= bounds.greatest.bound < a / c**2 * 1.1
    truth = {  # at the tips of the longest and of the shortest axis
        ("smaller principal curvature", "maximum"): (a / b**2, (a, 0, 0)),
        ("larger principal curvature", "maximum"): (a / c**2, (a, 0, 0)),
        ("smaller principal curvature", "minimum"): (c / a**2, (0, 0, c)),
        ("larger principal curvature", "minimum"): (c / b**2, (0, 0, c)),
        ("mean curvature", "maximum"): ((a / b**2 + a / c**2) / 2, (a, 0, 0)),
        ("mean curvature", "minimum"): ((c / a**2 + c / b**2) / 2, (0, 0, c)),
    }
    assert len(report.extrema) == 12
    for one in report.extrema:
        value, place = truth[one.quantity, one.kind]
        assert not one.proved
        assert_close(one.curvature, value, rtol=1e-11)
        assert_close(np.abs(one.point), place, atol=1e-9)
    # Legendre's formula for the area.
    angle, share = mp.acos(mp.mpf(c) / a), mp.mpf(a**2 * (b**2 - c**2)) / (b**2 * (a**2 - c**2))
    both = mp.ellipe(angle, share) * mp.sin(angle) ** 2 + mp.ellipf(angle, share) * mp.cos(angle) ** 2
    area = 2 * mp.pi * (c**2 + a * b / mp.sin(angle) * both)
    for name, size in (("area", float(area)), ("volume", 4 / 3 * math.pi * a * b * c)):
        assert_close(report.measures[name].value, size, atol=report.measures[name].error)
    assert "numerical" in str(report.extrema[0])
    assert "none" in str(report)


@pytest.mark.slow
def test_edges_have_no_part_in_what_is_sampled():
    block = rsym.conjunction(1 - x**2, 1 - y**2, 1 - z**2)
    report = fairness(rsym.Shape(block, (x, y, z), bounds=((-1.5, 1.5),) * 3))
    (bounds,) = report.curvatures
    assert (report.verdict, report.continuity) == ("REFUTED", "G0")
    assert (bounds.least.attained, bounds.greatest.attained) == (0, 0)
    assert_close(report.measures["area"].value, 24, rtol=1e-9)
    assert_close(report.measures["bending_energy"].value, 0, atol=1e-9)
    assert len([one for one in report.smoothness.defects if one.kind == "edge"]) == 12
