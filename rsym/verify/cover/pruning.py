"""Pruning: which of many boxes certainly hold no zero, by interval arithmetic in float64 over all of them at once."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence

import numpy as np

from rsym.bounds.intervals import IntervalFunction
from rsym.model.shape import Shape
from rsym.program.builder import Builder
from rsym.program.lowering import lower
from rsym.verify.boxes.local import Box, Interval

Prune = Callable[[Sequence[Box]], Sequence[bool]]


def bounds_of_omega(shape: Shape, axes: Sequence[str], letters: Iterable[str]) -> IntervalFunction:
    """Omega over boxes with sides along the axes; letters that range are axes."""
    builder = Builder(tuple(symbol.name for symbol in shape.coordinates), tuple(letters))
    program = builder.program({"value": lower(builder, shape.expression)})
    return IntervalFunction(program.varying(axes[2:]), "numpy", 1)


def pruner(function: IntervalFunction, axes: Sequence[str], letters: Mapping[str, Interval]) -> Prune:
    """A function of boxes, with sides along the axes, that is true for those on which omega is not zero anywhere.

    Letters that range are axes: each box has its own part of the range.
    """
    fixed = {name: value for name, value in letters.items() if name not in axes}

    def prune(boxes: Sequence[Box]) -> Sequence[bool]:
        ends = np.array(boxes, dtype=np.float64)
        low, high = function(list(ends[..., 0].T), list(ends[..., 1].T), fixed)["value"]
        empty: list[bool] = ((low > 0) | (high < 0)).tolist()
        return empty

    return prune
