"""Integrals and measures of shapes, with their errors, against exact values."""

import math
import pickle

import numpy as np
import pytest
import sympy as sp
from scipy.integrate import quad

import rsym
from rsym import conjunction, x, y, z
from rsym.sampling.rules import refinement

r = sp.Symbol("r", real=True)


@pytest.fixture(scope="module")
def half():
    return rsym.disc(r, letters={r: 2}).named("rim") & rsym.Shape(y, (x, y)).named("cut")


def close(found, truth, relative=1e-12):
    """Whether a value is right, and its error covers what it is off."""
    return abs(found - truth) <= min(found.error + 1e-15, relative * max(1.0, abs(truth)))


def test_integrals_of_numbers_expressions_shapes_and_functions(half):
    assert close(rsym.integrate(1, half), 2 * math.pi)
    assert close(rsym.integrate(r * y, half), 2 * 16 / 3)
    assert close(rsym.integrate(r * y, half, letters={"r": 1}), 2 / 3)
    assert close(rsym.integrate(rsym.Shape(x**2, (x, y)), half), 2 * math.pi)
    assert close(rsym.integrate(lambda u, v: np.exp(u) * 0 + v**2, half), 2 * math.pi)
    odd = rsym.integrate(x, half)
    assert abs(odd) <= odd.error < 1e-12


def test_integrals_over_the_boundary_and_its_parts(half):
    assert close(rsym.integrate(1, half, "boundary"), 2 * math.pi + 4)
    assert close(rsym.integrate(y, half, "rim"), 8)
    assert close(rsym.integrate(x**2, half, over="cut"), 16 / 3)


def test_errors_are_told_where_a_function_has_a_singular_point():
    disc = rsym.disc(1)
    with pytest.warns(rsym.RsymWarning, match="known to a relative error"):
        found = rsym.integrate(1 / sp.sqrt((x - sp.Rational(1, 7)) ** 2 + y**2), disc, cells=16, order=4)
    truth = 4 * float(sp.elliptic_e(sp.Rational(1, 49)))
    assert 1e-9 < abs(found - truth) < 10 * found.error


def test_an_integral_is_a_float_that_travels():
    found = rsym.integrate(2, rsym.disc(1))
    copy = pickle.loads(pickle.dumps(found))
    assert (copy, copy.error, copy + 0.0) == (found, found.error, float(found))


def test_measures_of_a_half_disc(half):
    found = rsym.measure(half)
    assert close(found.area, 2 * math.pi)
    assert close(found.length, 2 * math.pi + 4)
    assert close(found.parts["rim"], 2 * math.pi)
    assert close(found.parts["cut"], 4)
    height = 8 / (3 * math.pi)
    assert np.allclose(found.centroid, [0, height], atol=1e-13)
    assert np.allclose(found.inertia, [[2 * math.pi * (1 - height**2), 0], [0, 2 * math.pi]], atol=1e-12)
    assert rsym.measure(half, letters={"r": 1}).area == pytest.approx(math.pi / 2, abs=1e-13)
    with pytest.raises(rsym.RsymError, match="length"):
        found.surface  # noqa: B018 - to ask is to be refused
    assert "rim" in found._repr_html_()
    assert "6.28318530718" in str(found)


def test_measures_of_a_cone_in_space():
    cone = rsym.Shape(rsym.conjunction(1 - z - sp.sqrt(x**2 + y**2), z), (x, y, z))
    found = rsym.measure(cone, bounds=((-1.25, 1.25), (-1.25, 1.25), (-0.5, 1.25)), tolerance=1e-8)
    assert abs(found.volume * 3 / math.pi - 1) < 1e-9
    assert abs(found.surface / (math.pi * (1 + math.sqrt(2))) - 1) < 1e-8
    assert np.allclose(found.centroid, [0, 0, 0.25], atol=1e-9)
    assert np.allclose(np.diag(found.second_moments), [math.pi / 20, math.pi / 20, math.pi / 80], atol=1e-9)


def test_refusals(half):
    with pytest.raises(rsym.RsymError, match="rim, cut"):
        rsym.integrate(1, half, "bore")
    with pytest.raises(rsym.RsymError, match="nan"):
        rsym.integrate(sp.log(x), half)
    with pytest.raises(rsym.RsymError, match="coordinates"):
        rsym.integrate(rsym.sphere(1), half)
    with pytest.raises(rsym.RsymError):
        rsym.integrate(sp.Symbol("unknown"), half)
    with pytest.raises(rsym.RsymError, match="bounds"):
        rsym.measure(rsym.Shape(x, (x, y)))


