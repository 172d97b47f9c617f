"""Gordon surfaces: networks that fit, that are made to fit, and that are refused."""

import numpy as np
import pytest
import sympy as sp
from oracles.closeness import assert_close
from scipy.interpolate import CubicSpline, PPoly, lagrange

from rsym.errors import RsymError
from rsym.surfaces.functions.polynomials import Polynomials
from rsym.surfaces.functions.univariate import Formula
from rsym.surfaces.networks.gordon import GordonSurface
from rsym.surfaces.networks.reparametrisation import Composed, increasing
from rsym.surfaces.symbols import t, u, v

U, V = (0, 0.3, 0.8, 1), (0, 0.45, 1)
DENSE = np.linspace(0, 1, 41)


def height(x, y):
    return np.sin(2 * x + 1) * np.cos(3 * y) + x * y


def on_graph(x, y):
    x, y = np.broadcast_arrays(x, y)
    return np.stack([x, y, height(x, y)], axis=-1)


def graph_network(pace=lambda k, s: s):
    """Curves of the graph of `height`, each run through at its own pace."""
    along = [lambda s, y=y, j=j: on_graph(pace(j, s), y) for j, y in enumerate(V)]
    over = [lambda s, x=x, i=i: on_graph(x, pace(i + 7, s)) for i, x in enumerate(U)]
    return along, over


def uneven(k, s):
    return s + (0.3, -0.25, 0.4, 0.1, -0.4, 0.2, 0.35)[k % 7] * s * (1 - s)


def by_hand(kind, knots, places):
    """Cardinal functions (places, knots) by SciPy."""
    if kind == "lagrange":
        return np.stack([lagrange(knots, row)(places) for row in np.eye(len(knots))], axis=-1)
    return CubicSpline(knots, np.eye(len(knots)), bc_type="natural")(places)


@pytest.mark.parametrize("kind", ["lagrange", "spline"])
def test_the_surface_is_gordons_formula_and_meets_every_curve(kind):
    surface = GordonSurface(*graph_network(), cardinals_u=kind, cardinals_v=kind, reparametrise="refuse")
    assert_close(surface.network.u_knots, U, atol=1e-14)
    phi, psi = by_hand(kind, U, DENSE), by_hand(kind, V, DENSE)
    across_v = np.einsum("vj,ujc->uvc", psi, on_graph(DENSE[:, None], np.array(V)))
    across_u = np.einsum("ui,ivc->uvc", phi, on_graph(np.array(U)[:, None], DENSE))
    corners = np.einsum("ui,vj,ijc->uvc", phi, psi, on_graph(np.array(U)[:, None], np.array(V)))
    assert_close(surface.grid(DENSE, DENSE), across_v + across_u - corners, atol=1e-13)
    assert_close(surface.grid(DENSE, V), on_graph(DENSE[:, None], np.array(V)), atol=1e-13)
    assert_close(surface.grid(U, DENSE), on_graph(np.array(U)[:, None], DENSE), atol=1e-13)


def test_hermite_cardinals_and_functions_of_ones_own_meet_every_curve():
    a = sp.pi * t / 2
    own = (1 - sp.sin(a), sp.sin(a))
    along = [lambda s, y=y: on_graph(s, y) for y in V]
    over = [lambda s, x=x: on_graph(x, s) for x in (0, 1)]
    surface = GordonSurface(along, over, cardinals_u=own, cardinals_v="hermite")
    assert_close(surface.grid(DENSE, V), on_graph(DENSE[:, None], np.array(V)), atol=1e-13)
    assert_close(surface.grid([0, 1], DENSE), on_graph(np.array([[0], [1]]), DENSE), atol=1e-13)
    with pytest.raises(RsymError, match=r"2 functions of u must be 1 at their own knot .* \[0.0, 1.0\]"):
        GordonSurface(along, over, cardinals_u=(1 - t, t + 1))


def test_formulas_stay_a_formula_that_reproduces_what_the_boolean_sum_must():
    def point(x, y):
        return (x, y, x**5 * y**2 + sp.exp(y) * x**2)

    along = [point(t, y) for y in (0, sp.Rational(1, 2), 1)]
    over = [point(x, t) for x in (0, sp.Rational(1, 3), 1)]
    surface = GordonSurface(along, over)
    # Exact in v up to v**2, in u up to u**2: so both terms, whose other factors are of any degree.
    difference = surface.expression() - sp.Matrix(point(u, v))
    values = sp.lambdify((u, v), list(difference))(*np.random.default_rng(1).uniform(0, 1, (2, 50)))
    assert all(np.abs(one).max() < 1e-14 for one in values)
    assert surface.network.u_knots == (0, 1 / 3, 1)


