"""Features of meshes made by hand, whose curves, sides and angles are known without a mesher, and of simple bodies."""

import numpy as np
import pytest
import sympy as sp
from oracles.closeness import assert_close

import rsym
from rsym import x, y, z
from rsym.sampling.sharp.features import features_of

SIDES = ("left", "right", "front", "back", "bottom", "top")


def flat_normals(vertices, faces):
    a, b, c = vertices[faces].transpose(1, 0, 2)
    normals = np.cross(b - a, c - a)
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    return lambda some: normals[some][:, None].repeat(3, axis=1)


def cube(n):
    """[0, 1]^3, each side n*n squares of two triangles, welded; faces, and the side of each."""
    u, v = (axis.ravel() for axis in np.meshgrid(np.arange(n), np.arange(n), indexing="ij"))
    points, faces, leaf = [], [], []
    for side in range(6):
        axis, top = divmod(side, 2)
        square = np.array([(u, v), (u + 1, v), (u + 1, v + 1), (u, v + 1)]).transpose(2, 0, 1)
        corners = np.insert(square, 0, n * top, axis=2)
        corners = np.roll(corners, axis, axis=2)  # (axis, axis + 1, axis + 2) is a turn of (x, y, z)
        corners = corners if top else corners[:, ::-1]
        start = 4 * n * n * side + 4 * np.arange(n * n)[:, None]
        points.append(corners.reshape(-1, 3))
        faces.append(np.concatenate([start + np.array([0, 1, 2]), start + np.array([0, 2, 3])]))
        leaf.append(np.full(2 * n * n, side, np.int16))
    welded, index = np.unique(np.concatenate(points), axis=0, return_inverse=True)
    return welded / n, index.ravel()[np.concatenate(faces)].astype(np.int32), np.concatenate(leaf)


def tube(n, rings=3):
    """A cylinder about z between 0 and 1, closed by fans: bottom 0, mantle 1, top 2."""
    turn = 2 * np.pi * np.arange(n) / n
    points = [np.stack([np.cos(turn), np.sin(turn), np.full(n, height)], axis=1) for height in np.linspace(0, 1, rings)]
    here, there = np.arange(n), np.roll(np.arange(n), -1)
    faces = []
    for ring in range(rings - 1):
        a, b, c, d = (n * ring + k for k in (here, there, there + n, here + n))
        faces += [np.stack([a, b, c], 1), np.stack([a, c, d], 1)]
    last, bottom, top = (rings - 1) * n, np.full(n, rings * n), np.full(n, rings * n + 1)
    faces += [np.stack([there, here, bottom], 1), np.stack([here + last, there + last, top], 1)]
    leaf = [1] * 2 * last + [0] * n + [2] * n
    return np.concatenate([*points, [[0, 0, 0], [0, 0, 1.0]]]), np.concatenate(faces), np.array(leaf)


def shuffled(vertices, faces, leaf, seed=1):
    """The same mesh with its vertices and faces in another order, and other corners first."""
    random = np.random.default_rng(seed)
    place, order = random.permutation(len(vertices)), random.permutation(len(faces))
    moved = np.empty_like(vertices)
    moved[place] = vertices
    turned = place[faces][np.arange(len(faces))[:, None], (np.arange(3) + random.integers(0, 3, (len(faces), 1))) % 3]
    return moved, turned[order], leaf[order]


