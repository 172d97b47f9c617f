import numpy as np
import pytest
import sympy as sp
from oracles.closeness import assert_close

import rsym
from rsym import Shape, conjunction, x, y

SHAPE = Shape(conjunction(1 - x**2 - y**2, y - x, rsym.trimming(y, x)), (x, y))
FIELDS = (*rsym.SIX, "gradient", "hessian", "singular")


def test_it_agrees_with_the_kernel():
    points = np.random.default_rng(5).uniform(-2, 2, (2, 200))
    plain, fast = rsym.lambdify(SHAPE, FIELDS)(*points), rsym.compile(SHAPE, FIELDS)(*points)
    for name in rsym.SIX:
        assert_close(plain[name], fast[name], atol=1e-9 * np.abs(fast[name]).max())
    assert plain["hessian"].shape == (200, 2, 2)
    assert not plain["singular"].any()


def test_letters_and_source():
    body = rsym.paper.skeleton_body()
    function = rsym.lambdify(body)
    assert function(0.0, 0.0)["value"] != function(0.0, 0.0, letters={"p1": 20})["value"]
    assert "_lambdifygenerated" in function.__doc__


def test_wrong_number_of_coordinates():
    with pytest.raises(rsym.RsymError):
        rsym.lambdify(SHAPE)(1.0)


def test_the_larger_of_an_array_and_a_number():
    shape = rsym.Shape(sp.Max(x, sp.Rational(1, 2)) - sp.Min(y, 2), (x, y))
    assert rsym.lambdify(shape)([0.0, 1.0], [3.0, 1.0])["value"].tolist() == [-1.5, 0.0]
