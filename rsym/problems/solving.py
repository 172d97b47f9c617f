"""Boundary value problems on shapes: the public `solve`."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from fractions import Fraction
from functools import partial
from typing import Any

import sympy as sp

from rsym.errors import RsymError, warn
from rsym.language.equations import UNKNOWN
from rsym.model.arguments import coordinate, default, number, whole
from rsym.model.letters import Letter
from rsym.model.requirements import require_shape
from rsym.model.shape import Shape
from rsym.problems.conditions import given_by_name, with_letters_of
from rsym.problems.cornered import with_corners
from rsym.problems.equations import equation_of
from rsym.problems.estimates import Goal, goal_of
from rsym.problems.guards import is_slow
from rsym.problems.peaks import of_problem, unseen
from rsym.problems.places import rule_for, rule_order
from rsym.problems.plates import checked_ratio, require_edges
from rsym.problems.posing import posed
from rsym.problems.problem import Problem, beside_at
from rsym.problems.refinement import HIGHEST_DEGREE, TOLERANCE, last_degree, refined
from rsym.problems.seams.seamless import Seamless, seamless
from rsym.problems.solution import Solution, estimated, solved, solved_alone, with_rule
from rsym.reports.numbers import short
from rsym.sampling.progress import Progress
from rsym.sampling.windows import relettered


def solve(
    shape: Shape,
    equation: Any,
    conditions: Any,
    *,
    degree: int = 4,
    cells: int | None = None,
    tolerance: float | None = None,
    letters: Mapping[Any, Any] | None = None,
    axis: Any = None,
    poisson: float | None = None,
    mean: float | None = None,
    corners: bool = True,
    estimate: bool = True,
    goal: Any = None,
    progress: Progress | None = None,
) -> Solution:
    """The solution of a linear elliptic equation on a shape.

    Parameters
    ----------
    shape : Shape
        In the plane or in space, bounded; its parts have names, by ``shape.named(name)``.
    equation : text or SymPy
        ``"-laplacian(u) = 2"``, ``"-div(k*grad(u)) + c*u = f"``, ``"-laplacian(u) + dot([1, 0], grad(u)) = 0"``, or a
        SymPy equation in ``sympy.Function("u")(x, y)``. Text is read by a parser of its own and never run. Coefficients
        may jump or have kinks, by Piecewise, sign, Heaviside, Abs, Max or Min: solutions have kinks there then.
    conditions : mapping, or one condition for all of the boundary
        Names of parts to a value, an expression, a function (`dirichlet`), ``rsym.robin(c, h)``, ``rsym.neumann(h)``,
        ``rsym.constant(flow)``; the key ``...`` is the rest; where parts lie in one another that of the smallest named
        holds. Where nothing is said nothing flows. Plates, "bilaplacian(u) = q/D", have ``rsym.clamped()`` and
        ``rsym.supported()``; where nothing is said they are free.
    degree : int
        Of the splines, 1 to 6.
    cells : int, optional
        Along the longest side; one system is solved then.
    tolerance : float, optional
        Without `cells`, they are doubled and the degree is raised until the estimate of the error, a share of the
        largest value, is below it; 1e-8 by default. The estimate is the difference from splines of one degree less.
    letters : mapping, optional
        Override the defaults of the shape, and say what other names in the equation are: a number, an expression, a
        Shape (its omega), a Python function of arrays of coordinates, or a vector or matrix of these, for
        ``-div(k*grad(u))`` and ``dot(b, grad(u))``.
    axis : coordinate, optional
        The shape in the plane is half the section of a body of revolution about this axis; u does not depend on the
        angle, and operators are those of space.
    poisson : float, optional
        Poisson's ratio of a plate; it matters on edges that are free, or supported and curved.
    mean : float, optional
        Of the solution, where only fluxes are given, which have to balance the sources.
    corners : bool
        Whether functions of their own are added at corners of a shape in the plane where solutions are singular; an
        equation that diffuses differently in different directions has none.
    estimate : bool
        Whether, of a number of cells too, the error is estimated; without, half of the time is saved.
    goal : point, text or function, optional
        What the tolerance is of, as a share of it: the value at a point, the flux through a part of this name, or the
        number that a function of the solution gives, as ``lambda u: u.gradient(0, 0)[0]``. By default u all over.
    progress : callable, optional
        ``progress(done, total)``; an answer of False cancels.

    Returns
    -------
    Solution
        A function of the coordinates, on which values are exact on the boundary.

    Raises
    ------
    RsymError
        For an equation that is not elliptic, not linear or of an order that is not offered, a source with a pole inside
        that has no integral, an unknown part, a problem without a single answer, too few cells.

    Warns
    -----
    RsymWarning
        Where the tolerance is not reached, or the error on given cells is about 5 % or more, in the mean or in some
        place; where a shape touches itself, or conditions change at places near to each other, and cells do not
        resolve it; where a problem is so near to one without a single answer, as ``-laplacian(u) - c*u = f`` for c near
        an eigenvalue, that next to nothing of the answer is sure.

    Examples
    --------
    >>> import rsym
    >>> ring = rsym.disc(1).named("rim") - rsym.disc(0.5).named("bore")
    >>> u = rsym.solve(ring, "-laplacian(u) = 0", {"rim": rsym.neumann(1), "bore": 0}, cells=16)
    >>> abs(u(0, 1) - 0.6931471805599453) < 1e-6
    np.True_
    """
    problem = problem_of(shape, equation, conditions, letters=letters, axis=axis, poisson=poisson)
    if mean is not None:
        problem = replace(problem, mean=default(number(mean, "the mean"), problem.shape.letters, "the mean"))
    return answered(problem, degree, cells, tolerance, corners, progress, estimate, goal_of(goal, shape.dimension))


def answered(
    problem: Problem,
    degree: int,
    cells: int | None,
    tolerance: float | None,
    corners: bool,
    progress: Progress | None,
    estimate: bool = True,
    goal: Goal | None = None,
) -> Solution:
    """The solution of a problem on a grid, or refined until its estimate of the error is small enough."""
    checked_degree(degree)
    problem = with_corners(problem, last_degree(degree, cells)) if corners else problem
    if cells is not None:
        whole(cells, "the cells", 1)
        rule = rule_for(problem, cells, rule_order(problem, cells, degree))
        if problem.cuts:
            problem.switches.warn_if_near(rule.grid.size, cells)
        return solved_alone(problem, rule, cells, degree, estimate, goal)

    def attempt(cells: int, degree: int) -> tuple[Solution, int, float]:
        rule = rule_for(problem, cells, rule_order(problem, cells, degree))
        functions = beside_at(problem, rule.points)
        made = solved(problem, rule, cells, degree, functions)
        told = estimated(made, functions, goal)
        error = max(told.mean if told.goal is None else told.goal, made.report.unsure)
        made = with_rule(replace(made, report=replace(made.report, estimate=told.mean, goal=told.goal)), rule)
        # What all points of a rule miss is in no difference of degrees.
        return made, made.report.unknowns, error if error > wanted else max(error, missed(made))

    wanted = reachable(tolerance, problem.off)
    found, grades = refined(
        attempt,
        problem.dimension,
        degree,
        wanted,
        progress,
        beside=problem.has_corners or is_slow(problem) or bool(problem.interfaces.functions),
        why=lambda made: made.report.nearness,
    )
    last: dict[str, Any] = {"estimate" if goal is None else "goal": grades[-1].estimate}
    told = replace(found.report, grades=grades, **last)
    return with_rule(replace(found, report=told), found.rule)


def reachable(tolerance: float | None, off: float) -> float:
    """The tolerance, or how far formulas are off that stand for functions on the boundary, where that is more."""
    wanted = TOLERANCE if tolerance is None else tolerance
    if off == 0 or off <= wanted:
        return wanted
    warn(
        f"functions given on the boundary are met to about {short(off)} of the largest value, above the tolerance "
        f"of {short(wanted)}; give expressions"
    )
    return off


def checked_degree(degree: Any) -> int:
    """A degree that splines are offered in."""
    whole(degree, "the degree", 1)
    if degree > HIGHEST_DEGREE:
        raise RsymError(f"the degree must be 1 to {HIGHEST_DEGREE}, got {degree}", code="degree")
    return int(degree)


def problem_of(
    shape: Shape,
    equation: Any,
    conditions: Any,
    *,
    letters: Mapping[Any, Any] | None = None,
    axis: Any = None,
    poisson: float | None = None,
    single: bool = True,
) -> Problem:
    """The data of a problem, checked; `single`: whether it must have one answer."""
    require_shape(shape)
    if isinstance(equation, str) and UNKNOWN in map(str, letters or {}) and UNKNOWN not in shape.letters:
        raise RsymError(
            f"'{UNKNOWN}' is the unknown function of equations: letters= cannot say what it is",
            code="unknown-letter",
            remedy="rename the letter",
        )
    seams, named = lettered(with_letters_of(shape, conditions), letters)
    found = equation_of(equation, shape.coordinates, named)
    turned = turned_about(shape, axis)
    named_conditions = given_by_name(seams.shape, conditions)
    made = posed(Problem(seams.shape, found, named_conditions, (), turned, poisson=checked_ratio(poisson), seams=seams))
    require_edges(made, single=single)
    return made


def turned_about(shape: Shape, axis: Any) -> int:
    """The number of the coordinate that a shape in the plane is turned about, -1 without an axis."""
    if axis is None:
        return -1
    if shape.dimension != 2:
        raise RsymError("axis= is for shapes in the plane", code="axis", remedy="leave it out")
    return coordinate(axis, shape.coordinates, "the axis")


def lettered(
    shape: Shape, letters: Mapping[Any, Any] | None, divisible: bool = True
) -> tuple[Seamless, dict[str, Any]]:
    """The shape at values of its letters, with those of other names, and what names stand for that are no numbers."""
    named: dict[str, Any] = {}
    numbers: dict[str, Any] = {}
    for key, value in (letters or {}).items():
        name = str(key)
        is_number = isinstance(value, int | float | Fraction | sp.Number | Letter)
        if name in shape.letters or is_number:
            numbers[name] = value
        else:
            named[name] = value
            if isinstance(value, Shape):
                shape = shape.replace(letters={**value.letters, **shape.letters})
    shape = relettered(shape, {name: value for name, value in numbers.items() if name in shape.letters})
    shape = shape.replace(letters={**{n: v for n, v in numbers.items() if n not in shape.letters}, **shape.letters})
    for name in shape.letters:
        named.setdefault(name, sp.Symbol(name, real=True))
    return seamless(shape, divisible).told(), named


def missed(solution: Solution) -> float:
    """How much of the data of its problem a solution may not have seen, as a share of their squares; or 0."""
    problem, rule = solution.problem, solution.rule
    data = of_problem(problem)
    return (
        0.0 if data is None else unseen(rule, partial(rule_for, problem, order=rule.order), solution.report.cells, data)
    )
