"""Parts of leaves: evaluated one after the other they are the leaf, to the bit."""

import numpy as np
import pytest
import sympy as sp
from oracles.many_balls import many_balls

import rsym
from rsym import x, y, z
from rsym.backends.interpreter import interpret
from rsym.logic import leaf_parts
from rsym.logic.leaf_parts import NONE, OPERANDS, parted
from rsym.logic.sign_form import SignForm, surface_form
from rsym.program.builder import Builder

POINTS = {name: np.random.default_rng(k).uniform(-2, 2, 300) for k, name in enumerate("xy")}


def values_of(parts):
    """What entries are, one by one."""
    found = []
    for what, *operands in parts.entries:
        own = [found[k] if k != NONE else np.full(300, np.nan) for k in operands]
        if isinstance(what, str):
            found.append((np.minimum if what == "min" else np.maximum)(*own))
        else:
            builder = parts.form.builder
            program = builder.program({"value": parts.form.leaves[what]})
            found.append(
                np.broadcast_to(interpret(program, POINTS | dict(zip(OPERANDS, own, strict=True)))["value"], 300)
            )
    return found


def at_random(builder, generator, depth):
    """A node of choices and arithmetic that shares some of its parts."""
    if depth <= 0:
        return builder.input(generator.choice(["x", "y"]))
    a, b, c = (at_random(builder, generator, depth - int(generator.integers(1, 3))) for _ in "abc")
    kind = generator.choice(["min", "max", "add", "mul", "sin", "square", "select", "r0_conjunction", "share"])
    if kind == "select":
        return builder.select(a, b, c, a)
    if kind == "share":
        return builder.mul(builder.add(a, b), builder.add(a, c))
    if kind == "sin":
        return builder.make("sin", builder.add(a, b))
    return builder.square(a) if kind == "square" else builder.make(kind, a, b)


def test_parts_have_the_values_of_their_leaf_to_the_bit(monkeypatch):
    monkeypatch.setattr(leaf_parts, "FEW", 2)
    generator = np.random.default_rng(5)
    count = most = 0
    for _ in range(150):
        builder = Builder(("x", "y"), ())
        root = builder.add(at_random(builder, generator, 5), at_random(builder, generator, 4))
        parts = parted(SignForm(builder, (root,), ()))
        if parts is not None:
            count, most = count + 1, max(most, len(parts.entries))
            expected = interpret(builder.program({"value": root}), POINTS)["value"]
            np.testing.assert_array_equal(values_of(parts)[-1], expected)
    assert count > 30
    assert most > 20


def test_what_is_small_or_chooses_between_three_stays_whole(monkeypatch):
    shape, _, _ = many_balls(80, 3, rsym.R1)
    row = shape.expression
    assert parted(surface_form(shape)) is None  # its choices are gates
    few = rsym.Shape(x + sp.Min(x, y) ** 2, (x, y, z))
    assert parted(surface_form(few)) is None
    assert parted(surface_form(rsym.Shape(row + sp.exp(row), (x, y, z)))) is not None
    monkeypatch.setattr(leaf_parts, "FEW", 2)
    b = Builder(("x", "y", "z"), ())
    u, v, w = (b.make("min", b.input(p), b.input(q)) for p, q in ("xy", "yz", "zx"))
    assert parted(SignForm(b, (b.add(b.select(u, v, w, b.const(1)), b.const(1)),), ())) is None
    assert parted(SignForm(b, (b.add(b.select(u, v, u, b.const(1)), b.const(1)),), ())) is None  # two choices are few
    assert parted(SignForm(b, (b.add(b.mul(u, v), b.make("sin", w)),), ())) is not None


def test_parts_that_would_have_too_many_nodes_are_not_made(monkeypatch):
    monkeypatch.setattr(leaf_parts, "FEW", 2)
    b = Builder(("x", "y"), ())
    wide, most = b.input("y"), b.input("x")
    for k in range(40):
        wide = b.add(wide, b.make("sin", b.mul(b.const(k), b.input("x"))))
    for k in range(1, 30):
        most = b.make("max", most, b.mul(b.const(k), wide))  # each part holds the sum
    form = SignForm(b, (b.make("exp", most),), ())
    assert parted(form) is None
    monkeypatch.setattr(leaf_parts, "GROWTH", 100)
    assert parted(form) is not None


@pytest.mark.parametrize("count", [70, 400])
def test_a_part_has_few_nodes_however_many_there_are(count):
    shape, _, _ = many_balls(count, 3, rsym.R1)
    body = shape.expression
    parts = parted(surface_form(rsym.Shape(body + 1 / (9 + body**2), (x, y, z))))
    builder = parts.form.builder
    assert len(parts.form.leaves) == 2 * count  # balls, choices between them, and the leaf
    assert max(len(builder.program({"part": part}).nodes) for part in parts.form.leaves) < 25
