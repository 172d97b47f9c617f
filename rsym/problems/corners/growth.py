"""The factor by which solutions at a corner are not those of Laplace's equation: convection, and diffusion that varies.

With u = E w and grad(log E) = G = (b/k - grad(log k))/2 the equation -div(k grad u) + b . grad u = f has no first
derivatives of w at all; G is a gradient but for what turns round, so E is taken to second order:

    log E = q/sqrt(1 + (q/4)**2),    q = G . d + d . H d/2,

d the way from the corner, H the symmetric part of the derivatives of G there. What is left is of the order of c*u.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rsym.arrays import Floats
from rsym.problems.corners.corners import PlaneCorner

MOST = 4.0  # of log E
DEGREE = 5  # of polynomials that are taken for data near a corner
NEAR = 0.1  # of the reach of a corner: where
ROUGH, SURE = 1e-5, 1e-10  # the share of data that polynomials miss where these are not smooth; of singular values


@dataclass(frozen=True)
class Growth:
    """log E, by its first and second derivatives at a corner: x, y, and xx, xy, yy.

    Examples
    --------
    >>> Growth((1.0, 0.0), (0.0, 0.0, 0.0)).at(np.array([[0.0, 5.0], [1e-9, 0.0]]), 1).round(6).tolist()
    [[1.0, 1.0], [1.0, 1.0], [0.0, 0.0]]
    """

    slope: tuple[float, float]
    bend: tuple[float, float, float]

    def at(self, away: Floats, order: int) -> Floats:
        """The derivatives (kinds, n) of E up to an order at places so far away (n, 2) from the corner."""
        (p, q), (xx, xy, yy), (x, y) = self.slope, self.bend, away.T
        half = (p + (xx * x + xy * y) / 2) * x + (q + (xy * x + yy * y) / 2) * y
        first = np.stack([p + xx * x + xy * y, q + xy * x + yy * y])
        root = 1 / np.sqrt(1 + (half / MOST) ** 2)
        value = np.exp(half * root)
        if order == 0:
            return np.asarray(value[None])
        one, two = root**3, -3 * half * root**5 / MOST**2
        slopes = first * one
        if order == 1:
            return np.concatenate([value[None], value * slopes])
        second = [
            one * bent + two * first[i] * first[j] + slopes[i] * slopes[j]
            for (i, j), bent in zip(((0, 0), (0, 1), (1, 1)), self.bend, strict=True)
        ]
        return np.concatenate([value[None], value * slopes, value * np.stack(second)])


def places_at(corner: PlaneCorner) -> Floats:
    """Places (n, 2) inside near a corner, from which `growth_of` knows data there."""
    turns = np.linspace(0.1, 0.9, 2 * DEGREE - 1) * corner.angle
    along, across = corner.edges[0], np.array([-corner.edges[0, 1], corner.edges[0, 0]])
    ways = np.cos(turns)[:, None] * along + np.sin(turns)[:, None] * across
    away = NEAR * corner.reach * np.linspace(0, 1, DEGREE + 3)[1:, None, None] * ways
    return np.asarray(corner.point + away.reshape(-1, 2))


def growth_of(corner: PlaneCorner, diffusion: Floats, convection: Floats) -> Growth | None:
    """What k (n,) and b (2, n) at its `places_at` make of functions; None where that is nothing, or not smooth."""
    if corner.is_cusp or not (np.isfinite(diffusion).all() and np.isfinite(convection).all() and diffusion.all()):
        return None
    data = np.stack([np.log(np.abs(diffusion)), *convection / diffusion], axis=1)
    if not np.ptp(data[:, 0]) and not convection.any():
        return None
    size = NEAR * corner.reach
    x, y = (places_at(corner) - corner.point).T / size
    powers = [(total - j, j) for total in range(DEGREE + 1) for j in range(total + 1)]
    table = np.stack([x**i * y**j for i, j in powers], axis=1)
    found = np.linalg.lstsq(table, data, rcond=SURE)[0]
    if np.abs(table @ found - data).max() > ROUGH * np.abs(data - data.mean(axis=0) * [1, 0, 0]).max():
        return None
    value, by_x, by_y, xx, xy, yy = found[:6]
    slope = (value[1] - by_x[0] / size) / 2, (value[2] - by_y[0] / size) / 2
    second = (
        (by_x[1] / size - 2 * xx[0] / size**2) / 2,
        ((by_y[1] + by_x[2]) / (2 * size) - xy[0] / size**2) / 2,
        (by_y[2] / size - 2 * yy[0] / size**2) / 2,
    )
    return Growth((float(slope[0]), float(slope[1])), (float(second[0]), float(second[1]), float(second[2])))
