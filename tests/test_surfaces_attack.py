"""What once went wrong with patches, each with an oracle of its own."""

import numpy as np
import pytest
import sympy as sp
from closeness import assert_close

from rsym.surfaces.continuity import continuity_report
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


def side_by_side(opening, beyond=v):
    """z = sin 2x over [0, 1]^2 and, torn from it by `opening` in y, over [1, 2] x [0, 1]."""
    left = ParametricSurface((u, v, sp.sin(2 * u)))
    right = ParametricSurface((1 + u, beyond, sp.sin(2 + 2 * u) + opening(beyond)))
    return continuity_report([left, right])


@pytest.mark.parametrize(
    "opening",
    [
        lambda y: sp.exp(-((30 * (y - sp.Rational(2, 5))) ** 2)) / 1000,  # joined at both ends
        lambda y: sp.exp(-((200 * y) ** 2)) / 1000,  # torn at one end, joined over all the rest
        lambda y: sp.Piecewise((0, y < sp.Rational(4, 5)), ((y - sp.Rational(4, 5)) ** 4, True)),
    ],
)
def test_a_crack_in_a_part_of_an_edge_is_reported_as_broken(opening):
    report = side_by_side(opening)
    gap = sp.lambdify(v, opening(v), "numpy")
    widest = gap(np.linspace(0, 1, 5001)).max()
    assert report.continuity == "broken"
    assert_close(report.edges[0].gap.value, widest, rtol=1e-3)
    assert abs(gap(report.edges[0].gap.point[1]) - widest) < 1e-3 * widest
    left = [one.interval for one in report.free if (one.patch, one.edge) in ((0, "u1"), (1, "u0"))]
    assert all(stop - start < 1e-4 for start, stop in left)


def test_edges_that_overlap_by_a_hundredth_are_found():
    report = side_by_side(lambda y: 0, v + sp.Rational(99, 100))
    assert report.continuity == "G2"
    assert_close(report.edges[0].intervals[0], [0.99, 1.0], atol=1e-9)
