"""A derivative that does not exist is NaN, one that does is the derivative: by difference quotients of 200 digits.

The oracle looks at a function around a point in 24 directions, nothing else. A gradient exists where the quotients are
linear in the direction, a Hessian where what is left is quadratic.
"""

from __future__ import annotations

import itertools
import math

import mpmath as mp
import numpy as np
import pytest
import sympy as sp
from oracles.closeness import assert_close

import rsym
from rsym import x, y, z
from rsym.program.fields import program_of

HALF = sp.Rational(1, 2)
STEP, DIGITS = mp.mpf(10) ** -40, 200
FIELDS = ("value", "gradient", "hessian", "singular")


def piecewise(*pairs):
    return sp.Piecewise(*pairs)


CASES = {
    "kink": (y + piecewise((0, x < 0), (x, True)), (0, 1)),
    "kink beside it": (y + piecewise((0, x < 0), (x, True)), (HALF, 1)),
    "jump": (y + piecewise((0, x < 0), (1, True)), (0, 1)),
    "x sign x": (x * sp.sign(x) + y**2, (0, 1)),
    "x^2 sign x": (x**2 * sp.sign(x) + y**2, (0, 1)),
    "x^3 sign x": (x**3 * sp.sign(x) + y**2, (0, 1)),
    "sign": (y + sp.sign(x) / 4, (0, 0)),
    "sign of a square": (y + sp.sign(x) ** 2, (0, 1)),
    "sign off its zero": (y * sp.sign(x), (-1, 2)),
    "cut": (sp.atan2(y, x), (-1, 0)),
    "before the cut": (sp.atan2(y, x), (1, 0)),
    "no cut": (sp.atan2(y**2, x), (-1, 0)),
    "whole turns": (sp.cos(3 * sp.atan2(y, x) + 1) + sp.sin(sp.atan2(y, x) / 1), (-1, 0)),
    "half turns": (sp.sin(sp.atan2(y, x) / 2), (-1, 0)),
    "C1": (y + piecewise((x**2, x < 0), (2 * x**2, True)), (0, 1)),
    "C2": (y + piecewise((x**2, x < 0), (x**2 + x**3, True)), (0, 1)),
    "C1 by rounding": (y + piecewise((sp.sin(x), x < 1), (sp.sin(1) + sp.cos(1) * (x - 1), True)), (1, 3)),
    "x |x|": (x * abs(x) + y, (0, 1)),
    "three branches": (piecewise((x**2, x < 0), (0, x < 1), ((x - 1) ** 3, True)) + y, (1, 1)),
    "and": (piecewise((x * y, sp.And(x > 0, y > 0)), (0, True)) + x, (0, 0)),
    "and on a side": (piecewise((x * y, sp.And(x > 0, y > 0)), (0, True)) + x, (0, 2)),
    "and off its sides": (piecewise((x * y, sp.And(x > 0, y > 0)), (0, True)) + x, (0, -2)),
    "thin": (y - piecewise((0, x < 0), (0, x > 0), (1, True)), (0, 1)),
    "curved border": (piecewise((x**2 + y**2 - 1, x**2 + y**2 < 1), (0, True)), (1, 0)),
    "curved border, smooth": (piecewise(((x**2 + y**2 - 1) ** 2, x**2 + y**2 < 1), (0, True)), (0, -1)),
    "in a quotient": (1 / (2 + piecewise((0, x < 0), (x, True))), (0, 1)),
    "in a root": (sp.sqrt(2 + piecewise((0, x < 0), (x**2, True))), (0, 1)),
    "in an exponential": (sp.exp(piecewise((0, x < 0), (x, True)) * y), (0, 0)),
    "in an R-operation": (rsym.conjunction(y + 2, 1 + piecewise((0, x < 0), (x**2, True))), (0, 1)),
    "in an R-operation, kinked": (rsym.conjunction(y + 2, 1 + piecewise((0, x < 0), (x, True))), (0, 1)),
    "Sardf": (rsym.conjunction(x, y, system=rsym.Sardf()), (1, 3 * HALF)),
    "fillet G1": (rsym.conjunction(x, y, system=rsym.Rho(1)), (1, 0)),
    "fillet G2": (rsym.conjunction(x, y, system=rsym.Rho(1, "G2")), (1, 0)),
}


