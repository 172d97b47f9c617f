"""The mesher: closed, outward, exact on omega, the same bits however it is computed."""

import logging
import multiprocessing
import threading
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from functools import partial

import numpy as np
import pytest
import sympy as sp
from oracles.closeness import assert_close
from oracles.undefined import without_value

import rsym
from rsym import RsymError, RsymWarning, Shape, conjunction, disjunction, x, y, z
from rsym.logic.sign_form import surface_program
from rsym.sampling import smooth
from rsym.sampling.lattice import Lattice

mesh_smoothly = partial(rsym.mesh, method="smooth")

BALL = Shape((1 - x**2 - y**2 - z**2) / 2, (x, y, z), bounds=((-1.25, 1.25),) * 3)


def directed_edges_match(faces):
    """libfive's oracle: every directed edge once, and its reverse once."""
    edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    forward = {tuple(edge) for edge in edges.tolist()}
    return len(forward) == len(edges) and all((b, a) in forward for a, b in forward)


@pytest.mark.parametrize("resolution", [8, 33, (20, 30, 25)])
def test_a_ball(resolution):
    mesh = mesh_smoothly(BALL, resolution)
    assert directed_edges_match(mesh.faces)
    assert mesh.status.closed
    assert mesh.status.euler_characteristic == 2
    assert mesh.status.volume > 0
    assert_close(np.linalg.norm(mesh.vertices, axis=1), np.ones(len(mesh.vertices)), atol=1e-6)
    assert_close(mesh.normals, mesh.vertices[mesh.faces], atol=1e-5)


def test_volume_converges_with_the_square_of_the_cell():
    errors = [4 * np.pi / 3 - mesh_smoothly(BALL, n).status.volume for n in (16, 32, 64)]
    assert 3.5 < errors[0] / errors[1] < 4.5
    assert 3.5 < errors[1] / errors[2] < 4.5


def test_faces_are_neither_repeated_nor_degenerate():
    mesh = mesh_smoothly(BALL, 40)
    corners = mesh.vertices[mesh.faces]
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    assert (area > 0).all()
    assert len(np.unique(np.sort(mesh.faces, axis=1), axis=0)) == len(mesh.faces)


# The pillars and the roof of the car, and their crumbs.
THIN = pytest.mark.filterwarnings("ignore:.*(thinner|smaller) than:rsym.errors.RsymWarning")


@pytest.mark.slow
@THIN
@pytest.mark.parametrize("variant", ["a", "b"])
def test_the_car_is_closed_and_its_vertices_are_on_omega(variant):
    shape = rsym.paper.car(variant)
    mesh = mesh_smoothly(shape, 96)
    assert directed_edges_match(mesh.faces)
    assert mesh.status.closed
    assert mesh.status.volume > 0
    omega = rsym.compile(shape)(*mesh.vertices.T)["value"]
    assert np.quantile(np.abs(omega), 0.99) < 1e-6


@pytest.mark.parametrize("length", [1, 3])
def test_a_normalised_shape_is_meshed_through_its_omega(length):
    shape = conjunction(BALL, Shape(z - x**2 + sp.Rational(1, 3), (x, y, z)))
    unit = rsym.normalise(~shape, length=length)
    assert "sqrt" not in str(surface_program(rsym.normalise(BALL, length=length), ("value",)))
    reference = mesh_smoothly(~shape, 24)
    assert reference.status.volume < 0  # the outside of the body
    for other in (mesh_smoothly(unit, 24), mesh_smoothly(~rsym.normalise(shape, length=length), 24)):
        assert np.array_equal(other.vertices, reference.vertices)
        assert np.array_equal(other.faces, reference.faces)


@pytest.mark.slow
@THIN
def test_the_gradient_of_the_normalised_car_is_one_away_from_its_edges():
    shape = rsym.paper.car()
    vertices = mesh_smoothly(shape, 64).vertices
    result = rsym.compile(rsym.normalise(shape), ("value", "gradient_squared"))(*vertices.T)
    # At the distance r from an edge the Laplacian is about 1/r: a thousandth of the car's length is 1/30.
    laplacian = rsym.compile(shape, ("laplacian",))(*vertices.T)["laplacian"]
    smooth_part = (np.abs(laplacian) < 30) & (np.abs(result["value"]) < 1e-13)
    assert smooth_part.mean() > 0.7
    assert_close(np.sqrt(result["gradient_squared"][smooth_part]), np.ones(smooth_part.sum()), atol=1e-9)


def test_a_body_that_leaves_the_bounds_is_said_to_be_clipped():
    with pytest.warns(RsymWarning, match="the upper end of x; wider") as caught:
        mesh = mesh_smoothly(BALL, 20, bounds=((-1.25, 0.3), (-1.25, 1.25), (-1.25, 1.25)))
    assert [warning.filename for warning in caught] == [__file__]
    assert mesh.status.clipped_at == ("the upper end of x",)
    assert not mesh.status.closed
    assert "clipped" in str(mesh.status)


@pytest.mark.slow
def test_the_same_bits_for_any_block_slab_executor_and_thread(monkeypatch):
    shape = disjunction(BALL, Shape(conjunction(x, 0.3 - y**2 - z**2, 1.2 - x), (x, y, z)))
    reference = mesh_smoothly(shape, 40)
    monkeypatch.setattr(smooth, "SLAB_POINTS", 4000)
    with ThreadPoolExecutor(2) as threads, ProcessPoolExecutor(2, multiprocessing.get_context("spawn")) as processes:
        others = [mesh_smoothly(shape, 40, executor=executor) for executor in (None, threads, processes)]
    from rsym.backends import kernel

    monkeypatch.setattr(kernel, "checked_threads", lambda threads: 1)
    smooth._surface_kernel.cache_clear()
    others.append(mesh_smoothly(shape, 40))
    for other in others:
        assert np.array_equal(other.vertices, reference.vertices)
        assert np.array_equal(other.faces, reference.faces)
        assert np.array_equal(other.normals, reference.normals)


