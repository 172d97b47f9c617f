"""Splines through and near points at given parameters: curves, and surfaces through scattered points."""

import itertools

import numpy as np
import pytest
from oracles.closeness import assert_close
from scipy.interpolate import BSpline, NdBSpline, make_interp_spline, make_lsq_spline

from rsym.errors import RsymError
from rsym.surfaces.bsplines import bspline_fitting
from rsym.surfaces.bsplines.spline_surfaces import BSplineSurface
from rsym.surfaces.functions.nurbs import Nurbs

RANDOM = np.random.default_rng(11)
T = np.sort(RANDOM.uniform(0, 1, 24))
T[[0, -1]] = 0, 1
U, V = RANDOM.uniform(0, 1, (2, 400))
FINE = np.linspace(0, 1, 41)
interpolate, approximate = BSplineSurface.interpolate, BSplineSurface.least_squares


def refused(code, words, work):
    with pytest.raises(RsymError) as caught:
        work()
    assert caught.value.code == code, str(caught.value)
    assert words in str(caught.value), str(caught.value)
    assert caught.value.remedy


def helix(t):
    return np.stack([np.cos(4 * t), np.sin(4 * t), t], axis=-1)


def polynomial(degree, seed=0):
    """A random polynomial curve and its value in plain arithmetic."""
    coefficients = np.random.default_rng(seed).normal(size=(degree + 1, 3))
    return lambda t: np.polynomial.polynomial.polyval(t, coefficients).T


def sheet(degree, seed=0):
    """A random polynomial surface of some degrees."""
    coefficients = np.random.default_rng(seed).normal(size=(degree[0] + 1, degree[1] + 1, 3))
    return lambda u, v: np.moveaxis(np.polynomial.polynomial.polyval2d(*np.broadcast_arrays(u, v), coefficients), 0, -1)


@pytest.mark.parametrize("degree", range(1, 7))
@pytest.mark.parametrize("rule", ["chord-length", "centripetal", T])
def test_a_curve_meets_its_points(degree, rule):
    curve = Nurbs.interpolate(helix(T), degree=degree, parameters=rule)
    assert_close(curve(curve.parameters), helix(T), atol=1e-12)
    assert (curve.domain, curve.degree, curve.order, len(curve.points)) == ((0, 1), degree, degree + 1, 24)
    assert curve.residual.maximum < 1e-12
    chords = np.linalg.norm(np.diff(helix(T), axis=0), axis=1) ** (
        0.5 if isinstance(rule, str) and rule[1] == "e" else 1
    )
    shares = np.append(0, np.cumsum(chords) / chords.sum())
    assert_close(curve.parameters, shares if isinstance(rule, str) else T, atol=1e-14)


@pytest.mark.parametrize("degree", range(1, 7))
def test_polynomial_curves_are_reproduced(degree):
    truth = polynomial(degree)
    for curve in (
        Nurbs.interpolate(truth(T), degree=degree, parameters=T),
        Nurbs.least_squares(truth(T), degree + 4, degree=degree, parameters=T),
    ):
        assert_close(curve(FINE), truth(FINE), atol=1e-11)


def test_curves_are_those_of_scipy():
    points = helix(T) + RANDOM.normal(scale=0.1, size=(24, 3))
    curve = Nurbs.interpolate(points, parameters=T)
    theirs = make_interp_spline(T, points, k=3, t=curve.knots)
    assert_close(curve(FINE, 2), theirs(FINE, 2), atol=1e-8)
    near = Nurbs.least_squares(points, 9, 5, parameters=T)
    assert_close(near(FINE), make_lsq_spline(T, points, near.knots, k=4)(FINE), atol=1e-10)
    distances = np.linalg.norm(near(T) - points, axis=1)
    assert_close(near.residual.maximum, distances.max(), rtol=1e-12)
    assert near.residual.worst == (distances.argmax(),)
    assert f"datum {distances.argmax()}, t = " in str(near.residual)
    turn = np.arange(12) / 12
    around = Nurbs.interpolate(helix(turn) * [1, 1, 0], closed=True, parameters=np.append(turn, 1))
    rows = helix(np.arange(13) / 12 % 1) * [1, 1, 0]
    assert_close(around(FINE), make_interp_spline(np.append(turn, 1), rows, k=3, bc_type="periodic")(FINE), atol=1e-12)
    assert around.closed


