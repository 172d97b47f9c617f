"""Plates whose deflection or frequency is known: round, with a hole, square, clamped, supported and free."""

import math

import numpy as np
import pytest
import sympy as sp
from scipy.optimize import brentq
from scipy.special import iv, ivp, jv, jvp

import rsym
from rsym import x, y

RIM = rsym.disc(1).named("rim")
RING = RIM - rsym.disc(sp.Rational(1, 2)).named("bore")
SQUARE = rsym.half_plane((1, 0), 0) & rsym.half_plane((-1, 0), -1)
SQUARE = (SQUARE & rsym.half_plane((0, 1), 0) & rsym.half_plane((0, -1), -1)).replace(bounds=((0, 1), (0, 1)))
EDGES = {"clamped": rsym.clamped(), "supported": rsym.supported()}


def bilaplacian(u):
    def laplacian(u):
        return u.diff(x, 2) + u.diff(y, 2)

    return laplacian(laplacian(u))


@pytest.mark.parametrize("degree", [3, 4, 5])
def test_energies_fall_by_twice_the_degree_less_one(degree):
    """Of what vanishes with its slope the energy of the error is the integral of f*(u - u_h)."""
    u = (1 - x**2 - 2 * y**2) ** 2 * sp.cos(3 * x + 4 * y)
    load = bilaplacian(u)
    shape = rsym.Shape(1 - x**2 - 2 * y**2, (x, y))
    errors = []
    for cells in (8, 16):
        found = rsym.solve(shape, "bilaplacian(u) = f", rsym.clamped(), letters={"f": load}, cells=cells, degree=degree)
        points, weights = found.rule.points, found.rule.weights
        exact, force = sp.lambdify((x, y), [u, load])(*points.T)
        errors.append(
            abs(np.sum(weights * force * (exact - found.jets(points, 0)[0])) / np.sum(weights * force * exact))
        )
    assert math.log2(errors[0] / errors[1]) > 2 * (degree - 1) - 0.4
    assert errors[1] < (2e-5, 2e-7, 1e-9)[degree - 3]


@pytest.mark.parametrize("ratio", [0, 0.3])
def test_a_round_plate_that_is_supported(ratio):
    found = rsym.solve(RIM, "bilaplacian(u) = 64", rsym.supported(), poisson=ratio, cells=8)
    r2 = np.array([0.0, 0.25, 0.8])
    exact = (1 - r2) * ((5 + ratio) / (1 + ratio) - r2)
    np.testing.assert_allclose(found(np.sqrt(r2), 0), exact, rtol=1e-11)
    across, _, along = np.moveaxis(found.hessian(0.6, [0.8, 0.0]).reshape(2, 4)[:, [0, 1, 3]], -1, 0)
    second = -2 * ((5 + ratio) / (1 + ratio) + 1)  # of (1 - r2)*(c - r2), at the middle
    np.testing.assert_allclose([across[1], along[1]], [second + 12 * 0.36, second + 4 * 0.36], rtol=1e-9)
    # No moment across the rim, whose normal is (0.6, 0.8) there.
    curvatures = found.hessian(0.6, 0.8)
    n, t = np.array([0.6, 0.8]), np.array([-0.8, 0.6])
    assert abs(n @ curvatures @ n + ratio * (t @ curvatures @ t)) < 1e-8


@pytest.mark.parametrize("rim", EDGES)
def test_a_hole_with_a_free_edge(rim):
    """u = r**4 + a + b r**2 + c log r + d r**2 log r for the load 64; at the bore neither moment nor force."""
    nu, r = 0.3, sp.Symbol("r", positive=True)
    parts = [r**4, sp.S.One, r**2, sp.log(r), r**2 * sp.log(r)]

    def moment(w):
        return w.diff(r, 2) + nu * w.diff(r) / r

    def force(w):
        return (w.diff(r, 2) + w.diff(r) / r).diff(r)

    at_rim = (lambda w: w.diff(r)) if rim == "clamped" else moment
    rows = [[f(w).subs(r, at) for w in parts] for f, at in ((lambda w: w, 1), (at_rim, 1), (moment, 0.5), (force, 0.5))]
    table = np.array(rows, float)
    exact = sp.lambdify(
        r, sum(c * w for c, w in zip([1, *np.linalg.solve(table[:, 1:], -table[:, 0])], parts, strict=True))
    )
    found = rsym.solve(RING, "bilaplacian(u) = 64", {"rim": EDGES[rim]}, poisson=nu, cells=24, degree=5)
    at = np.array([0.5, 0.6, 0.8])
    np.testing.assert_allclose(found(0.6 * at, 0.8 * at), exact(at), rtol=1e-6)


