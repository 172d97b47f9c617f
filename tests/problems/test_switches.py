"""Conditions that change on a smooth edge: Motz's problem, an arc, two places on one edge, and what is refused."""

import math
import pickle

import numpy as np
import pytest
import sympy as sp
from numpy.polynomial import legendre

import rsym
from rsym import x, y

MOTZ = 401.162453745234416  # Georgiou, Olson and Smyrlis (1996), Comm. Numer. Methods Eng. 12


def side(normal, distance, name):
    return rsym.half_plane(normal, distance).named(name)


BOX = side((1, 0), -1, "left") & side((-1, 0), -1, "right") & side((0, 1), 0, "low") & side((0, -1), -1, "top")
LEFT = rsym.half_plane((-1, 0), 0)


def expansion(count=30, points=60):
    """The coefficients of r**(k - 1/2) cos((k - 1/2) theta) in Motz's problem, fitted to the other three sides."""
    t, w = legendre.leggauss(points)
    rates = np.arange(count) + 0.5

    def slopes(z):
        """Both derivatives of the functions, of a size for largest radii."""
        powers = rates * z[:, None] ** (rates - 1) / 1.2**rates
        return powers.real, -powers.imag

    values = ((1 + 1j * (t + 1) / 2)[:, None] ** rates / 1.2**rates).real
    rows = np.vstack([values, slopes(-1 + 1j * (t + 1) / 2)[0], slopes(t + 1j)[1]])
    scale = np.sqrt(np.tile(w, 3))
    right = np.repeat([500.0, 0.0, 0.0], points)
    return np.linalg.lstsq(rows * scale[:, None], right * scale, rcond=1e-15)[0] / 1.2**rates


def motz(**more):
    conditions = {"right": 500, "low": rsym.switched(LEFT, 0, rsym.neumann())}
    return rsym.solve(BOX, "-laplacian(u) = 0", conditions, **more)


def test_the_problem_of_motz():
    coefficients = expansion()
    assert abs(coefficients[0] / MOTZ - 1) < 1e-11
    found = motz(cells=32, degree=5)
    z = np.array([0.3 + 0.4j, -0.5 + 0.5j, 0.9 + 0.1j, 0.01 + 0.01j, 0.5])
    exact = (z[:, None] ** (np.arange(30) + 0.5)).real @ coefficients
    assert np.abs(found(z.real, z.imag) - exact).max() < 5e-4  # of 500
    tip = 1e-10
    assert abs(found(tip, 0) / math.sqrt(tip) / MOTZ - 1) < 1e-5
    assert abs(found(-np.array([0.1, 0.5, 0.9]), 0)).max() < 1e-12
    assert abs(found.flux()) < 0.1 < abs(motz(cells=16, corners=False).flux())  # nothing comes out in all
    assert found.minimum().value == pytest.approx(0, abs=1e-9)
    assert found.maximum().value == pytest.approx(500, rel=1e-9)
    again = pickle.loads(pickle.dumps(found))
    assert again(0.3, 0.4) == found(0.3, 0.4)


@pytest.mark.parametrize("where", [-1000 * x, -x / 10**6, rsym.rectangle(1, 4, (sp.Rational(-1, 2), 0)) | LEFT])
def test_the_size_of_what_tells_where_conditions_change_does_not_matter(where):
    found = rsym.solve(
        BOX, "-laplacian(u) = 0", {"right": 500, "low": rsym.switched(where, 0, rsym.neumann())}, cells=16
    )
    exact = ((0.3 + 0.4j) ** (np.arange(30) + 0.5)).real @ expansion()
    assert found(0.3, 0.4) == pytest.approx(exact, abs=0.4)  # of 500


