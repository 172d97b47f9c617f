"""Cardinal functions, and the surfaces that they make through families of curves."""

from fractions import Fraction
from math import prod

import numpy as np
import pytest
import sympy as sp
from oracles.closeness import assert_close
from scipy.interpolate import CubicSpline

from rsym.errors import RsymError, RsymWarning
from rsym.surfaces.functions.cardinals import SlopeFunctions, hermite_cardinals, lagrange_cardinals, spline_cardinals
from rsym.surfaces.functions.nurbs import Nurbs
from rsym.surfaces.functions.univariate import Formula
from rsym.surfaces.networks.gordon import HermiteSurface, LagrangeSurface, SplineLoft
from rsym.surfaces.symbols import t, u, v

KNOTS = (0, 1, sp.Rational(5, 2), 3, sp.Rational(21, 5))
ROUND = (*KNOTS, 6)
KINDS = {
    "hermite": lambda: hermite_cardinals(KNOTS),
    "spline": lambda: spline_cardinals(KNOTS),
    "lagrange": lambda: lagrange_cardinals(KNOTS),
    "closed hermite": lambda: hermite_cardinals(ROUND, closed=True),
    "closed spline": lambda: spline_cardinals(ROUND, closed=True),
    "two": lambda: hermite_cardinals((1, 4)),
}
BELOW = np.nextafter(np.array(KNOTS, float), -1)


@pytest.mark.parametrize("kind", KINDS)
def test_cardinal_functions_add_up_to_one_and_meet_their_knots(kind):
    functions = KINDS[kind]()
    size = functions.shape[0]
    assert_close(functions(functions.knots)[:size], np.eye(size), atol=1e-15)
    assert_close(functions(np.linspace(*functions.domain, 97)).sum(axis=-1), np.ones(97), atol=1e-14)


@pytest.mark.random
@pytest.mark.parametrize("kind", KINDS)
def test_formulas_of_cardinal_functions_are_exact_and_give_the_values(kind):
    functions = KINDS[kind]()
    formulas = functions.expressions()
    assert not any(entry.has(sp.Float) for entry in formulas)
    places = [sp.Rational(k, 7) for k in range(8, 28, 3)]
    for order in range(3):
        expected = [[entry.diff(t, order).subs(t, place) for entry in formulas] for place in places]
        assert_close(functions(np.array(places, float), order), np.array(expected, float), atol=2e-13)


@pytest.mark.parametrize("closed", [False, True])
def test_spline_cardinals_are_those_of_scipy(closed):
    knots = ROUND if closed else KNOTS
    rows = np.eye(5)[np.arange(len(knots)) % 5]
    expected = CubicSpline(np.array(knots, float), rows, bc_type="periodic" if closed else "natural")
    places = np.linspace(0, float(knots[-1]), 200)
    for order in range(3):
        assert_close(spline_cardinals(knots, closed=closed)(places, order), expected(places, order), atol=1e-12)


def test_lagrange_cardinals_are_the_products_beside_a_knot_and_far_from_it():
    knots, places = [Fraction(k * k + k, 3) for k in range(6)], [Fraction(1, 2), Fraction(2, 3) + Fraction(1, 10**9), 9]
    expected = [[prod((x - b) / (a - b) for b in knots if b != a) for a in knots] for x in places]
    assert_close(lagrange_cardinals(knots)(np.array(places, float)), np.array(expected, float), atol=1e-14)


@pytest.mark.parametrize(
    ("kind", "order"), [("hermite", 1), ("closed hermite", 1), ("spline", 2), ("closed spline", 2)]
)
def test_cubic_cardinals_are_smooth_at_knots_and_across_the_seam(kind, order):
    functions = KINDS[kind]()
    for k in range(order + 1):
        assert_close(functions(BELOW[1:], k), functions(np.array(KNOTS[1:], float), k), atol=1e-13)
        if "closed" in kind:
            assert_close(functions(np.nextafter(6.0, 0), k), functions(0.0, k), atol=1e-13)
    if kind == "hermite":
        ends = np.array([0.0, 4.2])
        assert_close(functions(ends, 3), np.zeros((2, 5)), atol=1e-12)
        squares = functions(np.linspace(0, 4.2, 31)) @ np.array(KNOTS, float) ** 2
        assert_close(squares, np.linspace(0, 4.2, 31) ** 2, atol=1e-13)