def exact(expression, point):
    """The value at a point of numbers of DIGITS digits, branches decided by these."""
    u, v = point
    place = {x: sp.Float(u, DIGITS), y: sp.Float(v, DIGITS)}
    return mp.mpf(sp.N(expression.doit().subs(place), DIGITS))


def expansion(expression, point):
    """The gradient and the Hessian at a point, each None where there is none."""
    with mp.workdps(DIGITS):
        turns = [2 * mp.pi * (k + mp.mpf("0.5")) / 24 for k in range(24)]
        ways = [(mp.cos(turn), mp.sin(turn)) for turn in turns] + [(1, 0), (-1, 0), (0, 1), (0, -1)]
        here = exact(expression, point)
        rates = [(exact(expression, (point[0] + STEP * a, point[1] + STEP * b)) - here) / STEP for a, b in ways]
        gradient = (rates[24] - rates[25]) / 2, (rates[26] - rates[27]) / 2
        left = [rate - gradient[0] * a - gradient[1] * b for rate, (a, b) in zip(rates, ways, strict=True)]
        if max(map(abs, left)) > mp.mpf(10) ** -30:
            return None, None
        bends = [2 * rate / STEP for rate in left]
        xx, yy = (bends[24] + bends[25]) / 2, (bends[26] + bends[27]) / 2
        a, b = ways[1]
        xy = (bends[1] - xx * a**2 - yy * b**2) / (2 * a * b)
        rest = [bend - xx * a**2 - yy * b**2 - 2 * xy * a * b for bend, (a, b) in zip(bends, ways, strict=True)]
        hessian = None if max(map(abs, rest)) > mp.mpf(10) ** -20 else ((xx, xy), (xy, yy))
        return gradient, hessian


def check(values, gradient, hessian, tolerance):
    assert values["singular"] == (gradient is None)
    if gradient is None:
        assert np.isnan(values["gradient"]).any()
        assert np.isnan(values["hessian"]).any()
        return
    assert_close(values["gradient"], np.array(gradient, float), atol=tolerance)
    assert np.isnan(values["hessian"]).any() == (hessian is None)
    if hessian is not None:
        assert_close(values["hessian"], np.array(hessian, float), atol=tolerance)


@pytest.mark.random
@pytest.mark.parametrize("name", CASES)
def test_derivatives_are_there_where_they_exist(name):
    expression, point = CASES[name]
    gradient, hessian = expansion(expression, tuple(map(mp.mpf, map(str, map(float, point)))))
    shape = rsym.Shape(expression, (x, y))
    place = tuple(map(float, point))
    for dtype, tolerance in (("float64", 1e-12), ("float32", 1e-5)):
        found = [rsym.compile(shape, FIELDS, backend=one, dtype=dtype)(*place) for one in ("numpy", "llvm")]
        check(found[0], gradient, hessian, tolerance)
        for field in FIELDS:
            if not expression.has(sp.sin, sp.cos, sp.exp, sp.atan2):
                assert np.array_equal(found[0][field], found[1][field], equal_nan=True), field
        check(found[1], gradient, hessian, tolerance)
    check(rsym.lambdify(shape, FIELDS)(*place), gradient, hessian, 1e-12)


@pytest.mark.random
@pytest.mark.parametrize("name", CASES)
def test_enclosures_hold_both_sides_of_a_border(name):
    """They stay those of the sides: a box is none the worse for a border in it."""
    expression, point = CASES[name]
    shape = rsym.Shape(expression, (x, y))
    box = [[float(c) - 1e-3, float(c) + 1e-3] for c in point]
    ways = itertools.product((-9e-4, -1e-5, 1e-5, 9e-4), repeat=2)
    near = np.array([[float(c) + way for c, way in zip(point, pair, strict=True)] for pair in ways])
    values = rsym.compile(shape, ("gradient",))(*near.T)["gradient"]
    for backend in ("ball", "interval"):
        low, high = np.moveaxis(rsym.enclose(shape, box, ("gradient",), backend=backend)["gradient"], -1, 0)
        assert (values >= low - 1e-12).all(), backend
        assert (values <= high + 1e-12).all(), backend
        assert np.isfinite(high - low).all(), backend


