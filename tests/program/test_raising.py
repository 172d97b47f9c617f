"""Nodes go back to SymPy as what they compute: lowered once more they have the same values."""

import numpy as np
import pytest
import sympy as sp

import rsym
from rsym import x, y
from rsym.program.builder import Builder
from rsym.program.lowering import lower
from rsym.program.operations import OPERATIONS
from rsym.program.raising import raised

a = sp.Symbol("a", real=True)
FORMULAS = [
    a * x**2 - y / 3 + sp.pi,
    rsym.conjunction(x, y, rsym.disjunction(x - 1, a, system=rsym.R1)),
    rsym.conjunction(x, y - 1, system=rsym.RAlpha(a)),
    rsym.disjunction(x, y - 1, system=rsym.Rp(4)),
    rsym.disjunction(x, y - 1, system=rsym.R0m(2)),
    rsym.joining(x, y, x - y, order=2),
    rsym.equivalence(x, y, order=2),
    rsym.trimming(x - y, y),
    rsym.normalise(rsym.ellipse(2, 1)).expression,
    sp.Piecewise((x, y > x), (sp.sin(y) ** 3, True)),
    sp.exp(-x) + sp.atan2(x, y) + sp.erf(y) + sp.sqrt(sp.Abs(x * y)),
]


@pytest.mark.parametrize("formula", FORMULAS, ids=lambda formula: sp.sstr(formula)[:30])
def test_what_is_raised_has_the_same_values(formula):
    b = Builder(("x", "y"), ("a",))
    back = raised(b.nodes, lower(b, formula))
    points = np.random.default_rng(3).uniform(-2, 2, (2, 200))
    one, other = (rsym.compile(rsym.Shape(f, (x, y), letters={a: 0.7}))(*points)["value"] for f in (formula, back))
    assert np.isfinite(one).all()
    assert np.abs(one - other).max() < 1e-12


def test_r_nodes_are_kept_and_parts_shared():
    b = Builder(("x", "y"), ("a",))
    nest = rsym.conjunction(x, y)
    for _ in range(40):
        nest = rsym.disjunction(nest, rsym.conjunction(nest, x))
    back = raised(b.nodes, lower(b, nest))
    assert type(back) is type(nest)
    assert back.args[0].func == nest.args[0].func


def test_every_operation_has_a_formula():
    lacking = [name for name, row in OPERATIONS.items() if row.formula is None and name not in {"const", "input"}]
    assert lacking == []
