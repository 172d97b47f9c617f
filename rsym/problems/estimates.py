"""Errors of solutions: how far others are away, which share as little of what may be wrong as can be."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from numbers import Real
from typing import Any, NamedTuple

import numpy as np

from rsym.arrays import Floats
from rsym.errors import RsymError
from rsym.problems.guards import beyond_data, inward_edges, is_bent, is_slow
from rsym.problems.places import rule_for
from rsym.problems.pointwise import first_place
from rsym.problems.problem import Problem
from rsym.problems.refinement import on_fewer
from rsym.problems.solution_report import SolutionReport
from rsym.sampling.rules.quadrature import Quadrature

# An error that falls as cells do is three times its difference from that on three quarters of the cells; at edges that
# point inwards, up to 3.3 times that from one degree less (a thick L, data of x**2 - y**2 + x*z).
SLOWLY = 3.0


Goal = Callable[[Any], float]  # of a solution


class Error(NamedTuple):
    """In the root of the mean square, and at worst, as shares of the largest value, and where it is worst.

    slowly : how many times as large errors are as differences.
    goal : of a number that was asked for, as a share of it.
    """

    mean: float
    worst: float
    place: str
    slowly: float = 1.0
    goal: float | None = None


def goal_of(goal: Any, dimension: int) -> Goal | None:
    """What a tolerance is of: a point, the name of a part, whose flux it is, or a function of the solution."""
    if goal is None or callable(goal):
        given: Goal | None = goal
        return given
    if isinstance(goal, str):
        return lambda solution: float(solution.flux(goal))
    numbers = isinstance(goal, Sequence) and all(isinstance(one, Real) for one in goal)
    if not (numbers and len(goal) == dimension):
        raise RsymError(
            f"the goal is a point, the name of a part or a function of the solution, got {goal!r}",
            code="goal",
            remedy='goal=(0, 0.5), goal="rim" for its flux, goal=lambda u: u.gradient(0, 0)[0]',
        )
    return lambda solution: float(solution(*goal))


def error_of_goal(goal: Goal, solution: Any, others: Sequence[Any]) -> float:
    """How far that of other solutions is away at most, as a share of it."""
    value, *rest = (float(goal(one)) for one in (solution, *others))
    if not all(map(math.isfinite, (value, *rest))):
        raise RsymError(
            f"the goal is {value}: it has no error",
            code="goal",
            remedy="a point inside, or a part through which a finite flux goes",
        )
    apart = max((abs(one - value) for one in rest), default=math.inf)
    return apart / abs(value) if value else math.inf if apart else 0.0


def slowness(problem: Problem) -> float:
    """How many times as large errors may be as what fewer cells, or less of a degree in space, are away."""
    return SLOWLY if is_slow(problem) or inward_edges(problem) else 1.0


def error_of(
    problem: Problem,
    report: SolutionReport,
    rule: Quadrature,
    values: Floats,
    found: Callable[[Quadrature, int, int], Floats],
) -> Error:
    """How far one degree less is away from values at the points of a rule; of the least degree one more.

    found : of a rule, cells and a degree, the values of another solution at the same points.

    Where errors are amplified or fall slowly also how far fewer cells are away: beside corners without functions, or
    edges in space, degrees differ by less than they are wrong, by a tenth, and kinks on interfaces may be as wrong for
    both. Where weights have kinks the lower degree has a rule of its own: about a square hole that of both was 1.8e-6
    wrong, and 2.4e-7 their difference.
    """
    degree = report.degree + (-1 if report.degree > problem.order else 1)
    own = rule_for(problem, report.cells, rule.order - 1) if is_bent(problem) else rule
    lower = values - found(own, report.cells, degree)
    apart = [SLOWLY * lower if inward_edges(problem) else lower]
    slow, times = is_slow(problem), slowness(problem)
    if slow or report.amplified or problem.interfaces.functions:

        def of_fewer(cells: int) -> Floats:
            return found(rule_for(problem, cells, rule.order - 1), cells, report.degree)

        apart.append((SLOWLY if slow else 1.0) * (values - on_fewer(of_fewer, report.cells)))
    if (largest := float(np.max(np.abs(values)))) == 0:
        return Error(0.0, 0.0, "", times)
    away = np.abs(lower)
    means = [float(np.sqrt(np.sum(rule.weights * one**2) / np.sum(rule.weights)) / largest) for one in apart]
    mean = max(*means, beyond_data(problem, rule, values))
    return Error(mean, float(away.max()) / largest, first_place(rule.points, away == away.max()), times)
