"""Lifting: the same value to the bit, choices at the top; against NumPy's own minima, sums and absolute values."""

import numpy as np
import pytest
import sympy as sp
from oracles.many_balls import many_balls

import rsym
from rsym import x, y, z
from rsym.backends.interpreter import interpret
from rsym.logic import lifting
from rsym.logic.lifting import CHOICES, lifted, opened
from rsym.logic.sign_form import surface_form
from rsym.model.symbols import with_operands
from rsym.program.builder import Builder
from rsym.sampling.plane import plane_sampler, plane_view, signs_of
from rsym.sampling.plane_regions import value_kernels

POINTS = {name: np.random.default_rng(k).uniform(-2, 2, 500) for k, name in enumerate("xy")}


def value(builder, number):
    return interpret(builder.program({"value": number}), POINTS)["value"]


def at_random(builder, generator, depth):
    """A node of choices, sums and multiples, and its value by NumPy."""
    if depth <= 0:
        name = generator.choice(["x", "y"])
        if generator.random() < 0.3:
            return builder.make("exp", builder.input(name)), np.exp(POINTS[name])
        return builder.input(name), POINTS[name]
    (a, u), (b, v) = (at_random(builder, generator, depth - int(generator.integers(1, 3))) for _ in "ab")
    numerator, denominator = (int(part) for part in generator.integers(1, 9, 2))
    sign = int(generator.choice([-1, 1]))
    constant = sp.Rational(sign * numerator, denominator)
    match generator.choice(["min", "max", "abs", "add", "neg", "mul", "shift"]):
        case "min":
            return builder.make("min", a, b), np.minimum(u, v)
        case "max":
            return builder.make("max", a, b), np.maximum(u, v)
        case "abs":
            return builder.abs(a), np.abs(u)
        case "neg":
            return builder.neg(a), -u
        case "mul":
            return builder.make("mul", builder.const(constant), a), float(constant) * u
        case "shift":
            return builder.make("add", a, builder.const(constant)), u + float(constant)
    return builder.make("add", a, b), u + v


@pytest.mark.parametrize("few", [0, 3])
def test_values_are_those_of_numpy_to_the_bit(few, monkeypatch):
    monkeypatch.setattr(lifting, "FEW", few)
    generator = np.random.default_rng(11)
    changed = 0
    for _ in range(120):
        builder = Builder(("x", "y"), ())
        node, expected = at_random(builder, generator, 5)
        found = lifted(builder, node, few)
        changed += found != node
        np.testing.assert_array_equal(value(builder, node), expected)
        np.testing.assert_array_equal(value(builder, found), expected)
    assert changed > 20


def test_choices_come_to_the_top_of_a_shell():
    shape, _, _ = many_balls(80, 3, rsym.R1)
    shell = rsym.Shape(sp.Rational(1, 50) - sp.Abs(2 * shape.expression - sp.Rational(1, 30)), (x, y, z))
    form = surface_form(shell)
    assert len(form.leaves) == 1
    wide = opened(form)
    assert len(wide.leaves) == 160
    builder = wide.builder
    inside = {
        builder.nodes[part].operation
        for leaf in wide.leaves
        for part, _ in with_operands(leaf, lambda number: builder.nodes[number].arguments, int)
    }
    assert not inside & CHOICES


def test_what_is_small_or_would_grow_too_much_stays():
    shape, _, _ = many_balls(80, 3, rsym.R1)
    small = surface_form(rsym.Shape(sp.Abs(x) + sp.Max(y, z) - 1, (x, y, z)))
    assert opened(small) is small
    nested = shape.expression
    for k in range(12):
        nested = sp.Abs(nested) - sp.Rational(1, 100 + k)
    form = surface_form(rsym.Shape(nested, (x, y, z)))
    assert opened(form) is form


def test_of_two_large_sides_of_a_sum_none_is_lifted_over_the_other():
    # Each of the hundred leaves would hold the other side in whole, to be compiled and evaluated a hundred times.
    shape, _, _ = many_balls(100, 3, rsym.R1)
    body = shape.expression
    form = surface_form(rsym.Shape(body + 1 / (100 + 900 * body**2), (x, y, z)))
    assert opened(form) is form
    lifted_one = opened(surface_form(rsym.Shape(body + 1 / (100 + 900 * x**2), (x, y, z))))
    assert len(lifted_one.leaves) == 100


def test_an_offset_of_many_balls_is_meshed_by_what_matters():
    shape, centres, radii = many_balls(80, 3, rsym.R1)
    offset = rsym.Shape(3 * shape.expression - sp.Rational(3, 500), (x, y, z), bounds=shape.bounds)
    mesh = rsym.Mesher(offset)(96)
    assert len(mesh.leaves) == 86
    radius = np.sqrt(radii**2 - 1 / 500)
    off = np.abs(np.linalg.norm(mesh.vertices[:, None] - centres, axis=2) - radius).min(axis=1)
    assert off.max() < 1e-9
    assert mesh.status.volume == pytest.approx(4 / 3 * np.pi * (radius**3).sum(), rel=0.02)


def test_values_and_signs_of_an_offset_in_the_plane_are_those_of_its_formula():
    shape, centres, radii = many_balls(90, 2, rsym.R1)
    shell = rsym.Shape(sp.Rational(1, 300) - sp.Abs(shape.expression), (x, y), bounds=shape.bounds)
    assert value_kernels(shell) is not None
    sampler = plane_sampler(shell, "value", resolution=70)
    values = sampler.values()
    np.testing.assert_array_equal(values, sampler.samples()["value"])
    places = np.stack(np.meshgrid(*(sampler.lattice.axis(k) for k in range(2)), indexing="ij"))
    discs = radii**2 - ((places[..., None] - centres.T[:, None, None]) ** 2).sum(axis=0)
    expected = 1 / 300 - np.abs(discs.max(axis=-1))
    np.testing.assert_allclose(values, expected, atol=1e-12)
    signs = signs_of(plane_view(shell, resolution=70))
    clear = np.abs(expected) > 1e-9
    np.testing.assert_array_equal(signs[clear] > 0, expected[clear] > 0)
