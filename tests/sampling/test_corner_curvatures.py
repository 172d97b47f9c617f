"""Curvatures at the corners of faces against closed forms: a surface has its own up to each edge and on it."""

import numpy as np
import pytest
import sympy as sp
from oracles.closeness import assert_close

import rsym
from rsym import Shape, x, y, z
from rsym.paper.models import model_path

SMALL = ((-1.3, 1.3),) * 3
CAN = rsym.cylinder(2).named("wall") & rsym.slab(-1, 1).named("ends")
CAN_BOUNDS = ((-2.5, 2.5), (-2.5, 2.5), (-1.5, 1.5))
UNIT_BALL = Shape(1 - x**2 - y**2 - z**2, (x, y, z), bounds=SMALL)
CAPSULE = Shape(
    1 - y**2 - z**2 - sp.Max(sp.Abs(x) - 1, 0) ** 2, (x, y, z), bounds=((-2.2, 2.2), (-1.2, 1.2), (-1.2, 1.2))
)


def on_edges(mesh):
    """The vertices at which two leaves meet."""
    first = np.full(len(mesh.vertices), -1)
    first[mesh.faces] = mesh.leaf[:, None]
    return np.unique(mesh.faces[first[mesh.faces] != mesh.leaf[:, None]])


def is_nan_only(values, where):
    undefined = np.zeros(len(values), bool)
    undefined[where] = True
    return np.array_equal(np.isnan(values).reshape(len(values), -1).all(axis=1), undefined) and np.array_equal(
        np.isnan(values).reshape(len(values), -1).any(axis=1), undefined
    )


def test_a_can_has_the_curvature_of_its_wall_and_of_its_ends_up_to_the_rims():
    mesh = rsym.mesh(CAN, 24, bounds=CAN_BOUNDS)
    found = rsym.corner_curvatures(mesh, CAN)
    wall = np.array(mesh.leaves)[mesh.leaf] == "wall"
    assert_close(found["mean_curvature"], np.where(wall, 0.25, 0.0)[:, None].repeat(3, axis=1), atol=1e-12)
    assert_close(found["gaussian_curvature"], np.zeros(mesh.faces.shape), atol=1e-12)
    expected = np.where(wall[:, None, None], [0.5, 0.0], [0.0, 0.0]).repeat(3, axis=1)
    assert_close(found["principal_curvatures"], expected.reshape(-1, 3, 2), atol=1e-12)
    upright = np.abs(found["principal_directions"][wall][..., 1, :])
    assert_close(upright, np.broadcast_to([0.0, 0.0, 1.0], upright.shape), atol=1e-9)


def test_a_vertex_of_a_can_has_a_curvature_unless_it_is_on_a_rim():
    mesh = rsym.mesh(CAN, 24, bounds=CAN_BOUNDS)
    found = rsym.vertex_curvatures(mesh, CAN)
    rims = on_edges(mesh)
    assert len(rims) > 50
    for values in found.values():
        assert is_nan_only(values, rims)
    heights = np.abs(mesh.vertices[:, 2])
    inner = np.setdiff1d(np.arange(len(heights)), rims)
    expected = np.where(heights[inner] < 1 - 1e-9, 0.25, 0.0)
    assert_close(found["mean_curvature"][inner], expected, atol=1e-12)


@pytest.mark.random
@pytest.mark.parametrize("system", [rsym.R0, rsym.R1, rsym.Rp(4)])
def test_a_box_is_flat_at_every_corner_and_has_no_curvature_on_its_edges(system):
    sides = rsym.conjunction(1 - x**2, 1 - y**2, 1 - z**2, system=system)
    box = Shape(sides, (x, y, z), bounds=SMALL)
    mesh = rsym.mesh(box, 12)
    assert_close(
        rsym.corner_curvatures(mesh, box)["principal_curvatures"], np.zeros((len(mesh.faces), 3, 2)), atol=1e-15
    )
    assert is_nan_only(rsym.vertex_curvatures(mesh, box)["mean_curvature"], on_edges(mesh))


