"""Small edits of a mesh around its flaws, in which the set of points that it covers stays.

Several patches may show one corner: vertices on one point are joined, and what has no extent then vanishes, crumbs
and tunnels alike. Three vertices in a row on a straight edge may make a triangle, which has no area: it goes, and the
triangle across its long side is cut in two.

What remains is made a manifold again. Around an edge with more than two triangles the body lies in sectors: the two
sides of each sector become neighbours. A vertex whose triangles are then several fans becomes several vertices on one
point. Where two edges still join the same two vertices, one of them gets a vertex in its middle.

Source: A. Gueziec, G. Taubin, F. Lazarus and B. Horn, IEEE Trans. Vis. Comput. Graph. 7 (2001) 136-151.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from rsym.arrays import Faces, Flags, Floats, Ints
from rsym.sampling.sharp.clusters import components
from rsym.sampling.sharp.faces import FLATNESS, Adjacency, smallest

# As far as vertices have been moved.
RINGS = 3
# All triangles of the vertices across from what is cut.
BESIDE = 2
# Cutting may bring vertices on one point together, and joining may leave triangles without area.
TURNS = 16

Corners: TypeAlias = tuple[int, int, int]
Edge: TypeAlias = tuple[int, int]


class Edited(NamedTuple):
    """Which faces may have changed, and which remain; new points (3, k), behind the others; new faces, their leaves."""

    changed: Ints
    remain: Flags
    points: Floats
    faces: Faces
    leaf: NDArray[Any]


def edit(
    adjacency: Adjacency, quads: Ints, points: Floats, faces: Faces, leaf: NDArray[Any], lattice: Floats
) -> Edited:
    """Join, cut and stitch what is flawed in some quads; `faces` and `leaf`, that of each face, change in place."""
    near, _ = adjacency.around(quads, RINGS)
    no_length = smallest(lattice)
    flawed = near[_are_flawed(points, faces.reshape(-1, 2, 3)[near], no_length)]
    near, inner = adjacency.around(flawed, BESIDE)
    some = np.stack([2 * near, 2 * near + 1], axis=1).ravel()
    soup = _Soup(points, faces[some], leaf[some], inner > 0, no_length)
    for _ in range(TURNS):
        if not (soup.join() | soup.cut()):
            break
    remain = np.ones(len(faces), np.bool_)
    remain[some] = False
    kept = some[soup.numbers]
    remain[kept] = True
    leaf[kept] = soup.leaf[soup.numbers]
    stitched = stitch(soup.faces, points, inner > 0)
    faces[kept] = stitched.faces[: len(kept)]
    return Edited(some, remain, stitched.points, stitched.faces[len(kept) :], leaf[kept[stitched.part_of[len(kept) :]]])


def _are_flawed(points: Floats, quads: Faces, no_length: float) -> Flags:
    """Which quads (m, 2, 3) have a triangle without area or an edge without length."""
    sides = _sides(points, quads.reshape(-1, 3))
    short = np.minimum.reduce([np.abs(side).max(axis=0) for side in sides]) <= no_length
    return np.asarray((short | _have_no_area(*sides)).reshape(-1, 2).any(axis=1))


class _Soup:
    """Triangles, some of them `there` still. Whatever is done, each directed edge occurs as often as its reverse."""

    def __init__(self, points: Floats, faces: Faces, leaf: NDArray[Any], inner: Any, no_length: float) -> None:
        self.points, self.inner, self.no_length = points, inner, no_length
        self.corners, self.leaf, self.there = faces, leaf, np.ones(len(faces), np.bool_)
        self.changed = np.zeros(points.shape[1], np.bool_)

    def join(self) -> bool:
        """Let the vertices at the ends of edges without length be one, and drop what has no extent; whether any is."""
        tail, head = _ends(self.faces)
        apart = np.abs(self.points[:, tail] - self.points[:, head]).max(axis=0)
        short = np.flatnonzero((apart <= self.no_length) & self.inner[tail] & self.inner[head])
        if not len(short):
            return False
        ids, local = np.unique(np.stack([tail[short], head[short]]), return_inverse=True)
        one_end, other_end = local.reshape(2, -1)
        label = components(one_end, other_end, len(ids))
        _, first = np.unique(label, return_index=True)
        one, touched = np.arange(self.points.shape[1]), np.zeros(self.points.shape[1], np.bool_)
        one[ids], touched[ids] = ids[first[label]], True
        which = self.numbers[touched[self.faces].any(axis=1)]
        self._put(which, one[self.corners[which]])
        self._cancel()
        return True

    def cut(self) -> bool:
        """Drop each triangle without area, and cut the one across its long side at the middle one of its corners."""
        faces = self.faces
        flat = self.numbers[is_flat(self.points, faces)].tolist()
        if not flat:
            return False
        long = {face: max(_turns(self._corners(face)), key=self._length) for face in flat}
        across = self._across(faces, [(b, a) for a, b, _ in long.values()])
        touched: set[int] = set()
        for face, (a, b, c) in long.items():
            for other in across[b, a]:
                # Of two without area only the one with the longer side is cut: each cut makes sides shorter.
                longer = other in long and self._length(long[other]) > self._length((a, b, c))
                if not longer and self.inner[c] and not touched & {face, other}:
                    touched |= {face, other}
                    self._cut(face, other, (a, b, c))
        self._cancel()
        return bool(touched)

    def _across(self, faces: Faces, edges: list[Edge]) -> dict[Edge, list[int]]:
        """The triangles that have some directed edges."""
        size = int(faces.max()) + 1
        half = np.flatnonzero(np.isin(_keys(faces, size), [a * size + b for a, b in edges]))
        tail, head = _ends(faces)
        found: dict[Edge, list[int]] = defaultdict(list)
        for a, b, face in zip(tail[half].tolist(), head[half].tolist(), self.numbers[half // 3].tolist(), strict=True):
            found[a, b].append(face)
        return found

    def _cut(self, face: int, other: int, corners: Corners) -> None:
        a, b, c = corners
        (d,) = set(self._corners(other)) - {a, b}
        self.leaf[face] = self.leaf[other]
        self._put(np.array([face, other]), np.array([(a, d, c), (d, b, c)]))

    def _corners(self, face: int) -> Corners:
        a, b, c = self.corners[face].tolist()
        return a, b, c

    def _length(self, corners: Corners) -> float:
        return float(np.linalg.norm(self.points[:, corners[0]] - self.points[:, corners[1]]))

    @property
    def numbers(self) -> Ints:
        """The numbers of the triangles that are left."""
        return np.flatnonzero(self.there)

    @property
    def faces(self) -> Faces:
        """The triangles that are left."""
        return self.corners[self.there]

    def _put(self, which: Ints, corners: NDArray[np.integer[Any]]) -> None:
        """Give triangles other corners; one with two equal corners is none."""
        self.changed[corners] = True
        self.corners[which] = corners
        self.there[which] = (corners != corners[:, [1, 2, 0]]).all(axis=1)

    def _cancel(self) -> None:
        """Drop triangles that lie back to back; before something changed there were none, and then there are none."""
        seen: dict[Corners, list[int]] = defaultdict(list)
        some = self.numbers[self.changed[self.faces].all(axis=1)]
        for face, (a, b, c) in zip(some.tolist(), self.corners[some].tolist(), strict=True):
            back = seen.get(min(_turns((a, c, b))))
            if back:
                self.there[[face, back.pop()]] = False
            else:
                seen[min(_turns((a, b, c)))].append(face)
        self.changed[:] = False


def is_flat(points: Floats, faces: Any) -> Flags:
    """Which triangles have no area."""
    return _have_no_area(*_sides(points, faces))


def _sides(points: Floats, faces: Any) -> tuple[Floats, Floats, Floats]:
    """From corner 0 of each triangle to 1 and 2, and from 1 to 2, as (3, m)."""
    a, b, c = (points.take(corner, axis=1) for corner in np.ascontiguousarray(faces.T, np.intp))
    return b - a, c - a, c - b


def _have_no_area(u: Floats, v: Floats, w: Floats) -> Flags:
    normal = np.stack([u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]])
    longest = np.maximum.reduce([_lengths(side) for side in (u, v, w)])
    return np.asarray(_lengths(normal) <= FLATNESS * longest**2)


def _lengths(sides: Floats) -> Floats:
    x, y, z = sides
    return np.asarray(np.sqrt(x * x + y * y + z * z))


def _turns(corners: Corners) -> Iterable[Corners]:
    a, b, c = corners
    return (a, b, c), (b, c, a), (c, a, b)


def _ends(faces: Faces) -> tuple[Faces, Faces]:
    """Where each half-edge 3*face + k begins and ends."""
    return faces.ravel(), faces[:, [1, 2, 0]].ravel()


def _keys(faces: Faces, size: int) -> Ints:
    """A number for each directed edge, that of half-edge 3*face + k, where vertices are below `size`."""
    return (faces.astype(np.int64) * size + faces[:, [1, 2, 0]]).ravel()


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
    if len(np.unique(_keys(apart, int(apart.max()) + 1))) == apart.size:  # no two edges join the same vertices
        return Stitched(apart, np.arange(len(apart)), points[:, copied])
    middles = _Middles(apart.tolist(), mates.tolist(), points.shape[1] + len(copied))
    middles.insert()
    count = points.shape[1]
    ends = np.array([[copied[v - count] if v >= count else v for v in pair] for pair in middles.ends], np.int64)
    added = np.concatenate([points[:, copied], points[:, ends.reshape(-1, 2)].mean(axis=2)], axis=1)
    return Stitched(np.array(middles.faces, np.int32), np.array(middles.part_of), added)


def _mates(faces: Faces, points: Floats) -> Ints:
    """The half-edge across each half-edge 3*face + k, -1 where there is none."""
    tail, head = (ends.astype(np.int64) for ends in _ends(faces))
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
