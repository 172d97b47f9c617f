"""Closed outlines of straight edges: corners in counterclockwise order, refused where the outline is not simple."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import TypeAlias

from rsym.errors import RsymError

Place: TypeAlias = tuple[float, float]
# What is nearer to a line than this was meant to be on it, in parts of the extent and of the largest coordinate, to
# which coordinates are rounded (1e-16) and so their sums and turned copies (a few times that).
NEAR = 1e-12
ROUNDED = 2e-15


def cross(a: Place, b: Place, c: Place) -> float:
    """Twice the area of the triangle a, b, c, positive counterclockwise."""
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def nearness(places: Sequence[Place]) -> float:
    """The distance below which a point is on a line."""
    extent: float = max(max(axis) - min(axis) for axis in zip(*places, strict=True))
    largest = max(abs(coordinate) for place in places for coordinate in place)
    return NEAR * extent + ROUNDED * largest


def area(places: Sequence[Place]) -> float:
    """The area inside, negative where the corners go clockwise.

    Examples
    --------
    >>> area([(0, 0), (2, 0), (0, 3)])
    3.0
    """
    total: float = sum(cross(places[0], b, c) for b, c in pairwise(places[1:]))
    return total / 2


def aligned(a: Place, b: Place, c: Place, near: float) -> bool:
    """Whether three points lie on one line."""
    return abs(cross(a, b, c)) <= near * max(math.dist(a, b), math.dist(b, c))


def ahead(a: Place, b: Place, c: Place, d: Place) -> bool:
    """Whether the ways from a to b and from c to d have a common direction."""
    return (b[0] - a[0]) * (d[0] - c[0]) + (b[1] - a[1]) * (d[1] - c[1]) > 0


def straight(a: Place, b: Place, c: Place, near: float) -> bool:
    """Whether the way from a over b to c does not turn at b; a way that turns back is refused.

    Examples
    --------
    >>> straight((0, 0), (1, 1), (3, 3), 1e-12)
    True
    """
    if not aligned(a, b, c, near):
        return False
    if not ahead(a, b, b, c):
        raise RsymError(
            f"the outline turns back on itself at {shown(b)}",
            code="polygon",
            remedy="leave out the spike",
        )
    return True


def check_simple(places: Sequence[Place]) -> None:
    """Refuse an outline that crosses or touches itself.

    Raises
    ------
    RsymError
        With the two edges that meet.

    Examples
    --------
    >>> check_simple([(0, 0), (2, 0), (2, 1), (0, 1)])
    """
    near = nearness(places)
    for first, second in _close_edges(places, near):
        a, b, c, d = (places[(edge + step) % len(places)] for edge in (first, second) for step in (0, 1))
        if _meet(a, b, c, d, near):
            raise RsymError(
                f"the outline must not cross or touch itself, but the edges from {shown(a)} to {shown(b)} "
                f"and from {shown(c)} to {shown(d)} meet",
                code="polygon",
                remedy="give the corners in their order along the boundary; two shapes that touch are two polygons",
            )


def _close_edges(places: Sequence[Place], near: float) -> Iterator[tuple[int, int]]:
    """Pairs of edges without a common corner whose boxes overlap, met from left to right."""
    count = len(places)
    boxes = []
    for edge, (a, b) in enumerate(zip(places, (*places[1:], places[0]), strict=True)):
        (left, right), (low, high) = (sorted(axis) for axis in zip(a, b, strict=True))
        boxes.append((left, right + near, low, high + near, edge))
    boxes.sort()
    for position, (_, right, low, high, edge) in enumerate(boxes):
        for left, _, other_low, other_high, other in boxes[position + 1 :]:
            if left > right:
                break
            apart = other_low > high or low > other_high
            if not apart and (edge - other) % count not in (1, count - 1):
                yield edge, other


def _meet(a: Place, b: Place, c: Place, d: Place, near: float) -> bool:
    if cross(a, b, c) * cross(a, b, d) < 0 and cross(c, d, a) * cross(c, d, b) < 0:
        return True
    ends = ((a, c, d), (b, c, d), (c, a, b), (d, a, b))
    return any(_distance(*three) <= near for three in ends)


def _distance(p: Place, a: Place, b: Place) -> float:
    """From a point to an edge."""
    along = (b[0] - a[0], b[1] - a[1])
    share = ((p[0] - a[0]) * along[0] + (p[1] - a[1]) * along[1]) / (along[0] ** 2 + along[1] ** 2)
    share = min(1.0, max(0.0, share))
    return math.dist(p, (a[0] + share * along[0], a[1] + share * along[1]))


def shown(place: Place) -> str:
    """A point for a message."""
    return f"({place[0]:g}, {place[1]:g})"