@pytest.mark.parametrize("shape", [rsym.disc(1).named("rim"), rsym.rectangle(2, 1).named("rim")], ids=["disc", "box"])
def test_the_sign_alone_tells_where_conditions_change(shape):
    """Of the box what is left and right is one leaf, on which nothing changes, as are the others, each cut twice."""

    def solved(where):
        place = {"rim": rsym.switched(where, 0, rsym.neumann())}
        return rsym.solve(shape, "-laplacian(u) = 1", place, cells=12)([0.3, -0.5], [0.2, 0.1])

    plain = solved(x)
    for where in (sp.tanh(100 * x), sp.exp(9 * x) - 1, x / sp.sqrt(x**2 + sp.Rational(1, 1000))):
        np.testing.assert_allclose(solved(where), plain, rtol=1e-8)


def test_what_is_too_steep_or_flat_is_refused():
    for where, told in ((sp.tanh(10**4 * x), "no zero between is found"), (x**3, "no zero between is found")):
        with pytest.raises(rsym.RsymError, match=told):
            rsym.solve(rsym.disc(1), "-laplacian(u) = 1", {...: rsym.switched(where, 0, rsym.neumann())}, cells=8)
    ring = rsym.Shape((1 - x**2 - y**2) * (x**2 + y**2 - sp.Rational(1, 4)), (x, y))
    bent = rsym.switched(sp.tanh(20 * (y - sp.sin(3 * x))), 0, rsym.neumann())
    with pytest.raises(rsym.RsymError, match=r"is steep at \(.*x instead of tanh"):
        rsym.solve(ring, "-laplacian(u) = 1", {...: bent}, cells=16)


def test_places_too_near_to_each_other_for_cells_are_told():
    strip = rsym.switched(sp.Rational(1, 100) - (x - sp.Rational(1, 7)) ** 2, 0, rsym.neumann())

    def solved(cells):
        return rsym.solve(BOX, "-laplacian(u) = 1", {"low": strip}, cells=cells)

    with pytest.raises(rsym.RsymError, match=r"0\.2 from there, .*ask for 21 cells at least; 51 are enough"):
        solved(16)
    with pytest.warns(rsym.RsymWarning, match=r"0\.2 from there, .* remedy: 51 cells"):
        solved(21)


def test_values_on_both_sides_of_a_place_that_agree_there():
    found = rsym.solve(BOX, "-laplacian(u) = 0", {"low": rsym.switched(LEFT, -x, x), "top": 1}, cells=12)
    assert found([-0.5, 0.25], 0) == pytest.approx([0.5, 0.25], abs=1e-12)
    assert found(-0.3, 0.4) == pytest.approx(found(0.3, 0.4), abs=1e-9)


@pytest.mark.parametrize(
    "where", [rsym.disc(0.1, (0, 5)), ~rsym.disc(0.3, (0, 0.3)), rsym.half_plane((-1, 0), -1), -y - 1]
)
def test_where_nothing_changes_one_condition_holds(where):
    """What is beside the edge, touches it or has a corner of it alone is not cut: the bits are those of one value."""
    inside, outside = (0, 1) if rsym.switched(where, 0, 1).where.subs({x: 0.5, y: 0}) > 0 else (1, 0)
    one = rsym.solve(BOX, "-laplacian(u) = 1", {"low": 0}, cells=8)
    found = rsym.solve(BOX, "-laplacian(u) = 1", {"low": rsym.switched(where, inside, outside)}, cells=8)
    assert np.array_equal(found.coefficients, one.coefficients)


def test_an_edge_in_two_pieces_of_which_each_has_its_own_condition():
    shape = (BOX - rsym.disc(0.25).named("notch")).replace(bounds=((-2, 2), (-1, 2)))
    found = rsym.solve(
        shape, "-laplacian(u) = 0", {"low": rsym.switched(LEFT, 0, rsym.neumann()), "right": 1}, cells=12
    )
    assert np.abs(found([-0.9, -0.3], 0)).max() < 1e-12 < 0.3 < found(0.5, 0)


def test_values_that_letters_take_off_the_edge_fix_no_level():
    a = sp.Symbol("a", real=True)
    shape = BOX.replace(letters={a: 0})
    found = rsym.solve(shape, "-laplacian(u) = 1", {"low": rsym.switched(a - x, 0, rsym.neumann())}, cells=8)
    assert found.with_letters({"a": 1})(0.3, 0.4) == pytest.approx(0.4 - 0.08, abs=1e-12)
    with pytest.raises(rsym.RsymError, match="nothing fixes the level"):
        found.with_letters({"a": -1})


