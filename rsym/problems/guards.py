"""What problems and solutions have to keep: that something fixes the level, an elliptic equation, values within data.

A mean fixes the level where sources and fluxes balance.
"""

from __future__ import annotations

import math
from dataclasses import replace
from functools import partial
from itertools import product

import numpy as np
import sympy as sp
from scipy import sparse

from rsym.analysis.conditions import Clamped, Dirichlet, Robin, Supported
from rsym.arrays import Flags, Floats
from rsym.bounds.intervals import IntervalFunction
from rsym.errors import RsymError
from rsym.logic.inside import inside_kernel
from rsym.logic.sign_form import shape_builder
from rsym.model.symbols import symbols_of
from rsym.problems.corners.corners import surveyed_corners
from rsym.problems.equations import EllipticEquation
from rsym.problems.galerkin import Discretisation
from rsym.problems.places import has_poles
from rsym.problems.pointwise import first_place, formulas
from rsym.problems.problem import VALUED, Problem
from rsym.problems.systems.forms import Some
from rsym.problems.systems.linear import Solved, solve_system
from rsym.program.lowering import lower_all
from rsym.sampling.rules.quadrature import Quadrature
from rsym.sampling.rules.sides import pieces_of

BALANCE = 1e-6  # of all sources and fluxes
DEPTH, MOST = 10, 1 << 14  # halvings of cells, and boxes
BEYOND = 1 + 1e-6  # of an angle: corners are known to rounding
KINKED = (sp.Piecewise, sp.Abs, sp.sign, sp.Heaviside, sp.Max, sp.Min, sp.floor, sp.ceiling)


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


def require_elliptic(problem: Problem, rule: Quadrature) -> None:
    """Refuse coefficients that are not positive definite at a place between the points of a rule, with the place.

    Over the cells that the shape meets bounds of the leading minors are asked, and smaller boxes where they say
    nothing; in these the middle.
    """
    equation, shape = problem.equation, problem.shape
    minors = _minors(equation.diffusion)
    varying = [one for one in minors if {*symbols_of(one)} & {*shape.coordinates}]
    if not varying or {symbol.name for one in varying for symbol in symbols_of(one)} & {*equation.functions}:
        return
    named = {f"{k}": one for k, one in enumerate(varying)}
    builder = shape_builder(shape)
    program = builder.program(dict(zip(named, lower_all(builder, varying), strict=True)))
    bounds, values = IntervalFunction(program, threads=1), formulas(shape, named)
    low, high = (np.ascontiguousarray(end.T) for end in rule.grid.corners(rule.touched))
    letters = shape.letters.values_with(None)
    inside = inside_kernel(shape)
    for _ in range(DEPTH):
        found = bounds(list(low.T), list(high.T), letters)
        least = np.min([np.broadcast_to(one[0], len(low)) for one in found.values()], axis=0)
        left = ~(least > 0)
        low, high = low[left], high[left]
        if not len(low) or len(low) > MOST:
            return
        middle = (low + high) / 2
        with np.errstate(all="ignore"):
            wrong: Flags = np.logical_and((values(middle) <= 0).any(axis=0), inside(*middle.T)["value"] > 0)
        if wrong.any():
            raise RsymError(
                f"the equation is not elliptic at {first_place(middle, wrong)}, between the points of the rule",
                code="not-elliptic",
                remedy="the coefficients of the second derivatives must be positive definite all over the shape",
            )
        low, high = _halves(low, middle, high)


def _minors(a: tuple[tuple[sp.Expr, ...], ...]) -> list[sp.Expr]:
    """The leading minors of the symmetric part."""
    half = sp.Matrix(a)
    even = (half + half.T) / 2
    return [even[:k, :k].det() for k in range(1, len(a) + 1)]


def _halves(low: Floats, middle: Floats, high: Floats) -> tuple[Floats, Floats]:
    parts = np.array(list(product((False, True), repeat=low.shape[1])))
    lower = np.concatenate([np.where(part, middle, low) for part in parts])
    return lower, np.concatenate([np.where(part, high, middle) for part in parts])


def beyond_data(problem: Problem, rule: Quadrature, values: Floats) -> float:
    """By how much of the largest value a solution is above or below all of its data, where it has to lie within.

    That is so without sources, where it is given on parts of the boundary and nothing flows through the others. The
    `values` are those at the points of the rule.
    """
    boundary, equation = rule.boundary, problem.equation
    if (
        not isinstance(equation, EllipticEquation)
        or equation.order != 2
        or not (equation.load == 0 == equation.reaction)
    ):
        return 0.0
    given, valued = problem.leaves(Dirichlet), problem.leaves(*VALUED)
    natural = [problem.conditions[leaf] for leaf in problem.leaves(Robin)]
    if given != valued or any(isinstance(one, Robin) and not (one.flux == 0 == one.coefficient) for one in natural):
        return 0.0
    on = np.isin(boundary.leaves, given)
    if not on.any():
        return 0.0
    lift = problem.lift(0)
    data = np.zeros(1) if lift is None else lift(np.ascontiguousarray(boundary.points[on]))[0]
    largest = max(float(np.abs(values).max()), float(np.abs(data).max()))
    beyond = max(float(values.max() - data.max()), float(data.min() - values.min()), 0.0)
    return beyond / largest if largest else 0.0


def is_bent(problem: Problem) -> bool:
    """Whether a shape may have corners or edges that point inwards, where weights have kinks: it has an "or"."""
    return any(gate.operation == "max" for gate in problem.form.gates)


def inward_edges(problem: Problem) -> bool:
    """Whether a shape in space may have edges that point inwards, where solutions are less smooth."""
    return problem.dimension == 3 and is_bent(problem)


def is_kinked(problem: Problem) -> bool:
    """Whether what is given on the boundary has kinks or jumps, or coefficients more than is known of interfaces.

    Or a source has poles, of which a rule finds no more on cells of the same size.
    """
    given = [value for one in problem.conditions if one is not None for value in one.values]
    every = [value for value in given if isinstance(value, sp.Expr)]
    kinked = any(isinstance(part, KINKED) for value in every for part in sp.preorder_traversal(value))
    return kinked or bool(problem.interfaces.doubts) or has_poles(problem)


def bare_corners(problem: Problem) -> int:
    """How many corners in the plane make solutions rough, and have no functions of their own.

    Of plates, and where an equation diffuses differently in different directions, none has. Rough are those which point
    inwards, and beyond a right angle those with one edge that is held and another that is not; of plates, those where
    not both are clamped.
    """
    if problem.corners is not None:
        return len(problem.corners.left) + len(problem.corners.refused)
    if problem.dimension != 2 or len(problem.form.leaves) < 2:
        return 0
    try:
        corners, refused = surveyed_corners(problem.shape)
    except RsymError:
        return 0
    fast = Clamped if problem.order == 2 else VALUED
    found = len(refused)
    for corner in corners:
        held = {isinstance(problem.conditions[leaf], fast) for leaf in corner.leaves}
        alike = held == {True} or (held == {False} and problem.order == 1)
        found += corner.angle > BEYOND * (math.pi if alike else math.pi / 2)
    return found


def is_slow(problem: Problem) -> bool:
    """Whether errors fall as cells do, or little faster: for data with kinks, at corners that have no functions."""
    return is_kinked(problem) or bare_corners(problem) > 0
