"""What is asked of bodies first: is a point inside, how large is it, where is its middle."""

import functools
import math
import operator
import pickle

import numpy as np
import pytest
import sympy as sp
from oracles.closeness import assert_close

import rsym
from rsym import x, y, z
from rsym.sampling.mesh import Mesh
from rsym.sampling.status import Findings, OffSurface

CORNERS = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]])
FACES = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
r = sp.Symbol("r", real=True)
TURN = np.array([[0.36, 0.48, -0.8], [-0.8, 0.6, 0.0], [0.48, 0.64, 0.6]])  # exact: a rotation


def cuboid(a, b, c):
    return rsym.mesh(rsym.box(a, b, c), 12, bounds=((-a, a), (-b, b), (-c, c)))


# contains


def test_contains_arrays_that_broadcast_and_single_points():
    disc = rsym.disc(1)
    inside = disc.contains(np.linspace(-2, 2, 5), np.array([[0.0], [0.9]]))
    assert inside.dtype == bool
    assert inside.tolist() == [[False, True, True, True, False], [False, False, True, False, False]]
    assert disc.contains(0, 0) is True
    assert disc.contains(2, 0) is False
    assert rsym.sphere(2).contains(0, [0, 3], 1).tolist() == [True, False]


def test_the_boundary_belongs_to_the_shape_and_what_is_undefined_does_not():
    assert rsym.disc(1).contains([1.0, -1.0, np.nextafter(1.0, 2.0)], 0).tolist() == [True, True, False]
    quadrant = rsym.Shape(rsym.conjunction(x, y), (x, y))
    assert quadrant.contains(0, 0)  # the corner, where every derivative is undefined
    assert rsym.Shape(sp.sqrt(x) + 1, (x, y)).contains([-1.0, 1.0], 0).tolist() == [False, True]
    assert not quadrant.contains(np.nan, 1)


def test_what_is_inside_whatever_an_undefined_part_is_belongs_to_the_shape():
    part = rsym.Shape(sp.sqrt(x - 2) - y, (x, y))
    places = [0.0, 1.5, 3.0, 3.0], [0.0, 0.0, 0.9, 1.1]
    for system in (rsym.R0, rsym.R1):
        either, both = (join(rsym.disc(1), part, system=system) for join in (rsym.disjunction, rsym.conjunction))
        assert either.contains(*places).tolist() == [True, False, True, False]
        assert both.contains(*places).tolist() == [False] * 4
        assert (~both).contains(*places).tolist() == [False, True, True, True]


# measures of a mesh


def test_measures_of_a_tetrahedron_are_exact():
    mesh = Mesh(CORNERS, FACES)
    assert_close(mesh.volume, 1 / 6, rtol=1e-15)
    assert_close(mesh.area, 1.5 + np.sqrt(3) / 2, rtol=1e-15)
    assert_close(mesh.centroid, [0.25] * 3, rtol=1e-15)
    # The integral of x^2 is 1/60 and that of xy 1/120; from the centroid V/16 is taken off both.
    square, mixed = 1 / 60 - 1 / 96, 1 / 120 - 1 / 96
    assert_close(mesh.inertia, 2 * square * np.eye(3) - mixed * (1 - np.eye(3)), rtol=1e-13)
    assert mesh.bounds == ((0.0, 1.0),) * 3


def test_measures_of_a_cuboid_far_away():
    mesh = cuboid(2, 3, 4).transform(np.column_stack([np.eye(3), [1e3, -2e3, 5e2]]))
    assert_close(mesh.volume, 24, rtol=1e-11)
    assert_close(mesh.area, 52, rtol=1e-11)
    assert_close(mesh.centroid, [1e3, -2e3, 5e2], rtol=1e-13)
    assert_close(mesh.inertia, 2 * np.diag([25, 20, 13]), atol=1e-8)
    assert_close(np.array(mesh.bounds), [[999, 1001], [-2001.5, -1998.5], [498, 502]], rtol=1e-13)


def test_a_ball_of_triangles_tends_to_the_ball_at_second_order():
    errors = []
    for resolution in (16, 32):
        mesh = rsym.mesh(rsym.sphere(1), resolution, bounds=((-1.1, 1.1),) * 3)
        errors.append([4 / 3 * np.pi - mesh.volume, 4 * np.pi - mesh.area, 8 / 15 * np.pi - mesh.inertia[0, 0]])
    assert (np.array(errors) > 0).all()
    assert (np.divide(*errors) > 3.5).all()


