"""Weights vanish on the wanted leaves of the boundary and nowhere else inside, however these are joined."""

import numpy as np
import pytest
import sympy as sp

import rsym
from rsym import x, y, z
from rsym.backends.kernel import compile_program
from rsym.logic.sign_form import shape_form
from rsym.logic.weights import PRODUCT, Joins, Weights, constant_speed, even, weight
from rsym.program.differentiation import gradient
from rsym.program.raising import raised

A, B, C, D = sp.symbols("A B C D", real=True)


def random_tree(rng, depth):
    """Half-planes through random points and discs, by and, or, not."""
    if depth == 0:
        u, v, angle, size = (sp.Rational(int(k), 16) for k in rng.integers(1, 30, 4))
        if rng.random() < 0.5:
            return (
                rsym.half_plane((sp.Rational(3, 5), sp.Rational(4, 5)), u - 1)
                if angle < 1
                else rsym.half_plane((v, -u), u - 1)
            )
        disc = rsym.disc(size / 2 + 1, (u - 1, v - 1))
        return disc if rng.random() < 0.6 else ~disc
    one, other = random_tree(rng, depth - 1), random_tree(rng, depth - 1)
    return one & other if rng.random() < 0.5 else one | other


def values(shape, nodes, points):
    """Nodes of a builder of its form at points (n, 2)."""
    form, numbers = nodes
    program = form.builder.program({f"{k}": node for k, node in enumerate(numbers)})
    kernel = compile_program(program, tuple(f"{k}" for k in range(len(numbers))), shape, backend="numpy")
    found = kernel(*points.T)
    return [found[name] for name in kernel.fields]


def signs(form, leaves):
    """The form at points by what min and max mean."""
    rows = list(leaves)
    for operation, first, second in form.gates:
        rows.append((np.minimum if operation == "min" else np.maximum)(rows[first], rows[second]))
    return rows[-1]


def on_leaf(shape, form, number, start):
    """Points of the zero set of a leaf, on the boundary or not."""
    b = form.builder
    nodes = (form, [form.leaves[number], *gradient(b, form.leaves[number])])
    points = start.copy()
    for _ in range(40):
        f, p, q = values(shape, nodes, points)
        with np.errstate(all="ignore"):
            points = points - (f / (p * p + q * q))[:, None] * np.stack([p, q], axis=1)
    return points[np.isfinite(points).all(axis=1) & (np.abs(points) < 9).all(axis=1)]


@pytest.mark.parametrize("joins", [PRODUCT, Joins(1), Joins(2)], ids=str)
def test_of_random_trees_they_vanish_where_wanted_and_are_positive_elsewhere(joins):
    rng, seen = np.random.default_rng(11), np.zeros(3, int)
    for _ in range(12):
        shape = random_tree(rng, int(rng.integers(1, 4)))
        form = shape_form(shape)
        count = len(form.leaves)
        wanted = set(rng.choice(count, int(rng.integers(1, count + 1)), replace=False).tolist())
        nodes = form, [*form.leaves, weight(form, wanted, joins=joins)]
        for number in range(count):
            points = on_leaf(shape, form, number, rng.uniform(-3, 3, (150, 2)))
            if not len(points):
                continue
            *leaves, found = values(shape, nodes, points)
            # The leaf counts as exactly zero, and points close to another one are left out.
            clear = (
                np.min([np.abs(row) for k, row in enumerate(leaves) if k != number] or [np.ones(len(points))], axis=0)
                > 1e-3
            )
            leaves[number] = np.zeros(len(points))
            value = signs(form, leaves)
            leaves[number] = np.full(len(points), 1e-9)
            moves = signs(form, leaves) != value  # the leaf is the boundary there
            bounding, inside = clear & (value == 0) & moves, clear & (value > 0)
            if number in wanted:
                assert (np.abs(found[bounding]) < 1e-12).all()
                seen[0] += bounding.sum()
            else:
                assert (found[bounding] > 1e-9).all()
                seen[1] += bounding.sum()
            assert (found[inside] > 1e-9).all()
            seen[2] += inside.sum()
    assert (seen > 300).all()


def test_a_part_of_what_is_joined_by_or_has_its_own_weight():
    angle = rsym.Shape(A, (x, y), letters={A: 0, B: 0, C: 0}) | rsym.Shape(B, (x, y), letters={A: 0, B: 0, C: 0})
    form = shape_form(angle & rsym.Shape(C, (x, y), letters={A: 0, B: 0, C: 0}))
    made = [raised(form.builder.nodes, weight(form, wanted)) for wanted in ([0], [0, 1], [0, 1, 2])]
    one = rsym.disjunction(A, B - A)
    assert made == [one, rsym.disjunction(A, B), C * rsym.disjunction(A, B)]
    assert weight(form, []) is None


