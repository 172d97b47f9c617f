"""One contract, several kinds of patches: what holds for each of them."""

import functools
import itertools
import pickle

import numpy as np
import pytest
import sympy as sp
from oracles.closeness import assert_close

import rsym
from rsym.surfaces import (
    BicubicCoons,
    BSplineSurface,
    Called,
    CompositeCoons,
    CoonsPatch,
    Formula,
    GordonSurface,
    HermiteBlend,
    HermiteSurface,
    LagrangeSurface,
    ParametricSurface,
    SplineLoft,
    TensorProductSurface,
    TransitionSurface,
    join,
    mesh_patches,
    sphere_octant,
    torus_quarter,
)
from rsym.surfaces.projections import ProjectionOperator
from rsym.surfaces.symbols import t, u, v

a = sp.Symbol("a", real=True)
RANDOM = np.random.default_rng(17)
HILLS = [(t, k, sp.sin(t + k) / 2) for k in range(5)]
CROSSING = [(x, 3 * t, sp.sin(x + 3 * t) / 2) for x in (0, sp.Rational(1, 2), 1)]
POINTS = np.array([[(i, j + i * i / 9, np.sin(i * j)) for j in range(5)] for i in range(6)])
SQUARE = ((0, t, sp.sin(t)), (1, t, sp.sin(t)), (t, 0, t * (1 - t)), (t, 1, t * (t - 1) + sp.sin(1)))
TURN = 2 * np.pi * np.arange(7)[:, None] / 7
TUBE = np.stack(np.broadcast_arrays(np.cos(TURN), np.sin(TURN) * [1, 2, 3, 2, 1], np.arange(5)), axis=-1)
MATRIX = RANDOM.normal(size=(4, 4, 3))


def called(s):
    return np.stack([s, 0 * s + 2, np.exp(s) - 1], axis=-1)


def called_slowly(s):
    return np.stack([0 * s, s / 3, np.sin(s / 3)], axis=-1)


def called_one_by_one(s):
    return (1.0, s, (np.e - 1) * s) if 0 <= s <= 1 else (np.nan,) * 3


BICUBIC = BicubicCoons(MATRIX, HermiteBlend.class2(1, sp.pi / 2), HermiteBlend.cubic())
FLAT = [(0, t, 0), called_one_by_one, [(0, 0, 0), (0.4, 0, 0), (1, 0, 0)], (t, 1, t * (sp.E - 1))]
TRIANGLE = ProjectionOperator([rsym.y, rsym.x, rsym.x + rsym.y - 1], [(0, 0), (1, 0), (0, 1)])
CIRCLE = [(sp.cos(angle) * (2 + t), sp.sin(angle) * (2 + t), t**2) for angle in (0, 2, 4)]
OTHER = BicubicCoons(RANDOM.normal(size=(4, 4, 3)), blend_v=HermiteBlend.cubic())
SIDES = ParametricSurface((u, v, u * v)), ParametricSurface((u + 2, v, 1))
MADE = {
    "formula": lambda: ParametricSurface((u, v, a * sp.sin(u * v)), ((-1, 2), (0, 1)), letters={a: 2}),
    "torus": lambda: ParametricSurface(
        (sp.cos(u) * (2 + sp.cos(v)), sp.sin(u) * (2 + sp.cos(v)), sp.sin(v)),
        ((0, 2 * sp.pi), (-sp.pi, sp.pi)),
        closed=(True, True),
    ),
    "Coons, class 1": lambda: CoonsPatch(*SQUARE),
    "Coons, class 2": lambda: CoonsPatch(*SQUARE, order=2),
    "Coons, a slow function": lambda: CoonsPatch(Called(called_slowly, domain=(0, 3)), *SQUARE[1:], order=2),
    "Coons, class 3": lambda: CoonsPatch.of_surface((u, v, sp.exp(u * v)), order=3),
    "Coons, a function and points": lambda: CoonsPatch(*FLAT),
    "Hermite, a function": lambda: HermiteSurface([(t, 0, 0), (t, 1, t), called]),
    "bicubic": lambda: BICUBIC,
    "Hermite": lambda: HermiteSurface(HILLS, knots=[0, 1, 1.5, 3, 4]),
    "Hermite, closed": lambda: HermiteSurface(CIRCLE, closed=True),
    "spline loft": lambda: SplineLoft(HILLS),
    "Lagrange": lambda: LagrangeSurface(HILLS),
    "B-spline": lambda: BSplineSurface.interpolate(POINTS),
    "B-spline, closed": lambda: BSplineSurface(TUBE, order=(4, 3), closed=(True, False)),
    "joined matrices": lambda: join(BICUBIC, "u1", OTHER, "u0", 2, tolerance=10),
    "joined": lambda: join(BICUBIC, "u1", ParametricSurface((u, v, u * v)), "u0", tolerance=10),
    "Gordon": lambda: GordonSurface(HILLS[:4], CROSSING),
    "Gordon, reparametrised": lambda: GordonSurface(
        [((t**2 + t) / 2, 0, sp.sin((t**2 + t) / 2) / 2), *HILLS[1:4]], CROSSING
    ),
    "composite": lambda: CompositeCoons(HILLS[:4], CROSSING),
    "points": lambda: TensorProductSurface(POINTS),
    "points, closed": lambda: TensorProductSurface(TUBE, closed=(True, False)),
    "transition": lambda: TransitionSurface(BICUBIC, (t, 1 - t / 2), ParametricSurface((u + 9, v, u * v)), "u0"),
    "transition, class 3": lambda: TransitionSurface(SIDES[0], "u1", SIDES[1], "u0", order=3),
    "octant": lambda: sphere_octant(2, blend_u=HermiteBlend.class2(a, sp.pi / 2, letters={a: 1})),
    "quarter of a torus": lambda: torus_quarter(3, 1),
    "graph": lambda: TRIANGLE(sp.exp(rsym.x + 2 * rsym.y)).graph(((0, 1), (0, 1))),
}
ORDERS = [(0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2)]


