"""A minimum is one however it is written: of conditions, absolute values, roots."""

import numpy as np
import pytest
import sympy as sp

import rsym
from rsym import x, y, z
from rsym.backends.interpreter import interpret
from rsym.logic.sign_form import shape_form

LEAST = {
    "condition": lambda a, b: sp.Piecewise((a, a < b), (b, True)),
    "difference": lambda a, b: sp.Piecewise((b, (a - b) / 3 > 0), (a, True)),
    "absolute value": lambda a, b: (a + b - sp.Abs(a - b)) / 2,
    "root": lambda a, b: a + b - sp.sqrt(a**2 + b**2),
    "scaled root": lambda a, b: 2 * a + b / 3 - sp.sqrt(4 * a**2 + b**2 / 9),
    "root with a product": lambda a, b: a + b - sp.sqrt(a**2 + b**2 - a * b),
    "odd powers": lambda a, b: sp.Piecewise((a**3, a < b), (b**3, True)),
}
ONE, OTHER = 1 - x**2 - y**2, 1 - (x - 1) ** 2 - y**2
POINTS = dict(zip("xyz", np.random.default_rng(3).uniform(-1.5, 2.5, (3, 400)), strict=True))


def signs(expression):
    form = shape_form(rsym.Shape(expression, (x, y, z)))
    return np.sign(interpret(form.builder.program({"f": form.value}), POINTS)["f"]), form


@pytest.mark.parametrize("written", LEAST.values(), ids=LEAST)
@pytest.mark.parametrize(
    "pair", [(ONE, OTHER), (-ONE, OTHER), (ONE, x - sp.Rational(1, 3)), (x, z), (1 + x - ONE, ONE)]
)
def test_a_minimum_is_a_gate_however_it_is_written(written, pair):
    found, form = signs(written(*pair))
    assert len(form.leaves) == 2
    assert [gate.operation for gate in form.gates] == ["min"]
    np.testing.assert_array_equal(found, signs(sp.Min(*pair))[0])
    largest, form = signs(-written(*(-one for one in pair)))
    assert [gate.operation for gate in form.gates] == ["max"]
    np.testing.assert_array_equal(largest, signs(sp.Max(*pair))[0])


@pytest.mark.parametrize("inner", LEAST)
@pytest.mark.parametrize("outer", LEAST)
def test_a_minimum_of_a_minimum_is_a_gate_of_gates(outer, inner):
    parts = ONE, OTHER, sp.Rational(1, 3) - z
    found, form = signs(LEAST[outer](LEAST[inner](*parts[:2]), parts[2]))
    np.testing.assert_array_equal(found, signs(sp.Min(*parts))[0])
    if ("value" in outer or "root" in outer) and "product" not in inner:  # what is under that root may be negative
        assert len(form.leaves) == 3
        assert [gate.operation for gate in form.gates] == ["min", "min"]


NONE = {
    "another condition": sp.Piecewise((ONE, x < y), (OTHER, True)),
    "the root of less": ONE + OTHER - sp.sqrt(ONE**2 + OTHER**2 - 3 * ONE * OTHER),
    "the root of more": ONE + 2 * OTHER - sp.sqrt(ONE**2 + OTHER**2),
    "a number more": ONE + OTHER + 1 - sp.sqrt(ONE**2 + OTHER**2),
    "nothing cancels": ONE - sp.Abs(z),
}


@pytest.mark.parametrize("expression", NONE.values(), ids=NONE)
def test_what_is_no_minimum_stays(expression):
    found, form = signs(expression)
    with np.errstate(invalid="ignore"):
        value = sp.lambdify((x, y, z), expression, "numpy")(*POINTS.values())
    np.testing.assert_array_equal(found, np.where(np.isnan(value), -1, np.sign(value)))
    assert len(form.leaves) != 2


def test_a_side_without_a_value_keeps_its_condition():
    least = LEAST["absolute value"](sp.sqrt(x), 1 - y)
    shape = rsym.Shape(least, (x, y), bounds=((-2, 2), (-2, 2)))
    assert not bool(shape.contains(-1, 0))
    assert bool(shape.contains(1, 0))


@pytest.mark.parametrize("written", LEAST.values(), ids=LEAST)
def test_a_cone_ends_however_it_is_written(written):
    side = sp.Min(z, z**2 - x**2 - y**2)
    found = np.array(rsym.extent(rsym.Shape(written(sp.Rational(9, 10) - z, side), (x, y, z))))
    np.testing.assert_allclose(found, [(-0.9, 0.9), (-0.9, 0.9), (0, 0.9)], atol=0.03 * 1.8)


def test_conditions_hold_choices():
    square = LEAST["condition"](*(LEAST["condition"](1 - one, 1 + one) for one in (x, y)))
    assert square.has(sp.ITE)
    shape = rsym.Shape(square, (x, y), bounds=((-2, 2), (-2, 2)))
    u, v = POINTS["x"], POINTS["y"]
    np.testing.assert_array_equal(shape.contains(u, v), np.maximum(abs(u), abs(v)) < 1)
