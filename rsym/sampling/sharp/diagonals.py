"""Diagonals of the quads at features: those whose triangles lie along the surface beneath them."""

from __future__ import annotations

from concurrent.futures import Executor
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from rsym.sampling.kernels.surface_kernels import SurfaceKernels, padded
from rsym.sampling.sharp.crossings import evaluate
from rsym.sampling.sharp.loops import in_threads, loop, step

Floats: TypeAlias = NDArray[np.float64]
Faces: TypeAlias = NDArray[np.int32]

# Costs this close, as a share of both, say nothing: then the better shape decides.
EVEN = 1e-3
GRAIN = 1024
# The triangles of a quad a, b, c, d: on the diagonal a-c, then on b-d.
TRIANGLES = np.array([[0, 1, 2], [0, 2, 3], [1, 2, 3], [1, 3, 0]])


def turn_diagonals(
    kernels: SurfaceKernels, sharp: NDArray[np.uint8], points: Floats, faces: Faces, pool: Executor | None
) -> None:
    """Choose, in place, the diagonal of each quad marked in `sharp`; triangles 2*e and 2*e + 1 are quad e.

    A triangle costs what it turns away from the surface: its area minus that of its projection along the gradient of
    the leaf that is active at its middle.
    """
    which = np.flatnonzero(sharp)
    count = 4 * len(which)
    if not count:
        return
    middle, gradient = np.zeros((3, padded(count))), np.zeros((3, padded(count)))
    value, leaf = np.empty(middle.shape[1]), np.full(middle.shape[1], -1, np.int16)
    in_threads(lambda a, b: middles(a, b, which, faces, points, middle), len(which), GRAIN, pool)
    in_threads(lambda a, b: kernels.value(b - a, middle, value, leaf, first=a), count, GRAIN, pool)
    evaluate(kernels, leaf, middle, value, gradient, count, pool)
    in_threads(lambda a, b: choose(a, b, which, gradient, points, faces), len(which), GRAIN, pool)


@loop
def middles(first: int, last: int, which: Any, faces: Faces, points: Floats, middle: Floats) -> None:
    """The middles of the four possible triangles of each quad."""
    quad = np.empty(4, np.int64)
    for w in range(first, last):
        corners_of(faces, which[w], quad)
        for t in range(4):
            for axis in range(3):
                total = 0.0
                for k in range(3):
                    total += points[axis, quad[TRIANGLES[t, k]]]
                middle[axis, 4 * w + t] = total / 3


@step
def corners_of(faces: Faces, quad: int, corners: Any) -> None:
    """The corners of a quad in their order, whichever its diagonal is."""
    for k in range(3):
        corners[k] = faces[2 * quad, k]
    corners[3] = faces[2 * quad + 1, 2]


@loop
def choose(first: int, last: int, which: Any, gradient: Floats, points: Floats, faces: Faces) -> None:
    """Take the diagonal that costs less; of even ones that with the better worst triangle."""
    quad = np.empty(4, np.int64)
    cost, shape = np.empty(2), np.empty(2)
    for w in range(first, last):
        corners_of(faces, which[w], quad)
        area = 0.0
        for diagonal in range(2):
            cost[diagonal], shape[diagonal] = 0.0, np.inf
            for t in (2 * diagonal, 2 * diagonal + 1):
                a, b, c = quad[TRIANGLES[t, 0]], quad[TRIANGLES[t, 1]], quad[TRIANGLES[t, 2]]
                size, along, longest = triangle(points, a, b, c, gradient, 4 * w + t)
                cost[diagonal] += size - along
                shape[diagonal] = min(shape[diagonal], size / (longest + 1e-300))
                area += size
        even = abs(cost[0] - cost[1]) < EVEN * (cost[0] + cost[1]) + 1e-9 * area
        if shape[1] > shape[0] if even else cost[1] < cost[0]:
            for k in range(3):
                faces[2 * which[w], k] = quad[1 + k]
            faces[2 * which[w] + 1, 0], faces[2 * which[w] + 1, 1], faces[2 * which[w] + 1, 2] = (
                quad[1],
                quad[3],
                quad[0],
            )


@step
def triangle(points: Floats, a: int, b: int, c: int, gradient: Floats, at: int) -> Any:
    """Twice the area of a triangle, twice that of its projection along the gradient, and its longest side squared."""
    ux, uy, uz = points[0, b] - points[0, a], points[1, b] - points[1, a], points[2, b] - points[2, a]
    vx, vy, vz = points[0, c] - points[0, a], points[1, c] - points[1, a], points[2, c] - points[2, a]
    nx, ny, nz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
    gx, gy, gz = gradient[0, at], gradient[1, at], gradient[2, at]
    steep = np.sqrt(gx * gx + gy * gy + gz * gz)
    wx, wy, wz = vx - ux, vy - uy, vz - uz
    longest = max(ux * ux + uy * uy + uz * uz, vx * vx + vy * vy + vz * vz, wx * wx + wy * wy + wz * wz)
    along = -(nx * gx + ny * gy + nz * gz) / steep if steep > 0 else 0.0
    return np.sqrt(nx * nx + ny * ny + nz * nz), along, longest
