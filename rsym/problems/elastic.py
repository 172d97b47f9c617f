"""Plane stress and plane strain of elastic bodies."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property, partial
from typing import Any

import numpy as np
import sympy as sp
from numpy.typing import ArrayLike
from scipy import sparse

from rsym.analysis.conditions import BoundaryCondition, dirichlet
from rsym.arrays import Floats
from rsym.errors import RsymError
from rsym.model.arguments import whole
from rsym.model.letters import real_number
from rsym.model.requirements import require_mapping, require_shape
from rsym.model.shape import Shape
from rsym.problems.conditions import given_by_name, resolved
from rsym.problems.equations import equation_of
from rsym.problems.galerkin import Discretisation, applied_form, single_load
from rsym.problems.pointwise import PointFormulas
from rsym.problems.problem import Problem, on_part, value_at
from rsym.problems.solution import MORE_POINTS, Solution, SolutionReport, rule_for, with_rule
from rsym.problems.solving import checked_degree
from rsym.problems.systems.forms import CellPoints, extended
from rsym.problems.systems.linear import solve_system

CELLS = 32
EXAMPLE = '{"wall": (0, 0), "slide": (None, 0)}'


@dataclass(frozen=True, eq=False, repr=False)
class Deformation:
    """An elastic body under loads: ``deformation(x, y)`` gives displacements (..., 2), NaN outside.

    Attributes
    ----------
    components : pair of Solution
        The displacements along x and y, each a field that can be drawn.
    first, shear : float
        Lame's numbers, the first for plane stress or strain.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> bar = rsym.half_plane((1, 0), 0).named("wall") & rsym.half_plane((-1, 0), -2).named("end")
    >>> bar = bar & rsym.half_plane((0, 1), 0).named("floor") & rsym.half_plane((0, -1), -0.5)
    >>> pulled = rsym.elasticity(
    ...     bar, {"wall": (0, None), "floor": (None, 0)}, young=100, poisson=0.3, loads={"end": (1, 0)}, cells=16
    ... )
    >>> pulled(1.5, 0.25).round(9).tolist(), abs(pulled.stress(1, 0.2).round(9)).tolist()
    ([0.015, -0.00075], [1.0, 0.0, 0.0])
    """

    components: tuple[Solution, Solution]
    first: float
    shear: float
    strain: bool
    poisson: float

    def __repr__(self) -> str:
        return f"<Deformation of {self.components[0].report.unknowns} unknowns>"

    def __call__(self, *coordinates: ArrayLike) -> Any:
        """The displacements (..., 2) at points."""
        return np.stack([one(*coordinates) for one in self.components], axis=-1)

    def stress(self, *coordinates: ArrayLike) -> Any:
        """The stresses (..., 3) at points: along x, along y, shear."""
        slopes = [one.gradient(*coordinates) for one in self.components]
        return np.moveaxis(self._stress(np.stack([np.moveaxis(slope, -1, 0) for slope in slopes])), 0, -1)

    def von_mises(self, *coordinates: ArrayLike) -> Any:
        """Von Mises' equivalent stress at points."""
        sx, sy, shear = np.moveaxis(self.stress(*coordinates), -1, 0)
        across = self.poisson * (sx + sy) if self.strain else 0.0
        return np.sqrt(((sx - sy) ** 2 + (sy - across) ** 2 + (across - sx) ** 2) / 2 + 3 * shear**2)

    def reaction(self, part: str) -> tuple[float, float]:
        """The force with which what is outside acts on the body through a part: the integral of stress times normal.

        Raises
        ------
        RsymError
            For a name that no part of the boundary has.
        """
        one = self.components[0]
        boundary, on = one.rule.boundary, on_part(one.problem, one.rule.boundary.leaves, part)
        points = np.ascontiguousarray(boundary.points[on])
        sx, sy, shear = self._stress(np.stack([u.jets(points, 1)[1:] for u in self.components]))
        (nx, ny), weights = boundary.normals[on].T, boundary.weights[on]
        return float(np.sum(weights * (sx * nx + shear * ny))), float(np.sum(weights * (shear * nx + sy * ny)))

    def _stress(self, slopes: Floats) -> Floats:
        """From slopes (component, axis, ...)."""
        spread = self.first * (slopes[0, 0] + slopes[1, 1])
        twice = 2 * self.shear
        shear = self.shear * (slopes[0, 1] + slopes[1, 0])
        return np.stack([spread + twice * slopes[0, 0], spread + twice * slopes[1, 1], shear])