@pytest.mark.parametrize("cardinals", ["lagrange", "spline"])
def test_curves_at_another_pace_are_all_met(cardinals):
    surface = GordonSurface(*graph_network(uneven), cardinals_u=cardinals, cardinals_v=cardinals)
    net = surface.network
    for at, found in ((V, surface.grid(DENSE, net.v_knots)), (U, surface.grid(net.u_knots, DENSE).swapaxes(0, 1))):
        axis = 0 if at is V else 1
        places = found[..., axis]
        assert_close(found[..., 1 - axis], np.broadcast_to(np.array(at), places.shape), atol=1e-12)
        assert_close(found[..., 2], height(found[..., 0], found[..., 1]), atol=1e-12)
        assert_close(places[[0, -1]], np.repeat([[0.0], [1.0]], len(at), axis=1), atol=1e-13)
        assert (np.diff(places, axis=0) > 0).all()


def test_derivatives_of_curves_at_another_pace_are_those_of_the_composition():
    surface = GordonSurface(*graph_network(uneven))
    v1, h = surface.network.v_knots[1], 2e-4
    places = np.array([0.11, 0.52, 0.93])
    for order in (1, 2):
        stencil = [surface.derivative(places + k * h, v1, (order - 1, 0)) for k in (-2, -1, 1, 2)]
        expected = (stencil[0] - 8 * stencil[1] + 8 * stencil[2] - stencil[3]) / (12 * h)
        assert_close(surface.derivative(places, v1, (order, 0)), expected, atol=1e-9)


@pytest.mark.slow
def test_a_curve_at_another_pace_has_the_derivatives_of_the_composition_to_order_four():
    point, pace = (sp.sin(2 * t), sp.exp(t), t**4), t / 3 + t**2 / 5 + t**3 / 7
    coefficients = np.array([[1 / 7], [1 / 5], [1 / 3], [0]])
    curve = Composed(Formula(point), Polynomials(PPoly(coefficients, [0, 1])))
    exact = [sp.sympify(one).subs(t, pace) for one in point]
    for order in range(5):
        expected = [one.diff(t, order).subs(t, 0.6) for one in exact]
        assert_close(curve(0.6, order), np.array(expected, float), atol=1e-12)
    assert_close(np.array([one.subs(t, 0.6) for one in curve.expressions()], float), curve(0.6), atol=1e-14)


@pytest.mark.parametrize("closed", [False, True])
def test_paces_increase_through_their_values_and_are_as_smooth_as_they_can(closed):
    random = np.random.default_rng(4)
    smooth = 0
    for roughness in np.linspace(0.1, 6, 60):
        knots, values = (np.cumsum(np.exp(roughness * random.uniform(size=7))) for _ in range(2))
        knots = (knots - knots[0]) / (knots[-1] - knots[0])
        pace = increasing(knots, values, closed=closed)
        assert_close(pace(knots), values, rtol=1e-14)
        below, dense = np.nextafter(knots[1:], 0), np.linspace(0, 1, 2001)
        starts = np.append(knots[1:-1], knots[0] if closed else knots[-1])
        scale = np.abs(pace(dense, 1)).max()
        assert_close(pace(below, 1), pace(starts, 1), atol=1e-11 * scale)
        assert (pace(dense, 1) > 0).all()
        jump = np.abs(pace(below, 2) - pace(starts, 2)).max() / np.abs(pace(dense, 2)).max()
        assert jump < 1e-12 or jump > 1e-3
        smooth += jump < 1e-12
    assert 10 < smooth < 50


def test_without_another_pace_the_worst_pair_is_named():
    along, over = graph_network(uneven)
    with pytest.raises(RsymError) as caught:
        GordonSurface(along, over, reparametrise="refuse")
    error = caught.value
    assert error.code == "network"
    assert error.where.startswith("the pair (v-curve ")
    i, j = (int(part.split()[-1].strip(")")) for part in error.where.removesuffix(")").split(","))
    # On its own pace the u-curve j is at x = U[i] where uneven(j, s) is.
    s = np.interp(U[i], uneven(j, np.linspace(0, 1, 100001)), np.linspace(0, 1, 100001))
    assert f"meet at u = {s:.3f}" in error.message


def test_a_pair_that_does_not_meet_is_named_with_distance_and_parameters():
    along = [(2 * t, y, 0) for y in (0, 1, 2)]
    over = [(0, 2 * t, 0), (sp.Rational(1, 2), 2 * t, t * (1 - t) / 2), (2, 2 * t, 0)]
    with pytest.raises(RsymError, match=r"smallest distance is 0.125, at u = 0.25 and v = 0.5") as caught:
        GordonSurface(along, over)
    assert caught.value.where == "the pair (v-curve 1, u-curve 1)"


