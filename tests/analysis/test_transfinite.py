"""Transfinite interpolation by weights: shares add up, are 1 on their part, and nothing is divided by zero."""

import itertools

import mpmath
import numpy as np
import pytest
import sympy as sp

import rsym
from rsym import x, y, z
from rsym.analysis.transfinite import OnPart, inverse_distances, joined_weights, taylor

BLENDS = [inverse_distances, joined_weights]
WEIGHTS = [x, y, z]  # distances in the octant x, y, z >= 0
MARKS = sp.symbols("u v w", real=True)


def kernel(expression, fields=("value",), dtype="float64"):
    letters = dict.fromkeys(MARKS, 0)
    return rsym.compile(rsym.Shape(expression, (x, y, z), letters=letters), fields, dtype=dtype)


def shares(blend, power, points):
    """The share of each of three functions: the value where it is 1 and the others 0."""
    pieces = [OnPart(mark, weight) for mark, weight in zip(MARKS, WEIGHTS, strict=True)]
    function = kernel(blend(pieces, power))
    return np.array([function(*points.T, letters={mark.name: 1})["value"] for mark in MARKS])


@pytest.mark.parametrize("blend", BLENDS)
@pytest.mark.parametrize("power", [1, 2, 4])
def test_shares_are_what_the_formula_says(blend, power):
    points = np.random.default_rng(1).uniform(0.01, 3, (50, 3))
    inverse = points.T**-power
    if blend is joined_weights:
        inverse = 1 / (inverse.sum(axis=0) - inverse)
    expected = inverse / inverse.sum(axis=0)
    assert np.abs(shares(blend, power, points) - expected).max() < 1e-13


@pytest.mark.parametrize("blend", BLENDS)
@pytest.mark.parametrize("power", [2, 4])
@pytest.mark.parametrize("size", [1, 1e-50, 1e30])
def test_on_the_boundary_nothing_is_divided_by_zero_and_shares_add_up(blend, power, size):
    points = size * np.array([[0, 1, 2], [1, 0, 2], [1, 2, 0], [0, 0, 1], [0, 1, 0], [1, 0, 0], [0, 0, 0], [1, 1, 1.0]])
    found = shares(blend, power, points)
    assert np.abs(found.sum(axis=0) - 1).max() < 1e-15
    assert np.abs(found[:, :3] - np.eye(3)).max() < 1e-15
    where_others_meet = found[[2, 1, 0], [3, 4, 5]]
    assert (where_others_meet == 0).all()


@pytest.mark.parametrize("blend", BLENDS)
def test_the_kernels_of_float32_have_the_data_too(blend):
    function = kernel(
        blend([OnPart(s, w) for s, w in zip((y, x + 1, x * y), WEIGHTS, strict=True)], 2), dtype="float32"
    )
    edge = np.float32([[0, 0.3, 0.7], [0.3, 0, 0.7], [0.3, 0.7, 0], [0, 1, 0], [1e-25, 1, 1e-25]])
    found = function(*edge.T)["value"]
    assert np.abs(found - [0.3, 1.3, 0.21, 1, 1]).max() < 1e-6


@pytest.mark.parametrize("power", [2, 4])
def test_derivatives_below_the_power_are_those_of_the_function_of_the_part(power):
    functions = [sp.sin(x + 2 * y), x * y + z, sp.exp(x - z)]
    u = inverse_distances([OnPart(f, w) for f, w in zip(functions, WEIGHTS, strict=True)], power).doit()
    at = {x: sp.Rational(3, 7), y: sp.Rational(1, 3), z: sp.Rational(5, 4)}
    for function, weight in zip(functions, WEIGHTS, strict=True):
        place = {**at, weight: 0}
        s = sp.Symbol("s", positive=True)
        gap = (u - function).subs({one: value for one, value in place.items() if one != weight}).subs(weight, s)
        sizes = [abs(sp.N(gap.subs(s, step), 60)) for step in (sp.Rational(1, 1000), sp.Rational(1, 2000))]
        order = float(sp.log(sizes[0] / sizes[1], 2))
        assert abs(order - power) < 0.02


def test_parts_in_any_number_are_no_longer_than_their_square():
    pieces = [OnPart(sp.Integer(k), x - k) for k in range(20)]
    assert len(sp.sstr(inverse_distances(pieces, 2))) < 20 * 20 * 60
    assert len(sp.sstr(joined_weights(pieces, 2))) < 20 * 20 * 160


@pytest.mark.parametrize("blend", BLENDS)
def test_programs_grow_with_the_number_of_parts(blend):
    sizes = [len(kernel(blend([OnPart(sp.sin(k * y), x - k) for k in range(n)], 2)).program) for n in (8, 16, 32)]
    assert sizes[2] - sizes[1] < 2.1 * (sizes[1] - sizes[0])


SLOPES = [sp.sin(x + 3 * y), x * y, 2 * x - 1, x + 4]


@pytest.mark.parametrize("count", [1, 2, 3, 4])
def test_the_taylor_form_has_the_derivatives_that_are_given(count):
    """On the circle with its exact distance, along the outward normal, by differences from inside with 120 digits."""
    u = taylor(1 - sp.sqrt(x**2 + y**2), (x, y), SLOPES[:count]).doit()
    with mpmath.workdps(120):
        angle, step = mpmath.mpf(7) / 10, mpmath.mpf(10) ** -10
        ray = mpmath.cos(angle), mpmath.sin(angle)
        function = sp.lambdify((x, y), u, "mpmath")
        # Not at the point itself, where the formula says 0 for a product.
        rows = [function(*(way * (1 - (k + step) * step) for way in ray)) for k in range(9)]
        differences, found = [rows[0]], [rows[0]]
        while len(rows) > 1:
            rows = [a - b for a, b in itertools.pairwise(rows)]
            differences.append(rows[0])
        for order in range(1, count):
            # The derivative is (-log(1 - nabla))**order, nabla being the backward difference.
            powers = mpmath.taylor(lambda t, k=order: (-mpmath.log(1 - t)) ** k, 0, len(differences) - 1)
            found.append(mpmath.fdot(powers, differences) / step**order)
        for have, want in zip(found, SLOPES[:count], strict=True):
            assert abs(have - sp.lambdify((x, y), want, "mpmath")(*ray)) < 1e-15
