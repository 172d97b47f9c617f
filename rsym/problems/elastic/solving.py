"""Elastic bodies in the plane: the public `elasticity`."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any, Literal

import numpy as np
import sympy as sp

from rsym.analysis.conditions import condition_value
from rsym.arrays import Floats
from rsym.errors import RsymError, warn
from rsym.model.arguments import whole
from rsym.model.requirements import require_mapping, require_shape
from rsym.model.shape import Shape
from rsym.problems.conditions import given_by_name
from rsym.problems.corners.corners import inward_corners
from rsym.problems.elastic.bodies import STRAIN, STRESS, ElasticBody, with_corners
from rsym.problems.elastic.result import ElasticSolution, in_equilibrium, rule_of
from rsym.problems.elastic.supports import EXAMPLES, Pressure, Traction, as_support, vector
from rsym.problems.estimates import Goal, error_of_goal
from rsym.problems.peaks import of_problem, unseen, varies
from rsym.problems.places import MORE_POINTS
from rsym.problems.refinement import FEWER, last_degree, on_fewer, refined
from rsym.problems.solution import SURE
from rsym.problems.solving import checked_degree, lettered, reachable
from rsym.problems.sources import require_integrable
from rsym.reports.numbers import short
from rsym.sampling.progress import Progress
from rsym.sampling.rules.quadrature import Quadrature

DISPLACEMENTS: Literal["displacement"] = "displacement"
STRESSES = "stress"
AT_CORNERS = 0.5  # of the cells: beside corners without functions errors fall slowly, and so do differences
# Overlapping discs, one held: errors fall by 1.3 where cells are halved, so that they are twice the difference.
SLOWLY = 2
# Cells: at corners whose functions end sooner errors fall as slowly as without. An edge of a disc 0.08 from its bore,
# held, 16 cells of 0.105: 5e-3 off, by the difference alone 9e-4.
NARROW = 2
BESIDE = 3  # cells from such a corner, within which stresses are not compared


def elasticity(
    shape: Shape,
    conditions: Mapping[Any, Any],
    *,
    young: Any = None,
    poisson: Any = None,
    loads: Any = (0, 0),
    plane: str = STRESS,
    degree: int = 4,
    cells: int | None = None,
    tolerance: float | None = None,
    letters: Mapping[Any, Any] | None = None,
    corners: bool = True,
    goal: Literal["displacement", "stress"] | Goal = DISPLACEMENTS,
    estimate: bool = True,
    progress: Progress | None = None,
) -> ElasticSolution:
    """The displacements and stresses of an elastic body in the plane, of thickness 1, strains being small.

    div sigma + f = 0,  sigma = lambda*tr(eps)*I + 2*mu*eps,  eps = (grad u + grad u^T)/2.

    Parameters
    ----------
    shape, degree, cells, tolerance, letters, corners, progress
        As in `solve`, of a shape in the plane; the estimate is that of displacements, as a share of the largest one,
        by one degree less on fewer cells.
    conditions : mapping
        Names of parts to ``rsym.fixed()``, or 0; ``{"x": 0.1}``, a displacement along some coordinates, the others
        free; ``rsym.roller()`` for straight parts along an axis, planes of symmetry among them; ``rsym.traction((0,
        -1))``; ``rsym.pressure(2)``; the key ``...`` is the rest. Where nothing is said no force acts.
    young, poisson : number, expression, Shape or function
        Young's modulus and Poisson's ratio: both must be given.
    loads : sequence
        The force on a volume, along each coordinate.
    plane : "stress" or "strain"
        A thin plate, free across the plane, or a long body that cannot become longer.
    goal : "displacement", "stress" or function
        What the tolerance is of: stresses, of which the worst place counts, as a share of the largest; or the number
        that a function of the solution gives, as ``lambda body: body.stress(0, 1).xx``, as a share of it. Near
        corners where they may have no bound, those that point inwards and most between what is held and what is not,
        stresses do not count.
    estimate : bool
        Whether errors are estimated of a number of cells too.

    Returns
    -------
    ElasticSolution
        Displacements, which are exact where they are given, strains, stresses, reactions.

    Raises
    ------
    RsymError
        For a body that may move without being strained, a material that is none, and as `solve`; it warns as that.

    Examples
    --------
    A quarter of a thick ring under pressure inside; on its inner side the stress along the circle is 5/3.

    >>> import rsym
    >>> ring = rsym.disc(2) - rsym.disc(1).named("bore")
    >>> quarter = ring & rsym.half_plane((1, 0), 0).named("left") & rsym.half_plane((0, 1), 0).named("below")
    >>> conditions = {"bore": rsym.pressure(1), "left": rsym.roller(), "below": rsym.roller()}
    >>> found = rsym.elasticity(quarter, conditions, young=1, poisson=0.3, cells=24)
    >>> bool(abs(found.stress(1, 0).yy - 5 / 3) < 1e-4)
    True
    """
    require_shape(shape)
    if shape.dimension != 2:
        raise RsymError("elastic bodies are in the plane", code="dimension", remedy="give a section of the body")
    require_mapping(conditions, "condition", EXAMPLES)
    if plane not in (STRESS, STRAIN):
        raise RsymError(f'plane is "{STRESS}" or "{STRAIN}", got {plane!r}', code="plane")
    if young is None or poisson is None:
        raise RsymError(
            "Young's modulus and Poisson's ratio of the body are not given",
            code="material",
            remedy="for steel, in N and mm, young=210e3, poisson=0.3",
        )
    if not (callable(goal) or goal in (DISPLACEMENTS, STRESSES)):
        raise RsymError(f'goal is "{DISPLACEMENTS}", "{STRESSES}" or a function, got {goal!r}', code="goal")
    aim = goal if callable(goal) else None
    checked_degree(degree)
    seams, _ = lettered(shape, letters, divisible=False)
    shape = seams.shape
    material = condition_value(young, "Young's modulus"), condition_value(poisson, "Poisson's ratio")
    supports = given_by_name(shape, conditions, as_support)
    body = ElasticBody(shape, supports, *material, vector(loads, "a force on a volume"), plane, seams)
    for load in body.loads:
        if isinstance(load, sp.Expr):
            require_integrable(shape, load, "the force on a volume")
    body = with_corners(body, last_degree(degree, cells)) if corners else body
    if cells is not None:
        whole(cells, "the cells", 1)
        if not estimate:
            return in_equilibrium(body, rule_of(body, cells, degree + MORE_POINTS), cells, degree)
        found = _compared(body, cells, degree, aim)
        error = found.report.estimate or 0.0
        if not error <= SURE:
            warn(
                f"the error of displacements, an estimate, is about {short(error)} of the largest; give tolerance=, "
                "more cells or a higher degree"
            )
        return found

    def attempt(cells: int, degree: int) -> tuple[ElasticSolution, int, float]:
        made = _compared(body, cells, degree, aim)
        error = getattr(made.report, wanted_of) or 0.0
        return made, made.report.unknowns, error if error > wanted else max(error, _missed(made))

    wanted_of = "goal" if aim is not None else "stress" if goal == STRESSES else "estimate"
    wanted = reachable(tolerance, body.off)
    beside = body.corners is not None and len(body.corners.functions) > 0
    found, grades = refined(attempt, 2, degree, wanted, progress, beside=beside)
    last: dict[str, Any] = {wanted_of: grades[-1].estimate}
    told = replace(found, report=replace(found.report, grades=grades, **last))
    told.__dict__["rule"] = found.rule
    return told


def _compared(body: ElasticBody, cells: int, degree: int, aim: Goal | None) -> ElasticSolution:
    """The state on a grid, with estimates of its errors."""

    def found(cells: int, degree: int) -> ElasticSolution:
        return in_equilibrium(body, rule_of(body, cells, degree + MORE_POINTS), cells, degree)

    made, (left, rough) = found(cells, degree), corners_of(body)
    if degree == 1:
        return _with_errors(made, math.inf, math.inf, None if aim is None else math.inf, left)
    unknown = left or made.report.refused or body.interfaces.doubts or _narrowest(body) < NARROW * made.rule.grid.size
    other = on_fewer(lambda fewer: found(fewer, degree - 1), cells, AT_CORNERS if unknown else FEWER)
    error, stress = _apart(made, other, rough)
    times = SLOWLY if unknown else 1
    of_goal = None if aim is None else times * error_of_goal(aim, made, [other])
    return _with_errors(made, times * error, times * stress, of_goal, left)


def corners_of(body: ElasticBody) -> tuple[int, Floats]:
    """How many corners have no functions though they point inwards, and where stresses have no bound, (n, 2)."""
    inward, choice = inward_corners(body.shape), body.corners
    if choice is None:
        return len(inward), inward
    own = [part.corner.point for part in choice.functions.parts if part.terms[0].exponent < 1]
    rough = np.array([*own, *(corner.point for corner in choice.left)]).reshape(-1, 2)
    return len(choice.left), rough


def _narrowest(body: ElasticBody) -> float:
    """The least radius, in leaf coordinates, of functions at corners."""
    return min((part.radius for part in body.corners.functions.parts), default=math.inf) if body.corners else math.inf


def _with_errors(made: ElasticSolution, error: float, stress: float, goal: float | None, left: int) -> ElasticSolution:
    """The same with estimates; so many corners that point inwards have no functions of their own."""
    unsure = made.report.unsure
    report = replace(made.report, estimate=max(error, unsure), stress=max(stress, unsure), goal=goal, left=left)
    told = replace(made, report=report)
    told.__dict__["rule"] = made.rule
    return told


def _apart(made: ElasticSolution, other: ElasticSolution, corners: Floats) -> tuple[float, float]:
    """How far another state is away: displacements in the root of the mean square, stresses where they are most.

    As shares of the largest; stresses not within some cells of corners where they have no bound.
    """
    rule = made.rule
    values, others = (one.jets(rule.points)[:, 0] for one in (made, other))
    largest = float(np.sqrt(np.max(np.sum(values**2, axis=0))))
    if largest == 0:
        return 0.0, 0.0
    apart = np.sum((values - others) ** 2, axis=0)
    error = float(np.sqrt(np.sum(rule.weights * apart) / np.sum(rule.weights)) / largest)
    points = np.vstack([rule.points, rule.boundary.points])
    for corner in corners:
        points = points[np.hypot(*(points - corner).T) > BESIDE * rule.grid.size]
    if not len(points):
        return error, math.inf
    one, two = (made.stresses(points), other.stresses(points))
    most = float(np.max(np.abs(one)))
    return error, float(np.max(np.abs(one - two))) / most if most else 0.0


def _missed(found: ElasticSolution) -> float:
    """How much of loads, moduli and what is given on the boundary a state may not have seen."""
    body, order = found.body, found.rule.order
    parts = [data for data in map(of_problem, body.problems) if data is not None]

    def data(rule: Quadrature) -> Iterator[tuple[Floats, Floats]]:
        boundary = rule.boundary
        yield np.concatenate([body.load(rule.points), body.moduli(rule.points)]), rule.weights
        for leaf in range(len(body.names)):
            on = boundary.leaves == leaf
            force = body.traction(leaf, np.ascontiguousarray(boundary.points[on]), boundary.normals[on])
            if force is not None:
                yield force, boundary.weights[on]
        for part in parts:
            yield from part(rule)

    if not (parts or varies(*body.loads, body.young, body.poisson, *_forces(body))):
        return 0.0
    return unseen(found.rule, lambda cells: rule_of(body, cells, order), found.report.cells, data)


def _forces(body: ElasticBody) -> list[Any]:
    """What presses and pulls on the parts of a body."""
    found: list[Any] = []
    for condition in body.named.values():
        found += [condition.pressure] if isinstance(condition, Pressure) else []
        found += condition.force if isinstance(condition, Traction) else ()
    return found
