"""Eigenvalues against exact ones: drums, closed rooms, sloshing."""

import math

import numpy as np
import pytest
import sympy as sp
from scipy.optimize import brentq
from scipy.special import iv, ivp, jn_zeros, jnp_zeros

import rsym
from rsym import y
from rsym.problems.systems import linear

DRUM = jn_zeros(0, 1)[0] ** 2


def robin_root(n):
    """The k of I_n(k*r)*cos(n*angle) with du/dr = 3*u at 1."""
    return brentq(lambda k: k * ivp(n, k) - 3 * iv(n, k), 1, 6)


@pytest.mark.parametrize(("degree", "most"), [(3, (2e-8, 3e-10)), (4, (1e-10, 2e-13)), (5, (1e-12, 5e-15))])
def test_a_drum_by_degree(degree, most):
    for cells, share in zip((8, 16), most, strict=True):
        found = rsym.modes(rsym.disc(1), 1, cells=cells, degree=degree).values[0]
        assert abs(found / DRUM - 1) < share


def test_modes_are_orthogonal_and_of_the_size_one():
    found = rsym.modes(rsym.disc(1), 4, cells=12)
    rule = found.modes[0].rule
    values = np.array([one.jets(rule.points, 0)[0] for one in found.modes])
    np.testing.assert_allclose((values * rule.weights) @ values.T, np.eye(4), atol=1e-8)
    assert np.allclose(found.values, [jn_zeros(k, 2)[j] ** 2 for k, j in ((0, 0), (1, 0), (1, 0), (2, 0))], rtol=1e-6)
    assert found.modes[0](0, 0) > 0


def test_a_closed_room_and_a_ball():
    found = rsym.modes(rsym.disc(1), 3, {}, cells=12).values
    assert abs(found[0]) < 1e-10
    np.testing.assert_allclose(found[1:], jnp_zeros(1, 1)[0] ** 2, rtol=1e-7)
    half = rsym.disc(1).named("rim") & rsym.half_plane((1, 0), 0)
    assert abs(rsym.modes(half, 1, {"rim": 0}, axis=y, cells=12).values[0] / math.pi**2 - 1) < 1e-10


def test_a_tank_sloshes():
    """In a tank of width 1 and depth h the frequencies are k*pi*tanh(k*pi*h)."""
    tank = rsym.rectangle(1, 1) & rsym.half_plane((0, -1), -0.25).named("surface")
    found = rsym.modes(tank, 3, {}, mass={"surface": 1}, cells=12).values
    exact = [0, *(k * math.pi * math.tanh(k * math.pi * 0.75) for k in (1, 2))]
    np.testing.assert_allclose(found, exact, rtol=1e-6, atol=1e-9)


def test_a_tank_with_a_step_sloshes():
    """Functions of the corner have a mass on the surface too."""
    step = rsym.polygon([(0, 0), (2, 0), (2, 2), (1, 2), (1, 1), (0, 1)])
    tank = step & rsym.half_plane((0, -1), -1.75).named("surface")
    found, plain = (rsym.modes(tank, 2, {}, mass={"surface": 1}, cells=24, corners=own).values for own in (True, False))
    np.testing.assert_allclose(found, plain, rtol=2e-3, atol=1e-9)


def test_density_and_tolerance():
    heavy = rsym.modes(rsym.disc(1), 1, mass=4, tolerance=1e-9)
    assert abs(heavy.values[0] * 4 / DRUM - 1) < 1e-9
    assert heavy.grades[-1].estimate < 1e-9


@pytest.mark.parametrize(
    ("conditions", "equation", "exact"),
    [
        # k*I_n'(k) = 3*I_n(k), lambda = -k**2, for n = 0 and, twice, 1.
        (rsym.robin(-3), "-laplacian(u) = 0", [*(-(robin_root(n) ** 2) for n in (0, 1, 1))]),
        (0, "-laplacian(u) - 100*u = 0", [DRUM - 100, *[jn_zeros(1, 1)[0] ** 2 - 100] * 2]),
    ],
)
def test_eigenvalues_below_0_are_the_least(conditions, equation, exact):
    found = rsym.modes(rsym.disc(1), 3, conditions, equation=equation, cells=12).values
    np.testing.assert_allclose(found, exact, rtol=1e-6)


