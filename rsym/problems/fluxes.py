"""What flows through parts of the boundary: as is given there, or by what the equation leaves of a function there.

On a part where u is given the normal derivative of an approximation is only as good as its gradient there, and at
corners that has no bound. By Green's formula the flux of k grad u through the part is

    integral of k grad u . grad v + (b . grad u + c u - f) v  less that of k (h - c u) v over where du/dn + c u = h,

v being any function that is 1 on the part and 0 where else u is given: its error is about the square of that of the
gradient. Sources: M. F. Wheeler (1974), I. Babuska and A. Miller (1984).
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from rsym.analysis.conditions import Robin
from rsym.arrays import Flags, Floats, Ints
from rsym.errors import RsymError
from rsym.problems.equations import EllipticEquation
from rsym.problems.problem import VALUED, Problem, on_part, value_at
from rsym.problems.shares import jumps_in, share_of
from rsym.sampling.rules.quadrature import Quadrature

Jets = Callable[[Floats, int], Floats]  # the derivatives of u at points up to an order


def flux_through(problem: Problem, rule: Quadrature, jets: Jets, part: str | None) -> float:
    """The integral of k du/dn over a part, outwards; of all of the boundary without a name."""
    boundary = rule.boundary
    on = np.ones(len(boundary.weights), np.bool_) if part is None else on_part(problem, boundary, part)
    turn = 1.0 if problem.axis < 0 else 2 * np.pi
    if not isinstance(problem.equation, EllipticEquation) or problem.order != 1:
        return turn * _along(problem, rule, jets, on)
    valued = np.isin(boundary.leaves, problem.leaves(*VALUED))
    total = _given(problem, rule, jets, on & ~valued, np.ones(len(on)))
    left = on & valued
    if left.any():
        ends = _endless(problem, boundary.leaves[left])
        if ends:
            return math.inf if min(ends) > 0 else -math.inf if max(ends) < 0 else math.nan
        own = tuple(np.unique(boundary.leaves[left]).tolist())
        whole = left.sum() == np.isin(boundary.leaves, own).sum()  # else another part has some of a leaf
        found = _left(problem, rule, jets, own) if whole and not problem.cuts else None
        total += _along(problem, rule, jets, left) if found is None else found
    return float(turn * total)


def _endless(problem: Problem, leaves: Ints) -> list[float]:
    """By how much values on some leaves are above those on others where they jump: there what flows has no bound."""
    found = []
    for jump in jumps_in(problem):
        first, second = (leaf in leaves for leaf in jump.corner.leaves)
        if first != second:
            found.append((jump.values[1] - jump.values[0]) * (1 if second else -1))
    return found


def _along(problem: Problem, rule: Quadrature, jets: Jets, on: Flags) -> float:
    """By the gradient on the boundary."""
    boundary = rule.boundary
    points = np.ascontiguousarray(boundary.points[on])
    dimension = problem.dimension
    diffusion = problem.coefficients(points)[: dimension * dimension].reshape(dimension, dimension, -1)
    along = np.einsum("ni,ijn,jn->n", boundary.normals[on], diffusion, jets(points, 1)[1:])
    return float(np.sum(boundary.weights[on] * problem.radius(points) * along))


def _given(problem: Problem, rule: Quadrature, jets: Jets, on: Flags, times: Floats) -> float:
    """Where it is given, or nothing flows: k (h - c u), times what a function is at all points of the boundary."""
    boundary, total = rule.boundary, 0.0
    for leaf in problem.leaves(Robin):
        here = on & (boundary.leaves == leaf)
        condition = problem.conditions[leaf]
        if not here.any() or not isinstance(condition, Robin):
            continue
        points = np.ascontiguousarray(boundary.points[here])
        flux, coefficient = (value_at(problem.shape, one, points) for one in (condition.flux, condition.coefficient))
        if np.any(coefficient != 0):
            flux = flux - coefficient * jets(points, 0)[0]
        weights = boundary.weights[here] * problem.radius(points) * times[here]
        total += float(np.sum(weights * problem.coefficients(points)[0] * flux))
    return total


def _left(problem: Problem, rule: Quadrature, jets: Jets, own: tuple[int, ...]) -> float | None:
    """By what the equation leaves of a function that is 1 on some leaves; None where others, with values, meet them."""
    try:
        share = share_of(problem, own)
    except RsymError:
        return None
    points = rule.points
    coefficients = dict(zip(problem.equation.expressions, problem.coefficients(points), strict=True))
    u = jets(points, 1)
    v = np.zeros_like(u)
    v[0] = 1
    at_boundary = np.ones(len(rule.boundary.weights))
    if share is not None:
        v, at_boundary = share(points), share(np.ascontiguousarray(rule.boundary.points))[0]
    density = -coefficients["f"] * v[0]
    for (test, trial), name in problem.equation.places.items():
        density = density + coefficients[name] * v[test] * u[trial]
    inside = float(np.sum(rule.weights * problem.radius(points) * density))
    free = ~np.isin(rule.boundary.leaves, problem.leaves(*VALUED))
    return inside - _given(problem, rule, jets, free, at_boundary)
