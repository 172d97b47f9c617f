"""Conditions that change on an edge: the leaf is two, each with its own weight, and the points between have functions.

In place of a leaf f that a function c cuts stands min(max(f, -c), max(f, c)): the first f bounds where c > 0, the other
where c < 0.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np
import sympy as sp
from scipy.spatial import cKDTree

from rsym.analysis.conditions import BoundaryCondition, Dirichlet, Switched
from rsym.arrays import Flags, Floats
from rsym.backends.kernel import Kernel
from rsym.backends.kernel import compile as compile_shape
from rsym.errors import RsymError, warn
from rsym.logic.gates import Gate
from rsym.logic.sign_form import SignForm
from rsym.model.shape import Bounds, Shape
from rsym.problems.corners.corners import PlaneCorner, flat_corners
from rsym.problems.even_switches import evened, evened_between, unexplained
from rsym.problems.meetings import Places
from rsym.problems.pointwise import PointFormulas, compiled
from rsym.program.lowering import lower
from rsym.sampling.active_leaves import active_leaf
from rsym.sampling.rules.division import Grading
from rsym.sampling.rules.quadrature import Quadrature, prepared
from rsym.sampling.windows import bounds_or_extent

ASIDE = 1e-6  # of the size of a shape: where is looked which condition holds beside a point
NEAR = 1e-9  # of it: points that are one
MOST_POINTS = 64  # between conditions on one leaf: more are those of a function that is 0 along it
FLAT = 1e-6  # of usual slopes
ON_EDGE = 1e-2  # of a step along an edge: how far from it is on it
APART, SURE = 2.0, 5.0  # cells from one place where conditions change to the next
COARSE = 32  # cells of a rule that tells which conditions hold on an edge
HALVINGS, JUMP, STEPS = 40, 1e-3, 65


class EdgeCut(NamedTuple):
    """A leaf, the function whose sign tells which of two conditions holds, and the points (n, 2) where it is 0.

    crosses : whether it changes its sign on the edge at one of them, and not at its ends alone.
    changes : at which of them it changes its sign along the leaf, which has there these `tangents` (n, 2).
    """

    leaf: int
    where: sp.Expr
    points: Floats = np.empty((0, 2))
    crosses: bool = True
    changes: Flags = np.empty(0, np.bool_)
    tangents: Floats = np.empty((0, 2))


def placed_conditions(
    shape: Shape, form: SignForm, conditions: Sequence[BoundaryCondition | None], order: int
) -> tuple[tuple[BoundaryCondition | None, ...], tuple[EdgeCut, ...]]:
    """As `cut_conditions`, cuts `located` and even; a leaf on which nothing changes has the condition that holds on it.

    Raises
    ------
    RsymError
        For a function that jumps from one sign to the other on an edge, too, or is steep there and flat elsewhere.
    """
    every, cuts = cut_conditions(shape, conditions, order)
    if not cuts:
        return every, ()
    cuts, own, evener = located(shape, form, cuts), [*conditions], []
    box = bounds_or_extent(shape, None)
    boundary = prepared(shape, box, None).rule(COARSE, 2).boundary
    for k, cut in enumerate(cuts):
        points = boundary.points[boundary.leaves == cut.leaf]
        if not len(points):
            evener.append(cut)
            continue
        kernel = compile_shape(shape.replace(expression=cut.where), backend="numpy")
        values = kernel(*points.T)["value"]
        if cut.crosses:
            evener.append(_even(shape, form, cut, values, points))
        elif (values > 0).all() or not (values > 0).any():
            own[cut.leaf] = every[cut.leaf] if (values > 0).all() else every[len(conditions) + k]
            evener.append(cut)
        else:
            way = _require_zero(kernel, points, values > 0)
            _require_explained(shape, cut, values, points)
            along = kernel(*np.linspace(*way, STEPS).T)["value"]
            evener.append(cut._replace(where=evened_between(shape, cut.where, values, points, way, along)))
    every, left = cut_conditions(shape, own, order)
    return every, tuple(cut for cut in evener if any(cut.leaf == one.leaf for one in left))


def _even(shape: Shape, form: SignForm, cut: EdgeCut, values: Floats, edge: Floats) -> EdgeCut:
    """A cut with an even function, all of whose changes, between points of an edge, are known."""
    _require_explained(shape, cut, values, edge)
    size, some = float(np.diff(bounds_or_extent(shape, None), axis=1).max()), cut.changes
    even = evened(shape, cut.where, values, edge, cut.points[some], cut.tangents[some], size)
    return cut if even is cut.where else located(shape, form, [EdgeCut(cut.leaf, even)])[0]


def _require_explained(shape: Shape, cut: EdgeCut, values: Floats, edge: Floats) -> None:
    """Refuse a function that changes its sign between points of an edge where no zero of it was found."""
    size = float(np.diff(bounds_or_extent(shape, None), axis=1).max())
    if (place := unexplained(values, edge, cut.points[cut.changes], size / COARSE)) is not None:
        told = ", ".join(f"{value:.6g}" for value in place)
        raise RsymError(
            f"what tells where conditions change has another sign beside ({told}), and no zero between is found",
            code="condition",
            remedy="give a function of that sign that is neither flat nor steep: x instead of x**3 or tanh(10**4*x)",
        )


def _require_zero(kernel: Kernel, points: Floats, within: Flags) -> tuple[Floats, Floats]:
    """Refuse a function that has no zero between the points, next to each other, at which its signs differ; these."""

    def where(point: Floats) -> float:
        return float(kernel(*point)["value"])

    away, nearest = cKDTree(points[~within]).query(points[within])
    first = int(np.argmin(away))
    one, other = way = points[within][first], points[~within][nearest[first]]
    ends = abs(where(one) - where(other))
    for _ in range(HALVINGS):
        middle = (one + other) / 2
        one, other = (middle, other) if where(middle) > 0 else (one, middle)
    if abs(where(one) - where(other)) > JUMP * ends:
        place = ", ".join(f"{value:.6g}" for value in one)
        raise RsymError(
            f"what tells where conditions change jumps at ({place})",
            code="condition",
            remedy="give a shape whose boundary crosses the edge: x instead of sign(x)",
        )
    return way


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


def located(shape: Shape, form: SignForm, cuts: Sequence[EdgeCut]) -> tuple[EdgeCut, ...]:
    """The cuts with their points, their functions times powers of 2: along edges they grow as leaves do across.

    Of others the weights of both leaves are as good as 0, or have large derivatives, about all of the points.

    Raises
    ------
    RsymError
        For a function that is 0 along an edge, or changes its sign on it without a slope.

    Examples
    --------
    >>> import rsym
    >>> from rsym.logic.sign_form import shape_form
    >>> (cut,) = located(rsym.disc(1), shape_form(rsym.disc(1)), [EdgeCut(0, 1000 * rsym.x)])
    >>> cut.where, sorted(cut.points.round(9).tolist())
    (125*x/128, [[0.0, -1.0], [0.0, 1.0]])
    """
    if not cuts:
        return ()
    split, first, box = split_form(form, cuts), len(form.leaves) + len(cuts), bounds_or_extent(shape, None)
    size, found = float(np.diff(box, axis=1).max()), []
    for k, cut in enumerate(cuts):
        places = Places(shape, split, box, ((cut.leaf,), (first + k,)))
        points = _distinct(places.meeting(0, 1)[0], NEAR * size)
        slopes = places.at(points)[1]
        across, where = slopes[cut.leaf], slopes[first + k]
        steep = np.linalg.norm(across, axis=1)
        tangents = np.stack([-across[:, 1], across[:, 0]], axis=1) / steep[:, None]
        growth = np.abs(np.sum(where * tangents, axis=1)) / steep
        flat = growth <= FLAT * _usual(np.linalg.norm(places.at(_lattice(box))[1][first + k], axis=1)) / steep
        ways = ASIDE * size * tangents
        before, behind = (places.at(points + way)[0][first + k] for way in (-ways, ways))
        changes = np.sign(before) != np.sign(behind)
        wrong = flat & changes
        if len(points) > MOST_POINTS or wrong.any():
            place = ", ".join(f"{value:.6g}" for value in points[int(np.argmax(wrong))])
            raise RsymError(
                f"what tells where conditions change has no slope along the edge at ({place})",
                code="condition",
                remedy="give a shape whose boundary crosses the edge: x instead of x**3; a corner needs no switch",
            )
        power = -round(math.log2(float(np.median(growth[~flat])))) if not flat.all() else 0
        own = [active_leaf(form.gates, [*places.at(points + way)[0][: len(form.leaves)]])[0] for way in (-ways, ways)]
        on_edge = np.all(np.abs(own) <= ON_EDGE * ASIDE * size * steep, axis=0)
        crosses = bool(np.any(changes & on_edge))
        found.append(EdgeCut(cut.leaf, cut.where * sp.Integer(2) ** power, points, crosses, changes, tangents))
    return tuple(found)


def _distinct(points: Floats, near: float) -> Floats:
    """Each of some points once."""
    kept: list[Floats] = []
    for point in points:
        if all(np.hypot(*(point - other)) > near for other in kept):
            kept.append(point)
            if len(kept) > MOST_POINTS:
                break
    return np.array(kept).reshape(-1, 2)


def _lattice(box: Bounds) -> Floats:
    """Some points (n, 2) of a box."""
    axes = np.meshgrid(*(np.linspace(low, high, 7)[1:-1] for low, high in box))
    return np.stack([axis.ravel() for axis in axes], axis=1)


def _usual(sizes: Floats) -> float:
    """The median of those that are numbers; 0 of none."""
    known = sizes[np.isfinite(sizes)]
    return float(np.median(known)) if len(known) else 0.0


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
        for cut in self.cuts:
            for point in cut.points:
                (plain,) = flat_corners(self.shape, [(point, cut.leaf, (False, False))])
                first, second = (self.is_natural(cut.leaf, point + step * edge) for edge in plain.edges)
                if first != second:
                    places.append(replace(plain, natural=(first, second)))
        ends = np.concatenate([np.empty((0, 2)), *(cut.points for cut in self.cuts)])
        return tuple(replace(one, reach=min(one.reach, _nearest(one.point, ends))) for one in (*own, *places))

    def require_apart(self, size: float, cells: int) -> None:
        """Refuse cells of a size that do not resolve how near to each other conditions change.

        Of a strip on which u is 0 between two fluxes errors are 40 and 15 parts of a hundred where it is half a cell
        and a cell wide, 6 to 1 at two cells, 1 to 0.1 at three to five; with some twenty such places on one edge they
        are 6 at five.
        """
        if self.least_apart < APART * size:
            raise RsymError(
                self._near(size),
                code="cells",
                remedy=f"ask for {math.ceil(cells * APART * size / self.least_apart)} cells at least; "
                f"{math.ceil(cells * SURE * size / self.least_apart)} are enough",
            )

    def warn_if_near(self, size: float, cells: int) -> None:
        """Warn of cells that hardly resolve it."""
        if self.least_apart < SURE * size:
            enough = math.ceil(cells * SURE * size / self.least_apart)
            warn(f"{self._near(size)}: errors may be some parts of a hundred there; remedy: {enough} cells")

    def _near(self, size: float) -> str:
        points, away = self._apart
        place = ", ".join(f"{value:.4g}" for value in points[int(np.argmin(away))])
        return f"conditions change at ({place}) and {self.least_apart:.4g} from there, with cells of {size:.4g}"

    @property
    def least_apart(self) -> float:
        """How near to each other conditions change."""
        return float(np.min(self._apart[1], initial=np.inf))

    @cached_property
    def _apart(self) -> tuple[Floats, Floats]:
        """Where conditions change, and how far the next such place is from each."""
        points = np.concatenate([np.empty((0, 2)), *(cut.points[cut.changes] for cut in self.cuts)])
        return points, np.array([_nearest(point, points, NEAR * self._size) for point in points])

    def graded(self, near: Grading | None) -> Grading:
        """Towards the points where conditions change too: weights have roots there."""
        points, rates = (np.empty((0, 2)), np.empty(0)) if near is None else (near.points, near.exponents)
        more = [one for cut in self.cuts for one in cut.points if not (points == one).all(axis=1).any()]
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


def _nearest(point: Sequence[float], others: Floats, same: float = 0.0) -> float:
    """The distance to the nearest of some points but itself, and those that are as good as the same."""
    away = np.hypot(*(others - np.array(point)).T)
    return float(np.min(away[away > same], initial=np.inf))