def test_masses_that_are_none_are_refused():
    for mass in (-1, rsym.x, 0):
        with pytest.raises(rsym.RsymError, match="the mass on the shape is from"):
            rsym.modes(rsym.disc(1), 1, mass=mass, cells=8)
    tank = rsym.rectangle(1, 1) & rsym.half_plane((0, -1), -0.25).named("surface")
    with pytest.raises(rsym.RsymError, match="a mass that moves in"):
        rsym.modes(tank, 20, {}, mass={"surface": 1}, cells=4)


def test_what_is_not_homogeneous_is_refused():
    for given in ({"conditions": rsym.neumann(1)}, {"conditions": rsym.constant(1)}, {"equation": "-laplacian(u) = 7"}):
        with pytest.raises(rsym.RsymError, match="fluxes 0"):
            rsym.modes(rsym.disc(1), 1, cells=8, **given)
    with pytest.raises(rsym.RsymError, match="first derivatives, got a value"):
        rsym.modes(rsym.disc(1), 1, 1, cells=8)
    with pytest.raises(rsym.RsymError, match="no part 'rin'"):
        rsym.modes(rsym.disc(1).named("rim"), 1, {}, mass={"rin": 1}, cells=8)


def test_letters_of_a_spectrum():
    r = sp.Symbol("r", real=True)
    drum = rsym.modes(rsym.disc(r, letters={r: 1}), 2, cells=12, mass=2)
    np.testing.assert_allclose(drum.with_letters({"r": 0.5}).values, 4 * drum.values, rtol=1e-9)


HEXAGON = 7.155339133926055  # side 1; Jones, Computing ultra-precise eigenvalues (2017)


def test_functions_of_corners_that_splines_make_up_spoil_no_mode():
    """On fine grids of a high degree functions at flat corners are splines but for rounding."""
    found = rsym.modes(rsym.regular_polygon(6, 1.6), 4, cells=48, degree=6).values
    assert found[0] * 1.6**2 == pytest.approx(HEXAGON, rel=1e-11)
    assert found[1] == pytest.approx(found[2], rel=1e-11)


@pytest.mark.slow
@pytest.mark.parametrize(
    "shape",
    [
        rsym.polygon([(0, -1), (1, 0), (0, 2), (-1, 0)]),
        rsym.regular_polygon(5, 1),
        rsym.regular_polygon(8, 1),
        rsym.regular_polygon(6, 1.2) - rsym.disc(0.34),
    ],
    ids=["kite", "pentagon", "octagon", "holed"],
)
def test_modes_of_polygons_are_those_of_other_cells(shape):
    fine, coarse = (rsym.modes(shape, 3, cells=cells, degree=degree).values for cells, degree in ((40, 6), (24, 4)))
    np.testing.assert_allclose(fine, coarse, rtol=2e-6)


def test_an_eigenvalue_that_would_be_rounding_is_refused(monkeypatch):
    monkeypatch.setattr(linear, "UNSURE", 0.0)
    with pytest.raises(rsym.RsymError, match="would be rounding"):
        rsym.modes(rsym.rectangle(2, 1), 1, cells=8)


TRIANGLE, SQUARE = rsym.regular_polygon(3, 1), rsym.rectangle(2, 2)
SYMMETRIC = {
    "square": (SQUARE.rotate(0.3), None, (1, 4)),
    "pentagon": (rsym.regular_polygon(5, 1), None, (1, 3)),
    "hexagon": (rsym.regular_polygon(6, 1.6).rotate(0.2), {}, (1, 3)),
    "cross": ((rsym.rectangle(3, 1) | rsym.rectangle(1, 3)).rotate(0.3), None, (1,)),
    "clover": (TRIANGLE | rsym.disc(sp.Rational(3, 4)), {}, (1,)),
    "star": (TRIANGLE | TRIANGLE.rotate(sp.pi / 3), None, (1, 3)),
}


@pytest.mark.parametrize("cells", [8, 14])
@pytest.mark.parametrize("name", SYMMETRIC)
def test_eigenvalues_of_symmetric_figures_come_in_pairs_to_their_estimate(name, cells):
    """Nothing is known of the symmetry: on the grid the two of a pair are other functions."""
    shape, conditions, pairs = SYMMETRIC[name]
    found = rsym.modes(shape, 6, conditions, cells=cells, degree=4)
    estimate = found.grades[-1].estimate
    for k in pairs:
        assert abs(found.values[k + 1] - found.values[k]) <= estimate * found.values[k + 1]
    assert estimate < 0.2
