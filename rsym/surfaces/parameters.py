"""Parameters: arrays of numbers in an interval that may be closed."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from rsym.arrays import Floats
from rsym.errors import RsymError

Interval: TypeAlias = tuple[float, float]
LetterValues: TypeAlias = Mapping[Any, float] | None

# Parameters this share of the interval outside of it are rounding, and moved to its end.
ROUNDING = 1e-12


def real_array(given: ArrayLike) -> Floats:
    """Float64 numbers, a copy of none that are. TypeError or ValueError for others: NumPy only warns of complex ones.

    Examples
    --------
    >>> real_array([1, 2]).tolist()
    [1.0, 2.0]
    """
    array = np.asarray(given)
    if np.iscomplexobj(array):
        raise TypeError("complex numbers")
    return array.astype(np.float64, copy=False)


def parameter_arrays(*given: ArrayLike) -> list[Floats]:
    """Float64 arrays that broadcast against each other, in the shapes given."""
    try:
        arrays = [real_array(one) for one in given]
    except (TypeError, ValueError) as error:
        raise RsymError(
            "parameters must be real arrays", code="array", remedy="give numbers, or arrays of one shape"
        ) from error
    try:
        np.broadcast_shapes(*(one.shape for one in arrays))
    except ValueError as error:
        shapes = " and ".join(str(one.shape) for one in arrays)
        raise RsymError(
            f"parameters of the shapes {shapes} do not broadcast",
            code="array",
            remedy="use patch.grid(u, v) for vectors of different length",
        ) from error
    return arrays


def as_interval(given: Any, what: str) -> Interval:
    """A pair of finite increasing numbers.

    Examples
    --------
    >>> as_interval((0, 2), "u")
    (0.0, 2.0)
    """
    try:
        low, high = (float(end) for end in given if not isinstance(end, str))
    except (TypeError, ValueError):
        low = high = math.nan
    if not (math.isfinite(low) and math.isfinite(high) and low < high):
        raise RsymError(
            f"the interval of {what} must be a pair (low, high) of finite numbers, got {given!r}",
            code="domain",
            remedy="for example (0, 1)",
        )
    return low, high


def wrapped(values: Floats, interval: Interval) -> Floats:
    """The values modulo the length of an interval, from its lower end on.

    Examples
    --------
    >>> wrapped(np.array([-0.25, 1.0]), (0.0, 1.0)).tolist()
    [0.75, 0.0]
    """
    low, high = interval
    return np.asarray(low + np.mod(values - low, high - low))


def inside(values: Floats, interval: Interval, closed: bool, name: str) -> Floats:
    """The values in the interval: modulo its length if it is closed, otherwise refused if they lie outside.

    Examples
    --------
    >>> inside(np.array([-0.25, 1.5]), (0.0, 1.0), True, "u").tolist()
    [0.75, 0.5]
    """
    low, high = interval
    if closed:
        # The upper end stays where it is, so that a closed grid ends where it should.
        return np.where((values >= low) & (values <= high), values, wrapped(values, interval))
    if not values.size or (values.min() >= low and values.max() <= high):
        return values
    room = ROUNDING * (high - low)
    outside = (values < low - room) | (values > high + room)
    if outside.any():
        raise RsymError(
            f"{name} must lie in [{low:g}, {high:g}], got {values[outside].flat[0]:.17g}",
            code="domain",
            remedy=f"the ends are patch.domain; {int(outside.sum())} of {values.size} values lie outside",
        )
    return np.clip(values, low, high)
