"""Coefficients, sources and masses that jump or have kinks on curves inside a shape, against exact solutions."""

import math
import pickle

import numpy as np
import pytest
import sympy as sp
from scipy.optimize import brentq

import rsym
from rsym import x, y, z
from rsym.problems.interfaces import interfaces_of

WHERE = sp.Rational(1, 7)
BOX = ((0, 1), (0, 1))


def square(*names):
    sides = zip((x, 1 - x, y, 1 - y), ("left", "right", "bottom", "top"), strict=True)
    left, right, bottom, top = (rsym.Shape(side, (x, y), bounds=BOX).named(name) for side, name in sides)
    return left & right & bottom & top


SQUARE = square()
ACROSS = {"left": 0, "right": 1}


def layers(first, second, where=WHERE):
    return sp.Piecewise((first, x < where), (second, True))


def error(solution, exact):
    """In the mean square, as a share of the largest value."""
    points, weights = solution.rule.points, solution.rule.weights
    values = solution.jets(points, 0)[0]
    apart = values - sp.lambdify((x, y), exact)(*points.T[:2])
    return math.sqrt(np.sum(weights * apart**2) / np.sum(weights)) / np.abs(values).max()


def rise(k, where=WHERE):
    """What rises from 0 to 1 through two layers, and what flows."""
    flow = 1 / (where / k[0] + (1 - where) / k[1])
    return sp.Piecewise((flow * x / k[0], x < where), (1 - flow * (1 - x) / k[1], True)), float(flow)


@pytest.mark.parametrize(("k", "most"), [((1, 10), 2e-6), ((1, 1000), 2e-5)])
def test_two_layers(k, most):
    exact, flow = rise(k)
    u = rsym.solve(SQUARE, "-div(k*grad(u)) = 0", ACROSS, letters={"k": layers(*k)}, cells=24)
    assert error(u, exact) < u.report.estimate
    assert error(u, exact) < most
    assert abs(u.flux("right") / flow - 1) < most
    assert abs(u.flux("left") / flow + 1) < most
    # The gradient on either side, and on the interface where x - 1/7 is positive.
    slopes = u.gradient([0.14, float(WHERE), 0.15], 0.5)[:, 0]
    assert np.allclose(slopes, flow / np.array([k[0], k[1], k[1]]), rtol=0, atol=1e-3 * flow)


def in_a_disc(inner, outer, radius):
    """k = inner within a radius, outer beyond, u = x on the unit circle."""
    a, b, c = sp.symbols("a b c")
    equations = [
        a * radius - b * radius - c / radius,
        inner * a - outer * (b - c / radius**2),
        b + c - 1,
    ]
    found = sp.solve(equations, [a, b, c])
    square = x**2 + y**2
    exact = sp.Piecewise((found[a] * x, square < radius**2), (x * (found[b] + found[c] / square), True))
    return sp.Piecewise((inner, square < radius**2), (outer, True)), exact


@pytest.mark.parametrize(("inner", "most"), [(10, 1e-5), (sp.Rational(1, 1000), 5e-5)])
def test_a_disc_in_a_disc(inner, most):
    k, exact = in_a_disc(inner, 1, sp.Rational(1, 2))
    u = rsym.solve(rsym.disc(1), "-div(k*grad(u)) = 0", x, letters={"k": k}, cells=24)
    assert error(u, exact) < u.report.estimate
    assert error(u, exact) < most
    assert u.report.interfaces == 1
    assert "1 interface of coefficients" in str(u.report)


def test_a_tolerance_is_met_without_a_warning():
    k, exact = in_a_disc(10, 1, sp.Rational(1, 2))
    u = rsym.solve(rsym.disc(1), "-div(k*grad(u)) = 0", x, letters={"k": k}, tolerance=1e-4)
    assert error(u, exact) < u.report.estimate < 1e-4


def test_a_jump_of_the_source():
    where = sp.Rational(2, 7)
    c, d = sp.symbols("c d")
    one, other = c * x - x**2 / 2, d * (1 - x) + sp.Rational(3, 2) * (1 - x) ** 2
    found = sp.solve([(one - other).subs(x, where), sp.diff(one - other, x).subs(x, where)], [c, d])
    exact = sp.Piecewise((one.subs(found), x < where), (other.subs(found), True))
    source = 2 * sp.Heaviside(where - x) - 1 - 2 * sp.Heaviside(x - where)
    u = rsym.solve(SQUARE, "-laplacian(u) = f", {"left": 0, "right": 0}, letters={"f": source}, cells=12)
    assert error(u, exact) < u.report.estimate
    assert error(u, exact) < 1e-5