@pytest.mark.parametrize("n", [1, 2, 5])
@pytest.mark.parametrize("order", [lambda *mesh: mesh, shuffled])
def test_a_cube_has_twelve_edges_between_its_sides(n, order):
    vertices, faces, leaf = order(*cube(n))
    found = features_of(vertices, faces, leaf, leaf, SIDES, flat_normals(vertices, faces))
    assert len(found) == 12
    for feature in found:
        (one, other), points = feature.leaves, feature.points
        assert feature.names == (SIDES[one], SIDES[other])
        assert one < other
        assert not feature.closed
        assert len(points) == n + 1
        for side in (one, other):
            assert_close(points[:, side // 2], np.full(n + 1, side % 2), atol=1e-15)
        assert_close(np.linalg.norm(np.diff(points, axis=0), axis=1), np.full(n, 1 / n), atol=1e-12)
        assert_close(feature.angle, 90, atol=1e-9)
        # Seen from outside the first leaf lies to the left of the curve.
        out = np.zeros((2, 3))
        for row, side in enumerate((one, other)):
            out[row, side // 2] = 2 * (side % 2) - 1
        along = (points[-1] - points[0]) / np.linalg.norm(points[-1] - points[0])
        assert_close(np.cross(out[0] + out[1], along), out[0] - out[1], atol=1e-12)


@pytest.mark.parametrize("order", [lambda *mesh: mesh, shuffled])
def test_the_rims_of_a_cylinder_are_closed_circles(order):
    vertices, faces, leaf = order(*tube(40))
    found = features_of(vertices, faces, leaf, leaf, ("bottom", "mantle", "top"), flat_normals(vertices, faces))
    assert {feature.names for feature in found} == {("bottom", "mantle"), ("mantle", "top")}
    for feature in found:
        assert feature.closed
        assert len(feature.points) == 41
        assert_close(feature.points[:, 2], np.full(41, feature.leaves[1] - 1), atol=1e-15)
        x, y, _ = feature.points.T
        area = (x[:-1] * y[1:] - x[1:] * y[:-1]).sum() / 2
        # The bottom on its left, seen from below, it runs clockwise seen from above; so it does under the top.
        assert_close(area, -20 * np.sin(2 * np.pi / 40), atol=1e-12)
    assert "closed, 90°" in repr(found[0])


def test_one_pair_of_leaves_may_meet_in_several_curves_and_a_smooth_seam_has_no_angle():
    vertices, faces, leaf = tube(30, rings=6)
    leaf[30 * 2 * 2 : 30 * 2 * 3] = 3  # a band of the mantle
    # Normals of the round mantle, the same on both sides of its seams.
    outward = vertices * [1, 1, 0] + [0, 0, 1e-30]
    outward /= np.linalg.norm(outward, axis=1)[:, None]
    found = features_of(vertices, faces, leaf, leaf, "abcd", lambda some: outward[faces[some]])
    assert [feature.names for feature in found].count(("b", "d")) == 2
    assert all(feature.angle < 1e-6 for feature in found if feature.names == ("b", "d"))


def test_a_mesh_of_one_leaf_and_open_borders_have_no_features():
    vertices, faces, leaf = cube(3)
    normals = flat_normals(vertices, faces)
    assert features_of(vertices, faces, np.zeros_like(leaf), np.zeros_like(leaf), ("all",), normals) == ()
    some = leaf < 2  # two sides that do not touch
    assert features_of(vertices, faces[some], leaf[some], leaf[some], SIDES, normals) == ()


def test_three_curves_end_at_a_corner_and_four_at_a_crossing():
    u, v = (axis.ravel() for axis in np.meshgrid(np.arange(4), np.arange(4), indexing="ij"))
    corner = 5 * u + v
    faces = np.concatenate(
        [np.stack([corner, corner + 5, corner + 6], 1), np.stack([corner, corner + 6, corner + 1], 1)]
    )
    plane = np.array([(i, j, 0.0) for i in range(5) for j in range(5)])
    chessboard = np.tile((u >= 2) ^ (v >= 2), 2).astype(int)
    up = lambda some: np.tile([0.0, 0, 1], (len(some), 3, 1))  # noqa: E731
    found = features_of(plane, faces, chessboard, chessboard, "ab", up)
    assert sorted(len(feature.points) for feature in found) == [3, 3, 3, 3]
    for feature in found:
        assert [2, 2, 0] in feature.points[[0, -1]].tolist()


def test_curves_of_different_leaves_do_not_run_on_into_each_other():
    """A fan of three leaves on the border of an open mesh: one curve comes to its middle, the other leaves it."""
    fan = np.array([[0, 0, 0], [2, 0, 0], [1, 1, 0], [-1, 1, 0], [-2, 0, 0.0]])
    faces = np.array([[0, 1, 2], [0, 2, 3], [0, 3, 4]])
    found = features_of(fan, faces, np.array([2, 0, 1]), np.array([2, 0, 1]), "abc", flat_normals(fan, faces))
    assert sorted(feature.names for feature in found) == [("a", "b"), ("a", "c")]


def test_the_rim_of_two_balls_is_the_circle_of_geometry():
    first = rsym.Shape(4 - x**2 - y**2 - z**2, (x, y, z), bounds=((-1.5, 2.5), (-2.2, 2.2), (-2.2, 2.2)))
    second = rsym.Shape(4 - (x - 1) ** 2 - y**2 - z**2, (x, y, z))
    (rim,) = rsym.mesh(first.named("left") & second.named("right"), 40).features
    assert rim.closed
    assert rim.names == ("left", "right")
    count = len(rim.points)
    assert_close(rim.points[:, 0], np.full(count, 0.5), atol=1e-13)
    assert_close(np.hypot(*rim.points[:, 1:].T), np.full(count, np.sqrt(3.75)), atol=1e-13)
    assert_close(rim.normals[:, 0], rim.points / 2, atol=1e-12)
    assert_close(rim.normals[:, 1], (rim.points - [1, 0, 0]) / 2, atol=1e-12)
    assert_close(rim.angle, np.degrees(np.arccos((4 - 0.5) / 4)), atol=1e-9)


def test_a_bored_block_has_its_edges_and_two_rims():
    block = rsym.conjunction(1 - x, 1 + x, 1 - y, 1 + y, 1 - z, 1 + z)
    bore = rsym.Shape(sp.Rational(1, 4) - x**2 - y**2, (x, y, z)).named("bore")
    bored = rsym.Shape(block, (x, y, z), bounds=((-1.1, 1.2),) * 3).named("block") - bore
    found = rsym.mesh(bored, 30).features
    straight = [feature for feature in found if feature.names == ("block", "block")]
    rims = [feature for feature in found if "bore" in feature.names]
    assert (len(straight), len(rims), len(found)) == (12, 2, 14)
    for feature in straight:
        assert_close(np.sort(np.abs(feature.points[[0, -1]]), axis=1), np.ones((2, 3)), atol=1e-13)
        assert_close(np.linalg.norm(np.diff(feature.points, axis=0), axis=1).sum(), 2, atol=1e-12)
    for rim in rims:
        assert rim.closed
        assert_close(np.hypot(*rim.points[:, :2].T), np.full(len(rim.points), 0.5), atol=1e-13)
        assert_close(np.abs(rim.points[:, 2]), np.ones(len(rim.points)), atol=1e-13)