@pytest.mark.parametrize("degree", [2, 3, 4, 5])
def test_interpolation_is_of_the_order_of_the_spline(degree):
    def error(count):
        t = np.linspace(0, 1, count)
        return np.abs(
            Nurbs.interpolate(helix(t), degree=degree, parameters=t)(np.linspace(0, 1, 999))
            - helix(np.linspace(0, 1, 999))
        ).max()

    observed = np.log2(error(25) / error(49))
    assert degree + 0.5 < observed < degree + 1.8, observed


def test_knots_that_are_given_give_the_interval():
    knots = [2, 2, 2, 2, 3, 5, 6, 6, 6, 6]
    curve = Nurbs.least_squares(helix(T), 6, knots=knots)
    assert curve.domain == (2, 6)
    assert curve.parameters[[0, -1]].tolist() == [2, 6]
    assert Nurbs.interpolate(helix(T), parameters=3 * T - 1).domain == (-1, 2)


@pytest.mark.parametrize("orders", [(4, 4), (2, 5), (3, 4)])
def test_scattered_points_of_a_polynomial_give_it_back(orders):
    truth = sheet((orders[0] - 1, orders[1] - 1))
    surface = BSplineSurface.least_squares(truth(U, V), (orders[0] + 3, orders[1] + 2), orders, parameters=(U, V))
    assert surface.domain == ((0, 1), (0, 1))
    assert_close(surface.grid(FINE, FINE), truth(FINE[:, None], FINE), atol=1e-10)
    assert surface.residual.maximum < 1e-12
    assert [one.shape for one in surface.parameters] == [(400,), (400,)]
    assert surface.fit.points.shape == (400, 3)


def test_scattered_least_squares_are_those_of_the_normal_equations():
    points = np.stack([U, V, np.sin(5 * U) * V], axis=-1) + RANDOM.normal(scale=0.01, size=(400, 3))
    surface = BSplineSurface.least_squares(points, (6, 5), (4, 3), parameters=(U, V))
    each = [
        NdBSpline(surface.knots, np.eye(30)[row].reshape(6, 5), (3, 2))(np.stack([U, V], axis=-1)) for row in range(30)
    ]
    c = np.stack(each, axis=1)
    assert_close(surface.net.reshape(-1, 3), np.linalg.solve(c.T @ c, c.T @ points), atol=1e-10)
    distances = np.linalg.norm(points - surface(U, V), axis=1)
    assert surface.residual.worst == (distances.argmax(),)
    assert_close(surface.residual.rms, np.sqrt((distances**2).mean()), rtol=1e-12)


def test_the_order_of_the_points_does_not_matter_and_a_net_may_be_given_as_points():
    points, places = sheet((5, 4), 3)(U, V), RANDOM.permutation(400)
    one = BSplineSurface.least_squares(points, (6, 6), parameters=(U, V))
    other = BSplineSurface.least_squares(points[places], (6, 6), parameters=(U[places], V[places]))
    assert_close(one.net, other.net, atol=1e-11)
    rows, columns = np.linspace(0, 1, 8), np.linspace(0, 1, 7) ** 2
    net = sheet((6, 6), 5)(rows[:, None], columns)
    whole = BSplineSurface.interpolate(net, parameters=(rows, columns))
    u, v = (one.ravel() for one in np.meshgrid(rows, columns, indexing="ij"))
    flat = BSplineSurface.interpolate(net.reshape(-1, 3), parameters=(u, v), vertices=(8, 7))
    assert_close(flat.net, whole.net, atol=1e-11)
    assert_close(flat(u, v), net.reshape(-1, 3), atol=1e-12)