def test_a_kink_of_a_coefficient():
    gap = sp.Abs(x - WHERE)
    rising = sp.sign(x - WHERE) * sp.log(1 + 5 * gap)
    low, high = (rising.subs(x, end) for end in (0, 1))
    u = rsym.solve(SQUARE, "-div(k*grad(u)) = 0", ACROSS, letters={"k": 1 + 5 * gap}, cells=24)
    assert error(u, (rising - low) / (high - low)) < min(u.report.estimate, 2e-6)
    assert abs(u.flux("right") / float(5 / (high - low)) - 1) < 1e-7


def test_convection_across_an_interface():
    """A form that is not symmetric: u = a + b exp(3 x/k) on both sides."""
    a, b, c, d = sp.symbols("a b c d")
    one, other = a + b * sp.exp(3 * x), c + d * sp.exp(3 * x / 10)
    jumps = (one - other, sp.diff(one, x) - 10 * sp.diff(other, x))
    ends = [one.subs(x, 0), other.subs(x, 1) - 1, *(jump.subs(x, WHERE) for jump in jumps)]
    found = sp.solve(ends, [a, b, c, d])
    exact = sp.Piecewise((one.subs(found), x < WHERE), (other.subs(found), True))
    equation = "-div(k*grad(u)) + 3*diff(u, x) = 0"
    u = rsym.solve(SQUARE, equation, ACROSS, letters={"k": layers(1, 10)}, cells=24)
    assert error(u, exact) < u.report.estimate
    assert error(u, exact) < 5e-6


def test_a_hole_at_an_unknown_level_within_an_interface():
    """What flows out of the bore is given; by r u_r = -1/(2 pi k)."""
    ring = rsym.disc(1).named("rim") - rsym.disc(sp.Rational(1, 2)).named("bore")
    k = sp.Piecewise((1, x**2 + y**2 < sp.Rational(9, 16)), (10, True))
    u = rsym.solve(ring, "-div(k*grad(u)) = 0", {"rim": 0, "bore": rsym.constant(1)}, letters={"k": k}, cells=24)
    ((_, level),) = u.levels
    assert abs(level / ((math.log(4 / 3) / 10 + math.log(3 / 2)) / (2 * math.pi)) - 1) < 2e-6


def test_a_weak_form_is_the_same_problem():
    k = layers(1, 10)
    form = {"inside": lambda u, v, w: w.k * (u.grad @ v.grad)}
    one = rsym.solve_form(SQUARE, form, lambda v, w: 0 * v, ACROSS, letters={"k": k}, cells=12, estimate=False)
    other = rsym.solve(SQUARE, "-div(k*grad(u)) = 0", ACROSS, letters={"k": k}, cells=12, estimate=False)
    assert one(0.3, 0.3) == pytest.approx(other(0.3, 0.3), abs=1e-12)


def test_an_interface_moves_with_letters_and_is_pickled():
    a = sp.Symbol("a", real=True)
    k = layers(1, 10, a)
    u = rsym.solve(SQUARE, "-div(k*grad(u)) = 0", ACROSS, letters={"k": k, "a": WHERE}, cells=24, estimate=False)
    assert pickle.loads(pickle.dumps(u))(0.3, 0.3) == u(0.3, 0.3)
    exact, _ = rise((1, 10), sp.Rational(2, 5))
    assert error(u.with_letters({"a": 0.4}), exact) < 2e-6


@pytest.mark.parametrize("masses", [(1, 1), (1, 3)])
def test_modes_of_two_layers(masses):
    (one, other), a = masses, float(WHERE)

    def determinant(value):
        first, second = math.sqrt(value * one), math.sqrt(value * other / 10)
        left, right = math.sqrt(one), math.sqrt(10 * other)
        across = left * math.cos(first * a) * math.sin(second * (1 - a))
        return across + right * math.sin(first * a) * math.cos(second * (1 - a))

    exact = brentq(determinant, 5, 60, xtol=1e-13)
    mass = one if one == other else sp.Piecewise((one, x < WHERE), (other, True))
    ends, equation = {"left": 0, "right": 0}, "-div(k*grad(u)) = 0"
    found = rsym.modes(SQUARE, 1, ends, equation=equation, letters={"k": layers(1, 10)}, mass=mass, cells=16)
    assert abs(found.values[0] / exact - 1) < 2e-7