@functools.cache
def made(name):
    """Each patch once, where it is asked for."""
    return MADE[name]()


@pytest.fixture(params=MADE)
def patch(request):
    return made(request.param)


def places(patch, count=9):
    """Scattered parameters, away from the ends and from knots at eighths."""
    generator = np.random.default_rng(5)
    shares = (generator.integers(0, 8, (2, count)) + generator.uniform(0.03, 0.97, (2, count))) / 8
    return [low + (high - low) * one for one, (low, high) in zip(shares, patch.domain, strict=True)]


@pytest.mark.random
def test_shapes(patch):
    (u0, u1), (v0, v1) = patch.domain
    assert patch(u0, v1).shape == (3,)
    rows, columns = np.linspace(u0, u1, 4), np.linspace(v0, v1, 5)
    grid = patch.grid(rows, columns)
    assert grid.shape == (4, 5, 3)
    assert grid.dtype == np.float64
    assert np.array_equal(grid, patch(rows[:, None], columns))
    assert patch([], v0).shape == (0, 3)
    assert patch.grid([], columns).shape == (0, 5, 3)
    assert patch.normal(rows, v1).shape == (4, 3)
    assert patch.second_fundamental_form(rows[:, None], columns).shape == (4, 5, 2, 2)
    assert patch.principal_curvatures(rows, v1).shape == (4, 2)


@pytest.mark.random
def test_a_point_is_the_same_alone_and_among_many(patch):
    """To the last bit; but SciPy's B-splines go another way for scattered points than for one or for a grid."""
    at_u, at_v = places(patch, 4000)
    rounding = 1e-14 if isinstance(patch, BSplineSurface) else 1e-300
    for order in ((0, 0), (1, 1)):
        many = patch.derivative(at_u, at_v, order)
        assert_close(patch.derivative(at_u[7], at_v[7], order), many[7], atol=rounding * np.abs(many).max())
        assert np.array_equal(patch.derivative(at_u[3000:], at_v[3000:], order), many[3000:])


