"""Saint-Venant's torsion: the rigidity and the stresses of twisted shafts, hollow ones too."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from rsym.analysis.conditions import constant, dirichlet
from rsym.errors import RsymError
from rsym.logic.separation import separated_gates
from rsym.model.requirements import require_shape
from rsym.model.shape import Shape
from rsym.problems.cornered import with_corners
from rsym.problems.equations import equation_of
from rsym.problems.estimates import slowness
from rsym.problems.extremes import Attained
from rsym.problems.loops import BoundaryLoop, loops_of
from rsym.problems.places import rule_for, rule_order
from rsym.problems.problem import Problem, beside_at
from rsym.problems.refinement import Grade, graded_alone, last_degree, observed_order, on_fewer, refined, told
from rsym.problems.seams.seamless import Seamless, seamless
from rsym.problems.solution import Solution, solved
from rsym.problems.solving import checked_degree
from rsym.sampling.progress import Progress
from rsym.sampling.windows import relettered


@dataclass(frozen=True, eq=False, repr=False)
class Torsion:
    """A shaft under torsion, for the shear modulus and the twist 1.

    Attributes
    ----------
    solution : Solution
        Prandtl's function, -laplacian(u) = 2, 0 on the outer boundary and level on each hole; its level lines are the
        stress lines.
    rigidity : float
        J, the moment: twice the integral of u, and of each hole its level times twice its area.
    levels, areas : tuples of float
        Of the holes.
    grades : tuple
        The refinement; the estimate is the change of J from one degree less on three quarters of the cells, as a share
        of it.

    Examples
    --------
    >>> import rsym
    >>> shaft = rsym.torsion(rsym.disc(1) - rsym.disc(0.5), cells=16)
    >>> round(float(shaft), 6), round(15 / 32 * 3.14159265359, 6)
    (1.472622, 1.472622)
    """

    solution: Solution
    rigidity: float
    levels: tuple[float, ...]
    areas: tuple[float, ...]
    grades: tuple[Grade, ...] = ()

    @property
    def observed_order(self) -> float | None:
        """By which order in the size of cells the last two estimates fell; None where cells were given."""
        return observed_order(self.grades)

    def __float__(self) -> float:
        return self.rigidity

    def __repr__(self) -> str:
        return f"<Torsion of rigidity {told(self.rigidity, self.grades)}>"

    @property
    def shape(self) -> Shape:
        """The section, with the letters it was twisted for as defaults."""
        return self.solution.shape

    def sampled(
        self, *coordinates: Any, field: str = "value", letters: Mapping[Any, float] | None = None
    ) -> dict[str, Any]:
        """Prandtl's function, or a field of it, at points for pictures: what `Solution.sampled` says."""
        return self.solution.sampled(*coordinates, field=field, letters=letters)

    def stress(self, *coordinates: ArrayLike) -> Any:
        """The shear stresses (..., 2) at points, (u_y, -u_x)."""
        slope = self.solution.gradient(*coordinates)
        return np.stack([slope[..., 1], -slope[..., 0]], axis=-1)

    def greatest_stress(self) -> Attained:
        """The greatest shear stress |grad u| at the points of integration on the boundary, where it is greatest.

        At a corner that points inwards the stress has no bound: what is answered there grows with the cells.
        """
        points = self.solution.rule.boundary.points
        stress = np.linalg.norm(self.solution.jets(points, 1)[1:], axis=0)
        most = int(np.argmax(stress))
        return Attained(float(stress[most]), tuple(float(one) for one in points[most]))

    def with_letters(self, values: Mapping[Any, float]) -> Torsion:
        """The same for other letters, with the same cells and degree: nothing is compiled."""
        report, problem = self.solution.report, self.solution.problem
        assert problem.seams is not None
        other = _problem(problem.seams.relettered(values))
        other = other if problem.corners is None else with_corners(other, problem.corners.degree)
        return _torsion(other, report.cells, report.degree)


