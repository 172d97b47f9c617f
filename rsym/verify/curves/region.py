"""Unions of boxes: which points lie in one, through which face a curve leaves it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from rsym.arrays import Floats
from rsym.verify.boxes.local import GROWN, Box

# A hair less than the share by which boxes were grown when they were examined, for the rounding of their sides.
_GROWN = GROWN * (1 - 2.0**-20)


class Region:
    """A union of axis-parallel boxes in space, each of which stands for the same box grown by a quarter.

    Examples
    --------
    >>> region = Region([((0.0, 1.0), (0.0, 1.0), (0.0, 1.0)), ((1.0, 2.0), (0.0, 1.0), (0.0, 1.0))], 1e-9)
    >>> region.holds(np.array([1.5, 0.5, 1.0])), region.holds(np.array([1.5, 0.5, 1.1]))
    (True, False)
    >>> region.surrounds(np.array([0.5, 0.2, 0.2]), np.array([1.2, 0.3, 1.2]))
    True
    >>> region.face(np.array([1.9, 0.5, 1.0]), np.array([2.1, 0.5, 1.01]))
    (0, 2.0)
    """

    def __init__(self, boxes: Sequence[Box], tolerance: float) -> None:
        sides = np.array([box[:3] for box in boxes], float).reshape(-1, 3, 2)
        self.tolerance = tolerance
        self.low, self.high = sides[..., 0], sides[..., 1]
        margin = _GROWN * (self.high - self.low)
        self._low, self._high = self.low - margin, self.high + margin
        # Along each axis the boxes by their lower ends, and how far below a point one can begin that reaches it.
        self._lines = [(ends.argsort(), np.sort(ends)) for ends in self._low.T]
        self._reach = (1 + 2.0**-20) * (self._high - self._low).max(axis=0, initial=0) + 2 * tolerance

    def _candidates(self, low: Floats, high: Floats) -> NDArray[np.intp]:
        """All that may hold a box, to within the tolerance: what reaches it along the axis where that is least."""
        beyond = low + 2 * self.tolerance
        least = high - self._reach
        ranges = [
            (order, line.searchsorted(least[axis]), line.searchsorted(beyond[axis], "right"))
            for axis, (order, line) in enumerate(self._lines)
        ]
        order, first, last = min(ranges, key=lambda item: item[2] - item[1])
        some: NDArray[np.intp] = order[first:last]
        return some

    def around(self, point: Floats) -> NDArray[np.intp]:
        """The boxes that a point lies in, to within the tolerance."""
        some = np.sort(self._candidates(point, point))
        near = (self.low[some] - self.tolerance <= point) & (point <= self.high[some] + self.tolerance)
        found: NDArray[np.intp] = some[near.all(axis=1)]
        return found

    def holds(self, point: Floats) -> bool:
        """Whether a point lies in the union, to within the tolerance."""
        return bool(len(self.around(point)))

    def surrounds(self, low: Floats, high: Floats) -> bool:
        """Whether one of the grown boxes holds a box."""
        some = self._candidates(low, high)
        return bool(((self._low[some] <= low) & (high <= self._high[some])).all(axis=1).any())

    def face(self, inner: Floats, outer: Floats) -> tuple[int, float] | None:
        """The axis and the value of the face between two points that are close together; None if there is none."""
        best, found = 0.0, None
        for number in self.around(inner):
            for axis in range(3):
                for value, beyond in ((self.high[number, axis], 1), (self.low[number, axis], -1)):
                    if (excess := beyond * (outer[axis] - value)) > best:
                        best, found = float(excess), (axis, float(value))
        return found
