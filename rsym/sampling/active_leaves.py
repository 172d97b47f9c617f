"""Which leaf of a form is active at points: the one that gives its value."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from rsym.arrays import Floats, Ints
from rsym.logic.gates import Gate, through

SAME = 1e-9  # of the largest coordinate: leaves so close are zero at one place


def active_leaf(gates: Sequence[Gate], values: Sequence[Floats] | Floats) -> tuple[Floats, Ints]:
    """The values of a form whose leaves have the values (leaves, n), and the number of the leaf that gives each."""

    def join(gate: Gate, one: tuple[Floats, Ints], other: tuple[Floats, Ints]) -> tuple[Floats, Ints]:
        (f, i), (g, j) = one, other
        take = f <= g if gate.operation == "min" else f >= g
        return np.where(take, f, g), np.where(take, i, j)

    return through(gates, [(row, np.full(len(row), k)) for k, row in enumerate(values)], join)[-1]


def ends_last(values: Floats, walls: Ints, slopes: Floats, points: Floats) -> Floats:
    """Values (leaves, n) by which ends of domains are not active where another leaf is zero as well, to rounding.

    There that leaf bounds, and what has no value beyond is not asked. `slopes` are the gradients of the ends alone.
    """
    later = values.copy()
    with np.errstate(all="ignore"):
        later[walls] += SAME * np.abs(points).max(initial=0.0) * np.linalg.norm(slopes, axis=-1)
    return later