def test_measures_agree_with_another_program():
    trimesh = pytest.importorskip("trimesh")
    mesh = rsym.mesh(rsym.torus(1, 0.3) - rsym.sphere(0.5).translate(1, 0, 0), 24, bounds=((-1.5, 1.5),) * 3)
    other = trimesh.Trimesh(mesh.vertices, mesh.faces, process=False)
    assert_close(mesh.volume, other.volume, rtol=1e-12)
    assert_close(mesh.area, other.area, rtol=1e-12)
    assert_close(mesh.centroid, other.center_mass, atol=1e-12)
    assert_close(mesh.inertia, other.moment_inertia, atol=1e-12)


def test_an_open_mesh_encloses_nothing_and_says_where():
    mesh = Mesh(CORNERS, FACES[1:])
    for name in ("volume", "centroid", "inertia"):
        with pytest.raises(rsym.RsymError, match=r"3 open edges.*\(0, 0, 0\).*remedy.*bounds") as refused:
            getattr(mesh, name)
        assert refused.value.code == "open-mesh"
    assert_close(mesh.area, 1 + np.sqrt(3) / 2, rtol=1e-15)
    turned = FACES.copy()
    turned[0] = turned[0, ::-1]
    with pytest.raises(rsym.RsymError, match="3 open edges"):
        _ = Mesh(CORNERS, turned).volume


def test_two_bodies_that_share_an_edge_are_closed():
    """Four triangles at an edge, two each way round."""
    mirrored = CORNERS * [1, -1, -1]
    mesh = Mesh(np.vstack([CORNERS, mirrored[2:]]), np.vstack([FACES, np.array([0, 1, 4, 5])[FACES]]))
    assert_close(mesh.volume, 1 / 3, rtol=1e-15)


def test_meshes_without_volume_or_triangles():
    flat = Mesh(CORNERS, np.array([[0, 1, 2], [0, 2, 1]]))
    assert flat.volume == 0
    with pytest.raises(rsym.RsymError, match="volume of 0"):
        _ = flat.centroid
    empty = Mesh(np.zeros((0, 3)), np.zeros((0, 3), int))
    for name in ("volume", "area", "centroid", "inertia", "bounds"):
        with pytest.raises(rsym.RsymError, match="at least one triangle"):
            getattr(empty, name)
    assert Mesh(np.vstack([CORNERS, [[9, 9, 9]]]), FACES).bounds == ((0.0, 1.0),) * 3


# scale and transform


def half_ball():
    """A closed body with a curved and a flat leaf."""
    ball = rsym.sphere(1).named("ball") & rsym.half_space([1, 0, 0], 0).named("cut")
    return rsym.mesh(ball, 16, bounds=((-1.2, 1.2),) * 3)


@pytest.mark.parametrize(
    "matrix",
    [TURN, np.diag([2, 2, 2]), np.diag([1, 2, -3]), [[1, 0.5, 0], [0, 1, 0], [0.2, 0, -2]]],
    ids=["turn", "scale", "squeeze and mirror", "shear and mirror"],
)
def test_transform_keeps_the_outside_outside_and_normals_normal(matrix):
    matrix, shift = np.asarray(matrix, float), np.array([3.0, -1.0, 2.0])
    mesh = half_ball()
    moved = mesh.transform(np.column_stack([matrix, shift]))
    assert_close(moved.vertices, mesh.vertices @ matrix.T + shift, rtol=1e-15)
    assert_close(moved.volume, mesh.volume * abs(np.linalg.det(matrix)), rtol=1e-12)
    assert_close(moved.centroid, matrix @ mesh.centroid + shift, rtol=1e-12)
    assert moved.status.closed
    assert moved.status.folded == 0
    assert moved.leaves == mesh.leaves
    assert moved.leaf.tolist() == mesh.leaf.tolist()
    # The image of the ball is |A^-1 (p - t)| = 1, and its gradient the normal.
    ball = np.array(moved.leaves)[moved.leaf] == "ball"
    corners = moved.vertices[moved.faces[ball]]
    inverse = np.linalg.inv(matrix)
    outward = (corners - shift) @ inverse.T @ inverse
    assert_close(moved.normals[ball], outward / np.linalg.norm(outward, axis=2)[..., None], atol=1e-9)
    assert_close(pickle.loads(pickle.dumps(moved)).normals, moved.normals, atol=1e-15)
    assert {one.names for one in moved.features} == {one.names for one in mesh.features} != set()


