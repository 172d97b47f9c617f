"""The bounds of a primitive: the box around it with room on every side."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from rsym.model.arguments import LetterMapping, Point, default
from rsym.model.shape import Bounds

# Of the largest extent: meshers want the boundary inside the box, not on it.
ROOM = 0.1


def box_around(points: Iterable[Sequence[float]]) -> Bounds:
    """The box that holds points, a tenth of its largest side wider everywhere.

    Examples
    --------
    >>> box_around([(0, 0), (2, 1)])
    ((-0.2, 2.2), (-0.2, 1.2))
    """
    ends = [(min(axis), max(axis)) for axis in zip(*points, strict=True)]
    room = ROOM * max(high - low for low, high in ends)
    return tuple((low - room, high + room) for low, high in ends)


def centred(centre: Point, halves: Point, letters: LetterMapping) -> Bounds:
    """The same for centre -+ halves where letters have their defaults."""
    middle = [default(component, letters, "the centre") for component in centre]
    reach = [default(half, letters) for half in halves]
    return box_around([[m + side * h for m, h in zip(middle, reach, strict=True)] for side in (-1, 1)])
