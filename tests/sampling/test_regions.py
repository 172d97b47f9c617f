"""Regions: the same bits as what LLVM compiles, and balls against formulas that share nothing with either."""

import itertools
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
import sympy as sp

import rsym
from rsym import x, y, z
from rsym.logic.sign_form import SignForm, surface_form
from rsym.program.builder import Builder
from rsym.sampling.kernels.mesher_kernels import SMALL, backend_for, columns, mesher_kernels, padded
from rsym.sampling.kernels.routines import LANES
from rsym.sampling.mesh import MeshRequest
from rsym.sampling.mesher import SharpMesher
from rsym.sampling.regions import kept_regions
from rsym.sampling.regions.kept_regions import MOST
from rsym.sampling.regions.leaf_tapes import LeafTapes
from rsym.sampling.regions.point_groups import by_number
from rsym.sampling.regions.region_kernels import RegionKernels, region_kernels
from rsym.sampling.regions.regions import INFINITE, MAX, MIN, MINUS_INFINITE, Regions, whole_form, without_idle

SLOW = ["streamlined", "gyroid", "bracket", "spring", "solids", "vase", "lattice", "jack"]
MODELS = ["car", "skeleton", "valve", "gear", *(pytest.param(model, marks=pytest.mark.slow) for model in SLOW)]


def balls(side, seed=7):
    """Disjoint balls in a grid: the shape, their centres and radii."""
    generator = np.random.default_rng(seed)
    centres = np.stack(np.meshgrid(*[(np.arange(side) + 0.5) / side * 2 - 1] * 3, indexing="ij")).reshape(3, -1).T
    centres = np.round(centres + generator.uniform(-0.1, 0.1, centres.shape) / side, 6)
    radii = np.round(generator.uniform(0.5, 0.8, len(centres)) / side, 6)
    parts = [
        rsym.Shape(r**2 - (x - a) ** 2 - (y - b) ** 2 - (z - c) ** 2, (x, y, z))
        for (a, b, c), r in zip(centres.tolist(), radii.tolist(), strict=True)
    ]
    whole = rsym.disjunction(*parts)
    return rsym.Shape(whole.expression, (x, y, z), bounds=((-1.2, 1.2),) * 3), centres, radii


def in_space(model):
    shape = rsym.load(model)
    return shape if shape.dimension == 3 else rsym.revolve(shape)


@pytest.mark.parametrize("model", MODELS)
def test_meshes_have_the_bits_of_llvm(model):
    shape = in_space(model)
    mesh, same = (SharpMesher(shape, backend)(MeshRequest(32)) for backend in ("llvm", "tape"))
    np.testing.assert_array_equal(mesh.vertices, same.vertices)
    np.testing.assert_array_equal(mesh.faces, same.faces)
    np.testing.assert_array_equal(mesh.leaf, same.leaf)
    np.testing.assert_array_equal(mesh.normals, same.normals)
    assert str(mesh.status) == str(same.status)
    assert mesh.status.remarks == same.status.remarks


def test_many_balls_are_few_kinds_and_have_the_bits_of_llvm():
    shape, _, radii = balls(4)
    form = surface_form(shape).capped()
    assert len(form.gates) > SMALL
    assert backend_for(form) == "tape"
    assert len(LeafTapes(form, shared=True).kinds) <= 12
    mesh, same = (SharpMesher(shape, backend)(MeshRequest(64)) for backend in ("llvm", "tape"))
    np.testing.assert_array_equal(mesh.vertices, same.vertices)
    np.testing.assert_array_equal(mesh.faces, same.faces)
    assert mesh.status.closed
    assert mesh.status.volume == pytest.approx(4 / 3 * np.pi * (radii**3).sum(), rel=0.02)


def test_value_and_active_leaf_of_balls_against_their_formula():
    shape, centres, radii = balls(5)
    kernels = region_kernels(surface_form(shape))
    kernels.set({}, shape.bounds)
    generator = np.random.default_rng(1)
    points = columns(generator.uniform(-1.2, 1.2, (3, 1000)))
    value, leaf = np.empty(padded(1000)), np.empty(padded(1000), np.int16)
    kernels.value(1000, points, value, leaf)
    every = radii[:, None] ** 2 - ((points[:, None, :1000] - centres.T[:, :, None]) ** 2).sum(axis=0)
    scales = np.asarray(kernels._given[1])[:, None]
    assert len(kernels.form.leaves) == len(radii)
    # Leaves come in an order of SymPy's: each ball is known by its value.
    np.testing.assert_array_equal(value[:1000] > 0, every.max(axis=0) > 0)
    gradient = np.empty((3, padded(1000)))
    again = np.empty(padded(1000))
    kernels.leaf(1000, leaf, points, again, gradient)
    np.testing.assert_array_equal(again[:1000], value[:1000])
    unscaled = again[:1000] / scales[leaf[:1000], 0]
    distance = np.abs(every - unscaled).min(axis=0)
    assert distance.max() < 1e-12


