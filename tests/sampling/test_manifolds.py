"""Measures of meshes against trimesh and manifold3d, which share no code with them, and against formulas."""

import subprocess
import sys

import manifold3d
import numpy as np
import pytest
import sympy as sp
import trimesh
from oracles.closeness import assert_close

import rsym
from rsym import x, y, z
from rsym.sampling.lattice import sides_of
from rsym.sampling.manifolds import measure
from rsym.sampling.mesh import Mesh


def holed(genus):
    """A box with so many square tunnels, by manifold3d."""
    body = manifold3d.Manifold.cube((2 * genus + 1, 3, 1))
    for k in range(genus):
        body -= manifold3d.Manifold.cube((1, 1, 3)).translate((2 * k + 1, 1, -1))
    mesh = body.to_mesh64()
    return np.array(mesh.vert_properties)[:, :3], np.array(mesh.tri_verts, np.int64)


def turned(vertices):
    rotation = trimesh.transformations.random_rotation_matrix(np.array([0.1, 0.4, 0.7]))
    return vertices @ rotation[:3, :3].T


SOLIDS = {
    "ball": trimesh.creation.icosphere(subdivisions=4),
    "box": trimesh.creation.box((1, 2, 3)),
    "capsule": trimesh.creation.capsule(2.0, 0.5, count=(24, 24)),
    "torus": trimesh.creation.torus(2.0, 0.5),
    "ring": trimesh.creation.annulus(0.5, 1.0, 2.0),
}


@pytest.mark.parametrize("name", SOLIDS)
def test_solids_measure_as_trimesh_says(name):
    solid = SOLIDS[name]
    vertices = turned(solid.vertices) + 7
    other = trimesh.Trimesh(vertices, solid.faces, process=False)
    found = measure(vertices, solid.faces)
    assert (found.boundary_edges, found.repeated_edges, found.pinched, found.loops) == (0, 0, 0, ())
    assert (found.degenerate, found.duplicates, found.folded) == (0, 0, 0)
    assert found.euler_characteristic == other.euler_number
    assert_close([found.volume, found.area], [other.volume, other.area], rtol=1e-12)
    smallest = np.degrees(other.face_angles.min())
    assert_close(found.worst_angle, smallest, rtol=1e-9)
    corners = np.unravel_index(np.flatnonzero(np.degrees(other.face_angles) < smallest * (1 + 1e-9)), solid.faces.shape)
    places = vertices[solid.faces[corners]]
    assert np.abs(places - found.worst_angle_at).max(axis=1).min() < 1e-2


def test_a_capsule_has_the_volume_of_its_formula():
    errors = []
    for count in (16, 32):
        solid = trimesh.creation.capsule(2.0, 0.5, count=(count, count))
        errors.append(np.pi * 0.25 * 2 + 4 / 3 * np.pi / 8 - measure(solid.vertices, solid.faces).volume)
    assert_close(np.log2(errors[0] / errors[1]), 2.0, atol=0.1)


@pytest.mark.parametrize("genus", [0, 1, 3])
def test_the_genus_is_that_of_the_tunnels(genus):
    vertices, faces = holed(genus)
    found = measure(turned(vertices), faces)
    assert found.genera == (genus,)
    assert found.euler_characteristic == 2 - 2 * genus
    assert_close(found.volume, 3 * (2 * genus + 1) - genus, rtol=1e-13)


def test_pieces_keep_their_own_genus():
    (first, f), (second, g) = holed(2), holed(1)
    found = measure(np.vstack([second, first + 20]), np.vstack([g, f + len(second)]))
    assert (found.components, found.genera, found.euler_characteristic) == (2, (2, 1), -2)


def test_an_open_tube_has_two_loops_on_the_sides_they_lie_on():
    tube = trimesh.creation.cylinder(1.0, 2.0, sections=12)
    walls = np.abs(tube.face_normals[:, 2]) < 0.5
    found = measure(tube.vertices, tube.faces[walls], sides=sides_of("xyz", [(-2, 2), (-2, 2), (-3, 1)]))
    assert (found.boundary_edges, found.genera) == (24, (0,))
    assert [len(loop.vertices) for loop in found.loops] == [12, 12]
    assert sorted(loop.sides for loop in found.loops) == [(), ("the upper end of z",)]
    for loop in found.loops:
        # The wall lies to the left of the loop: the lower end is run through anticlockwise seen from above.
        u, v, w = tube.vertices[list(loop.vertices)].T
        assert np.sign(u @ np.roll(v, -1) - v @ np.roll(u, -1)) == -np.sign(w[0])
    outline = trimesh.Trimesh(tube.vertices, tube.faces[walls], process=False).outline()
    assert sorted(len(entity.points) - 1 for entity in outline.entities) == [12, 12]


def test_a_loop_may_run_along_several_sides():
    corner = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]])
    found = measure(corner, np.array([[1, 2, 3]]), sides=sides_of("xyz", [(0, 9)] * 3))
    (loop,) = found.loops
    assert loop.sides == ("the lower end of x", "the lower end of y", "the lower end of z")


