"""All roots of many functions of one variable, each on an interval of its own: isolated by bounds of their slopes.

A function whose slope is known to keep its sign has at most one root, told by the signs at the ends; one whose value
in the middle is larger than what the slope can make up for has none; other intervals are halved. So two roots close to
each other are found, wherever they lie. What is left of a double root is a very short interval, of which the middle
is given. Nothing here depends on which functions are asked for together.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from rsym.arrays import Floats, Ints
from rsym.sampling.compiled import loop

# Few intervals are parted so often at once: what is left of a double root takes as many steps as one.
FEW, AT_ONCE = 64, 5
HALVINGS = 30  # a double root is then met to half the digits, which is as well as its place is known
MOST = 64  # intervals left of one function at a level: its slope is not bounded
FLAT = 16  # intervals left of one function at a level, all of whose ends are zero: it is zero all along
STEPS = 200
# After a Newton step that is so small, as a part of the bracket, the next is below rounding.
CLOSE, ROUNDING = 1e-10, 4e-16
HASTE = 8  # Newton steps before every third one halves the bracket


class Curves(Protocol):
    """BoundedFunctions of one variable, by their numbers."""

    @property
    def tolerance(self) -> float:
        """A value up to this is zero to rounding."""

    def evaluate(self, which: Ints, at: Floats) -> tuple[Floats, Floats]:
        """Values and slopes."""

    def enclose(self, which: Ints, lower: Floats, upper: Floats) -> tuple[Floats, Floats]:
        """Bounds of slopes."""


@dataclass(frozen=True)
class Brackets:
    """Intervals on which functions change their sign once, and the values at their ends."""

    which: Ints
    lower: Floats
    upper: Floats
    below: Floats
    above: Floats


def isolate(
    curves: Curves, lower: Floats, upper: Floats, below: Floats, above: Floats, least: Floats, most: Floats
) -> tuple[Brackets, Ints, Floats]:
    """Brackets of the roots of functions 0 to n - 1 on their intervals, and functions and places of double roots.

    `below`, `above` are the values at the ends, `least` and `most` bound the slopes. A value within the tolerance
    counts as negative.
    """
    which = np.arange(len(lower))
    found: list[tuple[Ints, ...]] = []
    double: list[tuple[Ints, Floats]] = []
    level = 0
    while True:
        steepest = np.maximum(np.abs(least), np.abs(most))
        tolerance = curves.tolerance * np.minimum(1.0, steepest)
        changes = (below > tolerance) != (above > tolerance)
        done = (least > 0) | (most < 0)
        # No root where the ends are too large for the slope: half the interval from each.
        with np.errstate(invalid="ignore"):  # of places alone, at which slopes are not bounded
            reach = np.where(upper > lower, steepest * (upper - lower), 0.0)
        done |= ~changes & (np.abs(below) + np.abs(above) > reach + 2 * tolerance)
        take = done & changes
        found.append(tuple(a[take] for a in (which, lower, upper, below, above)))
        going = ~done & ~(np.abs(below) + reach <= tolerance)  # zero all along
        rest: Any = [a[going] for a in (which, lower, upper, below, above, least, most)]
        which, lower, upper, below, above, least, most = rest
        if not len(which):
            break
        if level > 0:
            small = np.maximum(np.abs(below), np.abs(above)) <= tolerance[going]
            flat = np.bincount(which)[which] >= FLAT
            flat &= np.bincount(which, ~small)[which] == 0
            changes = changes[going][~flat]
            rest = [a[~flat] for a in (which, lower, upper, below, above)]
            which, lower, upper, below, above = rest
            if not len(which):
                break
        else:
            changes = changes[going]
        crowd = np.bincount(which)[which] > MOST
        if level == HALVINGS or crowd.any():
            last = crowd | (level == HALVINGS)
            take = last & changes
            found.append(tuple(a[take] for a in (which, lower, upper, below, above)))
            double.append((which[last & ~changes], (lower / 2 + upper / 2)[last & ~changes]))
            rest = [a[~last] for a in (which, lower, upper, below, above)]
            which, lower, upper, below, above = rest
            if not len(which):
                break
        several = len(which) <= FEW and level >= AT_ONCE and np.bincount(which).max() <= MOST >> AT_ONCE
        for _ in range(min(AT_ONCE, HALVINGS - level) if several else 1):
            middle = lower / 2 + upper / 2
            between, _ = curves.evaluate(which, middle)
            which = np.tile(which, 2)
            lower, upper = np.concatenate([lower, middle]), np.concatenate([middle, upper])
            below, above = np.concatenate([below, between]), np.concatenate([between, above])
            level += 1
        least, most = curves.enclose(which, lower, upper)
    brackets = Brackets(*(np.concatenate(parts) for parts in zip(*found, strict=True)))
    if not double:
        return brackets, np.empty(0, np.int64), np.empty(0)
    return brackets, np.concatenate([a for a, _ in double]), np.concatenate([b for _, b in double])


def roots(curves: Curves, brackets: Brackets) -> Floats:
    """The root in each bracket, by Newton steps that never leave it; where a value at an end is zero, that end."""
    lower, upper, below, above = (a.copy() for a in (brackets.lower, brackets.upper, brackets.below, brackets.above))
    found = np.where(np.abs(below) <= np.abs(above), lower, upper)
    live = np.flatnonzero(below * np.sign(above) < 0)
    with np.errstate(all="ignore"):
        place = lower - below * ((upper - lower) / (above - below))
    a, b, x = lower[live], upper[live], place[live]
    rising, which = above[live] > 0, brackets.which[live]
    near = np.maximum(CLOSE * (b - a), ROUNDING * np.maximum(np.abs(a), np.abs(b)))
    x = np.where((x >= a) & (x <= b), x, a / 2 + b / 2)  # NaN too
    count = len(live)
    for number in range(STEPS):
        if not count:
            break
        value, slope = curves.evaluate(which[:count], x[:count])
        halved, last = number >= HASTE and number % 3 == 0, number == STEPS - 1
        count = step_to_roots(value, slope, halved, last, live, which, a, b, x, rising, near, found)
    return found


@loop
def step_to_roots(
    value: Any, slope: Any, halved: bool, last: bool, live: Any, which: Any, lower: Any, upper: Any, at: Any,
    rising: Any, near: Any, found: Any,
) -> int:  # fmt: skip
    """A Newton step of each function in its bracket, which closes; those still sought are moved to the front."""
    count = 0
    for k in range(len(value)):
        a, b, x = lower[k], upper[k], at[k]
        if (value[k] > 0) == rising[k]:  # the root is to the left of x
            b = x
        else:
            a = x
        following = x if value[k] == 0 else x - value[k] / slope[k]
        if last or abs(following - x) <= near[k] or b - a <= near[k]:
            found[live[k]] = min(following, b) if following >= a else a
            continue
        if halved or not a <= following <= b:  # NaN too
            following = a / 2 + b / 2
        lower[count], upper[count], at[count] = a, b, following
        live[count], which[count], rising[count], near[count] = live[k], which[k], rising[k], near[k]
        count += 1
    return count