def test_inertia_turns_with_the_body():
    mesh = half_ball()
    turned = mesh.transform(TURN)
    assert_close(turned.inertia, TURN @ mesh.inertia @ TURN.T, atol=1e-12)
    assert_close(mesh.scale(2).inertia, 32 * mesh.inertia, atol=1e-11)


def test_a_mesh_that_was_moved_is_none_of_its_shape():
    ball = rsym.sphere(1)
    moved = rsym.mesh(ball, 16).scale(2)
    for function in (rsym.vertex_curvatures, rsym.corner_curvatures):
        with pytest.raises(rsym.RsymError, match="not one of this shape"):
            function(moved, ball)
        assert_close(np.nanmax(function(moved, ball.scale(2))["mean_curvature"]), 0.5, rtol=1e-9)
    with pytest.raises(rsym.RsymError, match="not one of this shape"):
        rsym.plot_mesh(moved, ax=None, colour_by="gaussian_curvature", shape=ball)


def test_a_matrix_may_be_three_by_three_or_four_wide_or_four_by_four():
    mesh = Mesh(CORNERS, FACES)
    wide = np.column_stack([2 * np.eye(3), [1, 0, 0]])
    assert_close(mesh.transform(wide).vertices, mesh.transform(np.vstack([wide, [0, 0, 0, 1]])).vertices, rtol=1e-15)
    assert_close(mesh.transform(2 * np.eye(3)).vertices, 2 * CORNERS, rtol=1e-15)
    assert_close(mesh.transform(sp.diag(2, 2, 2)).vertices, 2 * CORNERS, rtol=1e-15)


def test_scale_by_one_factor_or_one_for_each_axis():
    mesh = Mesh(CORNERS, FACES)
    assert_close(mesh.scale(3).volume, 27 / 6, rtol=1e-15)
    assert mesh.scale([1, 2, 3]).bounds == ((0.0, 1.0), (0.0, 2.0), (0.0, 3.0))
    assert_close(mesh.scale([1, 1, -1]).volume, 1 / 6, rtol=1e-15)
    for wrong in (0, "2", None, np.nan, [1, 2], [1, 0, 1], 1j, np.eye(3)):
        with pytest.raises(rsym.RsymError, match="factor"):
            mesh.scale(wrong)


@pytest.mark.parametrize(
    "wrong",
    [None, "turn", np.eye(2), np.zeros((3, 3)), np.diag([1, 1, 0]), np.full((3, 3), np.nan), 2 * np.eye(4), 1j, {}],
    ids=str,
)
def test_a_matrix_that_flattens_or_is_none_is_refused(wrong):
    with pytest.raises(rsym.RsymError, match="matrix"):
        Mesh(CORNERS, FACES).transform(wrong)


def test_given_normals_turn_with_their_corners():
    given = np.arange(36.0).reshape(4, 3, 3) + 1
    moved = Mesh(CORNERS, FACES, shading=given).scale([1, 1, -1])
    assert moved.faces[0].tolist() == [1, 2, 0]
    unit = given / np.linalg.norm(given, axis=2)[..., None]
    assert_close(moved.normals[:, ::-1] * [1, 1, -1], unit, atol=1e-15)


def test_curvatures_of_a_surface_without_equation_follow_similarities():
    patch = rsym.surfaces.sphere_octant(1.0).mesh(8)
    plain = {name: patch.curvatures(name) for name in ("mean_curvature", "gaussian_curvature", "principal_curvatures")}
    moved = patch.transform(-2 * TURN)
    for name, power in (("mean_curvature", 1), ("gaussian_curvature", 2), ("principal_curvatures", 1)):
        expected = plain[name][:, ::-1] / 2.0**power
        np.testing.assert_allclose(moved.curvatures(name), expected, rtol=1e-12)
    assert patch.scale([1, 2, 1]).curvatures is None


def test_places_that_the_mesher_tells_of_move_along():
    found = Findings(off_surface=OffSurface(1, 0.5, (1.0, 2.0, 3.0)), clipped_at=("the upper end of x",))
    moved = Mesh(CORNERS, FACES, found=found).scale(2)
    assert moved.findings.off_surface == OffSurface(1, 0.5, (2.0, 4.0, 6.0))
    assert moved.findings.clipped_at == found.clipped_at