def test_values_on_an_axis_are_those_of_no_edge():
    half = rsym.disc(1).named("rim") & rsym.half_plane((1, 0), 0).named("axis")
    change = rsym.switched(rsym.half_plane((0, 1), 0), 0, rsym.neumann(-2))
    found = rsym.solve(half, "-laplacian(u) = 6", {...: change}, axis=y, cells=12)
    assert found([0.0, 0.3], [0.2, -0.5]) == pytest.approx([0.96, 0.66], abs=2e-3)
    with pytest.raises(rsym.RsymError, match="no value of u can be held"):
        rsym.solve(half, "-laplacian(u) = 6", {"rim": 0, "axis": change}, axis=y, cells=12)


def test_a_form_has_values_that_change_on_an_edge():
    """The flux of the form holds where no value does."""
    place = {"right": 1, "low": rsym.switched(LEFT, 0, rsym.robin(3, 1))}
    wanted = rsym.solve(BOX, "-laplacian(u) = 1", place, cells=8)
    found = rsym.solve_form(
        BOX,
        {"inside": lambda u, v, w: u.grad @ v.grad, "low": lambda u, v, w: 3 * u * v},
        {"inside": lambda v, w: v, "low": lambda v, w: v},
        {"right": 1, "low": rsym.switched(LEFT, 0, rsym.neumann())},
        cells=8,
    )
    assert np.array_equal(found.coefficients, wanted.coefficients)
    with pytest.raises(rsym.RsymError, match="'low' is one on the flux"):
        rsym.solve_form(BOX, lambda u, v, w: u.grad @ v.grad, lambda v, w: v, place, cells=8)


def test_conditions_that_change_on_an_arc():
    """The real part of the root of i*(1 - z)/(1 + z), which is real above on the circle and imaginary below."""
    size = (1 + x) ** 2 + y**2
    real, imaginary = 2 * y / size, (1 - x**2 - y**2) / size
    exact = sp.root(real**2 + imaginary**2, 4) * sp.cos(sp.atan2(imaginary, real) / 2)
    shape = rsym.disc(1).named("rim") & side((1, 0), -0.5, "cut")
    conditions = {"rim": rsym.switched(-y, 0, rsym.neumann()), "cut": rsym.neumann(-sp.diff(exact, x))}
    found = rsym.solve(shape, "-laplacian(u) = 0", conditions, cells=24, degree=5)
    (corner,) = (one for one in found.problem.corners.corners if one.is_flat)
    assert corner.point == pytest.approx((1, 0), abs=1e-12)
    assert corner.natural == (True, False)
    u, v = np.array([0.5, -0.4, 0.5, 0.9]), np.array([0.3, 0.2, -0.5, 0.1])
    assert np.abs(found(u, v) - sp.lambdify((x, y), exact)(u, v)).max() < 1e-4
    angles = -np.array([0.1, 0.5, 1.5])
    assert np.abs(found.jets(np.stack([np.cos(angles), np.sin(angles)], axis=1), 0)).max() < 1e-13


def test_a_part_whose_condition_changes_meets_another_with_values():
    """The real part of the root of z: its energy about the corner (-1, 0) is finite, and so is that of the lift."""
    exact = sp.sqrt((sp.sqrt(x**2 + y**2) + x) / 2)
    conditions = {
        "low": rsym.switched(LEFT, 0, rsym.neumann()),
        "left": exact,
        "right": rsym.neumann(sp.diff(exact, x)),
        "top": rsym.neumann(sp.diff(exact, y)),
    }
    found = rsym.solve(BOX, "-laplacian(u) = 0", conditions, cells=16)
    z = np.array([0.3 + 0.4j, -0.5 + 0.5j, 0.9 + 0.1j, -0.8 + 0.05j, -0.95 + 0.02j])
    assert np.abs(found(z.real, z.imag) - np.sqrt(z).real).max() < 5e-4
    assert found.flux("left") == pytest.approx(-0.0986841134678, abs=0.03)  # integrals of slopes near a corner


