"""Composite Coons surfaces cell by cell, and the tensor product surface of a grid of points."""

import numpy as np
import pytest
import sympy as sp
from oracles.closeness import assert_close
from scipy.interpolate import CubicSpline, PPoly

from rsym.errors import RsymError
from rsym.surfaces.functions.cardinals import hermite_cardinals
from rsym.surfaces.functions.curves import Called
from rsym.surfaces.functions.polynomials import Polynomials
from rsym.surfaces.functions.univariate import Formula
from rsym.surfaces.networks.composite import CompositeCoons
from rsym.surfaces.networks.gordon import GordonSurface, TensorProductSurface
from rsym.surfaces.symbols import t, u, v

UNIFORM, GENERAL = (range(5), range(4)), ((0, 0.7, 2, 2.5, 4), (0, 1.3, 1.9, 3))
STEP = 1e-3


def sheet(x, y, bump=0.0):
    x, y = np.broadcast_arrays(np.asarray(x, float), np.asarray(y, float))
    return np.stack([x + 0.1 * np.sin(y), y + 0.2 * np.cos(x), np.sin(x) * np.cos(1.3 * y) + bump], axis=-1)


def bumps(kind, number, s, knots):
    """What vanishes at the other family's knots with any slope: tangents of curves and ribbons then differ."""
    return (0.02 if kind == "r" else -0.03) * (number + 1) * np.prod([s - k for k in knots], axis=0)


class Grid:
    """The curves of a network, and the ribbons of the theory from them alone."""

    def __init__(self, knots, closed=False):
        self.a, self.b = (np.array(one, float) for one in knots)

    def r(self, j, s):
        return sheet(s, self.b[j], bumps("r", j, s, self.a))

    def s(self, i, w):
        return sheet(self.a[i], w, bumps("s", i, w, self.b))

    def curves(self):
        def rows(function, count, ends):
            return [Called(lambda x, k=k: function(k, x), domain=ends) for k in range(count)]

        return rows(self.r, len(self.b), (0, self.a[-1])), rows(self.s, len(self.a), (0, self.b[-1]))

    def ribbon(self, curve, knots, k, at):
        """D_k or E_k by (3.7.7), (3.7.8) for any knots."""
        last, h = len(knots) - 1, np.diff(knots)
        value = lambda m: curve(m, at)  # noqa: E731
        if k in (0, last):
            inner, step = (1, h[0]) if k == 0 else (last - 1, h[-1])
            chord = (value(1) - value(0)) / step if k == 0 else (value(last) - value(last - 1)) / step
            return 2 * chord - self.ribbon(curve, knots, inner, at)
        before, after = h[k - 1], h[k]
        left, right = value(k) - value(k - 1), value(k + 1) - value(k)
        return (after / before * left + before / after * right) / (before + after)

    def D(self, i, w):
        return self.ribbon(self.s, self.a, i, w)

    def E(self, j, s):
        return self.ribbon(self.r, self.b, j, s)


def slope(function, at, h=STEP):
    """Sixth-order central difference."""
    weights = {1: 45, 2: -9, 3: 1}
    return sum(c * (function(at + k * h) - function(at - k * h)) for k, c in weights.items()) / (60 * h)


def functions(w, h):
    """Cubic Hermite functions for an interval of length h."""
    return np.array([1 - 3 * w**2 + 2 * w**3, 3 * w**2 - 2 * w**3, h * (w - 2 * w**2 + w**3), h * (w**3 - w**2)])


