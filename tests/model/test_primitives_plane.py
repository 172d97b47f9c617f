"""Signed primitives of the plane: normalised at random boundary points, right inside and outside, boxed in."""

import numpy as np
import pytest
import sympy as sp
from oracles.boundary_points import assert_normalised, boundary_points, random_motion
from oracles.closeness import assert_close

import rsym
from rsym import RsymError, x, y
from rsym.model.primitives.plane import disc, ellipse, half_plane, line, rectangle, strip, superellipse

a, b, c, n = sp.symbols("a b c n", real=True)
VALUES = {a: sp.Rational(9, 4), b: 0.8, c: -0.3, n: 2.5}
FAR = ((-4, 4), (-4, 4))


def given(*letters):
    return {letter: VALUES[letter] for letter in letters}


# Shape, order, and whether a point is inside, written apart.
PIECES = {
    "half-plane": (
        half_plane((a, b), c, letters=given(a, b, c)),
        4,
        lambda u, v: 2.25 * u + 0.8 * v > -0.3 * np.hypot(2.25, 0.8),
    ),
    "strip": (
        strip(c, b, (3, a), letters=given(a, b, c)),
        1,
        lambda u, v: abs((3 * u + 2.25 * v) / 3.75 - 0.25) < 0.55,
    ),
    "line": (
        line((c, 1), (a, b), letters=given(a, b, c)),
        4,
        lambda u, v: v < 1 - 0.2 / 2.55 * (u + 0.3),
    ),
    "disc": (
        disc(a, (c, b), letters=given(a, b, c)),
        1,
        lambda u, v: np.hypot(u + 0.3, v - 0.8) < 2.25,
    ),
    "exact disc": (
        disc(a, (c, b), True, letters=given(a, b, c)),
        4,
        lambda u, v: np.hypot(u + 0.3, v - 0.8) < 2.25,
    ),
    "ellipse": (
        ellipse(a, b, (c, 1), letters=given(a, b, c)),
        1,
        lambda u, v: np.hypot((u + 0.3) / 2.25, (v - 1) / 0.8) < 1,
    ),
    "narrow ellipse": (
        ellipse(b, a, length=3, letters=given(a, b)),
        1,
        lambda u, v: np.hypot(u / 0.8, v / 2.25) < 1,
    ),
    "squircle": (
        superellipse(a, b, 4, letters=given(a, b)),
        1,
        lambda u, v: (u / 2.25) ** 4 + (v / 0.8) ** 4 < 1,
    ),
    "cubic": (
        superellipse(a, a, 3, letters=given(a)),
        1,
        lambda u, v: abs(u) ** 3 + abs(v) ** 3 < 2.25**3,
    ),
    "lens": (
        superellipse(a, b, 1.5, letters=given(a, b)),
        1,
        lambda u, v: abs(u / 2.25) ** 1.5 + abs(v / 0.8) ** 1.5 < 1,
    ),
    "exponent in letters": (
        superellipse(a, b, n, (0, c), letters=given(a, b, c, n)),
        1,
        lambda u, v: abs(u / 2.25) ** 2.5 + abs((v + 0.3) / 0.8) ** 2.5 < 1,
    ),
    "rectangle": (
        rectangle(a, b, (c, 1), letters=given(a, b, c)),
        1,
        lambda u, v: (abs(u + 0.3) < 1.125) & (abs(v - 1) < 0.4),
    ),
}
BOUNDED = [name for name, (shape, *_) in PIECES.items() if shape.box]


@pytest.mark.random
@pytest.mark.parametrize("name", PIECES)
def test_normalised_to_the_order_it_states(name):
    shape, order, _ = PIECES[name]
    for seed in range(3):
        assert_normalised(random_motion(shape, seed, bounds=(shape.box and shape.box.ends) or FAR), order, seed=seed)


