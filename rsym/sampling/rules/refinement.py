"""Rules refined until two of them agree."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from rsym.arrays import Floats
from rsym.errors import warn
from rsym.sampling.rules.quadrature import Prepared, Quadrature

# What is asked of a rule: numbers, and beside each how large its parts are.
Quantities: TypeAlias = Callable[[Quadrature], tuple[Floats, Floats]]
CELLS = {2: 8, 3: 4}  # along the longest side at first
MOST_POINTS = 2e7  # of the finer rule, for the shape fills its bounds at most
MORE = 4  # points along each direction that the finer rule has more
ROUNDING = 4 * np.finfo(np.float64).eps


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
    """Numbers with estimates of their errors, the finer rule they come from, and its cells along the longest side."""

    values: Floats
    errors: Floats
    rule: Quadrature
    cells: int

    def integral(self, number: int) -> Integral:
        """A number with its error."""
        return Integral(float(self.values[number]), float(self.errors[number]))


def refined(
    shape: Prepared,
    quantities: Quantities,
    *,
    tolerance: float,
    cells: int | None,
    order: int,
    near: ArrayLike | None = None,
    threads: int | None = None,
) -> Refined:
    """Numbers by rules of two orders on the same cells, which are halved until the numbers agree.

    The error is the difference of both, and rounding. Where more points than `MOST_POINTS` would be needed that is
    warned of.
    """
    dimension = shape.functions.dimension
    count = CELLS[dimension] if cells is None else cells
    while True:
        coarse, _ = quantities(shape.rule(count, order, near, threads))
        rule = shape.rule(count, order + MORE, near, threads)
        values, scales = quantities(rule)
        errors = np.abs(values - coarse) + ROUNDING * scales
        open_ones = errors > np.maximum(tolerance, 2 * ROUNDING) * scales
        if not open_ones.any():
            return Refined(values, errors, rule, count)
        if (2 * count * (order + MORE)) ** dimension > MOST_POINTS:
            worst = float((errors / scales)[open_ones].max())
            warn(
                f"an integral is known to a relative error of {worst:.1e} only, at {count} cells along the longest "
                f"side: two rules differ by so much; points near= which it varies fast, or a larger order, may help"
            )
            return Refined(values, errors, rule, count)
        count *= 2
