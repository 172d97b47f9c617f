"""What `solve` answers: a function of the coordinates that meets the conditions on values exactly."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from html import escape
from typing import Any

import numpy as np
import sympy as sp
from numpy.typing import ArrayLike

from rsym.analysis.conditions import Clamped, Dirichlet, Robin
from rsym.arrays import Flags, Floats, Ints
from rsym.errors import RsymError, warn
from rsym.logic.leaf_names import shape_leaf_names
from rsym.model.arguments import whole
from rsym.model.shape import Shape
from rsym.problems.equations import EllipticEquation
from rsym.problems.estimates import Error, Goal, error_of, error_of_goal
from rsym.problems.extremes import Attained, Extremes
from rsym.problems.fluxes import flux_through
from rsym.problems.galerkin import Discretisation
from rsym.problems.guards import require_elliptic, require_level, solved_with_mean
from rsym.problems.interfaces import NO_INTERFACES
from rsym.problems.limits import with_limits
from rsym.problems.places import inside, on_shape, rule_for
from rsym.problems.posing import posed_again
from rsym.problems.printed import printed
from rsym.problems.problem import Problem, beside_at, on_cells, oriented
from rsym.problems.resonance import SampledFunctions, resonance, surely_regular
from rsym.problems.solution_report import SolutionReport, reported
from rsym.problems.splines.cardinals import derivatives
from rsym.problems.splines.evaluation import weighted
from rsym.problems.splines.web import WebSplines
from rsym.problems.systems.borders import BesideAt
from rsym.problems.systems.linear import SINGULAR, nearly_singular, solve_system
from rsym.reports.numbers import short
from rsym.reports.words import plural
from rsym.sampling.level_lines import level_lines
from rsym.sampling.rules.quadrature import Quadrature
from rsym.sampling.stills import line_picture

AT_ONCE = 1 << 18  # points
SKETCHED, SKETCH = 6, 72  # level lines in a notebook, on a lattice of so many cells
# An estimated error: of an answer with a larger one next to nothing is known. Layers thinner than cells are little in
# the mean: where an edge takes 3e-3 of the size, errors are a tenth in some place of 48 cells, and a hundredth in it.
SURE = 0.05


@dataclass(frozen=True, eq=False, repr=False)
class Solution:
    """A field on a shape: ``solution(x, y)`` gives its values, NaN outside.

    `plot_field`, `plot_fields`, `plot_sweep`, `plot_gallery`, `level_lines`, `explore` and `write` take it as it is.
    It pickles. A coefficient that is a Python function no pickle holds, a lambda say, stays behind: values and
    derivatives are there, and who asks what needs the function, a flux or other letters, is told.

    Attributes
    ----------
    problem : Problem
        The shape, the equation and the conditions.
    splines : WebSplines
        The functions whose sum it is, times the weight.
    coefficients, others : arrays
        Theirs, (families, active) with those of kinks on interfaces, and those of other functions beside them, such as
        the levels of holes.
    report : SolutionReport
        Unknowns, rule, system, estimate.

    Examples
    --------
    >>> import rsym
    >>> u = rsym.solve(rsym.disc(1), "-laplacian(u) = 1", 0, cells=8)
    >>> u(0, [0, 0.6, 2]).round(10).tolist()
    [0.25, 0.16, nan]
    >>> (u.gradient(0.5, 0).round(10) + 0.0).tolist(), float(u.laplacian(0.1, 0.3).round(8))
    ([-0.25, 0.0], -1.0)
    """

    problem: Problem
    splines: WebSplines
    coefficients: Floats
    others: Floats
    report: SolutionReport
    order: int

    def __repr__(self) -> str:
        cells = " x ".join(map(str, self.splines.counts))
        return f"<Solution of {plural(self.report.unknowns, 'unknown')} on {cells} cells>"

    def _repr_html_(self) -> str:
        words = escape(repr(self))
        if self.problem.dimension != 2:
            return f"<div>{words}</div>"
        values = self.jets(self.rule.points, 0)[0]
        levels = np.linspace(values.min(), values.max(), SKETCHED + 2)[1:-1]
        inner = level_lines(self, levels, resolution=SKETCH) if np.ptp(values) > 0 else ()
        lines = [*level_lines(self.shape, resolution=SKETCH), *(line for one in inner for line in one)]
        return f"<div>{line_picture(lines)}<br>{words}</div>"

    def __getstate__(self) -> dict[str, Any]:
        """What was compiled and computed on the way is made again."""
        return {name: self.__dict__[name] for name in self.__dataclass_fields__}

    @property
    def shape(self) -> Shape:
        """What it is a field on, with the letters it was solved for as defaults."""
        return self.problem.shape

    @property
    def levels(self) -> tuple[tuple[str, float], ...]:
        """Of each curve at a level that was not known, ``rsym.constant()``, what it is called, and the level."""
        names = shape_leaf_names(self.shape)
        return tuple(
            (names[leaves[0]], float(level)) for leaves, level in zip(self.problem.levels, self.others, strict=False)
        )

    @cached_property
    def rule(self) -> Quadrature:
        """The rule of integration that it was found with."""
        return rule_for(self.problem, self.report.cells, self.order)

    def jets(self, points: Floats, order: int = 1, functions: BesideAt | None = None) -> Floats:
        """The derivatives (kinds, n) up to an order of at most 2 at points (n, dimension), whether inside or not.

        They come in the order value, first and second derivatives: u, u_x, u_y, u_xx, u_xy, u_yy.

        functions : those beside splines, if they are known at these points.
        """
        kinds = len(derivatives(self.problem.dimension, order))
        found = np.zeros((kinds, len(points)))
        for first in range(0, len(points), AT_ONCE):
            some = slice(first, first + AT_ONCE)
            here = points[some]
            weight = with_limits(self.problem.weight(order), here, self.inside, self._size)
            weights = self.problem.interfaces.weights(weight, here, order)
            found[:, some] = weighted(self.splines, self.coefficients, weights, here, order)
            lift = self.problem.lift(order)
            if lift is not None:
                found[:, some] += with_limits(lift, here, self.inside, self._size)
            if functions is None:
                beside_at(self.problem, here, order).add_to(found[:, some], self.others)
        if functions is not None:
            functions.add_to(found, self.others)
        return found

    @property
    def _size(self) -> float:
        return float(np.max(self.splines.size * self.splines.counts))

    def __call__(self, *coordinates: ArrayLike) -> Any:
        """Values at points; coordinates broadcast, outside it is NaN."""
        return self._field(coordinates, 0)[0]

    def gradient(self, *coordinates: ArrayLike) -> Any:
        """The gradient (..., dimension) at points: on the boundary its limit, NaN where it has none.

        It has none at re-entrant corners between values, and where parts that are flush end on an edge.
        """
        return np.moveaxis(self._field(coordinates, 1)[1:], 0, -1)

    def hessian(self, *coordinates: ArrayLike) -> Any:
        """The second derivatives (..., dimension, dimension) at points: of a plate, its curvatures."""
        return np.moveaxis(self._field(coordinates, 2)[self._second_places()], (0, 1), (-2, -1))

    def _second_places(self) -> Ints:
        """Where the second derivatives (dimension, dimension) stand among all up to this order."""
        axes = range(self.problem.dimension)
        every = derivatives(self.problem.dimension, 2)
        return np.array([[every.index(tuple((k == i) + (k == j) for k in axes)) for j in axes] for i in axes])

    def laplacian(self, *coordinates: ArrayLike) -> Any:
        """The Laplacian at points; about an axis that of the body in space."""
        return self._laplacian(self._field(coordinates, 2), coordinates)

    def _laplacian(self, found: Floats, coordinates: Sequence[ArrayLike]) -> Any:
        """The Laplacian, of the derivatives up to the order 2 at points."""
        every = derivatives(self.problem.dimension, 2)
        total = sum(found[k] for k, index in enumerate(every) if 2 in index)
        axis = self.problem.axis
        if axis < 0:
            return total
        radius = np.broadcast_arrays(*map(np.asarray, coordinates))[1 - axis]
        with np.errstate(all="ignore"):
            # On the axis u_r/r is u_rr.
            pure = found[every.index(tuple(2 * (k == 1 - axis) for k in range(2)))]
            return total + np.where(radius == 0, pure, found[1 + (1 - axis)] / radius)

    def sampled(
        self, *coordinates: Any, field: str = "value", letters: Mapping[Any, float] | None = None
    ) -> dict[str, Any]:
        """One of `drawn` and its gradient at points, for pictures: also in cells that the shape touches, else NaN.

        The gradient of the Laplacian is not known: it is NaN.
        """
        n = self.problem.dimension
        arrays = np.broadcast_arrays(*(np.asarray(one, np.float64) for one in coordinates))
        points = np.stack([array.ravel() for array in arrays], axis=1)
        order = 1 if field == "value" else 2
        found, on = np.full((len(derivatives(n, order)), len(points)), np.nan), self.splines.carried(points)
        found[:, on] = self.jets(points[on], order)
        value, gradient = found[0], found[1 : 1 + n]
        if field == "gradient_squared":
            second = np.einsum("jn,ijn->in", gradient, found[self._second_places()])
            value, gradient = np.sum(gradient**2, axis=0), 2 * second
        elif field == "laplacian":
            value, gradient = self._laplacian(found, list(points.T)), np.full_like(gradient, np.nan)
        shape = arrays[0].shape
        return {"value": value.reshape(shape), "gradient": np.moveaxis(gradient.reshape(n, *shape), 0, -1)}

    def _field(self, coordinates: tuple[ArrayLike, ...], order: int) -> Floats:
        return on_shape(self.shape, self.splines, coordinates, lambda points: self.jets(points, order))

    def inside(self, points: Floats) -> Flags:
        """Which points (n, dimension) belong to the shape, those of the boundary to rounding."""
        return inside(self.shape, self.splines, points)

    # -- numbers -----------------------------------------------------------------------------------------------------

    def integral(self, functions: BesideAt | None = None) -> float:
        """The integral over the shape; about an axis that over the body in space, 2 pi and the radius in it.

        functions : those beside splines, if they are known at the points of the rule.
        """
        points = self.rule.points
        turn = 1.0 if self.problem.axis < 0 else 2 * np.pi
        return float(
            turn * np.sum(self.rule.weights * self.problem.radius(points) * self.jets(points, 0, functions)[0])
        )

    def flux(self, part: str | None = None) -> float:
        """The flux through a part of the boundary, outwards: the integral of k du/dn; of all of it without a name.

        Where it is given it is that, h - c*u; else it is by Green's formula, whose error is about the square of that of
        the gradient. Through a part at whose end values jump it is infinite, NaN where it is so in both directions.

        Raises
        ------
        RsymError
            For a name that no part of the boundary has.
        """
        return flux_through(self.problem, self.rule, self.jets, part)

    def minimum(self) -> Attained:
        """The least value and a point where it is, found by Newton's method from the least of a few for each cell.

        It is looked for inside, along the leaves of the boundary, and where leaves meet.
        """
        return self._least(1)

    def maximum(self) -> Attained:
        """The greatest value and a point where it is."""
        least = self._least(-1)
        return Attained(-least.value, least.point)

    def _least(self, sign: int) -> Attained:
        found = Extremes(self.problem, self.rule, lambda points, order: sign * self.jets(points, order), self.inside)
        value, point = found.least()
        return Attained(value, tuple(float(one) for one in point))

    def formula(self, degree: int = 6) -> sp.Expr:
        """An expression: the weight times the best polynomial of a total degree, and the lift.

        It meets the conditions on values identically, letters of the shape symbolic in it; the coefficients are those
        for the letters of the solution.

        Examples
        --------
        >>> import rsym
        >>> from rsym import x, y
        >>> u = rsym.solve(rsym.disc(1), "-laplacian(u) = 1", 0, cells=8).formula(0)
        >>> abs(u.subs({x: 0.6, y: 0.0}) - 0.16) < 1e-12, u.subs({x: 1, y: 0})
        (True, 0)
        """
        whole(degree, "the degree", 0)
        if self.report.eigenvalue is not None:
            raise RsymError("a mode has no formula of this kind", code="formula", remedy="solve has")
        smooth = replace(self.problem, corners=None, interfaces=NO_INTERFACES)
        return printed(Discretisation(smooth, self.rule, self.report.degree), degree)

    def with_letters(self, values: Mapping[Any, float]) -> Solution:
        """The same problem for other letters, with the same cells and degree: new matrices, nothing compiled."""
        if self.report.eigenvalue is not None:
            raise RsymError(
                "this is a mode, with an eigenvalue of its own", code="letters", remedy="ask modes of other letters"
            )
        if self.problem.levels and not self.problem.named:
            raise RsymError(
                "this is the function of a twisted shaft, with what its holes of these letters need",
                code="letters",
                remedy="ask torsion.with_letters({...}).solution",
            )
        problem = posed_again(self.problem, values)
        rule = rule_for(problem, self.report.cells, self.order)
        return solved_alone(problem, rule, self.report.cells, self.report.degree)


def with_rule(solution: Solution, rule: Quadrature) -> Solution:
    """The same solution, that knows its rule already."""
    solution.__dict__["rule"] = rule
    return solution


def solved_alone(
    problem: Problem, rule: Quadrature, cells: int, degree: int, estimate: bool = False, goal: Goal | None = None
) -> Solution:
    """The solution on a rule, no other being asked for; where errors are amplified with an estimate in any case."""
    functions = beside_at(problem, rule.points) if estimate else None
    made = solved(problem, rule, cells, degree, functions)
    report = made.report
    if not (report.amplified or estimate):
        return made
    error, worst, place, _, of_goal = estimated(made, functions, goal)
    error = max(error, report.unsure)
    if not max(error, worst) <= SURE:
        there = f", {short(worst)} of it at {place}" if worst > SURE else ""
        warn(
            f"the error, an estimate, is about {short(error)} of the largest value{there}{report.nearness}; give "
            "tolerance=, more cells or a higher degree"
        )
    return with_rule(replace(made, report=replace(report, estimate=error, goal=of_goal)), rule)


def estimated(solution: Solution, functions: BesideAt | None = None, goal: Goal | None = None) -> Error:
    """Its error, by other solutions; `functions` are those beside splines at the points of its rule."""
    problem, own, others = solution.problem, solution.rule, list[Solution]()

    def found(rule: Quadrature, cells: int, degree: int) -> Floats:
        other = solved(problem, rule, cells, degree, functions if rule is own else None, measured=False)
        values: Floats = other.jets(own.points, 0, functions)[0]
        others.append(other)
        return values

    error = error_of(problem, solution.report, own, solution.jets(own.points, 0, functions)[0], found)
    return error if goal is None else error._replace(goal=error.slowly * error_of_goal(goal, solution, others))


def solved(
    problem: Problem,
    rule: Quadrature,
    cells: int,
    degree: int,
    functions: BesideAt | None = None,
    *,
    measured: bool = True,
) -> Solution:
    """The solution on a rule.

    functions : those beside splines at its points, if they are known.
    measured : whether to ask how near the problem is to resonance.
    """
    if degree < problem.order:
        raise RsymError(
            f"an equation of the order {problem.equation.order} needs splines of the degree {problem.order} at least",
            code="degree",
        )
    problem = oriented(on_cells(problem, float(np.max(rule.grid.size))), rule.points)
    discrete = Discretisation(problem, rule, degree, functions=functions)
    require_level(discrete)
    if measured and isinstance(problem.equation, EllipticEquation) and problem.equation.order == 2:
        require_elliptic(problem, rule)
    sampled, regular = SampledFunctions(discrete), surely_regular(discrete)
    if problem.mean is not None:
        found = solved_with_mean(discrete, problem.mean)
    else:
        found = solve_system(
            discrete.matrix,
            discrete.right,
            definite=problem.equation.definite and regular,
            dimension=problem.dimension,
            symmetric=problem.equation.symmetric,
            last=discrete.beside_count,
            held=bool(problem.leaves(Dirichlet, Clamped)) and not problem.leaves(Robin),
            size=sampled.size,
            beside=lambda: discrete.lift_size,
        )
    told = reported(rule, cells, degree, found).of_problem(problem)
    if measured and found.again is not None and not regular:
        amplification, rounding = resonance(sampled, found.again)
        if not rounding <= SINGULAR:
            raise nearly_singular()
        told = replace(told, amplification=amplification, rounding=max(rounding, found.residual))
    return with_rule(Solution(problem, discrete.splines, *discrete.parted(found.values), told, rule.order), rule)