def test_the_middle_of_a_square():
    clamped = rsym.solve(SQUARE, "bilaplacian(u) = 1", rsym.clamped(), cells=16)
    assert abs(clamped(0.5, 0.5) - 0.00126531908) < 1.5e-11
    series = sum(
        16 / math.pi**6 * math.sin(m * math.pi / 2) * math.sin(n * math.pi / 2) / (m * n * (m * m + n * n) ** 2)
        for m in range(1, 200, 2)
        for n in range(1, 200, 2)
    )
    supported = rsym.solve(SQUARE, "bilaplacian(u) = 1", rsym.supported(), cells=16)
    assert abs(supported(0.5, 0.5) - series) < 2e-11
    turned = rsym.solve(SQUARE.rotate(0.3), "bilaplacian(u) = 1", rsym.supported(), cells=16)
    c, s = math.cos(0.3), math.sin(0.3)
    assert abs(turned(0.5 * (c - s), 0.5 * (c + s)) - series) < 2e-9


def test_values_and_slopes_on_clamped_edges():
    u = sp.exp(x) * sp.cos(y)
    found = rsym.solve(RIM, "bilaplacian(u) = 0", rsym.clamped(u, x * u.diff(x) + y * u.diff(y)), cells=16)
    np.testing.assert_allclose(found([0.3, -0.5], [0.2, 0.1]), np.exp([0.3, -0.5]) * np.cos([0.2, 0.1]), rtol=1e-8)


def test_slopes_whose_formula_has_a_pole_inside():
    """A normal by the gradient of a leaf has none in the middle, where nobody gave a slope."""
    leaf, u = 1 - x**2 - 2 * y**2, sp.exp(x) * sp.cos(y)
    slope = [leaf.diff(one) for one in (x, y)]
    outward = -(slope[0] * u.diff(x) + slope[1] * u.diff(y)) / sp.sqrt(slope[0] ** 2 + slope[1] ** 2)
    found = rsym.solve(rsym.Shape(leaf, (x, y)), "bilaplacian(u) = 0", rsym.clamped(u, outward), cells=24)
    apart = found.jets(found.rule.points, 0)[0] - sp.lambdify((x, y), u)(*found.rule.points.T)
    assert np.abs(apart).max() < 2e-3


def test_round_plates_ring():
    """(beta*r)**2: J_0 I_1 + I_0 J_1 = 0, and J_1/J_0 + I_1/I_0 = 2 beta/(1 - nu) of the least of each."""
    clamped = brentq(lambda b: jv(0, b) * iv(1, b) + iv(0, b) * jv(1, b), 3, 3.5, xtol=1e-15) ** 4
    supported = brentq(lambda b: (jv(1, b) / jv(0, b) + iv(1, b) / iv(0, b)) * 0.7 - 2 * b, 2, 2.39, xtol=1e-15) ** 4
    assert abs(clamped - 104.363105559) < 1e-8
    for edge, exact in ((rsym.clamped(), clamped), (rsym.supported(), supported)):
        found = rsym.modes(RIM, 1, edge, equation="bilaplacian(u) = 0", poisson=0.3, cells=12, degree=5)
        assert abs(found.values[0] / exact - 1) < 1e-9
    square = rsym.modes(SQUARE, 1, rsym.supported(), equation="bilaplacian(u) = 0", cells=8)
    assert abs(square.values[0] / (4 * math.pi**4) - 1) < 1e-8


