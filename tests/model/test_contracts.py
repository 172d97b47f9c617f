"""Contracts: what nodes promise and what a shape's formula comes to."""

import math

import pytest
import sympy as sp

import rsym
from rsym import x, y, z
from rsym.analysis.contracts.orders import leaf_order
from rsym.model.powers import absolute_power

r, a, b, k = sp.symbols("r a b k", positive=True)
QUADRIC = 1 - x**2 / a**2 - y**2 / b**2
GYROID = sp.sin(x) * sp.cos(y) + sp.sin(y) * sp.cos(z) + sp.sin(z) * sp.cos(x) - a
SUPER = 1 - absolute_power(x / a, k) - absolute_power(y / b, k)
SUPER_SLOPES = (k / a * absolute_power(x / a, k - 1)) ** 2 + (k / b * absolute_power(y / b, k - 1)) ** 2


def over_root(f, squared):
    return f / sp.sqrt(f**2 + squared)


@pytest.mark.random
@pytest.mark.parametrize(
    ("leaf", "order"),
    [
        (r**2 - x**2 - y**2, 0),
        ((r**2 - x**2 - y**2) / (2 * r), 1),
        (r - sp.sqrt(x**2 + y**2 + z**2), math.inf),
        ((a * x + b * y - r) / sp.sqrt(a**2 + b**2), math.inf),
        ((a * x + b * y - r) / sp.sqrt(a**2 + 2 * b**2), 0),
        ((b - x) * (x - a) / (b - a), 1),
        ((b - x) * (x - a) / (b + a), 0),
        (over_root(QUADRIC, 4 * x**2 / a**4 + 4 * y**2 / b**4), 1),
        (over_root(QUADRIC, 4 * x**2 / a**4 + 2 * y**2 / b**4), 0),
        (r - sp.sqrt((sp.sqrt(x**2 + y**2) - a) ** 2 + z**2), math.inf),
        ((r**2 - (sp.sqrt(x**2 + y**2) - a) ** 2 - z**2) / (2 * r), 1),
        ((y * sp.cos(k * z) - x * sp.sin(k * z)) / sp.sqrt(1 + k**2 * (x**2 + y**2)), 2),
        (over_root(GYROID, sum(GYROID.diff(v) ** 2 for v in (x, y, z))), 1),
        (over_root(SUPER, SUPER_SLOPES), 1),
        (over_root(SUPER, 2 * SUPER_SLOPES), 0),
        (sp.sinh(x) / sp.cosh(x), 2),
        (sp.log(x), None),
        (sp.sin(x) * sp.cos(x), 2),
        (sp.sin(2 * x) - 2 * sp.sin(x) * sp.cos(x) + x, math.inf),
        (x + x**3 * y, 2),
        (x + x**2 * y, 1),
        (x * y, 0),
        (r, math.inf),
    ],
    ids=str,
)
def test_the_order_of_a_leaf(leaf, order):
    assert leaf_order(leaf, (x, y, z)) == order


@pytest.mark.slow
def test_the_leaves_of_the_car():
    """What the source says is not normalised: roof, windows, headlights; and nothing else."""
    contract = rsym.paper.car().contract()
    lost = {leaf.part for leaf in contract.not_normalised}
    assert lost == {"roof", "side windows", "front and rear window", "headlights"}
    assert all(leaf.order == 0 for leaf in contract.not_normalised)
    assert {leaf.order for leaf in contract.leaves} == {0, 1, math.inf}
    assert contract.order == 0
    assert contract.continuity == 0
