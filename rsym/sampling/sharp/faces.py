"""Triangles of the quads around crossings."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from rsym.sampling.sharp.loops import loop, step
from rsym.sampling.sharp.signs import Numbers

Floats = NDArray[np.float64]


@loop
def connect(
    first: int, last: int, quads: Numbers, points: Floats, gradients: Floats, feature: Any, faces: Numbers, sharp: Any
) -> None:
    """Two triangles 2*e and 2*e + 1 for each crossing e, outward, on the better diagonal of its quad.

    ``points`` (3, vertices), ``gradients`` (3, crossings) of the leaf at the crossing, pointing inwards. ``feature``
    (vertices,) is not 0 for a vertex on an edge or corner of the body; ``sharp[e]`` tells that a quad has one.
    A quad that is not whole here (the rim of a piece) gives triangles of -1.
    """
    corner = np.empty((4, 3))
    for e in range(first, last):
        a, b, c, d = quads[e, 0], quads[e, 1], quads[e, 2], quads[e, 3]
        if a < 0 or b < 0 or c < 0 or d < 0:
            faces[2 * e : 2 * e + 2] = -1
            sharp[e] = 0
            continue
        for axis in range(3):
            corner[0, axis], corner[1, axis] = points[axis, a], points[axis, b]
            corner[2, axis], corner[3, axis] = points[axis, c], points[axis, d]
        sharp[e] = feature[a] or feature[b] or feature[c] or feature[d]
        gx, gy, gz = gradients[0, e], gradients[1, e], gradients[2, e]
        if split_quality(corner, 0, gx, gy, gz) < split_quality(corner, 1, gx, gy, gz):
            a, b, c, d = b, c, d, a
        faces[2 * e, 0], faces[2 * e, 1], faces[2 * e, 2] = a, b, c
        faces[2 * e + 1, 0], faces[2 * e + 1, 1], faces[2 * e + 1, 2] = a, c, d


@step
def split_quality(corner: Floats, h: int, gx: float, gy: float, gz: float) -> Any:
    """Worse of the two triangles on the diagonal from corner h: its outward area over its longest side squared."""
    a, b, c, d = corner[h], corner[h + 1], corner[h + 2 & 3], corner[h + 3 & 3]
    return min(outwardness(a, b, c, gx, gy, gz), outwardness(a, c, d, gx, gy, gz))


@step
def outwardness(a: Floats, b: Floats, c: Floats, gx: float, gy: float, gz: float) -> Any:
    """Twice the area of a triangle seen against the gradient (or seen best, if that is 0) over its side squared."""
    ux, uy, uz, vx, vy, vz = b[0] - a[0], b[1] - a[1], b[2] - a[2], c[0] - a[0], c[1] - a[1], c[2] - a[2]
    nx, ny, nz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
    longest = max(ux * ux + uy * uy + uz * uz, vx * vx + vy * vy + vz * vz) + 1e-300
    if gx == 0 and gy == 0 and gz == 0:
        return np.sqrt(nx * nx + ny * ny + nz * nz) / longest
    return -(nx * gx + ny * gy + nz * gz) / longest
