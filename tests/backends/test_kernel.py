import sys
import threading
from dataclasses import replace

import numpy as np
import pytest
import sympy as sp
from hypothesis import given, settings
from oracles.closeness import assert_close
from oracles.tiers import examples
from oracles.trees import trees

import rsym
from rsym import RsymError, Shape, conjunction, x, y, z
from rsym.backends import kernel as kernel_module
from rsym.backends.interpreter import interpret_nodes
from rsym.backends.kernel import blocks_of, run_in_blocks
from rsym.program.operations import OPERATIONS

a = sp.Symbol("a", real=True)
SHAPE = Shape(conjunction(a - x**2 - y**2, y, x + 1), (x, y), letters={a: 2}, bounds=((-2, 2), (-2, 2)))
ALL = (*rsym.SIX, "gradient", "hessian", "singular")


@pytest.mark.parametrize("backend", ["numpy", "llvm"])
def test_shapes_of_results(backend):
    result = rsym.compile(SHAPE, ALL, backend=backend)(np.zeros((3, 1)), np.ones(4))
    assert {name: array.shape for name, array in result.items()} == {
        **{name: (3, 4) for name in rsym.SIX},
        "gradient": (3, 4, 2),
        "hessian": (3, 4, 2, 2),
        "singular": (3, 4),
    }
    assert result["singular"].dtype == bool
    scalar = rsym.compile(SHAPE, backend=backend)(0.5, 0.5)["value"]
    assert scalar.shape == ()
    assert rsym.compile(SHAPE, backend=backend)(np.zeros(0), 1.0)["value"].shape == (0,)


def test_letters_change_the_result_and_never_recompile():
    kernel = rsym.compile(SHAPE)
    count = len(kernel_module._CACHE)
    assert kernel(0.0, 0.5, letters={"a": 1.0})["value"] != kernel(0.0, 0.5)["value"]
    rsym.compile(SHAPE.with_letters({"a": 7}))
    assert len(kernel_module._CACHE) == count


@pytest.mark.slow
@pytest.mark.parametrize("dtype", ["float64", "float32"])
@pytest.mark.parametrize("backend", ["numpy", "llvm"])
def test_the_same_bits_for_any_threads_blocks_and_neighbours(backend, dtype, monkeypatch):
    points = np.random.default_rng(0).uniform(-2, 2, (2, 5003))
    reference = rsym.compile(SHAPE, rsym.SIX, backend=backend, dtype=dtype, threads=1)(*points)
    for block_size in (1, 7, 64, 1000):
        kernel = rsym.compile(SHAPE, rsym.SIX, backend=backend, dtype=dtype, threads=2)
        monkeypatch.setattr(type(kernel.function), "block_size", block_size)
        result = kernel(*points)
        for name in rsym.SIX:
            assert np.array_equal(result[name], reference[name], equal_nan=True)
    value = rsym.compile(SHAPE, backend=backend, dtype=dtype)
    grid = value(points[0][:17, None], points[1][None, :19])["value"]
    alone = [[value(u, v)["value"] for v in points[1][:19]] for u in points[0][:17]]
    assert np.array_equal(grid, np.array(alone))


def shares_of_the_largest_node(shape, points):
    """Errors of the float32 value against the float64 interpreter, as shares of the largest node at the point."""
    kernel = rsym.compile(shape, dtype="float32")
    inputs = dict(zip(kernel.program.coordinates, points, strict=True))
    inputs |= {name: float(shape.letters[name].default) for name in kernel.program.letters}
    nodes = interpret_nodes(kernel.program, inputs)
    largest = np.max([np.broadcast_to(np.abs(node), points[0].shape) for node in nodes], axis=0)
    return np.abs(kernel(*points)["value"] - nodes[-1]) / largest


@pytest.mark.slow
def test_the_error_of_float32_on_the_car():
    car = rsym.paper.car()
    points = [np.random.default_rng(5).uniform(*side, 50_000).astype(np.float32) for side in car.bounds]
    assert shares_of_the_largest_node(car, points).max() <= 2.0**-24


@pytest.mark.slow
@settings(max_examples=examples(60), deadline=None)
@given(tree=trees())
def test_the_error_of_float32_on_random_trees(tree):
    points = np.random.default_rng(6).uniform(-1.5, 1.5, (3, 300)).astype(np.float32)
    assert shares_of_the_largest_node(Shape(tree, (x, y, z)), points).max() <= 32 * 2.0**-24


def test_both_backends_give_the_same_bits_in_float32():
    body = rsym.paper.skeleton_body()
    points = [np.random.default_rng(7).uniform(*side, 1000) for side in body.box.ends]
    first, second = (rsym.compile(body, ALL, backend=name, dtype="float32")(*points) for name in ("numpy", "llvm"))
    for name in ALL:
        assert first[name].dtype == (bool if name == "singular" else np.float32)
        assert np.array_equal(first[name], second[name], equal_nan=True)


def test_numbers_beyond_float32_are_zero_or_infinite():
    kernel = rsym.compile(Shape(x * a, (x, y), letters={a: 1e-60}), dtype="float32")
    assert kernel([1.0, 1e300], 0.0)["value"].tolist()[0] == 0.0
    assert kernel(1e300, 0.0, letters={"a": 1.0})["value"] == np.inf


def test_a_joint_zero_has_the_value_zero_and_is_singular():
    result = rsym.compile(Shape(conjunction(x, y), (x, y)), ("value", "gradient", "laplacian", "singular"))
    at = result(np.array([0.0, 1.0]), np.array([0.0, 0.0]))
    assert at["value"].tolist() == [0, 0]
    assert at["singular"].tolist() == [True, False]
    assert np.isnan(at["gradient"][0]).all()
    assert np.isnan(at["laplacian"][0])


