"""Of a problem: where its values jump, and functions that are 1 on some leaves and 0 where else u is given."""

from __future__ import annotations

import sympy as sp

from rsym.analysis.conditions import Dirichlet
from rsym.model.recent import recently
from rsym.problems.conditions import Name
from rsym.problems.jumps import ValueJump, jumps_of
from rsym.problems.lifts import lift_on
from rsym.problems.parts import Parts, formula
from rsym.problems.pointwise import PointFormulas
from rsym.problems.problem import VALUED, Problem
from rsym.program.lowering import lower
from rsym.sampling.windows import bounds_or_extent


@recently(16)
def jumps_in(problem: Problem) -> tuple[ValueJump, ...]:
    """The corners where values jump."""
    if not problem.alike or problem.cuts:
        return ()
    own: dict[int, sp.Expr] = {}
    for leaf in problem.leaves(Dirichlet):
        condition = problem.conditions[leaf]
        if isinstance(condition, Dirichlet):
            own[leaf] = formula(condition.value, problem.shape, "the value")[0]
    return jumps_of(_parts(problem, {f"{leaf}": [leaf] for leaf in own}), own)


@recently(16)
def share_of(problem: Problem, own: tuple[int, ...]) -> PointFormulas | None:
    """A function that is 1 on some leaves and 0 on others where u is given, to the first order; None if it is 1.

    Raises
    ------
    RsymError
        Where others meet them, and no function jumps there.
    """
    others = [leaf for leaf in problem.leaves(*VALUED) if leaf not in own]
    if not others:
        return None
    parts = _parts(problem, {"own": [*own], "others": others})
    made = lift_on(parts, {"own": sp.S.One, "others": sp.S.Zero}, {}, problem.alike)
    return problem.with_derivatives(f"share {own}", 1, lambda: {"": lower(problem.form.builder, made.expression)})


def _parts(problem: Problem, named: dict[Name, list[int]]) -> Parts:
    return Parts(problem.shape, named, problem.form, bounds_or_extent(problem.shape, None))
