"""Coons patches of all classes against the surfaces that their edges come from."""

import numpy as np
import pytest
import sympy as sp
from oracles.closeness import assert_close
from oracles.tiers import of_the_day

import rsym
from rsym.surfaces.blends.blending import HermiteBlend
from rsym.surfaces.coons.bicubic import BicubicCoons
from rsym.surfaces.coons.coons_patches import CoonsPatch
from rsym.surfaces.functions.univariate import Formula
from rsym.surfaces.parametric import ParametricSurface
from rsym.surfaces.symbols import t, u, v
from rsym.surfaces.transfinite import _Separable

WAVY = sp.Matrix([u + sp.sin(v) / 3, v + u**2 * sp.cos(v), sp.exp(u * v) + sp.sin(3 * u)])
RNG = np.random.default_rng(1967)


def hermite_data(surface, size):
    """The corner information matrix of a surface over [0, 1]^2, by SymPy."""
    orders, ends = [k for k in range(size // 2) for _ in (0, 1)], [0, 1] * (size // 2)
    return [
        [list(surface.diff(u, k, v, m).subs({u: i, v: j})) for m, j in zip(orders, ends, strict=True)]
        for k, i in zip(orders, ends, strict=True)
    ]


@pytest.mark.slow
@pytest.mark.parametrize("order", of_the_day([1, 2, 3], 1))
def test_edges_and_derivatives_across_them_are_those_of_the_surface(order):
    point = CoonsPatch.of_surface(WAVY, order=order).expression()
    for k in range(order):
        for end in (0, 1):
            assert sp.simplify((point.diff(u, k) - WAVY.diff(u, k)).subs(u, end)) == sp.zeros(3, 1)
            assert sp.simplify((point.diff(v, k) - WAVY.diff(v, k)).subs(v, end)) == sp.zeros(3, 1)
    beyond = (point.diff(u, order) - WAVY.diff(u, order)).subs({u: 0, v: 0.37}).evalf()
    assert max(abs(entry) for entry in beyond) > 1e-5


def test_the_thesis_s_bicubic_patch_is_the_coons_patch_of_its_own_edges():
    """(2.4.1) in (2.2.7) gives (2.4.2)."""
    data = sp.Matrix(4, 4, sp.symbols("q:16", real=True))
    f = sp.Matrix(HermiteBlend.cubic().functions)
    point = (f.T.subs(t, u) * data * f.subs(t, v))[0]
    lifted = CoonsPatch.of_surface((point, 0, 0), order=2, letters={q: 1 for q in data}).expression()[0]
    assert sp.expand(lifted - point) == 0


def test_the_paraboloid_of_the_matlab_program():
    """Test1 of the first seed on its own grids; the four corners alone give the plane z = 50."""

    def surf(x, y):
        return [x, y, x**2 + y**2]

    matrix = np.zeros((4, 4, 3))
    for i, x in enumerate((-5, 5)):
        for j, y in enumerate((-5, 5)):
            matrix[i, j], matrix[i, 2 + j], matrix[2 + i, j] = surf(x, y), [0, 10, 20 * y], [10, 0, 20 * x]
    rows, columns = np.arange(0, 1.005, 0.01), np.arange(0, 1.01, 0.02)
    points = BicubicCoons(matrix).grid(rows, columns)
    assert points.shape == (101, 51, 3)
    x, y = np.meshgrid(-5 + 10 * rows, -5 + 10 * columns, indexing="ij")
    assert_close(points, np.stack([x, y, x**2 + y**2], axis=-1), atol=2e-13)
    plane = BicubicCoons(matrix[:2, :2].repeat(2, 0).repeat(2, 1) * 0 + _bilinear(matrix[:2, :2]))
    assert_close(plane.grid(rows, columns)[..., 2], np.full((101, 51), 50.0), atol=1e-12)


def _bilinear(corners):
    edge = np.array([[1.0, 0], [0, 1], [-1, 1], [-1, 1]])
    return np.einsum("ai,ijc,bj->abc", edge, corners, edge)


@pytest.mark.slow
def test_the_rank_one_formula_and_the_blockwise_one_agree_to_rounding():
    patch = CoonsPatch.of_surface(WAVY, order=3)
    places, orders = RNG.random((2, 500)), [(0, 0), (1, 0), (1, 2)]
    parts = _Separable(patch, orders, {}).evaluate(*places)
    for whole, part in zip(patch.derivatives(*places, orders), parts, strict=True):
        assert_close(part, whole, atol=1e-11)


@pytest.mark.slow
@pytest.mark.parametrize("callables", [False, True])
def test_values_do_not_depend_on_grid_block_or_neighbours(callables):
    edges = (lambda s: (0 * s, s, s**2), lambda s: (1 + 0 * s, s, s), lambda s: (s, 0 * s, 0 * s))
    edges = (
        (*edges, lambda s: (s, 1 + 0 * s, 1 + 0 * s)) if callables else ((0, t, t**2), (1, t, t), (t, 0, 0), (t, 1, 1))
    )
    patch = CoonsPatch(*edges, order=2)
    rows, columns = RNG.random(301), RNG.random(97)
    grid = patch.grid(rows, columns)
    alone = np.array([[patch(one, other) for other in columns[:3]] for one in rows[:5]])
    assert np.array_equal(grid[:5, :3], alone)
    assert np.array_equal(grid, patch(np.repeat(rows, 97), np.tile(columns, 301)).reshape(grid.shape))


@pytest.mark.slow
def test_functions_of_python_give_the_patch_of_their_formulas():
    symbolic = CoonsPatch(
        (0, t, sp.sin(t)), (1, t, sp.sin(t) * sp.exp(1)), (t, 0, 0), (t, 1, sp.sin(1) * sp.exp(t)), order=2
    )
    called = CoonsPatch(
        lambda s: (0, s, np.sin(s)),
        lambda s: np.stack([1 + 0 * s, s, np.sin(s) * np.e], axis=-1),
        lambda s: [s, 0.0, 0.0],
        lambda s: (s, 1, np.sin(1) * np.exp(s)),
        order=2,
    )
    places = RNG.random((2, 50))
    for order, tolerance in (((0, 0), 1e-13), ((1, 1), 1e-10), ((0, 2), 1e-9), ((2, 1), 1e-9)):
        assert_close(called.derivative(*places, order), symbolic.derivative(*places, order), atol=tolerance)
    with pytest.raises(rsym.RsymError, match="formula"):
        called.expression()


@pytest.mark.slow
def test_letters_move_edges_and_blends_without_another_kernel():
    h, mu = sp.symbols("h mu")
    patch = CoonsPatch(
        (0, t, sp.sin(3 * t) - t * sp.sin(3)), (1, t, h * t), (t, 0, sp.sin(sp.pi * t)), (t, 1, h * t), letters={h: 1}, order=2,  # noqa: E501
        blend_u=HermiteBlend.class2(mu, sp.pi / 2, letters={mu: 0}),
    )  # fmt: skip
    assert set(patch.letters) == {"h", "mu"}
    assert_close(patch(1.0, 0.5, letters={"h": 3})[2], 1.5, atol=1e-15)
    functions = patch._compiled._functions
    before = len(functions)
    moved = patch(0.2, 0.3, letters={"mu": 2.5})
    assert len(functions) == before
    assert np.abs(moved - patch(0.2, 0.3)).max() > 1e-4
    assert_close(patch(0.0, 0.3, letters={"mu": 2.5}), patch(0.0, 0.3), atol=1e-15)


def test_an_incompatible_ribbon_is_named_with_both_values():
    edges = ((0, t, 0), (1, t, 0), (t, 0, 0), (t, 1, 0))
    flat = {"u0": (1, 0, 0), "u1": (1, 0, 0), "v0": (0, 1, 0), "v1": (0, 1, 0)}
    CoonsPatch(*edges, order=2, ribbons=flat)
    with pytest.raises(rsym.RsymError, match=r"corner \(0, 1\).*across the edge u0 at v = 1.*\(1, 0, 2\).*\(1, 0, 0\)"):
        CoonsPatch(*edges, order=2, ribbons=flat | {"u0": (1, 0, 2 * t)})


@pytest.fixture(scope="module")
def disagreeing():
    edges = ((0, t, 0), (1, t, 0), (t, 0, 0), (t, 1, 0))
    bump = t * (1 - t)
    ribbons = {"u0": (1, 0, bump), "u1": (1, 0, -bump), "v0": (0, 1, 2 * bump), "v1": (0, 1, 0)}
    return edges, ribbons


def test_gregory_keeps_ribbons_on_whose_twists_the_edges_disagree(disagreeing):
    edges, ribbons = disagreeing
    s = np.linspace(0, 1, 41)
    kept = CoonsPatch(*edges, order=2, ribbons=ribbons, corners="gregory")
    mean = CoonsPatch(*edges, order=2, ribbons=ribbons)
    wanted = {"u0": s * (1 - s), "u1": -s * (1 - s), "v0": 2 * s * (1 - s), "v1": 0 * s}
    worst = 0.0
    for name, height in wanted.items():
        end = float(name[1])
        place, order = ((end, s), (1, 0)) if name[0] == "u" else ((s, end), (0, 1))
        assert_close(kept.derivative(*place, order)[:, 2], height, atol=1e-14)
        worst = max(worst, np.abs(mean.derivative(*place, order)[:, 2] - height).max())
    assert worst > 1e-2
    at = {u: sp.Rational(1, 3), v: sp.Rational(1, 5)}
    exact = np.array([float(entry) for entry in kept.expression().subs(at)])
    assert_close(kept(1 / 3, 1 / 5), exact, atol=1e-14)
    with pytest.raises(rsym.RsymError, match="disagree"):
        CoonsPatch(*edges, order=2, ribbons=ribbons, corners="refuse")


@pytest.mark.slow
def test_a_quintic_matrix_is_the_class_3_patch_of_its_own_edges():
    matrix = hermite_data(WAVY, 6)
    patch = BicubicCoons(matrix)
    lifted = CoonsPatch.of_surface(patch.expression(), order=3)
    places = RNG.random((2, 20))
    assert_close(lifted(*places), patch(*places), atol=1e-11)
    surface = ParametricSurface(WAVY)
    for order in ((0, 0), (2, 0), (1, 2), (2, 2)):
        assert_close(
            patch.derivative([0, 1, 0], [0, 0, 1], order), surface.derivative([0, 1, 0], [0, 0, 1], order), atol=1e-11
        )


@pytest.mark.parametrize(
    ("matrix", "message"),
    [
        (np.zeros((4, 3, 3)), "shape"),
        (np.full((4, 4, 3), np.nan), "not finite"),
        ([[[sp.Symbol("q")] * 3] * 4] * 4, "unknown symbol 'q'"),
    ],
)
def test_bad_matrices_are_refused(matrix, message):
    with pytest.raises(rsym.RsymError, match=message):
        BicubicCoons(matrix)


def test_parameters_outside_are_refused_and_rounding_is_not():
    patch = CoonsPatch((0, t, 0), (1, t, 0), (t, 0, 0), (t, 1, 0))
    assert_close(patch(1 + 1e-14, 0.5), [1.0, 0.5, 0.0], atol=1e-12)
    with pytest.raises(rsym.RsymError, match=r"u must lie in \[0, 1\], got 1.5"):
        patch([0.2, 1.5], 0.5)
    with pytest.raises(rsym.RsymError, match="broadcast"):
        patch(np.zeros(3), np.zeros(4))


def test_a_patch_is_written_as_in_the_textbook():
    matrix = np.zeros((4, 4, 3))
    matrix[1, :2, 0] = 1 / 3
    written = BicubicCoons(matrix, HermiteBlend.trigonometric(0))._repr_latex_()
    for part in (r"f(u)^T Q \, g(v)", "(0.33333, 0, 0)", r"F_{1}(t) &= ", r"\hat F_{1}(t) &= - 2 t^{3} + 3 t^{2}"):
        assert part in written
    edges = CoonsPatch((0, t, sp.sin(t)), (1, t, 0), (t, 0, 0), (t, 1, sp.sin(1) * (1 - t)))
    assert r"(0, v, \sin{\left(v \right)})" in edges._repr_latex_()
    assert CoonsPatch(lambda s: (0, s, 0), (1, t, 0), (t, 0, 0), (t, 1, 0))._repr_latex_() is None


def test_a_blend_of_a_higher_class_serves_a_lower_one():
    """Class 1 with a smoothstep: the edges are the same, the tangents across them vanish with its slope."""
    edges = ((0, t, t**2), (1, t, 0), (t, 0, 0), (t, 1, 1 - t))
    linear, smooth = CoonsPatch(*edges), CoonsPatch(*edges, blend_u=HermiteBlend.quintic())
    s = np.linspace(0, 1, 9)
    assert_close(smooth(0, s), linear(0, s), atol=1e-15)
    assert_close(smooth(0.25, s)[:, 2], (1 - 0.103515625) * s**2 + (0.75 - (1 - 0.103515625)) * s, atol=1e-14)
    with pytest.raises(rsym.RsymError, match="class 2 or higher in v, got one of class 1"):
        CoonsPatch(*edges, order=2, blend_v=HermiteBlend.linear())


def test_no_orders_are_no_derivatives():
    assert CoonsPatch((0, t, 0), (1, t, 0), (t, 0, 0), (t, 1, 0)).derivatives(0.5, 0.5, []) == []


def test_functions_have_values_of_any_shape():
    scalar = Formula(t**2)
    assert scalar(0.5) == 0.25
    assert scalar([0.5, 1.0]).tolist() == [0.25, 1.0]
    assert Formula([[t, 1], [0, t]])(2 / 4).tolist() == [[0.5, 1.0], [0.0, 0.5]]
