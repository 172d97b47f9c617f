"""Triangles of the quads around crossings: their diagonals, and the flaws that are left.

The better shape chooses the diagonal; at features the one whose triangles lie along the surface beneath them. Flaws are
triangles that face inwards or have no area, and edges without length.
"""

from __future__ import annotations

from concurrent.futures import Executor
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from rsym.arrays import Faces, Flags, Floats, Ints
from rsym.sampling.kernels.mesher_kernels import MesherKernels, padded
from rsym.sampling.sharp.crossings import CompiledLeaves, evaluate
from rsym.sampling.sharp.loops import in_threads, loop, step
from rsym.sampling.sharp.signs import ABSENT, Bytes, Numbers

# Costs this close, as a share of both, say nothing: then the better shape decides.
EVEN = 1e-3
GRAIN = 4096
# The triangles of a quad a, b, c, d: on the diagonal a-c, then on b-d.
TRIANGLES = np.array([[0, 1, 2], [0, 2, 3], [1, 2, 3], [1, 3, 0]])

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
FLAW_GRAIN = 8192


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
            one, other = merit(p, q, r, g), merit(p, r, s, g)
            first_worst = other if other < one else one
            one, other = merit(q, r, s, g), merit(q, s, p, g)
            if first_worst < (other if other < one else one):
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
    u, v = ux * ux + uy * uy + uz * uz, vx * vx + vy * vy + vz * vz
    side = (v if v > u else u) + 1e-300
    if g[0] == 0 and g[1] == 0 and g[2] == 0:
        return np.sqrt(nx * nx + ny * ny + nz * nz) / side
    return -(nx * g[0] + ny * g[1] + nz * g[2]) / side


def turn_diagonals(kernels: MesherKernels, which: Ints, points: Floats, faces: Faces, pool: Executor | None) -> None:
    """Choose, in place, the diagonal of each of some quads; triangles 2*e and 2*e + 1 are quad e.

    A triangle costs what it turns away from the surface: its area minus that of its projection along the gradient of
    the leaf that is active at its middle.
    """
    count = 4 * len(which)
    if not count:
        return
    middle, gradient = np.zeros((3, padded(count))), np.zeros((3, padded(count)))
    value, leaf = np.empty(middle.shape[1]), np.full(middle.shape[1], -1, np.int16)
    in_threads(lambda a, b: middles(a, b, which, faces, points, middle, _corners()), len(which), GRAIN, pool)
    in_threads(lambda a, b: kernels.value(b - a, middle, value, leaf, first=a), count, kernels.grain, pool)
    evaluate(kernels, leaf, middle, value, gradient, count, pool)
    arrays = (which, gradient, points, faces)
    in_threads(lambda a, b: choose(a, b, *arrays, _corners(), np.empty((2, 2))), len(which), GRAIN, pool)


@loop
def middles(first: int, last: int, which: Any, faces: Faces, points: Floats, middle: Floats, quad: Ints) -> None:
    """The middles of the four possible triangles of each quad; `quad` (4,) is scratch."""
    for w in range(first, last):
        corners_of(faces, which[w], quad)
        for t in range(4):
            for axis in range(3):
                total = 0.0
                for k in range(3):
                    total += points[axis, quad[TRIANGLES[t, k]]]
                middle[axis, 4 * w + t] = total / 3


def _corners() -> Ints:
    return np.empty(4, np.int64)


@step
def corners_of(faces: Faces, quad: int, corners: Any) -> None:
    """The corners of a quad in their order, whichever its diagonal is."""
    for k in range(3):
        corners[k] = faces[2 * quad, k]
    corners[3] = faces[2 * quad + 1, 2]


@loop
def choose(
    first: int, last: int, which: Any, gradient: Floats, points: Floats, faces: Faces, quad: Ints, rating: Floats
) -> None:
    """Take the diagonal that costs less; of even ones that with the better worst triangle.

    `quad` (4,) and `rating` (2, 2), the cost and the worst shape of each diagonal, are scratch.
    """
    for w in range(first, last):
        corners_of(faces, which[w], quad)
        area = 0.0
        for diagonal in range(2):
            rating[0, diagonal], rating[1, diagonal] = 0.0, np.inf
            for t in (2 * diagonal, 2 * diagonal + 1):
                a, b, c = quad[TRIANGLES[t, 0]], quad[TRIANGLES[t, 1]], quad[TRIANGLES[t, 2]]
                size, along, longest = triangle(points, a, b, c, gradient, 4 * w + t)
                rating[0, diagonal] += size - along
                shape = size / (longest + 1e-300)
                rating[1, diagonal] = shape if shape < rating[1, diagonal] else rating[1, diagonal]
                area += size
        even = abs(rating[0, 0] - rating[0, 1]) < EVEN * (rating[0, 0] + rating[0, 1]) + 1e-9 * area
        if rating[1, 1] > rating[1, 0] if even else rating[0, 1] < rating[0, 0]:
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
    u, v, w = ux * ux + uy * uy + uz * uz, vx * vx + vy * vy + vz * vz, wx * wx + wy * wy + wz * wz
    longest = v if v > u else u
    longest = w if w > longest else longest
    along = -(nx * gx + ny * gy + nz * gz) / steep if steep > 0 else 0.0
    return np.sqrt(nx * nx + ny * ny + nz * nz), along, longest


def smallest(lattice: Floats) -> float:
    """A length that says nothing: far below a cell, and not below the rounding of coordinates far from the origin."""
    return max(NO_LENGTH * float(lattice[3:].min()), ROUNDING * float(np.spacing(np.abs(lattice[:3]).max())))