def of_whole(kernels, points):
    """Value and leaf where everything is evaluated, point by point in vectors of their own."""
    count = points.shape[1]
    begin = np.arange(count + 1) * LANES
    found, names = kernels.within(np.repeat(points, LANES, axis=1), kernels._whole[np.zeros(count, int)], begin)
    return found[::LANES], names[::LANES]


@pytest.mark.parametrize("most", [0, 2000, MOST])
def test_kept_regions_have_the_bits_of_the_whole(most, monkeypatch):
    """Questions large and small, from threads at once, on the faces of boxes, outside of all, and nowhere."""
    monkeypatch.setattr(kept_regions, "MOST", most)
    shape = balls(5)[0]
    kernels = RegionKernels(surface_form(shape), shared=True)
    kernels.set({}, shape.bounds)
    generator = np.random.default_rng(3)
    points = generator.uniform(-1.2, 1.2, (3, 600))
    points[:, :100] = generator.choice(np.linspace(-2.4, 2.4, 33), (3, 100))  # outside, and where boxes meet
    points[:, 100:110] = generator.uniform(2.5, 1e9, (3, 10))
    points[0, 110:120], points[1, 120:130], points[2, 130:140] = np.nan, np.inf, -np.inf
    points[:, 140:200] = points[:, [200]] + generator.uniform(-1e-3, 1e-3, (3, 60))
    places = columns(points)
    value, leaf = np.empty(padded(600)), np.empty(padded(600), np.int16)
    cuts = np.unique([0, 600, *generator.integers(0, 600, 40)]).tolist()

    def part(ends):
        kernels.copy().value(ends[1] - ends[0], places, value, leaf, first=ends[0])

    with ThreadPoolExecutor(4) as pool:
        list(pool.map(part, list(itertools.pairwise(cuts))))
    expected, names = of_whole(kernels, points)
    np.testing.assert_array_equal(value[:600], expected)
    np.testing.assert_array_equal(leaf[:600], names)
    numbers, regions = kernels._kept.at(points)
    entries = np.diff(regions.start)[numbers]
    assert (entries[100:140] == len(kernels._whole.entries)).all()
    assert (entries[140:].max() <= 2 * kept_regions.FEW) if most == MOST else most or not numbers.any()


def test_kept_regions_are_those_of_the_letters():
    """One set of kernels for two letters: what is kept for one never answers for the other."""
    a = sp.Symbol("a", real=True)
    parts = [rsym.Shape(a**2 - (x - k) ** 2 - y**2 - z**2, (x, y, z), letters={a: 0.5}) for k in range(12)]
    kernels = RegionKernels(surface_form(rsym.disjunction(*parts)), shared=True)
    points = columns(np.random.default_rng(5).uniform(-1, 1, (3, 50)) * [[6], [1], [1]] + [[5.5], [0], [0]])
    for one in (0.5, 1.5, 0.5):
        kernels.set({"a": one}, ((-1, 12), (-1, 1), (-1, 1)))
        value, leaf = np.empty(padded(50)), np.empty(padded(50), np.int16)
        kernels.value(50, points, value, leaf)
        every = one**2 - (points[0] - np.arange(12)[:, None]) ** 2 - points[1] ** 2 - points[2] ** 2
        np.testing.assert_array_equal(value[:50] > 0, every.max(axis=0)[:50] > 0)


def test_regions_of_words_leave_out_what_is_idle():
    """min(a, max(b, c)): operands of both gates left out in all ways, by hand."""
    form = surface_form(rsym.Shape(rsym.conjunction(x, rsym.disjunction(y, z)), (x, y, z)))
    whole = whole_form(form)
    numbers = {what: k for k, what in enumerate(whole.entries[:, 0].tolist())}
    inner, outer = numbers[MAX] - 3, numbers[MIN] - 3
    words = np.zeros((4, 1), np.uint64)
    first = form.gates[outer].first
    leaf_side, gate_side = (0, 1) if first < 3 else (1, 0)
    words[1] = 1 << (2 * outer + gate_side)  # the leaf alone
    words[2] = 1 << (2 * outer + leaf_side) | 1 << (2 * inner)  # one of the inner leaves
    words[3] = 3 << (2 * inner) | 1 << (2 * outer + leaf_side)  # nothing
    regions = without_idle(whole, words)
    assert np.diff(regions.start).tolist() == [5, 1, 1, 1]
    assert regions[0:1].entries[-1, 0] == MIN
    assert regions[1:2].entries[0, 0] == min(form.gates[outer][1:])
    assert regions[2:3].entries[0, 0] == form.gates[inner].second
    assert regions[3:4].entries[0, 0] == MINUS_INFINITE
    assert INFINITE not in regions.entries[:, 0]


