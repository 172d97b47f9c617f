"""Edges with samples: which points of them are closest to given points."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from rsym.arrays import Floats
from rsym.surfaces.forms import dot
from rsym.surfaces.joints.edges import PatchEdge

SAMPLES = 129
# Newton's method doubles the digits at each step from a start that is off by less than one sample.
NEWTON_STEPS = 12


@dataclass(frozen=True, eq=False)
class Border:
    """An edge with samples; index and size are those of its patch.

    Edges that are closer than `gap` are together; those within `reach` are meant to be.
    """

    index: int
    edge: PatchEdge
    size: float
    gap: float
    reach: float
    is_point: bool = False

    @cached_property
    def t(self) -> Floats:
        """Parameters of the samples."""
        return np.linspace(*self.edge.interval, SAMPLES)

    @cached_property
    def points(self) -> Floats:
        """The samples (SAMPLES, 3)."""
        return self.edge.position(self.t)

    @cached_property
    def box(self) -> Floats:
        """Lowest and highest coordinates (2, 3) of the samples, widened by what lies between them."""
        step = np.abs(np.diff(self.points, axis=0)).max()
        return np.stack([self.points.min(axis=0) - step, self.points.max(axis=0) + step])

    @cached_property
    def bulge(self) -> float:
        """How far the edge can be from the polygon through the samples, twice over."""
        return float(np.linalg.norm(np.diff(self.points, 2, axis=0), axis=-1).max()) / 4

    def roughly(self, points: Floats) -> tuple[NDArray[np.int64], Floats]:
        """For each point the closest sample, and a distance that the edge is not nearer than."""
        # |p|^2 - 2 p.q is least where |p - q| is; near the origin, so that rounding does not choose.
        places, others = self.points - self.points[0], points - self.points[0]
        nearest = np.argmin(dot(places, places) - 2 * others @ places.T, axis=1)
        least = np.full(len(points), np.inf)
        for beside in (np.maximum(nearest - 1, 0), np.minimum(nearest + 1, SAMPLES - 1)):
            start, way = self.points[nearest], self.points[beside] - self.points[nearest]
            square = dot(way, way)
            share = np.clip(dot(points - start, way) / np.where(square > 0, square, 1), 0, 1)
            least = np.minimum(least, np.linalg.norm(points - start - share[:, None] * way, axis=-1))
        return nearest, least - self.bulge

    @property
    def loop(self) -> bool:
        """Whether the edge ends where it begins."""
        return bool(np.abs(self.points[0] - self.points[-1]).max() <= 1e-6 * np.ptp(self.points, axis=0).max())


def closest(edge: PatchEdge, points: Floats, guess: Floats, low: Floats, high: Floats) -> Floats:
    """Parameters of the points of an edge closest to points in space, by Newton's method between bounds.

    Zero of (c(s) - p) . c'(s), where c is the edge. Far from the point its derivative may have the wrong sign: there
    |c'|^2 takes its place.
    """
    s = np.clip(guess, low, high)
    rounding = 4 * np.finfo(np.float64).eps * max(map(abs, edge.interval))
    for _ in range(NEWTON_STEPS):
        position, first, second = edge.derivatives(s, ((0, 0), (1, 0), (2, 0)))
        away, speed = position - points, dot(first, first)
        slope = speed + dot(away, second)
        slope = np.where(slope > 0.1 * speed, slope, speed)
        with np.errstate(all="ignore"):
            step = np.where(slope > 0, dot(away, first) / slope, 0.0)
        before, s = s, np.clip(s - step, low, high)
        if np.abs(s - before).max() <= rounding:
            break
    return s


def projected(border: Border, points: Floats, room: float) -> tuple[Floats, Floats]:
    """For each point the parameter of the closest point of an edge, and the distance; infinite where beyond `room`."""
    nearest, least = border.roughly(points)
    s, away = border.t[nearest], np.full(len(points), np.inf)
    near = least <= room
    if near.any():
        places = nearest[near]
        low, high = border.t[np.maximum(places - 1, 0)], border.t[np.minimum(places + 1, SAMPLES - 1)]
        s[near] = closest(border.edge, points[near], s[near], low, high)
        away[near] = np.linalg.norm(border.edge.position(s[near]) - points[near], axis=-1)
    return s, away
