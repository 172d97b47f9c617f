"""Rules refined until two of them agree."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from rsym.arrays import Flags, Floats
from rsym.errors import warn
from rsym.sampling.rules.portions import RulePortion
from rsym.sampling.rules.quadrature import Prepared

# What is asked of a part of a rule: sums, and the sums of the absolute values of what is added.
Quantities: TypeAlias = Callable[[RulePortion], tuple[Floats, Floats]]
TOLERANCE = {2: 1e-12, 3: 1e-10}
CELLS = {2: 8, 3: 6}  # along the longest side at first
ORDERS = 4  # points along each direction from one rule to the next
HIGHEST = 20  # beyond, cells are halved instead
MOST_POINTS = {2: 2e6, 3: 3e7}  # some seconds
FINER = {2: 8, 3: 2}  # times the cells, and one more, of the rule that a first agreement is held against
ROUNDING = 4 * np.finfo(np.float64).eps
# Differences that fall no faster than this fall as a power of the points along a line: this one at worst,
# as at the root of a distance to a line. By chance one may be smaller than its like by so much.
SLOW, POWER, CHANCE = 0.03, 0.5, 0.125


class Integral(float):
    """The value of an integral, a float, with `.error`: how far two rules, or rounding, leave it open; an estimate.

    Examples
    --------
    >>> value = Integral(2.0, 1e-14)
    >>> value + 1, value.error, value
    (3.0, 1e-14, Integral(2.0, error=1e-14))
    """

    error: float

    def __new__(cls, value: float, error: float) -> Integral:
        """A value and its error."""
        made = super().__new__(cls, value)
        made.error = error
        return made

    def __repr__(self) -> str:
        return f"Integral({float(self)!r}, error={self.error:.2g})"

    def __str__(self) -> str:
        return repr(float(self))

    def __reduce__(self) -> tuple[type[Integral], tuple[float, float]]:
        return Integral, (float(self), self.error)


@dataclass(frozen=True)
class Refined:
    """Sums by two rules, the better one first, and how large they can be; cells and order of the better one.

    `apart`: how far the better one may be off but for rounding.
    """

    sums: Floats
    before: Floats
    scales: Floats
    cells: int
    order: int
    apart: Floats

    def beyond(self, tolerance: float) -> Flags:
        """Which errors are not within a tolerance, relative to the scales."""
        return ~(self.errors <= tolerance * self.scales) | np.isinf(self.errors)

    @property
    def errors(self) -> Floats:
        """Of the sums; infinite where one is not finite, so that no comparison takes it for small."""
        with np.errstate(invalid="ignore"):
            apart = self.apart + ROUNDING * self.scales
        return np.where(np.isfinite(apart), apart, np.inf)

    def integral(self, number: int) -> Integral:
        """A sum with its error."""
        return Integral(float(self.sums[number]), float(self.errors[number]))


def refined(
    shape: Prepared,
    quantities: Quantities,
    *,
    tolerance: float | None,
    cells: int | None,
    order: int,
    near: ArrayLike | None = None,
    threads: int | None = None,
    peaks: bool = False,
) -> Refined:
    """Sums over rules of rising order, then on smaller cells, until two agree; what they leave open is warned of.

    Where what is added may have `peaks` that all points of these cells miss, a rule on other and smaller cells has to
    agree too.
    """
    met: set[int] = set()

    def summed() -> tuple[Floats, Floats, int]:
        total, scale, points = np.zeros(1), np.zeros(1), 0
        for portion in shape.portions(shape.grid(count), highest, near, threads):
            value, size = quantities(portion)
            total, scale = total + value, scale + size
            points += len(portion.rule.weights)
            met.update(np.unique(portion.rule.edge_leaf).tolist())
        return total, scale, points

    def compared() -> Refined:
        with np.errstate(invalid="ignore"):  # of sums that are not finite
            now, last, older = np.abs(sums - before), np.abs(before - earlier), np.abs(earlier - first)
        return Refined(sums, before, scales, count, highest, _apart(now, last, older, count * highest / along))

    dimension = shape.functions.dimension
    least = max(TOLERANCE[dimension] if tolerance is None else tolerance, 2 * ROUNDING)
    count, highest = CELLS[dimension] if cells is None else cells, order
    sums, scales, points = summed()
    before = earlier = np.full_like(sums, np.nan)
    shape.warn_of_cuts(shape.owner[sorted(met)])
    while True:
        first, earlier, before, along = earlier, before, sums, count * highest
        if highest + ORDERS > max(HIGHEST, order + ORDERS):
            count, highest = 2 * count, max(order, HIGHEST - 2 * ORDERS)
        else:
            highest += ORDERS
        sums, scales, points = summed()
        found = compared()
        open_ones = found.beyond(least)
        if not open_ones.any():
            finer = FINER[dimension] * count + 1
            if not peaks or (finer / count) ** dimension * points > MOST_POINTS[dimension]:
                return found
            first, earlier, before, along = earlier, before, sums, count * highest
            count, highest = finer, order
            sums, scales, points = summed()
            found = compared()
            open_ones = found.beyond(least)
            if not open_ones.any():
                return found
        if ((highest + ORDERS) / highest) ** dimension * points > MOST_POINTS[dimension]:
            if np.isinf(found.errors).any():
                warn(f"an integral is not known: on rules of {points:.1e} points it is no finite number")
                return found
            worst = float((found.errors / scales)[open_ones].max())
            warn(
                f"an integral is known to a relative error of about {worst:.0e}: so much do rules of {points:.1e} "
                "points differ; near= points where the function or the boundary varies fast may help"
            )
            return found


def _apart(now: Floats, before: Floats, earlier: Floats, growth: float) -> Floats:
    """How far the sum of the finer rule may be off, from the last three differences of sums.

    Where they fall fast it is the last. Where they fall slowly, as powers of the points along a line do, what is still
    to come adds up to more than that, and a small one may be chance.
    """
    slow = (now > SLOW * before) | (before > SLOW * earlier)
    return np.where(slow, np.fmax(now, CHANCE * before) / (growth**POWER - 1), now)