def test_a_free_plate_has_three_rigid_modes():
    """Then come two of w = (J_2(beta*r) + c*I_2(beta*r))*cos(2*angle) without moment and force on the rim."""
    nu, n = 0.33, 2

    def on_rim(f, derivative, sign, b):
        w, slope = f(n, b), b * derivative(n, b, 1)
        moment = b * b * derivative(n, b, 2) + nu * (slope - n * n * w)
        return moment, sign * b * b * slope - (1 - nu) * n * n * (slope - w)

    def both(b):
        return np.linalg.det([on_rim(jv, jvp, -1, b), on_rim(iv, ivp, 1, b)])

    exact = brentq(both, 2, 2.6, xtol=1e-15) ** 4
    found = rsym.modes(RIM, 5, {}, equation="bilaplacian(u) = 0", poisson=nu, cells=16, degree=5).values
    assert np.abs(found[:3]).max() < 1e-7
    np.testing.assert_allclose(found[3:], exact, rtol=1e-7)


@pytest.mark.parametrize(
    ("equation", "conditions", "more", "code", "words"),
    [
        ("bilaplacian(u) = 1", 0, {}, "condition", "a value alone"),
        ("bilaplacian(u) = 1", {"rim": rsym.clamped(), "bore": rsym.neumann(1)}, {}, "condition", "a flux alone"),
        ("bilaplacian(u) = 1", rsym.supported(), {}, "material", "Poisson"),
        ("bilaplacian(u) = 1", {"rim": rsym.clamped()}, {}, "material", "Poisson"),
        ("bilaplacian(u) = 1", {}, {"poisson": 0.3}, "singular", "as a whole"),
        ("bilaplacian(u) = 1", rsym.clamped(), {"poisson": 1.5}, "material", "1.5"),
        ("bilaplacian(u) = 1", rsym.clamped(), {"axis": x}, "equation", "plane"),
        ("-laplacian(u) = 1", rsym.clamped(), {}, "condition", "order 2"),
    ],
)
def test_what_is_no_plate_is_refused(equation, conditions, more, code, words):
    with pytest.raises(rsym.RsymError, match=words) as raised:
        rsym.solve(RING, equation, conditions, **more, cells=8)
    assert raised.value.code == code
    assert raised.value.remedy


ELL = rsym.half_plane((1, 0), 0).named("left") & rsym.half_plane((0, 1), 0).named("below")
ELL = ELL & rsym.half_plane((-1, 0), -2) & rsym.half_plane((0, -1), -2)
ELL = ELL & (rsym.half_plane((-1, 0), -1) | rsym.half_plane((0, -1), -1)).named("notch")


@pytest.mark.parametrize(
    ("conditions", "integral"),
    [
        # Of degree 6 on 40 cells; of splines alone, on 24 cells, they are 3e-3, 3e-3, 3e-2 and 5e-4 off.
        (rsym.clamped(), 0.0035785700505),
        ({"notch": rsym.clamped(), ...: rsym.supported()}, 0.0091430090046),
        (rsym.supported(), 0.0124007016334),
        ({"left": rsym.clamped(), "below": rsym.clamped()}, 0.0928901028143),
    ],
)
def test_the_corner_of_an_ell(conditions, integral):
    found = rsym.solve(ELL, "bilaplacian(u) = 1", conditions, poisson=0.3, cells=24)
    assert abs(found.integral() / integral - 1) < 1e-6
    assert found.report.estimate < 1e-5
    assert found.report.left == 0


def test_two_discs_clamped_along_their_curved_edges():
    """Deflections from below; by functions that follow edges to the first order alone, 0.0433 on 24 cells."""
    pair = rsym.disc(1) | rsym.disc(1, (1.5, 0))
    found = rsym.solve(pair, "bilaplacian(u) = 1", rsym.clamped(), cells=24)
    assert 0 < 1 - found.integral() / 0.0421877 < 1e-3  # 0.04218733 on 48 cells, of degree 6 on 40 0.04218765
    edge = np.linspace(1, 5, 50)
    on = np.transpose([np.cos(edge), np.sin(edge)])
    np.testing.assert_allclose(found.jets(on, 1), 0, atol=1e-14)


def test_how_a_plate_with_a_notch_rings():
    """The order of convergence is not that of the corner, which is 1.09: of degree 4 on 12 cells as on 20."""
    few, more = (
        rsym.modes(ELL, 2, rsym.clamped(), equation="bilaplacian(u) = 0", cells=cells, estimate=False).values
        for cells in (12, 20)
    )
    np.testing.assert_allclose(few, more, rtol=2e-5)
