"""The greatest curvature over the plane of two letters, and its level lines: for figures, not proved."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CloughTocher2DInterpolator

from rsym.arrays import Floats
from rsym.sampling.isolines import isolines

PIXELS = 400  # along each letter, of the map from which level lines are read
DECADE = (1.0, 2.0, 5.0)  # levels in each
FEWEST = 4  # points that make a map


def round_levels(low: float, high: float) -> list[float]:
    """The numbers 1, 2, 5, 10, ... from low to high.

    Examples
    --------
    >>> round_levels(0.4, 10)
    [0.5, 1.0, 2.0, 5.0, 10.0]
    """
    powers = range(math.floor(math.log10(low)), math.floor(math.log10(high)) + 1)
    return [level for power in powers for step in DECADE if low <= (level := step * 10.0**power) <= high]


@dataclass(frozen=True, eq=False)
class CurvatureMap:
    """The greatest size of a curvature of the boundary at pairs of letters; numerical.

    points (n, 2) and values (n,) are what was found, `certified` (m, 2, 2) where the map between them holds.

    Examples
    --------
    >>> points = np.array([[0, 0], [1, 0], [0, 1], [1, 1.0]])
    >>> shown = CurvatureMap(points, 3 / (1 + points[:, 0]), np.array([[[0, 1], [0, 1.0]]]))
    >>> shown.on((np.array([0.25]), np.array([0.5]))).round(6)
    array([[2.4]])
    >>> ((level, (line,)),) = shown.level_lines()
    >>> level, bool(abs(line[:, 0] - 0.5).max() < 1e-3)
    (2.0, True)
    """

    points: Floats
    values: Floats
    certified: Floats

    def on(self, axes: tuple[Floats, Floats]) -> Floats:
        """The map on a lattice; NaN where smoothness is not certified.

        Between the points the radius is interpolated: towards a corner it falls to zero, as a rule in proportion.
        """
        result = np.full((len(axes[0]), len(axes[1])), np.nan)
        if len(self.values) < FEWEST:
            return result
        low, width = self.points.min(axis=0), np.ptp(self.points, axis=0)
        smooth = CloughTocher2DInterpolator((self.points - low) / width, 1 / self.values)
        places = np.meshgrid(*((axis - low[k]) / width[k] for k, axis in enumerate(axes)), indexing="ij")
        values = 1 / np.clip(smooth(*places), 1 / self.values.max(), 1 / self.values.min())
        for sides in self.certified:
            inside = np.ix_(*((low <= axis) & (axis <= high) for axis, (low, high) in zip(axes, sides, strict=True)))
            result[inside] = values[inside]
        return result

    def lattice(self) -> tuple[Floats, Floats]:
        """The coordinates of a fine lattice over all certified rectangles."""
        low, high = self.certified[..., 0].min(axis=0), self.certified[..., 1].max(axis=0)
        return np.linspace(low[0], high[0], PIXELS), np.linspace(low[1], high[1], PIXELS)

    def level_lines(self, levels: Sequence[float] | None = None) -> list[tuple[float, list[Floats]]]:
        """The lines of each level of the greatest curvature, by default of 1, 2, 5, 10, ... as far as they occur."""
        if len(self.values) < FEWEST:
            return []
        if levels is None:
            levels = round_levels(float(self.values.min()), float(self.values.max()))
        axes = self.lattice()
        heights = np.log(self.on(axes))
        return [(float(level), isolines(heights, float(np.log(level)), axes)) for level in levels]
