"""Leaves in parts by regions of their own: the bits of LLVM's code of the whole leaf."""

import pickle

import numpy as np
import pytest
import sympy as sp
from oracles.many_balls import many_balls
from oracles.undefined import without_value

import rsym
from rsym import x, y, z
from rsym.logic import leaf_parts
from rsym.logic.gates import Gate
from rsym.logic.leaf_parts import parted
from rsym.logic.sign_form import SignForm, surface_form
from rsym.program.builder import Builder
from rsym.sampling.kernels.mesher_kernels import MesherKernels, columns, padded
from rsym.sampling.mesher import SharpMesher
from rsym.sampling.meshing import MeshRequest
from rsym.sampling.regions.region_kernels import RegionKernels

COUNT = 700
r = sp.Symbol("r", real=True)


@pytest.fixture(autouse=True)
def few(monkeypatch):
    """Large from seven choices on: LLVM compiles fewer sooner."""
    monkeypatch.setattr(leaf_parts, "FEW", 6)


def blend():
    """Balls and a bump of their own minimum, cut in two by a second leaf; r is a letter."""
    shape, centres, radii = many_balls(10, 3, rsym.R1)
    body = shape.expression
    bumpy = body + r / (1 + 9 * body**2 + x**2 / 4)
    whole = rsym.Shape(rsym.conjunction(bumpy, z + 1), (x, y, z), letters={r: 0.02}, bounds=shape.bounds)
    return whole, centres, radii


def both(shape):
    form = surface_form(shape).capped()
    made = MesherKernels(form), RegionKernels(form, shared=True)
    for kernels in made:
        kernels.set(shape.letters.values_with(None), shape.bounds)
    assert made[1].in_parts
    return made


def points_of(generator=1):
    return columns(np.random.default_rng(generator).uniform(-1.5, 1.5, (3, COUNT)))


def asked(kernels):
    points, leaf = points_of(), np.full(padded(COUNT), -1, np.int16)
    leaf[:COUNT] = np.arange(COUNT) % 3 - 1
    value, gradient = np.full(padded(COUNT), -7.0), np.full(points.shape, -7.0)
    kernels.leaf(COUNT, leaf, points, value, gradient)
    slid = points.copy()
    kernels.slide(COUNT, leaf, slid, 3)
    form, active = np.empty(padded(COUNT)), np.empty(padded(COUNT), np.int16)
    kernels.value(COUNT, points, form, active)
    some = leaf[:COUNT] >= 0
    return value[:COUNT][some], gradient[:, :COUNT][:, some], slid[:, :COUNT][:, some], form[:COUNT], active[:COUNT]


def test_values_gradients_and_slides_have_the_bits_of_llvm():
    for expected, found in zip(*map(asked, both(blend()[0])), strict=True):
        np.testing.assert_array_equal(found, expected)


def test_values_against_the_formula_by_hand():
    shape, centres, radii = blend()
    _, kernels = both(shape)
    points = points_of(2)
    form, active = np.empty(padded(COUNT)), np.empty(padded(COUNT), np.int16)
    kernels.value(COUNT, points, form, active)
    own = points[:, :COUNT]
    body = (radii**2 - ((own.T[:, None] - centres) ** 2).sum(axis=2)).max(axis=1)
    bumpy = body + 0.02 / (1 + 9 * body**2 + own[0] ** 2 / 4)
    inside = (np.abs(own) <= 1.2).all(axis=0)
    np.testing.assert_array_equal(form[:COUNT] > 0, (bumpy > 0) & (own[2] > -1) & inside)
    assert 8 < (form[:COUNT] > 0).sum() < 400


