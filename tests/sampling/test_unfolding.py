"""No triangle of the car faces inwards; where a mesh had none, nothing of it changes."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

import rsym
from rsym.sampling.sharp import finishing

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
@pytest.mark.parametrize(("variant", "cells", "folds"), [("a", 128, 16), ("b", 128, 19), ("a", 96, 3)])
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
