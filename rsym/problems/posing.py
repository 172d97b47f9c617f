"""Conditions on the leaves of a problem as the letters of its shape have it: what lies on an axis, which holes are."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from rsym.analysis.conditions import BoundaryCondition, Switched, UnknownLevel, neumann
from rsym.arrays import Floats
from rsym.errors import RsymError
from rsym.logic.leaf_names import shape_leaf_names
from rsym.model.arguments import default
from rsym.model.wording import listing
from rsym.problems.conditions import assigned, resolved
from rsym.problems.cornered import with_corners
from rsym.problems.corners.choice import ON_AXIS
from rsym.problems.given_functions import as_formulas
from rsym.problems.interfaces import interfaces_of
from rsym.problems.loops import holes
from rsym.problems.pointwise import compiled
from rsym.problems.problem import VALUED, Problem
from rsym.problems.sources import require_integrable
from rsym.problems.switches import placed_conditions
from rsym.program.lowering import lower
from rsym.sampling.windows import relettered

# Places along an axis, in shares of the size of a shape.
PLACES = np.array([-0.83, -0.41, -0.07, 0.0, 0.23, 0.57, 0.91])


def posed(problem: Problem) -> Problem:
    """The problem with the conditions of its leaves, of its shape's letters; without functions of corners."""
    given = problem.named if problem.given is None else problem.given
    named, off = as_formulas(problem.shape, given)
    problem = replace(problem, named=named, given=given, off=off)
    equation = problem.equation
    for source in (equation.expressions[name] for name in equation.load_places.values()):
        if source.free_symbols:
            require_integrable(problem.shape, source, "the right side", equation.functions)
    conditions = _with_divided(problem)
    on_axis = _on_axis(problem)
    names = assigned(problem.shape, problem.named) if on_axis else ()
    for leaf in on_axis:
        condition = conditions[leaf]
        both = (condition.inside, condition.outside) if isinstance(condition, Switched) else (condition,)
        if not any(isinstance(one, VALUED) for one in both):
            continue
        called = shape_leaf_names(problem.shape)[leaf]
        if not _flat(problem, leaf):
            raise RsymError(
                f"{called} lies on the axis and goes on elsewhere, with one condition",
                code="axis",
                remedy="cut the shape at the axis by an rsym.half_plane of its own",
            )
        if names[leaf] is not ... and names.count(names[leaf]) == 1:
            raise RsymError(
                f"{called} lies on the axis, where no value of u can be held",
                code="axis",
                remedy="leave the condition out: nothing flows there",
            )
        conditions[leaf] = None
    unknown = [leaf for leaf, one in enumerate(conditions) if isinstance(one, UnknownLevel)]
    every, cuts = placed_conditions(problem.shape, problem.form, conditions, problem.order)
    levels = holes(problem.shape, unknown, on_axis)
    flows = tuple(_flow(problem, [conditions[leaf] for leaf in hole]) for hole in levels)
    made = replace(problem, conditions=every, levels=levels, flows=flows, corners=None, cuts=cuts)
    return replace(made, interfaces=interfaces_of(made.shape, [*made.equation.expressions.values()], made.order))


def _with_divided(problem: Problem) -> list[BoundaryCondition | None]:
    """The conditions of leaves; on those that belong to two parts of which other things are said, those of both."""
    divided = () if problem.seams is None else problem.seams.divided
    conditions = list(resolved(problem.shape, problem.named, [one.leaf for one in divided]))
    for one in divided:
        leaf = problem.form.leaves.index(lower(problem.form.builder, one.leaf))
        named = [next((name for name in names if name in problem.named), ...) for names in (one.inside, one.outside)]
        inside, outside = (problem.named.get(name) for name in named)
        both = Switched(one.where, inside or neumann(), outside or neumann())
        conditions[leaf] = inside if inside == outside else both
    return conditions


def _flow(problem: Problem, conditions: Sequence[BoundaryCondition | None]) -> float:
    """What flows through the leaves of a hole; about an axis without 2 pi, as integrals are there."""
    flows = {one.flow for one in conditions if isinstance(one, UnknownLevel)}
    if len(flows) > 1:
        raise RsymError(
            f"parts of one closed curve have the flows {listing(map(str, flows))}: it has one",
            code="condition",
            remedy="say the same of all of its parts",
        )
    return default(flows.pop(), problem.shape.letters) / (1.0 if problem.axis < 0 else 2 * np.pi)


def posed_again(problem: Problem, values: Mapping[Any, float]) -> Problem:
    """The same problem for other letters: which leaves make up holes is found again."""
    seams = None if problem.seams is None else problem.seams.relettered(values)
    shape = relettered(problem.shape, values) if seams is None else seams.shape
    other = posed(replace(problem, shape=shape, seams=seams))
    return other if problem.corners is None else with_corners(other, problem.corners.degree)


def _leaf_values(problem: Problem, points: Floats) -> Floats:
    """The values (leaves, n) of the leaves."""
    leaves = {f"leaf {k}": node for k, node in enumerate(problem.form.leaves)}
    return compiled(problem.shape, problem.form.builder, leaves)(points)


def _on_axis(problem: Problem) -> list[int]:
    """The leaves that vanish all along the axis that a shape is turned about."""
    if problem.axis < 0:
        return []
    points = np.zeros((len(PLACES), 2))
    points[:, problem.axis] = PLACES
    with np.errstate(all="ignore"):
        there = np.all(np.abs(_leaf_values(problem, points)) <= ON_AXIS**2, axis=1)
    return [int(leaf) for leaf in np.flatnonzero(there)]


def _flat(problem: Problem, leaf: int) -> bool:
    """Whether a leaf depends on the distance from the axis alone, and vanishes nowhere else: it grows all the way."""
    radii = np.linspace(-2, 2, 9)
    across = np.zeros((2, len(radii), 2))
    across[:, :, 1 - problem.axis] = radii
    across[1, :, problem.axis] = PLACES[1]
    one, other = _leaf_values(problem, across.reshape(-1, 2))[leaf].reshape(2, -1)
    return bool(np.array_equal(one, other) and (np.all(np.diff(one) > 0) or np.all(np.diff(one) < 0)))
