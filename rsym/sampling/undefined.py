"""Where omega has no value in what is looked at: told once for each picture, for there the other parts decide."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from rsym.arrays import Floats
from rsym.backends.interpreter import interpret
from rsym.errors import warn
from rsym.logic.domains import ends_of
from rsym.logic.sign_form import shape_builder
from rsym.logic.steps import is_partial
from rsym.model.recent import recently, written
from rsym.model.shape import Bounds, Shape
from rsym.program.lowering import lower
from rsym.program.program import Program
from rsym.program.raising import raised
from rsym.reports.numbers import point
from rsym.sampling.windows import bounds_or_extent

ALONG = {2: 65, 3: 17}  # points along each axis: what is smaller than some of these cells is no part of a picture
BESIDE = 1e-5  # of a side
HELD = 1 << 22  # values of nodes at a time
LONGEST = 60  # characters of a formula that is told


@dataclass(frozen=True)
class Undefined:
    """A share of a box where omega has no value, a place in its midst, and what is negative there, if that is known."""

    share: float
    place: tuple[float, ...]
    negative: str = ""

    def __str__(self) -> str:
        share = f"{100 * self.share:.2g} %" if self.share < 1 else "all"
        where = f", where {self.negative} is negative" if self.negative else ""
        return (
            f"omega has no value in {share} of the bounds, as near {point(self.place, 3)}{where}: "
            "there the parts that have one decide, and what they leave open is outside"
        )


def warn_undefined(shape: Shape, bounds: Any, letters: Mapping[Any, float] | None = None) -> None:
    """Tell where omega has no value in what is shown or meshed: within bounds, or where the shape is looked at."""
    if _program(shape) is not None:
        found = undefined_in(shape, bounds_or_extent(shape, bounds, letters), letters)
        if found is not None:
            warn(str(found))


def undefined_in(shape: Shape, box: Bounds, letters: Mapping[Any, float] | None = None) -> Undefined | None:
    """Where omega has no value in a box, as points of it show; None where it has one at all of them.

    Examples
    --------
    >>> import rsym, sympy
    >>> from rsym import x, y
    >>> shape = rsym.disc(1) | rsym.Shape(sympy.log(x - 2) - y, (x, y))
    >>> found = undefined_in(shape, ((-2, 3), (-1, 1)))
    >>> round(found.share, 2), found.negative, undefined_in(rsym.disc(1), ((-2, 2), (-2, 2)))
    (0.8, 'x - 2', None)
    """
    program = _program(shape)
    if program is None:
        return None
    count = ALONG[len(box)]
    axes = [low + (high - low) * (np.arange(count) + 0.5) / count for low, high in box]
    points = np.stack([axis.ravel() for axis in np.meshgrid(*axes, indexing="ij")])
    numbers = shape.letters.values_with(letters)

    def at(places: Floats) -> dict[str, Floats]:
        return interpret(program, {**numbers, **dict(zip(program.coordinates, places, strict=True))})

    size = max(1, HELD // len(program.nodes))
    blocks = [points[:, start : start + size] for start in range(0, points.shape[1], size)]
    missing = np.concatenate([np.broadcast_to(np.isnan(at(block)["value"]), block.shape[1:]) for block in blocks])
    # Along lines and planes that points happen to lie on, omega may have none, and has one beside them.
    beside = points[:, missing] + [[BESIDE * (high - low) / math.sqrt(k + 2)] for k, (low, high) in enumerate(box)]
    missing[missing] = np.isnan(np.broadcast_to(at(beside)["value"], beside.shape[1:]))
    if not missing.any():
        return None
    there = points[:, missing]
    middle = there[:, np.argmin(((there - there.mean(axis=1, keepdims=True)) ** 2).sum(axis=0))]
    failing = [text for text, domain in at(middle).items() if domain < 0]
    return Undefined(float(missing.mean()), tuple(middle.tolist()), next(iter(failing), ""))


@recently(16, written)
def _program(shape: Shape) -> Program | None:
    """The value, and what must not be negative for it, by their texts; None where it has a value everywhere."""
    builder = shape_builder(shape)
    value = lower(builder, shape.expression)
    if not is_partial(builder, value):
        return None
    texts = {number: str(raised(builder.nodes, number)) for number in ends_of(builder, value)}
    ends = {text: number for number, text in texts.items() if len(text) <= LONGEST}
    return builder.program({**ends, "value": value})
