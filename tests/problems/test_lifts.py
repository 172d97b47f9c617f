"""Lifts: values of parts that meet, with slopes that do not agree, met exactly and smoothly."""

import numpy as np
import pytest
import sympy as sp

import rsym
from rsym import x, y
from rsym.model.nodes import expand_nodes
from rsym.problems.lifts import lift_of

THIRD = sp.Rational(1, 3)


def named(**functions):
    """The points where all of some functions are positive."""
    shapes = [rsym.Shape(function, (x, y)).named(name) for name, function in functions.items()]
    return shapes[0] if len(shapes) == 1 else shapes[0] & named(**dict(list(functions.items())[1:]))


SQUARE = named(left=x, right=1 - x, floor=y, lid=1 - y)
SIDES = {"left": y**2, "right": 1 + y**2, "floor": x**2, "lid": 1 + x**2}
CURVED = rsym.disc(1).named("rim") & named(floor=y)
BENT = named(left=x, floor=y, right=2 - x, lid=2 - y) & (named(side=1 - x) | named(top=1 - y))
BENT_SIDES = {"left": y**3, "floor": x, "right": 2 + y**3, "lid": 8 + x, "side": 1 + y**3, "top": 1 + x}


def lift(shape, values):
    return sp.lambdify(
        (x, y), expand_nodes(lift_of(shape, {k: rsym.dirichlet(v) for k, v in values.items()}).expression)
    )


def second(f, p, q, h=1e-5):
    """A second derivative, by differences."""
    return (f(p + h, q + h) - 2 * f(p, q) + f(p - h, q - h)) / h**2


@pytest.mark.parametrize(
    ("shape", "values", "points"),
    [
        (SQUARE, SIDES, {"left": (0, 0.3), "right": (1, 0.3), "floor": (0.8, 0), "lid": (0.8, 1)}),
        (CURVED, {"rim": 1, "floor": x**2}, {"rim": (0.6, 0.8), "floor": (-0.7, 0)}),
        (BENT, BENT_SIDES, {"left": (0, 1.7), "side": (1, 1.6), "top": (1.3, 1), "lid": (0.4, 2), "right": (2, 0.1)}),
    ],
)
def test_values_are_met_exactly(shape, values, points):
    found = lift(shape, values)
    for part, point in points.items():
        expected = float(sp.sympify(values[part]).subs(dict(zip((x, y), point, strict=True))))
        assert abs(found(*map(float, point)) - expected) < 1e-14


def test_between_straight_parts_a_lift_is_smooth():
    """Coons: it is x**2 + y**2 itself."""
    found = lift(SQUARE, SIDES)
    for point in np.random.default_rng(4).random((50, 2)):
        assert abs(found(*point) - point @ point) < 1e-14


def test_second_derivatives_are_bounded_at_a_curved_corner():
    found = lift(CURVED, {"rim": 1, "floor": x**2})
    assert max(abs(second(found, 1 - r, r, r / 64)) for r in (1e-1, 1e-2, 1e-3)) < 20


def test_data_with_kinks_have_no_taylor_polynomials():
    """A jump would be seen: the lift is as steep as its data."""
    found = lift(SQUARE, {"lid": sp.Abs(x - THIRD) - (1 + x) / 3, ...: sp.S.Zero})
    assert abs(found(1 / 3 - 1e-9, 0.8) - found(1 / 3 + 1e-9, 0.8)) < 1e-7


def test_slopes_and_fluxes_near_corners_are_those_of_the_solution():
    found = rsym.solve(SQUARE, "-laplacian(u) = -4", SIDES, cells=8)
    np.testing.assert_allclose(found.gradient(0.999, 0.999), [1.998, 1.998], atol=1e-5)
    assert abs(sum(found.flux(part) for part in SIDES) - 4) < 1e-5


def test_a_lift_that_is_the_solution_is_no_singular_system():
    """What is left of its loads is rounding: no share of it is sure."""
    found = rsym.solve(SQUARE, "-laplacian(u) = -4", SIDES, cells=32)
    assert abs(found(0.4, 0.7) - 0.65) < 1e-8


@pytest.mark.slow
def test_values_beside_a_re_entrant_corner():
    found = rsym.solve(BENT, "-laplacian(u) = -6*y", BENT_SIDES, cells=32)
    here = np.array([[0.9, 1.05], [1.9, 0.05], [0.3, 1.2]]).T
    np.testing.assert_allclose(found(*here), here[0] + here[1] ** 3, atol=1e-3)
