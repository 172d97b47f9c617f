"""Silhouettes: how far lines of sight pass from a body, and where along them they come nearest.

The outline of a body seen along d is where omega = 0 and grad omega . d = 0, or an edge. A line of sight p + t d
touches it if the largest distance along it, M(p) = max over t of D(p + t d), is 0; where it passes beside the body -M
is how far, to first order. By the envelope theorem dM/da = dD/da at the place t* of the maximum, for every letter a:
what t* does to D is of second order. At an edge D rises to t* along one leaf and falls along another, and M is what
both have in common: with the slopes u > 0 > v before and behind t*, and the derivatives by the letter p and q there,

    dM/da = (u q - v p)/(u - v)

which is dD/da where D is smooth.

Source: P. Milgrom, I. Segal (2002), Envelope theorems for arbitrary choice sets, corollary 4 for the maximin.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from rsym.arrays import Floats
from rsym.errors import RsymError
from rsym.model.shape import Bounds

# Places along each line; a body, or a hole, thinner along the line than the distance of two of them may be missed.
PLACES = 96
PEAKS = 3  # the largest maxima between neighbours are all refined, for the order of samples is not that of maxima
GOLDEN = (5**0.5 - 1) / 2
# 0.618**44 is below 1e-9 of a step between places: omega_1 there differs from its maximum by rounding.
STEPS = 44
# Of a line: a hundred times what t* is off by at an edge. Derivatives are off by what D turns within it; where D is
# smooth t* is off by more, 1e-8, but both sides are alike there.
ASIDE = 1e-8


@dataclass(frozen=True)
class LinesOfSight:
    """Lines p + t d, p in `origins` (n, 3), d of length 1, for t in [low, high]."""

    origins: Floats
    direction: Floats
    low: float
    high: float

    def points(self, t: Floats) -> Floats:
        """The points at t, (n, ...) to (n, ..., 3)."""
        lift = (slice(None),) + (None,) * (t.ndim - 1)
        points: Floats = self.origins[lift] + t[..., None] * self.direction
        return points

    @property
    def aside(self) -> float:
        """How far before and behind a maximum slopes are taken: where two leaves meet each is seen, nothing else is."""
        return ASIDE * (self.high - self.low)

    def nearest(self, distance: Callable[[Floats], Floats]) -> Floats:
        """Where t (n,) a distance, positive inside, of points (..., 3) is largest on each line.

        Examples
        --------
        >>> lines = lines_of_sight([[0.5, 2.0]], "z", ((-2, 2),) * 3, ("x", "y", "z"))
        >>> ball = lambda points: 1 - np.linalg.norm(points - [0, 0, 0.3], axis=-1)
        >>> lines.points(lines.nearest(ball)).round(6).tolist()
        [[0.5, 2.0, 0.3]]
        """
        t = np.linspace(self.low, self.high, PLACES)
        values = _known(distance(self.points(np.broadcast_to(t, (len(self.origins), PLACES)))))
        padded = np.pad(values, ((0, 0), (1, 1)), constant_values=-np.inf)
        peak = (values >= padded[:, :-2]) & (values >= padded[:, 2:])
        best = np.argsort(np.where(peak, -values, np.inf), axis=1, kind="stable")[:, :PEAKS]
        low, high = t[np.maximum(best - 1, 0)], t[np.minimum(best + 1, PLACES - 1)]
        inner = [high - GOLDEN * (high - low), low + GOLDEN * (high - low)]
        found = [_known(distance(self.points(one))) for one in inner]
        for _ in range(STEPS):
            left = found[0] >= found[1]
            low, high = np.where(left, low, inner[0]), np.where(left, inner[1], high)
            new = np.where(left, high - GOLDEN * (high - low), low + GOLDEN * (high - low))
            value = _known(distance(self.points(new)))
            inner = [np.where(left, new, inner[1]), np.where(left, inner[0], new)]
            found = [np.where(left, value, found[1]), np.where(left, found[0], value)]
        # On a plateau, and at the ends of a line, the sample itself may be the best.
        places = np.concatenate([t[best], *inner], axis=1)
        reached = np.concatenate([np.take_along_axis(values, best, axis=1), *found], axis=1)
        chosen: Floats = np.take_along_axis(places, reached.argmax(axis=1)[:, None], axis=1)[:, 0]
        return chosen


def _known(values: Floats) -> Floats:
    """What is undefined is no maximum."""
    return np.where(np.isnan(values), -np.inf, values)


def lines_of_sight(points: Any, direction: Any, bounds: Bounds, names: tuple[str, ...]) -> LinesOfSight:
    """The lines through measured points of an outline, between the planes across them that hold the bounds.

    A coordinate as the direction takes points (n, 2) in the two others, a vector points (n, 3) anywhere on the lines.
    """
    points = np.asarray(points, np.float64)
    axis = names.index(str(direction)) if str(direction) in names else None
    given = np.eye(3)[axis] if axis is not None else _vector(direction, names)
    width = 2 if axis is not None else 3
    if points.ndim != 2 or points.shape[1] != width:
        what = f"in {', '.join(name for name in names if name != str(direction))}" if axis is not None else "in space"
        raise RsymError(
            f"expected points (n, {width}) of the silhouette, {what}, got the shape {points.shape}",
            code="points",
            remedy="a coordinate as the direction takes the two others, a vector takes three",
        )
    origins = np.insert(points, axis, 0.0, axis=1) if axis is not None else points
    origins = origins - (origins @ given)[:, None] * given
    corners = np.stack(np.meshgrid(*bounds), axis=-1).reshape(-1, 3) @ given
    return LinesOfSight(origins, given, float(corners.min()), float(corners.max()))


def _vector(direction: Any, names: tuple[str, ...]) -> Floats:
    try:
        given = np.asarray(direction, np.float64)
    except (TypeError, ValueError):
        given = np.zeros(0)
    if given.shape != (3,) or not np.isfinite(given).all() or not given.any():
        raise RsymError(
            f"a silhouette is seen along {', '.join(names)} or a vector of three numbers, got {direction!r}",
            code="silhouette",
            remedy="for example silhouette=z, or silhouette=(1, 1, 0)",
        )
    unit: Floats = given / np.linalg.norm(given)
    return unit