def test_own_bounds_that_cut_are_told():
    grown = rsym.disc(r, letters={r: 1})
    assert close(rsym.measure(grown, letters={"r": 2}).area, 4 * math.pi)  # nobody gave bounds
    grown = grown.replace(bounds=((-1.2, 1.2),) * 2)
    with pytest.warns(rsym.RsymWarning, match="own bounds cut it: x lower, x upper, y lower, y upper; give bounds="):
        assert rsym.measure(grown, letters={"r": 2}).area < 6
    united = rsym.disc(1) | rsym.Shape(conjunction(y + 1, -y, x, 2 - x), (x, y))
    with pytest.warns(rsym.RsymWarning, match="own bounds cut it: x upper;"):
        rsym.quadrature(united.replace(bounds=((-1.2, 1.2),) * 2), cells=8)
    with pytest.warns(rsym.RsymWarning, match="own bounds"):
        rsym.integrate(1, grown.with_letters({"r": 2}), "boundary")
    wide = rsym.extent(grown, {"r": 2})
    assert close(rsym.measure(grown, letters={"r": 2}, bounds=wide).area, 4 * math.pi)
    assert close(rsym.measure(grown, letters={"r": 2}, bounds=((-1, 1), (-1, 1))).area, 4)


def test_a_node_has_no_length():
    found = rsym.measure(rsym.Shape(x**2 - y**2 - (x**2 + y**2) ** 2, (x, y))).length
    truth = float(sp.gamma(sp.Rational(1, 4)) ** 2 / sp.sqrt(2 * sp.pi))
    assert abs(found - truth) < found.error < 1e-11


def test_a_sum_that_is_not_a_number_is_not_known(monkeypatch):
    made = rsym.sampling.rules.quadrature.prepared(rsym.disc(1), None, None)
    monkeypatch.setattr(refinement, "MOST_POINTS", {2: 1e4, 3: 1e4})
    for value in (math.inf, math.nan):
        with pytest.warns(rsym.RsymWarning, match="not known"):
            found = refinement.refined(
                made,
                lambda _, v=value: refinement.Sums(*np.array([[v], [v], [0.0], [0.0]])),
                tolerance=None,
                cells=None,
                order=8,
            )
        assert found.integral(0).error == math.inf


def test_a_peak_between_the_points_of_the_first_rule_is_found():
    def peak(u, v, square):
        return 1 + np.exp(-((u - 0.031) ** 2 + (v - 0.042) ** 2) / square) / (np.pi * square)

    found = rsym.integrate(lambda u, v: peak(u, v, 1e-4), rsym.disc(1), order=4)
    assert abs(found / (1 + math.pi) - 1) < 1e-12
    with pytest.warns(rsym.RsymWarning, match="known to a relative error"):
        found = rsym.integrate(lambda u, v: peak(u, v, 1e-6), rsym.disc(1))
    assert abs(found - 1 - math.pi) < found.error < 10


@pytest.mark.parametrize(("radius", "turn"), [(0.5, 0.0), (0.25, 0.0), (0.2, 0.0), (0.625, 6.29)])
def test_lengths_lost_where_boundaries_touch_are_told(radius, turn):
    hole = rsym.disc(radius, ((1 - radius) * math.cos(turn), (1 - radius) * math.sin(turn)))
    with pytest.warns(rsym.RsymWarning, match="touches itself"):
        found = rsym.measure(rsym.disc(1) - hole)
    assert abs(found.length - 2 * math.pi * (1 + radius)) < found.length.error < 1e-5
    assert close(found.area, math.pi * (1 - radius**2), 1e-9)


TURNED = [
    # What lies on one line or surface: turned, so that no axis stands along it; some written in two ways.
    ((rsym.rectangle(2, 2) & rsym.rectangle(3, 1, (0.5, 0))).rotate(0.3), 2, 6),
    ((rsym.rectangle(2, 2) - rsym.rectangle(1, 1, (0.5, 0))).rotate(0.3), 3, 10),
    ((rsym.rectangle(1, 2, (-0.5, 0)) | rsym.rectangle(1, 2, (0.5, 0))).rotate(0.3), 4, 8),
    (rsym.disc(1) & rsym.Shape(1 - sp.sqrt(x**2 + y**2), (x, y)), sp.pi, 2 * sp.pi),
    (rsym.disc(1) - rsym.Shape(3 - 3 * x**2 - 3 * y**2, (x, y)), 0, 0),
]


