"""Sharp meshes against formulas, and against trimesh and manifold3d, which share no code with them."""

import itertools

import manifold3d
import numpy as np
import pytest
import sympy as sp
import trimesh
from closeness import assert_close
from scipy.spatial import ConvexHull, HalfspaceIntersection

import rsym
from rsym import x, y, z

AXES = (x, y, z)


def cube(half):
    return ((-half, half),) * 3


def rotation(seed):
    quaternion = np.random.default_rng(seed).normal(size=4)
    return trimesh.transformations.quaternion_matrix(quaternion / np.linalg.norm(quaternion))[:3, :3]


def judged(mesh, euler_characteristic=None):
    """The status of a mesh that manifold3d and trimesh accept as closed."""
    status = mesh.status
    strict = manifold3d.Manifold(manifold3d.Mesh64(mesh.vertices, mesh.faces.astype(np.uint64)))
    assert strict.status() == manifold3d.Error.NoError
    other = trimesh.Trimesh(mesh.vertices, mesh.faces, process=False)
    assert other.is_watertight
    assert other.is_winding_consistent
    assert (status.closed, status.pinched, status.duplicates) == (True, 0, 0)
    assert other.euler_number == status.euler_characteristic
    assert_close([status.volume, status.area], [other.volume, other.area], rtol=1e-12)
    if euler_characteristic is not None:
        assert status.euler_characteristic == euler_characteristic
    return status


def flawless(mesh, euler_characteristic):
    """The status of a mesh without any remark but of clipping."""
    status = judged(mesh, euler_characteristic)
    assert (status.folded, status.degenerate, status.off_surface) == (0, 0, None)
    return status


def letters(count):
    return sp.symbols(f"n:{count}", real=True)


def values(numbers):
    return {f"n{k}": float(number) for k, number in enumerate(np.ravel(numbers))}


@pytest.fixture(scope="module")
def polyhedra():
    """A mesher of bodies within eight planes n.x <= d: letters n, d plane by plane."""
    names = letters(32)
    planes = [names[k + 3] - sum(n * s for n, s in zip(names[k : k + 3], AXES, strict=True)) for k in range(0, 32, 4)]
    return rsym.Mesher(rsym.Shape(rsym.conjunction(*planes), AXES, letters=dict.fromkeys(names, 1), bounds=cube(2)))


def polyhedron(normals, distances):
    """Letters of a body within at most eight planes; the others are far away."""
    planes = np.tile([0, 0, 1.0, 9.0], (8, 1))
    planes[: len(normals)] = np.column_stack([normals, distances])
    return values(planes)


def hull(normals, distances):
    """The same body by scipy."""
    corners = HalfspaceIntersection(np.column_stack([normals, -np.asarray(distances)]), np.zeros(3)).intersections
    return ConvexHull(corners)


def nearest(points, corners):
    """How far the farthest of some corners is from the points."""
    return max(np.linalg.norm(points - corner, axis=1).min() for corner in corners)


@pytest.mark.parametrize("seed", [0, 1, 6, 11])
def test_a_rotated_cube_is_exact(polyhedra, seed):
    """Seed 6: a lattice point that is cut off from the others near a corner makes no crumb there."""
    turn = rotation(seed)
    mesh = polyhedra(64, letters=polyhedron([*turn, *-turn], np.ones(6)))
    status = flawless(mesh, 2)
    assert_close([status.volume, status.area], [8, 24], rtol=1e-12)
    assert nearest(mesh.vertices, np.array(list(itertools.product((-1, 1), repeat=3))) @ turn) < 1e-12
    lengths = [np.linalg.norm(np.diff(edge.points, axis=0), axis=1).sum() for edge in mesh.features]
    assert_close(lengths, [2] * 12, rtol=1e-12)
    assert_close([edge.angle for edge in mesh.features], [90] * 12, rtol=1e-12)


