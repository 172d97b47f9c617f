"""What every solution has to keep, and costs little to look at: harmonic functions lie within their data."""

from __future__ import annotations

import numpy as np

from rsym.analysis.conditions import Dirichlet, Robin
from rsym.arrays import Floats
from rsym.problems.equations import EllipticEquation
from rsym.problems.problem import VALUED, Problem
from rsym.sampling.rules.quadrature import Quadrature


def beyond_data(problem: Problem, rule: Quadrature, values: Floats) -> float:
    """By how much of the largest value a solution is above or below all of its data, where it has to lie within.

    That is so without sources, where it is given on parts of the boundary and nothing flows through the others. The
    `values` are those at the points of the rule.
    """
    boundary, equation = rule.boundary, problem.equation
    if (
        not isinstance(equation, EllipticEquation)
        or equation.order != 2
        or not (equation.load == 0 == equation.reaction)
    ):
        return 0.0
    given, valued = problem.leaves(Dirichlet), problem.leaves(*VALUED)
    natural = [problem.conditions[leaf] for leaf in problem.leaves(Robin)]
    if given != valued or any(isinstance(one, Robin) and not (one.flux == 0 == one.coefficient) for one in natural):
        return 0.0
    on = np.isin(boundary.leaves, given)
    if not on.any():
        return 0.0
    lift = problem.lift(0)
    data = np.zeros(1) if lift is None else lift(np.ascontiguousarray(boundary.points[on]))[0]
    largest = max(float(np.abs(values).max()), float(np.abs(data).max()))
    beyond = max(float(values.max() - data.max()), float(data.min() - values.min()), 0.0)
    return beyond / largest if largest else 0.0