def test_as_many_scattered_points_as_vertices_are_met():
    """Points shaken out of a grid."""
    u, v = (one.ravel() for one in np.meshgrid(np.linspace(0.05, 0.95, 7), np.linspace(0.05, 0.95, 6), indexing="ij"))
    u, v = u + RANDOM.uniform(-0.04, 0.04, 42), v + RANDOM.uniform(-0.04, 0.04, 42)
    points = np.stack([u, v, np.exp(u * v)], axis=-1)
    surface = BSplineSurface.interpolate(points, parameters=(u, v), vertices=(7, 6))
    assert_close(surface(u, v), points, atol=1e-12)
    assert surface.domain == ((0, 1), (0, 1))


def test_a_tube_of_scattered_points_closes():
    turn, height = 2 * np.pi * U, V
    points = np.stack([np.cos(turn), np.sin(turn), height], axis=-1)
    surface = BSplineSurface.least_squares(points, (12, 4), parameters=(U, V), closed=(True, False))
    places = np.linspace(0, 1, 50)
    radius = np.hypot(*np.moveaxis(surface.grid(places, FINE), -1, 0)[:2])
    assert np.abs(radius - 1).max() < 2e-3
    for order in ((0, 0), (1, 0), (2, 0)):
        ends = [surface.derivative(end, FINE, order) for end in (0.0, 1.0)]
        assert_close(ends[0], ends[1], atol=1e-10)


@pytest.mark.slow
def test_scattered_points_are_of_the_order_of_the_spline():
    generator = np.random.default_rng(2)
    u, v = generator.uniform(0, 1, (2, 6000))
    points = np.stack([u, v, np.sin(6 * u) * np.cos(5 * v)], axis=-1)

    def error(count):
        found = BSplineSurface.least_squares(points, (count + 3,) * 2, parameters=(u, v), knots="uniform")
        return np.abs(found.grid(FINE, FINE)[..., 2] - np.sin(6 * FINE)[:, None] * np.cos(5 * FINE)).max()

    assert 3.4 < np.log2(error(6) / error(12)) < 4.8


def test_parameters_in_the_plane_of_the_points():
    """A turned and moved graph; where the points lie is found to rounding."""
    x, y = RANDOM.uniform(-1, 1, (2, 500)) * [[3], [1]]
    turn = np.linalg.qr(RANDOM.normal(size=(3, 3)))[0]
    bowl = np.stack([x, y, 0.1 * (x**2 - 2 * y**2)], axis=-1)
    points = bowl @ turn.T + [5, 6, 7]
    surface = BSplineSurface.least_squares(points, (7, 6), parameters="plane", knots="uniform")
    assert surface.residual.maximum < 0.05
    assert surface.domain == ((0, 1), (0, 1))
    u, v = surface.parameters
    assert (u.min(), u.max(), v.min(), v.max()) == (0, 1, 0, 1)
    assert abs(np.corrcoef(u, x)[0, 1]) > 0.999
    line = np.outer(np.arange(40.0), [1, 2, 3])
    refused("parameters", "lie on a line", lambda: BSplineSurface.least_squares(line, (4, 4), parameters="plane"))


def test_corrections_move_scattered_parameters_too():
    points = np.stack([U, V, 0.3 * np.sin(4 * U) * V], axis=-1)
    off = np.clip(U + 0.02 * np.sin(9 * V), 0, 1)
    surface = BSplineSurface.least_squares(points, (6, 6), parameters=(off, V), corrections=5)
    rms = [one.rms for one in surface.fit.history]
    assert len(rms) > 3
    assert all(b < a for a, b in itertools.pairwise(rms))
    assert [one.shape for one in surface.parameters] == [(400,), (400,)]


