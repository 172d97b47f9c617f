"""Enclosures of the fields of a shape over boxes, outward: what is true of every point of a box at once."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from rsym.arrays import Floats
from rsym.bounds.intervals import Bounds, IntervalFunction
from rsym.errors import RsymError
from rsym.model.letters import Letters, exact_number, mapping_of, real_number
from rsym.model.requirements import require_shape
from rsym.model.shape import Shape
from rsym.program.fields import checked_fields, gather, program_of
from rsym.program.program import Program

Range: TypeAlias = tuple[Fraction, Fraction]
BITS = 64  # rounding then costs a thousandth of what the last place of float64 is worth


def enclose(
    shape: Shape,
    boxes: ArrayLike,
    fields: Sequence[str] = ("value",),
    *,
    letters: Mapping[Any, Any] | None = None,
    backend: str = "ball",
) -> dict[str, Floats]:
    """Intervals that contain every value of fields over boxes.

    For a box B and letters in their ranges L: low <= field(p, l) <= high for all p in B and l in L where the
    field is defined. R-operations, trimming and normalisation count by their exact images, so the bounds are
    sharp up to what subexpressions have in common.

    Parameters
    ----------
    shape : Shape
        What to enclose.
    boxes : array_like (..., dim, 2)
        The lower and the upper end of each side, finite.
    fields : sequence of str
        As in `compile`, but for ``singular``.
    letters : mapping, optional
        Names or symbols to numbers or to pairs (low, high); the others have their defaults.
    backend : {"ball", "interval"}
        ``ball`` works with python-flint at 64 bits, box by box. ``interval`` works in compiled float64, a hundred
        times as fast; its bounds are a few units in the last place wider, and it never says "undefined".

    Returns
    -------
    dict of str to array
        Low and high ends, rounded outward to float64: (..., 2) for scalar fields, gradient (..., dim, 2),
        hessian (..., dim, dim, 2). NaN where a field is certainly undefined all over the box; infinite ends where
        no bound is known, as beside a division by 0.

    Raises
    ------
    RsymError
        For boxes that are not of this shape or have their ends reversed, an unknown field, letter or backend,
        or if python-flint cannot be imported.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> disc = rsym.Shape(1 - x**2 - y**2, (x, y))
    >>> bounds = rsym.enclose(disc, [[-0.5, 0.5], [0.0, 0.25]], ("value", "gradient"))
    >>> bounds["value"].round(6).tolist()
    [0.6875, 1.0]
    >>> bounds["gradient"].round(6).tolist()
    [[-1.0, 1.0], [-0.5, 0.0]]
    """
    require_shape(shape)
    names = checked_fields(fields)
    if "singular" in names:
        raise RsymError("the field 'singular' is not a number", code="unknown-field", remedy="enclose the gradient")
    if backend not in BACKENDS:
        raise RsymError(f"no backend {backend!r}", code="unknown-backend", remedy=f"choose from {', '.join(BACKENDS)}")
    lower, upper = _ends(shape, boxes)
    program = program_of(shape, names)
    bounds = BACKENDS[backend](program, lower, upper, ranges_of(shape.letters, letters))
    ends = [gather({part: pair[k] for part, pair in bounds.items()}, names, shape.dimension) for k in (0, 1)]
    return {name: np.stack([end[name] for end in ends], axis=-1) for name in names}


def ranges_of(letters: Letters, changes: Mapping[Any, Any] | None) -> dict[str, Range]:
    """The range of every letter, exactly: numbers are ranges of one point.

    Examples
    --------
    >>> from rsym.model.letters import as_letters
    >>> ranges_of(as_letters({"a": 5, "b": 6}), {"a": (5.25, 8)})
    {'a': (Fraction(21, 4), Fraction(8, 1)), 'b': (Fraction(6, 1), Fraction(6, 1))}
    """
    pairs = {str(key): _pair(str(key), value) for key, value in mapping_of(changes).items()}
    for end in (0, 1):
        letters.values_with({name: pair[end] for name, pair in pairs.items()})
    known = {name: (letter.fraction, letter.fraction) for name, letter in letters.items()} | pairs
    return {name: (Fraction(low), Fraction(high)) for name, (low, high) in known.items()}


def _pair(name: str, value: Any) -> tuple[Any, Any]:
    """The two ends of what a letter was given."""
    what = f"the letter {name!r}"
    if not isinstance(value, tuple | list):
        return (real_number(value, what),) * 2
    if len(value) != 2:
        raise RsymError(f"the range of {name} must be a pair, got {value!r}", code="number", remedy="(low, high)")
    low, high = (real_number(end, what) for end in value)
    if low > high:
        raise RsymError(f"the range of {name} is empty: {low} > {high}", code="number", remedy="(low, high)")
    ends = [exact_number(end, what) for end in value]
    beyond = [math.nextafter(end, way) for end, way in ((low, -math.inf), (high, math.inf))]
    first, last = (
        end if isinstance(end, int | float | Fraction) else wide for end, wide in zip(ends, beyond, strict=True)
    )
    return first, last


def _ends(shape: Shape, boxes: ArrayLike) -> tuple[Floats, Floats]:
    """The lower and the upper ends, (..., dim) each."""
    array = np.asarray(boxes, np.float64)
    if array.ndim < 2 or array.shape[-2:] != (shape.dimension, 2):
        raise RsymError(
            f"boxes must have the shape (..., {shape.dimension}, 2), got {array.shape}",
            code="array",
            remedy="give each side as (low, high)",
        )
    if not np.isfinite(array).all() or (array[..., 0] > array[..., 1]).any():
        raise RsymError("the sides of a box must be finite, the lower end first", code="array")
    return array[..., 0], array[..., 1]


def _in_intervals(program: Program, lower: Floats, upper: Floats, letters: Mapping[str, Range]) -> Bounds:
    """The bounds of the outputs, by the interval backend."""
    return IntervalFunction(program)(list(np.moveaxis(lower, -1, 0)), list(np.moveaxis(upper, -1, 0)), letters)


def _in_balls(program: Program, lower: Floats, upper: Floats, letters: Mapping[str, Range]) -> Bounds:
    """The bounds of the outputs, by the ball backend."""
    from rsym.bounds.balls import BallFunction, arb, ball, ctx, exact  # python-flint may be missing

    function = BallFunction(program.nodes, [number for _, number in program.outputs])
    bounds = np.empty((len(function.outputs), 2, *lower.shape[:-1]))
    with ctx.workprec(BITS):
        inputs = {name: ball(exact(low), exact(high)) for name, (low, high) in letters.items()}
        for index in np.ndindex(lower.shape[:-1]):
            for name, low, high in zip(program.coordinates, lower[index], upper[index], strict=True):
                inputs[name] = ball(arb(float(low)), arb(float(high)))
            bounds[(slice(None), slice(None), *index)] = [_floats(value) for value in function(inputs)]
    return {name: (low, high) for (name, _), (low, high) in zip(program.outputs, bounds, strict=True)}


def _floats(value: Any) -> tuple[float, float]:
    """The ends of a ball, each rounded outward; NaN for no ball."""
    return (math.nan, math.nan) if value is None else (_below(value.lower()), -_below(-value.upper()))


def _below(point: Any) -> float:
    """The largest float64 that is not above a point."""
    value = float(point)
    return value if value <= point else math.nextafter(value, -math.inf)


BACKENDS = {"ball": _in_balls, "interval": _in_intervals}
