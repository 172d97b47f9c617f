"""Eigenvalues and modes of shapes: drums, plates, closed rooms, sloshing."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np
import sympy as sp
from scipy import sparse

from rsym.analysis.conditions import Clamped, Dirichlet, Robin
from rsym.arrays import Floats
from rsym.errors import RsymError
from rsym.language.stating import WrittenEquation
from rsym.model.arguments import whole
from rsym.model.shape import Shape
from rsym.problems.cornered import with_corners
from rsym.problems.estimates import slowness
from rsym.problems.galerkin import Discretisation, at_values
from rsym.problems.interfaces import interfaces_of
from rsym.problems.left_behind import portable
from rsym.problems.peaks import unseen, varies
from rsym.problems.places import MORE_POINTS, rule_for
from rsym.problems.posing import posed_again
from rsym.problems.problem import Problem, on_part, oriented, value_at
from rsym.problems.refinement import (
    TOLERANCE,
    Grade,
    graded_alone,
    last_degree,
    observed_order,
    on_fewer,
    refined,
    told,
)
from rsym.problems.solution import Solution, with_rule
from rsym.problems.solution_report import reported
from rsym.problems.solving import checked_degree, missed, problem_of
from rsym.problems.systems.forms import CellPoints
from rsym.problems.systems.linear import Solved, eigenpairs, rank
from rsym.reports.words import plural
from rsym.sampling.progress import Progress
from rsym.sampling.rules.quadrature import Quadrature

SIGNED = 2000  # places at which a mode is looked at for its sign


@dataclass(frozen=True, eq=False, repr=False)
class Spectrum:
    """The least eigenvalues of a shape, ascending, and the modes, each of which has the mean square 1 by the mass.

    Attributes
    ----------
    values : (count,)
        The eigenvalues.
    modes : tuple of Solution
        Functions of the coordinates; the sign of each is such that it is positive where it is largest, of some two
        thousand places.
    grades : tuple
        The refinement, of which the last estimate is a share of each eigenvalue.
    mass
        As it was given.

    Examples
    --------
    >>> import rsym
    >>> drum = rsym.modes(rsym.disc(1), 3, cells=8)
    >>> drum.values.round(6).tolist()
    [5.783186, 14.681971, 14.681971]
    >>> drum.modes[0](0, 0).round(4)
    np.float64(1.0868)
    """

    values: Floats
    modes: tuple[Solution, ...]
    grades: tuple[Grade, ...] = ()
    mass: Any = 1

    @property
    def observed_order(self) -> float | None:
        """By which order in the size of cells the last two estimates fell; None where cells were given."""
        return observed_order(self.grades)

    def __repr__(self) -> str:
        first, last = (told(float(value), self.grades) for value in self.values[[0, -1]])
        return f"<Spectrum of {plural(len(self.values), 'eigenvalue')} from {first} to {last}>"

    def __getstate__(self) -> dict[str, Any]:
        """A mass that is a function which no pickle holds stays behind."""
        return self.__dict__ | {"mass": portable(self.mass, "the mass")}

    def with_letters(self, values: Mapping[Any, float]) -> Spectrum:
        """The same for other letters, with the same cells and degree: nothing is compiled."""
        problem, report = self.modes[0].problem, self.modes[0].report
        problem = _with_kinks(posed_again(problem, values), self.mass)
        return _spectrum(problem, report.cells, report.degree, len(self.values), self.mass)


def modes(
    shape: Shape,
    count: int = 6,
    conditions: Any = None,
    *,
    mass: Any = 1,
    equation: Any = "-laplacian(u) = 0",
    degree: int = 4,
    cells: int | None = None,
    tolerance: float | None = None,
    letters: Mapping[Any, Any] | None = None,
    axis: Any = None,
    poisson: float | None = None,
    corners: bool = True,
    estimate: bool = True,
    progress: Progress | None = None,
) -> Spectrum:
    """The least eigenvalues and the modes of a shape: L u = lambda*m*u with homogeneous conditions.

    Parameters
    ----------
    shape, degree, cells, tolerance, letters, axis, poisson, corners, estimate, progress
        As in `solve`; the estimate is the largest change of an eigenvalue from one degree less on
        three quarters of the cells, as a share of it.
    count : int
        How many.
    conditions : mapping or one condition, optional
        As in `solve`, values 0; without any u = 0 on all of the boundary. ``{}`` is a closed room: nothing flows.
    mass : number, expression, Shape, function, or mapping
        m; of a mapping of names of parts that on these parts of the boundary, none inside: sloshing has
        ``{"surface": 1}``.
    equation : text or SymPy
        Its operator is L, its right side 0 (that of a model file is not looked at); ``"bilaplacian(u) = 0"`` for
        plates, with conditions.

    Raises
    ------
    RsymError
        As `solve`, and for conditions or an equation that are not homogeneous, a mass below 0, more modes than there
        are unknowns.

    Examples
    --------
    >>> import rsym
    >>> float(rsym.modes(rsym.disc(1), 1, cells=8).values[0].round(7))
    5.783186
    >>> abs(rsym.modes(rsym.rectangle(2, 1), 3, {}, cells=8).values).round(4).tolist()
    [0.0, 2.4674, 9.8696]
    """
    whole(count, "the number of modes", 1)
    checked_degree(degree)
    given = 0 if conditions is None else conditions
    problem = problem_of(shape, equation, given, letters=letters, axis=axis, poisson=poisson, single=False)
    if isinstance(equation, WrittenEquation):
        # A model file states one equation for solve and for this.
        problem = replace(problem, equation=replace(problem.equation, load=sp.S.Zero))
    _require_homogeneous(problem)
    problem = _with_kinks(problem, mass)
    problem = with_corners(problem, last_degree(degree, cells)) if corners else problem

    def compared(cells: int, degree: int, made: Spectrum) -> float:
        lower = on_fewer(lambda fewer: _spectrum(problem, fewer, degree - 1, count, mass), cells)
        scale = np.maximum(np.abs(made.values), np.abs(made.values).max() * 1e-3)
        return slowness(problem) * float(np.max(np.abs(made.values - lower.values) / scale))

    if cells is not None:
        made = _spectrum(problem, cells, degree, count, mass)
        error = partial(compared, cells, degree, made)
        grades = graded_alone(cells, degree, made.modes[0].report.unknowns, error, estimate)
        return replace(made, grades=grades)

    def attempt(cells: int, degree: int) -> tuple[Spectrum, int, float]:
        made = _spectrum(problem, cells, degree, count, mass)
        error = compared(cells, degree, made)
        return made, made.modes[0].report.unknowns, error if error > wanted else max(error, _missed(made))

    wanted = TOLERANCE if tolerance is None else tolerance

    found, grades = refined(attempt, problem.dimension, degree, tolerance, progress)
    return replace(found, grades=grades)


def _with_kinks(problem: Problem, mass: Any) -> Problem:
    """The problem with the interfaces of its mass inside too."""
    every = [*problem.equation.expressions.values(), *([mass] if isinstance(mass, sp.Expr) else [])]
    return replace(problem, interfaces=interfaces_of(problem.shape, every, problem.order))


def _missed(made: Spectrum) -> float:
    """How much of the data and of the mass inside a spectrum may not have seen."""
    mode, mass = made.modes[0], made.mass
    found, shape = missed(mode), mode.shape
    if isinstance(mass, Mapping) or not varies(mass):
        return found

    def data(rule: Quadrature) -> Iterator[tuple[Floats, Floats]]:
        yield value_at(shape, mass, rule.points)[None], rule.weights

    finer = partial(rule_for, mode.problem, order=mode.rule.order)
    return max(found, unseen(mode.rule, finer, mode.report.cells, data))


def _spectrum(problem: Problem, cells: int, degree: int, count: int, mass: Any) -> Spectrum:
    order = degree + MORE_POINTS
    rule = rule_for(problem, cells, order)
    problem = oriented(problem, rule.points)
    discrete = Discretisation(problem, rule, degree)
    stiffness, masses = discrete.matrix, _masses(discrete, mass)
    if count >= stiffness.shape[0] - 1:
        raise RsymError(f"{count} modes of {stiffness.shape[0]} unknowns", code="cells", remedy="ask for more cells")
    if isinstance(mass, Mapping) and count > (most := rank(masses)):
        raise RsymError(
            f"{count} modes of a mass that moves in {most} ways", code="cells", remedy="ask for more cells, fewer modes"
        )
    # Where constants, or rigid motions of a plate, are modes the stiffness alone has no factors.
    grid = rule.grid
    free = not problem.leaves(Dirichlet, Clamped)
    unit = 1.0 / float(np.max(np.multiply(grid.size, grid.counts))) ** problem.equation.order
    values, vectors = eigenpairs(stiffness, masses, count, -unit if free else 0.0, unit, last=discrete.beside_count)
    made = reported(rule, cells, degree, Solved(vectors[:, 0], 0, 0.0)).of_problem(problem)
    found = []
    for value, vector in zip(values, vectors.T, strict=True):
        size = np.sqrt(abs(vector @ (masses @ vector)))
        one = Solution(
            problem,
            discrete.splines,
            *discrete.parted(vector / size),
            replace(made, eigenvalue=float(value)),
            order,
        )
        sampled = one.jets(rule.points[:: max(1, len(rule.points) // SIGNED)], 0)[0]
        if sampled[np.argmax(np.abs(sampled))] < 0:
            one = replace(one, coefficients=-one.coefficients, others=-one.others)
        found.append(with_rule(one, rule))
    return Spectrum(values, tuple(found), mass=mass)


def _masses(discrete: Discretisation, mass: Any) -> sparse.csr_matrix:
    """The matrix of the mass, inside or on parts of the boundary."""
    shape = discrete.problem.shape
    if not isinstance(mass, Mapping):
        inside = _density(mass)
        _require_mass(value_at(shape, inside, discrete.rule.points), "the shape")
        return discrete.mass(inside)
    boundary = discrete.rule.boundary
    forms = []
    for part, density in mass.items():
        on = on_part(discrete.problem, boundary, part)
        where = CellPoints(np.ascontiguousarray(boundary.points[on]), boundary.cells[on])
        value = _density(density)
        values = value_at(shape, value, where.points)
        _require_mass(values, repr(part))
        weights = boundary.weights[on] * discrete.problem.radius(where.points) * values
        forms.append((where, at_values(weights, discrete.kinds)))
    return discrete.of_forms(forms)


def _density(mass: Any) -> Any:
    """A mass as it can be evaluated."""
    if callable(mass) or isinstance(mass, Shape):
        return mass
    try:
        return sp.sympify(mass, strict=True)
    except sp.SympifyError:
        raise RsymError(
            f"the mass is a number, an expression, a shape or a function, got {mass!r}",
            code="mass",
            remedy="for example mass=1 + rsym.x**2",
        ) from None


def _require_mass(values: Floats, place: str) -> None:
    """Refuse a density at points of a place that is below 0 at one, or 0 at all."""
    if not (np.all(values >= 0) and np.any(values > 0)):
        raise RsymError(
            f"the mass on {place} is from {float(values.min()):.4g} to {float(values.max()):.4g}",
            code="mass",
            remedy="a mass is 0 or more, and more somewhere; eigenvalues of the negative one are the negative ones",
        )


def _require_homogeneous(problem: Problem) -> None:
    """Refuse what makes L u = lambda*m*u no problem of eigenvalues."""
    flowing = any(problem.flows) or any(problem.conditions[leaf].flux != 0 for leaf in problem.leaves(Robin))  # type: ignore[union-attr]
    wrong = {
        "a value": problem.lifted.expression != 0,
        "a flux": flowing,
        "a right side": problem.equation.expressions["f"] != 0,
        "first derivatives": not problem.equation.symmetric,
    }
    if any(wrong.values()):
        raise RsymError(
            "modes need conditions with values 0 and fluxes 0, and an equation without a right side and first "
            f"derivatives, got {', '.join(word for word, there in wrong.items() if there)}",
            code="condition",
            remedy="give conditions with 0; solve(shape, equation, conditions) answers what is not homogeneous",
        )