def energy_rows(surface):
    """The penalty's roots, by SciPy's derivatives of basis functions and their integrals, over [0, 1]."""
    each = []
    for knots, degree, count in zip(surface.knots, surface.degree, surface.net.shape, strict=False):
        unit = (knots - knots[0]) / (knots[-1] - knots[0])
        rows = []
        for order in range(3):
            inner, k = unit[order : len(unit) - order], degree - order
            derived = [
                BSpline(unit, one, degree).derivative(order) if order else BSpline(unit, one, degree)
                for one in np.eye(count)
            ]
            vertices = np.stack([one.c[: count - order] for one in derived], axis=1)
            areas = [BSpline(inner, one, k).integrate(0, 1) for one in np.eye(count - order)]
            rows.append(np.sqrt(areas)[:, None] * vertices)
        each.append(rows)
    (n, n_u, n_uu), (m, m_v, m_vv) = each
    return np.concatenate([np.kron(n_uu, m), 2**0.5 * np.kron(n_u, m_v), np.kron(n, m_vv)])


@pytest.mark.parametrize("orders", [(4, 4), (3, 5)])
@pytest.mark.parametrize("net", [False, True])
def test_smoothed_surfaces_are_those_of_the_normal_equations(orders, net):
    rows, columns = np.linspace(2, 5, 9) ** 1.3, np.linspace(0, 1, 8)
    u, v = (one.ravel() for one in np.meshgrid(rows, columns, indexing="ij")) if net else (3 * U - 1, V**2)
    points = np.stack([u, v, np.sin(u) * v], axis=-1) + RANDOM.normal(scale=0.05, size=(len(u), 3))
    given, parameters = (points.reshape(9, 8, 3), (rows, columns)) if net else (points, (u, v))
    surface = BSplineSurface.least_squares(given, (7, 6), orders, parameters=parameters, smoothing=1e-3)
    degrees = (orders[0] - 1, orders[1] - 1)
    c = np.stack(
        [NdBSpline(surface.knots, np.eye(42)[k].reshape(7, 6), degrees)(np.stack([u, v], axis=-1)) for k in range(42)],
        axis=1,
    )
    e = energy_rows(surface)
    expected = np.linalg.solve(c.T @ c / len(u) + 1e-3 * e.T @ e, c.T @ points / len(u))
    assert_close(surface.net.reshape(-1, 3), expected, atol=1e-9)


@pytest.mark.parametrize("closed", [(False, False), (True, False)])
@pytest.mark.parametrize("orders", [(4, 4), (3, 3), (2, 4), (5, 2)])
def test_what_is_straight_stays_so_however_smooth(orders, closed):
    """Planes in u and v, cylinders' axes in v alone; the hole is filled."""
    outside = np.hypot(U - 0.5, V - 0.5) > 0.4
    u, v = U[outside], V[outside]
    points = np.stack([0 * u if closed[0] else u, v, 1 + 2 * v - (0 if closed[0] else 3) * u], axis=-1)
    surface = BSplineSurface.least_squares(
        points, (9, 8), orders, parameters=(u, v), closed=closed, knots="uniform", smoothing=1e-2
    )
    a, b = np.broadcast_arrays(FINE[:, None], FINE)
    x = np.zeros_like(a) if closed[0] else a
    assert_close(surface.grid(FINE, FINE), np.stack([x, b, 1 + 2 * b - 3 * x], axis=-1), atol=1e-9)


def test_a_disc_of_points_needs_smoothing_and_its_dome_is_met():
    inside = np.hypot(U - 0.5, V - 0.5) < 0.45
    u, v = U[inside], V[inside]
    dome = np.stack([u, v, np.sqrt(1 - (u - 0.5) ** 2 - (v - 0.5) ** 2)], axis=-1)
    refused(
        "schoenberg-whitney", "smoothing=1e-6", lambda: approximate(dome, (12, 12), parameters=(u, v), knots="uniform")
    )
    rms = [
        approximate(dome, (12, 12), parameters=(u, v), knots="uniform", smoothing=10.0**-k).residual.rms
        for k in (2, 4, 6, 8)
    ]
    assert all(b < a / 5 for a, b in itertools.pairwise(rms))
    assert rms[-1] < 5e-5


