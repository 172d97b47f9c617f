"""What the lint looks at: a shape, its logic, and its leaves and terms at points of its bounds."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import sympy as sp

from rsym.analysis.contracts.leaves import is_logical, logical_parts
from rsym.analysis.contracts.orders import leaf_order
from rsym.analysis.contracts.promises import Order
from rsym.arrays import Floats
from rsym.model.shape import Shape
from rsym.sampling.extent import bounds_or_extent
from rsym.verify.lint.functions import Functions, functions_of
from rsym.verify.lint.logic import Logic, logic_of
from rsym.verify.lint.places import ModelPlace, places_of
from rsym.verify.lint.saturation import terms_of
from rsym.verify.lint.slopes import operands_of
from rsym.verify.lint.zeros import SCATTERED, Box, Progress, Zeros, diagonal, scattered, zeros_of

MARGIN = 0.02  # of the diagonal of the bounds, around the zeros of omega that were met


@dataclass(frozen=True)
class Survey:
    """A shape, its logic, and its leaves and terms at points.

    operations : the R-operations of the formula; orders : of its leaves, as far as algebra shows them;
    expressions : the leaves of the logic, then the other leaves, which blends, trimming and joining hide from it, then
    terms inside leaves; functions : these and omega, the last; zeros : points on their zero sets;
    near : such points in the box that holds the zeros of omega, and the diagonal of that box.
    """

    shape: Shape
    box: Box
    logic: Logic
    operations: tuple[sp.Expr, ...]
    orders: dict[sp.Expr, Order]
    expressions: tuple[sp.Expr, ...]
    places: tuple[ModelPlace, ...]
    functions: Functions
    cloud: Floats
    zeros: Zeros
    near: tuple[Zeros, float]

    def slopes(self, expression: sp.Expr) -> Floats:
        """The lengths of a gradient on its zero set."""
        slopes: Floats = self.zeros.slopes[self._of(expression)]
        return slopes

    def points(self, expression: sp.Expr) -> Floats:
        """Where these are."""
        points: Floats = self.zeros.points[self._of(expression)]
        return points

    def leaves_with(self, expression: sp.Expr) -> tuple[sp.Expr, ...]:
        """The leaves that R-operations join a leaf with, itself included; none for a term."""
        groups = (self.logic.leaves, tuple(self.orders))
        return next((leaves for leaves in groups if expression in leaves), ())

    def place(self, expression: sp.Expr) -> ModelPlace:
        """Where an expression stands in the model."""
        return self.places[self.expressions.index(expression)]

    def _of(self, expression: sp.Expr) -> Any:
        return self.zeros.which == self.expressions.index(expression)


def survey_of(shape: Shape, bounds: Any, progress: Progress | None = None) -> Survey:
    """Look at a shape.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> survey = survey_of(rsym.Shape(rsym.conjunction(x, 2 * y), (x, y)), ((-1, 1), (-1, 1)))
    >>> survey.orders[x], survey.orders[2 * y], survey.slopes(2 * y).max().item()
    (inf, 0, 2.0)
    """
    box = bounds_or_extent(shape, bounds)
    logic = logic_of(shape.expression)
    parts = logical_parts(shape.expression, operands_of)
    leaves = [part for part in parts if not is_logical(part)]
    terms = terms_of(leaves, shape.coordinates)
    expressions = tuple(dict.fromkeys([*logic.leaves, *leaves, *terms]))
    functions = functions_of(shape, [*expressions, shape.expression])
    cloud = scattered(box, SCATTERED[shape.dimension])
    zeros = zeros_of(functions, cloud, box, _half(progress, 0))
    return Survey(
        shape,
        box,
        logic,
        tuple(part for part in parts if is_logical(part)),
        {leaf: leaf_order(leaf, shape.coordinates) for leaf in leaves},
        expressions,
        places_of(shape, expressions),
        functions,
        cloud,
        zeros,
        _near(functions, zeros, box, _half(progress, 1)),
    )


def _half(progress: Progress | None, number: int) -> Progress | None:
    """The progress of the first or second of two equal tasks."""
    return None if progress is None else lambda done, total: progress(done + number * total, 2 * total)


def _near(functions: Functions, zeros: Zeros, box: Box, progress: Progress | None) -> tuple[Zeros, float]:
    """Zeros where the shape is: within generous bounds faces are few among those of their leaves."""
    points = zeros.points[zeros.which == functions.count - 1]
    if len(points):
        margin = MARGIN * diagonal(box)
        ends = zip(box, points.min(axis=0).tolist(), points.max(axis=0).tolist(), strict=True)
        box = tuple((max(low, least - margin), min(high, most + margin)) for (low, high), least, most in ends)
    cloud = scattered(box, SCATTERED[functions.dimension])
    return zeros_of(functions, cloud, box, progress), diagonal(box)
