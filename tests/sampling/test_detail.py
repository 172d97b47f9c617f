"""Warnings about detail below the resolution: where there is some, and nowhere else."""

from functools import partial

import numpy as np
import pytest
import sympy as sp
from oracles.closeness import assert_close

import rsym
from rsym import RsymWarning, conjunction, disjunction, x, y, z
from rsym.sampling.lattice import SHIFTS

mesh_smoothly = partial(rsym.mesh, method="smooth")

BOX = ((-1.2, 1.2),) * 3
CELL = 2.4 / 32


def shape(omega):
    return rsym.Shape(omega, (x, y, z), bounds=BOX)


PLAIN = {
    "ball": 1 - x**2 - y**2 - z**2,
    "small ball": 0.01 - x**2 - y**2 - z**2,
    "ellipsoid": 1 - x**2 - 4 * y**2 - 9 * z**2,
    "torus": 0.09 - (sp.sqrt(x**2 + y**2) - sp.Rational(4, 5)) ** 2 - z**2,
    "cube": conjunction(1 - x**2, 1 - y**2, 1 - z**2),
    "wedge of 60 degrees": conjunction(1 - x**2 - y**2, 1 - z**2, x - sp.sqrt(3) * y, x + sp.sqrt(3) * y),
}


@pytest.mark.random
@pytest.mark.parametrize("name", PLAIN)
@pytest.mark.parametrize("resolution", [24, 32])
def test_plain_bodies_raise_no_alarm(name, resolution):
    """Warnings are errors here: a ball has lines that graze it, a cube and a wedge edges."""
    assert mesh_smoothly(shape(PLAIN[name]), resolution).status.remarks == ()


@pytest.mark.random
@pytest.mark.parametrize("thickness", [0.4, 0.8, 1.3])
@pytest.mark.parametrize("sign", [1, -1])
def test_a_slanting_wall_or_gap_is_measured(thickness, sign):
    half = thickness * CELL / 2
    normal = np.array([1, 2, -9]) / np.sqrt(86)
    height = x * normal[0] + y * normal[1] + z * normal[2] - 0.01
    ball = 1 - x**2 - y**2 - z**2
    body = shape(conjunction(ball, sign * (half**2 - height**2)))
    if thickness > 1:
        assert mesh_smoothly(body, 32).status.thin is None
        return
    # Where the rim runs between samples a wall leaves crumbs, which are told too.
    with pytest.warns(RsymWarning) as caught:
        detail = mesh_smoothly(body, 32).status.thin
    assert "a wall or a gap is thinner than a cell" in str(caught[0].message)
    assert f"{2 / thickness:.2g} times the resolution puts 2 cells across it" in str(caught[0].message)
    assert_close(detail.cells, thickness, rtol=0.009)
    assert abs(np.dot(detail.finest, normal) - 0.01) < half
    # About a quarter of the disc's lines along z hit one sample of a wall 0.8 cells thick: some hundreds of 560.
    assert detail.places > 100


def test_cells_are_counted_across_the_wall_whatever_their_shape():
    on_samples = SHIFTS[2] * 0.05
    wall = shape(conjunction(0.015**2 - (z + on_samples) ** 2, 1 - x**2, 1 - y**2))
    with pytest.warns(RsymWarning, match="thinner"):
        detail = mesh_smoothly(wall, (24, 60, 48)).status.thin
    assert_close(detail.cells, 0.6, rtol=1e-6)


def test_a_small_piece_is_found():
    ball = 0.25 - x**2 - y**2 - z**2
    crumb = (1.2 * CELL) ** 2 - (x - 0.9) ** 2 - (y + 0.8) ** 2 - (z - 0.7) ** 2
    with pytest.warns(RsymWarning, match="1 piece is smaller than three cells"):
        mesh = mesh_smoothly(shape(disjunction(ball, crumb)), 32)
    assert mesh.status.components == 2
    assert_close(mesh.status.small.finest, (0.9, -0.8, 0.7), atol=CELL)
    assert_close(mesh.status.small.cells, 2.4, atol=0.5)
    other = 0.04 - (x - 0.9) ** 2 - (y + 0.8) ** 2 - (z - 0.7) ** 2
    assert mesh_smoothly(shape(disjunction(ball, other)), 32).status.remarks == ()


def test_a_knife_edge_is_not_promised_a_resolution():
    tilted = y - 0.3 * x - 0.17 * z
    blade = conjunction(0.8 - x**2 - z**2, x / 20 - tilted, x / 20 + tilted)
    with pytest.warns(RsymWarning) as caught:
        mesh_smoothly(shape(blade), 64)
    assert "it may taper to an edge, which no resolution resolves" in str(caught[0].message)


def test_a_clipped_surface_names_the_sides():
    slab = shape(0.25 - (z - 1) ** 2)
    with pytest.warns(RsymWarning) as caught:
        status = mesh_smoothly(slab, 12).status
    assert [str(warning.message) for warning in caught] == [" ".join(status.remarks)]
    x_and_y = tuple(f"the {end} end of {axis}" for axis in "xy" for end in ("lower", "upper"))
    assert status.clipped_at == x_and_y
    assert "the upper end of y; wider bounds close it" in str(status)
