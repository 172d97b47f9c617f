"""Values on the boundary that are Python functions: what expressions of the same values give."""

import pickle

import numpy as np
import pytest
import sympy as sp

import rsym
from rsym import x, y, z

HEAT, SINE = "-laplacian(u) = 0", np.sin(1)
RING = rsym.disc(2).named("rim") - rsym.disc(1).named("bore")
SQUARE = (
    rsym.Shape(x, (x, y)).named("left")
    & rsym.Shape(1 - x, (x, y)).named("right")
    & rsym.Shape(y, (x, y)).named("bottom")
    & rsym.Shape(1 - y, (x, y)).named("top")
)


def polar(u, v):
    return np.cos(3 * np.arctan2(v, u))


def on_boundary_alone(u, v):
    return np.where(np.abs(u**2 + v**2 - 1) < 1e-9, u, np.nan)


CASES = {
    "smooth": (rsym.disc(1), lambda u, v: np.exp(u) * np.cos(v), sp.exp(x) * sp.cos(y), (0.3, 0.4)),
    "polar": (rsym.disc(1), polar, 4 * x**3 - 3 * x, (0.3, 0.4)),
    "nothing inside": (rsym.disc(1), on_boundary_alone, x, (0.3, 0.4)),
    "waves": (rsym.ellipse(1, 0.5), lambda u, v: np.sin(10 * u), sp.sin(10 * x), (0.3, 0.1)),
    "parts": (RING, {"rim": lambda u, v: u, "bore": polar}, {"rim": x, "bore": 4 * x**3 - 3 * x}, (0.5, 1.3)),
    "some": (
        SQUARE,
        {"left": lambda u, v: np.sin(v), "right": sp.E * sp.sin(y), "bottom": 0, "top": lambda u, v: SINE * np.exp(u)},
        sp.exp(x) * sp.sin(y),
        (0.3, 0.4),
    ),
    "space": (rsym.sphere(1), lambda u, v, w: u * v + w**3, x * y + z**3, (0.1, 0.2, 0.3)),
    "a switch": (
        RING,
        {"rim": rsym.switched(y, lambda u, v: u, rsym.neumann()), "bore": 0},
        {"rim": rsym.switched(y, x, rsym.neumann()), "bore": 0},
        (0.5, 1.3),
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", CASES)
def test_functions_agree_with_expressions(name):
    shape, functions, expressions, place = CASES[name]
    cells = 4 if shape.dimension == 3 else 24
    u, v = (rsym.solve(shape, HEAT, given, cells=cells) for given in (functions, expressions))
    assert u.report.estimate < 0.02
    assert abs(u(*place) - v(*place)) <= 3 * (u.report.estimate + v.report.estimate)


def test_tables_are_met_as_well_as_they_say():
    steps = np.linspace(0, 1, 41)
    top = {"top": lambda u, v: np.interp(u, steps, np.exp(steps)) * SINE}
    rest = {"left": sp.sin(y), "right": sp.E * sp.sin(y), "bottom": 0}
    u = rsym.solve(SQUARE, HEAT, top | rest, cells=16)
    assert 1e-5 < u.report.estimate < 1e-3
    assert abs(u(0.3, 0.4) - np.exp(0.3) * np.sin(0.4)) <= 3 * u.report.estimate
    assert "Functions given on the boundary are met" in str(u.report)
    with pytest.warns(rsym.RsymWarning, match="above the tolerance"):
        u = rsym.solve(SQUARE, HEAT, top | rest, tolerance=1e-6)
    assert u.report.estimate > 1e-5


@pytest.mark.parametrize(
    ("function", "words"),
    [
        (lambda u, v: np.where(u > 0.3, 1.0, 0.0), r"'top' jumps.* at \(0\.30"),
        (lambda u, v: np.log(u - 0.5), r"undefined at \(0\.00"),
        (lambda u, v: np.sign(np.sin(40 * u)), "polynomials are off by"),
    ],
)
def test_functions_that_no_polynomial_follows_are_refused_with_the_place(function, words):
    with np.errstate(all="ignore"), pytest.raises(rsym.RsymError, match=words):
        rsym.solve(SQUARE, HEAT, {"top": function}, cells=8)


def test_letters_move_the_boundary_of_a_function():
    shape = rsym.Shape(sp.Symbol("a") ** 2 - x**2 - y**2, (x, y), letters={"a": 1})
    u = rsym.solve(shape, HEAT, lambda u, v: u / (u**2 + v**2), cells=12)
    assert u(0.5, 0) == pytest.approx(0.5, abs=1e-9)
    assert u.with_letters({"a": 2})(0.5, 0) == pytest.approx(0.125, abs=1e-9)
    assert pickle.loads(pickle.dumps(u))(0.5, 0) == u(0.5, 0)


def test_plates_and_bodies_take_functions():
    plate = rsym.clamped(lambda u, v: u**2, lambda u, v: 2 * u**2)
    assert rsym.solve(rsym.disc(1), "bilaplacian(u) = 0", plate, cells=8)(0.5, 0.1) == pytest.approx(0.25, abs=1e-9)
    moved = [{"bore": {"x": one, "y": 0}, "rim": rsym.fixed()} for one in (lambda u, v: u * v, x * y)]
    both = [rsym.elasticity(RING, one, young=1, poisson=0.3, cells=16).displacement(1.2, 0.3) for one in moved]
    assert np.abs(np.array(both[0]) - both[1]).max() < 1e-12
