"""Corners are found, their functions are what they are said to be, and singular problems are solved to many digits."""

import math
from dataclasses import replace

import numpy as np
import pytest
import sympy as sp

import rsym
from rsym import x, y
from rsym.problems.corners.places import corners_of
from rsym.problems.corners.singular import SingularFunctions, singular_functions
from rsym.problems.problem import with_corners
from rsym.problems.solving import problem_of

L_DRUM = 9.639723844021941  # of three unit squares: Trefethen and Betcke (2006)
SQUARE = 0.14057701495515551


def side(angle, distance):
    return rsym.half_plane((math.cos(angle), math.sin(angle)), distance)


def ell(turn=0.0):
    whole = side(turn, -1)
    for k in (1, 2, 3):
        whole = whole & side(turn + k * math.pi / 2, -1)
    return whole & (side(turn + math.pi, 0) | side(turn + math.pi / 2, 0))


def test_corners_of_an_l():
    found = corners_of(ell(0.3))
    assert sorted(round(one.angle / math.pi, 9) for one in found) == [0.5] * 5 + [1.5]
    (inner,) = (one for one in found if one.angle > math.pi)
    np.testing.assert_allclose(inner.point, (0, 0), atol=1e-12)
    assert abs(inner.distance - 1) < 1e-2


def test_curved_corners_have_the_angle_of_their_tangents():
    lens = rsym.disc(1) & rsym.disc(1, (1, 0))
    found = corners_of(lens)
    assert [round(3 * one.angle / math.pi, 9) for one in found] == [2, 2]
    np.testing.assert_allclose([one.point for one in found], [(0.5, -math.sqrt(0.75)), (0.5, math.sqrt(0.75))])


@pytest.mark.parametrize("valued", [(0, 1, 2), (0,), ()])
def test_slopes_of_functions_at_curved_corners(valued):
    """Of first and second order, against differences."""
    shape = rsym.disc(1) & (rsym.half_plane((-1, 0), 0) | rsym.disc(sp.Rational(1, 2), (0, sp.Rational(1, 2))))
    corners = corners_of(shape)
    problem = problem_of(shape, "-laplacian(u) = 1", 0)
    step = 1e-5
    for one in singular_functions(corners, valued, [True] * len(corners)):
        alone = replace(problem, corners=(one,))
        places = np.array(one.corner.point) + one.radius * np.array([[0.2, 0.13], [-0.31, 0.2], [-0.1, -0.4]])
        found = alone.extras(places, 2)
        for axis, second in enumerate(((3, 4), (4, 5))):
            shift = step * np.eye(2)[axis]
            ahead, back = (alone.extras(places + sign * shift, 1) for sign in (1, -1))
            slopes = (ahead - back) / (2 * step)
            size = np.abs(found).max()
            np.testing.assert_allclose(found[1 + axis], slopes[0], atol=1e-6 * size)
            np.testing.assert_allclose(found[list(second)], slopes[1:], atol=1e-6 * size)


def test_functions_vanish_on_leaves_with_values():
    problem = with_corners(problem_of(ell(0.2), "-laplacian(u) = 1", 0))
    assert len(problem.corners) == 6
    rule = rsym.quadrature(ell(0.2), cells=16, order=4)
    assert np.abs(problem.extras(rule.boundary.points, 0)).max() < 1e-13
    unloaded = with_corners(problem_of(ell(), "-laplacian(u) = 0", 0))
    assert [(one.terms[0][0], round(one.terms[0][1], 9)) for one in unloaded.corners] == [("sin", 0.666666667)]


def test_the_laplacian_of_the_logarithm_is_minus_one():
    (corner,) = (one for one in corners_of(rsym.rectangle(1, 1).rotate(0.3)) if one.point[0] > 0.4)
    one = SingularFunctions(corner, (("log", 2.0, 0),), 1e6)
    problem = problem_of(rsym.rectangle(1, 1).rotate(0.3), "-laplacian(u) = 1", 0)
    centre = np.array(corner.point) * np.array([[0.99], [0.9999]])
    leaves = problem._with_derivatives("leaves", 2, lambda: {f"{k}": problem.form.leaves[k] for k in corner.leaves})(
        centre
    ).reshape(2, 6, -1)
    found = one(centre, leaves)[:, 0]
    np.testing.assert_allclose(found[3, 1] + found[5, 1], -1, atol=3e-2)


@pytest.mark.parametrize(("turn", "share"), [(0.0, 5e-7), (0.3, 3e-6)])
def test_an_l_shaped_drum(turn, share):
    assert abs(rsym.modes(ell(turn), 1, cells=16).values[0] / L_DRUM - 1) < share
    assert abs(rsym.modes(ell(turn), 1, cells=16, corners=False).values[0] / L_DRUM - 1) > 1e-4


@pytest.mark.slow
def test_an_l_shaped_drum_to_ten_digits():
    assert abs(rsym.modes(ell(), 1, cells=32, degree=5).values[0] / L_DRUM - 1) < 3e-11
    assert abs(rsym.modes(ell(0.3), 1, cells=32, degree=5).values[0] / L_DRUM - 1) < 5e-10


def square(turn):
    whole = side(turn, -0.5)
    for k in (1, 2, 3):
        whole = whole & side(turn + k * math.pi / 2, -0.5)
    return whole


@pytest.mark.parametrize(("turn", "share"), [(0.0, 1e-9), (0.3, 1e-8)])
def test_the_torsion_of_a_square(turn, share):
    assert abs(float(rsym.torsion(square(turn), cells=16, degree=5)) / SQUARE - 1) < share


def test_mixed_conditions_at_a_straight_corner():
    """Half of a disc with the cut free: half of the torsion of the whole."""
    half = rsym.disc(1).named("rim") & rsym.half_plane((0, 1), 0)
    found = rsym.solve(half, "-laplacian(u) = 1", {"rim": 0}, cells=16)
    assert abs(found(0.3, 0.4) - 0.75 / 4) < 1e-10


def test_a_re_entrant_corner_with_mixed_conditions():
    """u = Im z**(1/3): 0 on one edge of a right re-entrant corner, no flow through the other."""
    inner = side(math.pi, 0).named("free") | side(math.pi / 2, 0).named("held")
    shape = rsym.disc(1).named("rim") & inner
    exact = (x**2 + y**2) ** sp.Rational(1, 6) * sp.sin((sp.pi / 2 + sp.atan2(-x, y)) / 3)
    conditions = {"held": 0, "free": rsym.neumann(0), "rim": rsym.robin(1, sp.Rational(4, 3) * exact)}
    found = rsym.solve(shape, "-laplacian(u) = 0", conditions, cells=24)
    for r, angle in ((0.5, 1.0), (0.1, 2.5), (0.001, 4.0)):
        value = found(r * math.cos(angle), r * math.sin(angle))
        assert abs(value - r ** (1 / 3) * math.sin(angle / 3)) < 1e-5