@pytest.mark.random
def test_derivatives_are_those_of_the_points(patch):
    """Central differences of the order below, Richardson's extrapolation of two steps: error h**4."""
    at = places(patch)
    steps = [(high - low) * 1e-3 for low, high in patch.domain]
    every = dict(zip(ORDERS, patch.derivatives(*at, ORDERS), strict=True))
    for order, axis in itertools.product(ORDERS[:3], (0, 1)):
        higher = tuple(k + (index == axis) for index, k in enumerate(order))

        def difference(share, order=order, axis=axis):
            step = np.array([share * steps[axis] if index == axis else 0.0 for index in (0, 1)])
            forth, back = (patch.derivative(at[0] + s * step[0], at[1] + s * step[1], order) for s in (1, -1))
            return (forth - back) / (2 * step[axis])

        size = 1 + np.abs(every[higher]).max()
        assert_close((4 * difference(0.5) - difference(1.0)) / 3, every[higher], atol=2e-6 * size)


@pytest.mark.random
def test_the_formula_is_the_surface(patch):
    try:
        formula = patch.expression()
    except rsym.RsymError as error:
        assert error.code == "no-formula"  # noqa: PT017
        return
    at_u, at_v = places(patch)
    letters = [sp.Symbol(name, real=True) for name in patch.letters]
    function = sp.lambdify((u, v, *letters), list(formula), "numpy")
    values = [float(letter.default) for letter in patch.letters.values()]
    expected = np.stack([one + 0 * at_u for one in function(at_u, at_v, *values)], axis=-1)
    assert_close(patch(at_u, at_v), expected, atol=1e-12 * (1 + np.abs(expected).max()))
    printed = patch._repr_latex_()
    assert printed.startswith(r"$\displaystyle ")
    assert printed.count("{") == printed.count("}")


@pytest.mark.random
def test_normals_and_curvatures_follow_from_the_derivatives(patch):
    at = places(patch)
    p_u, p_v, p_uu, p_uv, p_vv = patch.derivatives(*at, ORDERS[1:])
    cross = np.cross(p_u, p_v)
    n = cross / np.linalg.norm(cross, axis=-1, keepdims=True)
    assert_close(patch.normal(*at), n, atol=1e-12)
    E, F, G = ((p * q).sum(-1) for p, q in ((p_u, p_u), (p_u, p_v), (p_v, p_v)))
    L, M, N = ((n * p).sum(-1) for p in (p_uu, p_uv, p_vv))
    gaussian = np.linalg.det(np.moveaxis(np.array([[L, M], [M, N]]), -1, 0)) / (E * G - F**2)
    shape = np.linalg.solve(
        np.moveaxis(np.array([[E, F], [F, G]]), -1, 0), np.moveaxis(np.array([[L, M], [M, N]]), -1, 0)
    )
    size = 1 + np.abs(shape).max()
    assert_close(patch.gaussian_curvature(*at), gaussian, atol=1e-10 * size**2)
    assert_close(patch.mean_curvature(*at), np.trace(shape, axis1=-2, axis2=-1) / 2, atol=1e-10 * size)


@pytest.mark.random
@pytest.mark.parametrize("axis", [0, 1])
def test_closed_directions_close_and_repeat_and_others_end(patch, axis):
    low, high = patch.domain[axis]
    middle = np.mean(patch.domain[1 - axis])

    def at(place, order=(0, 0)):
        return patch.derivative(*((place, middle) if axis == 0 else (middle, place)), order)

    if patch.closed[axis]:
        along = (1 - axis, axis)
        assert_close(at(low), at(high), atol=1e-12)
        assert_close(at(low, along), at(high, along), atol=1e-9)
        for turns in (-2, 1, 3):
            assert_close(at(low + 0.25 + turns * (high - low)), at(low + 0.25), atol=1e-12)
    else:
        with pytest.raises(rsym.RsymError, match=rf"{'uv'[axis]} must lie in \[.*remedy: the ends are patch.domain"):
            at(high + 0.1)
        with pytest.raises(rsym.RsymError, match="must lie in"):
            at(low - 0.1)


