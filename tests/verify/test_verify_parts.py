"""The parts of a verdict: what drops, what generates, what both sides of a switch are, where two equations meet."""

import math
from fractions import Fraction
from functools import reduce as reduce_all

import numpy as np
import pytest
import sympy as sp
from flint import arb, ctx

from rsym import Shape, conjunction, disjunction, normalise, trimming, x, y, z
from rsym.verify.boxes.domains import is_defined
from rsym.verify.boxes.generators import generators
from rsym.verify.boxes.krawczyk import refined, unique_zero
from rsym.verify.boxes.local import Model, side
from rsym.verify.boxes.locus import reduce
from rsym.verify.boxes.resolution import contact, resolve
from rsym.verify.cover.covering import bounds_of_omega, cover, pruner
from rsym.verify.revolution import meridian

DISC = 1 - x**2 - y**2
Q = sp.Rational


def on(expression, box):
    model = Model(Shape(expression, (x, y)), {})
    return model.over(box)


def locus(expression, box=((0.5, 0.75), (0.5, 0.75))):
    local = on(expression, box)
    found = reduce(local, local.model.root)
    return local, found


def values(local, number, points):
    """A node of a model at points, by its balls."""
    return [float(local.model.on([arb(u), arb(v)]).value(number)) for u, v in points]


@pytest.mark.slow
def test_of_hundreds_of_parts_those_count_that_a_box_holds():
    row = reduce_all(disjunction, [Q(1, 16) - (x - k) ** 2 - y**2 for k in range(400)])
    local, found = locus(row, ((100.2, 100.3), (-0.1, 0.1)))
    assert found.kind == "leaf"
    assert values(local, found.nodes[0], [(100.25, 0.0), (100.0, 0.0)]) == [0, 1 / 16]
    assert locus(row, ((-1, 400), (-1, 1)))[1].kind == "several"


POINTS = [(0.55, 0.7), (0.6, 0.52), (0.74, 0.74)]


@pytest.mark.parametrize(
    "expression",
    [
        DISC * (2 + abs(x)),
        conjunction(DISC, x + 1),
        -disjunction(-DISC, -x - 1),
        DISC**3,
        DISC * abs(DISC),
        DISC / (1 + x),
        sp.Max(DISC, -3),
        normalise(Shape(DISC, (x, y))).expression,
        sp.Piecewise((DISC, x > 0), (y - 5, True)),
    ],
    ids=range(9),
)
def test_what_drops_leaves_the_disc(expression):
    """The locus has the sign of omega and, here, is the disc itself."""
    local, found = locus(expression)
    assert found.kind == "leaf"
    np.testing.assert_allclose(values(local, *found.nodes, POINTS), [1 - u * u - v * v for u, v in POINTS], rtol=1e-12)


@pytest.mark.parametrize(
    "expression",
    [DISC * (2 + sp.sqrt(x - Q(5, 8))), conjunction(DISC, 2 + sp.log(x - Q(5, 8))), DISC / (2 + sp.sqrt(y - Q(5, 8)))],
)
def test_nothing_drops_that_is_not_defined_on_the_whole_box(expression):
    local, found = locus(expression)
    assert found.kind in {"leaf", "conjunction", "product"}
    assert not is_defined(local, local.model.root)


@pytest.mark.parametrize("expression", [-(DISC**2), abs(DISC), DISC**2 * (2 + x), sp.sqrt(DISC**2)])
def test_zeros_without_a_change_of_sign(expression):
    assert locus(expression)[1].kind == "double"


def test_a_box_without_zeros():
    assert locus(DISC, ((0, 0.25), (0, 0.25)))[1].kind == "none"
    assert locus(sp.sqrt(-1 - x**2))[1].kind == "none"


@pytest.mark.parametrize(
    ("expression", "switches", "hard"),
    [
        (x * y, 0, 0),
        (abs(x) + y, 1, 0),
        (abs(x) + sp.Max(x, 0), 1, 0),  # one switch for both
        (abs(x) + abs(y), 2, 0),
        (sp.Max(abs(x), 5), 0, 0),  # |x| is under a dead branch
        (conjunction(x, y) + 1, 0, 1),
        (conjunction(x, y + 1) + 1, 0, 0),
        (sp.sqrt(x + Q(1, 8)), 0, 1),
        (trimming(y, 1 - x**2), 1, 0),
        (trimming(y, x), 0, 1),
        (1 / (x + 1), 0, 0),
        (1 / x, 0, 1),
        (sp.log(x + 2), 0, 0),
    ],
)
def test_generators_alive_near_the_origin(expression, switches, hard):
    local = on(expression + 7, ((-0.25, 0.25), (-0.25, 0.25)))
    found = generators(local, local.model.root)
    assert (len(found.switches), len(found.hard)) == (switches, hard)