def test_slope_functions_vanish_at_knots_with_slope_one_at_their_own():
    for closed, knots in ((False, KNOTS), (True, ROUND)):
        slopes, at = SlopeFunctions(knots, closed=closed), np.array(KNOTS, float)
        assert_close(slopes(at), np.zeros((5, 5)), atol=1e-15)
        assert_close(slopes(at, 1), np.eye(5), atol=1e-14)
        assert_close(slopes(BELOW[1:], 1), np.eye(5)[1:], atol=1e-14)
        place = sp.Rational(9, 7)
        exact = [entry.diff(t).subs(t, place) for entry in slopes.expressions()]
        assert_close(slopes(float(place), 1), np.array(exact, float), atol=1e-14)


def curves(rows):
    """Unlike curves side by side: expressions, a function, points."""
    formula = [(t, row, sp.sin(3 * t + row) + row**2 / 3) for row in range(rows)]
    formula[1] = lambda s: (s, 1 + s**2 / 5, np.cos(4 * s))
    formula[2] = np.array([[0, 2, 0], [0.3, 2.2, 1], [0.7, 1.9, 1], [1, 2, -1.0]])
    return formula


def points_of(given, places):
    """The curves of `curves` without the library, (row, place, 3)."""
    rows = [
        np.stack([places, row + 0 * places, np.sin(3 * places + row) + row**2 / 3], -1) for row in range(len(given))
    ]
    rows[1] = np.stack([places, 1 + places**2 / 5, np.cos(4 * places)], -1)
    lengths = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(given[2], axis=0), axis=1))])
    rows[2] = CubicSpline(lengths / lengths[-1], given[2])(places)
    return np.array(rows)


@pytest.mark.parametrize("closed", [False, True])
def test_hermite_surface_is_golovanovs_formula(closed):
    given, places = curves(5), np.linspace(0, 1, 7)
    r = points_of(given, places)
    surface = HermiteSurface(given, closed=closed)
    q = (np.roll(r, -1, axis=0) - np.roll(r, 1, axis=0)) / 2
    if not closed:
        q[0], q[-1] = (-3 * r[0] + 4 * r[1] - r[2]) / 2, (3 * r[-1] - 4 * r[-2] + r[-3]) / 2
    assert surface.domain == ((0, 1), (0, 5 if closed else 4))
    for j in range(5 if closed else 4):
        for w in (0.0, 0.3, 0.9):
            k = (j + 1) % 5
            expected = (1 - 3 * w**2 + 2 * w**3) * r[j] + (3 * w**2 - 2 * w**3) * r[k]
            expected = expected + (w - 2 * w**2 + w**3) * q[j] + (w**3 - w**2) * q[k]
            assert_close(surface(places, j + w), expected, atol=1e-14)
    if closed:
        assert_close(surface.derivative(places, 5 - 1e-15, (0, 1)), q[0], atol=1e-12)
        assert_close(surface(places, -0.5), surface(places, 4.5), atol=1e-14)


def test_general_knots_reproduce_a_surface_quadratic_across():
    knots = (-2, -1, sp.Rational(1, 2), 3)
    surface = HermiteSurface([(t, k, t * k**2 - k) for k in knots], knots)
    along, over = np.linspace(0, 1, 5)[:, None], np.linspace(-2, 3, 23)
    expected = np.stack(np.broadcast_arrays(along, over, along * over**2 - over), axis=-1)
    assert_close(surface(along, over), expected, atol=1e-14)
    difference = surface.expression()[2].subs(v, sp.Rational(7, 5)) - (u * sp.Rational(49, 25) - sp.Rational(7, 5))
    assert sp.expand(difference) == 0


def test_two_curves_give_the_ruled_surface():
    one, two = sp.Matrix([t, 0, sp.sin(t)]), sp.Matrix([t, 1, t**2])
    for kind in (HermiteSurface, SplineLoft, LagrangeSurface):
        point = kind([one, two]).expression() - ((1 - v) * one + v * two).subs(t, u)
        assert point.expand() == sp.zeros(3, 1)