def test_open_edges_stay_on_the_sides_of_the_bounds():
    ball = rsym.sphere(1)
    with pytest.warns(rsym.RsymWarning):
        mesh = rsym.mesh(ball, 16, bounds=((-2, 2), (-2, 2), (-2, 0.5)), cap=False)
    assert {side for loop in mesh.scale([2, -3, 4]).status.loops for side in loop.sides} == {"the upper end of z"}
    assert mesh.transform(TURN).status.boundary_edges == mesh.status.boundary_edges


ROUND = 1 - x**2 - y**2
SHEETS = {
    "size": sp.Abs(x),
    "on a side": sp.Abs(x - sp.Rational(1, 4)),
    "within": sp.Abs(x - sp.Rational(3, 10)),
    "square": x**2,
    "fourth power": y**4,
    "multiplied out": sp.expand((x - sp.Rational(1, 7)) ** 2),
    "cosine": 1 - sp.cos(x),
    "hyperbolic": sp.cosh(y) - 1,
    "exponential": sp.exp(x) - 1 - x,
}


@pytest.mark.parametrize("name", SHEETS)
def test_a_sheet_of_zeros_inside_is_no_boundary(name):
    """Where a formula touches zero it has one sign on both sides, wherever the sides of cells are."""
    for bounds in (((-2, 2), (-2, 2)), ((-1.5, 1.6), (-1.5, 1.5))):
        found = rsym.measure(rsym.Shape(sp.Min(SHEETS[name], ROUND), (x, y), bounds=bounds))
        assert_close([found.area, found.length], [math.pi, 2 * math.pi], rtol=1e-12)
        assert found.length.error < 1e-11


@pytest.mark.filterwarnings("ignore:an integral is known")
def test_a_square_that_is_all_rounding_where_it_is_zero_is_told():
    """Multiplied out far from 0 it has both signs there, and its line may count."""
    u = (y + 240) / 1000
    shape = rsym.Shape(rsym.conjunction(650**2 - (x + 430) ** 2 - (y + 490) ** 2, sp.expand(u**2)), (x, y))
    found = rsym.measure(shape, bounds=((-1905.5, 1045.5), (-1965.5, 985.5)))
    assert abs(found.length - 1300 * math.pi) <= found.length.error
    assert abs(found.area - 650**2 * math.pi) <= found.area.error


def test_tiles_that_meet_have_one_outline():
    for count in (2, 3, 4, 6):
        assert rsym.measure(rsym.row(rsym.rectangle(1, 1), 1, count=count)).length == pytest.approx(2 * count + 2)
    tiled = rsym.measure(rsym.grid(rsym.rectangle(1, 1).named("tile"), (1, 1), counts=(3, 3)))
    assert tiled.parts["tile"] == pytest.approx(12)


def test_a_body_of_more_leaves_than_a_vector_has_bytes():
    joined = [((2, 0, 0), (4, 4, 5)), ((4, 4, 1), (6, 5, 4)), ((5, 0, 1), (6, 4, 5)), ((2, 0, 1), (5, 4, 5))]
    cut = [((2, 4, 1), (6, 5, 4)), ((5, 0, 0), (6, 5, 1))]
    parts = [
        rsym.box(
            *(b - a for a, b in zip(low, high, strict=True)),
            [sp.Rational(a + b, 2) for a, b in zip(low, high, strict=True)],
        )
        for low, high in (*joined, *cut)
    ]
    body = functools.reduce(operator.or_, parts[:4]) - parts[4] - parts[5]
    found = rsym.measure(body)
    assert found.volume == pytest.approx(72, rel=1e-12)
    assert found.surface == pytest.approx(108, rel=1e-12)


def test_boxes_that_meet_have_one_surface():
    shape = rsym.grid(rsym.box(1, 1, 1), (1, 1), counts=(3, 3))
    assert rsym.measure(shape).surface == pytest.approx(30, rel=1e-11)
    for cells in (16, 24):  # of which some have the sheets on their sides
        assert rsym.quadrature(shape, cells=cells, order=3).boundary.weights.sum() == pytest.approx(30, rel=1e-11)


@pytest.mark.parametrize("sheet", [sp.Abs(x), z**2, 1 - sp.cos(y)], ids=str)
def test_a_sheet_of_zeros_in_a_ball_is_no_boundary(sheet):
    ball = rsym.sphere(1) & rsym.Shape(sheet, (x, y, z))
    assert_close([rsym.measure(ball).volume, rsym.measure(ball).surface], [4 / 3 * math.pi, 4 * math.pi], rtol=1e-9)