@pytest.mark.parametrize(
    ("expression", "order"),
    [
        (abs(x), 1),
        (x * abs(x), 2),
        (sp.Max(x, 0) ** 3, 3),
        (x**2 * abs(x) * y + y, 3),
        (sp.exp(sp.Max(x, 0) ** 4), 4),
        (sp.sin(x * abs(x)) / (2 + y), 2),
        (abs(x) ** Q(5, 2), 2.5),
        (sp.sign(x), 0),
        (trimming(x, 2 + y), 1),
        (x * trimming(x, 2 + y), 2),
        (sp.Piecewise((y, x < 0), (y - x**2, True)), 2),
        (y - (sp.sign(x) + sp.sign(x) ** 2) / 2, 0),
        (abs(x) * sp.Max(x, -x), math.inf),  # x**2 on both sides
    ],
)
def test_contact_is_the_order_of_the_difference_of_both_sides(expression, order):
    """Bounded from below by the rules; sampled: the difference at u divided by u**order stays bounded."""
    local = on(expression, ((-0.25, 0.25), (-0.25, 0.25)))
    root = local.model.root
    (switch,) = generators(local, root).switches or [None]
    assert contact(local, root, switch) == order
    if order == math.inf or order == int(order):
        plus, minus = (resolve(local, root, switch, way) for way in (1, -1))
        for at in (0.1, 0.2):
            assert math.isclose(values(local, plus, [(at, 0.1)])[0], values(local, root, [(at, 0.1)])[0])
            assert math.isclose(values(local, minus, [(-at, 0.1)])[0], values(local, root, [(-at, 0.1)])[0])
        gaps = [values(local, plus, [(at, 0.1)])[0] - values(local, minus, [(at, 0.1)])[0] for at in (1e-2, 1e-3)]
        assert all(abs(gap) <= 4 * at**order + 1e-15 for gap, at in zip(gaps, (1e-2, 1e-3), strict=True))


def _system(box):
    """A circle and a parabola: x**2 + y**2 = 1, y = x**2."""

    def value(point):
        u, v = point
        return [u * u + v * v - 1, v - u * u]

    def jacobian(point):
        u, v = point
        return [(2 * u, 2 * v), (-2 * u, arb(1))]

    return value, jacobian, tuple(side(*ends) for ends in box)


def test_krawczyk_finds_one_zero_or_proves_that_there_is_none():
    golden = (math.sqrt(5) - 1) / 2
    value, jacobian, box = _system(((0.7, 0.9), (0.5, 0.7)))
    zero = unique_zero(value, jacobian, box)
    assert zero.exists
    with ctx.workprec(300):
        narrow = refined(value, jacobian, zero.box)
        assert narrow[1].overlaps((arb(5).sqrt() - 1) / 2)
        assert float(arb(narrow[1].rad())) < 1e-80
    assert math.isclose(float(narrow[0]), math.sqrt(golden))
    assert not unique_zero(*_system(((0.2, 0.4), (0.8, 0.9)))).exists
    assert unique_zero(*_system(((-1, 1), (0.5, 0.7)))) is None  # two zeros


def test_the_meridian_of_a_body():
    shape, axis = meridian(Shape(3 - 2 * (x**2 + z**2) - conjunction(y, 1 - x**2 - z**2), (x, y, z)))
    assert axis == 1
    assert shape.coordinates == (y, x)
    for point in ((0.3, 0.4), (-1.0, 0.7)):
        flat = shape.expression.doit().subs({y: point[0], x: point[1]})
        assert math.isclose(flat, (3 - 2 * x**2 - conjunction(y, 1 - x**2)).doit().subs({y: point[0], x: point[1]}))


def test_pruning_and_examination_agree():
    """What is discarded in float64 has no zero by balls either, over a range of a letter too."""
    a = sp.Symbol("a", real=True)
    shape = Shape(a - x**2 - y**2, (x, y), letters={a: 1}, bounds=((-2, 2), (-2, 2)))
    letters = {"a": (Fraction(1, 2), Fraction(3, 2))}
    model = Model(shape, letters)
    prune = pruner(bounds_of_omega(shape, model.axes, letters), model.axes, letters)
    grid = np.linspace(-2, 2, 18)
    boxes = [((u, u + 4 / 17), (v, v + 4 / 17), (0.75, 1.0)) for u in grid[:-1].tolist() for v in grid[:-1].tolist()]
    kept = [not empty for empty in prune(boxes)]
    truth = [not model.over(box).nonzero(model.root) for box in boxes]
    assert all(mine >= theirs for mine, theirs in zip(kept, truth, strict=True))
    assert sum(kept) < 1.1 * sum(truth) < len(boxes)


def test_the_cover_leaves_no_gap():
    """Every point of the boundary lies in a settled box or in one that is left."""
    shape = Shape(conjunction(DISC, x + y / 2 + Q(1, 3)) * (2 + abs(y)), (x, y))
    model = Model(shape, {})
    found = cover(model, ((-2.0, 2.0), (-2.0, 2.0)), smallest=1e-5, budget=5000)
    boxes = np.array([box for box, _ in found.settled + found.left])
    angles = np.linspace(0, 2 * np.pi, 2000)
    points = np.stack([np.cos(angles), np.sin(angles)], axis=-1)
    points = points[points[:, 0] + points[:, 1] / 2 + 1 / 3 >= 0]
    inside = (points[:, None] >= boxes[None, :, :, 0] - 1e-12) & (points[:, None] <= boxes[None, :, :, 1] + 1e-12)
    assert inside.all(axis=2).any(axis=1).all()
