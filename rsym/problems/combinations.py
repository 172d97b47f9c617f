"""Sums of the functions that a solution is made of, without the lift: weighted splines and those beside them."""

from __future__ import annotations

import numpy as np

from rsym.arrays import Floats
from rsym.problems.splines.cardinals import multiplied
from rsym.problems.splines.evaluation import jets
from rsym.problems.splines.web import WebSplines
from rsym.problems.systems.borders import BesideAt


def weighted(splines: WebSplines, coefficients: Floats, weights: Floats, points: Floats, order: int) -> Floats:
    """The derivatives (kinds, n) up to an order, at points, of weights times sums of active splines, together.

    coefficients, weights : (families, active), or (active,) of the only one, and the derivatives (families, kinds, n).
    """
    sums = jets(splines, np.atleast_2d(coefficients), points, order).transpose(1, 0, 2)
    found = multiplied(weights[0], sums[0], points.shape[1], order)
    for weight, phi in zip(weights[1:], sums[1:], strict=True):
        found += multiplied(weight, phi, points.shape[1], order)
    return found


def add_beside(functions: BesideAt, numbers: Floats, found: Floats) -> None:
    """Add those of the sum of functions beside splines, in place."""
    for number, one in enumerate(functions.beside):
        found[:, one.where] += (functions.of(number)[:, : len(found)] @ numbers[one.numbers]).T
