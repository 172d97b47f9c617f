import pytest
import sympy as sp

import rsym
from rsym import RsymError, Shape, trimming, x, y, z


def test_revolving_substitutes_the_radius_before_anything_is_differentiated():
    profile = Shape(1 - x**2 - y**2, (x, y), bounds=((-2, 2), (-1, 3)))
    ball = rsym.revolve(profile)
    assert ball.expression == 1 - x**2 - y**2 - z**2
    assert ball.bounds == ((-2, 2), (-3, 3), (-3, 3))


def test_revolving_about_y():
    body = rsym.revolve(Shape(x**4 + y, (x, y), bounds=((0, 2), (5, 6))), axis=y)
    assert body.expression == sp.expand((x**2 + z**2) ** 2) or body.expression == (x**2 + z**2) ** 2 + y
    assert body.bounds == ((-2, 2), (5, 6), (-2, 2))


def test_a_profile_smooth_in_y_squared_is_smooth_on_the_axis():
    body = rsym.revolve(Shape(1 - trimming(y, (4 - x**2) / 4), (x, y)))
    result = rsym.compile(body, ("gradient", "hessian", "singular"))(3.0, 0.0, 0.0)
    assert not result["singular"]
    assert abs(result["hessian"]).max() < 10
    assert result["hessian"][1, 1] == result["hessian"][2, 2]


@pytest.mark.parametrize("axis", [z, "w"])
def test_a_wrong_axis_is_refused(axis):
    with pytest.raises(RsymError):
        rsym.revolve(Shape(x, (x, y)), axis=axis)


def test_a_shape_in_space_is_refused():
    with pytest.raises(RsymError):
        rsym.revolve(Shape(x, (x, y, z)))