def elasticity(
    shape: Shape,
    conditions: Any,
    *,
    young: Any = 1,
    poisson: Any = 0.3,
    loads: Mapping[str, Any] | None = None,
    body: Any = (0, 0),
    strain: bool = False,
    degree: int = 4,
    cells: int = CELLS,
    letters: Mapping[Any, float] | None = None,
) -> Deformation:
    """The deformation of a plane elastic body, isotropic and linear.

    Parameters
    ----------
    shape : Shape
        In the plane; its parts have names, by ``shape.named(name)``.
    conditions : mapping
        Names of parts to displacements ``(along x, along y)``, numbers or expressions; None in the place of one leaves
        it free. ``...`` is the rest.
    young, poisson : number
        Young's modulus, which is a unit of stress by default, and Poisson's ratio.
    loads : mapping, optional
        Names of parts to tractions ``(along x, along y)``, or a number or expression for a pressure.
    body : pair
        The force on the inside, numbers or expressions: (0, -9.81*density).
    strain : bool
        Plane strain instead of plane stress.
    degree, cells, letters
        As in `solve`.

    Returns
    -------
    Deformation
        Displacements, stresses, reactions.

    Raises
    ------
    RsymError
        For a body that nothing holds along x or along y, a part that is not there, material numbers that are none.

    Examples
    --------
    A ring under the pressure 1 from within, a quarter of it (Lame):

    >>> import rsym
    >>> ring = rsym.disc(1) - rsym.disc(0.5).named("bore")
    >>> quarter = ring & rsym.half_plane((1, 0), 0).named("left") & rsym.half_plane((0, 1), 0).named("low")
    >>> held = {"left": (0, None), "low": (None, 0)}
    >>> tube = rsym.elasticity(quarter, held, young=1, poisson=0.3, loads={"bore": 1}, cells=16)
    >>> abs(tube(0.75, 0)[0] - (0.7 * 0.75 + 1.3 / 0.75) / 3) < 1e-4
    np.True_
    """
    require_shape(shape)
    whole(cells, "the cells", 1)
    checked_degree(degree)
    require_mapping(conditions, "conditions", f"for example {EXAMPLE}")
    if shape.dimension != 2:
        raise RsymError("elasticity is of bodies in the plane", code="dimension", remedy="give a shape of x and y")
    shape = shape if letters is None else shape.with_letters(letters)
    e, nu = float(real_number(young, "Young's modulus")), float(real_number(poisson, "Poisson's ratio"))
    if not (e > 0 and -1 < nu < 0.5):
        raise RsymError(
            f"Young's modulus must be positive and Poisson's ratio between -1 and 1/2, got {e:g} and {nu:g}",
            code="material",
            remedy="for steel young=210e9, poisson=0.3",
        )
    shear = e / (2 * (1 + nu))
    first = e * nu / ((1 + nu) * (1 - 2 * nu)) if strain else e * nu / (1 - nu**2)
    problems = tuple(_component(shape, conditions, axis) for axis in range(2))
    body_problem = _Elastic(problems, first, shear, _pair(body, "the body force"), dict(loads or {}), degree, cells)
    return Deformation(body_problem.solved(), first, shear, strain, nu)


def _pair(given: Any, what: str) -> tuple[Any, Any]:
    if not isinstance(given, tuple | list) or len(given) != 2:
        raise RsymError(f"{what} is a pair (along x, along y), got {given!r}", code="condition", remedy=f"{EXAMPLE}")
    return tuple(sp.sympify(one, strict=True) if one is not None else None for one in given)  # type: ignore[return-value]