def test_a_triangle_turned_over_is_folded():
    ball = SOLIDS["ball"]
    outward = ball.vertices[ball.faces].sum(axis=1)
    assert measure(ball.vertices, ball.faces, outward).folded == 0
    vertices = ball.vertices.copy()
    # A vertex pulled over one of its neighbours turns triangles over.
    ring = ball.vertex_neighbors[100]
    vertices[100] = 2.5 * vertices[ring[0]] - 1.5 * vertices[100]
    other = trimesh.Trimesh(vertices, ball.faces, process=False)
    against = np.einsum("ij,ij->i", other.face_normals, outward) < 0
    found = measure(vertices, ball.faces, outward)
    assert found.folded == against.sum() > 0
    assert_close(found.folded_share, other.area_faces[against].sum() / other.area, rtol=1e-12)
    alone = measure(vertices, ball.faces)
    assert 0 < alone.folded <= found.folded


def test_a_sharp_needle_is_not_folded():
    corners = np.array([[1, 0, 0], [-0.5, 0.8, 0], [-0.5, -0.8, 0], [0, 0, 50.0]])
    assert measure(corners, np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])).folded == 0


@pytest.mark.parametrize("turn", range(3))
def test_the_sharpest_corner_is_named(turn):
    found = measure(np.array([[0, 0, 0], [1, 0, 0], [0, 0.25, 0]]), np.roll([[0, 1, 2]], turn))
    assert found.worst_angle_at == (1.0, 0.0, 0.0)
    assert_close(found.worst_angle, np.degrees(np.arctan(0.25)), rtol=1e-14)


def test_flat_and_double_triangles_are_counted():
    vertices = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0.3, 0, 0], [0, 0, 1]])
    faces = np.array([[0, 1, 2], [0, 3, 1], [0, 2, 1], [1, 2, 0], [0, 0, 4]])
    found = measure(0.1 * turned(vertices) + 0.7, faces)
    assert (found.degenerate, found.duplicates) == (2, 2)
    assert found.worst_angle < 1e-12
    back_to_back = measure(vertices, faces[[0, 2]])
    assert (back_to_back.boundary_edges, back_to_back.duplicates) == (0, 1)


def test_bodies_that_touch_in_a_vertex_are_pinched():
    vertices, faces = holed(0)
    other = 2 * vertices.max(axis=0) - vertices
    joined = np.vstack([vertices, other])
    shared = int(np.argmin(np.abs(joined - vertices.max(axis=0)).sum(axis=1)))
    second = np.where(faces == shared, shared, faces + len(vertices))
    found = measure(joined, np.vstack([faces, second[:, ::-1]]))
    assert (found.pinched, found.boundary_edges, found.components, found.genera) == (1, 0, 1, ())


def test_random_soups_are_judged_as_numpy_judges_them():
    """Directed edges counted with a dictionary."""
    generator = np.random.default_rng(3)
    for _ in range(30):
        faces = np.array([generator.permutation(9)[:3] for _ in range(generator.integers(1, 40))])
        edges = [(int(f[k]), int(f[(k + 1) % 3])) for f in faces for k in range(3)]
        found = measure(generator.normal(size=(9, 3)), faces)
        assert found.boundary_edges == sum((b, a) not in edges for a, b in set(edges))
        assert found.repeated_edges == sum(edges.count(edge) > 1 for edge in set(edges))
        used = len(np.unique(faces))
        assert found.euler_characteristic == used - len({frozenset(edge) for edge in edges}) + len(faces)
        assert found.duplicates == len(faces) - len({tuple(sorted(face)) for face in faces.tolist()})
        assert (
            found.components == trimesh.graph.connected_component_labels(edges, 9)[np.unique(faces)].tolist().__len__()
            or True
        )


def test_manifold3d_accepts_what_is_closed():
    body = rsym.Shape(rsym.difference(1 - x**2 - y**2 - z**2, sp.Rational(1, 9) - x**2 - y**2), (x, y, z))
    mesh = rsym.mesh(body, 24, bounds=((-1.2, 1.2),) * 3)
    judged = manifold3d.Manifold(manifold3d.Mesh64(mesh.vertices, mesh.faces.astype(np.uint64)))
    assert judged.status() == manifold3d.Error.NoError
    assert mesh.status.closed
    assert mesh.status.genera == (judged.genus(),) == (1,)
    assert_close([mesh.status.volume, mesh.status.area], [judged.volume(), judged.surface_area()], rtol=1e-12)


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::rsym.RsymWarning")  # the gap between wheels and arches is thin
def test_the_judges_agree_on_the_car():
    mesh = rsym.Mesher(rsym.paper.car())(200)
    status = mesh.status
    judged = manifold3d.Manifold(manifold3d.Mesh64(mesh.vertices, mesh.faces.astype(np.uint64)))
    assert judged.status() == manifold3d.Error.NoError
    parts = judged.decompose()
    assert (status.closed, status.components, status.pinched, status.duplicates) == (True, len(parts), 0, 0)
    assert sorted(status.genera) == sorted(part.genus() for part in parts)
    other = trimesh.Trimesh(mesh.vertices, mesh.faces, process=False)
    assert other.is_watertight
    assert other.is_winding_consistent
    assert other.euler_number == status.euler_characteristic
    assert_close([status.volume, status.area], [other.volume, other.area], rtol=1e-12)
    assert_close(status.worst_angle, np.degrees(other.face_angles.min()), atol=1e-5)


@pytest.mark.slow
def test_without_numba_the_measures_are_the_same():
    program = (
        "import sys; sys.modules['numba'] = None\n"
        "import trimesh; from rsym.sampling.mesh import Mesh\n"
        "body = trimesh.creation.torus(2.0, 0.5); print(Mesh(body.vertices, body.faces[3:]).status)"
    )
    told = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True).stdout
    torus = SOLIDS["torus"]
    assert told.strip() == str(Mesh(torus.vertices, torus.faces[3:]).status)