def test_what_is_very_smooth_is_the_plane_of_least_squares():
    points = np.stack([U, V, np.sin(7 * U) * V], axis=-1)
    surface = approximate(points, (6, 6), parameters=(U, V), smoothing=1e8)
    line = np.stack([np.ones(400), U, V], axis=1)
    plane = np.linalg.lstsq(line, points, rcond=None)[0]
    assert_close(surface(U, V), line @ plane, atol=1e-7)


def test_kinks_at_repeated_knots_are_not_smoothed_away():
    """A roof: straight on either side of a double knot of degree 2."""
    points = np.stack([U, V, np.abs(U - 0.5)], axis=-1)
    knots = [0, 0, 0, 0.5, 0.5, 1, 1, 1], [0, 0, 0, 1, 1, 1]
    surface = approximate(points, (5, 3), (3, 3), parameters=(U, V), knots=knots, smoothing=1.0)
    assert surface.residual.maximum < 1e-10


@pytest.mark.slow
def test_systems_are_refused_only_where_they_must_be():
    """Against singular values."""
    generator = np.random.default_rng(4)
    seen = set()
    for case in range(150):
        order = generator.integers(2, 6, 2)
        count = order + generator.integers(0, 5, 2)
        u, v = generator.random((2, int(count.prod() * generator.choice([1, 1.2, 2, 4]))))
        u, v = (np.round(u, 1), np.round(v, 1)) if case % 3 else (u**2, v)
        knots = [
            np.r_[np.zeros(k), np.arange(1, n - k + 1) / (n - k + 1), np.ones(k)]
            for n, k in zip(count, order, strict=True)
        ]
        n, m = (BSpline.design_matrix(t, one, k - 1).toarray() for t, one, k in zip((u, v), knots, order, strict=True))
        system = (n[:, :, None] * m[:, None]).reshape(len(u), -1)
        values = np.linalg.svd(system / np.linalg.norm(system, axis=0).clip(1e-300), compute_uv=False)
        points = np.stack([u, v, u * v], axis=-1)
        try:
            approximate(points, count.tolist(), order.tolist(), parameters=(u, v), knots=knots)
            code = "fitted"
        except RsymError as error:
            code = error.code
        if code != "vertices":  # one decimal leaves eleven parameters for at most so many vertices
            assert values[-1] > 1e-15 * values[0] if code == "fitted" else values[-1] < 1e-14 * values[0], (case, code)
        seen.add(code)
    assert seen == {"fitted", "singular", "schoenberg-whitney", "vertices"}


def test_what_does_not_fit_in_memory_is_refused_before_it_is_taken(monkeypatch):
    points = np.stack([U, V, U * V], axis=-1)
    monkeypatch.setattr(bspline_fitting, "free_memory", lambda: 2.0**20)
    refused("memory", "400 points and 10 x 10 vertices need", lambda: approximate(points, (10, 10), parameters=(U, V)))
    assert approximate(points, (4, 4), parameters=(U, V)).residual.maximum < 1e-12


POINTS = np.stack([U, V, U * V], axis=-1)
HALF = U < 0.5