def test_two_places_on_one_edge_with_letters():
    """u = 0 between both, which letters move; the solution is even."""
    a = sp.Symbol("a", real=True)
    shape = BOX.replace(letters={a: sp.Rational(1, 2)})
    held = {"low": rsym.switched(a**2 - x**2, 0, rsym.neumann()), "top": rsym.neumann(1)}
    found = rsym.solve(shape, "-laplacian(u) = 0", held, cells=32)
    for one, place in ((found, 0.5), (found.with_letters({"a": 0.25}), 0.25)):
        flat = [corner for corner in one.problem.corners.corners if corner.is_flat]
        assert [corner.point for corner in flat] == [pytest.approx((sign * place, 0), abs=1e-12) for sign in (-1, 1)]
        assert all(corner.reach <= 2 * place for corner in flat)
        assert one(0.3, 0.6) == pytest.approx(one(-0.3, 0.6), rel=1e-5)
        assert abs(one(0.9 * place, 0)) < 1e-12 < 1e-2 < one(1.1 * place, 0)
        assert one.flux("low") == pytest.approx(-2, rel=3e-2)
    assert rsym.modes(shape, 1, held | {"top": rsym.neumann()}, cells=12).values[0] > 0.1


def test_letters_of_what_tells_where_conditions_change_are_letters_of_the_problem():
    a = sp.Symbol("a", real=True)
    half = rsym.Shape(a - x, (x, y), letters={a: 0.25})

    def solved(where, letters=None):
        return rsym.solve(
            BOX, "-laplacian(u) = 1", {"low": rsym.switched(where, 0, rsym.neumann())}, cells=8, letters=letters
        )

    found, wanted = solved(half), solved(0.25 - x)
    assert found(0.3, 0.4) == pytest.approx(wanted(0.3, 0.4), rel=1e-12)
    moved = solved(-0.5 - x)(0.3, 0.4)
    assert found.with_letters({"a": -0.5})(0.3, 0.4) == pytest.approx(moved, rel=1e-12)
    assert solved(half, {"a": -0.5})(0.3, 0.4) == pytest.approx(moved, rel=1e-12)
    assert pickle.loads(pickle.dumps(found))(0.3, 0.4) == found(0.3, 0.4)


@pytest.mark.parametrize(
    ("ask", "message"),
    [
        (lambda: rsym.switched(LEFT, 0, rsym.constant()), "values and fluxes"),
        (lambda: rsym.solve(BOX, "bilaplacian(u) = 1", {"low": rsym.switched(LEFT, 0, 1)}), "order 2"),
        (lambda: rsym.solve(BOX, "-laplacian(u) = 1", rsym.switched(sp.Symbol("q"), 0, 1)), "neither coordinate"),
        (lambda: rsym.solution_structure(BOX, {"low": rsym.switched(LEFT, 0, rsym.neumann())}), "no formula"),
        (lambda: rsym.interpolate(BOX, {"low": rsym.switched(LEFT, 0, 1)}), "condition"),
        (
            lambda: rsym.solve(BOX, "-laplacian(u) = 1", {"right": 1, "low": rsym.switched(x, 0, rsym.neumann())}),
            "meet at",
        ),
        (lambda: rsym.solve(BOX, "-laplacian(u) = 1", {"low": rsym.switched(x**3, 0, rsym.neumann())}), "no slope"),
        (lambda: rsym.solve(BOX, "-laplacian(u) = 1", {"low": rsym.switched(y, 0, rsym.neumann())}), "no slope"),
        (lambda: rsym.solve(BOX, "-laplacian(u) = 1", {"low": rsym.switched(sp.sign(x), 0, rsym.neumann())}), "jumps"),
    ],
)
def test_what_cannot_be_is_refused(ask, message):
    with pytest.raises(rsym.RsymError, match=message):
        ask()
