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
from rsym.sampling.rules.portions import CellGrid, DividedCells, RulePortion, boxed_portion
from rsym.sampling.rules.quadrature import Prepared, grading

TOLERANCE = {2: 1e-12, 3: 1e-10}
CELLS = {2: 8, 3: 6}  # along the longest side at first
# Points along each direction from one rule to the next; in space half up to the usual order: so many points are dear.
ORDERS = 4
HIGHEST = 20  # beyond, cells are halved instead
LEAST_PORTIONS = {2: 0, 3: 8}  # of a rule, that are the same ones for the next order
AT_ONCE = 2e6  # points of a portion of a rule, about
MOST_POINTS = {2: 2e6, 3: 6e6}  # a few seconds
# Where no tolerance is given, and the next rule has more points, so small a relative error is enough.
ENOUGH, CHEAP = 1e-6, 1e6
FALLING = {2: 0.0, 3: 0.5}  # see `Grading`: parts of cells in space are many
FINER = {2: 8, 3: 2}  # times the cells, and one more, of the rule that a first agreement is held against
AT_FIRST = 0.1  # of the time that there is, for what boxes tell
ROUNDING = 4 * np.finfo(np.float64).eps
BOUNDARY = {2: 2e-14, 3: 1e-13}  # of lengths and surfaces, which hang on slopes: twice the worst of a hundred
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
    met: set[int] = set()
    divided: dict[tuple[int, ...], dict[bytes, DividedCells]] = {}  # of the grid in use

    def summed() -> tuple[Sums, int]:
        grid = shape.grid(count, aside=dimension == 3)
        total, made = quantities(nothing), 0
        total = replace(total, rounding=np.zeros_like(total.rounding))  # of what no cell may meet
        number = max(LEAST_PORTIONS[dimension], points * (highest * count / spacing) ** dimension / AT_ONCE)
        if grid.counts not in divided:
            divided.clear()
        known = divided.setdefault(grid.counts, {})
        for portion in shape.portions(grid, highest, towards, threads, number, until, known):
            total += quantities(portion)
            made += len(portion.rule.weights)
            met.update(np.unique(portion.rule.edge_leaf).tolist())
        return total, made

    def compared() -> Refined:
        with np.errstate(invalid="ignore"):  # of sums that are not finite
            now, last, older = np.abs(sums.values - before), np.abs(before - earlier), np.abs(earlier - first)
        apart = _apart(now, last, older, count * highest / along)
        return Refined(sums, before, count, highest, apart)

    def step() -> int:
        return ORDERS // 2 if dimension == 3 and highest < order else ORDERS

    dimension = shape.functions.dimension
    towards = replace(grading(near, dimension), falling=FALLING[dimension])
    least = max(TOLERANCE[dimension] if tolerance is None else tolerance, 2 * ROUNDING)
    # In space a rule of half the order costs an eighth, and is exact where faces are plane.
    count, highest = CELLS[dimension] if cells is None else cells, order if dimension == 2 else max(1, order // 2)
    points, spacing = 0, count * highest
    nothing = DividedCells.of(shape.functions, shape.grid(count), np.arange(0), towards).rule(highest)
    found = _boxed(shape, quantities, shape.grid(count), quantities(nothing), until)
    try:
        sums, points = summed()
        before = earlier = np.full_like(sums.values, np.nan)
        with np.errstate(invalid="ignore"):  # of sums that are not finite
            apart, unresolved = np.abs(sums.values - found.found.values), found.found.unresolved
        found = Refined(replace(sums, unresolved=unresolved), before, count, highest, apart)
        shape.warn_of_cuts(shape.owner[sorted(met)])
        while True:
            first, earlier, before, along = earlier, before, sums.values, count * highest
            spacing = along
            if highest + ORDERS > max(HIGHEST, order + ORDERS):
                count, highest = 2 * count, max(order, HIGHEST - 2 * ORDERS)
            else:
                highest += step()
            sums, points = summed()
            found = compared()
            if not found.improves(least).any():
                finer = FINER[dimension] * count + 1
                if not peaks or (finer / count) ** dimension * points > MOST_POINTS[dimension]:
                    return told(found, points, least)
                first, earlier, before, along = earlier, before, sums.values, count * highest
                spacing = along
                count, highest = finer, order
                sums, points = summed()
                found = compared()
                if not found.improves(least).any():
                    return told(found, points, least)
            following = ((highest + step()) / highest) ** dimension * points
            enough = tolerance is None and following > CHEAP and not found.improves(ENOUGH).any()
            if enough or following > MOST_POINTS[dimension]:
                return told(found, points, least)
    except OutOfTime:
        return _out_of_time(found, points, least)


def _out_of_time(found: Refined, points: int, least: float) -> Refined:
    """What is known when the time is up."""
    if not np.isinf(found.errors).any():
        return told(found, points, least)
    warn(
        "the time was up before two rules were made: of what is inside is known what boxes tell, of the boundary "
        "nothing; timeout= may give more"
    )
    return found


def _boxed(shape: Prepared, quantities: Quantities, grid: CellGrid, nothing: Sums, until: float) -> Refined:
    """What boxes tell where the time is short, else nothing."""
    sums = replace(nothing, unresolved=np.full_like(nothing.values, np.inf))
    if until < math.inf:
        now = time.monotonic()
        sums = quantities(boxed_portion(shape.functions, grid, now + AT_FIRST * max(0.0, until - now)))
    return Refined(sums, sums.values, max(grid.counts), 1, np.zeros_like(sums.values))


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


def _apart(now: Floats, before: Floats, earlier: Floats, growth: float) -> Floats:
    """How far the sum of the finer rule may be off, from the last three differences of sums.

    Where they fall fast it is the last. Where they fall slowly, as powers of the points along a line do, what is still
    to come adds up to more than that, and a small one may be chance.
    """
    slow = (now > SLOW * before) | (before > SLOW * earlier)
    return np.where(slow, np.fmax(now, CHANCE * before) / (growth**POWER - 1), now)