@pytest.mark.parametrize(
    ("code", "words", "work"),
    [
        ("parameters", "need parameters for each", lambda: approximate(POINTS, (5, 5))),
        ("parameters", "need parameters for each", lambda: interpolate(POINTS, vertices=(20, 20))),
        ("parameters", "(400,), got (399,)", lambda: approximate(POINTS, (5, 5), parameters=(U[1:], V))),
        ("parameters", "must be finite", lambda: approximate(POINTS, (5, 5), parameters=(U, V * np.nan))),
        ("parameters", "must be numbers", lambda: approximate(POINTS, (5, 5), parameters=("a", V))),
        ("parameters", "all alike", lambda: approximate(POINTS, (5, 5), parameters=(0 * U + 2, V))),
        ("pair", "parameters must be a pair", lambda: approximate(POINTS, (5, 5), parameters=U)),
        ("vertices", "400 points determine at most 400", lambda: approximate(POINTS, (21, 20), parameters=(U, V))),
        ("vertices", "as many vertices", lambda: interpolate(POINTS, parameters=(U, V))),
        ("vertices", "400 points, got 5 x 5", lambda: interpolate(POINTS, parameters=(U, V), vertices=(5, 5))),
        ("vertices", "net of 9 x 7", lambda: interpolate(np.ones((9, 7, 3)), vertices=(5, 5))),
        (
            "knots",
            "reach from",
            lambda: approximate(POINTS, (4, 4), parameters=(9 * U, V), knots=([0] * 4 + [1] * 4,) * 2),
        ),
        ("closed", "one period", lambda: approximate(POINTS, (5, 5), parameters=(9 * U, V), closed=(True, False))),
        (
            "schoenberg-whitney",
            "no datum left for the vertex (5, 0): it matters for u in [0.6667, 1], v in [0, 0.3333], and 5 more",
            lambda: approximate(
                POINTS[HALF & (U < 0.4)],
                (6, 6),
                (4, 4),
                parameters=(U[HALF & (U < 0.4)], V[HALF & (U < 0.4)]),
                knots="uniform",
            ),
        ),
        (
            "singular",
            "do not determine the vertex",
            lambda: approximate(POINTS, (2, 2), (2, 2), parameters=(U, U)),
        ),
        ("smoothing", "number >= 0, got -1", lambda: approximate(POINTS, (5, 5), parameters=(U, V), smoothing=-1)),
        ("smoothing", "number >= 0, got nan", lambda: approximate(POINTS, (5, 5), parameters=(U, V), smoothing=np.nan)),
        (
            "kept",
            "kept, or the surface is smoothed",
            lambda: approximate(POINTS, (5, 5), parameters=(U, V), smoothing=1, kept=[((0, 0), POINTS)]),
        ),
        ("kept", "sequence of pairs", lambda: approximate(POINTS, (5, 5), parameters=(U, V), kept=3)),
        ("points", "(n, 3)", lambda: Nurbs.interpolate(POINTS[:, :2])),
        (
            "parameters",
            "points 3 and 4 have the same parameter t",
            lambda: Nurbs.interpolate(np.insert(helix(T), 3, helix(T[3]), axis=0)),
        ),
        ("parameters", "must not decrease", lambda: Nurbs.interpolate(helix(T), parameters=T[::-1])),
        ("parameters", "(24,)", lambda: Nurbs.interpolate(helix(T), parameters=T[1:])),
        ("vertices", "at most 24 vertices, got 25", lambda: Nurbs.least_squares(helix(T), 25)),
        ("order", "order 30 along t needs 30", lambda: Nurbs.interpolate(helix(T), 30)),
        ("order", "give one of them", lambda: Nurbs.interpolate(helix(T), 4, degree=3)),
        ("degree", "integer >= 1, got 0", lambda: Nurbs.interpolate(helix(T), degree=0)),
        ("closed", "last point", lambda: Nurbs.interpolate(helix(T)[[*range(24), 0]], closed=True)),
        (
            "schoenberg-whitney",
            "the vertex 4 along t: no parameter left for it between its knots 0.9 and 1",
            lambda: Nurbs.least_squares(
                helix(T), 8, knots=[0] * 4 + [0.9, 0.99, 0.999, 0.9999] + [1] * 4, parameters=T * 0.5
            ),
        ),
        ("no-data", "not of data", lambda: Nurbs(3, None, POINTS).parameters),
    ],
)
def test_what_is_refused(code, words, work):
    with pytest.raises(RsymError) as caught:
        work()
    assert caught.value.code == code, str(caught.value)
    assert words in str(caught.value), str(caught.value)
