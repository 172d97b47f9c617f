"""What is left of a stripped node has its zeros and, times the sign, its signs."""

from functools import partial

import numpy as np
import pytest
import sympy as sp

import rsym
from rsym import x, y, z
from rsym.backends.interpreter import interpret
from rsym.logic.stripping import Signed, Stripping, bare, even_root, factor, formal_sign, scaled
from rsym.model.powers import absolute_power, signed_power
from rsym.program.builder import Builder
from rsym.program.lowering import lower
from rsym.verify.boxes.local import Model
from rsym.verify.boxes.locus import reduce

POINTS = dict(zip("xyz", np.random.default_rng(11).uniform(-1.5, 1.5, (3, 400)), strict=True))
U = x - y / 3 + z
CASES = {
    "negation": (-U, U, -1),
    "constants": (-sp.Rational(2, 5) * U, U, -1),
    "odd power": ((-U) ** 3, U, -1),
    "even power": (-(U**2), U**2, -1),
    "positive factor": (sp.exp(y) * U / sp.pi, U, 1),
    "positive divisor": (-U / (2 + x**2), U, -1),
    "unknown factor": (U * (x - 5), U * (x - 5), 1),
    "tanh": (sp.tanh(1000 * U), U, 1),
    "atan": (-sp.atan(10**6 * U), U, -1),
    "erf": (sp.erf(1000 * U) ** 3, U, 1),
    "sinh": (sp.sinh(-5 * U), U, -1),
    "logistic": (1 / (1 + sp.exp(-50 * U)) - sp.Rational(1, 2), U, 1),
    "exponential": (1 - sp.exp(3 * U), U, -1),
    "exponentials": (sp.exp(2 * U) - sp.exp(U), U, 1),
    "rises through 0 elsewhere": (sp.exp(U) - 2, sp.exp(U) - 2, 1),
    "nested": (-3 * sp.exp(x) * (-2 * U / (1 + y**2)) ** 5, U, 1),
}


def values(builder, number):
    return interpret(builder.program({"value": number}), POINTS)["value"]


@pytest.mark.parametrize("case", CASES)
def test_what_drops_by_its_form(case):
    expression, left, sign = CASES[case]
    b = Builder(("x", "y", "z"), ())
    node, inner = lower(b, expression), lower(b, left)
    found = Stripping(b, partial(formal_sign, b))(node)
    assert bare(b, found.number) == bare(b, inner)
    assert found.sign * factor(b, found.number) == sign * factor(b, inner)
    assert np.array_equal(np.sign(values(b, found.made(b))), np.sign(values(b, node)))


def test_the_sign_counts():
    """Red proof: a loop that forgets a negation is seen."""
    b = Builder(("x", "y", "z"), ())
    node = b.neg(lower(b, U))
    found = Stripping(b, partial(formal_sign, b))(node)
    assert not np.array_equal(np.sign(values(b, found.number)), np.sign(values(b, node)))


@pytest.mark.parametrize("expression", [-6 * x + 4 * y - 2, -3 * (x * y), x + y - 1])
def test_what_is_scaled_is_the_node(expression):
    b = Builder(("x", "y", "z"), ())
    node = lower(b, expression)
    inner, times = scaled(b, node)
    assert np.allclose(float(times) * values(b, inner), values(b, node))
    assert np.array_equal(factor(b, node) * np.sign(values(b, bare(b, node))), np.sign(values(b, node)))


def test_roots_of_what_is_even():
    b = Builder(("x", "y", "z"), ())
    u = lower(b, U)
    assert [even_root(b, node) for node in (b.abs(u), b.square(u), b.powi(u, 4))] == [u, u, u]
    assert [even_root(b, node) for node in (u, b.powi(u, 3), b.neg(b.square(u)))] == [None, None, None]


@pytest.mark.parametrize(
    ("expression", "left"),
    [
        (U * sp.Abs(U, evaluate=False), U),
        (-2 * x * sp.Abs(5 * x) ** 3, -x),
        (-(U**3) * U**2 * (2 + sp.Abs(y)), -U),
        (signed_power(U, sp.Rational(3, 2)), U),
        (-signed_power(U, sp.Rational(3, 2)) * absolute_power(y - 9, sp.Integer(1)), -U),
    ],
)
def test_a_factor_that_keeps_its_sign_leaves_the_other(expression, left):
    model = Model(rsym.Shape(expression, (x, y, z)), {})
    locus = reduce(model.over(((-1, 1),) * 3), model.root)
    b = model.builder
    wanted = lower(b, left)
    assert locus.kind == "leaf"
    assert (bare(b, locus.nodes[0]), factor(b, locus.nodes[0])) == (bare(b, wanted), factor(b, wanted))


def test_two_factors_with_one_zero_and_no_change_of_sign():
    model = Model(rsym.Shape(U, (x, y, z)), {})
    b = model.builder
    product = b.mul(b.mul(b.const(-2), model.root), b.powi(model.root, 3))
    assert reduce(model.over(((-1, 1),) * 3), product).kind == "double"


def test_steps_end_with_what_is_left():
    b = Builder(("x",), ())
    node = b.neg(b.mul(b.const(3), b.input("x")))
    drop = Stripping(b, partial(formal_sign, b))
    assert [part.sign for part in drop.steps(node)] == [1, -1, -1]
    assert drop(node) == Signed(b.input("x"), -1)
