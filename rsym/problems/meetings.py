"""Where parts of the boundary are, and where two of them meet: corners, edges, and points where they touch.

Boxes in which the weight of a part is proved not to vanish, or that lie outside of the shape, are dropped, the others
divided. In those left Newton's method goes to the zeros of a leaf, or to the common zeros of two, by steps of least
norm; where two leaves are tangent it halves the distance at every step, until rounding may be more than the step: from
there on chance would lead it. What it finds counts if it lies on the boundary. That is some points of each meeting, in
space too, to tell where data differ; `corners.common_zeros` proves that it has all of those in the plane, each once.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import product

import numpy as np

from rsym.arrays import Flags, Floats, Ints
from rsym.backends.kernel import Kernel, compile_program, run_in_blocks
from rsym.bounds.intervals import IntervalFunction
from rsym.logic.sign_form import SignForm
from rsym.logic.weights import weight
from rsym.model.shape import Bounds, Shape
from rsym.program.differentiation import gradient
from rsym.sampling.active_leaves import active_leaf
from rsym.sampling.form_signs import Boxes, grid, halves

GRID = {2: 16, 3: 8}  # boxes along each axis
# Halvings: corners of the plane lie 1e6 boxes apart at the end, edges in space some two hundred points from each other.
DEEPEST = {2: 16, 3: 4}
# Boxes left, and those of them that are looked at: parts that meet all along a curve are seen at so many places of it.
MOST, FEW = 4096, 512
AT_A_GLANCE = 16  # boxes in which a part is looked for before they are divided
STEPS = 60  # halve the way to where two leaves are tangent to 1e-18 of it
OFF = 4  # last steps and what rounding may make of one: how far off a point is where contact is of that order at most
SLACK = 1e-9  # of the box: what Newton's method leaves, and how far beyond a box a point of it may lie
ROUNDING = 1e-15  # of the box
EPS = float(np.finfo(float).eps)  # of the box: the rounding of a leaf, as a distance
NEAR_ENOUGH = 1e-7  # of the box: points that are taken for one


@dataclass(frozen=True)
class Places:
    """Where parts of the boundary of a shape, sets of leaves, are within a box, letters at their defaults.

    between : of two leaves with one formula, in both orders, that whose zeros are between them.

    Examples
    --------
    >>> import rsym
    >>> from rsym.logic.sign_form import shape_form
    >>> half = rsym.disc(2) & rsym.half_plane((1, 0), 0)
    >>> places = Places(half, shape_form(half), ((-3, 3), (-3, 3)), ((0,), (1,)))
    >>> len(places.of(1)) > 0, sorted(places.meeting(0, 1)[0].round(12).tolist())
    (True, [[0.0, -2.0], [0.0, 2.0]])
    """

    shape: Shape
    form: SignForm
    box: Bounds
    parts: tuple[tuple[int, ...], ...]
    between: Mapping[tuple[int, int], int] = field(default_factory=dict)

    def of(self, part: int) -> Floats:
        """Some points (n, dim) of a part, by its number, within the box; none if it has none there."""
        found = (points[:, :-1] for points in self._search([part]) if len(points))
        return next(found, np.empty((0, self.shape.dimension)))

    def meeting(self, one: int, other: int) -> tuple[Floats, Floats]:
        """Points (n, dim) where two parts meet, and (n,) how far off they may be."""
        *_, last = self._search([one, other])
        return last[:, :-1], OFF * last[:, -1] + ROUNDING * self._size

    @cached_property
    def _letters(self) -> dict[str, float]:
        return self.shape.letters.values_with(None)

    @cached_property
    def _leaves(self) -> Kernel:
        """The values and the gradients of all leaves."""
        b, outputs = self.form.builder, dict[str, int]()
        for number, leaf in enumerate(self.form.leaves):
            outputs[f"{number}"] = leaf
            outputs |= {f"{number} {axis}": node for axis, node in enumerate(gradient(b, leaf))}
        return compile_program(b.program(outputs), (), self.shape, backend="numpy")

    def at(self, points: Floats) -> tuple[Floats, Floats]:
        """The values (leaves, n) and the gradients (leaves, n, dim) at points (n, dim)."""
        kernel = self._leaves
        out = np.empty((len(kernel.program.outputs), len(points)))
        letters = [self._letters[name] for name in kernel.program.letters]
        run_in_blocks(kernel.function, list(np.ascontiguousarray(points.T)), letters, out, threads=1)
        rows = out.reshape(len(self.form.leaves), 1 + points.shape[1], len(points))
        return rows[:, 0], np.moveaxis(rows[:, 1:], 1, 2)

    def _search(self, parts: Sequence[int]) -> Iterator[Floats]:
        """From depth to depth points (n, dim + 1) of all parts, how far off they may be last."""
        dimension = self.shape.dimension
        boxes, open_ = self._first
        boxes = boxes[_where_all(open_, parts)]
        for _ in range(DEEPEST[dimension]):
            if not len(boxes) or len(boxes) > MOST:
                break
            if len(parts) == 1:
                yield self._points(parts, boxes[_spread(len(boxes), AT_A_GLANCE)])
            boxes, _ = halves(boxes)
            boxes = boxes[_where_all(self._open(boxes), parts)]
        if len(boxes) > MOST:
            boxes = boxes[_spread(len(boxes), FEW)]
        yield self._points(parts, boxes)

    @cached_property
    def _first(self) -> tuple[Boxes, Flags]:
        """Boxes, and which of them may have points of which part (parts, n)."""
        boxes = grid(Boxes(*np.array(self.box).T[:, :, None]), GRID[self.shape.dimension])
        return boxes, self._open(boxes)

    @cached_property
    def _bounds(self) -> IntervalFunction:
        """Of the form, and of the weights of parts."""
        nodes = [weight(self.form, part) for part in self.parts]
        weights = {f"{k}": node for k, node in enumerate(nodes) if node is not None}
        return IntervalFunction(self.form.builder.program({"form": self.form.value, **weights}), "numpy", threads=1)

    def _open(self, boxes: Boxes) -> Flags:
        """Which boxes may have points of which part (parts, n)."""
        found = self._bounds(list(boxes.lower), list(boxes.upper), self._letters)
        beside, *rows = [(low <= 0) & (high >= 0) for low, high in found.values()]
        return np.array([beside & row for row in rows])

    def _points(self, parts: Sequence[int], boxes: Boxes) -> Floats:
        """The points of all parts in or beside boxes, each once."""
        found = [self._newton(leaves, boxes) for leaves in product(*(self.parts[k] for k in parts))]
        points = np.concatenate([np.empty((0, self.shape.dimension + 1)), *found])
        keys = np.round(points[:, :-1] / (NEAR_ENOUGH * self._size)).astype(np.int64)
        return points[np.sort(np.unique(keys, axis=0, return_index=True)[1])]

    @property
    def _size(self) -> float:
        return float(np.diff(self.box, axis=1).max())

    def _newton(self, leaves: Sequence[int], boxes: Boxes) -> Floats:
        """From the middle of boxes to the common zeros of leaves that are on the boundary.

        Each with its last step, to which is added what the rounding of values may change it by.
        """
        points, chosen = boxes.centres.T.copy(), list(leaves)
        if (leaves[0], leaves[-1]) in self.between:
            chosen[-1] = self.between[leaves[0], leaves[-1]]
        reach = boxes.sides.max(axis=0)
        doubt = np.zeros(len(points))
        with np.errstate(all="ignore"):
            for _ in range(STEPS if len(boxes) else 0):
                values, slopes = (rows[chosen] for rows in self.at(points))
                step, gain = _least(values.T, np.moveaxis(slopes, 0, 1))
                step *= np.minimum(1, reach / np.linalg.norm(step, axis=1))[:, None]
                length, noise = np.linalg.norm(step, axis=1), EPS * self._size * gain
                doubt = length + noise
                step[length <= np.where(noise > ROUNDING * self._size, noise, 0)] = 0
                points = points - step
                if not (np.abs(step) > ROUNDING * self._size).any():
                    break
            values, slopes = self.at(points)
            away = np.abs(values[chosen]).max(axis=0)
            value, _ = active_leaf(self.form.gates, list(values))
            speed = np.linalg.norm(slopes[chosen], axis=2).max(axis=0)
            good = (np.maximum(away, np.abs(value)) <= SLACK * speed * self._size) & (doubt <= reach)
            good &= (np.abs(points - boxes.centres.T) <= 2 * reach[:, None]).all(axis=1)
            lower, upper = np.array(self.box).T
            good &= ((points >= lower - SLACK * self._size) & (points <= upper + SLACK * self._size)).all(axis=1)
        found: Floats = np.column_stack([points, doubt])[good]
        return found


def _where_all(open_: Flags, parts: Sequence[int]) -> Flags:
    """Which boxes may have points of all of some parts."""
    return np.asarray(open_[list(parts)].all(axis=0))


def _spread(count: int, most: int) -> Ints:
    """The numbers of so many of `count` things, from the first on."""
    return np.arange(0, count, max(1, count // most))


def _least(values: Floats, slopes: Floats) -> tuple[Floats, Floats]:
    """The step of least norm (n, dim) to the zeros of linear functions: values (n, k), slopes (n, k, dim).

    And (n,) by how much it may grow errors of the values, those that a step of unit length along each slope is.
    """
    bad = ~(np.isfinite(values).all(axis=1) & np.isfinite(slopes).all(axis=(1, 2)))
    slopes[bad], values[bad] = 0, 0
    inverse = np.linalg.pinv(slopes, rcond=1e-12)
    step: Floats = np.einsum("nij,nj->ni", inverse, values)
    step[bad] = np.nan
    return step, np.linalg.norm(inverse * np.linalg.norm(slopes, axis=2)[:, None], axis=(1, 2))
