"""Sums of the functions that a solution is made of, without the lift: weighted splines and those beside them."""

from __future__ import annotations

import numpy as np

from rsym.arrays import Floats
from rsym.problems.problem import Problem
from rsym.problems.splines.cardinals import derivatives, product_terms
from rsym.problems.splines.evaluation import jets
from rsym.problems.splines.web import WebSplines


def combined(
    problem: Problem, splines: WebSplines, coefficients: Floats, others: Floats, points: Floats, order: int
) -> Floats:
    """The derivatives (kinds, n) up to an order, at points, of the sum of active splines, weighted, and others."""
    found = np.zeros((len(derivatives(problem.dimension, order)), len(points)))
    weight = problem.weight(order)(points)
    phi = jets(splines, coefficients[None], points, order)[:, 0]
    for term in product_terms(problem.dimension, order):
        found[term.whole] += term.times * weight[term.left] * phi[term.right]
    for one in problem.beside(points):
        found[:, one.where] += (one.derivatives(points[one.where], order) @ others[one.numbers]).T
    return found
