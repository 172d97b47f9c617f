"""Flaws that vertices make: triangles that face inwards or have no area, edges without length; what surrounds them."""

from __future__ import annotations

from concurrent.futures import Executor
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from rsym.sampling.sharp.loops import in_threads, loop

Floats: TypeAlias = NDArray[np.float64]
Faces: TypeAlias = NDArray[np.int32]
Ints: TypeAlias = NDArray[np.int64]
Marks: TypeAlias = NDArray[np.uint8]

FOLDED, FLAT, SHORT, TURNED = 1, 2, 4, 8
# The cosine of the angle between a triangle and its leaf at the crossing, beyond which the leaf is asked at its middle.
ASKED = 0.7
# A fold turns more than this share of a triangle's longest side squared against the surface; less is rounding.
FOLD = 1e-9
# Twice the area of a triangle over its longest side squared, below which it has none.
FLATNESS = 1e-9
# In cells. Newton's method puts two vertices on one corner to 1e-14, and what it leaves is far larger.
NO_LENGTH = 1e-9
# Of coordinates, in units of their last place.
ROUNDING = 16
GRAIN = 8192


def smallest(lattice: Floats) -> float:
    """A length that says nothing: far below a cell, and not below the rounding of coordinates far from the origin."""
    return max(NO_LENGTH * float(lattice[3:].min()), ROUNDING * float(np.spacing(np.abs(lattice[:3]).max())))


def find_flaws(faces: Faces, points: Floats, gradients: Floats, lattice: Floats, pool: Executor | None) -> Marks:
    """FOLDED, FLAT, SHORT and TURNED for each quad; `gradients` (3, quads) of the leaf of the quad, inwards."""
    flaws = np.zeros(len(faces) // 2, np.uint8)
    shortest = smallest(lattice) ** 2
    in_threads(lambda a, b: _inspect(a, b, faces, points, gradients, shortest, flaws), len(flaws), GRAIN, pool)
    return flaws


@loop
def _inspect(
    first: int, last: int, faces: Faces, points: Floats, gradients: Floats, shortest: float, flaws: Any
) -> None:
    u, v, n = np.empty(3), np.empty(3), np.empty(3)
    for e in range(first, last):
        for f in (2 * e, 2 * e + 1):
            a, b, c = faces[f, 0], faces[f, 1], faces[f, 2]
            if a < 0:
                continue
            uu = vv = ww = along = steep = 0.0
            for k in range(3):
                u[k], v[k] = points[k, b] - points[k, a], points[k, c] - points[k, a]
                uu += u[k] * u[k]
                vv += v[k] * v[k]
                ww += (v[k] - u[k]) ** 2
            n[0], n[1], n[2] = u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]
            for k in range(3):
                along += n[k] * gradients[k, e]
                steep += gradients[k, e] ** 2
            longest = max(uu, vv, ww)
            if longest > shortest and along > FOLD * longest * np.sqrt(steep):
                flaws[e] |= FOLDED
            nn = n[0] ** 2 + n[1] ** 2 + n[2] ** 2
            if along > -ASKED * np.sqrt(nn * steep):
                flaws[e] |= TURNED
            if nn < (FLATNESS * longest) ** 2:
                flaws[e] |= FLAT
            if min(uu, vv, ww) < shortest:
                flaws[e] |= SHORT


class Adjacency:
    """The quads around each vertex; turned diagonals change nothing, for a quad keeps its corners."""

    def __init__(self, faces: Faces, vertices: int) -> None:
        self._faces = faces
        self._start, self._quads = np.zeros(vertices + 2, np.int32), np.empty(2 * len(faces), np.int32)
        _list_quads(faces, self._start, self._quads)

    def around(self, quads: Ints, rings: int) -> tuple[Ints, Marks]:
        """The quads within some rings around others, and marks for the vertices all of whose quads are among them."""
        inner = np.zeros(len(self._start) - 2, np.uint8)
        for _ in range(rings):
            vertices = np.unique(self._faces.reshape(-1, 6)[quads])
            inner[vertices] = 1
            count = self._start[vertices + 1] - self._start[vertices]
            place = np.arange(count.sum()) + np.repeat(self._start[vertices] - np.cumsum(count) + count, count)
            quads = np.unique(self._quads[place]).astype(np.int64)
        return quads, inner


@loop
def _list_quads(faces: Faces, start: Any, quads: Any) -> None:
    for e in range(len(faces) // 2):
        for corner in (faces[2 * e, 0], faces[2 * e, 1], faces[2 * e, 2], faces[2 * e + 1, 2]):
            start[corner + 2] += 1
    for v in range(2, len(start)):
        start[v] += start[v - 1]
    for e in range(len(faces) // 2):
        for corner in (faces[2 * e, 0], faces[2 * e, 1], faces[2 * e, 2], faces[2 * e + 1, 2]):
            quads[start[corner + 1]] = e
            start[corner + 1] += 1