@pytest.mark.random
def test_nothing_that_is_given_changes_and_nan_stays(patch):
    at_u, at_v = places(patch)
    before = at_u.copy(), at_v.copy()
    patch.gaussian_curvature(at_u, at_v)
    assert np.array_equal(at_u, before[0])
    assert np.array_equal(at_v, before[1])
    at_u[3] = np.nan
    found = patch(at_u, at_v)
    assert np.isnan(found[3]).any()
    assert np.isfinite(np.delete(found, 3, axis=0)).all()


@pytest.mark.random
def test_orders_that_are_refused(patch):
    for order in (3, (1,), (1, -1), (0.5, 1), (True, 0), "uv"):
        with pytest.raises(rsym.RsymError, match="an order is a pair of integers >= 0"):
            patch.derivative(patch.domain[0][0], patch.domain[1][0], order)


@pytest.mark.random
def test_orders_may_be_integers_of_numpy(patch):
    at = places(patch)
    order = tuple(np.array([1, 0]))
    assert np.array_equal(patch.derivative(*at, order), patch.derivative(*at, (1, 0)))


@pytest.mark.random
def test_unknown_letters_are_refused(patch):
    with pytest.raises(rsym.RsymError, match="no letter 'nobody'"):
        patch(patch.domain[0][0], patch.domain[1][0], letters={"nobody": 1})


@pytest.mark.random
def test_the_mesh_lies_on_the_surface(patch):
    mesh = patch.mesh((7, 5))
    grid = patch.grid(
        *(np.linspace(*interval, cells + 1) for interval, cells in zip(patch.domain, (7, 5), strict=True))
    )
    gaps = np.linalg.norm(mesh.vertices[:, None] - grid.reshape(1, -1, 3), axis=-1).min(axis=1)
    assert_close(gaps, 0 * gaps, atol=1e-8)
    assert np.isfinite(mesh.normals).all()
    middle = mesh.vertices[mesh.faces]
    flat = np.cross(middle[:, 1] - middle[:, 0], middle[:, 2] - middle[:, 0])
    assert ((flat * mesh.normals.mean(axis=1)).sum(-1) > 0).mean() > 0.9


@pytest.mark.parametrize("interval", [(0, 0), (1, 0), (0, np.inf), (0, "1"), 1, (0, 1, 2)])
def test_intervals_that_are_refused(interval):
    for make_it in (
        lambda: ParametricSurface((u, v, u * v), ((0, 1), interval)),
        lambda: Formula((t, t, t), domain=interval),
        lambda: Called(called, domain=interval),
    ):
        with pytest.raises(rsym.RsymError, match=r"interval .*\(low, high\) of finite numbers, got"):
            make_it()


def test_a_domain_that_is_no_pair_is_refused():
    with pytest.raises(rsym.RsymError, match=r"the intervals of u and v, got \(0, 1, 2\); remedy: "):
        ParametricSurface((u, v, u * v), (0, 1, 2))


@pytest.mark.random
def test_a_patch_says_what_it_is(patch):
    said = repr(patch)
    assert said.startswith(type(patch).__name__ + "(u in [")
    assert "closed in u" in said or not patch.closed[0]
    assert all(f"{name} = {letter.default}" in said for name, letter in patch.letters.items())


@pytest.mark.random
def test_a_patch_can_be_sent_elsewhere(patch):
    at = places(patch)
    here = patch(*at)
    copy = pickle.loads(pickle.dumps(patch))
    assert np.array_equal(copy(*at), here)
    assert np.array_equal(copy.normal(*at), patch.normal(*at))


def test_letters_of_several_patches():
    one, other = (ParametricSurface((u, v, letter * u), letters={letter: 1}) for letter in sp.symbols("p q", real=True))
    assert_close(mesh_patches([one, other], 1, letters={"q": 3}).vertices[:, 2].max(), 3, atol=1e-15)
    with pytest.raises(rsym.RsymError, match="no letter 'nobody'; the letters are: p, q"):
        mesh_patches([one, other], 1, letters={"nobody": 3})


def test_only_patches_are_joined():
    with pytest.raises(rsym.RsymError, match="expected two patches, got CoonsPatch and int"):
        join(made("Coons, class 1"), "u1", 3, "u0")
