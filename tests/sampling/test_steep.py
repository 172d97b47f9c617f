"""Meshes of steep functions: their slopes say nothing a cell away, and the signs of values say all."""

from __future__ import annotations

import numpy as np
import pytest
import sympy as sp

import rsym
from rsym import x, y, z
from rsym.errors import RsymError

D = 1 - x**2 - y**2 - z**2
BOUNDS = ((-1.3, 1.3),) * 3
CELLS = 16


def ball(expression):
    return rsym.Shape(expression, (x, y, z), bounds=BOUNDS)


STEEP = {
    "a profile of 1/30": sp.tanh(30 * D),
    "a profile of 1e-4": sp.tanh(10**4 * D),
    "an angle": sp.atan(10**6 * D),
    "an error function": sp.erf(1000 * D),
    "a root, steep at 0 alone": sp.sign(D) * sp.Abs(D) ** sp.Rational(1, 3),
    "a sign": sp.sign(D),
    "a jump": sp.Piecewise((1 + x**2, D > 0), (-1 - y**2, True)),
    "tiny": D / 10**300,
}


@pytest.mark.filterwarnings("ignore")  # that nothing is proved of them is right
@pytest.mark.parametrize("name", STEEP)
def test_a_ball_is_a_ball_however_steep_it_is(name):
    mesh = rsym.mesh(ball(STEEP[name]), CELLS)
    assert mesh.status.closed
    # By construction all vertices lie on the sphere, up to what a profile hides of it in float64.
    assert abs(np.linalg.norm(mesh.vertices, axis=1) - 1).max() < 1e-8
    # Inscribed: a hundredth of the volume at most, of cells of a sixth of the radius (h**2/4).
    assert 0.98 * 4 / 3 * np.pi < mesh.volume < 4 / 3 * np.pi
    assert mesh.status.off_surface is None
    assert not mesh.status.clipped


@pytest.mark.parametrize("power", [60, 200, 600])
def test_powers_that_are_nearly_a_cube_stay_in_their_bounds(power):
    mesh = rsym.mesh(ball(1 - x**power - y**power - z**power), 24)
    assert np.abs(mesh.vertices).max() <= 1 + 1e-12
    assert mesh.status.off_surface is None
    # The body lies between the cubes of half side (1/3)**(1/p) and 1; its rounded edges are cut by a cell at most.
    assert 8 - 12 * 2 * (2.6 / 24) ** 2 < mesh.volume < 8
    assert not mesh.status.clipped


@pytest.mark.filterwarnings("ignore")
def test_vertices_on_a_large_body_without_its_scale():
    """A leaf next to its zero is beyond the distances of the bounds: which one is crossed its sign tells."""
    mesh = rsym.mesh(ball(sp.tanh(30 * D) * 10**12), CELLS)
    assert set(mesh.leaf.tolist()) == {0}


def test_two_cells_of_a_ball_are_too_few_and_it_is_no_point():
    with pytest.raises(RsymError, match="resolution") as caught:
        rsym.mesh(ball(D), 2)
    assert caught.value.code == "no-surface"
    assert "extent" not in str(caught.value)


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("size", [1e-100, 1e100])
def test_sizes_beyond_numbers_are_refused_and_not_meshed_for_ever(size):
    body = rsym.sphere(1) - rsym.cylinder(0.5, 4)
    with pytest.raises(RsymError, match="unit") as caught:
        rsym.mesh(body.scale(size), 16)
    assert caught.value.code == "size"
    there, here = (rsym.mesh(shape, 16) for shape in (body.scale(2.0**-180), body))
    assert abs(there.volume * 2.0**540 - here.volume) < 1e-12
