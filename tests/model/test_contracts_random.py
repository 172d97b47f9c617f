"""Contracts never claim too much: 500 random models, checked by values at points alone."""

from dataclasses import replace

import numpy as np
import pytest
import sympy as sp
from oracles.array_values import REAL, evaluated
from oracles.random_models import model

from rsym import R0, Shape, x, y
from rsym.analysis.contracts.leaves import leaves
from rsym.analysis.contracts.promises import Singularity
from rsym.analysis.contracts.summary import image, singularities, slope_of
from rsym.analysis.contracts.table import PROMISES, Promises
from rsym.model.rnodes import R0Conjunction
from rsym.model.symbols import real_symbol

ENDS = {symbol: (real_symbol(f"{symbol}_lower"), real_symbol(f"{symbol}_upper")) for symbol in (x, y)}
NAMES = (x, y, *ENDS[x], *ENDS[y])
SIZE = 25  # models of one part
PARTS = range(500 // SIZE)


def boxes(random, count):
    """Boxes of all sizes, some a point or a segment, and a point in each, often on its border."""
    lower = random.uniform(-2, 2, (2, count))
    width = 10 ** random.uniform(-6, 0.6, (2, count)) * (random.random((2, count)) < 0.9)
    share = np.clip(random.uniform(-0.3, 1.3, (2, count)), 0, 1)
    upper = lower + width
    points = np.clip(lower + share * width, lower, upper)
    return [*points, lower[0], upper[0], lower[1], upper[1]]


def escapes(expression, places):
    """How many values lie outside the interval that is promised for their box, and how many intervals have ends."""
    lower, upper = image(Promises(expression), ENDS)
    value, low, high = evaluated([expression, lower, upper], dict(zip(NAMES, places, strict=True)))
    slack = 1e-13 * (1 + np.abs(value))  # the ends are rounded like any value
    outside = (value < low - slack) | (value > high + slack)
    return np.array([outside.sum(), (np.isfinite(low) & np.isfinite(high)).sum()])


@pytest.mark.random
@pytest.mark.parametrize("half", [0, 1])
@pytest.mark.parametrize("part", range(5))
def test_the_interval_image_holds_the_value(part, half):
    random = np.random.default_rng(part)
    places = [boxes(random, 250) for _ in range(100)]
    chosen = range(50 * half, 50 * half + 50)
    outside, told = sum(escapes(model(100 * part + k).expression, places[k]) for k in chosen)
    assert outside == 0
    assert told > 11_000  # of 12 500: an end without a value says nothing


class Values:
    """Some expressions as a function of places."""

    def __init__(self, *expressions):
        self.expressions = expressions

    def __call__(self, places):
        return evaluated(self.expressions, dict(zip((x, y), places, strict=True)))


def crossings(values, random, count):
    """Points where the first function changes sign on random segments, by bisection."""
    start, end = random.uniform(-2, 2, (2, 2, count))
    low, high = values(start)[0], values(end)[0]
    cut = np.isfinite(low) & np.isfinite(high) & (low * high < 0)
    start, end, low = start[:, cut].astype(REAL), end[:, cut].astype(REAL), low[cut]
    for _ in range(60):
        middle = (start + end) / 2
        same = values(middle)[0] * low > 0
        start, end = np.where(same, middle, start), np.where(same, end, middle)
    return (start + end) / 2


def slopes(values, points):
    """The gradient of the first function, by differences."""
    step = REAL(1e-6)
    axes = np.eye(2, dtype=REAL)[:, :, None] * step
    return np.array([(values(points + axis)[0] - values(points - axis)[0]) / (2 * step) for axis in axes])


def deviations(shape, contract, random):
    """Where one leaf is zero and with it omega: how far |omega(p + h nu)|/h is from 1, at two distances h."""
    leaves = [leaf.expression for leaf in contract.leaves]
    found = [np.empty((2, 0))]
    for leaf in random.permutation(np.array(leaves, object))[:1]:
        others = [other for other in leaves if other not in (leaf, -leaf)]
        sets = [item.generator for item in contract.singular if sp.Abs not in {type(e) for e in item.equations}]
        kept = [g for g in sets if g not in (leaf, -leaf)]
        zero = Values(leaf)
        points = crossings(zero, random, 24)
        if not points.size:
            continue
        omega, *rest = Values(shape.expression, *others, *kept)(points)
        regular = (abs(omega) < 1e-15) & np.all([abs(v) > 0.02 for v in rest] or [omega == omega], axis=0)
        points = points[:, regular]
        normals = slopes(zero, points)
        normals = normals / np.hypot(*normals)
        omegas = [Values(shape.expression)(points + h * normals)[0] / h for h in (REAL(1e-3), REAL(1e-4))]
        found.append(np.abs(np.abs(omegas) - 1))
    return np.concatenate(found, axis=1)


@pytest.mark.random
@pytest.mark.parametrize("part", PARTS)
def test_the_order_holds(part):
    """To order m the deviation is smaller than any multiple of h**(m - 1); for R_5/2, m = 2, it is h**(3/2)."""
    random, points = np.random.default_rng(part), 0
    for seed in range(SIZE * part, SIZE * (part + 1)):
        shape = model(seed, normalised=True)
        contract = shape.contract()
        if contract.order:
            far, near = deviations(shape, contract, random)
            order = min(contract.order, 3)
            assert (near <= far * 10 ** (0.6 - order) + 1e-12).all(), seed
            points += len(near)
    assert points > 20


def places(equations, random, count):
    """Points where one equation changes sign, or where two vanish, by Newton's steps."""
    if len(equations) == 1:
        return crossings(Values(*equations), random, count)
    points = random.uniform(-2, 2, (2, count)).astype(REAL)
    first, second = (Values(equation) for equation in equations)
    with np.errstate(all="ignore"):
        for _ in range(9):
            (a, b), (c, d) = slopes(first, points), slopes(second, points)
            u, v = first(points)[0], second(points)[0]
            points = points - np.array([d * u - b * v, a * v - c * u]) / (a * d - b * c)
        arrived = (abs(first(points)[0]) + abs(second(points)[0]) < 1e-15) & (abs(points) < 2).all(axis=0)
    return points[:, arrived]


def jumps(expression, points, random, order):
    """How far the derivatives of that order on both sides are apart along random lines, at two distances."""
    angle = random.uniform(0, 2 * np.pi, points.shape[1])
    direction = np.array([np.cos(angle), np.sin(angle)])
    result = []
    for h in (REAL(1e-3), REAL(2e-4)):
        weights = [(-1) ** (order - k) * sp.binomial(order, k) for k in range(order + 1)]
        # The value itself is compared a step away from the place.
        start = 1 if order == 0 else 0
        steps = [(start + k) * h * direction for k in range(order + 1)]
        at = [[Values(expression)(points + side * step)[0] for step in steps] for side in (1, -1)]
        sides = [sum(int(w) * value for w, value in zip(weights, values, strict=True)) for values in at]
        result.append(abs(sides[0] - (-1) ** order * sides[1]) / h**order)
    return result


def broken(expression, lost, random):
    """How many places have a jump in a derivative that is promised to be continuous, and how many places."""
    wrong = count = 0
    told = [item for item in lost if 0 <= item.continuity <= 3 and len(item.equations) < 3]
    for item in random.permutation(np.array(told, object))[:1]:
        points = places(item.equations, random, 8)
        rougher = [other.generator for other in lost if other.continuity < item.continuity]
        if rougher and points.size:
            points = points[:, np.all([abs(v) > 0.03 for v in Values(*rougher)(points)], axis=0)]
        for order in range(item.continuity + 1):
            far, near = jumps(expression, points, random, order)
            wrong += int((near > 0.7 * far + 1e-4).sum())
        count += points.shape[1]
    return np.array([wrong, count])


@pytest.mark.random
@pytest.mark.parametrize("part", PARTS)
def test_the_class_holds(part):
    random = np.random.default_rng(part)
    found = np.zeros(2, int)
    for seed in range(SIZE * part, SIZE * (part + 1)):
        expression = model(seed).expression
        found += broken(expression, singularities(Promises(expression), (x, y)), random)
    assert found[0] == 0
    assert found[1] > 20


def falls(promises, leaf, random):
    """Whether a formula goes the wrong way somewhere when a leaf grows and all leaves take any values."""
    columns = {part: random.uniform(-2, 2, 100) for part in (x, y, *leaves(promises))}
    grown = columns | {leaf: columns[leaf] + 10 ** random.uniform(-4, 1, 100)}
    before, after = (evaluated([promises.root], given)[0] for given in (columns, grown))
    return (slope_of(promises, leaf) * (after - before) < -1e-15).any()


@pytest.mark.random
@pytest.mark.parametrize("part", PARTS)
def test_monotonicity_holds(part):
    random, checked = np.random.default_rng(part), 0
    for seed in range(SIZE * part, SIZE * (part + 1)):
        promises = Promises(model(seed).expression)
        for leaf in leaves(promises):
            if slope_of(promises, leaf) is not None:
                assert not falls(promises, leaf, random), seed
                checked += 1
    assert checked > 10


def test_wrong_promises_are_caught(monkeypatch):
    """Red proof: of a conjunction of R_0, one promise at a time too much."""
    right, random = PROMISES[R0Conjunction], np.random.default_rng(0)
    shape = Shape(R0.conjunction((1 - x**2 - y**2) / 2, (3 * x + 4 * y - 1) / 5), (x, y))

    def promising(**changes):
        monkeypatch.setitem(PROMISES, R0Conjunction, lambda part, least: replace(right(part, least), **changes))
        return Promises(shape.expression)

    promising(image=lambda f, g: (R0.conjunction(f[0], g[1]), R0.conjunction(f[1], g[0])))
    assert escapes(shape.expression, boxes(random, 250))[0] > 0
    corner = Singularity(shape.expression.operands, 1, "too smooth")
    assert broken(shape.expression, singularities(promising(singular=(corner,)), (x, y)), random)[0] > 0
    promising(order=lambda orders: 2)
    assert shape.contract().order == 2
    far, near = deviations(shape, shape.contract(), random)
    assert (near > far * 10 ** (0.6 - 2) + 1e-12).any()
    promises = promising(monotone=(-1, 1))
    assert falls(promises, shape.expression.operands[0], random)
