"""Gradients at corners, of one side: limits along the ray on which both operands grow alike."""

import numpy as np
import pytest
import sympy as sp
from oracles.closeness import assert_close

import rsym
from rsym import x, y, z

FIELDS = ("value", "gradient", "normalised_gradient", "gradient_squared", "singular", "hessian")
F, G = x + 2 * y, 3 * x - y
SYSTEMS = [rsym.R0, rsym.RAlpha(sp.Rational(1, 2)), rsym.Rp(3), rsym.Rp(4), rsym.R0m(2)]


def at(expression, *point, at_corners="one-sided", coordinates=(x, y), **options):
    return rsym.compile(rsym.Shape(expression, coordinates), FIELDS, at_corners=at_corners, **options)(*point)


@pytest.mark.random
@pytest.mark.parametrize("system", SYSTEMS, ids=repr)
@pytest.mark.parametrize("operation", ["conjunction", "disjunction"])
@pytest.mark.parametrize("backend", ["llvm", "numpy"])
def test_of_an_r_operation_it_is_the_limit_along_the_ray_of_equal_operands(system, operation, backend):
    expression = getattr(rsym, operation)(F, G, system=system)
    ray = np.array(list(sp.solve([F - 1, G - 1], [x, y]).values()), float)  # f = g = 1 there
    near = at(expression, *(1e-6 * ray), at_corners="nan")["gradient"]
    assert_close(at(expression, 0, 0, backend=backend)["gradient"], near, atol=1e-5)


def test_of_r0_it_is_the_sum_of_both_gradients_in_closed_form():
    found = at(rsym.conjunction(F, G), 0, 0)
    assert_close(found["gradient"], (1 - np.sqrt(0.5)) * np.array([4, 1]), rtol=1e-15)
    assert_close(found["normalised_gradient"], np.array([4, 1]) / np.sqrt(17), rtol=1e-15)
    assert not found["singular"]
    assert np.isnan(found["hessian"]).all()


@pytest.mark.parametrize(
    ("expression", "expected"),
    [
        (sp.Abs(x) + y, [1, 1]),
        (y - sp.Abs(F), [-1, -1]),
        (sp.Min(F, G), [1, 2]),
        (sp.Max(G, F), [3, -1]),
        (y + sp.Piecewise((0, x < 0), (x, True)), [1, 1]),
        (y + sp.Piecewise((0, x <= 0), (x, True)), [0, 1]),
        (x * y + x, [1, 0]),
    ],
)
def test_of_choices_it_is_that_of_the_first_or_the_positive_or_the_one_that_counts(expression, expected):
    found = at(expression, 0, 0)
    got = sorted(map(tuple, [found["gradient"]]))
    options = [tuple(expected)]
    if expression.has(sp.Min, sp.Max):  # SymPy sorts the operands
        options = [(1.0, 2.0), (3.0, -1.0)]
    assert got[0] in options
    assert not found["singular"]


def test_a_corner_of_three_planes_has_a_gradient_into_the_solid():
    octant = rsym.conjunction(rsym.conjunction(x, y), z)
    found = at(octant, 0, 0, 0, coordinates=(x, y, z))
    assert (found["gradient"] > 0).all()
    assert_close(np.linalg.norm(found["normalised_gradient"]), 1, rtol=1e-14)


@pytest.mark.slow
def test_away_from_corners_nothing_changes_not_a_bit():
    shape = rsym.load("car").shape if hasattr(rsym.load("car"), "shape") else rsym.load("car")
    rng = np.random.default_rng(7)
    points = [rng.uniform(low, high, 400) for low, high in shape.box.ends]
    usual = rsym.compile(shape, FIELDS[:5])(*points)
    one = rsym.compile(shape, FIELDS[:5], at_corners="one-sided")(*points)
    for field in FIELDS[:5]:
        assert np.array_equal(usual[field], one[field], equal_nan=True), field


def test_what_has_no_side_and_what_is_undefined_stay_nan():
    assert at(sp.sqrt(x**2 + y**2) - x, 0, 0)["singular"]
    assert at(1 - sp.sqrt(x), 0, 0)["singular"]
    assert at(rsym.conjunction(sp.log(x), y), -1, 0)["singular"]
    assert at(sp.Min(sp.log(x), y), -1, 0)["singular"]


def test_collocation_at_the_corners_of_a_polygon_meets_no_nan():
    polygon = rsym.polygon([(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)])
    fields = ("normalised", "normalised_gradient", "normalised_gradient_squared")
    corners = np.array([(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)], float)
    found = rsym.compile(polygon, fields, at_corners="one-sided")(*corners.T)
    assert (found["normalised"] == 0).all()
    assert_close(found["normalised_gradient_squared"], np.ones(6), rtol=1e-12)


def test_another_choice_is_refused():
    with pytest.raises(rsym.RsymError, match="'nan' or 'one-sided'"):
        at(x * y, 0, 0, at_corners="mean")


@pytest.mark.parametrize(
    "expression",
    [rsym.conjunction(F, G, system=rsym.Sardf(0.5)), rsym.trimming(F, 1 - x**2), rsym.exclusive_or(F, G)],
    ids=["sardf", "trimming", "exclusive or"],
)
def test_where_no_side_is_preferred_there_is_no_direction(expression):
    assert np.isnan(at(expression, 0, 0)["normalised_gradient"]).all()
