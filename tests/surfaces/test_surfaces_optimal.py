"""Energies against double integrals of the patch itself, optima against a minimiser that knows only those."""

from math import comb

import numpy as np
import pytest
import sympy as sp
from oracles.closeness import assert_close
from scipy.integrate import quad
from scipy.optimize import minimize_scalar

from rsym.errors import RsymError
from rsym.model.letters import Letter
from rsym.surfaces.blends.blending import HermiteBlend
from rsym.surfaces.coons.bicubic import BicubicCoons
from rsym.surfaces.coons.energies import energy
from rsym.surfaces.coons.exact import sphere_octant
from rsym.surfaces.coons.optimal import _least_in_box, optimal_parameters
from rsym.surfaces.symbols import t

LAM, MU, NU = sp.symbols("lambda mu nu")
QUARTER = np.pi / 2
# Its third derivative goes as t**(-2/3).
ROUGH = (10 * t ** sp.Rational(7, 3) - 7 * t ** sp.Rational(10, 3)) / 3
STRETCH, BENDING, JERK = np.eye(3).tolist()


def random_matrix(seed):
    return np.random.default_rng(seed).normal(size=(4, 4, 3))


def double_integral(patch, weights, letters=None):
    """By Gauss's rule on the derivatives of the patch."""
    places, rule = np.polynomial.legendre.leggauss(24)
    u, rule = (places + 1) / 2, rule / 2
    total = 0.0
    for k in (k for k, weight in enumerate(weights, 1) if weight):
        orders = [(i, k - i) for i in range(k + 1)]
        for (i, _), derivative in zip(orders, patch.derivatives(u[:, None], u, orders, letters=letters), strict=True):
            total += weights[k - 1] * comb(k, i) * np.einsum("uvc,uvc,u,v->", derivative, derivative, rule, rule)
    return total


def class1(value=0.5):
    return HermiteBlend.class1(LAM, QUARTER, letters={LAM: value})


def class2(value=1.0):
    return HermiteBlend.class2(MU, QUARTER, letters={MU: value})


def step(blend):
    """Z = F1(u), so that the energies are integrals of squares of derivatives of F1."""
    matrix = np.zeros((4, 4, 3))
    matrix[1, :2, 2] = 1
    return BicubicCoons(matrix, blend_u=blend)


@pytest.mark.random
@pytest.mark.parametrize("weights", [STRETCH, BENDING, JERK, (0.3, 1.0, 0.02)])
def test_energies_are_double_integrals(weights):
    patch = BicubicCoons(random_matrix(1), class1(-3), class2(2))
    assert_close(energy(patch, weights), double_integral(patch, weights), rtol=1e-12)
    letters = {"lambda": 12.0, "mu": -7.0}
    assert_close(energy(patch, weights, letters=letters), double_integral(patch, weights, letters), rtol=1e-11)


def test_energies_of_class_three_and_of_a_matrix_with_letters():
    matrix = np.random.default_rng(2).normal(size=(6, 6, 3))
    patch = BicubicCoons(matrix)
    assert_close(energy(patch), double_integral(patch, BENDING), rtol=1e-12)
    a = sp.Symbol("a")
    given = random_matrix(3).tolist()
    given[2][2][1] = a**2
    slanted = BicubicCoons(given, letters={a: 2})
    for value in (2.0, -0.5):
        expected = double_integral(slanted, BENDING, {"a": value})
        assert_close(energy(slanted, letters={"a": value}), expected, rtol=1e-12)


def test_the_closed_facts_of_the_step():
    for mu in (-12, 0, 2.5):
        assert_close(energy(step(class2()), letters={"mu": mu}), 12 + 4 * mu**2 / 7, rtol=1e-12)
    assert_close(optimal_parameters(step(class2())).parameters["mu"], 0, atol=1e-12)
    assert_close(optimal_parameters(step(class2()), weights=JERK).parameters["mu"], 0.5, atol=1e-12)
    assert_close(optimal_parameters(step(class1())).parameters["lambda"], 0, atol=1e-9)
    assert_close(optimal_parameters(step(class1()), weights=JERK).parameters["lambda"], 3.98, atol=5e-3)


def test_the_hermite_basis_of_arcs_is_least_in_the_functional_it_belongs_to():
    """c(t; alpha) minimises the integral of f''**2 - alpha**2 f'**2 among all f with its ends."""

    def functional(blend):
        def integrand(place):
            return blend(place, 2)[1] ** 2 - QUARTER**2 * blend(place, 1)[1] ** 2

        return quad(integrand, 0, 1, epsabs=1e-12)[0]

    least = functional(HermiteBlend.class1(1, QUARTER))
    assert all(
        functional(blend) > least + 1e-6 for blend in (HermiteBlend.class1(0.5, QUARTER), HermiteBlend.class2(1, 1))
    )


@pytest.mark.random
@pytest.mark.parametrize("weights", [STRETCH, BENDING, JERK])
@pytest.mark.parametrize("make", [class1, class2, lambda: HermiteBlend.trigonometric(NU, letters={NU: 0.2})])
def test_one_direction_against_a_minimiser(make, weights):
    patch = BicubicCoons(random_matrix(4), blend_v=make())
    (name,) = patch.letters
    best = optimal_parameters(patch, weights=weights)
    low, high = map(float, make().monotone_range())
    found = minimize_scalar(
        lambda value: double_integral(patch, weights, {name: value}), bounds=(low, high), method="bounded"
    )
    assert_close(best.after, double_integral(patch, weights, best.parameters), rtol=1e-10)
    assert best.after <= found.fun * (1 + 1e-12)
    assert_close(best.parameters[name], found.x, atol=1e-3 * (high - low))
    assert low <= best.parameters[name] <= high
    assert best.after <= best.before
    assert_close(best.before, double_integral(patch, weights), rtol=1e-11)