def find_flaws(faces: Faces, points: Floats, gradients: Floats, lattice: Floats, pool: Executor | None) -> Marks:
    """FOLDED, FLAT, SHORT and TURNED for each quad; `gradients` (3, quads) of the leaf of the quad, inwards."""
    flaws = np.zeros(len(faces) // 2, np.uint8)
    shortest = smallest(lattice) ** 2
    arrays = (faces, points, gradients, shortest, flaws)
    in_threads(lambda a, b: _inspect(a, b, *arrays), len(flaws), FLAW_GRAIN, pool)
    return flaws


@loop
def _inspect(
    first: int, last: int, faces: Faces, points: Floats, gradients: Floats, shortest: float, flaws: Any
) -> None:
    for e in range(first, last):
        gx, gy, gz = gradients[0, e], gradients[1, e], gradients[2, e]
        steep = gx * gx + gy * gy + gz * gz
        for f in range(2 * e, 2 * e + 2):
            a, b, c = faces[f, 0], faces[f, 1], faces[f, 2]
            if a < 0:
                continue
            ux, uy, uz = points[0, b] - points[0, a], points[1, b] - points[1, a], points[2, b] - points[2, a]
            vx, vy, vz = points[0, c] - points[0, a], points[1, c] - points[1, a], points[2, c] - points[2, a]
            wx, wy, wz = vx - ux, vy - uy, vz - uz
            nx, ny, nz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
            uu, vv, ww = ux * ux + uy * uy + uz * uz, vx * vx + vy * vy + vz * vz, wx * wx + wy * wy + wz * wz
            along = nx * gx + ny * gy + nz * gz
            longest, least = vv if vv > uu else uu, vv if vv < uu else uu
            longest, least = ww if ww > longest else longest, ww if ww < least else least
            if longest > shortest and along > FOLD * longest * np.sqrt(steep):
                flaws[e] |= FOLDED
            nn = nx * nx + ny * ny + nz * nz
            if along > -ASKED * np.sqrt(nn * steep):
                flaws[e] |= TURNED
            if nn < FLATNESS * longest * (FLATNESS * longest):
                flaws[e] |= FLAT
            if least < shortest:
                flaws[e] |= SHORT


def facing_inwards(leaves: CompiledLeaves, corners: Floats, leaf: NDArray[np.int16]) -> tuple[Flags, Floats]:
    """Which triangles (n, 3, 3) face inwards or have no area, and how far each turns away from its leaf."""
    a, b, c = np.ascontiguousarray(corners.transpose(1, 2, 0))
    u, v = b - a, c - a
    normal = np.stack([u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]])
    _, gradient = leaves.evaluate(leaf, (a + b + c) / 3)
    with np.errstate(all="ignore"):
        along = -(normal * gradient).sum(axis=0) / np.sqrt((gradient * gradient).sum(axis=0))
    size = np.sqrt((normal * normal).sum(axis=0))
    longest = np.maximum.reduce([((p - q) ** 2).sum(axis=0) for p, q in ((a, b), (b, c), (c, a))])
    return (along < 0) | (size <= FLATNESS * longest), size - np.nan_to_num(along)


class BeyondRim(Exception):
    """A part of a surface is too small: it matters what is beyond some `vertices` of its rim."""

    def __init__(self, vertices: NDArray[np.integer[Any]]) -> None:
        super().__init__("the part is too small")
        self.vertices = vertices


def ranges(start: NDArray[np.integer[Any]], count: NDArray[np.integer[Any]]) -> tuple[Ints, Ints]:
    """All numbers from each start on, so many, and whose each is.

    Examples
    --------
    >>> ranges(np.array([5, 0]), np.array([2, 3]))
    (array([0, 0, 1, 1, 1]), array([5, 6, 0, 1, 2]))
    """
    owner = np.repeat(np.arange(len(start)), count)
    return owner, np.arange(len(owner)) + (start - np.cumsum(count) + count)[owner]


class Adjacency:
    """The quads around each vertex; turned diagonals change nothing, for a quad keeps its corners.

    Of a part of a surface `rim` marks the vertices that may have quads elsewhere; to ask for those raises `BeyondRim`.
    """

    def __init__(self, faces: Faces, vertices: int, rim: Flags | None = None) -> None:
        self._faces, self._rim = faces, rim
        self._start, self._quads = quads_of_vertices(faces, vertices)

    def around(self, quads: Ints, rings: int) -> tuple[Ints, Marks]:
        """The quads within some rings around others, and marks for the vertices all of whose quads are among them."""
        inner, near = np.zeros(len(self._start) - 2, np.uint8), np.zeros(len(self._faces) // 2, np.bool_)
        near[quads] = True
        for _ in range(rings):
            new = np.zeros(len(inner), np.bool_)
            new[self._faces.reshape(-1, 6)[quads]] = True
            vertices = np.flatnonzero(new & (inner == 0))
            inner[vertices] = 1
            if self._rim is not None and self._rim[vertices].any():
                raise BeyondRim(vertices[self._rim[vertices]])
            start = self._start[vertices]
            _, place = ranges(start, self._start[vertices + 1] - start)
            found = np.zeros(len(near), np.bool_)
            found[self._quads[place]] = True
            quads = np.flatnonzero(found & ~near)
            near[quads] = True
        return np.flatnonzero(near), inner


def quads_of_vertices(faces: Faces, count: int) -> tuple[Faces, Faces]:
    """The quads of each vertex, ascending: where they begin in a list, and the list."""
    start, quads = np.zeros(count + 2, np.int32), np.empty(2 * len(faces), np.int32)
    _list_quads(faces, start, quads)
    return start, quads


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
