"""What once went wrong with patches, each with an oracle of its own."""

import numpy as np
import pytest
import sympy as sp
from closeness import assert_close

from rsym.surfaces.parametric import ParametricSurface
from rsym.surfaces.symbols import u, v


def paraboloid(steepness, radius):
    """z = steepness r**2 in polar parameters r, angle."""
    return ParametricSurface((u * sp.cos(v), u * sp.sin(v), steepness * u**2), ((0, radius), (0, 3)))


@pytest.mark.parametrize(("steepness", "radius"), [(1, 1), (1, 10**6), (1000, 1), (1, 200)])
def test_curvatures_near_a_pole_do_not_depend_on_the_size_of_the_domain(steepness, radius):
    r = np.array([0, 1e-9, 3e-7, 4e-6, 1e-4, 1e-3, 0.01, 0.5]) / steepness
    expected = 4 * steepness**2 / (1 + 4 * steepness**2 * r**2) ** 2
    assert_close(paraboloid(steepness, radius).gaussian_curvature(r, 1.0) / expected, np.ones(8), atol=1e-9)


def test_normals_on_both_sides_of_an_inner_pole_follow_the_parameters():
    disc = ParametricSurface((u * sp.cos(v), u * sp.sin(v), u**2), ((-1, 1), (0, 3)))
    assert_close(disc.normal([-1e-3, -1e-9, 1e-9, 1e-3], 1.0)[:, 2], [-1, -1, 1, 1], atol=1e-5)


def test_a_sphere_has_one_curvature_all_the_way_to_its_pole():
    point = (sp.cos(u) * sp.cos(v), sp.sin(u) * sp.cos(v), sp.sin(v))
    globe = ParametricSurface(point, ((0, 2 * sp.pi), (-sp.pi / 2, sp.pi / 2)), closed=(True, False))
    latitudes = np.pi / 2 - 10.0 ** -np.arange(4, 17)
    assert_close(globe.mean_curvature(1.0, latitudes), -np.ones(13), atol=1e-12)