def _component(shape: Shape, conditions: Mapping[Any, Any], axis: int) -> Problem:
    """The problem whose weight and lift are those of one component; its equation is not asked."""
    given: dict[Any, BoundaryCondition] = {}
    for name, pair in conditions.items():
        value = _pair(pair, f"the displacement on {'the rest' if name is ... else repr(name)}")[axis]
        if value is not None:
            given[name] = dirichlet(value)
    if not given:
        raise RsymError(
            f"nothing holds the body along {'xy'[axis]}", code="singular", remedy="give a displacement on some part"
        )
    equation = equation_of("-laplacian(u) = 0", shape.coordinates)
    return Problem(shape, equation, given_by_name(shape, given), resolved(shape, given))


def _lifted(lift: PointFormulas, points: Floats) -> Floats:
    """The derivatives (kinds, 1, n) of a lift."""
    return lift(points)[:, None]


@dataclass(frozen=True, eq=False)
class _Elastic:
    """The system of two components."""

    problems: tuple[Problem, ...]
    first: float
    shear: float
    body: tuple[Any, Any]
    loads: Mapping[str, Any]
    degree: int
    cells: int

    @cached_property
    def discrete(self) -> tuple[Discretisation, ...]:
        """Of both on one rule."""
        rule = rule_for(self.problems[0], self.cells, self.degree + MORE_POINTS)
        return tuple(Discretisation(problem, rule, self.degree) for problem in self.problems)

    def form(self, test: int, trial: int) -> Any:
        """first*div u*div v + 2*shear*(strains), of a component of v and one of u."""
        weights = self.discrete[0].rule.weights

        def at(some: slice, points: Floats) -> Floats:
            found = np.zeros((len(points), 3, 3))
            found[:, 1 + test, 1 + trial] += self.first * weights[some]
            found[:, 1 + trial, 1 + test] += self.shear * weights[some]
            if test == trial:
                for axis in range(2):
                    found[:, 1 + axis, 1 + axis] += self.shear * weights[some]
            return found

        return at

    def right(self, component: int) -> Floats:
        """The loads on a component."""
        discrete = self.discrete[component]
        rule, problem = discrete.rule, discrete.problem
        forces = value_at(problem.shape, self.body[component], rule.points) * rule.weights
        total = discrete.loads(discrete.inside, single_load(forces, 3))
        for part, given in self.loads.items():
            on = on_part(problem, rule.boundary.leaves, part)
            where = CellPoints(np.ascontiguousarray(rule.boundary.points[on]), rule.boundary.cells[on])
            if isinstance(given, tuple | list):
                values = value_at(problem.shape, _pair(given, f"the load on {part!r}")[component], where.points)
            else:
                pressure = value_at(problem.shape, sp.sympify(given, strict=True), where.points)
                values = -pressure * rule.boundary.normals[on, component]
            if len(values):
                total = total + discrete.loads(where, single_load(values * rule.boundary.weights[on], 3))
        for trial, other in enumerate(self.problems):
            lift = other.lift(1)
            if lift is not None:
                load = applied_form(self.form(component, trial), partial(_lifted, lift))
                total = total - discrete.loads(discrete.inside, load)
        found: Floats = total[0]
        return found

    def solved(self) -> tuple[Solution, Solution]:
        """Both components."""
        x = self.discrete[0]
        blocks = {}
        for test, trial in ((0, 0), (0, 1), (1, 1)):
            tests, trials = self.discrete[test].tests, self.discrete[trial].tests
            matrix = x.assembler.matrix(x.inside, self.form(test, trial), tests, trials, symmetric=test == trial)
            blocks[test, trial] = extended(x.splines, matrix)
        matrix = sparse.bmat([[blocks[0, 0], blocks[0, 1]], [blocks[0, 1].T, blocks[1, 1]]], format="csr")
        found = solve_system(matrix, np.concatenate([self.right(0), self.right(1)]), definite=True, dimension=2)
        parts = np.split(found.values, 2)
        report = SolutionReport(
            unknowns=len(found.values),
            degree=self.degree,
            cells=self.cells,
            points=len(x.rule.weights),
            steps=found.steps,
            residual=found.residual,
            estimate=None,
            grades=(),
            unresolved=x.rule.unresolved,
        )
        made = [
            with_rule(
                Solution(
                    one.problem, x.splines, x.splines.extension @ part, np.empty(0), report, self.degree + MORE_POINTS
                ),
                x.rule,
            )
            for one, part in zip(self.discrete, parts, strict=True)
        ]
        return made[0], made[1]