@pytest.mark.parametrize(
    ("shape", "speed"),
    [
        (rsym.Shape(3 * x - 4 * y + A, (x, y), letters={A: 1}), 5),
        (rsym.Shape(7 - 2 * x**2 - 2 * (y - 1) ** 2, (x, y)), 2 * sp.sqrt(14)),
        (rsym.Shape((B - x) * (x - A), (x, y), letters={A: 0, B: 1}), sp.Abs(A - B)),
        (rsym.Shape(1 - x**2 - y**2, (x, y, z)), 2),
        (rsym.Shape(x * y, (x, y)), None),
        (rsym.Shape(1 - x**2 - y**2 / 4, (x, y)), None),
        (rsym.Shape(x**2 + y**2, (x, y)), None),
        (rsym.Shape(sp.sin(x), (x, y)), None),
        (rsym.Shape(x - y**4, (x, y)), None),
    ],
)
def test_the_speed_on_the_zero_set_where_it_is_one_formula(shape, speed):
    assert constant_speed(shape) == speed
    assert constant_speed(shape, 2) == (speed if shape.expression.is_Add and speed == 5 else None)


@pytest.mark.parametrize("order", [1, 2])
def test_weights_are_normalised_off_corners(order):
    """Along the inner normal they are the distance s, but for what goes to 0 with s**(order + 1)."""
    shape = (rsym.ellipse(2, 1) & rsym.half_plane((1, 2), -1)) | rsym.disc(sp.Rational(1, 2), (1, 1))
    rng, form = np.random.default_rng(5), shape_form(shape)
    found = Weights(shape, form, order)
    for leaf, wanted in ((0, [0, 1]), (1, [0, 1]), (0, [0]), (2, [1, 2])):
        points = on_leaf(shape, form, leaf, rng.uniform(-2, 2, (60, 2)))
        rows = np.array(values(shape, (form, form.leaves), points))
        rows[leaf] = 0
        points = points[(signs(form, rows) == 0) & (np.abs(np.delete(rows, leaf, axis=0)) > 0.1).all(axis=0)]
        assert len(points) > 3
        slopes = np.array(values(shape, (form, gradient(form.builder, form.leaves[leaf])), points)).T
        inward = slopes / np.linalg.norm(slopes, axis=1)[:, None]
        kernel = rsym.compile(shape.replace(expression=found.of(wanted)))
        errors = [np.abs(kernel(*(points + s * inward).T)["value"] - s).max() for s in (4e-3, 1e-3)]
        assert errors[0] < 4e-4
        assert errors[1] < 1.3 * errors[0] / 4 ** (order + 1) + 1e-14


@pytest.mark.parametrize("joins", [PRODUCT, Joins(1)], ids=str)
def test_of_an_exclusive_or_both_sides_of_a_leaf_are_the_part(joins):
    """The circle bounds it from within and from without; lens and crescents on circles of their own."""
    one, other = rsym.disc(1), rsym.disc(1, (1, 0))
    shape = one ^ other
    form = shape_form(shape)
    first = [k for k, leaf in enumerate(form.leaves) if raised(form.builder.nodes, leaf).subs({x: -1, y: 0}) == 0]
    assert len(first) == 2
    angles = np.linspace(0.01, 6.27, 200)
    circles = [np.stack([np.cos(angles) + shift, np.sin(angles)], axis=1) for shift in (0, 1)]
    node = [weight(form, first, joins=joins)]
    on_first, on_second = (values(shape, (form, node), points)[0] for points in circles)
    assert np.abs(on_first).max() < 1e-14
    corner = np.abs(circles[1][:, 0] - 0.5) < 0.01
    assert on_second[~corner].min() > 1e-6
    inside = np.random.default_rng(2).uniform(-1, 2, (500, 2))
    inside = inside[shape.contains(*inside.T)]
    assert values(shape, (form, node), inside)[0].min() > 0


def test_a_factor_is_the_product_of_few_leaves_and_the_weight_of_many():
    row = rsym.disc(9)
    for k in range(7):
        row = row - rsym.ellipse(0.2, 0.1, centre=(k, 0))
    found = Weights(row, shape_form(row))
    assert found.factor([0]) == found.of([0])
    leaves = [raised(found.form.builder.nodes, leaf) for leaf in found.form.leaves]
    assert sp.expand(found.factor([1, 2]) - leaves[1] * leaves[2]) == 0
    assert found.factor(range(1, 8)) == found.of(range(1, 8))


def test_even_numbers():
    assert [even(k) for k in range(4)] == [0, 2, 2, 4]