@pytest.mark.parametrize(
    ("along", "over", "message"),
    [
        (
            [(t, 0, 0), (t, 1, 0)],
            [(1, t, 0), (0, t, 0)],
            "the u-curve 0 meets the v-curve 0 at u = 1 and .* sort the v-curves",
        ),
        ([(t, 0, 0), (1 - t, 1, 0)], [(0, t, 0), (1, t, 0)], "the u-curve 1 meets .* run the same way"),
        (
            [(t, 0, 0), (t, 1, 0)],
            [(0.3 * t, 2 * t**2 - t, 0), (1, t, 0)],
            r"meet 2 times: .* and \(u, v\) = \(0.15, 0.5\)",
        ),
        (
            [(sp.cos(2 * sp.pi * t), sp.sin(2 * sp.pi * t), z) for z in (0, 1)],
            [(1, 0, t), (-1, 0, t)],
            "the u-curves are closed; three v-curves across them are the least, got 2",
        ),
        ([(t, 0, 0)], [(0, t, 0), (1, t, 0)], "the u-curves: expected a sequence of 2 or more, got 1"),
    ],
)
def test_networks_that_are_no_grid_are_refused(along, over, message):
    with pytest.raises(RsymError, match=message):
        GordonSurface(along, over)


def test_what_lies_beyond_the_outermost_curves_is_cut_off():
    along = [lambda s, y=y: on_graph(1.5 * s - 0.3, y) for y in V]
    over = [lambda s, x=x: on_graph(x, 2 * s - 0.5) for x in U]
    surface = GordonSurface(along, over)
    assert_close(surface.domain, ((0.2, 1.3 / 1.5), (0.25, 0.75)), atol=1e-14)
    corners = surface.grid(*surface.domain)
    assert_close(corners, on_graph(np.array([[0], [1]]), np.array([0, 1])), atol=1e-13)


def test_given_knots_are_kept():
    along, over = graph_network()
    surface = GordonSurface(along, over, u_knots=range(4), v_knots=range(3))
    assert surface.domain == ((0, 3), (0, 2))
    assert_close(surface.grid(range(4), range(3)), on_graph(np.array(U)[:, None], np.array(V)), atol=1e-13)
    places = surface(np.linspace(0, 3, 50), 1.0)
    assert_close(places[:, 2], height(places[:, 0], 0.45), atol=1e-12)
    with pytest.raises(RsymError, match="u_knots lie outside"):
        GordonSurface(along, over, u_knots=range(4), v_knots=V, reparametrise="refuse")


def torus(a, b):
    a, b = np.broadcast_arrays(a, b)
    r = 3 + np.cos(b)
    return np.stack([r * np.cos(a), r * np.sin(a), np.sin(b) + np.cos(2 * a)], axis=-1)


@pytest.mark.parametrize("shift", [0, 0.13])
def test_closed_families_close_twice_smoothly(shift):
    """Also where the curves do not start at one another."""
    full = 2 * np.pi
    us, vs = np.arange(6) / 6 + shift, np.arange(5) / 5 + shift / 2
    along = [lambda s, b=b: torus(full * s, full * b) for b in vs]
    over = [lambda s, a=a: torus(full * a, full * s) for a in us]
    surface = GordonSurface(along, over)
    assert surface.closed == (True, True)
    (u0, u1), (v0, v1) = surface.domain
    assert_close((u1 - u0, v1 - v0), (1, 1), atol=1e-14)
    assert_close(surface.grid(us, DENSE), torus(full * us[:, None], full * DENSE), atol=1e-12)
    assert_close(surface.grid(DENSE, vs), torus(full * DENSE[:, None], full * vs), atol=1e-12)
    for order, size in (((0, 0), 1e-12), ((1, 0), 1e-9), ((1, 1), 1e-8), ((2, 0), 1e-6)):
        assert_close(surface.derivative(u1, DENSE, order), surface.derivative(u0, DENSE, order), atol=size)
        back = order[::-1]
        assert_close(surface.derivative(DENSE, v1, back), surface.derivative(DENSE, v0, back), atol=size)


def test_closed_curves_at_uneven_paces_close_c2():
    full = 2 * np.pi
    rings = [lambda s, j=j: torus(full * (s + 0.1 * j + 0.02 * j * np.sin(full * s)), 0.5 + j) for j in range(3)]
    over = [lambda s, a=a: torus(a, 0.5 + 2 * s) for a in full * np.arange(5) / 5]
    surface = GordonSurface(rings, over)
    assert surface.closed == (True, False)
    (u0, u1), _ = surface.domain
    for order, size in (((0, 0), 1e-12), ((1, 0), 1e-8), ((0, 1), 1e-9), ((2, 0), 1e-6)):
        assert_close(surface.derivative(u1, DENSE, order), surface.derivative(u0, DENSE, order), atol=size)
    for number in range(5):
        found = surface(surface.network.u_knots[number], DENSE)
        b = np.arctan2(found[:, 2] - np.cos(4 * np.pi * number / 5), np.hypot(found[:, 0], found[:, 1]) - 3)
        assert_close(found, torus(full * number / 5, b), atol=1e-12)


