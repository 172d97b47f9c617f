"""Corners: where two leaves of the boundary meet, at which angle, and how far away other leaves are."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from rsym.arrays import Floats
from rsym.model.shape import Shape
from rsym.sampling.contours import level_lines
from rsym.sampling.plane_leaves import PlaneLeaves, leaves_of

RESOLUTION = 256
# Of the box: Newton's method from where the active leaf changes goes no further.
REACH = 0.02
SAME = 1e-9
# Points of a disc that are asked how the coordinates of the leaves turn.
RINGS, SPOKES = 6, 24
# The derivative of these coordinates by x and y differs from the identity by no more.
DISTORTION = 0.5


@dataclass(frozen=True)
class LeafCorner:
    """A corner between two leaves.

    point : where it is.
    leaves : the two, in the direction of growing angles: the first is 0 where the angle is 0.
    angle : inside, between 0 and 2 pi.
    turned : (2, 2), from the values of the leaves to coordinates p, q with p = r cos(theta), q = r sin(theta), in
        which both leaves are rays and which are those of the plane, turned, in the limit at the corner.
    distance : to the nearest point of the boundary on another leaf, or how far these coordinates are good ones.
    """

    point: tuple[float, float]
    leaves: tuple[int, int]
    angle: float
    turned: tuple[tuple[float, float], tuple[float, float]]
    distance: float


def corners_of(shape: Shape) -> tuple[LeafCorner, ...]:
    """The corners of the boundary, as a lattice shows them; those that Newton's method does not find are left out.

    Examples
    --------
    >>> import rsym
    >>> (low, high) = corners_of(rsym.disc(1) & rsym.half_plane((1, 0), 0))
    >>> [round(value, 12) + 0.0 for value in low.point], round(low.angle / 3.14159265359, 9)
    ([0.0, -1.0], 0.5)
    """
    lines = level_lines(shape, resolution=RESOLUTION)
    leaves = leaves_of(shape, (0, 1), {})
    every = np.concatenate([np.empty((0, 2)), *lines])
    active = [leaves.distance(np.asarray(line))[1] for line in lines]
    owners = np.concatenate([np.empty(0, np.int64), *active])
    found: list[LeafCorner] = []
    for line, own in zip(lines, active, strict=True):
        for k in np.flatnonzero(own[1:] != own[:-1]):
            corner = _corner(leaves, (line[k] + line[k + 1]) / 2, int(own[k]), int(own[k + 1]), every, owners)
            if corner is not None and not any(math.dist(corner.point, one.point) < SAME for one in found):
                found.append(corner)
    return tuple(sorted(found, key=lambda corner: corner.point))


def _corner(
    leaves: PlaneLeaves, start: Floats, one: int, other: int, every: Floats, owners: Floats
) -> LeafCorner | None:
    """The corner near a point of two leaves, the first of which is met first with the inside to the left."""
    size = float(np.ptp(every, axis=0).max())
    (point,) = leaves.common(start[None], np.array([one]), np.array([other]))
    if not np.linalg.norm(point - start) < REACH * size:
        return None
    # With the inside to the left the boundary comes in along the first leaf and leaves along the other.
    (_, (f,)), (_, (g,)) = leaves.of(point[None], np.array([other]), np.array([one]))
    jacobian = np.array([f, g])
    if abs(np.linalg.det(jacobian)) < 1e-6 * np.linalg.norm(f) * np.linalg.norm(g):
        return None
    # Along a leaf with its inside to the left one goes in the direction of its gradient turned by -90 degrees.
    out, back = np.array([f[1], -f[0]]), -np.array([g[1], -g[0]])
    start_angle = math.atan2(out[1], out[0])
    angle = (math.atan2(back[1], back[0]) - start_angle) % (2 * math.pi)
    c, s = math.cos(start_angle), math.sin(start_angle)
    turned = np.array([[c, s], [-s, c]]) @ np.linalg.inv(jacobian)
    beside = ~np.isin(owners, (one, other))
    far = np.linalg.norm(every[beside] - point, axis=1).min() if beside.any() else size
    distance = _good(leaves, point, (other, one), turned, jacobian, float(far))
    rows = (tuple(map(float, turned[0])), tuple(map(float, turned[1])))
    return LeafCorner((float(point[0]), float(point[1])), (other, one), angle, rows, distance)  # type: ignore[arg-type]


def _good(
    leaves: PlaneLeaves, point: Floats, pair: tuple[int, int], turned: Floats, jacobian: Floats, far: float
) -> float:
    """The radius of a disc in which the coordinates of two leaves are near those of the plane."""
    angles = np.linspace(0, 2 * math.pi, SPOKES, endpoint=False)
    for radius in far * 0.8 ** np.arange(30):
        rings = radius * np.arange(1, RINGS + 1) / RINGS
        around = np.stack([np.outer(rings, np.cos(angles)), np.outer(rings, np.sin(angles))], axis=-1).reshape(-1, 2)
        asked = [np.full(len(around), leaf) for leaf in pair]
        slopes = np.array([slope for _, slope in leaves.of(point + around, *asked)])
        local = np.einsum("ab,bnc->nac", np.linalg.inv(jacobian), slopes)
        if (np.abs(local - np.eye(2)).sum(axis=2).max() < DISTORTION) and np.isfinite(local).all():
            return float(radius)
    return 0.0
