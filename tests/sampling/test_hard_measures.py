"""What is measured of shapes whose functions are steep, have kinks, poles, products and singular points."""

import math

import pytest
import sympy as sp

import rsym
from rsym import x, y, z

DISC, BALL = 1 - x**2 - y**2, 1 - x**2 - y**2 - z**2
WINDOW = ((-1.5, 1.5),) * 3


def holds(value, truth, most=1e-6):
    """An error below a relative one, and below the one that is stated."""
    error = abs(value - truth)
    return error <= most * abs(truth) and error <= value.error


@pytest.mark.parametrize(
    "steep", [sp.tanh(1000 * DISC), sp.atan(10**6 * DISC), sp.exp(300 * DISC) - 1, sp.erf(1000 * DISC)], ids=str
)
def test_what_rises_steeply_through_0_is_measured_as_what_it_rises_with(steep):
    found = rsym.measure(rsym.Shape(steep, (x, y), bounds=WINDOW[:2]))
    assert holds(found.area, math.pi, 1e-13)
    assert holds(found.length, 2 * math.pi, 1e-13)


def test_what_rises_steeply_through_0_is_meshed_as_what_it_rises_with():
    meshes = [rsym.mesh(rsym.Shape(steep, (x, y, z), bounds=WINDOW), 24) for steep in (BALL, sp.tanh(10**4 * BALL))]
    assert meshes[1].volume == pytest.approx(meshes[0].volume, rel=1e-9)
