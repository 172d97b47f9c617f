"""Small edits of a mesh around its flaws, in which the set of points that it covers stays.

Several patches may show one corner: vertices on one point are joined, and what has no extent then vanishes, crumbs
and tunnels alike. Three vertices in a row on a straight edge may make a triangle, which has no area: it goes, and the
triangle across its long side is cut in two. What remains is made a manifold again.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from rsym.sampling.sharp.clusters import components
from rsym.sampling.sharp.flaws import FLATNESS, Adjacency, smallest
from rsym.sampling.sharp.stitching import stitch

# As far as vertices have been moved.
RINGS = 3
# All triangles of the vertices across from what is cut.
BESIDE = 2
# Cutting may bring vertices on one point together, and joining may leave triangles without area.
TURNS = 16

Floats: TypeAlias = NDArray[np.float64]
Ints: TypeAlias = NDArray[np.int64]
Faces: TypeAlias = NDArray[np.int32]
Corners: TypeAlias = tuple[int, int, int]
Edge: TypeAlias = tuple[int, int]


class Edited(NamedTuple):
    """Which faces may have changed, and which remain; new points (3, k), behind the others; new faces, their leaves."""

    changed: Ints
    remain: NDArray[np.bool_]
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
    leaf[kept] = [soup.leaf[face] for face in soup.corners]
    stitched = stitch(soup.faces, points, inner > 0)
    faces[kept] = stitched.faces[: len(kept)]
    return Edited(some, remain, stitched.points, stitched.faces[len(kept) :], leaf[kept[stitched.part_of[len(kept) :]]])


def _are_flawed(points: Floats, quads: Faces, no_length: float) -> NDArray[np.bool_]:
    """Which quads (m, 2, 3) have a triangle without area or an edge without length."""
    corners = points[:, quads]
    short = np.abs(np.roll(corners, -1, axis=3) - corners).max(axis=0).min(axis=2) <= no_length
    return np.asarray((short | is_flat(points, quads.reshape(-1, 3)).reshape(-1, 2)).any(axis=1))


class _Soup:
    """Triangles by number. Whatever is done, each directed edge occurs as often as its reverse."""

    def __init__(self, points: Floats, faces: Faces, leaf: NDArray[Any], inner: Any, no_length: float) -> None:
        self.points, self.inner, self.no_length = points, inner, no_length
        self.corners: dict[int, Corners] = {face: (a, b, c) for face, (a, b, c) in enumerate(faces.tolist())}
        self.leaf: dict[int, int] = dict(enumerate(leaf.tolist()))
        self.changed: set[int] = set()

    def join(self) -> bool:
        """Let the vertices at the ends of edges without length be one, and drop what has no extent; whether any is."""
        tail, head = self.faces.ravel(), np.roll(self.faces, -1, axis=1).ravel()
        apart = np.abs(self.points[:, tail] - self.points[:, head]).max(axis=0)
        short = np.flatnonzero((apart <= self.no_length) & self.inner[tail] & self.inner[head])
        if not len(short):
            return False
        ids, local = np.unique(np.stack([tail[short], head[short]]), return_inverse=True)
        one_end, other_end = local.reshape(2, -1)
        label = components(one_end, other_end, len(ids))
        _, first = np.unique(label, return_index=True)
        one = dict(zip(ids.tolist(), ids[first[label]].tolist(), strict=True))
        for face, (a, b, c) in list(self.corners.items()):
            if a in one or b in one or c in one:
                self._put(face, (one.get(a, a), one.get(b, b), one.get(c, c)))
        self._cancel()
        return True

    def cut(self) -> bool:
        """Drop each triangle without area, and cut the one across its long side at the middle one of its corners."""
        flat = self.numbers[is_flat(self.points, self.faces)].tolist()
        if not flat:
            return False
        long = {face: max(_turns(self.corners[face]), key=self._length) for face in flat}
        across: dict[Edge, list[int]] = defaultdict(list)
        for face, corners in self.corners.items():
            for edge in _edges(corners):
                across[edge].append(face)
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

    def _cut(self, face: int, other: int, corners: Corners) -> None:
        a, b, c = corners
        (d,) = set(self.corners[other]) - {a, b}
        self.leaf[face] = self.leaf[other]
        self._put(face, (a, d, c))
        self._put(other, (d, b, c))

    def _length(self, corners: Corners) -> float:
        return float(np.linalg.norm(self.points[:, corners[0]] - self.points[:, corners[1]]))

    @property
    def numbers(self) -> Ints:
        """The numbers of the triangles that are left."""
        return np.fromiter(self.corners, np.int64, len(self.corners))

    @property
    def faces(self) -> Faces:
        """The triangles that are left."""
        return np.array(list(self.corners.values()), np.int32).reshape(-1, 3)

    def _put(self, face: int, corners: Corners) -> None:
        """A triangle with two equal corners is none."""
        self.changed.update(corners)
        if len(set(corners)) == 3:
            self.corners[face] = corners
        else:
            del self.corners[face]

    def _cancel(self) -> None:
        """Drop triangles that lie back to back; before something changed there were none."""
        seen: dict[Corners, list[int]] = defaultdict(list)
        for face, (a, b, c) in list(self.corners.items()):
            if a in self.changed and b in self.changed and c in self.changed:
                back = seen.get(min(_turns((a, c, b))))
                if back:
                    del self.corners[face], self.corners[back.pop()]
                else:
                    seen[min(_turns((a, b, c)))].append(face)


def is_flat(points: Floats, faces: Any) -> NDArray[np.bool_]:
    """Which triangles have no area."""
    a, b, c = points[:, faces].transpose(2, 1, 0)
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    longest = np.maximum.reduce([np.linalg.norm(side, axis=1) for side in (b - a, c - b, a - c)])
    return np.asarray(area <= FLATNESS * longest**2)


def _turns(corners: Corners) -> Iterable[Corners]:
    a, b, c = corners
    return (a, b, c), (b, c, a), (c, a, b)


def _edges(corners: Corners) -> Iterator[Edge]:
    a, b, c = corners
    yield from ((a, b), (b, c), (c, a))
