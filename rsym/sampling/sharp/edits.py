"""Small edits of a mesh around its flaws, each only where the mesh stays a manifold.

Several patches may show one corner: vertices on one point are joined. Three vertices in a row on a straight edge may
make a triangle, which has no area: its long side is turned to the other diagonal of the two triangles beside it.
"""

from __future__ import annotations

from collections import defaultdict
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from rsym.sampling.sharp.flaws import FLATNESS, NO_LENGTH

# What forbids one edit may go with another.
TURNS = 3

Floats: TypeAlias = NDArray[np.float64]
Ints: TypeAlias = NDArray[np.int64]
Faces: TypeAlias = NDArray[np.int32]


def edit(quads: Ints, points: Floats, faces: Faces, leaf: NDArray[Any], lattice: Floats) -> NDArray[np.bool_]:
    """Join and turn what is flawed among some quads, in place; tells which faces remain. `leaf` is that of each face.

    What lies beside these quads stays as it is.
    """
    some = np.stack([2 * quads, 2 * quads + 1], axis=1).ravel()
    no_length = NO_LENGTH * lattice[3:].min()
    editor = Editor(points, faces, leaf, some, no_length)
    for _ in range(TURNS):
        some = some[editor.remain[some]]
        for face in some[_sides(points, faces[some]).min(axis=0) < no_length].tolist():
            editor.join(face)
        for face in some[_is_flat(points, faces[some])].tolist():
            editor.turn(face)
    return editor.remain


def _sides(points: Floats, faces: Faces) -> Floats:
    """The lengths of the sides of triangles, (3, m), each after its first corner."""
    corners = points[:, faces]
    lengths: Floats = np.linalg.norm(np.roll(corners, -1, axis=2) - corners, axis=0).T
    return lengths


def _is_flat(points: Floats, faces: Faces) -> NDArray[np.bool_]:
    """Which triangles have no area."""
    a, b, c = points[:, faces].transpose(2, 1, 0)
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    return np.asarray(area <= FLATNESS * _sides(points, faces).max(axis=0) ** 2)


class Editor:
    """A part of a mesh, with the faces around each of its vertices."""

    def __init__(self, points: Floats, faces: Faces, leaf: NDArray[Any], some: Ints, no_length: float) -> None:
        self.points, self.faces, self.leaf, self.no_length = points, faces, leaf, no_length
        self.remain = np.ones(len(faces), np.bool_)
        self.around: dict[int, set[int]] = defaultdict(set)
        for face in some.tolist():
            for vertex in faces[face].tolist():
                self.around[vertex].add(face)

    def join(self, face: int) -> None:
        """Join the ends of an edge without length if they have two neighbours in common, those across it.

        The link condition (Dey, Edelsbrunner, Guha and Nekhayev 1999).
        """
        for k in range(3):
            a, b = int(self.faces[face, k]), int(self.faces[face, k - 1])
            if not self.remain[face] or np.abs(self.points[:, a] - self.points[:, b]).max() > self.no_length:
                continue
            gone = self.around[a] & self.around[b]
            links = [{int(v) for f in self.around[vertex] for v in self.faces[f]} for vertex in (a, b)]
            if len(gone) == 2 and len(links[0] & links[1]) == 4 and len(links[0] | links[1]) > 4:
                self._merge(a, b, gone)

    def _merge(self, a: int, b: int, gone: set[int]) -> None:
        for face in gone:
            self.remain[face] = False
            for vertex in self.faces[face].tolist():
                self.around[vertex].discard(face)
        for face in self.around.pop(b):
            self.faces[face][self.faces[face] == b] = a
            self.around[a].add(face)

    def turn(self, face: int) -> None:
        """Turn the long side of a triangle without area, if both triangles beside it are on one leaf."""
        if not self.remain[face]:
            return
        if not _is_flat(self.points, self.faces[[face]]).all():
            return
        k = int(_sides(self.points, self.faces[[face]]).argmax())
        a, b, c = (int(self.faces[face, (k + turn) % 3]) for turn in range(3))
        (other,) = (self.around[a] & self.around[b]) - {face} or (face,)
        (d,) = set(self.faces[other].tolist()) - {a, b} or (c,)
        if self.leaf[other] != self.leaf[face] or self.around[c] & self.around[d]:
            return
        before, after = self._normal(b, a, d), (self._normal(a, d, c), self._normal(d, b, c))
        if min(float(before @ normal) for normal in after) > 0:
            self.faces[face], self.faces[other] = (a, d, c), (d, b, c)
            self.around[a].discard(other)
            self.around[b].discard(face)
            self.around[c].add(other)
            self.around[d].add(face)

    def _normal(self, a: int, b: int, c: int) -> Floats:
        normal: Floats = np.cross(self.points[:, b] - self.points[:, a], self.points[:, c] - self.points[:, a])
        return normal