def test_exact_zeros_on_the_lattice_are_handled():
    whole = Lattice((-4.0,) * 3, (1.0,) * 3, (9,) * 3)
    shape = Shape(2 - sp.Abs(x) - sp.Abs(y) - sp.Abs(z), (x, y, z))
    mesh = smooth.smooth_mesh(shape, whole, None, None, None)
    assert directed_edges_match(mesh.faces)
    assert mesh.status.nudged_zeros == 18
    assert len(np.unique(mesh.vertices, axis=0)) == len(mesh.vertices)
    assert_close(mesh.status.volume, 4 / 3 * 8, atol=1e-4)


@pytest.mark.random
@pytest.mark.parametrize("seed", range(25))
def test_random_integer_volumes_give_manifolds(seed, monkeypatch):
    """Integers put exact zeros everywhere; scikit-image alone fails on most of these."""
    values = np.random.default_rng(seed).integers(-3, 4, (7, 7, 7)).astype(float)
    values[[0, -1]] = values[:, [0, -1]] = values[:, :, [0, -1]] = -1
    monkeypatch.setattr(smooth, "sample", lambda *arguments: values)
    whole = Lattice((0.0,) * 3, (1.0,) * 3, (7,) * 3)
    mesh = smooth.smooth_mesh(Shape(x + y + z, (x, y, z)), whole, None, None, None)
    assert directed_edges_match(mesh.faces)


def test_signs_survive_float32(monkeypatch):
    """Between 1e30 inside and -1e-30 outside no float32 scale keeps both; the sign must stay."""
    values = np.full((6, 6, 6), -1e-30)
    values[2:4, 2:4, 2:4] = 1e30
    monkeypatch.setattr(smooth, "sample", lambda *arguments: values)
    whole = Lattice((0.0,) * 3, (1.0,) * 3, (6,) * 3)
    mesh = smooth.smooth_mesh(Shape(x + y + z, (x, y, z)), whole, None, None, None)
    assert directed_edges_match(mesh.faces)
    assert mesh.status.volume > 0


@pytest.mark.parametrize("factor", [1e-200, 1e-50, 1e40, 1e250])
def test_the_scale_of_omega_does_not_matter(factor):
    reference = mesh_smoothly(BALL, 24)
    other = mesh_smoothly(BALL.replace(expression=sp.Float(factor, 17) * BALL.expression), 24)
    assert np.array_equal(other.faces, reference.faces)
    assert_close(other.vertices, reference.vertices, atol=1e-12)


@pytest.mark.parametrize(
    ("call", "code"),
    [
        (lambda: mesh_smoothly(Shape(x, (x, y), bounds=((-1, 1),) * 2)), "dimension"),
        (lambda: rsym.mesh(BALL, method="rough"), "unknown-method"),
        (lambda: mesh_smoothly(BALL.replace(expression=BALL.expression + 9)), "no-surface"),
        (lambda: mesh_smoothly(BALL.replace(expression=BALL.expression - 9)), "no-surface"),
        (lambda: mesh_smoothly(BALL.replace(expression=without_value(-x) + z - 1)), "undefined"),
        (lambda: mesh_smoothly(BALL, progress=lambda done, total: False), "cancelled"),
        (lambda: mesh_smoothly(Shape(x + y + z, (x, y, z))), "unbounded"),
        (lambda: mesh_smoothly(BALL, 0), "resolution"),
    ],
)
def test_bad_input(call, code):
    with pytest.raises(RsymError) as caught:
        call()
    assert caught.value.code == code


def test_progress_is_reported():
    seen = []
    mesh_smoothly(BALL, 16, progress=lambda done, total: seen.append((done, total)))
    total = 1 + smooth.VERTEX_BLOCKS + 3
    assert seen == [(done, total) for done in range(1, total + 1)]


@pytest.mark.parametrize("last", range(1, 13))
def test_every_report_can_cancel_and_is_then_the_last(last):
    seen = []
    with pytest.raises(RsymError, match=f"after {last} of 12") as caught:
        mesh_smoothly(BALL, 16, progress=lambda done, total: seen.append(done) or done < last)
    assert caught.value.code == "cancelled"
    assert seen == list(range(1, last + 1))


def test_a_cancel_leaves_no_slab_waiting_in_an_executor(monkeypatch):
    monkeypatch.setattr(smooth, "SLAB_POINTS", 1000)
    computed, cancelled = [], threading.Event()
    evaluate = smooth._sample_slab

    def second_slab_waits(*task):
        computed.append(1)
        assert len(computed) == 1 or cancelled.wait(60)
        return evaluate(*task)

    monkeypatch.setattr(smooth, "_sample_slab", second_slab_waits)
    with ThreadPoolExecutor(1) as threads:
        with pytest.raises(RsymError, match="cancelled"):
            mesh_smoothly(BALL, 60, executor=threads, progress=lambda done, total: False)
        cancelled.set()
    assert len(computed) <= 2


def test_the_log_tells_samples_seconds_and_status(caplog):
    with caplog.at_level("INFO", "rsym"):
        mesh = mesh_smoothly(BALL, 8)
    (record,) = [record for record in caplog.records if record.name == "rsym.sampling.meshing"]
    assert "triangles" in record.getMessage()
    assert str(mesh.status) in record.getMessage()
    assert any(isinstance(handler, logging.NullHandler) for handler in logging.getLogger("rsym").handlers)
