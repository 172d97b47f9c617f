"""Rational curves: against circles, formulas and geomdl."""

import itertools

import mpmath
import numpy as np
import pytest
import sympy as sp
from geomdl import NURBS
from oracles.closeness import assert_close

from rsym.errors import RsymError
from rsym.surfaces.functions.curves import as_curve
from rsym.surfaces.functions.nurbs import Nurbs
from rsym.surfaces.symbols import t

HALF = 0.5**0.5
KNOTS = [0, 0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 4]
SQUARE = [[1, 0], [1, 1], [0, 1], [-1, 1], [-1, 0], [-1, -1], [0, -1], [1, -1], [1, 0]]
CIRCLE = Nurbs(2, KNOTS, [[x, y, 0.5] for x, y in SQUARE], [1, HALF] * 4 + [1])
RANDOM = np.random.default_rng(3)
POINTS, WEIGHTS = RANDOM.normal(size=(7, 3)), RANDOM.uniform(0.5, 3, 7)


def test_a_circle_of_four_arcs_is_round_and_closed():
    places = np.linspace(0, 4, 57)
    x, y, z = CIRCLE(places).T
    assert_close(x**2 + y**2, np.ones(57), atol=1e-15)
    assert_close(z, np.full(57, 0.5), atol=1e-15)
    assert CIRCLE.closed
    assert_close(CIRCLE(5.25), CIRCLE(1.25), atol=1e-15)


def test_derivatives_of_any_order_are_those_of_the_definition():
    """To fifty digits."""
    knots = [0, 0, 0, 0, 1, 1.5, 4, 5, 5, 5, 5]
    curve = Nurbs(3, knots, POINTS, WEIGHTS)
    assert not curve.closed
    with mpmath.workdps(50):
        inner = [mpmath.mpf(knot) for knot in knots]

        def place(at, axis):
            values = [WEIGHTS[i] * basis(4, inner, i, at) for i in range(7)]
            return mpmath.fdot(values, map(mpmath.mpf, POINTS[:, axis].tolist())) / mpmath.fsum(values)

        for at, order in itertools.product((0.25, 1.25, 3.0), range(7)):
            expected = [float(mpmath.diff(lambda s, axis=axis: place(s, axis), at, order)) for axis in range(3)]
            assert_close(curve(at, order), expected, atol=1e-12 * np.abs(expected).max())


def basis(order, knots, number, at):
    """A basis function inside the interval, by its definition."""
    if order == 1:
        return int(knots[number] <= at < knots[number + 1])
    total = 0
    for first, last, inner in ((number, number + order - 1, number), (number + order, number + 1, number + 1)):
        if knots[first] != knots[last]:
            total += (at - knots[first]) * basis(order - 1, knots, inner, at) / (knots[last] - knots[first])
    return total


def test_formulas_are_the_curve():
    places = np.linspace(0, 4, 9)
    formula = sp.lambdify(t, list(CIRCLE.expressions()))
    assert_close(CIRCLE(places), [formula(place) for place in places], atol=1e-14)


def test_values_are_those_of_geomdl():
    curve, theirs = Nurbs(3, None, POINTS, WEIGHTS), NURBS.Curve()
    theirs.degree = 3
    theirs.ctrlpts, theirs.weights = POINTS.tolist(), WEIGHTS.tolist()
    theirs.knotvector = curve.knots.tolist()
    for place in (0.0, 0.3, 0.77, 1.0):
        expected = theirs.derivatives(place, 2)
        for order in range(3):
            assert_close(curve(place, order), expected[order], atol=1e-11)


def test_points_that_go_round():
    """Knots of one period; and all of them, with the first points repeated."""
    curve = Nurbs(3, [0, 1, 3, 4, 4.5, 6, 7, 8], POINTS, WEIGHTS, closed=True)
    assert curve.domain == (0, 8)
    for order in range(3):
        ends = curve(np.array([0.0, 8.0]), order)
        assert_close(ends[0], ends[1], atol=1e-12)
    again = Nurbs(3, curve.knots, np.concatenate([POINTS, POINTS[:3]]), np.concatenate([WEIGHTS, WEIGHTS[:3]]))
    assert again.closed
    assert (again(2.7) == curve(2.7)).all()
    assert not Nurbs(3, None, POINTS).closed


def test_weights_that_are_all_alike_do_not_matter():
    assert_close(Nurbs(3, None, POINTS, np.full(7, 5.0))(0.3, 2), Nurbs(3, None, POINTS)(0.3, 2), atol=1e-13)


def test_an_arc_without_inner_knots_is_a_smooth_formula_and_a_curve():
    arc = Nurbs(2, [0, 0, 0, 1, 1, 1], [[1, 0, 0], [1, 1, 0], [0, 1, 0]], [1, HALF, 1])
    assert arc.is_smooth_formula
    assert not CIRCLE.is_smooth_formula
    assert as_curve(arc) is arc
    assert arc(0.5).shape == (3,)
    assert (arc.degree, arc.order) == (2, 3)
    assert Nurbs(3, None, POINTS).domain == Nurbs(3, None, POINTS, closed=True).domain == (0, 1)
    assert arc([[0.5, 0.1]], 1).shape == (1, 2, 3)


@pytest.mark.parametrize(
    ("code", "words", "work"),
    [
        ("degree", "integer >= 1, got 0", lambda: Nurbs(0, None, POINTS)),
        ("order", "order 9 along t needs 9", lambda: Nurbs(8, None, POINTS)),
        ("points", "(n, 3), got (7, 2)", lambda: Nurbs(3, None, POINTS[:, :2])),
        ("points", "entry (0, 1) is nan", lambda: Nurbs(1, None, [[0, np.nan, 0], [1, 1, 1]])),
        ("weights", "need 7 weights", lambda: Nurbs(3, None, POINTS, [1, 2])),
        ("weights", "that of the point 2 is 0", lambda: Nurbs(3, None, POINTS, [1, 1, 0, 1, 1, 1, 1])),
        ("knots", "need 11 knots, got 4", lambda: Nurbs(3, [0, 1, 2, 3], POINTS)),
        ("knots", "the knot 1 stands 3 times", lambda: Nurbs(2, [0, 0, 0, 1, 1, 1, 1.5, 2, 2, 2], POINTS)),
        ("domain", "t must lie in [0, 1]", lambda: Nurbs(3, None, POINTS)(4.5)),
    ],
)
def test_what_is_refused(code, words, work):
    with pytest.raises(RsymError) as caught:
        work()
    assert caught.value.code == code, str(caught.value)
    assert words in str(caught.value), str(caught.value)
