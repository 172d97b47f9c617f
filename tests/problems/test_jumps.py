"""Values that differ between parts: lifts no steeper than what lies between, jumps at corners, fluxes."""

import math

import numpy as np
import pytest
import sympy as sp

import rsym
from rsym import x, y

HEAT = "-laplacian(u) = 0"


def plane(formula):
    return rsym.Shape(formula, (x, y))


def plate(width, height):
    """A rectangle, its sides named."""
    across = plane(x).named("left") & plane(width - x).named("right")
    return across & plane(y).named("bottom") & plane(height - y).named("top")


HOLES = {
    "square": rsym.rectangle(1, 1),
    "half planes": plane(x + 1 / 2) & plane(1 / 2 - x) & plane(y + 1 / 2) & plane(1 / 2 - y),
    "triangle": rsym.polygon([(-0.5, -0.4), (0.5, -0.4), (0, 0.5)]),
}


@pytest.mark.parametrize("hole", HOLES)
def test_what_flows_from_a_hole_with_corners_to_a_rim_that_is_near(hole):
    shape = rsym.disc(1).named("outer") - HOLES[hole].named("inner")
    fluxes = []
    for cells in (24, 48):
        u = rsym.solve(shape, HEAT, {"outer": 0, "inner": 1}, cells=cells)
        assert u.flux("outer") == pytest.approx(-u.flux("inner"), rel=1e-12)
        assert u.minimum().value > -1e-3
        fluxes.append(u.flux("inner"))
    assert fluxes[0] == pytest.approx(fluxes[1], rel=1e-4)
    if hole != "triangle":
        assert fluxes[1] == pytest.approx(11.953, rel=2e-5)


def test_a_ring_has_the_flux_of_its_logarithm():
    ring = rsym.disc(1).named("outer") - rsym.disc(1 / 2).named("inner")
    u = rsym.solve(ring, HEAT, {"outer": 0, "inner": 1}, cells=16)
    assert u.flux("inner") == pytest.approx(2 * math.pi / math.log(2), rel=1e-9)


def series(places):
    """A square of which the top is at 100, by its series."""
    u, v = np.transpose(places)
    k = np.arange(1, 200, 2)[:, None]
    return np.sum(400 / np.pi / k * np.sin(k * np.pi * u) * np.sinh(k * np.pi * v) / np.sinh(k * np.pi), axis=0)


def test_a_square_about_a_hole_has_lifts_that_are_smooth_at_its_corners():
    square = plane(4 - x**2).named("side") & plane(4 - y**2).named("side")
    u = rsym.solve(square - rsym.disc(1).named("hole"), HEAT, {"side": sp.log(x**2 + y**2), "hole": 0}, cells=24)
    places = np.random.default_rng(8).uniform(1, 2, (200, 2))
    assert np.abs(u(*places.T) - np.log(np.sum(places**2, axis=1))).max() < 3e-6


def test_one_edge_of_a_plate_is_hot():
    u = rsym.solve(plate(1, 1), HEAT, {"top": 100, ...: 0}, cells=40)
    places = np.array([(0.5, 0.5), (0.25, 0.75), (0.1, 0.8), (0.9, 0.3), (0.99, 0.01), (0.03, 0.04)])
    assert np.abs(u(*places.T) - series(places)).max() < 3e-5
    k = np.arange(1, 40, 2)
    assert u.flux("bottom") == pytest.approx(-np.sum(800 / (k * np.pi) / np.sinh(k * np.pi)), rel=2e-6)
    assert (u.flux("top"), u.flux("left")) == (math.inf, -math.inf)
    assert abs(u.flux()) < 1e-10
    assert (u(0.5, 1), u(0, 0.5)) == (100, 0)


def test_a_bar_whose_ends_are_hot_is_cold_in_the_middle():
    """Problem 10 of SIAM's hundred digits, of a Brownian particle."""
    bar = plate(10, 1)
    u = rsym.solve(bar, HEAT, {"left": 1, "right": 1, ...: 0}, cells=240)
    assert u(5, 0.5) == pytest.approx(3.8375879792512e-7, abs=1e-10)


def test_values_that_are_not_constant_jump():
    quarter = rsym.disc(1).named("arc") & plane(x).named("left") & plane(y).named("bottom")
    given = {"arc": x, "left": y, "bottom": 0}
    one, other = (rsym.solve(quarter, HEAT, given, cells=cells)(0.5, 0.5) for cells in (24, 48))
    assert one == pytest.approx(other, abs=2e-6)


def test_values_jump_at_a_corner_that_points_inwards():
    ell = plane(x) & plane(y) & plane(2 - x) & plane(2 - y) & (plane(1 - x).named("i") | plane(1 - y).named("j"))
    one, other = (rsym.solve(ell, HEAT, {"i": 1, "j": 0, ...: 0}, cells=cells)(0.5, 0.5) for cells in (32, 64))
    assert one == pytest.approx(other, abs=1e-5)


def test_displacements_that_jump_are_refused():
    given = {"left": rsym.fixed(), "top": rsym.displacement({x: 1, y: 0})}
    with pytest.raises(rsym.RsymError, match="jump at"):
        rsym.elasticity(plate(1, 1), given, young=1, poisson=0.3, cells=8)


def test_through_a_part_with_a_given_flux_that_flows():
    sink = plate(2, 1)
    u = rsym.solve(sink, "-laplacian(u) = 2", {"top": rsym.robin(3, 1), "left": 0}, cells=8)
    assert u.flux("right") == u.flux("bottom") == 0
    assert u.flux("top") + u.flux("left") == pytest.approx(-4, rel=1e-6)


def test_what_lies_beyond_its_data_is_in_the_estimate():
    spiky = rsym.disc(1).named("rim") - rsym.rectangle(1.3, 0.25).named("bar")
    u = rsym.solve(spiky, HEAT, {"rim": 0, "bar": 1}, cells=20)
    values = u.jets(u.rule.points, 0)[0]
    assert u.report.estimate >= max(-values.min(), values.max() - 1)


def test_values_that_differ_where_edges_touch_are_refused_beside_jumps():
    # The discs touch inside: a cusp, where no angle tells; at the other corners values may jump.
    crescent = rsym.disc(1).named("outer") - rsym.disc(1 / 2, (1 / 2, 0)).named("inner")
    half = crescent & plane(x + y + 1 / 4).named("cut")
    with pytest.raises(rsym.RsymError, match="meet at"):
        rsym.solve(half, HEAT, {"outer": 0, "inner": 1, "cut": 2}, cells=16)