@pytest.mark.parametrize(("shape", "content", "boundary"), TURNED)
def test_two_leaves_on_one_curve_are_one(shape, content, boundary):
    """Without a warning: whose a length is does not hang on rounding."""
    found = rsym.measure(shape, bounds=((-3, 3),) * 2)
    assert abs(found.content - content) < 1e-13
    assert abs(found.boundary - boundary) < 1e-12
    assert sum(found.parts.values()) == pytest.approx(float(boundary), abs=1e-12)


LINE = sp.Abs(x - sp.Float(0.3137))


@pytest.mark.filterwarnings("ignore:an integral is known")
@pytest.mark.parametrize(
    ("shape", "function", "exact", "tolerance"),
    [
        (rsym.disc(1), 1 / sp.sqrt(1 - x**2 - y**2), 2 * math.pi, 1e-3),
        (rsym.disc(1), sp.sqrt(1 - x**2 - y**2), 2 * math.pi / 3, 1e-7),
        (rsym.disc(1), (x**2 + y**2) ** sp.Rational(-1, 4), 2 * math.pi / 1.5, 1e-7),
        (rsym.rectangle(2, 2), LINE, 0.6863**2 + 1.3137**2, 1e-5),
        (rsym.rectangle(2, 2), 1 / sp.sqrt(LINE), (0.6863**0.5 + 1.3137**0.5) * 4, 1e-3),
        (rsym.rectangle(2, 2), lambda x, y: x > 0.3137, 2 * 0.6863, 1e-3),
    ],
)
def test_errors_of_singular_functions_are_about_as_large_as_stated(shape, function, exact, tolerance):
    """They were up to 15 times as large: differences that fall slowly add up."""
    found = rsym.integrate(function, shape, tolerance=tolerance)
    assert abs(found - exact) < 2 * found.error < 1


SQUARE = x**2 + y**2
ASTROID = rsym.Shape(-((SQUARE - 1) ** 3) - 27 * x**2 * y**2, (x, y), bounds=((-1.1, 1.1),) * 2)
NEPHROID = rsym.Shape(108 * y**2 - (SQUARE - 4) ** 3, (x, y), bounds=((-4.5, 4.5),) * 2)
CARDIOID = rsym.Shape(4 * y**2 - 4 * x * SQUARE - SQUARE**2, (x, y), bounds=((-5, 2), (-4, 4)))
HORN = rsym.Shape(conjunction(x**3 - y, x**3 + y, 1 - x), (x, y), bounds=((-0.5, 1.5), (-1.5, 1.5)))
HORN_LENGTH = 2 + 2 * quad(lambda t: math.sqrt(1 + 9 * t**4), 0, 1, epsabs=1e-13)[0]


@pytest.mark.parametrize(
    ("shape", "area", "length", "most"),
    [
        (ASTROID, 3 * math.pi / 8, 6, 1e-5),
        (NEPHROID, 12 * math.pi, 24, 1e-6),
        (CARDIOID.translate(0.123, 0.0456), 6 * math.pi, 16, 1e-4),  # the equation is noise next to its cusp
        (HORN.rotate(0.3), 0.5, HORN_LENGTH, 1e-3),  # leaves that touch in a third order
    ],
)
def test_what_is_lost_next_to_cusps_is_told(shape, area, length, most):
    """Lengths were off up to 80 times what was stated, and nothing was warned of."""
    with pytest.warns(rsym.RsymWarning, match="not resolved where its boundary has cusps"):
        found = rsym.measure(shape)
    assert abs(found.length - length) < found.length.error < most
    assert abs(found.area - area) < found.area.error < most


def test_thin_shapes_are_resolved_and_know_their_rounding():
    thin = rsym.Shape(1 - (x / 6) ** 2 - (10 * y) ** 2, (x, y)).rotate(0.7)
    found = rsym.measure(thin, bounds=((-5, 5),) * 2)
    assert close(found.area, 6 * math.pi / 10)
    assert close(found.length, 24 * float(sp.elliptic_e(1 - sp.Rational(1, 60) ** 2)), 1e-11)
    ring = rsym.measure(rsym.disc(1) - rsym.disc(1 - 1e-6))
    assert abs(ring.area - math.pi * (2e-6 - 1e-12)) < ring.area.error < 1e-14
    assert abs(ring.length - 2 * math.pi * (2 - 1e-6)) < ring.length.error < 1e-12
    flat = rsym.measure(rsym.disc(1) - rsym.disc(0.5, (0.5 + 1e-7, 0)))  # they cross in an angle of 5e-4
    assert abs(flat.length - 9.422989106551829) < flat.length.error < 1e-11
