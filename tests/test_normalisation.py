import numpy as np
import pytest
import sympy as sp
from closeness import assert_close

import rsym
from rsym import RsymError, Shape, x, y


def test_the_gradient_is_one_on_the_boundary_of_an_ellipse():
    unit = rsym.normalise(Shape(1 - x**2 / 9 - y**2, (x, y)))
    angle = np.linspace(0, 2 * np.pi, 50)
    squared = rsym.compile(unit, ("gradient_squared",))(3 * np.cos(angle), np.sin(angle))["gradient_squared"]
    assert_close(squared, np.ones(50), atol=1e-12)


def test_a_length_makes_it_covariant_to_scale():
    small, large = Shape(1 - x**2 - y**2, (x, y)), Shape(1 - x**2 / 100 - y**2 / 100, (x, y))
    first = rsym.compile(rsym.normalise(small, length=2))(0.3, 0.5)["value"]
    second = rsym.compile(rsym.normalise(large, length=20))(3.0, 5.0)["value"]
    assert_close(second, 10 * first, rtol=1e-14)


def test_it_is_the_normalised_field():
    shape = Shape(rsym.conjunction(x, 1 - y), (x, y))
    points = np.linspace(-1, 1, 11), np.linspace(2, -1, 11)
    assert_close(
        rsym.compile(rsym.normalise(shape))(*points)["value"],
        rsym.compile(shape, ("normalised",))(*points)["normalised"],
        atol=1e-14,
    )


@pytest.mark.parametrize("order", [0, "1"])
def test_other_orders_are_refused(order):
    with pytest.raises(RsymError):
        rsym.normalise(Shape(x, (x, y)), order=order)


@pytest.mark.parametrize("length", [0, -1, sp.Integer(-2)])
def test_a_length_must_be_positive(length):
    with pytest.raises(RsymError):
        rsym.normalise(Shape(x, (x, y)), length=length)