def torsion(
    shape: Shape,
    *,
    degree: int = 4,
    cells: int | None = None,
    tolerance: float | None = None,
    letters: Mapping[Any, float] | None = None,
    corners: bool = True,
    estimate: bool = True,
    progress: Progress | None = None,
) -> Torsion:
    """The torsion of a shaft whose section is a shape in the plane.

    Parameters
    ----------
    shape, degree, cells, tolerance, letters, corners, estimate, progress
        As in `solve`; the shape is the section, whose holes are found, the tolerance a share of the rigidity.

    Returns
    -------
    Torsion
        Its ``rigidity`` is also its ``float()``: 0.1406 for the unit square.

    Raises
    ------
    RsymError
        For a shape in space, one of several pieces, a leaf that bounds several holes; as `solve`.

    Source: A. Barre de Saint-Venant (1855); L. Prandtl (1903).

    Examples
    --------
    >>> import rsym
    >>> round(rsym.torsion(rsym.ellipse(2, 1), cells=8).rigidity, 9), round(8 * 3.14159265359 / 5, 9)
    (5.026548246, 5.026548246)
    """
    require_shape(shape)
    checked_degree(degree)
    if shape.dimension != 2:
        raise RsymError("torsion is of a section in the plane", code="dimension", remedy="give a shape of x and y")
    problem = _problem(seamless(shape if letters is None else relettered(shape, letters)).told())
    problem = with_corners(problem, last_degree(degree, cells)) if corners else problem

    def compared(cells: int, degree: int, made: Torsion) -> float:
        lower = on_fewer(lambda fewer: _torsion(problem, fewer, degree - 1), cells)
        return max(slowness(problem) * abs(1 - lower.rigidity / made.rigidity), made.solution.report.unsure)

    if cells is not None:
        made = _torsion(problem, cells, degree)
        error = partial(compared, cells, degree, made)
        grades = graded_alone(cells, degree, made.solution.report.unknowns, error, estimate)
        return replace(made, grades=grades)

    def attempt(cells: int, degree: int) -> tuple[Torsion, int, float]:
        made = _torsion(problem, cells, degree)
        error = compared(cells, degree, made)
        return made, made.solution.report.unknowns, error

    found, grades = refined(attempt, 2, degree, tolerance, progress)
    return replace(found, grades=grades)


def _problem(seams: Seamless) -> Problem:
    """Prandtl's problem, a level for each hole."""
    shape = seams.shape
    outer, inner = _loops(shape)
    if _shared(outer, inner):  # as cells of one height have the leaf of their lids in common
        shape = separated_gates(shape)
        outer, inner = _loops(shape)
    if not outer:
        raise RsymError("the section has nothing inside", code="empty", remedy="change the letters, or the bounds")
    if len(outer) != 1:
        raise RsymError(
            f"the section has {len(outer)} outer boundaries", code="pieces", remedy="give one piece at a time"
        )
    if _shared(outer, inner):
        raise RsymError(
            "one leaf makes up the boundaries of several holes, each of which has a level of its own",
            code="condition",
            remedy="make each hole of a formula of its own: a product that vanishes on both is one leaf",
        )
    equation = equation_of("-laplacian(u) = 2", shape.coordinates)
    # Holes are found again for other letters, names do not tell them.
    made = Problem(shape, equation, {} if inner else {...: dirichlet(0)}, (), levels=tuple(inner), seams=seams)
    level = {leaf for one in inner for leaf in one}
    conditions = tuple(constant() if k in level else dirichlet(0) for k in range(len(made.form.leaves)))
    return replace(made, conditions=conditions)


def _loops(shape: Shape) -> tuple[list[BoundaryLoop], list[tuple[int, ...]]]:
    """The outer boundaries, and the leaves of each hole."""
    loops = loops_of(shape)
    return [loop for loop in loops if not loop.hole], [loop.leaves for loop in loops if loop.hole]


def _shared(outer: Sequence[BoundaryLoop], inner: Sequence[tuple[int, ...]]) -> bool:
    """Whether two of these boundaries have a leaf in common."""
    every = [leaf for one in (*(loop.leaves for loop in outer), *inner) for leaf in one]
    return len({*every}) < len(every)


def _torsion(problem: Problem, cells: int, degree: int) -> Torsion:
    rule = rule_for(problem, cells, rule_order(problem, cells, degree))
    boundary = rule.boundary
    # The outward normals of the section point into its holes: Gauss.
    around = np.sum(boundary.weights[:, None] * boundary.points * boundary.normals, axis=1) / 2
    areas = tuple(float(-np.sum(around[np.isin(boundary.leaves, hole)])) for hole in problem.levels)
    functions = beside_at(problem, rule.points)
    solution = solved(replace(problem, flows=tuple(2 * area for area in areas)), rule, cells, degree, functions)
    levels = tuple(level for _, level in solution.levels)
    held = sum(level * area for level, area in zip(levels, areas, strict=True))
    return Torsion(solution, 2 * (solution.integral(functions) + held), levels, areas)
