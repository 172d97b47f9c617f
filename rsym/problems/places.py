"""Where fields on shapes are known: the rule of a shape, and which points belong to it."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection
from contextlib import suppress
from dataclasses import replace

import numpy as np
import sympy as sp
from numpy.typing import ArrayLike

from rsym.arrays import Flags, Floats
from rsym.backends.kernel import compile, real_arrays
from rsym.errors import RsymError, warn
from rsym.model.shape import Shape
from rsym.problems.conditions import Name, assigned
from rsym.problems.corners.choice import ON_AXIS
from rsym.problems.problem import Problem, vanished
from rsym.problems.sources import poles_in
from rsym.problems.splines.web import WebSplines
from rsym.sampling.extent import extent
from rsym.sampling.rules.division import Grading
from rsym.sampling.rules.gaps import Gap, thin_gap
from rsym.sampling.rules.portions import CellGrid
from rsym.sampling.rules.quadrature import Quadrature, prepared
from rsym.sampling.rules.sides import closed_sides

# Of the size of the shape: points of the boundary are known to rounding.
ON_BOUNDARY = 1e-12
SURE = 1e-3  # of the width of a gap
# The rule has so many points more than the degree along each direction of a cell.
MORE_POINTS = 4
# And so many on few cells of a smooth shape in the plane: an answer that is a weight times a spline has a hundred to
# ten thousand times smaller an error then, of the rule alone (disc and ellipse on 6 cells of degree 4: 1e-9 to 1e-12),
# for a twelfth of the time more. With functions at corners it were a third more, and nothing is gained there.
MORE_ON_FEW, FEW_CELLS = 6, 8


def rule_order(problem: Problem, cells: int, degree: int) -> int:
    """How many points a rule has along each direction of a cell."""
    plain = problem.dimension == 2 and not problem.has_corners
    return degree + (MORE_ON_FEW if plain and cells <= FEW_CELLS else MORE_POINTS)


def has_poles(problem: Problem) -> bool:
    """Whether a source has no bound inside."""
    equation = problem.equation
    sources = [equation.expressions[name] for name in equation.load_places.values()]
    return any(poles_in(problem.shape, one, (*equation.functions,)) for one in sources)


def rule_for(problem: Problem, cells: int, order: int) -> Quadrature:
    """The rule of integration of a problem, graded towards corners that have functions of their own.

    Beside sources with poles the order is even: the middle of a cell, where a pole may be, is no point then.
    """
    order += order % 2 if has_poles(problem) else 0
    near = None if problem.corners is None else problem.corners.functions.grading
    if problem.cuts:
        near = problem.switches.graded(near)
    rule = rule_on(problem.shape, problem.named, cells, order, near, problem.interfaces.functions)
    if problem.cuts:
        problem.switches.require_apart(rule.grid.size, cells)
        rule = problem.switches.relabelled(rule)
    if problem.axis >= 0:
        across = rule.points[:, 1 - problem.axis]
        least, most = float(across.min()), float(across.max())
        if min(-least, most) > ON_AXIS * max(-least, most):
            raise RsymError(
                f"the shape is on both sides of the axis, from {least:.4g} to {most:.4g}",
                code="axis",
                remedy="give half of the section: shape & rsym.half_plane"
                f"({(1, 0) if problem.axis else (0, 1)}, 0) for axis={problem.shape.coordinates[problem.axis]}",
            )
    return rule


def rule_on(
    shape: Shape,
    names: Collection[Name],
    cells: int,
    order: int,
    near: Grading | None = None,
    folds: tuple[sp.Expr, ...] = (),
) -> Quadrature:
    """The rule of a problem with conditions on parts of these names, its cells graded towards some points.

    folds : functions where which are zero data have kinks.
    """
    box, given = None, shape.bounds
    with suppress(RsymError):
        found = extent(shape)
        # Bounds with room beside the shape would be cells without it.
        inside = given is None or all(a <= c and d <= b for (a, b), (c, d) in zip(given, found, strict=True))
        box = found if inside else given
    made = prepared(shape, box, None)
    rule = (prepared(shape, box, None, folds) if folds else made).rule(cells, order, near)
    if not len(rule.points):
        raise RsymError(
            "the shape has nothing inside", code="empty", remedy="change the letters, or the bounds, so that it has"
        )
    on_leaves = assigned(shape, list(names))
    met = np.unique(rule.boundary.leaves)
    sides = [rule.parts[leaf].removeprefix("cap ") for leaf in met if leaf >= len(on_leaves)]
    if sides and box is not None:
        raise RsymError(
            f"the shape's own bounds cut it, and no condition holds there: {', '.join(sides)}",
            code="bounds",
            remedy="shape.replace(bounds=rsym.extent(shape)), or cut it by a shape with a name",
        )
    there = {on_leaves[leaf] for leaf in met if leaf < len(on_leaves)}
    for name in names:
        if isinstance(name, str) and name not in there:
            raise vanished(name)
    _require_no_gap(thin_gap(made.functions, rule), rule.grid, cells)
    return replace(rule, closed=closed_sides(made.functions, rule))


def _require_no_gap(gap: Gap | None, grid: CellGrid, cells: int) -> None:
    """Refuse cells that do not resolve a gap; warn of a contact."""
    if gap is None:
        return
    place = ", ".join(f"{round(value / grid.size, 3) * grid.size + 0.0:.4g}" for value in gap.point)
    sides = f"'{gap.parts[0]}' and '{gap.parts[1]}'" if len(set(gap.parts)) == 2 else f"places of '{gap.parts[0]}'"
    if gap.width == 0:
        warn(
            f"the shape touches itself at ({place}), between {sides}, within a cell: splines tie both sides "
            "together, and what is found within a few cells is wrong; remedy: take the sides as shapes by themselves"
        )
        return
    enough = max(cells + 1, math.ceil(cells * grid.size / gap.side * (1 - SURE)))
    thinner = "thinner than the cells" if gap.width < grid.size else "within single cells, askew"
    raise RsymError(
        f"a gap {gap.width:.4g} wide at ({place}), between {sides}, is {thinner}, of {grid.size:.4g}: "
        "splines would tie together what it keeps apart",
        code="cells",
        remedy=f"ask for {enough} cells or more, or take the sides as shapes by themselves",
    )


def inside(shape: Shape, splines: WebSplines, points: Floats) -> Flags:
    """Which points (n, dimension) belong to a shape, those of the boundary to rounding."""
    kernel = compile(shape, ("value", "gradient"), at_corners="one-sided")
    found = kernel(*points.T)
    size = float(np.max(splines.size * splines.counts))
    with np.errstate(all="ignore"):
        near = found["value"] >= -ON_BOUNDARY * size * np.linalg.norm(found["gradient"], axis=-1)
    there: Flags = ((found["value"] >= 0) | near) & (splines.cell_of(points) >= 0)
    return there


def on_shape(
    shape: Shape, splines: WebSplines, coordinates: tuple[ArrayLike, ...], field: Callable[[Floats], Floats]
) -> Floats:
    """Functions (m, n) of points (n, dimension) where coordinates, which broadcast, say: (m, ...), NaN outside."""
    if len(coordinates) != shape.dimension:
        raise RsymError(
            f"a field on this shape takes {shape.dimension} coordinates, got {len(coordinates)}", code="arity"
        )
    arrays = real_arrays(coordinates)
    points = np.stack([array.ravel() for array in arrays], axis=1).astype(np.float64, copy=False)
    there = inside(shape, splines, points)
    values = field(points[there])
    found = np.full((len(values), len(points)), np.nan)
    found[:, there] = values
    return found.reshape(len(values), *arrays[0].shape)
