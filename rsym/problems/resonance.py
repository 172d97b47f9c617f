"""How near a problem is to one that has no single answer: what its solution makes of small changes.

Of A w = mu*w the eigenvalue nearest to 0 is found by inverse iteration, with the products of functions and not of their
numbers: what others make up is no function of its own there, whatever it does to the condition of the matrix. Near it
a change of the coefficients by a share changes the answer by so many times as much,

    |a|(w, w) / (|mu|*(w, w)),

where |a| is the form with all of its terms at points positive. It is 1 where the form is positive, about
2*lambda/|lambda - c| for -laplacian(u) - c*u beside an eigenvalue lambda.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from rsym.arrays import Floats, Ints
from rsym.problems.galerkin import Discretisation
from rsym.problems.problem import beside_at
from rsym.problems.splines.evaluation import weighted
from rsym.problems.systems.borders import BesideAt
from rsym.problems.systems.forms import CellPoints, single_load
from rsym.problems.systems.iterations import SEED

# Points of the rule that are looked at, of each unknown and at least: for two digits of a mean square.
SAMPLED, FEWEST = 3, 3000
EPSILON = float(np.finfo(float).eps)


class Resonance(NamedTuple):
    """How many times a share of change is amplified, and the share of the answer that rounding may be."""

    amplification: float
    rounding: float


def surely_regular(discrete: Discretisation) -> bool:
    """Whether a form that is positive, or a maximum principle, says that there is a single answer."""
    problem, highest = discrete.problem, discrete.problem.order
    equation, named = problem.equation, discrete.coefficients(discrete.rule.points)
    second = problem.dimension * (highest - 1)  # below it are derivatives of less than the highest order
    inside = {pair: named[name] for pair, name in equation.places.items() if named[name].any()}
    for (test, trial), values in inside.items():
        carried = highest == 1 and test == 0 < trial
        if not (carried or min(test, trial) > second or (test == trial and np.all(values >= 0))):
            return False
    edges = [item for part in discrete.edge_parts for item in part.form.items()]
    return all(test == trial == 0 and np.all(values >= 0) for (test, trial), values in edges)


@dataclass(frozen=True)
class SampledFunctions:
    """The functions of a system at some points of its rule: what numbers amount to, whatever functions share of it."""

    discrete: Discretisation

    @cached_property
    def some(self) -> Ints:
        """Which points."""
        count = len(self.discrete.inside.points)
        return np.flatnonzero(np.random.default_rng(SEED).random(count) < self.share)

    @property
    def share(self) -> float:
        """Of the points of the rule."""
        count = len(self.discrete.inside.points)
        return min(1.0, max(FEWEST, SAMPLED * len(self.discrete.right)) / count)

    @cached_property
    def where(self) -> CellPoints:
        """The points."""
        every = self.discrete.inside
        return CellPoints(np.ascontiguousarray(every.points[self.some]), every.cells[self.some])

    @cached_property
    def weights(self) -> Floats:
        """Theirs, of a mean."""
        return self.discrete.rule.weights[self.some] * self.discrete.problem.radius(self.where.points) / self.share

    @cached_property
    def _beside(self) -> BesideAt:
        return beside_at(self.discrete.problem, self.where.points)

    def jets(self, numbers: Floats, points: Floats, order: int) -> Floats:
        """The derivatives (kinds, n) of a function, by its numbers, at points."""
        problem, splines = self.discrete.problem, self.discrete.splines
        coefficients, others = self.discrete.parted(numbers)
        weights = problem.interfaces.weights(problem.weight(order)(points), points, order)
        found = weighted(splines, coefficients, weights, points, order)
        functions = self._beside if points is self.where.points else beside_at(problem, points, order)
        functions.add_to(found, others)
        return found

    def length(self, values: Floats) -> float:
        """The root of the integral of the square."""
        return float(np.sqrt(np.sum(self.weights * values**2)))

    def size(self, numbers: Floats) -> float:
        """That of a function."""
        return self.length(self.jets(numbers, self.where.points, 0)[0])


def resonance(functions: SampledFunctions, again: Callable[[Floats], Floats]) -> Resonance:
    """That of a problem whose system is solved `again` for other right sides."""
    discrete, where, weights = functions.discrete, functions.where, functions.weights
    # Noise has something of each eigenfunction; in the second step what is nearest to resonance prevails.
    values, nearest = np.random.default_rng(SEED).standard_normal(len(weights)), 0.0
    for _ in range(2):
        values /= functions.length(values)
        numbers = again(discrete.loads(where, single_load(weights * values, discrete.kinds))[0])
        values = functions.jets(numbers, where.points, 0)[0]
        nearest = functions.length(values)  # |mu|*(w, w)
    total = 0.0
    for place, form in discrete.forms():
        inside = place is discrete.inside
        own = functions.some if inside else np.arange(len(place.points))
        points = where.points if inside else place.points
        there = np.abs(functions.jets(numbers, points, discrete.problem.order))
        amount = float(np.einsum("nij,in,jn", np.abs(form(own, points)), there, there))
        total += amount / functions.share if inside else amount
    squares = numbers**2
    noise = EPSILON * np.sqrt(np.sum(squares * (discrete.matrix.power(2) @ squares)))
    return Resonance(max(1.0, total / nearest), float(noise / nearest))
