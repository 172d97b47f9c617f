"""Rules refined until two of them agree."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from rsym.arrays import Flags, Floats
from rsym.errors import warn
from rsym.sampling.rules.deadlines import OutOfTime
from rsym.sampling.rules.division import Grading
from rsym.sampling.rules.portions import DividedCells, RulePortion, boxed_portion
from rsym.sampling.rules.quadrature import Prepared, grading

TOLERANCE = {2: 1e-12, 3: 1e-10}
CELLS = {2: 8, 3: 6}  # along the longest side at first
ORDERS = 4  # points along each direction from one rule to the next
HIGHEST = 20  # beyond, cells are halved instead
LEAST_PORTIONS = {2: 0, 3: 8}  # of a rule, that are the same ones for the next order
AT_ONCE = 2e6  # points of a portion of a rule, about
MOST_POINTS = {2: 2e6, 3: 6e6}  # a few seconds
ENOUGH = {2: 0.0, 3: 1.0}  # see `Grading`, in tolerances: a cell has a hundredth of all faces, or less
FALLING = {2: 0.0, 3: 0.5}  # see `Grading`: parts of cells in space are many
FINER = {2: 8, 3: 2}  # times the cells, and one more, of the rule that a first agreement is held against
AT_FIRST = 0.1  # of the time that there is, for what boxes tell
ROUNDING = 4 * np.finfo(np.float64).eps
BOUNDARY = {2: 2e-14, 3: 1e-13}  # of lengths and surfaces, which hang on slopes: twice the worst of a hundred
# Differences that fall no faster than this fall as a power of the points along a line: this one at worst,
# as at the root of a distance to a line. By chance one may be smaller than its like by so much.
SLOW, POWER, CHANCE = 0.03, 0.5, 0.125
REMEMBERED = 4  # sums before the last


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
class Sums:
    """Sums over a rule, how large they are without signs, and how far they may be off for what is known of a rule.

    `unresolved`: because it may be wrong in places; `rounding`: because points of its boundary are rounded.
    """

    values: Floats
    scales: Floats
    unresolved: Floats
    rounding: Floats

    def __add__(self, other: Sums) -> Sums:
        return Sums(*(getattr(self, name) + getattr(other, name) for name in Sums.__dataclass_fields__))


Quantities: TypeAlias = Callable[[RulePortion], Sums]  # what is asked of a part of a rule


def boundary_rounding(shape: Prepared, measure: float) -> float:
    """How far a length or surface may be off for rounding: of what there is, and of where there is none."""
    dimension, size = shape.functions.dimension, max(high - low for low, high in shape.box)
    return BOUNDARY[dimension] * (measure + float(size ** (dimension - 1)))


@dataclass(frozen=True)
class Refined:
    """Sums by two rules, the better one first; cells and order of the better one.

    `apart`: how far the better one may be off but for rounding, and but for what is `unresolved`.
    """

    found: Sums
    before: Floats
    cells: int
    order: int
    apart: Floats

    def beyond(self, tolerance: float) -> Flags:
        """Which errors are not within a tolerance, relative to the scales."""
        most = tolerance * self.found.scales + self.found.rounding
        return ~(self.apart + self.found.unresolved <= most) | np.isinf(self.errors)

    def improves(self, tolerance: float) -> Flags:
        """Which errors are not, and are no less than what is unresolved, which is the same for any order."""
        return self.beyond(tolerance) & ~(
            self.apart <= np.maximum(self.found.unresolved, tolerance * self.found.scales)
        )

    @property
    def errors(self) -> Floats:
        """Of the sums; infinite where one is not finite, so that no comparison takes it for small."""
        with np.errstate(invalid="ignore"):
            apart = self.apart + self.found.unresolved + self.found.rounding + ROUNDING * self.found.scales
        return np.where(np.isfinite(apart), apart, np.inf)

    def integral(self, number: int) -> Integral:
        """A sum with its error."""
        return Integral(float(self.found.values[number]), float(self.errors[number]))


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
    until: float = math.inf,
) -> Refined:
    """Sums over rules of rising order, then on smaller cells, until two agree; what they leave open is warned of.

    When the time is up, on the monotonic clock, what two rules have told by then is returned; one alone is held against
    boxes, of which it is proved whether they are inside, and of its boundary nothing is known: the error is infinite.
    Where what is added may have `peaks` that all points of these cells miss, a rule on other and smaller cells has to
    agree too.
    """
    dimension = shape.functions.dimension
    least = max(TOLERANCE[dimension] if tolerance is None else tolerance, 2 * ROUNDING)
    towards = replace(grading(near, dimension), falling=FALLING[dimension], enough=ENOUGH[dimension] * least)
    # In space a rule of half the order costs an eighth, and is exact where faces are plane.
    count, highest = CELLS[dimension] if cells is None else cells, order if dimension == 2 else max(1, order // 2)
    rules = _Rules(shape, quantities, towards, threads, until)
    found = rules.boxed(count, highest)
    try:
        found = rules.first(found, count, highest)
        while True:
            if highest + ORDERS > max(HIGHEST, order + ORDERS):
                count, highest = 2 * count, max(order, HIGHEST - 2 * ORDERS)
            else:
                highest += ORDERS
            found = rules.compared(count, highest)
            if not found.improves(least).any():
                finer = FINER[dimension] * count + 1
                if not peaks or (finer / count) ** dimension * rules.points > MOST_POINTS[dimension]:
                    return told(found, rules.points, least)
                count, highest = finer, order
                found = rules.compared(count, highest)
                if not found.improves(least).any():
                    return told(found, rules.points, least)
            if ((highest + ORDERS) / highest) ** dimension * rules.points > MOST_POINTS[dimension]:
                return told(found, rules.points, least)
    except OutOfTime:
        return _out_of_time(found, rules.points, least)


class _Rules:
    """Sums over one rule after the other, each held against those before; `points` of the last."""

    def __init__(
        self, shape: Prepared, quantities: Quantities, near: Grading, threads: int | None, until: float
    ) -> None:
        self._shape, self._quantities, self._near, self._threads, self._until = shape, quantities, near, threads, until
        self._divided: dict[tuple[int, ...], dict[bytes, DividedCells]] = {}  # cells of the grid in use
        self._met: set[int] = set()
        self._values: list[Floats] = []
        self._along = self.points = 0

    def boxed(self, count: int, order: int) -> Refined:
        """What boxes tell where the time is short, else nothing."""
        grid, functions = self._shape.grid(count), self._shape.functions
        self._nothing = self._quantities(DividedCells.of(functions, grid, np.arange(0), self._near).rule(order))
        sums = replace(self._nothing, unresolved=np.full_like(self._nothing.values, np.inf))
        if self._until < math.inf:
            now = time.monotonic()
            sums = self._quantities(boxed_portion(functions, grid, now + AT_FIRST * max(0.0, self._until - now)))
        return Refined(sums, sums.values, max(grid.counts), 1, np.zeros_like(sums.values))

    def first(self, boxed: Refined, count: int, order: int) -> Refined:
        """The first sums, held against what boxes tell."""
        sums = self._summed(count, order)
        with np.errstate(invalid="ignore"):  # of sums that are not finite
            apart = np.abs(sums.values - boxed.found.values)
        self._shape.warn_of_cuts(self._shape.owner[sorted(self._met)])
        unknown = np.full_like(sums.values, np.nan)
        self._values = [sums.values, *[unknown] * REMEMBERED]
        return Refined(replace(sums, unresolved=boxed.found.unresolved), unknown, count, order, apart)

    def compared(self, count: int, order: int) -> Refined:
        """The next sums, held against those before."""
        along = self._along
        sums = self._summed(count, order)
        self._values = [sums.values, *self._values[:REMEMBERED]]
        with np.errstate(invalid="ignore"):  # of sums that are not finite
            steps = np.abs(np.diff(self._values, axis=0))
        return Refined(sums, self._values[1], count, order, _apart(steps, count * order / along))

    def _summed(self, count: int, order: int) -> Sums:
        dimension = self._shape.functions.dimension
        grid = self._shape.grid(count, aside=dimension == 3)
        total, made = replace(self._nothing, rounding=np.zeros_like(self._nothing.rounding)), 0
        number = self.points * (order * count / self._along) ** dimension / AT_ONCE if self._along else 0.0
        if grid.counts not in self._divided:
            self._divided.clear()
        known = self._divided.setdefault(grid.counts, {})
        least = max(LEAST_PORTIONS[dimension], number)
        for portion in self._shape.portions(grid, order, self._near, self._threads, least, self._until, known):
            total += self._quantities(portion)
            made += len(portion.rule.weights)
            self._met.update(np.unique(portion.rule.edge_leaf).tolist())
        self.points, self._along = made, order * count
        return total


def _out_of_time(found: Refined, points: int, least: float) -> Refined:
    """What is known when the time is up."""
    if not np.isinf(found.errors).any():
        return told(found, points, least)
    warn(
        "the time was up before two rules were made: of what is inside is known what boxes tell, of the boundary "
        "nothing; timeout= may give more"
    )
    return found


def told(found: Refined, points: int, least: float) -> Refined:
    """The sums; what they leave open beyond a tolerance is warned of."""
    if np.isinf(found.errors).any():
        warn(f"an integral is not known: on rules of {points:.1e} points it is no finite number")
    elif (over := found.beyond(least)).any():
        with np.errstate(divide="ignore"):
            worst = float((found.errors[over] / found.found.scales[over]).max())
        if found.improves(least).any():
            why = (
                f"so much do rules of {points:.1e} points differ; near= points where the function or the boundary "
                "varies fast may help"
            )
        else:
            why = "so much is not resolved where its boundary has cusps or nodes, touches itself, or is hardly one"
        warn(f"an integral is known to a relative error of about {worst:.0e}: {why}")
    return found


def _apart(steps: Floats, growth: float) -> Floats:
    """How far the sum of the finer rule may be off, from the last differences of sums, the newest first.

    Where they fall fast it is that one. Where they fall slowly, as powers of the points along a line do, what is still
    to come adds up to more than that, and a small one may be chance, or two.
    """
    now, before = steps[:2]
    slow = (steps[:-1] > SLOW * steps[1:]).any(axis=0)
    apart: Floats = np.where(slow, np.fmax(now, CHANCE * before) / (growth**POWER - 1), now)
    return apart
