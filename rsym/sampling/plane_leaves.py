"""The leaves of a sign form in a plane: which one is the boundary where, and where two of them meet."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from rsym.arrays import Flags, Floats, Ints
from rsym.backends.kernel import Kernel, compile_program, run_in_blocks
from rsym.backends.registry import ready_backend
from rsym.bounds.intervals import IntervalFunction
from rsym.logic.gates import through
from rsym.logic.lifting import unfolded
from rsym.logic.sign_form import SignForm, has_kinks, shape_form, sign_form
from rsym.model.recent import recently, written
from rsym.model.shape import Bounds, Shape
from rsym.model.symbols import real_symbol
from rsym.program.differentiation import derivative
from rsym.program.lowering import lower
from rsym.sampling.active_leaves import active_leaf, ends_last
from rsym.sampling.contours import ON_LEVEL
from rsym.sampling.form_signs import Signs, joined_signs, signs_between
from rsym.sampling.plane import large_form
from rsym.sampling.roots import repeated

NEWTON_STEPS = 12
# The tip of a wedge of four degrees sticks out of the cells whose edges it crosses by this many.
REACH = 16.0
LEVEL = "the level"  # a letter; none of a user has a space in its name
# Where a leaf is asked whether it is zero all over a plane, as shares of the sides of the bounds.
PLACES = np.stack(np.meshgrid([0.19, 0.43, 0.71], [0.23, 0.47, 0.83]), axis=-1).reshape(-1, 2)


@dataclass(frozen=True)
class PlaneLeaves:
    """The leaves of a sign form, as functions of two free coordinates.

    `flat` are leaves that are zero all over the plane: the plane runs along a face of theirs.
    Zero counts as inside, so they are left out of what bounds the section.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y, z
    >>> leaves = leaves_of(rsym.Shape(rsym.conjunction(x, y, 1 - z), (x, y, z)), (0, 1), {2: 0.0})
    >>> leaves.active(np.array([[3.0, 2.0]]))
    (array([1.]), array([2]))
    >>> list(leaves.of(np.array([[3.0, 2.0]]), np.array([1])))
    [(array([2.]), array([[0., 1.]]))]
    """

    form: SignForm
    shape: Shape
    free: tuple[int, int]
    fixed: Mapping[int, float]
    letters: Mapping[Any, float] | None
    bounds: Bounds | None = None
    flat: tuple[int, ...] = ()

    @property
    def count(self) -> int:
        """How many leaves there are."""
        return len(self.form.leaves)

    @property
    def operations(self) -> int:
        """How many operations the bounds of all leaves over a box take; of a large form some of them."""
        return 100 if self._large is not None else len(_leaf_bounds(self.form).program.nodes)

    def at(self, fixed: Mapping[int, float]) -> PlaneLeaves:
        """The same in another plane. A leaf that is zero at some places within the bounds is zero all over it."""
        plane = replace(self, fixed=fixed, flat=())
        if self.bounds is None:
            return plane
        low, high = np.array(self.bounds, float).T
        points = low + PLACES * (high - low)
        if plane._large is None:
            values = plane._every(points)[0][: self.count]
        else:
            every = np.repeat(np.arange(self.count), len(points))
            ((values, _),) = plane.of(np.tile(points, (self.count, 1)), every)
        zero = (values.reshape(self.count, -1) == 0).all(axis=1)
        return replace(plane, flat=tuple(np.flatnonzero(zero).tolist()))

    def active(self, points: Floats) -> tuple[Floats, Ints]:
        """The value of the form at points (n, 2), and the number of the leaf that gives it."""
        if self._large is not None:
            value, leaf = self._large.value(points)
            return value, leaf.astype(np.int64)
        return active_leaf(self.form.gates, self._every(points)[0][: self.count])

    def signs_over(self, low: Floats, high: Floats) -> Signs:
        """The sign that the form has all over boxes with corners (n, 2): 1 or -1, 0 where that is not known."""
        if self._large is not None:
            signs: Signs = self._large.signs_over(self._ends(low, high))
            return signs
        return self._signs_over(low, high)[-1]

    def slopes_over(self, low: Floats, high: Floats) -> Signs:
        """Along both coordinates (n, 2) the sign of the slope of the only leaf that matters in a box.

        0 where that sign is not known, or several leaves matter.
        """
        box, leaf = self._mattering(low, high)
        own = np.flatnonzero((np.bincount(box, minlength=len(low)) == 1)[box])
        one, slopes = box[own], np.zeros((len(low), 2), np.int8)
        slopes[one] = np.array([signs_between(*ends) for ends in self._slopes(low[one], high[one], leaf[own])]).T
        return slopes

    def crossing_over(self, low: Floats, high: Floats) -> tuple[Ints, Ints]:
        """The two leaves that alone matter in a box, if they cross there at one point at most; else -1."""
        box, leaf = self._mattering(low, high)
        count, real = len(self._zeros), ~np.isin(leaf, self.form.folds)
        box, leaf = box[real], leaf[real]
        box, leaf = np.divmod(np.unique(box * count + self._zeros[leaf]), count)
        both = np.flatnonzero(np.bincount(box, minlength=len(low)) == 2)
        first = np.searchsorted(box, both)
        pair = np.array([leaf[first], leaf[first + 1]]) if len(both) else np.empty((2, 0), np.int64)
        (a, b), (c, d) = (self._slopes(low[both], high[both], own) for own in pair)  # (2, n) each
        with np.errstate(all="ignore"):
            one, other = (_products(*factors) for factors in ((a, d), (b, c)))
            turns = (one[0] > other[1]) | (one[1] < other[0])
        turns |= np.isin(pair, self.walls).any(axis=0)  # where a line ends, upright perhaps
        found = np.full((2, len(low)), -1)
        found[:, both[turns]] = pair[:, turns]
        return found[0], found[1]

    def meet(self, points: Floats, one: Ints, other: Ints, cell: float) -> Flags:
        """Whether both leaves are zero at each point: Newton's method ends somewhere where they are nowhere."""
        one, other = self._at_walls(one, other), self._at_walls(other, one)
        with np.errstate(all="ignore"):
            cells = [np.abs(f) / np.linalg.norm(slope, axis=1) / cell for f, slope in self.of(points, one, other)]
        return np.asarray(np.maximum(*cells) <= ON_LEVEL)

    def _mattering(self, low: Floats, high: Floats) -> tuple[Ints, Ints]:
        """The leaves that the sign of the form may hang on in boxes: the number of a box, and of a leaf."""
        if self._large is not None:
            found: tuple[Ints, Ints] = self._large.mattering(self._ends(low, high))
            return found
        signs = self._signs_over(low, high)
        matters = [np.zeros(len(low), np.bool_) for _ in signs]
        matters[-1] = signs[-1] == 0
        for number, gate in reversed(list(enumerate(self.form.gates, self.count))):
            for part in (gate.first, gate.second):
                matters[part] |= matters[number] & (signs[part] == 0)
        box, leaf = np.nonzero(np.array(matters[: self.count]).T)
        return box, leaf

    def _signs_over(self, low: Floats, high: Floats) -> list[Signs]:
        """Of the leaves and the gates."""
        bounds = self._bounded(_leaf_bounds(self.form), low, high)
        # What is 0 all over is inside.
        signs = [np.where((lower == 0) & (upper == 0), 1, signs_between(lower, upper)) for lower, upper in bounds]
        for number in self.flat:
            signs[number] = np.ones_like(signs[number])
        return through(self.form.gates, signs, joined_signs)

    def _slopes(self, low: Floats, high: Floats, leaf: Ints) -> tuple[Floats, Floats]:
        """Along each coordinate the ends (2, n) of the slope of the leaf of each box."""
        if self._large is not None:
            ends: tuple[Floats, Floats] = self._large.slopes(self._ends(low, high), leaf)
            return ends
        every = np.array(self._bounded(_slope_bounds(self.form, self.free), low, high))
        first, second = every.reshape(2, self.count, 2, -1)[:, leaf, :, np.arange(len(low))].transpose(1, 2, 0)
        return first, second

    def _bounded(self, function: IntervalFunction, low: Floats, high: Floats) -> list[tuple[Floats, Floats]]:
        lower, upper = self._ends(low, high)
        return list(function(lower, upper, self._numbers).values())

    def _ends(self, low: Floats, high: Floats) -> Floats:
        """Boxes of the plane in the coordinates of the shape, lower and upper ends (2, dim, n)."""
        return np.stack([self.placed(low).T, self.placed(high).T])

    def of(self, points: Floats, *leaves: Ints) -> Iterator[tuple[Floats, Floats]]:
        """For each array of leaves the value (n,) and the gradient (n, 2) of the leaf of each point."""
        if self._large is None:
            values, gradients = self._every(points)
            at = np.arange(len(points))
            yield from ((values[leaf, at], gradients[leaf, at]) for leaf in leaves)
        else:
            for leaf in leaves:
                value, gradient = self._large.leaf(points, leaf)
                value[np.isin(leaf, self.flat)] = np.inf
                yield value, gradient

    def of_active(self, points: Floats) -> tuple[Floats, Floats, Ints]:
        """Value and gradient of the leaf that gives the value of the form, and which it is: an end of a domain last."""
        if self._large is not None:
            _, leaf = self.active(points)
            ((value, gradient),) = self.of(points, leaf)
            return value, gradient, leaf
        values, gradients = self._every(points)
        by = values[: self.count]
        if len(self.walls):
            by = ends_last(by, self.walls, gradients[self.walls], points)
        leaf, at = active_leaf(self.form.gates, by)[1], np.arange(len(points))
        return values[leaf, at], gradients[leaf, at], leaf

    def distance(self, points: Floats) -> tuple[Floats, Ints]:
        """How far the zero of the active leaf is, to first order, and which leaf it is."""
        value, gradient, leaf = self.of_active(points)
        with np.errstate(all="ignore"):
            return np.abs(value) / np.linalg.norm(gradient, axis=1), leaf

    def slide(self, points: Floats, leaf: Ints) -> Floats:
        """Newton from each point onto its leaf."""

        def step(points: Floats, which: Ints) -> Floats:
            ((f, p),) = self.of(points, leaf[which])
            return np.asarray(points - (f / np.einsum("ij,ij->i", p, p))[:, None] * p)

        return repeated(step, points, NEWTON_STEPS)

    def common(self, points: Floats, one: Ints, other: Ints) -> Floats:
        """Newton from points to the common zeros of two leaves each; NaN or far away where there is none."""
        one, other = self._at_walls(one, other), self._at_walls(other, one)

        def step(points: Floats, which: Ints) -> Floats:
            (f, first), (g, second) = self.of(points, one[which], other[which])
            (p, q), (u, v) = first.T, second.T
            across = np.stack([f * v - g * q, g * p - f * u], axis=1)
            return np.asarray(points - across / (p * v - q * u)[:, None])

        return repeated(step, points, NEWTON_STEPS)

    @cached_property
    def unfolded(self) -> PlaneLeaves:
        """The same with the choices within leaves as gates: leaves without corners of their own, by other numbers."""
        form = self.form if self._large is not None else unfolded(self.form)
        return self if form is self.form else replace(self, form=form, flat=()).at(self.fixed)

    @cached_property
    def _zeros(self) -> Ints:
        """Of each leaf the first that is zero where it is: itself, or what it is the negative of."""
        form = self.form if self._large is None else self._large.kernels.form
        first: dict[int, int] = {}
        plain = [min(leaf, form.builder.neg(leaf)) for leaf in form.leaves]
        return np.array([first.setdefault(node, number) for number, node in enumerate(plain)], np.int64)

    @cached_property
    def walls(self) -> Ints:
        """The leaves that are ends of domains: no zero of omega is there."""
        return np.array(sorted(self.form.walls), np.int64)

    @cached_property
    def kinked(self) -> list[int]:
        """The leaves that may have corners of their own, as far as that is known."""
        few = () if self._large is not None else self.form.leaves
        return [number for number, leaf in enumerate(few) if has_kinks(self.form.builder, leaf)]

    @cached_property
    def limits(self) -> dict[tuple[int, int], int]:
        """By a leaf and a wall the number of what the leaf is there, behind those of the leaves."""
        found = [(leaf, wall) for wall, ends in self.form.walls.items() for leaf, limit in ends.items() if limit]
        return {} if self._large is not None else {pair: self.count + k for k, pair in enumerate(found)}

    def _at_walls(self, leaf: Ints, other: Ints) -> Ints:
        """Leaves, and their limits for those that meet a wall."""
        own = leaf.copy()
        for (one, wall), number in self.limits.items():
            own[(leaf == one) & (other == wall)] = number
        return own

    def placed(self, points: Floats) -> Floats:
        """Points (n, 2) of the plane in the coordinates of the shape, (n, dim)."""
        found = np.zeros((len(points), self.shape.dimension))
        for number, value in self.fixed.items():
            found[:, number] = value
        found[:, self.free] = points
        return found

    def _every(self, points: Floats) -> tuple[Floats, Floats]:
        """The values (leaves, n) and the gradients (leaves, n, 2) at points (n, 2)."""
        program = self._kernel.program
        coordinates = [np.full(len(points), self.fixed.get(k, 0.0)) for k in range(len(program.coordinates))]
        coordinates[self.free[0]], coordinates[self.free[1]] = points.T
        out = np.empty((len(program.outputs), len(points)))
        letters = [self._numbers[name] for name in program.letters]
        run_in_blocks(self._kernel.function, coordinates, letters, out, self._kernel.threads)
        parts = out.reshape(len(out) // 3, 3, len(points))
        parts[list(self.flat), 0] = np.inf
        return parts[:, 0], parts[:, 1:].transpose(0, 2, 1)

    @cached_property
    def _numbers(self) -> dict[str, float]:
        """Of the letters of the builder by name; those of the shape have values."""
        return dict.fromkeys(self.form.builder.letters, 0.0) | self.shape.letters.values_with(self.letters)

    @cached_property
    def _large(self) -> Any:
        """The form of a large shape, of which at each place what matters is evaluated; else None."""
        found = large_form(self.shape, self.free, self.fixed, self.letters, self.bounds)
        return found if found is None or not self.flat else found.without(self.flat)

    @cached_property
    def _kernel(self) -> Kernel:
        return _all_leaves(self.form, self.shape, self.free)


@recently(16)
def _leaf_bounds(form: SignForm) -> IntervalFunction:
    """Called some ten times for thousands of boxes: nothing is compiled."""
    program = form.builder.program({f"leaf_{k}": leaf for k, leaf in enumerate(form.leaves)})
    return IntervalFunction(program, ready_backend(), sharpened=tuple({number for _, number in program.outputs}))


@recently(16)
def _slope_bounds(form: SignForm, free: tuple[int, int]) -> IntervalFunction:
    builder = form.builder
    names = [builder.coordinates[axis] for axis in free]
    slopes = [derivative(builder, leaf, name) for name in names for leaf in form.leaves]
    return IntervalFunction(builder.program({f"slope_{k}": node for k, node in enumerate(slopes)}), ready_backend())


@recently(16)
def _all_leaves(form: SignForm, shape: Shape, free: tuple[int, int]) -> Kernel:
    """Value and gradient in the plane of each leaf."""
    builder = form.builder
    outputs = {}
    limits = [limit for ends in form.walls.values() for limit in ends.values() if limit]
    for k, leaf in enumerate([*form.leaves, *limits]):
        outputs[f"leaf_{k}"] = leaf
        outputs.update({f"leaf_{k}_{i}": derivative(builder, leaf, builder.coordinates[i]) for i in free})
    return compile_program(builder.program(outputs), (), shape)


def _products(one: Floats, other: Floats) -> tuple[Floats, Floats]:
    """The ends of products of intervals (2, n)."""
    ends = (one[:, None] * other).reshape(4, -1)
    return ends.min(axis=0), ends.max(axis=0)


def leaves_of(
    shape: Shape,
    free: tuple[int, int],
    fixed: Mapping[int, float],
    letters: Mapping[Any, float] | None = None,
    bounds: Bounds | None = None,
) -> PlaneLeaves:
    """The leaves of a shape in a plane, asked for mostly within bounds of that."""
    found = PlaneLeaves(_form(shape), shape, free, fixed, letters, bounds)
    # Of a section the coordinate that is fixed may be a letter.
    return found.at(fixed) if fixed or found.form.builder.letters else found


@recently(16, written)
def _form(shape: Shape) -> SignForm:
    """One form, so that bounds and kernels of its leaves are made once."""
    return shape_form(shape)


def level_leaves(
    shape: Shape,
    free: tuple[int, int],
    fixed: Mapping[int, float],
    letters: Mapping[Any, float] | None,
    level: float,
    bounds: Bounds | None = None,
) -> PlaneLeaves | None:
    """The leaves of omega - level where the value of omega is a min and max of several; else None.

    Examples
    --------
    >>> import rsym
    >>> for system in (rsym.R0, rsym.R1):
    ...     found = level_leaves(rsym.rectangle(2, 2, system=system), (0, 1), {}, None, 0.25)
    ...     print(found and found.count)
    None
    2
    """
    moved = _lowered(shape)
    form = _lifted_form(moved)
    if form is None:
        return None
    given = {**shape.letters.values_with(letters), LEVEL: level}
    return PlaneLeaves(form, moved, free, fixed, given, bounds).at(fixed)


@recently(16)
def _lowered(shape: Shape) -> Shape:
    level = real_symbol(LEVEL)
    return shape.replace(expression=shape.expression - level, letters={**shape.letters, level: 0})


@recently(16)
def _lifted_form(shape: Shape) -> SignForm | None:
    builder = shape_form(shape).builder
    form = unfolded(sign_form(builder, lower(builder, shape.expression)))
    return form if len(form.leaves) > 1 else None
