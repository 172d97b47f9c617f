"""Values on the boundary are data there: what their formulas do inside is nobody's wish."""

import numpy as np
import pytest
import sympy as sp

import rsym
from rsym import x, y

RADIUS = sp.sqrt(x**2 + y**2)
ANGLE = sp.atan2(y, x)
PLACES = np.array([(0.3, 0.4), (0.6, 0.1), (-0.2, 0.7), (0, 0)]).T
DATA = {
    "a pole": (x / (x**2 + y**2), lambda u, v: u),
    "polar": (sp.cos(3 * ANGLE), lambda u, v: u**3 - 3 * u * v**2),
    "a direction": (x / RADIUS, lambda u, v: u),
    "a power": (RADIUS ** sp.Rational(1, 3) * sp.sin(ANGLE), lambda u, v: v),
}


@pytest.mark.parametrize("name", DATA)
def test_data_with_poles_inside_are_what_they_are_on_the_rim(name):
    value, truth = DATA[name]
    u = rsym.solve(rsym.disc(1), "-laplacian(u) = 0", value, cells=32)
    assert np.abs(u(*PLACES) - truth(*PLACES)).max() < 1e-5
    angle = np.linspace(0, 6, 20)
    on = rsym.compile(rsym.Shape(value, (x, y)), backend="numpy")(np.cos(angle), np.sin(angle))["value"]
    assert np.abs(u(np.cos(angle), np.sin(angle)) - on).max() < 1e-12


def test_data_with_poles_inside_meet_a_tolerance():
    u = rsym.solve(rsym.disc(1), "-laplacian(u) = 0", x / (x**2 + y**2), tolerance=1e-5)
    assert np.abs(u(*PLACES) - PLACES[0]).max() < 3e-5


def test_data_on_several_parts_are_kept_to_them():
    ring = rsym.disc(2).named("rim") - rsym.disc(1).named("bore")
    off = (x - sp.Rational(3, 2)) ** 2 + y**2  # a pole in the ring
    u = rsym.solve(ring, "-laplacian(u) = 0", {"rim": 1 / off, "bore": 0}, cells=32)
    v = rsym.solve(ring, "-laplacian(u) = 0", {"rim": 1 / off, "bore": 0}, cells=48)
    assert u(-1.5, 0) == pytest.approx(v(-1.5, 0), rel=5e-3)
    assert abs(u(1.5, 0)) < 8


def test_smooth_data_stay_as_they_are():
    u = rsym.solve(rsym.disc(1), "-laplacian(u) = 0", sp.log((x - 2) ** 2 + y**2), cells=8)
    assert u.problem.lifted.expression == sp.log((x - 2) ** 2 + y**2)