def test_a_lens_of_two_balls():
    small = Shape(1 - (x - 0.5) ** 2 - y**2 - z**2, (x, y, z)).named("small")
    large = Shape(4 - (x + 1.5) ** 2 - y**2 - z**2, (x, y, z)).named("large")
    lens = (small & large).replace(bounds=((-0.8, 0.8), (-1.2, 1.2), (-1.2, 1.2)))
    mesh = rsym.mesh(lens, 24)
    radius = np.where(np.array(mesh.leaves)[mesh.leaf] == "small", 1.0, 2.0)[:, None].repeat(3, axis=1)
    found = rsym.corner_curvatures(mesh, lens)
    assert_close(found["mean_curvature"], 1 / radius, atol=1e-11)
    assert_close(found["gaussian_curvature"], 1 / radius**2, atol=1e-11)
    assert is_nan_only(rsym.vertex_curvatures(mesh, lens)["gaussian_curvature"], on_edges(mesh))


def test_a_rim_between_equal_balls_has_no_curvature_though_both_sides_have_the_same():
    left, right = (Shape(1 - (x + shift) ** 2 - y**2 - z**2, (x, y, z)) for shift in (0.5, -0.5))
    lens = (left & right).replace(bounds=((-0.8, 0.8), (-1.2, 1.2), (-1.2, 1.2)))
    mesh = rsym.mesh(lens, 16)
    assert_close(rsym.corner_curvatures(mesh, lens)["mean_curvature"], np.ones(mesh.faces.shape), atol=1e-12)
    assert is_nan_only(rsym.vertex_curvatures(mesh, lens)["mean_curvature"], on_edges(mesh))


def test_a_torus_has_its_curvature_at_every_corner_and_vertex():
    torus = Shape(1 - (sp.sqrt(x**2 + y**2) - 3) ** 2 - z**2, (x, y, z), bounds=((-4.2, 4.2), (-4.2, 4.2), (-1.2, 1.2)))
    mesh = rsym.mesh(torus, 24)
    across = 1 - 3 / np.hypot(*mesh.vertices[:, :2].T)
    assert_close(rsym.vertex_curvatures(mesh, torus)["gaussian_curvature"], across, atol=1e-9)
    corners = rsym.corner_curvatures(mesh, torus)
    assert_close(corners["mean_curvature"], ((1 + across) / 2)[mesh.faces], atol=1e-9)


def test_leaves_that_are_one_surface_have_its_curvature_where_they_meet():
    """One ball by two formulas, each the leaf of some faces."""
    ball = 1 - x**2 - y**2 - z**2
    twice = Shape(rsym.conjunction(ball, (1 + x / 4 + y / 5) * ball), (x, y, z), bounds=SMALL)
    mesh = rsym.mesh(twice, 16)
    assert len(np.unique(mesh.leaf)) == 2
    found = rsym.vertex_curvatures(mesh, twice)
    assert_close(found["principal_curvatures"], np.ones((len(mesh.vertices), 2)), atol=1e-9)


def test_a_side_of_a_kink_inside_a_leaf_has_its_own_curvature():
    """The leaf is 1 - |x| - z: two planes, of which the lattice meets the ridge nowhere else than inside faces."""
    roof = Shape(
        rsym.conjunction(1 - sp.Abs(x) - z, z, 1 - y**2), (x, y, z), bounds=((-1.3, 1.3), (-1.3, 1.3), (-0.3, 1.2))
    )
    mesh = rsym.mesh(roof, 20)
    assert_close(rsym.corner_curvatures(mesh, roof)["mean_curvature"], np.zeros(mesh.faces.shape), atol=1e-12)


def test_a_jump_of_the_curvature_inside_a_leaf():
    mesh = rsym.mesh(CAPSULE, 24)
    found = rsym.corner_curvatures(mesh, CAPSULE)["mean_curvature"]
    middles = np.abs(mesh.vertices[mesh.faces][..., 0])
    clear = np.abs(middles - 1) > 1e-6
    assert_close(found[clear], np.where(middles < 1, 0.5, 1.0)[clear], atol=1e-9)