def test_regions_are_chosen_like_rows():
    regions = Regions(np.array([0, 1, 3, 3]), np.arange(9, dtype=np.int32).reshape(3, 3))
    chosen = regions[np.array([1, 0])]
    assert chosen.start.tolist() == [0, 2, 3]
    assert chosen.entries.tolist() == [[3, 4, 5], [6, 7, 8], [0, 1, 2]]
    assert len(regions[regions.start[1:] > 1]) == 2


def test_letters_move_and_meshers_are_pickled():
    import pickle

    shape = in_space("valve")
    kernels = region_kernels(surface_form(shape).capped())
    kernels.set(shape.letters.values_with(None), shape.bounds)
    again = pickle.loads(pickle.dumps(kernels))
    assert isinstance(again, RegionKernels)
    points = columns(np.random.default_rng(2).uniform(-1, 1, (3, 100)))
    found = []
    for one in (kernels, again):
        value, leaf = np.empty(padded(100)), np.empty(padded(100), np.int16)
        one.value(100, points, value, leaf)
        found.append((value[:100], leaf[:100]))
    np.testing.assert_array_equal(found[0][0], found[1][0])
    np.testing.assert_array_equal(found[0][1], found[1][1])


def test_bounds_of_leaves_are_those_of_llvm():
    shape = in_space("gear")
    form = surface_form(shape).capped()
    tapes, llvm = region_kernels(form), mesher_kernels(form)
    generator = np.random.default_rng(4)
    lower = generator.uniform(-1, 1, (3, 200))
    upper = lower + generator.uniform(0, 0.3, (3, 200))
    leaf = np.zeros(padded(200), np.int16)
    leaf[:200] = generator.integers(0, len(form.leaves), 200)
    found = []
    for kernels in (tapes, llvm):
        kernels.set(shape.letters.values_with(None), shape.bounds)
        bounds = np.empty((8, padded(200)))
        kernels.enclose(200, leaf, columns(lower), columns(upper), bounds)
        found.append(bounds[:, :200])
    np.testing.assert_array_equal(*found)


def test_more_leaves_than_have_numbers_are_refused(monkeypatch):
    monkeypatch.setattr("rsym.sampling.regions.region_kernels.MOST_LEAVES", 3)
    with pytest.raises(rsym.RsymError, match="at most 3 leaves apart, the shape has 7"):
        rsym.Mesher(rsym.Shape(1 - x**2 - y**2 - z**4 / 7, (x, y, z)), backend="tape")


def test_an_unknown_backend_is_refused():
    ball = rsym.Shape(1 - x**2 - y**2 - z**2, (x, y, z))
    with pytest.raises(rsym.RsymError, match="no backend 'cuda'"):
        rsym.Mesher(ball, backend="cuda")


def test_a_sum_that_stands_in_both_orders_is_one_node():
    b = Builder(("x", "y", "z"), ())
    u, v = b.input("x"), b.input("y")
    leaf = b.add(b.make("exp", b.make("add", u, v)), b.mul(b.make("sin", b.make("add", v, u)), b.input("z")))
    kernels = RegionKernels(SignForm(b, (leaf,), ()), shared=True)
    kernels.set({}, ((-1.0, 1.0),) * 3)
    points = columns(np.random.default_rng(4).uniform(-1, 1, (3, 50)))
    value, active = np.empty(padded(50)), np.empty(padded(50), np.int16)
    kernels.value(50, points, value, active)
    x_, y_, z_ = points[:, :50]
    np.testing.assert_allclose(value[:50] / kernels._given[1][0], np.exp(x_ + y_) + np.sin(x_ + y_) * z_, rtol=1e-13)


@pytest.mark.parametrize("most", [3, 2**15, 2**20])
def test_points_are_grouped_by_numbers_of_any_size(most):
    numbers = np.random.default_rng(1).integers(-1, most, 3000)
    which, begin, padded_places, places, order = by_number(numbers)
    expected = [(n, k) for n, k in sorted(zip(numbers.tolist(), range(3000), strict=True)) if n >= 0]
    assert [(n, k) for n, k in zip(numbers[order].tolist(), order.tolist(), strict=True)] == expected
    assert which.tolist() == sorted({n for n, _ in expected})
    assert (padded_places[places] == order).all()
    assert (numbers[padded_places] == np.repeat(which, np.diff(begin))).all()