def test_meshes_have_the_bits_of_llvm_also_with_other_letters():
    shape, _, _ = blend()
    meshers = [SharpMesher(shape, backend) for backend in ("llvm", "tape")]
    assert meshers[1]._kernels.in_parts
    for value in (0.02, 0.05):
        mesh, same = (mesher(MeshRequest(40, letters={"r": value})) for mesher in meshers)
        assert len(mesh.faces) > 1000
        np.testing.assert_array_equal(mesh.vertices, same.vertices)
        np.testing.assert_array_equal(mesh.faces, same.faces)
        np.testing.assert_array_equal(mesh.leaf, same.leaf)
        assert str(mesh.status) == str(same.status)


@pytest.mark.parametrize("hidden", ["a gate", "a part"])
def test_what_is_undefined_inside_a_leaf_is_so_in_its_parts(hidden):
    shape, _, _ = many_balls(10, 3, rsym.R1)
    body = shape.expression
    half = sp.Rational(1, 2)
    # NaN for x < 1/2, below all balls elsewhere; no form knows where.
    root = sp.Max(body, without_value(half - x) - 3)
    # By the bounds of what is defined the other operand is always the smaller one.
    least = sp.Min(root + 9, body) if hidden == "a gate" else sp.Min(sp.exp(-(root**2)), body - 2)
    leaf = rsym.Shape(sp.exp(least) - 1 + least / 7, (x, y, z), bounds=shape.bounds)
    llvm, tape = map(asked, both(leaf))
    for expected, found in zip(llvm, tape, strict=True):
        np.testing.assert_array_equal(found, expected)
    assert 100 < np.isnan(tape[3]).sum() < 600


def test_workers_and_copies_evaluate_the_same():
    _, kernels = both(blend()[0])
    for twin in (kernels.copy(), pickle.loads(pickle.dumps(kernels))):
        for expected, found in zip(asked(kernels), asked(twin), strict=True):
            np.testing.assert_array_equal(found, expected)


def at_random(builder, generator, depth):
    """A node of choices and arithmetic, in places undefined or infinite."""
    if depth <= 0:
        names = [builder.input(name) for name in ("x", "y", "z", "r")]
        first, second = generator.choice(names, 2).tolist()
        return (first, builder.mul(first, second), builder.add(first, builder.const(-1)))[generator.integers(3)]
    a, b = (at_random(builder, generator, depth - int(generator.integers(1, 3))) for _ in "ab")
    kind = generator.choice(
        ["min", "max", "min", "max", "add", "mul", "r0_conjunction", "sqrt", "div", "log", "select"]
    )
    match str(kind):
        case "sqrt":
            return builder.sqrt(builder.add(a, builder.abs(b)))
        case "log":
            return builder.make("log", builder.neg(a))
        case "div":
            return builder.div(a, b)
        case "select":
            return builder.select(a, b, a, b)
    return builder.make(str(kind), a, b)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(4))
def test_forms_at_random_have_the_bits_of_whole_leaves(seed, monkeypatch):
    generator, tried = np.random.default_rng(seed), 0
    while tried < 10:
        builder = Builder(("x", "y", "z"), ("r",))
        leaves = [
            builder.add(builder.mul(builder.const(3), builder.input("x")), at_random(builder, generator, 6))
            for _ in "ab"
        ]
        form = SignForm(builder, tuple(leaves), (Gate("min", 0, 1),))
        monkeypatch.setattr(leaf_parts, "FEW", 1)
        if leaves[0] == leaves[1] or parted(form) is None:
            continue
        tried += 1
        found = []
        for few in (64, 1):  # whole, and in parts
            monkeypatch.setattr(leaf_parts, "FEW", few)
            kernels = RegionKernels(form, shared=True)
            assert kernels.in_parts == (few == 1)
            kernels.set({"r": 0.3}, ((-1.2, 1.2),) * 3)
            found.append(asked(kernels))
        for name, expected, same in zip(("value", "gradient", "slid", "form", "active"), *found, strict=True):
            known = ~np.isnan(found[0][3]) if name == "active" else slice(None)  # of what is undefined none is active
            np.testing.assert_array_equal(same[..., known], expected[..., known], err_msg=f"{name}, form {tried}")
