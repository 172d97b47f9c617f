"""What the cells have in common that the shape fills: the splines at the points of the plain Gauss rule.

The sum over the points of a cell is one sum an axis: of forms at q**2 points on m**2 splines not q**2 m**4 products are
taken but about 9 q**2 m**2 + 4 q m**4. All cells are alike, so splines are evaluated once.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache
from itertools import product

import numpy as np

from rsym.arrays import Floats, Ints
from rsym.problems.splines.cardinals import derivatives, digits, pieces


@lru_cache(16)
def axis_sums(degree: int, points: int, dimension: int, order: int, size: float) -> AxisSums:
    """The tables, made once."""
    return AxisSums(degree, points, dimension, order, size)


@dataclass(frozen=True)
class AxisSums:
    """Tables for splines of a degree at `points` Gauss points along each axis of cells of one size.

    Examples
    --------
    >>> sums = AxisSums(1, 2, 2, 1, 1.0)
    >>> sums.values[0].round(3).tolist()
    [[0.789, 0.211], [0.211, 0.789]]
    >>> sums.pairs.tolist()
    [[0, 1, 2, 3, -1, -1, -1, -1, -1], [0, 0, 1, 0, 0, 1, 2, 2, 3]]
    """

    degree: int
    points: int
    dimension: int
    order: int
    size: float

    @cached_property
    def values(self) -> Floats:
        """(derivatives, points, splines), along an axis."""
        t = (np.polynomial.legendre.leggauss(max(self.points, 1))[0] + 1) / 2
        rows = [np.polynomial.Polynomial(row) for row in pieces(self.degree)]
        return np.array(
            [
                [[(row.deriv(k) if k else row)(place) / self.size**k for row in rows] for place in t]
                for k in range(self.order + 1)
            ]
        )

    @cached_property
    def along(self) -> Floats:
        """(pairs of derivatives, points, splines**2), products along an axis."""
        v = self.values
        count = len(v) ** 2
        return np.ascontiguousarray(np.einsum("aki,bkj->abkij", v, v).reshape(count, self.points, -1))

    @cached_property
    def everywhere(self) -> Floats:
        """(points, kinds, splines) of all points of a cell, the last coordinate fastest."""
        places, local = digits(self.points, self.dimension), digits(self.degree + 1, self.dimension)
        return np.ascontiguousarray(
            np.stack(
                [
                    np.prod(
                        [self.values[k][places[:, axis]][:, local[:, axis]] for axis, k in enumerate(index)], axis=0
                    )
                    for index in derivatives(self.dimension, self.order)
                ],
                axis=1,
            )
        )

    @cached_property
    def _stages(self) -> list[list[tuple[int, int]]]:
        """Of each axis, of each combination that is left before its sum: the pair along it, and what remains."""
        every = derivatives(self.dimension, self.order)
        left = [tuple(zip(f, g, strict=True)) for f, g in product(every, repeat=2)]
        stages = []
        for _ in range(self.dimension):
            shorter = list(dict.fromkeys(one[:-1] for one in left))
            stages.append([(a * (self.order + 1) + b, shorter.index(tuple(head))) for *head, (a, b) in left])
            left = shorter
        return stages[::-1]

    @cached_property
    def pairs(self) -> Ints:
        """Of each axis and combination, which product along the axis it is; -1 where there is none."""
        return self._filled(0)

    @cached_property
    def parents(self) -> Ints:
        """And which combination of the axes before."""
        return self._filled(1)

    def _filled(self, which: int) -> Ints:
        found = np.full((self.dimension, max(map(len, self._stages))), -1, np.int64)
        for axis, stage in enumerate(self._stages):
            found[axis, : len(stage)] = [one[which] for one in stage]
        return found

    @cached_property
    def largest(self) -> int:
        """How many numbers a sum may have on the way."""
        square, counts = (self.degree + 1) ** 2, [len(stage) for stage in self._stages]
        sizes = [square**self.dimension]
        for axis, count in enumerate(counts):
            sizes.append(int(count * self.points ** (axis + 1) * square ** (self.dimension - 1 - axis)))
        return int(max(sizes))

    @cached_property
    def places(self) -> Ints:
        """(splines, splines), where the entry of two tensor splines is among the products of those along the axes."""
        local = digits(self.degree + 1, self.dimension)
        found = np.zeros((len(local),) * 2, np.int64)
        for axis in range(self.dimension):
            pair = local[:, None, axis] * (self.degree + 1) + local[None, :, axis]
            found = found * (self.degree + 1) ** 2 + pair
        return found
