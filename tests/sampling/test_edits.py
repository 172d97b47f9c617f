"""Edits of meshes whose vertices were rounded to a coarse grid: what remains encloses the same and is a manifold."""

import manifold3d
import numpy as np
import pytest
import trimesh
from oracles.closeness import assert_close

from rsym.sampling.manifolds import measure
from rsym.sampling.sharp.edits import edit
from rsym.sampling.sharp.faces import Adjacency

SOLIDS = {
    "ball": trimesh.creation.icosphere(subdivisions=3),
    "torus": trimesh.creation.torus(1, 0.4, major_sections=24, minor_sections=12),
    "box": trimesh.creation.box().subdivide().subdivide().subdivide(),
}
LATTICE = np.array([0, 0, 0, 1.0, 1.0, 1.0])


def edited(points, faces):
    """The mesh that is left, all of it flawed."""
    faces, quads = faces.astype(np.int32), np.arange(len(faces) // 2)
    found = edit(Adjacency(faces, len(points)), quads, points.T.copy(), faces, np.zeros(len(faces), np.int16), LATTICE)
    points, faces = np.concatenate([points, found.points.T]), np.concatenate([faces[found.remain], found.faces])
    assert len(found.leaf) == len(found.faces)
    used, numbers = np.unique(faces, return_inverse=True)
    return points[used], numbers.reshape(-1, 3)


@pytest.mark.parametrize("name", SOLIDS)
def test_rounded_solids_stay_manifolds_of_the_same_volume(name):
    solid = SOLIDS[name]
    generator = np.random.default_rng(5)
    for step in (0.1, 0.2, 0.3, 0.5, 0.5, 1.0, 1.0):
        points = np.round(solid.vertices / step + generator.normal(size=3)) * step
        left, faces = edited(points, solid.faces)
        found = measure(left, faces)
        assert (found.boundary_edges, found.repeated_edges, found.pinched) == (0, 0, 0)
        assert (found.degenerate, found.duplicates) == (0, 0)
        judged = manifold3d.Manifold(manifold3d.Mesh64(left, faces.astype(np.uint64)))
        assert judged.status() == manifold3d.Error.NoError
        before = trimesh.Trimesh(points, solid.faces, process=False).volume
        assert_close(found.volume, before, rtol=1e-12, atol=1e-12)


def test_a_solid_without_extent_vanishes():
    for flat in (np.array([1.0, 0, 0]), np.zeros(3)):
        points, faces = edited(SOLIDS["ball"].vertices * flat, SOLIDS["ball"].faces)
        assert len(points) == len(faces) == 0


def test_boxes_that_come_to_share_an_edge_stay_two():
    points = np.array([[x, y, z] for x in (0, 1.0) for y in (0, 1.0) for z in (0, 1.0)])
    box = trimesh.convex.convex_hull(points)
    shifted = box.vertices + np.array([1 + 1e-12, 1, 0])
    corners, faces = np.concatenate([box.vertices, shifted]), np.concatenate([box.faces, box.faces + 8])
    left, faces = edited(corners, faces)
    found = measure(left, faces)
    assert (found.components, found.pinched, found.repeated_edges) == (2, 0, 0)
    assert_close(found.volume, 2.0, rtol=1e-11)
