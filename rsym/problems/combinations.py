"""Sums of the functions that a solution is made of, without the lift: weighted splines and those beside them."""

from __future__ import annotations

from rsym.arrays import Floats
from rsym.problems.splines.cardinals import multiplied
from rsym.problems.splines.evaluation import jets
from rsym.problems.splines.web import WebSplines
from rsym.problems.systems.borders import BesideAt


def weighted(splines: WebSplines, coefficients: Floats, weight: Floats, points: Floats, order: int) -> Floats:
    """The derivatives (kinds, n) up to an order, at points, of the weight times the sum of active splines.

    weight : those of the weight (kinds, n).
    """
    phi = jets(splines, coefficients[None], points, order)[:, 0]
    return multiplied(weight, phi, points.shape[1], order)


def add_beside(functions: BesideAt, numbers: Floats, found: Floats) -> None:
    """Add those of the sum of functions beside splines, in place."""
    for number, one in enumerate(functions.beside):
        found[:, one.where] += (functions.of(number)[:, : len(found)] @ numbers[one.numbers]).T