@pytest.mark.parametrize("name", PIECES)
def test_positive_inside_and_negative_outside(name):
    shape, _, inside = PIECES[name]
    points = 8 * np.random.default_rng(1).random((2, 4000)) - 4
    value = rsym.compile(shape)(*points)["value"]
    assert 0.02 < inside(*points).mean() < 0.98
    assert ((value > 0) == inside(*points)).all()
    assert np.isfinite(value).all()


@pytest.mark.random
@pytest.mark.parametrize("name", BOUNDED)
def test_bounds_leave_a_tenth_of_the_largest_side_free(name):
    shape = PIECES[name][0]
    low, high = np.array(shape.box.ends).T
    wide = tuple(zip(low - 1, high + 1, strict=True))
    points, _ = boundary_points(shape, 2000, bounds=wide, clearance=0)
    extent = np.ptp(np.asarray(points, float), axis=0)
    room = 0.1 * extent.max()
    assert_close(np.asarray(points, float).min(axis=0) - room, low, atol=0.02)
    assert_close(np.asarray(points, float).max(axis=0) + room, high, atol=0.02)


def test_an_ellipse_of_length_one_is_that_of_the_source():
    seed = 1 - x**2 / 9 - y**2 / 4
    seed = seed / sp.sqrt(seed**2 + 4 * x**2 / 81 + 4 * y**2 / 16)
    assert sp.simplify(ellipse(3, 2, length=1).expression - seed) == 0


def test_an_ellipse_twice_as_large_has_values_twice_as_large():
    points = np.random.default_rng(2).random((2, 100)) * 4 - 2
    small, large = rsym.compile(ellipse(1.5, 0.5)), rsym.compile(ellipse(3, 1))
    assert_close(large(*(2 * points))["value"], 2 * small(*points)["value"], rtol=1e-14)


@pytest.mark.parametrize("exponent", [1.75, 2, 2.5, 3, 4, 5, 40])
def test_superellipses_are_normalised_where_they_cross_their_axes(exponent):
    gradient = rsym.compile(superellipse(2, 1, exponent), fields=("gradient",))([2.0, -2.0, 0, 0], [0, 0, 1.0, -1.0])
    assert_close(gradient["gradient"], [[-1, 0], [1, 0], [0, -1], [0, 1]], atol=1e-12)


def test_letters_stay_letters():
    shape = rectangle(a, b, letters={a: 3, b: rsym.Letter(1, minimum=0.5)})
    assert shape.letters["b"].minimum == 0.5
    value = rsym.compile(shape)
    assert value(1.9, 0, letters={a: 4})["value"] > 0 > value(1.9, 0)["value"]
    assert set(superellipse(a, b, n, letters=given(a, b, n)).letters) == {"a", "b", "n"}


@pytest.mark.parametrize(
    ("make", "code"),
    [
        (lambda: half_plane((0, 0)), "direction"),
        (lambda: half_plane((1, 0), "far"), "number"),
        (lambda: half_plane((1, 0), a), "unknown-letter"),
        (lambda: half_plane((1, 0, 0)), "point"),
        (lambda: strip(1, 1), "interval"),
        (lambda: strip(a, b, letters=given(a, b)), "interval"),
        (lambda: line((1, 2), (1, 2)), "direction"),
        (lambda: line((a, 2), (1, 2)), "unknown-letter"),
        (lambda: disc(0), "positive"),
        (lambda: disc(c, letters=given(c)), "positive"),
        (lambda: disc(1, (0, 0, 0)), "point"),
        (lambda: ellipse(1, -1), "positive"),
        (lambda: ellipse(2, 1, length=0), "positive"),
        (lambda: superellipse(2, 1, 1), "exponent"),
        (lambda: superellipse(2, 1, n, letters={n: 0.5}), "exponent"),
        (lambda: rectangle(1, sp.oo), "number"),
    ],
)
def test_what_cannot_be_is_refused(make, code):
    with pytest.raises(RsymError) as caught:
        make()
    assert caught.value.code == code
