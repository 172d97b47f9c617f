"""Edges with samples: their points closest to given ones, and poles, to which whole edges of several patches shrink."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from rsym.arrays import Floats
from rsym.surfaces.forms import dot, limit_forms
from rsym.surfaces.joints.edges import PatchEdge

DIRECTIONS = (17, 33)
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


@dataclass(frozen=True, eq=False)
class Fan:
    """The directions in which patches leave a pole: place, normal and curvature tensor (3, 3) of each of n.

    The tensor T gives the normal curvature T w . w of a unit tangent w.
    """

    points: Floats
    normals: Floats
    tensors: Floats
    parameters: Floats


def clusters(borders: Sequence[Border]) -> list[list[Border]]:
    """Edges that are points, those within reach of one another together."""
    groups: list[list[Border]] = []
    for border in borders:
        near = [group for group in groups if any(_near(border, one) for one in group)]
        whole = [border, *(one for group in near for one in group)]
        groups = [*(group for group in groups if group not in near), whole]
    return [sorted(group, key=lambda border: (border.index, border.edge.name)) for group in groups]


def _near(one: Border, other: Border) -> bool:
    return bool(np.linalg.norm(one.points[0] - other.points[0]) <= min(one.reach, other.reach))


def fan(group: Sequence[Border], count: int) -> Fan:
    """What the patches of a pole are in `count` directions each, their normals turned to one side."""
    parts = []
    for border in group:
        t = np.linspace(*border.edge.interval, count)
        parts.append((*_directions(border.edge, t), np.stack(border.edge.parameters(t), axis=-1)))
    points, leaving, normals, tensors, parameters = (np.stack(column) for column in zip(*parts, strict=True))
    signs = _sides(leaving, normals)[:, None, None]
    normals, tensors = signs * normals, signs[..., None] * tensors
    return Fan(*(one.reshape(-1, *one.shape[2:]) for one in (points, normals, tensors, parameters)))


def _sides(leaving: Floats, normals: Floats) -> Floats:
    """A sign for each patch that turns all normals to one side: along edges that two of them share they agree.

    Patches are taken one after the other, always the one with the edge nearest to an edge of those taken before.
    """
    ends, there = leaving[:, [0, -1]], normals[:, [0, -1]]
    near = np.einsum("aid,bjd->abij", ends, ends)
    same = np.einsum("aid,bjd->abij", there, there)
    signs = np.zeros(len(ends))
    signs[0] = 1.0
    while (signs == 0).any():
        open_pairs = (signs[:, None] != 0) & (signs[None] == 0)
        nearest = np.where(open_pairs[..., None, None], np.nan_to_num(near, nan=-1.0), -np.inf)
        a, b, i, j = np.unravel_index(int(np.argmax(nearest)), near.shape)
        signs[b] = signs[a] * (-1.0 if same[a, b, i, j] < 0 else 1.0)
    return signs


def _directions(edge: PatchEdge, t: Floats) -> tuple[Floats, Floats, Floats, Floats]:
    """Points, unit directions, normals and curvature tensors; the basis at a pole is p_uv and the derivative across."""
    u, v = edge.parameters(t)
    forms = limit_forms(edge.patch, u, v, edge.letters)
    orders = ((0, 0), (1, 1), (0, 1) if edge.across == 1 else (1, 0))
    points, turning, leaving = edge.patch.derivatives(u, v, orders, letters=edge.letters)
    first, second = (turning, leaving) if edge.across == 1 else (leaving, turning)
    basis = np.stack([first, second], axis=-1)
    with np.errstate(all="ignore"):
        area = forms.E * forms.G - forms.F**2
        rows = [np.stack([forms.G, -forms.F], axis=-1), np.stack([-forms.F, forms.E], axis=-1)]
        direction = leaving / np.sqrt(dot(leaving, leaving))[:, None]
        dual = basis @ (np.stack(rows, axis=-2) / area[:, None, None])
        form = np.stack([np.stack([forms.L, forms.M], axis=-1), np.stack([forms.M, forms.N], axis=-1)], axis=-2)
        tensor = dual @ form @ np.swapaxes(dual, -1, -2)
    return points, direction, forms.normal, np.where(np.isfinite(tensor), tensor, np.nan)


def spread(fan: Fan) -> tuple[Floats, Floats, Floats]:
    """Gap, angle in degrees and difference of curvatures between all pairs of directions, (n, n) each."""
    gaps = np.linalg.norm(fan.points[:, None] - fan.points[None], axis=-1)
    crossed = np.linalg.norm(np.cross(fan.normals[:, None], fan.normals[None]), axis=-1)
    angles = np.degrees(np.arctan2(crossed, dot(fan.normals[:, None], fan.normals[None])))
    difference = fan.tensors[:, None] - fan.tensors[None]
    known = np.isfinite(difference).all(axis=(-1, -2))
    jumps = np.full(known.shape, np.nan)
    jumps[known] = np.abs(np.linalg.eigvalsh(difference[known])).max(axis=-1)
    return gaps, angles, jumps