@pytest.mark.parametrize("kind", [HermiteSurface, SplineLoft, LagrangeSurface])
def test_surfaces_pass_through_all_their_curves(kind):
    given, places = curves(6), np.linspace(0, 1, 11)
    surface = kind(given, "chord")
    found = surface.grid(places, surface.cardinals.knots)
    assert_close(found.swapaxes(0, 1), points_of(given, places), atol=2e-14)


def test_knots_by_chords_are_as_far_apart_as_the_curves():
    surface = HermiteSurface([(t, y, 0) for y in (0, 1, 4, 5)], knots="chord")
    assert_close(np.diff(surface.cardinals.knots), np.array([1, 3, 1]) * 0.6, atol=1e-14)


def test_a_closed_tube_is_smooth_across_both_seams():
    angles = 2 * np.pi * np.arange(9) / 9
    rings = [
        lambda s, a=a: (
            (3 + np.cos(2 * np.pi * s)) * np.cos(a),
            (3 + np.cos(2 * np.pi * s)) * np.sin(a),
            np.sin(2 * np.pi * s),
        )
        for a in angles
    ]
    surface = SplineLoft(rings, closed=True)
    places = np.linspace(0, 1, 13)
    for order in ((0, 0), (0, 1), (1, 1), (0, 2)):
        assert_close(surface.derivative(places, 9.0, order), surface.derivative(places, 0.0, order), atol=1e-10)
    assert surface.closed[1]


def test_curves_of_other_intervals_and_kinds_are_brought_to_that_of_the_first():
    quarter = Nurbs(2, [0, 0, 0, 5, 5, 5], [[1, 0, 1], [1, 1, 1], [0, 1, 1]], [1, 0.5**0.5, 1])
    arc = Formula((sp.cos(t), sp.sin(t), 0), domain=(0, sp.pi / 2))
    surface = HermiteSurface([arc, quarter])
    assert_close(surface.domain, ((0, np.pi / 2), (0, 1)), atol=1e-15)
    points = surface.grid(np.pi / 2 * np.linspace(0, 1, 9), [0, 0.5, 1])
    assert_close(np.hypot(points[:, [0, 2], 0], points[:, [0, 2], 1]), np.ones((9, 2)), atol=1e-14)
    assert_close(points[[0, 4, 8], 2], [[1, 0, 1], [0.5**0.5, 0.5**0.5, 1], [0, 1, 1]], atol=1e-14)


def test_letters_of_the_curves_move_the_surface():
    h = sp.Symbol("h")
    surface = SplineLoft([(t, 0, 0), (t, 1, h), (t, 2, 0)], letters={h: 1})
    assert_close(surface(0.5, [0.5, 1.0], letters={"h": 4})[:, 2], [2.75, 4], atol=1e-14)


def test_many_curves_swing_by_lagrange_which_is_told():
    given = [(t, row, 1 / (1 + (row - 5) ** 2)) for row in range(11)]
    with pytest.warns(RsymWarning, match="swing between 11 curves"):
        swinging = LagrangeSurface(given)
    over = np.linspace(0, 10, 101)
    assert swinging(0, over)[:, 2].max() > 1.5
    assert SplineLoft(given)(0, over)[:, 2].max() < 1.01


@pytest.mark.parametrize(
    ("build", "message"),
    [
        (lambda: HermiteSurface([(t, 0, 0)]), "the curves: expected a sequence of 2 or more, got 1"),
        (lambda: HermiteSurface([(t, 0, 0), (t, 1)]), "the curve 1"),
        (lambda: HermiteSurface([(t, 0, 0), (t, 1, 0)], closed=True), "3 or more"),
        (
            lambda: HermiteSurface([(t, k, 0) for k in range(3)], (0, 1, 2), closed=True),
            "3 curves need 4 knots, the last",
        ),
        (lambda: SplineLoft([(t, k, 0) for k in range(3)], (0, 2, 2)), "strictly increasing"),
        (lambda: SplineLoft([(t, 0, 0), (t, 1, 0), (t, 1, 0)], "chord"), "curves 1 and 2 are the same"),
        (lambda: SplineLoft([(t, 0, 0), (t, 1, 0)], "chords"), "\"chord\", got 'chords'"),
    ],
)
def test_bad_families_are_refused(build, message):
    with pytest.raises(RsymError, match=message):
        build()
