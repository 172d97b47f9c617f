"""Problems with functions for the corners of their shapes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from rsym.analysis.conditions import Clamped, Supported
from rsym.arrays import Floats
from rsym.problems.corners.choice import chosen_corners, chosen_waves
from rsym.problems.corners.corners import PlaneCorner
from rsym.problems.corners.goursat import EdgeConditions, of_plate
from rsym.problems.corners.growth import Growth, growth_of, places_at
from rsym.problems.equations import EllipticEquation
from rsym.problems.problem import VALUED, Problem

NO_LOAD = 1e-9  # of the largest at corners: rounding of their places


def with_corners(problem: Problem, degree: int) -> Problem:
    """The same problem with functions for the corners of its shape, for splines of a degree; without where none are."""
    if len(problem.split.leaves) < 2:
        return problem
    if isinstance(problem.equation, EllipticEquation) and problem.equation.order == 4:
        return _plate_with_corners(problem, degree) if problem.dimension == 2 and not problem.cuts else problem
    if not problem.alike:
        return problem
    place = list(problem.equation.expressions).index("f")

    def loaded(corners: Sequence[PlaneCorner]) -> list[bool]:
        points = np.array([corner.point for corner in corners]).reshape(-1, 2)
        sizes = np.abs(problem.coefficients(points)[place])
        return [bool(size > NO_LOAD * sizes.max()) for size in sizes]

    def grown(corners: Sequence[PlaneCorner]) -> list[Growth | None]:
        return [None if any(one.free(natural)) else growth_of(one, *_first_order(problem, one)) for one in corners]

    valued = problem.leaves(*VALUED)
    natural = [leaf for leaf in range(len(problem.form.leaves)) if leaf not in valued]
    marked = problem.switches.marked if problem.cuts else tuple
    chosen = chosen_corners(
        problem.shape, natural, loaded, axis=problem.axis, degree=degree, marked=marked, grown=grown
    )
    return replace(problem, corners=chosen)


def _plate_with_corners(problem: Problem, degree: int) -> Problem:
    clamped, supported = problem.leaves(Clamped), problem.leaves(Supported)

    def conditions(corner: PlaneCorner) -> EdgeConditions:
        first, second = (2 * (leaf in clamped) + (leaf in supported) for leaf in corner.leaves)
        return of_plate(corner, (first, second), problem.poisson)

    return replace(problem, corners=chosen_waves(problem.shape, conditions, degree=degree))


def _first_order(problem: Problem, corner: PlaneCorner) -> tuple[Floats, Floats]:
    """Near a corner k (n,) of -div(k grad u) and b (2, n) of b . grad u, about an axis the radius in both."""
    points = places_at(corner)
    values = dict(zip(problem.equation.expressions, problem.coefficients(points), strict=True))
    radius, convection = problem.radius(points), np.zeros((2, len(points)))
    for (test, trial), name in problem.equation.places.items():
        if test == 0 < trial:
            convection[trial - 1] += radius * values[name]
        elif trial == 0 < test:
            convection[test - 1] -= radius * values[name]
    return radius * values["a00"], convection
