"""Values and derivatives of tensor B-splines at points, in compiled loops."""

from __future__ import annotations

from typing import Any

import numpy as np

from rsym.arrays import Floats, Ints
from rsym.problems.splines.cardinals import derivatives, digits, multiplied, pieces
from rsym.problems.splines.web import WebSplines
from rsym.sampling.compiled import loop, step


def jets(splines: WebSplines, coefficients: Floats, points: Floats, order: int) -> Floats:
    """The derivatives up to an order, (kinds, functions, n), at points (n, dimension), of splines by coefficients.

    coefficients : (functions, active). Beside the grid, and where no spline is active, they are 0.

    Examples
    --------
    >>> from rsym.problems.splines.web import web_splines
    >>> splines = web_splines(np.zeros(2), 1.0, (4, 4), 2, np.arange(16), np.arange(16))
    >>> jets(splines, np.ones((1, 36)), np.array([[1.3, 2.7]]), 1).round(12).tolist()
    [[[1.0]], [[0.0]], [[0.0]]]
    """
    kinds = np.array(derivatives(splines.dimension, order), np.int64)
    cells = splines.home_of(points)
    wide, dimension = splines.degree + 1, splines.dimension
    local = digits(wide, dimension)
    table = np.empty((dimension, order + 1, wide))
    found = np.zeros((len(points), len(kinds), len(coefficients)))

    def add(some: Ints, first: Ints, shape: tuple[int, ...], whole: Floats) -> None:
        _jets(
            np.ascontiguousarray(points[some], np.float64),
            *(splines.cells(cells[some]), first, splines.lower, splines.size, pieces(splines.degree).T.copy(), local),
            *(kinds, np.array(shape, np.int64), whole, table, some, found),
        )

    row = splines.split_row(cells)
    plain, split = np.flatnonzero((cells >= 0) & (row < 0)), np.flatnonzero(row >= 0)
    whole = np.zeros((len(coefficients), int(np.prod(splines.shape))))
    whole[:, splines.number >= 0] = coefficients[:, splines.number[splines.number >= 0]]
    add(plain, splines.cells(cells[plain]), splines.shape, whole)
    if len(split):
        # Each of these cells has a block of coefficients of its own.
        first = np.zeros((len(split), dimension), np.int64)
        first[:, 0] = wide * row[split]
        own = np.ascontiguousarray(coefficients[:, splines.numbers.ravel()])
        add(split, first, (wide * len(splines.split), *[wide] * (dimension - 1)), own)
    return np.ascontiguousarray(found.transpose(1, 2, 0))


def weighted(splines: WebSplines, coefficients: Floats, weights: Floats, points: Floats, order: int) -> Floats:
    """The derivatives (kinds, n) up to an order, at points, of weights times sums of active splines, together.

    coefficients, weights : (families, active), or (active,) of the only one, and the derivatives (families, kinds, n).
    """
    sums = jets(splines, np.atleast_2d(coefficients), points, order).transpose(1, 0, 2)
    found = multiplied(weights[0], sums[0], points.shape[1], order)
    for weight, phi in zip(weights[1:], sums[1:], strict=True):
        found += multiplied(weight, phi, points.shape[1], order)
    return found


@step
def tabulate(point: Any, cell: Any, lower: Floats, size: Floats, coefficients: Floats, table: Floats) -> None:
    """The splines that live on a cell along each axis, and their derivatives, at a point: table (axis, order, spline).

    coefficients : (powers, splines). Derivatives of a polynomial by Horner's rule, of all splines at once: that of
    order k gathers that of order k - 1, k times.
    """
    dimension, orders, count = table.shape
    for axis in range(dimension):
        t = (point[axis] - lower[axis]) / size[axis] - cell[axis]
        for k in range(orders):
            for i in range(count):
                table[axis, k, i] = 0.0
        for power in range(count - 1, -1, -1):
            for k in range(orders - 1, 0, -1):
                for i in range(count):
                    table[axis, k, i] = table[axis, k, i] * t + k * table[axis, k - 1, i]
            for i in range(count):
                table[axis, 0, i] = table[axis, 0, i] * t + coefficients[power, i]
        scale = 1.0
        for k in range(1, orders):
            scale /= size[axis]
            for i in range(count):
                table[axis, k, i] *= scale


@loop
def _jets(
    points: Floats,
    cells: Ints,
    firsts: Ints,
    lower: Floats,
    size: Floats,
    coefficients: Floats,
    local: Ints,
    kinds: Ints,
    shape: Ints,
    whole: Floats,
    table: Floats,
    places: Ints,
    found: Floats,
) -> None:
    """The sum along the last axis first: its coefficients lie side by side.

    firsts : (n, dimension), where the coefficients of the splines of each point begin in `whole`, an array of a shape.
    """
    count, dimension = points.shape
    last, wide, orders = dimension - 1, table.shape[2], table.shape[1]
    sums = np.empty(orders)
    for k in range(count):
        tabulate(points[k], cells[k], lower, size, coefficients, table)
        for row in range(0, len(local), wide):
            flat = 0
            for axis in range(dimension):
                flat = flat * shape[axis] + firsts[k, axis] + local[row, axis]
            for function in range(len(whole)):
                for order in range(orders):
                    sums[order] = 0.0
                    for spline in range(wide):
                        sums[order] += table[last, order, spline] * whole[function, flat + spline]
                for kind in range(len(kinds)):
                    value = sums[kinds[kind, last]]
                    for axis in range(last):
                        value *= table[axis, kinds[kind, axis], local[row, axis]]
                    found[places[k], kind, function] += value
