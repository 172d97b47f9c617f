"""Conditions that change on an edge: the leaf is two, each with its own weight, and the points between have functions.

In place of a leaf f that a function c cuts stands min(max(f, -c), max(f, c)): the first f bounds where c > 0, the other
where c < 0.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np
import sympy as sp

from rsym.analysis.conditions import BoundaryCondition, Dirichlet, Switched
from rsym.arrays import Floats
from rsym.errors import RsymError
from rsym.logic.sign_form import Gate, SignForm
from rsym.model.shape import Bounds, Shape
from rsym.problems.corners.corners import PlaneCorner, flat_corners
from rsym.problems.meetings import Places
from rsym.problems.pointwise import PointFormulas, compiled
from rsym.program.lowering import lower
from rsym.sampling.extent import bounds_or_extent
from rsym.sampling.rules.division import Grading
from rsym.sampling.rules.quadrature import Quadrature

ASIDE = 1e-6  # of the size of a shape: where is looked which condition holds beside a point
NEAR = 1e-9  # of it: points that are one


class EdgeCut(NamedTuple):
    """A leaf, and the function whose sign tells which of two conditions holds."""

    leaf: int
    where: sp.Expr


def cut_conditions(
    shape: Shape, conditions: Sequence[BoundaryCondition | None], order: int
) -> tuple[tuple[BoundaryCondition | None, ...], tuple[EdgeCut, ...]]:
    """The conditions of all leaves, and after them those outside of each cut; the cuts."""
    inside, outside, cuts = [*conditions], [], []
    for leaf, one in enumerate(conditions):
        if isinstance(one, Switched):
            inside[leaf] = one.inside
            outside.append(one.outside)
            cuts.append(EdgeCut(leaf, one.where))
    if cuts and (shape.dimension != 2 or order != 1):
        raise RsymError(
            "conditions change on edges of shapes in the plane, in equations of the order 2",
            code="condition",
            remedy="make a part of its own of what has another condition",
        )
    return (*inside, *outside), tuple(cuts)


def split_form(form: SignForm, cuts: Sequence[EdgeCut]) -> SignForm:
    """The form with two leaves for each that is cut: the second is after all leaves, the functions after these.

    Examples
    --------
    >>> import rsym
    >>> from rsym.logic.sign_form import shape_form
    >>> form = split_form(shape_form(rsym.disc(1) & rsym.half_plane((0, 1), 0)), [EdgeCut(1, rsym.x)])
    >>> len(form.leaves), form.gates[-1]
    (5, Gate(operation='min', first=0, second=7))
    """
    b, count, extra = form.builder, len(form.leaves), len(cuts)
    functions = [lower(b, cut.where) for cut in cuts]
    leaves = (*form.leaves, *(form.leaves[cut.leaf] for cut in cuts), *functions, *map(b.neg, functions))
    gates: list[Gate] = []
    place: dict[int, int] = {}
    for k, cut in enumerate(cuts):
        first = len(leaves) + len(gates)
        gates.append(Gate("max", cut.leaf, count + 2 * extra + k))
        gates.append(Gate("max", count + k, count + extra + k))
        gates.append(Gate("min", first, first + 1))
        place[cut.leaf] = first + 2

    def moved(number: int) -> int:
        return place.get(number, number) if number < count else number - count + len(leaves) + 3 * extra

    gates += [Gate(gate.operation, moved(gate.first), moved(gate.second)) for gate in form.gates]
    return SignForm(b, leaves, tuple(gates))


@dataclass(frozen=True, eq=False)
class Switches:
    """The cuts of a shape; `form` is its split form, `natural` says of its leaves whether nothing is prescribed."""

    shape: Shape
    form: SignForm
    cuts: tuple[EdgeCut, ...]
    conditions: tuple[BoundaryCondition | None, ...]

    @cached_property
    def points(self) -> tuple[Floats, ...]:
        """Where conditions change, (n, 2) of each cut."""
        return tuple(self._points(k) for k in range(len(self.cuts)))

    def _points(self, k: int) -> Floats:
        pair = (self.cuts[k].leaf,), (len(self.conditions) + k,)
        found = Places(self.shape, self.form, self._box, pair).meeting(0, 1)[0]
        kept: list[Floats] = []
        for point in found:
            if all(np.hypot(*(point - other)) > NEAR * self._size for other in kept):
                kept.append(point)
        return np.array(kept).reshape(-1, 2)

    @cached_property
    def _box(self) -> Bounds:
        return bounds_or_extent(self.shape, None)

    @property
    def _size(self) -> float:
        return float(np.diff(self._box, axis=1).max())

    @cached_property
    def functions(self) -> PointFormulas:
        """Those of the cuts."""
        count = len(self.conditions)
        nodes = self.form.leaves[count : count + len(self.cuts)]
        return compiled(self.shape, self.form.builder, {f"where {k}": node for k, node in enumerate(nodes)})

    def is_natural(self, leaf: int, point: Floats) -> bool:
        """Whether nothing is prescribed on a leaf at a point of it."""
        for k, cut in enumerate(self.cuts):
            if cut.leaf == leaf and self.functions(point[None])[k, 0] < 0:
                leaf = len(self.conditions) - len(self.cuts) + k
                break
        return not isinstance(self.conditions[leaf], Dirichlet)

    def marked(self, corners: Sequence[PlaneCorner]) -> tuple[PlaneCorner, ...]:
        """The corners with what holds on their edges, and those where conditions change; none reaches to another."""
        step = ASIDE * self._size
        own = []
        for corner in corners:
            first, second = np.array(corner.point) + step * corner.edges
            natural = self.is_natural(corner.leaves[0], first), self.is_natural(corner.leaves[1], second)
            own.append(replace(corner, natural=natural))
        places = []
        for k, cut in enumerate(self.cuts):
            for point in self.points[k]:
                (plain,) = flat_corners(self.shape, [(point, cut.leaf, (False, False))])
                first, second = (self.is_natural(cut.leaf, point + step * edge) for edge in plain.edges)
                if first != second:
                    places.append(replace(plain, natural=(first, second)))
        ends = np.concatenate([np.empty((0, 2)), *self.points])
        return tuple(replace(one, reach=min(one.reach, _nearest(one.point, ends))) for one in (*own, *places))

    def graded(self, near: Grading | None) -> Grading:
        """Towards the points where conditions change too: weights have roots there."""
        points, rates = (np.empty((0, 2)), np.empty(0)) if near is None else (near.points, near.exponents)
        more = [one for row in self.points for one in row if not (points == one).all(axis=1).any()]
        return Grading(np.vstack([points, *more]), np.append(rates, np.ones(len(more))))

    def relabelled(self, rule: Quadrature) -> Quadrature:
        """The rule whose points on leaves that are cut know which condition holds."""
        boundary, count, extra = rule.boundary, len(self.conditions), len(self.cuts)
        before = count - extra
        leaves = np.where(boundary.leaves >= before, boundary.leaves + extra, boundary.leaves)
        for k, cut in enumerate(self.cuts):
            on = np.flatnonzero(boundary.leaves == cut.leaf)
            leaves[on[self.functions(boundary.points[on])[k] < 0]] = before + k
        parts = (*rule.parts[:before], *(rule.parts[cut.leaf] for cut in self.cuts), *rule.parts[before:])
        return replace(rule, parts=parts, boundary=replace(boundary, leaves=leaves, parts=parts))


def _nearest(point: Sequence[float], others: Floats) -> float:
    """The distance to the nearest of some points but itself."""
    away = np.hypot(*(others - np.array(point)).T)
    return float(np.min(away[away > 0], initial=np.inf))
