"""Where parts of the boundary are, and where two of them meet: corners, edges, and points where they touch.

Boxes in which the weight of a part is proved not to vanish, or that lie outside of the shape, are dropped, the others
divided. In those left Newton's method goes to the zeros of a leaf, or to the common zeros of two, by steps of least
norm; where two leaves are tangent it halves the distance at every step. What it finds counts if it lies on the
boundary.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import product

import numpy as np

from rsym.arrays import Flags, Floats
from rsym.backends.kernel import Kernel, compile_program
from rsym.bounds.intervals import IntervalFunction
from rsym.logic.sign_form import SignForm
from rsym.logic.weights import weight
from rsym.model.shape import Bounds, Shape
from rsym.program.differentiation import gradient
from rsym.sampling.form_signs import Boxes, grid, halves
from rsym.sampling.plane_leaves import active_leaf

GRID = {2: 16, 3: 8}  # boxes along each axis
# Halvings: corners of the plane lie 1e6 boxes apart at the end, edges in space some two hundred points from each other.
DEEPEST = {2: 16, 3: 4}
MOST = 4096  # boxes left: parts that meet all along a curve are seen at so many places of it
STEPS = 60  # halve the way to where two leaves are tangent to 1e-18 of it
SLACK = 1e-9  # of the box: what Newton's method leaves, and how far beyond a box a point of it may lie
NEAR_ENOUGH = 1e-7  # of the box: points that are taken for one


@dataclass(frozen=True)
class Boundary:
    """The boundary of a shape at its default letters, for questions where parts of it, sets of leaves, are."""

    shape: Shape
    form: SignForm
    box: Bounds

    def has(self, part: Collection[int]) -> bool:
        """Whether the part has a point within the box."""
        return any(len(points) for points in self._search([part]))

    def meeting(self, one: Collection[int], other: Collection[int]) -> tuple[Floats, Floats]:
        """Points (n, dim) where two parts meet, and (n,) how far off they may be."""
        *_, last = self._search([one, other])
        points, doubt = last[:, :-1], last[:, -1]
        return points, doubt

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
        return compile_program(b.program(outputs), tuple(outputs), self.shape, backend="numpy")

    def _at(self, points: Floats) -> tuple[Floats, Floats]:
        """The values (leaves, n) and the gradients (leaves, n, dim) at points (n, dim)."""
        found = self._leaves(*points.T)
        rows = np.array([found[name] for name in self._leaves.fields])
        rows = rows.reshape(len(self.form.leaves), 1 + points.shape[1], len(points))
        return rows[:, 0], np.moveaxis(rows[:, 1:], 1, 2)

    def _search(self, parts: Sequence[Collection[int]]) -> Iterator[Floats]:
        """From depth to depth the points (n, dim + 1) of all parts, how far off they may be last; until there are."""
        dimension, box = self.shape.dimension, Boxes(*np.array(self.box).T[:, :, None])
        boxes = grid(box, GRID[dimension])
        bounds = self._bounds(parts)
        for depth in range(DEEPEST[dimension] + 1):
            boxes = boxes[self._open(bounds, boxes, len(parts))]
            if not len(boxes) or len(boxes) > MOST:
                break
            if len(parts) == 1:
                yield self._points(parts, boxes)
            if depth < DEEPEST[dimension]:
                boxes, _ = halves(boxes)
        yield self._points(parts, boxes)

    def _bounds(self, parts: Sequence[Collection[int]]) -> IntervalFunction:
        """Of the weights of parts, and of the form."""
        b = self.form.builder
        weights = [weight(self.form, part) for part in parts]
        outputs = {f"part {k}": node for k, node in enumerate(weights) if node is not None}
        return IntervalFunction(b.program({**outputs, "form": self.form.value}), "numpy", threads=1)

    def _open(self, bounds: IntervalFunction, boxes: Boxes, parts: int) -> Flags:
        """Which boxes may have points of all parts."""
        found = bounds(list(boxes.lower), list(boxes.upper), self._letters)
        kept: Flags = (found["form"][0] <= 0) & (found["form"][1] >= 0)
        for k in range(parts):
            low, high = found[f"part {k}"]
            kept &= (low <= 0) & (high >= 0)
        return kept

    def _points(self, parts: Sequence[Collection[int]], boxes: Boxes) -> Floats:
        """The points of all parts in or beside boxes, each once."""
        found = [self._newton(leaves, boxes) for leaves in product(*parts)]
        points = np.concatenate([np.empty((0, self.shape.dimension + 1)), *found])
        keys = np.round(points[:, :-1] / (NEAR_ENOUGH * self._size)).astype(np.int64)
        return points[np.sort(np.unique(keys, axis=0, return_index=True)[1])]

    @property
    def _size(self) -> float:
        return float(np.diff(self.box, axis=1).max())

    def _newton(self, leaves: Sequence[int], boxes: Boxes) -> Floats:
        """From the middle of boxes to the common zeros of leaves that are on the boundary, each with its last step."""
        points, chosen = boxes.centres.T.copy(), list(leaves)
        reach = boxes.sides.max(axis=0)
        step = np.zeros_like(points)
        with np.errstate(all="ignore"):
            for _ in range(STEPS if len(boxes) else 0):
                values, slopes = (rows[chosen] for rows in self._at(points))
                step = _least(values.T, np.moveaxis(slopes, 0, 1))
                step *= np.minimum(1, reach / np.linalg.norm(step, axis=1))[:, None]
                points = points - step
                if not (np.abs(step) > SLACK**2 * self._size).any():
                    break
            values, slopes = self._at(points)
            away = np.abs(values[chosen]).max(axis=0)
            value, _ = active_leaf(self.form.gates, list(values))
            speed = np.linalg.norm(slopes[chosen], axis=2).max(axis=0)
            doubt = np.linalg.norm(step, axis=1)
            good = (np.maximum(away, np.abs(value)) <= SLACK * speed * self._size) & (doubt <= reach)
            good &= (np.abs(points - boxes.centres.T) <= 2 * reach[:, None]).all(axis=1)
            lower, upper = np.array(self.box).T
            good &= ((points >= lower - SLACK * self._size) & (points <= upper + SLACK * self._size)).all(axis=1)
        found: Floats = np.column_stack([points, doubt])[good]
        return found


def _least(values: Floats, slopes: Floats) -> Floats:
    """The step of least norm (n, dim) to the zeros of linear functions: values (n, k), slopes (n, k, dim)."""
    bad = ~(np.isfinite(values).all(axis=1) & np.isfinite(slopes).all(axis=(1, 2)))
    slopes[bad], values[bad] = 0, 0
    step: Floats = np.einsum("nij,nj->ni", np.linalg.pinv(slopes, rcond=1e-12), values)
    step[bad] = np.nan
    return step
