"""Triangles whose edges occur as often as their reverses, made a manifold: cut where more than two meet, and stitched.

Around an edge with more than two triangles the body lies in sectors: the two sides of each sector become neighbours.
A vertex whose triangles are then several fans becomes several vertices on one point. Where two edges still join the
same two vertices, one of them gets a vertex in its middle.

Source: A. Gueziec, G. Taubin, F. Lazarus and B. Horn, IEEE Trans. Vis. Comput. Graph. 7 (2001) 136-151.
"""

from __future__ import annotations

from collections import defaultdict
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from rsym.sampling.sharp.clusters import components

Floats: TypeAlias = NDArray[np.float64]
Ints: TypeAlias = NDArray[np.int64]
Faces: TypeAlias = NDArray[np.int32]


class Stitched(NamedTuple):
    """Triangles as given, then new ones; whose part each is; new points (3, k), numbered behind the others."""

    faces: Faces
    part_of: Ints
    points: Floats


def stitch(faces: Faces, points: Floats, inner: Any) -> Stitched:
    """The manifold of triangles (m, 3); only vertices marked in `inner` may become several."""
    if not len(faces):
        return Stitched(faces, np.empty(0, np.int64), points[:, :0])
    mates = _mates(faces, points)
    apart, copied = _fans(faces, mates, inner, points.shape[1])
    middles = _Middles(apart.tolist(), mates.tolist(), points.shape[1] + len(copied))
    middles.insert()
    count = points.shape[1]
    ends = np.array([[copied[v - count] if v >= count else v for v in pair] for pair in middles.ends], np.int64)
    added = np.concatenate([points[:, copied], points[:, ends.reshape(-1, 2)].mean(axis=2)], axis=1)
    return Stitched(np.array(middles.faces, np.int32), np.array(middles.part_of), added)


def _mates(faces: Faces, points: Floats) -> Ints:
    """The half-edge across each half-edge 3*face + k, -1 where there is none."""
    tail, head = faces.ravel().astype(np.int64), np.roll(faces, -1, axis=1).ravel().astype(np.int64)
    size = int(faces.max()) + 1
    key, reverse = tail * size + head, head * size + tail
    order = np.argsort(key, kind="stable")
    first = np.searchsorted(key[order], reverse)
    count = np.searchsorted(key[order], reverse, "right") - first
    mates = np.where(count == 1, order[np.minimum(first, len(key) - 1)], -1)
    for edge in np.unique(key[count > 1]):
        a, b = divmod(int(edge), size)
        if a < b:
            along, against = (np.flatnonzero(key == k) for k in (edge, b * size + a))
            for one, other in _sectors(points, a, b, faces, along, against):
                mates[one], mates[other] = other, one
    return mates


def _sectors(points: Floats, a: int, b: int, faces: Faces, along: Ints, against: Ints) -> list[tuple[int, int]]:
    """Pairs of half-edges that bound the sectors of the body around an edge.

    Seen along the edge and anticlockwise, the body begins at a triangle that runs against it, and ends at one along it.
    """
    axis = points[:, b] - points[:, a]
    half = np.concatenate([along, against])
    apex = points[:, faces[half // 3, (half + 2) % 3]] - points[:, [a]]
    u = np.cross(axis, np.eye(3)[np.abs(axis).argmin()])
    v = np.cross(axis, u)
    angle = np.arctan2(v @ apex / np.linalg.norm(v), u @ apex / np.linalg.norm(u))
    opened: list[int] = []
    pairs: list[tuple[int, int]] = []
    for at in np.tile(np.argsort(angle, kind="stable"), 2).tolist():  # a sector may begin before the first angle
        if at >= len(along):
            if half[at] not in opened and half[at] not in (other for _, other in pairs):
                opened.append(int(half[at]))
        elif opened and half[at] not in (one for one, _ in pairs):
            pairs.append((int(half[at]), opened.pop()))
    return pairs


def _fans(faces: Faces, mates: Ints, inner: Any, vertices: int) -> tuple[Faces, list[int]]:
    """The triangles with a vertex of its own for each fan, and of which vertices the new ones are copies."""
    half = np.flatnonzero(mates >= 0)
    following = mates[half] // 3 * 3 + (mates[half] + 1) % 3
    fan = components(half, following, faces.size)
    _, first = np.unique(fan, return_index=True)
    vertex = faces.ravel()[first]
    _, kept = np.unique(vertex, return_index=True)
    own = vertex.copy()
    extra = np.setdiff1d(np.flatnonzero(inner[vertex]), kept)
    own[extra] = vertices + np.arange(len(extra))
    return own[fan].reshape(faces.shape), vertex[extra].tolist()


class _Middles:
    """Vertices in the middles of edges that join the same vertices as others."""

    def __init__(self, faces: list[list[int]], mates: list[int], vertices: int) -> None:
        self.faces, self.mates, self.vertices = faces, mates, vertices
        self.part_of = list(range(len(faces)))
        self.ends: list[tuple[int, int]] = []
        self.halves: dict[tuple[int, int], list[int]] = defaultdict(list)
        for face, corners in enumerate(faces):
            for k in range(3):
                self.halves[corners[k], corners[k - 2]].append(3 * face + k)

    def insert(self) -> None:
        """Cut all but one of the edges that join the same vertices."""
        for a, b in [edge for edge, halves in self.halves.items() if len(halves) > 1 and edge[0] < edge[1]]:
            while len(self.halves[a, b]) > 1:
                self._cut(self.halves[a, b].pop(), a, b)

    def _cut(self, half: int, a: int, b: int) -> None:
        other, middle = self.mates[half], self.vertices + len(self.ends)
        self.ends.append((a, b))
        first, second = self._split(half, middle), self._split(other, middle)
        self._join(half, second)
        self._join(other, first)

    def _split(self, half: int, middle: int) -> int:
        """Cut a triangle from the middle of a half-edge to the corner across; the half-edge that begins there."""
        face, k = divmod(half, 3)
        corners, following, new = self.faces[face], 3 * face + (k + 1) % 3, 3 * len(self.faces)
        moved = self.halves.get((corners[k - 2], corners[k - 1]), [])
        if following in moved:
            moved[moved.index(following)] = new + 1
        self.faces.append([middle, corners[k - 2], corners[k - 1]])
        corners[k - 2] = middle
        self.part_of.append(self.part_of[face])
        self.mates += [-1, -1, -1]
        self._join(new + 1, self.mates[following])
        self._join(following, new + 2)
        return new

    def _join(self, one: int, other: int) -> None:
        self.mates[one] = other
        if other >= 0:
            self.mates[other] = one
