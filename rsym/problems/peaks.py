"""Peaks of data that all points of a rule miss, so that they are in no difference of two degrees on it.

Sums of squares of the data on the rule are compared with those on smaller cells.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any, TypeAlias

import numpy as np
import sympy as sp

from rsym.analysis.conditions import Robin
from rsym.arrays import Floats
from rsym.problems.problem import Problem, value_at
from rsym.problems.refinement import FIRST_CELLS
from rsym.sampling.rules.quadrature import Quadrature
from rsym.sampling.rules.refinement import FINER

SEEN = 1e-3  # of sums on two rules: larger differences are peaks that one of them misses

# The values (k, n) of data on a rule, and the weights (n,) of its points there.
Data: TypeAlias = Callable[[Quadrature], Iterator[tuple[Floats, Floats]]]


def unseen(rule: Quadrature, finer: Callable[[int], Quadrature], cells: int, data: Data) -> float:
    """How much more than a thousandth the squares of data sum up to on `finer` cells, as a share; or 0."""
    dimension = len(rule.grid.counts)
    other = finer(max(FINER[dimension] * FIRST_CELLS + 1, 2 * cells + 1))
    worst = 0.0
    for one, two in zip(data(rule), data(other), strict=True):
        here, there = (np.sum(weights * values**2, axis=1) for values, weights in (one, two))
        largest = np.maximum(here, there)
        apart = np.abs(here - there)[largest > 0] / largest[largest > 0]
        worst = max(worst, float(apart.max(initial=0.0)))
    return worst if worst > SEEN else 0.0


def varies(*values: Any) -> bool:
    """Whether one of some data is no number."""
    return any(not isinstance(value, int | float) and bool(getattr(value, "free_symbols", True)) for value in values)


def of_problem(problem: Problem) -> Data | None:
    """The coefficients of the equation, and what is given on the boundary; None where all are numbers."""
    inside = varies(*problem.equation.expressions.values())
    flows = {leaf: problem.conditions[leaf] for leaf in problem.leaves(Robin)}
    on_boundary = {k: (one.coefficient, one.flux) for k, one in flows.items() if isinstance(one, Robin)}
    on_boundary = {leaf: pair for leaf, pair in on_boundary.items() if varies(*pair)}
    lift = problem.lift(0) if varies(sp.sympify(problem.lifted.expression)) else None
    if not (inside or on_boundary or lift is not None):
        return None

    def data(rule: Quadrature) -> Iterator[tuple[Floats, Floats]]:
        boundary = rule.boundary
        if inside:
            yield problem.coefficients(rule.points), rule.weights
        for leaf, pair in on_boundary.items():
            on = boundary.leaves == leaf
            points = np.ascontiguousarray(boundary.points[on])
            yield np.array([value_at(problem.shape, value, points) for value in pair]), boundary.weights[on]
        if lift is not None:
            yield lift(boundary.points), boundary.weights

    return data