def cell(grid, i, j, t_, w_, twists, of_curves=False):
    """(3.7.6) with corner tangents from the ribbons; or, wrongly, from the curves."""
    hu, hv = grid.a[i + 1] - grid.a[i], grid.b[j + 1] - grid.b[j]
    A, B = functions(t_, hu), functions(w_, hv)
    x, y = grid.a[i] + t_ * hu, grid.b[j] + w_ * hv
    across_u = [grid.s(i, y), grid.s(i + 1, y), grid.D(i, y), grid.D(i + 1, y)]
    across_v = [grid.r(j, x), grid.r(j + 1, x), grid.E(j, x), grid.E(j + 1, x)]
    M = np.zeros((4, 4, 3))
    for k in (0, 1):
        for m in (0, 1):
            M[k, m] = grid.r(j + m, grid.a[i + k])
            M[2 + k, m] = grid.D(i + k, grid.b[j + m])
            M[k, 2 + m] = grid.E(j + m, grid.a[i + k])
            if of_curves:
                M[2 + k, m] = slope(lambda s, m=m: grid.r(j + m, s), grid.a[i + k])
                M[k, 2 + m] = slope(lambda w, k=k: grid.s(i + k, w), grid.b[j + m])
            M[2 + k, 2 + m] = twists[i + k, j + m]
    return A @ np.array(across_u) + B @ np.array(across_v) - np.einsum("a,abc,b->c", A, M, B)


def mean_twists(grid):
    pairs = [[mixed_by_ribbons(grid, i, j) for j in range(len(grid.b))] for i in range(len(grid.a))]
    return np.array(pairs).sum(axis=2) / 2


def mixed_by_ribbons(grid, i, j):
    """D_i'(v_j) and E_j'(u_i)."""
    return slope(lambda w: grid.D(i, w), grid.b[j]), slope(lambda s: grid.E(j, s), grid.a[i])


@pytest.mark.random
@pytest.mark.parametrize("knots", [UNIFORM, GENERAL])
@pytest.mark.parametrize("kind", ["mean", "zero", "any"])
def test_every_cell_is_the_cubic_coons_patch_of_the_source(knots, kind):
    grid = Grid(knots)
    size = len(grid.a), len(grid.b), 3
    twists = {"mean": lambda: mean_twists(grid), "zero": lambda: np.zeros(size)}.get(
        kind, lambda: np.random.default_rng(3).normal(size=size)
    )()
    surface = CompositeCoons(*grid.curves(), twists=twists if kind == "any" else kind)
    for i, j, t_, w_ in ((0, 0, 0.3, 0.6), (1, 1, 0.5, 0.2), (2, 0, 0.9, 0.1), (3, 2, 0.45, 0.7), (0, 2, 0.0, 0.4)):
        place = grid.a[i] * (1 - t_) + grid.a[i + 1] * t_, grid.b[j] * (1 - w_) + grid.b[j + 1] * w_
        assert_close(surface(*place), cell(grid, i, j, t_, w_, twists), atol=1e-11)


def test_with_tangents_of_the_curves_in_the_corners_the_network_would_be_missed():
    """Red proof."""
    grid, twists = Grid(GENERAL), np.zeros((5, 4, 3))
    x = 0.4 * grid.a[1] + 0.6 * grid.a[2]
    assert_close(cell(grid, 1, 1, 0.6, 0, twists), grid.r(1, x), atol=1e-12)
    assert np.abs(cell(grid, 1, 1, 0.6, 0, twists, of_curves=True) - grid.r(1, x)).max() > 0.01


def any_surface(seed=5):
    grid = Grid(GENERAL)
    twists = np.random.default_rng(seed).normal(size=(5, 4, 3))
    return grid, twists, CompositeCoons(*grid.curves(), twists=twists)


def test_the_network_is_met_though_its_tangents_are_not_those_of_the_ribbons():
    grid, _, surface = any_surface()
    dense = np.linspace(0, 1, 33)
    assert np.abs(slope(lambda s: grid.r(1, s), grid.a[1]) - grid.D(1, grid.b[1])).max() > 0.1
    for j in range(4):
        assert_close(surface(4 * dense, grid.b[j]), grid.r(j, 4 * dense), atol=1e-12)
    for i in range(5):
        assert_close(surface(grid.a[i], 3 * dense), grid.s(i, 3 * dense), atol=1e-12)


def test_the_surface_is_c1_for_any_twists():
    grid, _, surface = any_surface()
    dense = np.linspace(0.01, 0.99, 40)
    for order in ((1, 0), (0, 1), (1, 1)):
        for a in grid.a[1:-1]:
            assert_close(
                surface.derivative(np.nextafter(a, 0), 3 * dense, order),
                surface.derivative(a, 3 * dense, order),
                atol=1e-9,
            )
        for b in grid.b[1:-1]:
            assert_close(
                surface.derivative(4 * dense, np.nextafter(b, 0), order),
                surface.derivative(4 * dense, b, order),
                atol=1e-9,
            )


