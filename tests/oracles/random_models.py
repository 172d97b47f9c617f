"""Random models: formulas of leaves under operations of every system, motions, trimming, joining, blends."""

import numpy as np
import sympy as sp

import rsym
from rsym import R0, R1, R0m, RAlpha, Rp, Shape, x, y
from rsym.model.blends.displacement import Displacement
from rsym.model.blends.rho import Rho
from rsym.model.blends.sardf import Sardf
from rsym.model.powers import absolute_power
from rsym.model.symmetry.waves import TriangleWave

THIRD, HALF = sp.Rational(1, 3), sp.Rational(1, 2)
KEEPING = (R0, R1, RAlpha(HALF), RAlpha(-HALF), RAlpha(1), Rp(4), Rp(3), Rp(sp.Rational(5, 2)), Sardf(), Rho(THIRD))
SYSTEMS = (*KEEPING, R0m(1), R0m(2), Rho(THIRD, continuity="G2"))
_QUADRIC = 1 - x**2 / 2 - y**2
_SUPER = 1 - absolute_power(x, sp.Integer(3)) - absolute_power(y, sp.Integer(3))
LEAVES = (  # those that are normalised first
    x - THIRD,
    (3 * x + 4 * y - 1) / 5,
    (1 - x**2 - y**2) / 2,
    (1 - x) * (x + HALF) / sp.Rational(3, 2),
    1 - sp.sqrt((x - HALF) ** 2 + y**2),
    _QUADRIC / sp.sqrt(_QUADRIC**2 + x**2 + 4 * y**2),
    _SUPER / sp.sqrt(_SUPER**2 + 9 * x**4 + 9 * y**4),
    sp.sin(3 * x) / 3,
    (1 - TriangleWave(x, 1) ** 2 - y**2) / 2,
    1 - x**2 / 2 - y**2,
    x * y - THIRD,
    y - sp.sin(x) * sp.cos(2 * y) / 2,
    sp.exp(x - y) - 1,
    sp.Max(x - y, 0, evaluate=False) ** 2 - THIRD,
    sp.Abs(x, evaluate=False) - y**2,
    sp.atan2(y + 2, x) - 1,
    x / (2 + y**2) - sp.Rational(1, 5),
    sp.tanh(x) + sp.log(3 + y),
    absolute_power(x + y, sp.Rational(5, 2)) - HALF,
)
NORMALISED = 9


def formula(random, depth, leaves, systems):
    """A tree of operations over leaves."""
    if depth == 0 or random.random() < 0.15:
        return leaves[random.integers(len(leaves))]
    operands = [formula(random, depth - 1, leaves, systems) for _ in range(random.integers(2, 4))]
    kind = random.random()
    if kind < 0.6:
        system = systems[random.integers(len(systems))]
        return system.conjunction(*operands) if random.random() < 0.5 else system.disjunction(*operands)
    order = sp.Integer(random.integers(1, 4))
    if kind < 0.7:
        return rsym.equivalence(*operands, order=order)
    if kind < 0.8:
        return rsym.joining(*operands, order=order)
    if kind < 0.88:
        return rsym.trimming(*operands[:2])
    if kind < 0.95 or systems is KEEPING:
        return -operands[0]
    return R0.disjunction(*operands[:2]) + Displacement(HALF, 1, 1, *operands[:2])


def model(seed, normalised=False):
    """A plane shape, turned and moved."""
    random = np.random.default_rng(seed)
    leaves, systems = (LEAVES[:NORMALISED], KEEPING) if normalised else (LEAVES, SYSTEMS)
    expression = formula(random, int(random.integers(1, 3)), leaves, systems)
    shape = Shape(expression, (x, y), bounds=((-2, 2), (-2, 2)))
    if random.random() < 0.5:
        shape = shape.rotate(sp.Integer(random.integers(1, 6)) / 3).translate((sp.Rational(1, 7), -THIRD))
    return shape.replace(bounds=((-2, 2), (-2, 2)))