def test_the_tip_of_a_cone_has_no_curvature():
    cone = Shape(
        rsym.conjunction(z**2 - x**2 - y**2, z, 1 - z), (x, y, z), bounds=((-1.2, 1.2), (-1.2, 1.2), (-0.2, 1.2))
    )
    tip = np.array([[0.0, 0.0, 0.0], [0.3, 0.4, 0.5], [0.4, -0.3, 0.5]])
    mesh = rsym.Mesh(np.vstack([tip, [[-0.5, 0, 0.5]]]), np.array([[0, 2, 1], [0, 1, 3]]))
    found = rsym.corner_curvatures(mesh, cone)["mean_curvature"]
    assert np.isnan(found[:, 0]).all()
    assert_close(found[:, 1:], np.full((2, 2), 0.5**0.5), rtol=1e-12)  # cos/(2 r) = 1/(2 sqrt(2) r), r = 1/2


def test_caps_at_the_bounds_are_flat():
    bounds = ((-1.3, 0.4), (-1.3, 1.3), (-1.3, 1.3))
    with pytest.warns(rsym.RsymWarning):
        mesh = rsym.mesh(UNIT_BALL, 16, bounds=bounds)
    found = rsym.corner_curvatures(mesh, UNIT_BALL)["principal_curvatures"]
    cap = np.array([name.startswith("cap") for name in mesh.leaves])[mesh.leaf]
    assert cap.any()
    assert_close(found, np.where(cap, 0.0, 1.0)[:, None, None] * np.ones((1, 3, 2)), atol=1e-12)


def test_a_mesh_that_does_not_know_its_leaves_takes_those_that_are_active():
    for other in (rsym.mesh(CAN, 24, bounds=CAN_BOUNDS, method="smooth"), rsym.mesh(CAN, 24, bounds=CAN_BOUNDS)):
        turned = rsym.slab(-1, 1) & rsym.cylinder(2)
        found = rsym.vertex_curvatures(other, turned)["mean_curvature"]
        assert set(found[np.isfinite(found)].round(9)) <= {0.0, 0.25}
        assert np.isfinite(found).mean() > 0.8


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::rsym.RsymWarning")
@pytest.mark.parametrize("name", ["car", "valve", "gear", "snowflake"])
def test_no_corner_of_a_shipped_model_has_the_curvature_of_a_rounding_error(name):
    shape = rsym.load(model_path(name))
    mesh = rsym.mesh(shape, 48)
    size = np.ptp(mesh.vertices, axis=0).max()
    corners, vertices = rsym.corner_curvatures(mesh, shape), rsym.vertex_curvatures(mesh, shape)
    assert np.isfinite(corners["mean_curvature"]).all()
    for found in (corners, vertices):
        assert np.nanmax(np.abs(found["principal_curvatures"])) * size < 1e3
    assert np.isin(on_edges(mesh), np.flatnonzero(np.isnan(vertices["mean_curvature"]))).mean() > 0.8


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::rsym.RsymWarning")
def test_a_corner_that_is_not_on_the_leaf_of_its_face_has_the_curvature_of_the_nearest_point_that_is():
    """Balls so close to each other that three meet within a cell: some faces have a corner beside their leaf."""
    centres = np.random.default_rng(1).uniform(-0.5, 0.5, (25, 3)).round(3).tolist()
    balls = [sp.Rational(1, 25) - (x - a) ** 2 - (y - b) ** 2 - (z - c) ** 2 for a, b, c in centres]
    shape = Shape(rsym.disjunction(*balls), (x, y, z), bounds=((-0.8, 0.8),) * 3)
    mesh = rsym.mesh(shape, 24)
    leaf = np.array(centres)[mesh.leaf][:, None]
    off = np.abs(np.linalg.norm(mesh.vertices[mesh.faces] - leaf, axis=-1) - 0.2)
    assert off.max() > 1e-6
    found = rsym.corner_curvatures(mesh, shape)
    assert_close(found["principal_curvatures"], np.full((*mesh.faces.shape, 2), 5.0), atol=1e-4)


def test_threads_and_pickles_do_not_change_a_bit():
    import pickle

    mesh = rsym.mesh(CAN, 16, bounds=CAN_BOUNDS)
    again = rsym.corner_curvatures(pickle.loads(pickle.dumps(mesh)), CAN)
    for name, values in rsym.corner_curvatures(mesh, CAN).items():
        assert np.array_equal(values, again[name])
