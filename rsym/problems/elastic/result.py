"""What `elasticity` answers: displacements, strains and stresses in a body, and the forces that hold it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from rsym.arrays import Floats
from rsym.model.shape import Shape
from rsym.problems.conditions import Name
from rsym.problems.elastic.bodies import STRAIN, ElasticBody, with_corners
from rsym.problems.elastic.equilibrium import AXES, Equilibrium, Forces
from rsym.problems.places import on_shape, rule_on
from rsym.problems.solution import AT_ONCE, Solution, with_rule
from rsym.problems.solution_report import SolutionReport, reported, treatments
from rsym.problems.splines.web import WebSplines
from rsym.problems.systems.linear import solve_system
from rsym.reports.words import plural
from rsym.sampling.rules.quadrature import Quadrature


class PlaneTensor(NamedTuple):
    """A symmetric tensor whose components across the plane, xz and yz, are 0; x, y are the first two coordinates.

    Examples
    --------
    >>> import rsym
    >>> bar = rsym.rectangle(2, 1) & rsym.half_plane((1, 0), 0).named("wall")
    >>> pulled = rsym.elasticity(bar, {"wall": rsym.fixed()}, young=1, poisson=0, loads=(1, 0), cells=8)
    >>> round(float(pulled.stress(0.5, 0).xx), 6)
    0.5
    """

    xx: Any
    yy: Any
    xy: Any
    zz: Any

    @property
    def von_mises(self) -> Any:
        """Von Mises's number, ``sqrt(3/2 s:s)`` of the deviator s."""
        xx, yy, xy, zz = self
        return np.sqrt(((xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2) / 2 + 3 * xy**2)


@dataclass(frozen=True, eq=False, repr=False)
class ElasticSolution:
    """The state of an elastic body in the plane; fields take coordinates that broadcast, and are NaN outside.

    Attributes
    ----------
    body : ElasticBody
        The shape, what it is made of, what holds and loads it.
    splines : WebSplines
        The functions whose sums the displacements are, times their weights.
    coefficients, others : (2, families, splines), (functions,)
        Theirs, and those of the functions at corners, which have both components.
    report : SolutionReport
        Unknowns, rule, system, estimate.

    Examples
    --------
    >>> import rsym
    >>> ring = rsym.disc(2).named("rim") - rsym.disc(1).named("bore")
    >>> held = rsym.elasticity(ring, {"rim": 0, "bore": rsym.pressure(1)}, young=1, poisson=0.3, cells=16)
    >>> held.displacement(1, 0).round(4).tolist(), held(3, 0).tolist()
    ([0.6658, 0.0], [nan, nan])
    >>> round(float(held.stress(0, 1).yy), 2)
    -1.0
    """

    body: ElasticBody
    splines: WebSplines
    coefficients: Floats
    others: Floats
    report: SolutionReport
    order: int

    def __repr__(self) -> str:
        cells = " x ".join(map(str, self.splines.counts))
        return f"<ElasticSolution of {plural(self.report.unknowns, 'unknown')} on {cells} cells>"

    def __getstate__(self) -> dict[str, Any]:
        """What was compiled and computed on the way is made again."""
        return {name: self.__dict__[name] for name in self.__dataclass_fields__}

    @property
    def shape(self) -> Shape:
        """The body, undeformed, with the letters it was solved for as defaults."""
        return self.body.shape

    @cached_property
    def rule(self) -> Quadrature:
        """The rule of integration that it was found with."""
        return rule_of(self.body, self.report.cells, self.order)

    @cached_property
    def components(self) -> tuple[Solution, ...]:
        """The displacement along each coordinate, a field that can be drawn, and asked for its maximum and the like."""
        return tuple(
            with_rule(Solution(problem, self.splines, row, self.others, self.report, self.order), self.rule)
            for problem, row in zip(self.body.problems, self.coefficients, strict=True)
        )

    def jets(self, points: Floats) -> Floats:
        """The values and gradients (2, 3, n) of both displacements at points (n, 2), whether inside or not."""
        found = np.array([one.jets(points, 1) for one in self._alone])
        for first in range(0, len(points), AT_ONCE):
            some = slice(first, first + AT_ONCE)
            here = found[:, :, some].reshape(6, -1)
            self.body.beside_at(points[some]).add_to(here, self.others)
            found[:, :, some] = here.reshape(2, 3, -1)
        return found

    @cached_property
    def _alone(self) -> tuple[Solution, ...]:
        """The components without the functions at corners, which have both."""
        none = np.empty(0)
        return tuple(
            Solution(problem, self.splines, row, none, self.report, self.order)
            for problem, row in zip(self.body.without_corners.problems, self.coefficients, strict=True)
        )

    # -- fields ------------------------------------------------------------------------------------------------------

    def __call__(self, *coordinates: ArrayLike) -> Any:
        """The displacement (..., 2) at points."""
        return self.displacement(*coordinates)

    def displacement(self, *coordinates: ArrayLike) -> Any:
        """The displacement (..., 2) at points."""
        found = on_shape(self.shape, self.splines, coordinates, lambda points: self.jets(points)[:, 0])
        return np.moveaxis(found, 0, -1)

    def strain(self, *coordinates: ArrayLike) -> PlaneTensor:
        """The strains at points, xy half the change of the angle."""
        return PlaneTensor(*on_shape(self.shape, self.splines, coordinates, self._strains))

    def stress(self, *coordinates: ArrayLike) -> PlaneTensor:
        """The stresses at points; zz is 0 in plane stress."""
        return PlaneTensor(*on_shape(self.shape, self.splines, coordinates, self.stresses))

    def von_mises(self, *coordinates: ArrayLike) -> Any:
        """Von Mises's stress, ``sqrt(3/2 s:s)`` of the deviator s of the stresses."""
        return self.stress(*coordinates).von_mises

    def principal_stresses(self, *coordinates: ArrayLike) -> Any:
        """The principal stresses (..., 2) in the plane, the greater one first; the third one is ``stress(...).zz``."""
        xx, yy, xy, _ = self.stress(*coordinates)
        middle, radius = (xx + yy) / 2, np.hypot((xx - yy) / 2, xy)
        return np.stack((middle + radius, middle - radius), axis=-1)

    def stresses(self, points: Floats) -> Floats:
        """The stresses (4, n) in the order of `PlaneTensor` at points (n, 2), whether inside or not."""
        first, shear = self.body.moduli(points)
        (xx, xy), (_, yy) = Equilibrium.stress(self.jets(points), (first, shear))
        # In plane strain the first of Lame's numbers is that of space.
        across = first / (2 * (first + shear)) * (xx + yy) if self.body.plane == STRAIN else np.zeros_like(xx)
        return np.array([xx, yy, xy, across])

    def _strains(self, points: Floats) -> Floats:
        (_, xx, above), (_, right, yy) = self.jets(points)
        across = np.zeros_like(xx)
        if self.body.plane != STRAIN:
            first, shear = self.body.moduli(points)
            # The first number is E*nu/(1 - nu**2) = 2*mu*nu/(1 - nu), and the strain -nu/(1 - nu)*(xx + yy).
            across = -first / (2 * shear) * (xx + yy)
        return np.array([xx, yy, (above + right) / 2, across])

    # -- numbers -----------------------------------------------------------------------------------------------------

    @cached_property
    def _equilibrium(self) -> Equilibrium:
        return Equilibrium(self.body, self.rule, self.report.degree)

    @cached_property
    def reactions(self) -> Mapping[Name, Forces]:
        """The force and the moment by which each part that is held acts on the body, by its name."""
        return self._equilibrium.reactions(self.jets(self.rule.points))

    @cached_property
    def loads(self) -> Forces:
        """The force and the moment of all loads; with the reactions they are in balance."""
        return self._equilibrium.loads()

    @cached_property
    def energy(self) -> float:
        """The energy of the strains, half the integral of sigma : epsilon."""
        found = self.jets(self.rule.points)
        stress = Equilibrium.stress(found, self._equilibrium.moduli)
        return float(sum(np.sum(stress[i, k] * found[i, 1 + k]) for i in AXES for k in AXES) / 2)

    def with_letters(self, values: Mapping[Any, float]) -> ElasticSolution:
        """The same body for other letters, with the same cells and degree: new matrices, nothing compiled."""
        seams = self.body.seams.relettered(values)
        body = replace(self.body, shape=seams.shape, seams=seams, corners=None)
        if self.body.corners is not None:
            body = with_corners(body, self.body.corners.degree)
        rule = rule_of(body, self.report.cells, self.order)
        return in_equilibrium(body, rule, self.report.cells, self.report.degree)


def rule_of(body: ElasticBody, cells: int, order: int) -> Quadrature:
    """The rule of integration of a body, graded towards corners that have functions of their own."""
    near = None if body.corners is None else body.corners.functions.grading
    return rule_on(body.shape, body.named, cells, order, near, body.interfaces.functions)


def in_equilibrium(body: ElasticBody, rule: Quadrature, cells: int, degree: int) -> ElasticSolution:
    """The state of a body, on a rule."""
    system = Equilibrium(body, rule, degree)
    system.require_held()
    found = solve_system(
        system.matrix,
        system.right,
        definite=True,
        dimension=2,
        last=system.beside_count,
        beside=lambda: system.lift_size,
    )
    lines = dict.fromkeys(line for problem in body.problems for line in treatments(problem))
    told = replace(reported(rule, cells, degree, found), off=body.off, treatments=(*lines,))
    told = told.of_corners(body.corners).of_interfaces(body.interfaces)
    made = ElasticSolution(body, system.discrete[0].splines, *system.parted(found.values), told, rule.order)
    made.__dict__["rule"] = rule
    return made
