"""Triangles of the quads around crossings."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from rsym.sampling.sharp.loops import loop, step
from rsym.sampling.sharp.signs import ABSENT, Bytes, Numbers

Floats = NDArray[np.float64]


@loop
def connect(
    first: int,
    last: int,
    quads: Numbers,
    points: Floats,
    gradients: Floats,
    feature: Bytes,
    faces: Numbers,
    sharp: Bytes,
) -> None:
    """Two triangles 2*e and 2*e + 1 for each crossing e, outward, on the better diagonal of its quad.

    ``points`` (3, vertices), ``gradients`` (3, crossings) of the leaf at the crossing, pointing inwards. ``feature``
    (vertices,) is not 0 for a vertex on an edge or corner of the body; ``sharp[e]`` tells that a quad has one.
    A quad that is not whole here (the rim of a piece) gives triangles of -1.
    """
    for e in range(first, last):
        a, b, c, d = quads[e, 0], quads[e, 1], quads[e, 2], quads[e, 3]
        if a < 0 or b < 0 or c < 0 or d < 0:
            a = b = c = d = ABSENT
            sharp[e] = 0
        else:
            sharp[e] = feature[a] | feature[b] | feature[c] | feature[d]
            p, q, r, s, g = at(points, a), at(points, b), at(points, c), at(points, d), at(gradients, e)
            if min(merit(p, q, r, g), merit(p, r, s, g)) < min(merit(q, r, s, g), merit(q, s, p, g)):
                a, b, c, d = b, c, d, a
        faces[2 * e, 0], faces[2 * e, 1], faces[2 * e, 2] = a, b, c
        faces[2 * e + 1, 0], faces[2 * e + 1, 1], faces[2 * e + 1, 2] = a, c, d


@step
def at(points: Floats, n: int) -> Any:
    """Point n of an array (3, n)."""
    return points[0, n], points[1, n], points[2, n]


@step
def merit(a: Any, b: Any, c: Any, g: Any) -> Any:
    """Twice the area of a triangle as seen against g (without g: as seen best) over its longer side at a squared."""
    ux, uy, uz, vx, vy, vz = b[0] - a[0], b[1] - a[1], b[2] - a[2], c[0] - a[0], c[1] - a[1], c[2] - a[2]
    nx, ny, nz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
    side = max(ux * ux + uy * uy + uz * uz, vx * vx + vy * vy + vz * vz) + 1e-300
    if g[0] == 0 and g[1] == 0 and g[2] == 0:
        return np.sqrt(nx * nx + ny * ny + nz * nz) / side
    return -(nx * g[0] + ny * g[1] + nz * g[2]) / side