def test_the_operations_without_a_choice_have_the_programs_they_had():
    fields = ("gradient", "hessian", "normalised_laplacian", "curvature")
    systems = (rsym.R0, rsym.R1, rsym.RAlpha(HALF), rsym.R0m(2), rsym.Rp(3))
    plain = [rsym.conjunction(1 - x**2, y, abs(x) - 1, system=system) for system in systems]
    plain += [rsym.equivalence(x, y), rsym.trimming(x, y), sp.Max(x, y), sp.cos(4 * sp.atan2(y, x))]
    for expression in plain:
        shape = rsym.Shape(expression, (x, y))
        assert program_of(shape, fields).digest == program_of(shape, fields, share=None).digest
    for shape in (rsym.paper.skeleton_body(), rsym.paper.car(), rsym.cyclic(rsym.disc(1, (4, 0)), 12)):
        assert program_of(shape, ("gradient",)).digest == program_of(shape, ("gradient",), share=None).digest


def test_a_fillet_has_all_its_gradients_and_its_hessians_but_on_its_ends():
    """On a lattice through all its borders: G1 has no Hessian where the fillet ends, G2 has it everywhere."""
    across, up = np.meshgrid(np.arange(-2, 2.01, 1 / 16), np.arange(-2, 2.01, 1 / 16))
    for continuity in ("G1", "G2"):
        shape = rsym.Shape(rsym.conjunction(x, y, system=rsym.Rho(sp.Rational(5, 4), continuity)), (x, y))
        found = rsym.compile(shape, FIELDS)(across, up)
        assert not found["singular"].any()
        lost = np.isnan(found["hessian"]).any(axis=(-1, -2))
        ends = across**2 + up**2 == 1.25**2
        assert ends.sum() == 12
        assert np.array_equal(lost, ends if continuity == "G1" else np.zeros_like(ends))


def test_third_derivatives_are_refused_on_every_border():
    shape = rsym.Shape(y + piecewise((x**2, x < 0), (x**2 + x**3, True)), (x, y))
    found = rsym.compile(shape, ("laplacian", "normalised_laplacian"))([0.0, 1e-9], 1.0)
    assert np.isfinite(found["laplacian"]).all()
    assert np.isnan(found["normalised_laplacian"]).tolist() == [True, False]


def test_the_mesh_of_a_kinked_body_has_its_normals():
    ball = HALF - x**2 - y**2 - z**2 + piecewise((0, x < 0), (x / 4, True))
    mesh = rsym.mesh(rsym.Shape(ball, (x, y, z), bounds=((-1, 1),) * 3), (8, 8, 8))
    assert np.isfinite(mesh.normals).all()
    assert math.isfinite(mesh.vertices.sum())


def test_what_cancels_by_parity_alone_is_not_known_to_exist():
    """sin(t/2)**2 = (1 - cos t)/2 has no jump where t turns: NaN there says less than is true, never more."""
    shape = rsym.Shape(sp.sin(sp.atan2(y, x) / 2) ** 2 * y, (x, y))
    found = rsym.compile(shape, FIELDS)([-1.0, -1.0, 1.0], [0.0, 1e-9, 0.0])
    assert found["singular"].tolist() == [True, False, False]


def test_the_closed_form_of_a_sign_is_undefined_at_its_zero():
    (slope, _) = rsym.gradient(rsym.Shape(x * sp.sign(x), (x, y)))
    assert [slope.subs(x, place) for place in (-2, 3)] == [-1, 1]
    assert slope.subs(x, 0) is sp.nan
    values = rsym.compile(rsym.Shape(slope, (x, y)))([-2.0, 0.0, 3.0], 1.0)["value"]
    assert values[[0, 2]].tolist() == [-1, 1]
    assert math.isnan(values[1])
