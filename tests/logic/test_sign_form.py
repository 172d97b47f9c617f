"""The sign form against the signs of omega, which it must keep at every point."""

import numpy as np
import pytest
import sympy as sp
from hypothesis import given, settings
from oracles.tiers import examples
from oracles.trees import trees

import rsym
from rsym import x, y, z
from rsym.backends.interpreter import interpret
from rsym.logic.gates import Gate
from rsym.logic.sign_form import surface_form

a = sp.Symbol("a", real=True)
POINTS = np.random.default_rng(4).uniform(-1.5, 1.5, (3, 500))
SYSTEMS = (rsym.R0, rsym.R1, rsym.RAlpha(sp.Rational(1, 3)), rsym.R0m(2), rsym.Rp(3))


def signs_of(form, letters=None):
    program = form.builder.program({"value": form.value})
    inputs = dict(zip("xyz", POINTS, strict=True)) | dict(letters or {})
    return np.sign(interpret(program, inputs)["value"])


def signs_of_omega(shape):
    return np.sign(rsym.compile(shape, backend="numpy")(*POINTS)["value"])


@settings(max_examples=examples(60), deadline=None)
@given(trees(systems=SYSTEMS, more=(abs(x) - y, sp.Min(x, y) + z)))
def test_keeps_the_sign_of_omega_and_joins_nothing_else(expression):
    shape = rsym.Shape(expression, (x, y, z))
    form = surface_form(shape)
    assert np.array_equal(signs_of(form), signs_of_omega(shape))
    assert {gate.operation for gate in form.gates} <= {"min", "max"}


@pytest.mark.parametrize(
    ("expression", "leaves"),
    [
        (-(rsym.conjunction(x, y)) * (1 + x**2) ** 3 / sp.sqrt(2 + y**2), 2),
        (rsym.conjunction(x, y) ** 3, 2),
        (sp.exp(z) * rsym.conjunction(x, y) / sp.pi, 2),
        (rsym.conjunction(x, y) * (1 - x), 1),  # a factor that changes sign stays
        (rsym.conjunction(x, y) * x**2, 1),  # one that vanishes too: it has a zero sheet of its own
        (rsym.conjunction(x, y) * a, 1),  # and a letter, which may be negative
        (rsym.conjunction(x, y) + z, 1),
        (rsym.joining(x, y), 1),
        (rsym.conjunction(x, x), 1),
    ],
)
def test_what_drops_and_what_stays(expression, leaves):
    shape = rsym.Shape(expression, (x, y, z), letters={a: -2})
    form = surface_form(shape)
    assert len(form.leaves) == leaves
    assert np.array_equal(signs_of(form, {"a": -2.0}), signs_of_omega(shape))


def test_normalised_shapes_have_the_leaves_of_the_plain_ones():
    body = rsym.Shape(rsym.conjunction(1 - x**2 - y**2, z, 1 - z), (x, y, z))
    assert len(surface_form(rsym.normalise(body)).leaves) == 3


def test_negations_move_to_the_leaves():
    form = surface_form(rsym.Shape(-rsym.disjunction(x, -rsym.conjunction(y, z)), (x, y, z)))
    assert form.gates == (Gate("min", 1, 2), Gate("min", 0, 3))
    assert form.builder.nodes[form.leaves[0]].operation == "neg"


def test_caps_are_the_sides_of_the_bounds():
    form = surface_form(rsym.Shape(rsym.conjunction(x, y), (x, y, z)))
    capped = form.capped()
    ends = {f"{name} {end}": value for name in "xyz" for end, value in (("lower", -1.0), ("upper", 1.0))}
    inside = (np.abs(POINTS) < 1).all(axis=0)
    assert capped.caps == 6
    assert np.array_equal(signs_of(capped, ends) > 0, (signs_of(form) > 0) & inside)


@pytest.mark.slow
def test_nests_of_five_hundred():
    nest = x
    for k in range(500):
        nest = rsym.conjunction(nest, -rsym.conjunction(y - sp.Rational(k, 500), nest)) if k % 2 else -nest
    assert len(surface_form(rsym.Shape(nest, (x, y, z))).gates) > 0


def test_a_negative_constant_is_a_negation():
    pair = rsym.conjunction(x, y)
    scaled = surface_form(rsym.Shape(-3 * pair, (x, y, z)))
    negated = surface_form(rsym.Shape(-pair, (x, y, z)))
    assert scaled.gates == negated.gates == (Gate("max", 0, 1),)
    assert scaled.leaves == negated.leaves
    body = rsym.box(4, 4, 4) - rsym.box().scale(1.5)
    assert len(surface_form(body).leaves) == 6


DISC = 1 - x**2 - y**2
BUMP = sp.Max(0, sp.Rational(1, 100) - (x - 37) ** 2)


@pytest.mark.parametrize(
    ("expression", "jumps"),
    [
        (sp.Piecewise((1 - y + BUMP, y > 1), (1 - y, True)), True),  # no sample of the condition lies in the bump
        (sp.Piecewise((DISC + sp.Max(0, 1 - 1000 * (x - 3) ** 2), y > 0), (DISC, True)), True),
        (
            sp.Piecewise(
                (DISC, (x - 500) * ((x - 33) ** 2 + y**2 - sp.Rational(1, 10**4)) > 0), (DISC + x - 500, True)
            ),
            True,
        ),
        (sp.Piecewise((DISC + y**2, y > 0), (DISC, True)), False),
        (sp.Piecewise((2 * sp.Abs(x) - y, x > 0), (-2 * x - y, True)), False),
        (sp.Piecewise((0.1 * 3 * x - y + 0.3, x > -1), (0.3 * x + 0.1 * 3 - y + 0.7 * (x + 1) ** 2, True)), False),
        (sp.Piecewise((DISC + (sp.sqrt(x**2 + y**2) - 1) ** 2, sp.sqrt(x**2 + y**2) > 1), (DISC, True)), False),
        (sp.Piecewise((DISC + 1 / (1 + x) - sp.Rational(1, 2), x > 1), (DISC, True)), False),
    ],
)
def test_jumps_are_found_by_algebra(expression, jumps):
    assert (len(surface_form(rsym.Shape(expression, (x, y))).leaves) > 1) == jumps
