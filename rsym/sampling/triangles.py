"""Loops over triangles, each linear in their number: how they hang together, and what they look like.

Half-edge 3*f + k runs from corner k of face f to the next corner. Faces are (m, 3) int32. What a loop fills is made
before it: in compiled loops each kind of array that they make takes a tenth of a second to compile.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from rsym.sampling.compiled import loop, step

# A triangle this flat, height to longest side, has no direction: float64 knows the corners of a unit body to 1e-16.
FLAT = 1e-12
# Without outward directions a triangle is folded if its normal is turned by more than 127 degrees from those of two
# neighbours: beyond the tip of a needle of three sides (120) and the corner of a tetrahedron (109).
TURNED = -0.6
# Sums are taken over runs of this length first, so that 1e6 triangles lose no more digits than 1e4.
RUN = 128


@step
def following(h: int) -> int:
    """The next half-edge of the same face."""
    return h - 2 if h % 3 == 2 else h + 1


def pair(faces: Any, count: int) -> tuple[Any, int, int, int]:
    """The mate of each half-edge, -1 where it has not exactly one; edges, boundary edges and repeated ones.

    Half-edges are put into a bucket for the lower of their ends; inside a bucket the other end tells them apart.
    """
    start, mates = np.zeros(count + 2, np.int32), np.full(faces.size, -1, np.int32)
    # The half-edge and its other end, which is ~end if the half-edge runs down to v.
    bucket, ends = np.empty(faces.size, np.int32), np.empty(faces.size, np.int32)
    many, last = np.zeros((count, 2), np.int32), np.zeros((count, 2), np.int32)
    edges, boundary, repeated = _pair(faces, start, bucket, ends, many, last, mates)
    return mates, int(edges), int(boundary), int(repeated)


@loop
def _pair(faces: Any, start: Any, bucket: Any, ends: Any, many: Any, last: Any, mates: Any) -> tuple[int, int, int]:
    for f in range(len(faces)):
        for k in range(3):
            a, b = faces[f, k], faces[f, k - 2]
            start[(a if a <= b else b) + 2] += 1
    for v in range(len(many)):
        start[v + 2] += start[v + 1]
    for f in range(len(faces)):
        for k in range(3):
            a, b = faces[f, k], faces[f, k - 2]
            low = (a if a <= b else b) + 1
            place = start[low]
            start[low] += 1
            bucket[place], ends[place] = 3 * f + k, b if a <= b else ~a
    edges, boundary, repeated = 0, 0, 0
    for v in range(len(many)):
        for i in range(start[v], start[v + 1]):
            down = 1 if ends[i] < 0 else 0
            end = ~ends[i] if ends[i] < 0 else ends[i]
            many[end, down] += 1
            last[end, down] = bucket[i]
        for i in range(start[v], start[v + 1]):
            end = ~ends[i] if ends[i] < 0 else ends[i]
            up, down = many[end, 0], many[end, 1]
            if up == 0 and down == 0:
                continue
            many[end, 0], many[end, 1] = 0, 0
            edges += 1
            boundary += (up == 0) + (down == 0)
            repeated += (up > 1) + (down > 1)
            if up == 1 and down == 1:
                mates[last[end, 0]], mates[last[end, 1]] = last[end, 1], last[end, 0]
    return edges, boundary, repeated


def pieces(faces: Any, count: int) -> Any:
    """The number of the piece of each vertex, in the order of their first vertices; -1 for vertices of no face."""
    label = np.full(count, -1, np.int32)
    _pieces(faces, np.arange(count, dtype=np.int32), np.zeros(count, np.bool_), label)
    return label


@loop
def _pieces(faces: Any, root: Any, used: Any, label: Any) -> None:
    for f in range(len(faces)):
        used[faces[f, 0]] = used[faces[f, 1]] = used[faces[f, 2]] = True
        for k in range(1, 3):
            a, b = root[faces[f, 0]], root[faces[f, k]]
            if a == b:
                continue
            while root[a] != a:
                root[a] = root[root[a]]
                a = root[a]
            while root[b] != b:
                root[b] = root[root[b]]
                b = root[b]
            # The lower vertex leads, so a root comes before all that it leads.
            if a < b:
                root[b] = a
            else:
                root[a] = b
    found = 0
    for v in range(len(root)):
        if used[v] and root[v] == v:
            label[v] = found
            found += 1
        elif used[v]:
            label[v] = label[root[v]]


def pinched(faces: Any, mates: Any, count: int) -> int:
    """The number of vertices whose faces are not one fan: where bodies touch in a point."""
    faces_at, first = np.zeros(count, np.int32), np.full(count, -1, np.int32)
    return int(_pinched(faces.ravel(), mates, faces_at, first))


@loop
def _pinched(flat: Any, mates: Any, faces_at: Any, first: Any) -> int:
    for h in range(len(flat)):
        faces_at[flat[h]] += 1
        if first[flat[h]] < 0 or mates[h] < 0:
            first[flat[h]] = h
    found = 0
    for v in range(len(first)):
        if first[v] < 0:
            continue
        h, turned = first[v], 0
        while True:
            turned += 1
            h = mates[following(following(h))]
            if h < 0 or h == first[v]:
                break
        found += turned < faces_at[v]
    return found


@loop
def back_to_back(mates: Any) -> bool:
    """Whether two triangles are mates along all three edges."""
    for f in range(len(mates) // 3):
        first, second, third = mates[3 * f], mates[3 * f + 1], mates[3 * f + 2]
        if first >= 0 and second >= 0 and first // 3 == second // 3 == third // 3:
            return True
    return False


def loops(faces: Any, mates: Any) -> tuple[Any, Any]:
    """The half-edges without a mate, chained head to tail, and where in that list each closed chain begins.

    At the head of each one the faces are turned through until the next without a mate; that map is one to one.
    """
    free = int((mates < 0).sum())
    chain, begins = np.empty(free, np.int32), np.zeros(free + 1, np.int32)
    if not free:  # a closed surface needs nothing compiled
        return chain, begins
    chains = _chained(mates, np.zeros(len(mates), np.bool_), chain, begins)
    return chain, begins[: chains + 1]


@loop
def _chained(mates: Any, done: Any, chain: Any, begins: Any) -> int:
    n, chains = 0, 0
    for first in range(len(mates)):
        if mates[first] >= 0 or done[first]:
            continue
        begins[chains] = n
        chains += 1
        h = first
        while not done[h]:
            done[h] = True
            chain[n] = h
            n += 1
            h = following(h)
            while mates[h] >= 0:
                h = following(mates[h])
    begins[chains] = n
    return chains


def middles(vertices: Any, faces: Any) -> Any:
    """The centroid of each triangle."""
    middle = np.empty((len(faces), 3))
    _middles(vertices, faces, middle)
    return middle


@loop
def _middles(vertices: Any, faces: Any, middle: Any) -> None:
    for f in range(len(faces)):
        for k in range(3):
            middle[f, k] = (vertices[faces[f, 0], k] + vertices[faces[f, 1], k] + vertices[faces[f, 2], k]) / 3


def shapes(vertices: Any, faces: Any) -> tuple[Any, float, int, int, Any]:
    """Sums of (a - middle) . n and of |n|, the smallest angle and its vertex, flat triangles, and the normals n.

    The normal n = (b - a) x (c - a) is twice as long as the triangle is large. The smallest angle lies opposite
    the shortest side, and its tangent is |n| over the scalar product of the other two sides.
    """
    sums, normals = np.zeros(2), np.empty((len(faces), 3))
    least, where, flat = _shapes(vertices, faces, sums, normals)
    return sums, math.atan(least), int(where), int(flat), normals


@loop
def _shapes(vertices: Any, faces: Any, sums: Any, normals: Any) -> tuple[float, int, int]:
    x = y = z = 0.0
    for v in range(len(vertices)):
        x += vertices[v, 0]
        y += vertices[v, 1]
        z += vertices[v, 2]
    x, y, z = x / len(vertices), y / len(vertices), z / len(vertices)
    volume = area = 0.0
    least, where, flat = np.inf, 0, 0
    for f in range(len(faces)):
        a, b, c = faces[f, 0], faces[f, 1], faces[f, 2]
        ux, uy, uz = vertices[b, 0] - vertices[a, 0], vertices[b, 1] - vertices[a, 1], vertices[b, 2] - vertices[a, 2]
        vx, vy, vz = vertices[c, 0] - vertices[a, 0], vertices[c, 1] - vertices[a, 1], vertices[c, 2] - vertices[a, 2]
        nx, ny, nz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
        normals[f, 0], normals[f, 1], normals[f, 2] = nx, ny, nz
        length = math.sqrt(nx * nx + ny * ny + nz * nz)
        volume += (vertices[a, 0] - x) * nx + (vertices[a, 1] - y) * ny + (vertices[a, 2] - z) * nz
        area += length
        uu, vv, uv = ux * ux + uy * uy + uz * uz, vx * vx + vy * vy + vz * vz, ux * vx + uy * vy + uz * vz
        opposite = uu + vv - 2 * uv
        if opposite <= uu and opposite <= vv:
            corner, across = a, uv
        elif uu <= vv:
            corner, across = c, vv - uv
        else:
            corner, across = b, uu - uv
        flat += length <= FLAT * uu or length <= FLAT * vv or length <= FLAT * opposite
        tangent = length / across if across > 0 else 0.0
        if tangent < least:
            least, where = tangent, corner
        if f % RUN == RUN - 1:
            sums[0] += volume
            sums[1] += area
            volume = area = 0.0
    sums[0] += volume
    sums[1] += area
    return least, where, flat


@loop
def turned_from_neighbours(normals: Any, mates: Any) -> Any:
    """The triangles whose normal is turned by far from those of two neighbours."""
    turned = np.zeros(len(normals), np.bool_)
    for f in range(len(normals)):
        n, against = normals[f], 0
        for k in range(3):
            if mates[3 * f + k] >= 0:
                o = normals[mates[3 * f + k] // 3]
                product = n[0] * o[0] + n[1] * o[1] + n[2] * o[2]
                lengths = (n[0] ** 2 + n[1] ** 2 + n[2] ** 2) * (o[0] ** 2 + o[1] ** 2 + o[2] ** 2)
                against += product < TURNED * math.sqrt(lengths)
        turned[f] = against >= 2
    return turned