@pytest.mark.parametrize("sides", [3, 4, 5, 6, 7])
def test_pyramids_are_exact(polyhedra, sides):
    """As many planes as sides meet in the tip."""
    turn = rotation(sides)
    around = 2 * np.pi * np.arange(sides) / sides + 0.1
    normals = np.vstack([np.column_stack([np.cos(around), np.sin(around), np.full(sides, 0.8)]), [[0, 0, -1]]]) @ turn
    distances = np.array([0.45] * sides + [0.5])
    status = flawless(polyhedra(48, letters=polyhedron(normals, distances)), 2)
    body = hull(normals, distances)
    assert_close([status.volume, status.area], [body.volume, body.area], rtol=1e-11)


@pytest.fixture(scope="module")
def wedges():
    """Meshers of what is within six planes and both of two others, or either of them."""
    names = letters(32)
    planes = [names[k + 3] - sum(n * s for n, s in zip(names[k : k + 3], AXES, strict=True)) for k in range(0, 32, 4)]
    given = {"letters": dict.fromkeys(names, 1), "bounds": cube(1.7)}
    either = rsym.conjunction(*planes[:6], rsym.disjunction(*planes[6:]))
    return [rsym.Mesher(rsym.Shape(body, AXES, **given)) for body in (rsym.conjunction(*planes), either)]


@pytest.mark.parametrize("angle", [30, 45, 60, 90, 135, 170, 179, 181, 190, 225, 270, 285])
def test_wedges_of_any_angle_are_exact(wedges, angle):
    turn, radians = rotation(angle), np.radians(angle)
    box = np.column_stack([np.vstack([turn, -turn]), [0.9, 0.9, 0.8, 0.9, 0.9, 0.7]])
    sides = np.array([[0, -1, 0], [-np.sin(radians), np.cos(radians), 0]]) @ turn
    mesh = wedges[angle > 180](47, letters=values(np.vstack([box, np.column_stack([sides, [0.01, 0]])])))
    block = manifold3d.Manifold.cube((1.8, 1.8, 1.5)).translate((-0.9, -0.9, -0.7))
    halves = [block.trim_by_plane(-(side @ turn.T), -distance) for side, distance in zip(sides, (0.01, 0), strict=True)]
    body = halves[0] + halves[1] if angle > 180 else halves[0] ^ halves[1]
    status = flawless(mesh, 2)
    # manifold3d merges what is closer than 1e-12 or so.
    assert_close([status.volume, status.area], [body.volume(), body.surface_area()], rtol=1e-9)


SMOOTH = {
    "sphere": (1 - x**2 - y**2 - z**2, 4 / 3 * np.pi, 4 * np.pi),
    "torus": (
        sp.Rational(9, 100) - (sp.sqrt(x**2 + y**2) - sp.Rational(3, 4)) ** 2 - z**2,
        2 * np.pi**2 * 0.75 * 0.09,
        4 * np.pi**2 * 0.75 * 0.3,
    ),
    # A spheroid: its area has a closed form.
    "ellipsoid": (1 - x**2 - y**2 - 4 * z**2, 2 / 3 * np.pi, 2 * np.pi * (1 + np.arctanh(np.sqrt(0.75)) / np.sqrt(12))),
}


@pytest.mark.parametrize("name", SMOOTH)
def test_smooth_bodies_converge_with_the_square_of_the_cell(name):
    expression, volume, area = SMOOTH[name]
    shape = rsym.Shape(expression, AXES, bounds=cube(1.1))
    mesher, value = rsym.Mesher(shape), rsym.compile(shape)
    errors = []
    for cells in (32, 64, 128):
        mesh = mesher(cells)
        status = flawless(mesh, 0 if name == "torus" else 2)
        errors.append([abs(status.volume - volume), abs(status.area - area)])
        assert np.abs(value(*mesh.vertices.T)["value"]).max() < 1e-12
    assert (np.log2(np.divide(errors[:-1], errors[1:])) > 1.95).all()