def test_both_directions_and_one_parameter_for_both_are_stationary():
    both = BicubicCoons(random_matrix(1), class1(), class2())
    common = BicubicCoons(random_matrix(2), class2(), class2())
    for patch in (both, common):
        best = optimal_parameters(patch, monotone=False)
        assert_close(best.after, double_integral(patch, BENDING, best.parameters), rtol=1e-10)
        for name, place in best.parameters.items():
            around = [double_integral(patch, BENDING, {**best.parameters, name: place + h}) for h in (-1.0, 1.0)]
            assert min(around) > best.after
            # a quadratic, or a quartic with three roots, is nearly even about its minimum
            assert abs(around[0] - around[1]) < 0.2 * (sum(around) - 2 * best.after)


def test_of_two_valleys_the_deeper_is_found_from_the_other():
    """(pq - 1)**2 + ((p - 1)**2 + (q - 1)**2)/10 is 0 at (1, 1), and least nearby at p = q = -(1 + sqrt(0.6))/2."""
    table = np.array([[1.2, -0.2, 0.1], [-0.2, -2.0, 0.0], [0.1, 0.0, 1.0]])
    other = -(1 + np.sqrt(0.6)) / 2
    everywhere = (-np.inf, np.inf)
    assert_close(_least_in_box(table, (everywhere, everywhere), (other, other)), [1, 1], atol=1e-9)
    assert_close(_least_in_box(table, (everywhere, (-5.0, 0.0)), (1.0, -1.0)), [other, other], atol=1e-9)


def test_the_best_is_global():
    for seed in range(8):
        patch = BicubicCoons(random_matrix(seed), class2(), HermiteBlend.class2(NU, QUARTER, letters={NU: 0}))
        best = optimal_parameters(patch)
        table, grid = best.coefficients, np.linspace(-12, 3, 151)
        powers = grid[:, None] ** np.arange(3)
        assert best.after <= (powers @ table @ powers.T).min() * (1 + 1e-12)


def test_what_lies_beyond_the_range_stops_at_its_end():
    matrix = np.zeros((4, 4, 3))
    matrix[1, :2, 2], matrix[2:, :2, 2] = 1.0, 0.7  # F1 + 0.7 (G0 + G1), where mu changes little
    blend = HermiteBlend.class2(MU, QUARTER, letters={MU: Letter(0, minimum=-2, maximum=2)})
    free = optimal_parameters(BicubicCoons(matrix, blend_u=class2()), weights=STRETCH, monotone=False)
    kept = optimal_parameters(BicubicCoons(matrix, blend_u=class2()), weights=STRETCH)
    narrow = optimal_parameters(BicubicCoons(matrix, blend_u=blend), weights=STRETCH, monotone=False)
    assert not free.clipped
    assert not -12 <= free.parameters["mu"] <= 3
    assert kept.parameters["mu"] in (-12, 3)
    assert narrow.parameters["mu"] in (-2, 2)
    assert kept.clipped == narrow.clipped == ("mu",)
    assert free.after < kept.after < narrow.after < narrow.before


def test_on_a_sphere_every_parameter_is_as_good_and_none_is_moved():
    octant = sphere_octant(1, blend_u=class2(1.25), blend_v=HermiteBlend.trigonometric(NU, letters={NU: 0.5}))
    best = optimal_parameters(octant)
    assert best.parameters == {"mu": 1.25, "nu": 0.5}
    assert_close(best.after, best.before, rtol=1e-12)


def test_the_new_patch_has_the_best_values_as_defaults():
    a = sp.Symbol("a")
    given = random_matrix(5).tolist()
    given[0][0][0] = a
    patch = BicubicCoons(given, blend_u=class1(), blend_v=class2(), letters={a: 1})
    best = optimal_parameters(patch, ["mu"], letters={"a": 3})
    assert best.patch.letters["mu"].default == best.parameters["mu"]
    assert best.patch.letters["lambda"].default == 0.5
    assert_close(energy(best.patch), best.after, rtol=1e-12)
    assert_close(best.patch(0.3, 0.7), patch(0.3, 0.7, letters={"a": 3, "mu": best.parameters["mu"]}), atol=1e-13)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: optimal_parameters(BicubicCoons(random_matrix(1))), "must be letters of the blends"),
        (lambda: optimal_parameters(step(class2()), ["lam"]), "letters of the blends, got lam"),
        (lambda: optimal_parameters(step(class2()), weights=(0, 0, 0)), "three numbers >= 0, not all 0"),
        (lambda: optimal_parameters(step(HermiteBlend.class1(1, NU, letters={NU: 1})), [NU]), "not linear in 'nu'"),
        (lambda: energy(None), "the energy is that of a BicubicCoons, got NoneType"),
        (lambda: energy(step(HermiteBlend.from_smoothstep(ROUGH, 1)), JERK), "infinite, or too rough"),
    ],
)
def test_what_has_no_optimum_is_refused(make, message):
    with pytest.raises(RsymError, match=message):
        make()