def test_constant_fields_have_the_shape_of_the_points():
    result = rsym.compile(Shape(3 * x + 1, (x, y)), ("laplacian", "gradient_squared"))(np.zeros(5), 0.0)
    assert result["laplacian"].tolist() == [0] * 5
    assert result["gradient_squared"].tolist() == [9] * 5


def test_integers_are_taken_as_real_numbers():
    assert rsym.compile(Shape(x / 2 + y, (x, y)))([1, 2], 10**15)["value"].tolist() == [10**15 + 0.5, 10**15 + 1.0]


@pytest.mark.parametrize(
    ("call", "code"),
    [
        (lambda: rsym.compile(SHAPE, ("colour",)), "unknown-field"),
        (lambda: rsym.compile(SHAPE, ()), "unknown-field"),
        (lambda: rsym.compile(SHAPE, backend="fortran"), "unknown-backend"),
        (lambda: rsym.compile(SHAPE, dtype="int8"), "dtype"),
        (lambda: rsym.compile(SHAPE, threads=0), "threads"),
        (lambda: rsym.compile(x + y), "shape"),
        (lambda: rsym.compile(SHAPE)(1.0), "arity"),
        (lambda: rsym.compile(SHAPE)(1.0, "north"), "array"),
        (lambda: rsym.compile(SHAPE)(1.0, 2.0, letters={"b": 1}), "unknown-letter"),
        (lambda: rsym.compile(SHAPE)(1.0, 2.0, letters={"a": float("nan")}), "number"),
        (lambda: rsym.compile(SHAPE)(np.zeros(2), np.zeros(3)), "array"),
    ],
)
def test_bad_input_is_refused(call, code):
    with pytest.raises(RsymError) as caught:
        call()
    assert caught.value.code == code


def test_a_kernel_shows_its_code():
    assert "def kernel(c0, c1, p0)" in rsym.compile(SHAPE, backend="numpy").source
    assert "define void @kernel" in rsym.compile(SHAPE, backend="llvm").source


def test_directions_of_a_plane_that_are_rounding_do_not_look_miscompiled():
    plane = z + x * sp.cos(x * y) ** 2 + x * sp.sin(x * y) ** 2
    found = rsym.compile(Shape(plane, (x, y, z)), ("principal_curvatures", "principal_directions"))(0.3, 0.4, 0.5)
    assert np.abs(found["principal_curvatures"]).max() < 1e-14
    assert_close(np.linalg.norm(found["principal_directions"], axis=-1), [1.0, 1.0], atol=1e-12)


@pytest.mark.parametrize("dtype", ["float64", "float32"])
def test_a_miscompiled_kernel_is_not_handed_out(monkeypatch, dtype):
    """Red proof of the check at 32 points."""
    wrong = replace(OPERATIONS["versine"], expansion=lambda b, node: b.const(0))
    monkeypatch.setitem(OPERATIONS, "versine", wrong)
    with pytest.raises(RsymError) as caught:
        rsym.compile(Shape(conjunction(x - 7, y - 9), (x, y)), ("gradient",), dtype=dtype)
    assert caught.value.code == "miscompiled"


def test_without_llvmlite_numpy_takes_over(monkeypatch):
    monkeypatch.setitem(sys.modules, "rsym.backends.llvm_code", None)
    assert rsym.compile(SHAPE).backend == "numpy"
    monkeypatch.setattr(kernel_module, "_CACHE", {})
    with pytest.raises(RsymError) as caught:
        rsym.compile(SHAPE, backend="llvm")
    assert caught.value.code == "missing-package"


def test_compiling_in_eight_threads_at_once():
    results = []

    def work(k):
        results.append(float(rsym.compile(Shape(x * (k + 11) + y**3, (x, y)))(1.0, 2.0)["value"]) - k)

    threads = [threading.Thread(target=work, args=(k,)) for k in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert results == [19.0] * 8


def test_blocks_cover_an_array_once():
    for shape, size in (((5, 7, 9), 10), ((100,), 7), ((3, 1000), 64), ((4, 4), 1)):
        count = np.zeros(shape, int)
        for block in blocks_of(shape, size):
            count[block] += 1
            assert count[block].size <= size
        assert (count == 1).all()


def test_outputs_may_lie_side_by_side():
    kernel = rsym.compile(SHAPE, ("gradient",))
    px, py = np.random.default_rng(3).uniform(-2, 2, (2, 7, 12000))
    out = np.full((7, 12000, 2), np.nan)
    run_in_blocks(kernel.function, [px, py], [2.0], np.moveaxis(out, -1, 0), 2)
    assert np.array_equal(out, kernel(px, py)["gradient"])


def test_functions_of_libm():
    shape = Shape(sp.sin(x) * sp.exp(y) + sp.atan2(y, x) + sp.log(x + 3) + (x + 3) ** y, (x, y))
    points = np.random.default_rng(1).uniform(-1, 1, (2, 101))
    u, v = points
    expected = np.sin(u) * np.exp(v) + np.arctan2(v, u) + np.log(u + 3) + (u + 3) ** v
    assert_close(rsym.compile(shape, backend="llvm")(u, v)["value"], expected, atol=1e-14)


def test_three_dimensions():
    shape = Shape(x**2 * y + z**3, (x, y, z))
    result = rsym.compile(shape, ("gradient", "hessian", "laplacian"))(2.0, 3.0, 4.0)
    assert result["gradient"].tolist() == [12, 4, 48]
    assert result["hessian"].tolist() == [[6, 4, 0], [4, 0, 0], [0, 0, 24]]
    assert result["laplacian"] == 30