def test_the_derivative_across_a_curve_is_that_of_the_theorem():
    grid, twists, surface = any_surface()
    for i in (0, 2, 4):
        for j, w in ((0, 0.0), (0, 0.35), (1, 0.8), (2, 0.5)):
            h = grid.b[j + 1] - grid.b[j]
            F = functions(w, h)
            y = grid.b[j] + w * h
            expected = grid.D(i, y)
            for k in (0, 1):
                a = grid.a[i]
                along = slope(lambda s, m=j + k: grid.r(m, s), a)
                of_e = slope(lambda s, m=j + k: grid.E(m, s), a)
                expected = expected + F[k] * (along - grid.D(i, grid.b[j + k])) + F[2 + k] * (of_e - twists[i, j + k])
            assert_close(surface.derivative(a, y, (1, 0)), expected, atol=1e-9)
            if w == 0:
                mixed = sum(mixed_by_ribbons(grid, i, j)) - twists[i, j]
                assert_close(surface.derivative(a, y, (1, 1)), mixed, atol=1e-8)


def ring(a, b):
    a, b = np.broadcast_arrays(a, b)
    return np.stack(
        [(3 + np.cos(b)) * np.cos(a), (3 + np.cos(b)) * np.sin(a), np.sin(b) + 0.3 * np.cos(3 * a)], axis=-1
    )


def test_closed_directions_close_c1():
    full = 2 * np.pi
    us, vs, dense = np.arange(7) / 7, np.arange(5) / 5, np.linspace(0, 1, 41)
    along = [lambda s, b=b: ring(full * s, full * b) for b in vs]
    over = [lambda s, a=a: ring(full * a, full * s) for a in us]
    surface = CompositeCoons(along, over, twists=np.random.default_rng(2).normal(size=(7, 5, 3)))
    assert surface.closed == (True, True)
    assert surface.domain == ((0, 1), (0, 1))
    assert_close(surface.grid(us, dense), ring(full * us[:, None], full * dense), atol=1e-12)
    assert_close(surface.grid(dense, vs), ring(full * dense[:, None], full * vs), atol=1e-12)
    for order in ((0, 0), (1, 0), (0, 1)):
        assert_close(surface.derivative(1, dense, order), surface.derivative(0, dense, order), atol=1e-8)
        assert_close(surface.derivative(dense, 1, order), surface.derivative(dense, 0, order), atol=1e-8)


def test_the_formula_gives_the_values_and_letters_move_the_surface():
    h = sp.Symbol("h")
    along = [Formula((t, y, h * sp.sin(t) * y**2), {h: 1}, (0, 2)) for y in (0, 1, 2)]
    over = [Formula((x, t, h * sp.sin(x) * t**2), {h: 1}, (0, 2)) for x in (0, 1, 2)]
    surface = CompositeCoons(along, over)
    place = {u: sp.Rational(7, 5), v: sp.Rational(1, 3)}
    expected = surface.expression().subs(place).subs(sp.Symbol("h", real=True), 3)
    assert_close(surface(1.4, 1 / 3, letters={"h": 3}), np.array(expected, float).ravel(), atol=1e-14)
    over[1] = Formula((1, t, sp.sin(1) * t**2), None, (0, 2))
    with pytest.raises(RsymError, match="these letters part the u-curve 2 and the v-curve 1"):
        CompositeCoons(along, over)(1, 1, letters={"h": 2})


@pytest.mark.parametrize(
    ("twists", "message"),
    [
        ("none", "mean, zero or numbers, got 'none'"),
        (np.zeros((4, 5, 3)), r"shape \(5, 4, 3\) .* got the shape \(4, 5, 3\)"),
    ],
)
def test_bad_twists_are_refused(twists, message):
    with pytest.raises(RsymError, match=message):
        CompositeCoons(*Grid(UNIFORM).curves(), twists=twists)


