"""Boxes that hold what is of interest: pairs of numbers, one for each coordinate."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, TypeAlias

from rsym.errors import RsymError

Bounds: TypeAlias = tuple[tuple[float, float], ...]


def checked_bounds(bounds: Any, dimension: int) -> Bounds:
    """Bounds as pairs of floats; what is not so many finite, increasing pairs is refused.

    Examples
    --------
    >>> checked_bounds([[0, 1], [-2, 2]], 2)
    ((0.0, 1.0), (-2.0, 2.0))
    """
    try:
        box = tuple((float(low), float(high)) for low, high in bounds)
    except (TypeError, ValueError) as error:
        raise RsymError(f"bounds must be pairs (low, high), got {bounds!r}", code="bounds") from error
    if len(box) != dimension or not all(math.isfinite(a) and math.isfinite(b) and a < b for a, b in box):
        raise RsymError(
            f"bounds must be {dimension} finite pairs with low < high, got {bounds!r}",
            code="bounds",
            remedy="for example ((-1, 1), (-1, 1))",
        )
    return box


def hull(boxes: Sequence[Bounds]) -> Bounds | None:
    """The box around boxes; None around none.

    Examples
    --------
    >>> hull([((0, 1), (0, 1)), ((-1, 0), (0, 2))])
    ((-1, 1), (0, 2))
    """
    if not boxes:
        return None
    return tuple((min(low for low, _ in axis), max(high for _, high in axis)) for axis in zip(*boxes, strict=True))
