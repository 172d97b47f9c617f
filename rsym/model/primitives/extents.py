"""The bounds of a primitive: the box around it with room on every side."""

from __future__ import annotations

from collections.abc import Sequence

from rsym.model.arguments import LetterMapping, Point, default
from rsym.model.shape import Bounds

# Of the largest extent: meshers want the boundary inside the box, not on it.
ROOM = 0.1


def around(low: Sequence[float], high: Sequence[float]) -> Bounds:
    """The box from low to high, a tenth of its largest side wider everywhere.

    Examples
    --------
    >>> around((0, 0), (2, 1))
    ((-0.2, 2.2), (-0.2, 1.2))
    """
    room = ROOM * max(b - a for a, b in zip(low, high, strict=True))
    return tuple((a - room, b + room) for a, b in zip(low, high, strict=True))


def centred(centre: Point, halves: Point, letters: LetterMapping) -> Bounds:
    """The same for centre -+ halves where letters have their defaults."""
    middle = [default(component, letters, "the centre") for component in centre]
    reach = [default(half, letters) for half in halves]
    low = [m - h for m, h in zip(middle, reach, strict=True)]
    return around(low, [m + h for m, h in zip(middle, reach, strict=True)])
