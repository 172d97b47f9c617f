"""What fixes the level of a solution: values, terms, or a mean where sources and fluxes balance."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np
from scipy import sparse

from rsym.analysis.conditions import Clamped, Dirichlet, Supported
from rsym.arrays import Floats
from rsym.errors import RsymError
from rsym.problems.galerkin import Discretisation
from rsym.problems.pointwise import first_place
from rsym.problems.systems.forms import Some
from rsym.problems.systems.linear import Solved, solve_system
from rsym.sampling.rules.sides import pieces_of

BALANCE = 1e-6  # of all sources and fluxes


def solved_with_mean(discrete: Discretisation, mean: float) -> Solved:
    """The solution of a given mean, where conditions and equation leave constants open, of data that balance."""
    _require_balance(discrete)
    problem, rule = discrete.problem, discrete.rule
    column = sparse.csr_matrix(discrete.loads(discrete.inside, partial(_mean_form, discrete))[0][:, None])
    matrix = sparse.bmat([[discrete.matrix, column], [column.T, None]], format="csr")
    total = mean * float(np.sum(rule.weights * problem.radius(rule.points)))
    found = solve_system(matrix, np.append(discrete.right, total), definite=False, dimension=problem.dimension)
    return replace(found, values=found.values[:-1], again=None)


def _mean_form(discrete: Discretisation, some: Some, points: Floats) -> Floats:
    """Of the integral of v, (n, kinds, 1)."""
    found = np.zeros((len(points), discrete.kinds, 1))
    found[:, 0, 0] = discrete.rule.weights[some] * discrete.problem.radius(points)
    return found


def require_level(discrete: Discretisation) -> None:
    """Refuse a problem whose solutions differ by constants, on all of the shape or on a piece of it.

    With a mean one that leaves no constant open is refused.
    """
    problem, rule = discrete.problem, discrete.rule
    meant = problem.mean is not None
    if problem.equation.order != 2:
        return
    boundary = rule.boundary
    valued = np.isin(boundary.leaves, problem.leaves(Dirichlet, Clamped, Supported))
    held = [boundary.cells[valued], *(part.where.cells for part in discrete.edge_parts if part.holds_level)]
    piece = pieces_of(rule)
    free = np.setdiff1d(piece[rule.touched], piece[np.concatenate(held)])
    if not len(free):
        return _require_open(meant)
    every = problem.equation.expressions
    held_by = {name: every[name] for (_, trial), name in problem.equation.places.items() if trial == 0}
    if any(value.is_number and value != 0 for value in held_by.values()):
        return _require_open(meant)
    values = discrete.coefficients(rule.points) if any(value != 0 for value in held_by.values()) else {}
    for name in held_by:
        if name in values:
            some = np.broadcast_to(values[name] != 0, len(rule.points))
            free = np.setdiff1d(free, piece[rule.cells[some]])
    if not len(free):
        return _require_open(meant)
    if not meant:
        several = len(np.unique(piece[rule.touched])) > 1
        where = first_place(rule.points, piece[rule.cells] == free[0])
        raise RsymError(
            f"nothing fixes the level of the solution on the piece of the shape about {where}"
            if several
            else "nothing fixes the level of the solution: with it every u + constant is one",
            code="singular",
            remedy="give a value on some part, rsym.robin on one, or a term c*u in the equation; where sources and "
            "fluxes balance, mean=0",
        )


def _require_balance(discrete: Discretisation) -> None:
    """Refuse sources and fluxes that do not balance: without values and terms c*u there is no solution."""
    points = discrete.rule.points
    loads = [discrete.load_form(slice(None), points)[:, 0, 0]]
    loads += [part.load[0] for part in discrete.edge_parts if 0 in part.load]
    every = np.concatenate(loads)
    if abs(every.sum()) > BALANCE * np.abs(every).sum():
        raise RsymError(
            f"sources and fluxes do not balance: {every.sum():.6g} is left over, and nothing takes it up",
            code="singular",
            remedy="give data that balance, or a value on some part",
        )


def _require_open(meant: bool) -> None:
    if meant:
        raise RsymError("the solution is fixed, and a mean is asked of it", code="mean", remedy="leave mean= out")
