"""That an equation is elliptic all over a shape, and not at the points of a rule alone."""

from __future__ import annotations

from itertools import product

import numpy as np
import sympy as sp

from rsym.arrays import Flags, Floats
from rsym.bounds.intervals import IntervalFunction
from rsym.errors import RsymError
from rsym.logic.inside import inside_kernel
from rsym.logic.sign_form import shape_builder
from rsym.model.symbols import symbols_of
from rsym.problems.pointwise import first_place, formulas
from rsym.problems.problem import Problem
from rsym.program.lowering import lower_all
from rsym.sampling.rules.quadrature import Quadrature

DEPTH, MOST = 10, 1 << 14  # halvings of cells, and boxes


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