def test_a_plate_under_a_load_that_jumps():
    """A clamped disc, loaded within half of its radius: third derivatives have kinks."""
    r = sp.Symbol("r", positive=True)
    a, b, c, d, e, f = sp.symbols("a b c d e f")
    inner = r**4 / 64 + a + b * r**2
    outer = c + d * r**2 + (e + f * r**2) * sp.log(r)
    jumps = [sp.diff(inner - outer, r, order).subs(r, sp.Rational(1, 2)) for order in range(4)]
    found = sp.solve([*jumps, outer.subs(r, 1), sp.diff(outer, r).subs(r, 1)], [a, b, c, d, e, f])
    radius = sp.sqrt(x**2 + y**2)
    within = x**2 + y**2 < sp.Rational(1, 4)
    exact = sp.Piecewise((inner.subs(found).subs(r, radius), within), (outer.subs(found).subs(r, radius), True))
    load = sp.Piecewise((1, within), (0, True))
    u = rsym.solve(rsym.disc(1), "bilaplacian(u) = q", {...: rsym.clamped()}, letters={"q": load}, cells=12)
    assert error(u, exact) < u.report.estimate < 1e-4


def test_a_ball_in_a_ball_about_an_axis():
    a, b, c, radius = *sp.symbols("a b c"), sp.Rational(1, 2)
    jumps = [(a - b) * radius - c / radius**2, 10 * a - b + 2 * c / radius**3]
    found = sp.solve([*jumps, b + c - 1], [a, b, c])
    away = x**2 + y**2
    exact = sp.Piecewise(
        (found[a] * y, away < radius**2), (y * (found[b] + found[c] / away ** sp.Rational(3, 2)), True)
    )
    half = rsym.disc(1).named("rim") & rsym.half_plane((1, 0), 0)
    k = sp.Piecewise((10, away < radius**2), (1, True))
    u = rsym.solve(half, "-div(k*grad(u)) = 0", {"rim": y}, axis=y, letters={"k": k}, cells=16)
    assert error(u, exact) < u.report.estimate < 1e-3


def test_layers_in_space():
    sides = [rsym.Shape(side, (x, y, z), bounds=(*BOX, (0, 1))) for side in (y, 1 - y, z, 1 - z)]
    left, right = (rsym.Shape(side, (x, y, z), bounds=(*BOX, (0, 1))) for side in (x, 1 - x))
    cube = left.named("left") & right.named("right") & sides[0] & sides[1] & sides[2] & sides[3]
    u = rsym.solve(cube, "-div(k*grad(u)) = 0", ACROSS, letters={"k": layers(1, 10)}, cells=5, degree=2)
    assert error(u, rise((1, 10))[0]) < u.report.estimate < 0.03


def test_what_makes_solutions_less_smooth_is_told():
    plate = rsym.rectangle(1, 1)
    corner = sp.Piecewise((10, (x > 0) & (y > 0)), (1, True))
    assert interfaces_of(plate, [corner]).doubts == ("interfaces meet at (0, 0)",)
    assert "askew" in interfaces_of(plate, [sp.sign(x + 2 * y)]).doubts[0]
    assert "floor" in interfaces_of(plate, [sp.floor(3 * x)]).doubts[0]
    node = sp.sign(y**2 - x**2 * (x + sp.Rational(1, 3)))
    assert interfaces_of(plate, [node]).doubts[0].startswith("an interface has a node, or nearly, near (-0.00")
    touching = sp.sign(x**2 + (y - sp.Rational(1, 4)) ** 2 - sp.Rational(1, 16))
    assert interfaces_of(plate, [touching]).doubts == ("an interface runs askew into the boundary at (0, 0.5)",)
    assert interfaces_of(plate, [sp.sign(3 * x)]).doubts == ()
    assert interfaces_of(plate, [sp.Abs(x + 1), sp.Max(x, 1)]).functions == ()
    u = rsym.solve(plate, "-div(k*grad(u)) = 1", 0, letters={"k": corner}, cells=8)
    assert "interfaces meet at (0, 0)" in str(u.report)
    finer = rsym.solve(plate, "-div(k*grad(u)) = 1", 0, letters={"k": corner}, cells=24, estimate=False)
    points, weights = finer.rule.points, finer.rule.weights
    values = finer.jets(points, 0)[0]
    apart = math.sqrt(np.sum(weights * (u.jets(points, 0)[0] - values) ** 2)) / np.abs(values).max()
    assert apart < u.report.estimate


@pytest.mark.parametrize("share", [0.01, 0.001, 0.0001])
def test_a_boundary_layer_is_told(share):
    u = rsym.solve(SQUARE, "-k*laplacian(u) + u = 1", {"left": 0, "right": 0}, letters={"k": share}, cells=16)
    steep = 1 / math.sqrt(share)
    exact = 1 - sp.cosh(steep * (x - sp.Rational(1, 2))) / math.cosh(steep / 2)
    assert error(u, exact) < u.report.estimate
