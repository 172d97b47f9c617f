"""What is a function of one variable in the columns of cut cells: leaves on their ends, along their heights, and gaps.

In a piece of a cell the base runs along one axis and the height along the other. A *gap* is the difference of two
leaves' heights h over the base: h' = -f_s/f_t.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from rsym.arrays import Flags, Floats, Ints
from rsym.sampling.compiled import loop
from rsym.sampling.rules.division import BoundedFunctions
from rsym.sampling.rules.isolation import Brackets, roots
from rsym.sampling.rules.walks import SAME

NEWTON_STEPS = 7
ASIDE = 2.0**-17 * np.array([0.755, 0.570, 0.431])  # of a size, along no symmetry
# Places over which two leaves are compared, and how many agreements tell that they are one surface. Their steps are of
# no lattice, Kronecker's sequence, so that none of them is on the curve in which leaves cross.
PLACES, AGREED = 16, 4
STEP = np.array([0.7548776662466927, 0.5698402909980532])


def placed(height_axis: Ints, base: Floats, height: Floats) -> Floats:
    """Points (dim, n) with these places (n,), or (2, n) in space, along the base and along the height."""
    places = np.atleast_2d(base)
    points = np.empty((len(places) + 1, places.shape[1]))
    place_points(height_axis, places, np.ascontiguousarray(height), points)
    return points


@loop
def place_points(axis: Any, base: Any, height: Any, points: Any) -> None:
    """The height at its axis, the places of the base at the others, in order."""
    for k in range(points.shape[1]):
        other = 0
        for j in range(points.shape[0]):
            if j == axis[k]:
                points[j, k] = height[k]
            else:
                points[j, k] = base[other, k]
                other += 1


def along(gradient: Floats, axis: Ints) -> Floats:
    """One component of gradients (dim, n), or of their bounds (dim, 2, n)."""
    found: Floats = np.take_along_axis(gradient, axis.reshape(1, *[1] * (gradient.ndim - 2), -1), axis=0)[0]
    return found


def across(gradient: Floats, axis: Ints) -> Floats:
    """The components of gradients (3, n), or of their bounds (3, 2, n), along the base."""
    remaining = np.array([[1, 2], [0, 2], [0, 1]])[axis].T
    return np.take_along_axis(gradient, remaining if gradient.ndim == 2 else remaining[:, None], axis=0)


def smooth_values(functions: BoundedFunctions, leaf: Ints, points: Floats, size: Floats) -> tuple[Floats, Floats]:
    """Values and gradients (dim, n) of leaves, a little aside, by sizes (n,), where there are none: on a crease."""
    value, gradient = functions.evaluate(leaf, points)
    some = np.flatnonzero(~np.isfinite(gradient).all(axis=0))
    if len(some):
        _, gradient[:, some] = functions.evaluate(leaf[some], points[:, some] + ASIDE[:, None] * size[some])
    return value, gradient


@dataclass(frozen=True)
class EndCurves:
    """Leaves along the base, at a fixed height of their piece."""

    functions: BoundedFunctions
    leaf: Ints
    axis: Ints
    height: Floats

    @property
    def tolerance(self) -> float:
        """Of values."""
        return self.functions.tolerance

    def evaluate(self, which: Ints, at: Floats) -> tuple[Floats, Floats]:
        """Values and slopes."""
        axis = self.axis[which]
        value, gradient = self.functions.evaluate(self.leaf[which], placed(axis, at, self.height[which]))
        return value, along(gradient, 1 - axis)

    def enclose(self, which: Ints, lower: Floats, upper: Floats) -> tuple[Floats, Floats]:
        """Bounds of slopes."""
        axis, height = self.axis[which], self.height[which]
        ends = placed(axis, lower, height), placed(axis, upper, height)
        _, gradient = self.functions.enclose(self.leaf[which], *ends)
        least, most = along(gradient, 1 - axis)
        return least, most


@dataclass(frozen=True)
class Risers:
    """Leaves along the height, at a fixed place of the base."""

    functions: BoundedFunctions
    leaf: Ints
    axis: Ints
    base: Floats

    @property
    def tolerance(self) -> float:
        """Of values."""
        return self.functions.tolerance

    def evaluate(self, which: Ints, at: Floats) -> tuple[Floats, Floats]:
        """Values and slopes."""
        axis = self.axis[which]
        value, gradient = self.functions.evaluate(self.leaf[which], placed(axis, self.base[..., which], at))
        return value, along(gradient, axis)

    def distances(self, which: Ints, at: Floats) -> Floats:
        """Values, over the lengths of gradients shorter than 1: near singular points small values count."""
        axis = self.axis[which]
        value, gradient = self.functions.evaluate(self.leaf[which], placed(axis, self.base[..., which], at))
        length = np.sqrt((gradient**2).sum(axis=0))
        found: Floats = value / np.where((length > 0) & (length < 1), length, 1.0)
        return found

    def enclose(self, which: Ints, lower: Floats, upper: Floats) -> tuple[Floats, Floats]:
        """Never asked: they only rise or fall."""
        raise NotImplementedError


def heights(functions: BoundedFunctions, leaf: Ints, axis: Ints, base: Floats, lower: Floats, upper: Floats) -> Floats:
    """Where leaves are zero above places of the base; the nearer end where they keep their sign."""
    curves = Risers(functions, leaf, axis, base)
    every = np.arange(len(leaf))
    below, _ = curves.evaluate(every, lower)
    above, _ = curves.evaluate(every, upper)
    return heights_between(curves, lower, upper, below, above)


def heights_between(curves: Risers, lower: Floats, upper: Floats, below: Floats, above: Floats) -> Floats:
    """The same, given the values at the ends."""
    found = np.where(np.abs(below) <= np.abs(above), lower, upper)
    crossing = np.flatnonzero((below > 0) != (above > 0))
    bracket = Brackets(crossing, *(a[crossing] for a in (lower, upper, below, above)))
    found[crossing] = roots(curves, bracket)
    return found


def coincide(functions: BoundedFunctions, leaf: Ints, axis: Ints, height: Floats, base: Floats) -> Flags:
    """Whether two leaves (2, n) have one surface in a piece, whose height and base go between these (2, ..., n).

    They have if wherever both are met over the base they are met at one height; if they are met over so little of it
    that none of the places is there, the surface is followed beyond the ends of the height.
    """
    met, apart = np.zeros(len(axis), np.int64), np.zeros(len(axis), bool)
    for test in (_met_within, _met_beyond):
        going = np.flatnonzero(~apart & (met == 0))
        for number in range(PLACES):
            if not len(going):
                break
            share = (0.5 + number * STEP[: base.ndim - 1]) % 1
            share = share[0] if base.ndim == 2 else share[:, None]
            place = base[0][..., going] + share * (base[1] - base[0])[..., going]
            there, equal = test(functions, leaf[:, going], axis[going], height[:, going], place)
            met[going] += there & equal
            apart[going] = there & ~equal
            going = going[~apart[going] & (met[going] < AGREED)]
    return ~apart & (met > 0)


def _met_within(
    functions: BoundedFunctions, leaf: Ints, axis: Ints, height: Floats, place: Floats
) -> tuple[Flags, Flags]:
    """Whether both leaves are met over places of the base, and at one height."""
    count = len(axis)
    every, both = np.arange(2 * count), np.tile(np.arange(count), 2)
    curves = Risers(functions, leaf.ravel(), axis[both], np.tile(place, 2))
    lower, upper = height[:, both]
    below, _ = curves.evaluate(every, lower)
    above, _ = curves.evaluate(every, upper)
    one, other = heights_between(curves, lower, upper, below, above).reshape(2, count)
    there: Flags = ((below > 0) != (above > 0)).reshape(2, count).all(axis=0)
    return there, np.abs(one - other) <= SAME * functions.tolerance


def _met_beyond(
    functions: BoundedFunctions, leaf: Ints, axis: Ints, height: Floats, place: Floats
) -> tuple[Flags, Flags]:
    """Whether the first is met over places, not farther from the piece than it is tall, and the other there too."""
    curves, other = (Risers(functions, one, axis, place) for one in leaf)
    every, at = np.arange(len(axis)), height[0] / 2 + height[1] / 2
    reach, left = 1.5 * (height[1] - height[0]), np.full(len(axis), np.inf)
    with np.errstate(all="ignore"):
        for _ in range(NEWTON_STEPS):
            value, slope = curves.evaluate(every, at)
            left = value / slope
            at = at - left
        value, slope = other.evaluate(every, at)
        there = (np.abs(left) <= functions.tolerance) & (np.abs(at - height[0] / 2 - height[1] / 2) <= reach)
        return there, np.abs(value / slope) <= SAME * functions.tolerance


@dataclass(frozen=True)
class Gaps:
    """Differences of the heights of two leaves in the same piece."""

    functions: BoundedFunctions
    leaf: Ints  # (2, n)
    axis: Ints
    lower: Floats
    upper: Floats

    @property
    def tolerance(self) -> float:
        """Of heights."""
        return self.functions.tolerance

    def evaluate(self, which: Ints, at: Floats) -> tuple[Floats, Floats]:
        """Values and slopes."""
        axis, count = np.tile(self.axis[which], 2), len(which)
        base, leaf = np.tile(at, 2), self.leaf[:, which].ravel()
        height = heights(self.functions, leaf, axis, base, np.tile(self.lower[which], 2), np.tile(self.upper[which], 2))
        _, gradient = self.functions.evaluate(leaf, placed(axis, base, height))
        with np.errstate(all="ignore"):
            slope = -along(gradient, 1 - axis) / along(gradient, axis)
        return height[:count] - height[count:], slope[:count] - slope[count:]

    def enclose(self, which: Ints, lower: Floats, upper: Floats) -> tuple[Floats, Floats]:
        """Bounds of slopes."""
        axis = self.axis[which]
        ends = placed(axis, lower, self.lower[which]), placed(axis, upper, self.upper[which])
        one, other = (self.functions.enclose(self.leaf[k, which], *ends)[1] for k in (0, 1))
        return gap_bounds(one, other, axis)


def meetings(gaps: Gaps, brackets: Brackets) -> Floats:
    """Where gaps are zero, once in each bracket: Newton for both leaves at once, else height by height."""
    which, axis = brackets.which, gaps.axis[brackets.which]
    leaf, both = gaps.leaf[:, which].ravel(), np.tile(axis, 2)
    with np.errstate(all="ignore"):
        share = brackets.below / (brackets.below - brackets.above)
        base = brackets.lower + share * (brackets.upper - brackets.lower)
        height = gaps.lower[which] / 2 + gaps.upper[which] / 2
        for _ in range(NEWTON_STEPS):
            places = placed(both, np.tile(base, 2), np.tile(height, 2))
            value, gradient = gaps.functions.evaluate(leaf, places)
            (f, g), (p, q) = value.reshape(2, -1), along(gradient, 1 - both).reshape(2, -1)
            u, v = along(gradient, both).reshape(2, -1)
            across, up = (f * v - g * u) / (p * v - q * u), (p * g - q * f) / (p * v - q * u)
            base, height = base - across, height - up
        near = gaps.tolerance
        good = (np.abs(across) + np.abs(up) <= near) & (base >= brackets.lower - near) & (base <= brackets.upper + near)
        good &= (height >= gaps.lower[which] - near) & (height <= gaps.upper[which] + near)
    bad = np.flatnonzero(~good)
    ends = (brackets.lower, brackets.upper, brackets.below, brackets.above)
    base[bad] = roots(gaps, Brackets(which[bad], *(end[bad] for end in ends)))
    return base


def gap_bounds(one: Floats, other: Floats, axis: Ints) -> tuple[Floats, Floats]:
    """Bounds of the slope of a gap from bounds (2, 2, n) of the gradients of its leaves."""
    (a, b), (c, d) = (_climb(gradient, axis) for gradient in (one, other))
    return a - d, b - c


def _climb(gradient: Floats, axis: Ints) -> tuple[Floats, Floats]:
    """Bounds of -f_s/f_t; infinite where f_t may be zero."""
    (p, q), (u, v) = along(gradient, 1 - axis), along(gradient, axis)
    with np.errstate(all="ignore"):
        ratios = np.stack([-p / u, -p / v, -q / u, -q / v])
    known = (u > 0) | (v < 0)
    return np.where(known, ratios.min(axis=0), -np.inf), np.where(known, ratios.max(axis=0), np.inf)