@pytest.mark.slow
@pytest.mark.parametrize("pace", [t, t + sp.sin(2 * sp.pi * t) / 20])
def test_closed_families_of_formulas_are_formulas_wherever_they_start(pace):
    a = 2 * sp.pi * pace
    rings = [(sp.cos(2 * sp.pi * t), sp.sin(2 * sp.pi * t), 0), (2 * sp.cos(a), 2 * sp.sin(a), 1)]
    over = [((1 + t) * sp.cos(b), (1 + t) * sp.sin(b), t) for b in (1, 3, 5)]
    surface = GordonSurface(rings, over)
    assert surface.closed == (True, False)
    point = sp.lambdify((u, v), list(surface.expression()))
    for place in ((0.2, 0.3), (0.7, 0.5), (1.1, 0.9)):
        assert_close(surface(*place), point(*place), atol=1e-12)


def test_data_that_meet_roughly_are_met_within_the_tolerance():
    along = [(t, y, sp.Rational(y, 10**5)) for y in (0, 1)]
    over = [(x, t, 0) for x in (0, 1)]
    with pytest.raises(RsymError, match="smallest distance is 1e-05"):
        GordonSurface(along, over)
    surface = GordonSurface(along, over, tolerance=1e-4, reparametrise="refuse")
    assert_close(surface.grid([0, 1], DENSE)[..., 2], np.zeros((2, 41)), atol=1e-15)
    assert_close(surface(DENSE, 1)[:, 2], np.zeros(41), atol=1.1e-5)


def test_a_last_curve_that_is_the_first_again_is_left_out():
    full = 2 * np.pi
    rings = [(sp.cos(full * t), sp.sin(full * t), z) for z in (0, 1)]
    over = [(sp.cos(a), sp.sin(a), t) for a in (0, 2 * sp.pi / 3, 4 * sp.pi / 3, 2 * sp.pi)]
    surface = GordonSurface(rings, over)
    assert surface.closed == (True, False)
    assert surface.network.v_curves.shape[0] == 3
    # An open surface once around: the first and last curve meet every ring at both of its ends.
    seamed = GordonSurface(rings, over, closed=(False, False))
    assert seamed.closed == (False, False)
    assert_close(seamed.network.u_knots, np.arange(4) / 3, atol=1e-14)
    assert_close(seamed.grid([0, 1], [0.5])[:, 0], [[1, 0, 0.5]] * 2, atol=1e-14)
    with pytest.raises(RsymError, match=r"the u-curve 0 is not closed: it starts at \(0.0, 0.0, 0.0\) and ends at"):
        GordonSurface([(t, 0, 0), (t, 1, 0)], [(0, t, 0), (1, t, 0)], closed=(True, False))


@pytest.mark.slow
def test_poles_are_curves_of_one_point():
    parallels = [(sp.cos(b) * sp.cos(t), sp.cos(b) * sp.sin(t), sp.sin(b)) for b in (-0.8, 0, 0.7)]
    parallels = [(0, 0, -1), *parallels, (0, 0, 1)]
    meridians = [(sp.cos(t) * sp.cos(a), sp.cos(t) * sp.sin(a), sp.sin(t)) for a in 2 * sp.pi * np.arange(6) / 6]
    parallels = [Formula(one, domain=(0, 2 * np.pi)) for one in parallels]
    meridians = [Formula(one, domain=(-np.pi / 2, np.pi / 2)) for one in meridians]
    surface = GordonSurface(parallels, meridians)
    points = surface.grid(np.linspace(0, 2 * np.pi, 30), np.linspace(-np.pi / 2, np.pi / 2, 20))
    assert_close(points[:, [0, -1]], np.tile([[0.0, 0, -1], [0, 0, 1]], (30, 1, 1)), atol=1e-14)
    assert_close(np.linalg.norm(points, axis=-1), np.ones((30, 20)), atol=2e-3)
    assert_close(surface.normal(0.4, np.pi / 2), [0, 0, 1], atol=1e-6)


def test_letters_move_the_surface_but_not_the_curves_apart():
    h = sp.Symbol("h")
    along = [(t, y, h * t * y) for y in (0, 1)]
    over = [(x, t, h * x * t) for x in (0, sp.Rational(1, 2), 1)]
    surface = GordonSurface(along, over, letters={h: 1})
    assert_close(surface(0.5, 0.5, letters={"h": 8})[2], 2, atol=1e-14)
    over[1] = (sp.Rational(1, 2), t, t / 2)
    parted = GordonSurface(along, over, letters={h: 1})
    with pytest.raises(RsymError, match=r"these letters part the u-curve 1 and the v-curve 1 by 0.5 at u = 0.5, v = 1"):
        parted(0.5, 0.5, letters={"h": 2})
