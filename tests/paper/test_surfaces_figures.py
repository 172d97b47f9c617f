"""What the figures of parametric surfaces are made of, held against plain formulas."""

import matplotlib.pyplot
import numpy as np
import pytest
from oracles.closeness import assert_close

from rsym.paper import coons, curves
from rsym.paper.figures import SURFACES
from rsym.surfaces.meshes import mesh_patches


@pytest.fixture(autouse=True)
def _close_figures():
    yield
    matplotlib.pyplot.close("all")


def test_the_first_program_of_the_source_on_its_own_grids():
    u, v = np.arange(0, 1.005, 0.01), np.arange(0, 1.01, 0.02)
    x, y, z = np.moveaxis(coons.test1().grid(u, v), -1, 0)
    assert x.shape == (101, 51)
    assert_close(x, np.broadcast_to(-5 + 10 * u[:, None], (101, 51)), atol=1e-14)
    assert_close(z, x**2 + y**2, atol=1e-13)
    assert_close(coons.four_corners().grid(u, v)[..., 2], np.full((101, 51), 50.0), atol=1e-13)
    drawing = coons.draw_paraboloid()
    (_, exact), (_, plane) = drawing.table.rows
    assert float(exact) < 1e-12
    assert plane == "50"
    assert [text.get_text() for text in drawing.figure.texts] == ["corners, tangents, zero twists", "corners alone"]


def test_patches_of_a_quilt_differ_in_their_twists_alone():
    def ridge(x, y):
        return 9 / (6 + (x - y) ** 2)

    step = 1e-4
    for number in (0, 4, 5):
        i, j = divmod(number, 3)
        at = (i + np.array([0.0, 1.0]))[:, None], j + np.array([0.0, 1.0])
        x, y = at
        corners = np.array([0.0, 1.0])[:, None], np.array([0.0, 1.0])
        mixed = sum(a * b * ridge(x + a * step, y + b * step) for a in (-1, 1) for b in (-1, 1)) / (4 * step**2)
        slope = (ridge(x + step, y) - ridge(x - step, y)) / (2 * step)
        for kind, twists in (("zero", 0 * mixed), ("true", mixed)):
            patch = coons.quilt(kind)[number]
            assert_close(patch(*corners)[..., 2], ridge(x, y), atol=1e-14)
            assert_close(patch.derivative(*corners, (1, 0))[..., 2], slope, atol=1e-7)
            assert_close(patch.derivative(*corners, (1, 1))[..., 2], twists, atol=1e-6)


def test_rings_of_any_shape_parameter_are_one_torus_and_swollen_ones_are_not():
    for name, blend in coons.BLENDS.items():
        away = coons.distance(coons.ring(blend)[0])
        assert away > 0.1 if name == "bicubic" else away < 1e-14
    swollen = coons.ring(blend, coons.SWELLING)
    assert coons.distance(swollen[0]) > 0.1
    mesh = mesh_patches(swollen, 6)
    assert mesh.status.closed
    assert mesh.status.euler_characteristic == 0


def test_both_sides_of_the_ship_meet_its_sections_and_face_outwards():
    for kind in curves.LOFTS:
        for side, patch in zip((1, -1), curves.hull(kind), strict=True):
            for knot, points in zip(curves.KNOTS, curves.sections(side), strict=True):
                assert_close(patch([0.0, 1.0], knot), points[[0, -1]], atol=1e-13)
            normals = patch.normal(np.linspace(0.1, 0.9, 5)[:, None], np.linspace(0.1, 0.9, 5))
            assert (side * normals[..., 1]).min() > -0.25
            assert (side * normals[..., 1]).mean() > 0.4
    stations = [curves.station(share) for share in curves.STATIONS]
    assert all((np.diff(one[:, 1:], axis=0) > 0).all() for one in stations)


def test_the_curves_of_the_network_lie_on_one_surface_and_gordons_meets_them_all():
    t = np.linspace(0, 1, 50)
    for curve in (*map(curves.along, curves.ALONG), *map(curves.across, curves.ACROSS)):
        x, y, z = curve(t).T
        expected = 0.45 * np.exp(-2.2 * ((x - 0.95) ** 2 + (y - 0.7) ** 2)) + 0.22 * np.sin(1.9 * x) - 0.12 * y**2
        assert_close(z, expected, atol=1e-15)
    surface = curves.GordonSurface([*map(curves.along, curves.ALONG)], [*map(curves.across, curves.ACROSS)])
    first, second, third, whole = curves.parts(surface).values()
    u, v = np.linspace(*surface.domain[0], 9), np.linspace(*surface.domain[1], 8)
    assert_close(whole.grid(u, v), first.grid(u, v) + second.grid(u, v) - third.grid(u, v), atol=1e-14)
    misses = [curves.misses(surface, part) for part in (first, second, third, whole)]
    assert [[one < 1e-12 for one in pair] for pair in misses] == [
        [True, False],
        [False, True],
        [False, False],
        [True, True],
    ]


def test_fewer_vertices_are_nearer_to_the_truth():
    data = curves.measured()
    assert_close((data - curves.bonnet(data[..., 0], data[..., 1]))[..., 2].std(), curves.NOISE, rtol=9e-3, atol=2e-4)
    through, near = (curves.fitted(vertices) for vertices in curves.SHOWN)
    assert through.residual.maximum < 1e-14
    assert near.net.shape == (7, 7, 3)
    errors = []
    for surface in (through, near):
        x, y, z = np.moveaxis(surface.grid(*(np.linspace(*one, 50) for one in surface.domain)), -1, 0)
        errors.append(np.sqrt(((z - curves.bonnet(x, y)[..., 2]) ** 2).mean()))
    assert errors[1] < 0.6 * errors[0]


def test_the_joined_pairs_are_what_they_are_called():
    for kind, factor in (("meeting", None), ("joined G1", coons.K), ("joined G2", coons.K)):
        p, q = coons.pair(kind)
        v = np.linspace(0, 1, 9)
        assert_close(q(0.0, v), p(1.0, v), atol=1e-14)
        if factor:
            assert_close(q.derivative(0.0, v), factor * p.derivative(1.0, v), atol=1e-13)
        same = abs(q.derivative(0.0, v, (2, 0)) - coons.K**2 * p.derivative(1.0, v, (2, 0))).max() < 1e-12
        assert same == (kind == "joined G2")


@pytest.mark.slow
def test_every_figure_says_what_it_shows():
    assert [recipe.name for recipe in SURFACES] == "paraboloid twists torus joints hull network fitting".split()
    drawing = coons.draw_joints()
    assert {len(row) for row in drawing.table.rows} == {len(drawing.table.header)}
    assert [row[1] for row in drawing.table.rows] == ["G0", "G1", "G2"]
    assert "k = 1.7" in drawing.remark
    # Three panels of two patches with 8 times 16 cells a side between parameter lines, and three without lines.
    assert drawing.triangles == 3 * 2 * 2 * (128**2 + 126**2)
