"""No triangle of the car faces inwards; where a mesh had none, nothing of it changes."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from oracles.closeness import assert_close

import rsym
from rsym.sampling.sharp import finishing, unfolding, untangling
from rsym.sampling.sharp.faces import Adjacency, facing_inwards

pytestmark = pytest.mark.filterwarnings("ignore::rsym.RsymWarning")


def folded_and_mended(monkeypatch, shape, cells):
    """The status of the mesh whose folds stay, and that of the mesh as it is."""
    mended = rsym.mesh(shape, cells).status
    with monkeypatch.context() as patch:
        patch.setattr(finishing, "facing_inwards", lambda *_: (np.zeros(1, bool), None))
        folded = rsym.mesh(shape, cells).status
    return folded, mended


@pytest.mark.random
@pytest.mark.parametrize("cells", [96, 112, 128, 160, 192])
@pytest.mark.parametrize("variant", ["a", "b"])
def test_no_triangle_of_the_car_faces_inwards(variant, cells):
    status = rsym.mesh(rsym.paper.car(variant), cells).status
    assert (status.folded, status.degenerate, status.duplicates, status.pinched) == (0, 0, 0, 0)
    assert status.closed
    assert status.off_surface is None


@pytest.mark.slow
@pytest.mark.parametrize(("variant", "cells", "folds"), [("a", 128, 16), ("b", 128, 18), ("a", 96, 3)])
def test_unfolding_keeps_the_surface_as_it_hangs_together(monkeypatch, variant, cells, folds):
    folded, mended = folded_and_mended(monkeypatch, rsym.paper.car(variant), cells)
    assert folded.folded == folds, "nothing else takes these folds out"
    assert mended.folded == 0
    assert (mended.genera, mended.components) == (folded.genera, folded.components)
    assert abs(mended.volume - folded.volume) < 1e-4 * folded.volume


def test_walls_thinner_than_a_cell_unfold(monkeypatch):
    ball = rsym.Shape(1 - rsym.x**2 - rsym.y**2 - rsym.z**2, (rsym.x, rsym.y, rsym.z), bounds=((-1.2, 1.2),) * 3)
    cut = ball - ball.translate(0.03, 0.02, 0.01).scale(0.97)
    folded, mended = folded_and_mended(monkeypatch, cut, 24)
    assert folded.folded > 10 * mended.folded
    assert mended.closed
    assert mended.pinched == 0


@pytest.mark.slow
def test_pieces_unfold_as_the_whole_does():
    car = rsym.paper.car()
    whole = rsym.mesh(car, 112)
    with ThreadPoolExecutor(2) as pool:
        pieces = rsym.mesh(car, 112, executor=pool)
    for name in ("vertices", "faces", "leaf", "normals"):
        assert np.array_equal(getattr(whole, name), getattr(pieces, name))


def test_a_mesh_without_folds_keeps_its_bits(monkeypatch):
    car = rsym.paper.car()
    mended = rsym.mesh(car, 160)
    monkeypatch.setattr(finishing, "facing_inwards", lambda *_: (np.zeros(1, bool), None))
    as_it_was = rsym.mesh(car, 160)
    assert np.array_equal(mended.vertices, as_it_was.vertices)
    assert np.array_equal(mended.faces, as_it_was.faces)


def test_what_is_kept_around_vertices_is_what_would_be_found_anew(monkeypatch):
    car = rsym.paper.car()
    kept = rsym.Mesher(car)(64)
    improve = unfolding._Region.improve

    def improve_anew(region, keep):
        region.known[:], region.quiet[:], region.moves = False, False, region.moves[:, :0]
        return improve(region, keep)

    monkeypatch.setattr(unfolding._Region, "improve", improve_anew)
    anew = rsym.Mesher(car)(64)
    assert np.array_equal(kept.vertices, anew.vertices)
    assert np.array_equal(kept.faces, anew.faces)


def test_in_whichever_groups_clusters_are_untangled_the_mesh_is_the_same(monkeypatch):
    mesher = rsym.Mesher(rsym.paper.car())
    meshes = []
    for groups in (1, 6):
        monkeypatch.setattr(untangling, "GROUPS", groups)
        monkeypatch.setattr(untangling, "GROUP", 1)
        meshes.append(mesher(64))
    assert np.array_equal(meshes[0].vertices, meshes[1].vertices)
    assert np.array_equal(meshes[0].faces, meshes[1].faces)


class Flat:
    """Leaves whose gradient is the same everywhere."""

    def __init__(self, gradient):
        self.gradient = np.array(gradient, float)

    def evaluate(self, leaf, points):
        return points[0], np.repeat(self.gradient[:, None], points.shape[1], axis=1)


def test_triangles_face_inwards_where_their_normal_runs_along_the_gradient():
    generator = np.random.default_rng(3)
    corners = generator.normal(size=(200, 3, 3))
    corners[:20, 2] = (corners[:20, 0] + corners[:20, 1]) / 2
    gradient = np.array([0.3, -2.0, 1.0])
    folded, turned = facing_inwards(Flat(gradient), corners, np.zeros(200, np.int16))
    for triangle, inwards, away in zip(corners, folded, turned, strict=True):
        normal = np.cross(triangle[1] - triangle[0], triangle[2] - triangle[0])
        outwards = -normal @ gradient / np.linalg.norm(gradient)
        assert inwards == (outwards < 0 or np.linalg.norm(normal) < 1e-9)
        assert_close(away, np.linalg.norm(normal) - outwards, rtol=1e-12, atol=1e-12)


def test_rings_of_quads_are_those_that_share_vertices():
    generator = np.random.default_rng(4)
    quads = [generator.choice(60, 4, replace=False).tolist() for _ in range(40)]
    faces = np.array([[q[k] for k in corners] for q in quads for corners in ((0, 1, 2), (0, 2, 3))], np.int32)
    for rings in (1, 2):
        found, inner = Adjacency(faces, 60).around(np.array([7]), rings)
        near = {7}
        for _ in range(rings):
            vertices = {v for q in near for v in quads[q]}
            near = {q for q in range(40) if vertices & set(quads[q])}
        assert found.tolist() == sorted(near)
        assert set(np.flatnonzero(inner).tolist()) == vertices