def points(r=5, s=4, seed=8):
    return np.random.default_rng(seed).normal(size=(r, s, 3))


def hermite_slopes(p, axis, closed):
    p = np.moveaxis(p, axis, 0)
    q = (np.roll(p, -1, axis=0) - np.roll(p, 1, axis=0)) / 2
    if not closed:
        q[0], q[-1] = 2 * (p[1] - p[0]) - q[1], 2 * (p[-1] - p[-2]) - q[-2]
    return np.moveaxis(q, 0, axis)


@pytest.mark.parametrize("closed", [(False, False), (True, False), (True, True)])
def test_the_tensor_product_is_the_bicubic_hermite_patch_of_every_cell(closed):
    p = points()
    p_u, p_v = (hermite_slopes(p, axis, closed[axis]) for axis in (0, 1))
    p_uv = hermite_slopes(p_u, 1, closed[1])
    assert_close(p_uv, hermite_slopes(p_v, 0, closed[0]), atol=1e-14)
    surface = TensorProductSurface(p, closed=closed)
    assert surface.closed == closed
    for i, j, t_, w_ in ((0, 0, 0.2, 0.7), (2, 1, 0.5, 0.5), (4 if closed[0] else 3, 3 if closed[1] else 2, 0.9, 0.4)):
        rows = np.ix_([i, (i + 1) % 5], [j, (j + 1) % 4])
        M = np.vstack([np.hstack([p[rows], p_v[rows]]), np.hstack([p_u[rows], p_uv[rows]])])
        expected = np.einsum("a,abc,b->c", functions(t_, 1), M, functions(w_, 1))
        assert_close(surface(i + t_, j + w_), expected, atol=1e-13)


def test_three_surfaces_coincide_where_the_curves_are_hermite_splines_through_points():
    p = points()
    of_u, of_v = hermite_cardinals(range(5)), hermite_cardinals(range(4))
    along = [Called(lambda s, j=j: of_u(s) @ p[:, j], domain=(0, 4)) for j in range(4)]
    over = [Called(lambda s, i=i: of_v(s) @ p[i], domain=(0, 3)) for i in range(5)]
    places = np.linspace(0, 4, 23), np.linspace(0, 3, 19)
    expected = TensorProductSurface(p).grid(*places)
    gordon = GordonSurface(along, over, cardinals_u="hermite", cardinals_v="hermite")
    assert_close(gordon.grid(*places), expected, atol=1e-12)
    along = [Polynomials(PPoly(of_u.polynomials.c @ p[:, j], of_u.polynomials.x)) for j in range(4)]
    over = [Polynomials(PPoly(of_v.polynomials.c @ p[i], of_v.polynomials.x)) for i in range(5)]
    assert_close(CompositeCoons(along, over).grid(*places), expected, atol=1e-12)


def test_splines_make_the_tensor_product_c2_and_knots_may_be_any():
    p, places = points(), (np.linspace(0, 4, 9), np.linspace(0, 3, 8))
    knots = (0, 0.5, 2, 3, 4), (0, 1, 2.5, 3)
    surface = TensorProductSurface(p, *knots, cardinals="spline")
    rows = CubicSpline(knots[0], p, bc_type="natural")(places[0])
    assert_close(surface.grid(*places), CubicSpline(knots[1], rows, axis=1, bc_type="natural")(places[1]), atol=1e-13)
    point = TensorProductSurface(p, *knots).expression().subs({u: sp.Rational(1, 3), v: sp.Rational(14, 5)})
    assert_close(TensorProductSurface(p, *knots)(1 / 3, 2.8), np.array(point, float).ravel(), atol=1e-13)


@pytest.mark.parametrize(
    ("build", "message"),
    [
        (lambda: TensorProductSurface(np.zeros((4, 3))), r"shape \(r, s, 3\)"),
        (lambda: TensorProductSurface(points(), range(4)), "5 rows of points in u need 5 knots, got 4"),
        (lambda: TensorProductSurface(points(), closed=(False, True), cardinals="lagrange"), "not of a closed family"),
    ],
)
def test_bad_grids_are_refused(build, message):
    with pytest.raises(RsymError, match=message):
        build()
