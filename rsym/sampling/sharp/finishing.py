"""The last stage, on the whole surface: folds out, vertices on one corner joined, arrays as a mesh has them."""

from __future__ import annotations

from concurrent.futures import Executor
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from rsym.arrays import Floats, Ints
from rsym.errors import RsymError
from rsym.sampling.kernels.mesher_kernels import MesherKernels
from rsym.sampling.sharp.assembly import Unfinished
from rsym.sampling.sharp.crossings import CompiledLeaves
from rsym.sampling.sharp.edits import edit
from rsym.sampling.sharp.faces import FLAT, FOLDED, SHORT, TURNED, Adjacency, facing_inwards
from rsym.sampling.sharp.loops import in_threads, loop
from rsym.sampling.sharp.unfolding import unfold
from rsym.sampling.sharp.untangling import untangle

Faces: TypeAlias = NDArray[np.int32]

GRAIN = 16384


@dataclass(frozen=True)
class Finished:
    """Vertices (n, 3), faces (m, 3), and the leaf of each face."""

    vertices: Floats
    faces: Faces
    leaf: NDArray[np.int16]

    def some(self, which: NDArray[np.bool_]) -> Finished:
        """Some of the faces, and their vertices."""
        return Finished(self.vertices, self.faces[which], self.leaf[which]).renumbered()

    def renumbered(self) -> Finished:
        """Without the vertices that no face has; the faces change in place."""
        used = np.zeros(len(self.vertices), np.bool_)
        _mark(self.faces, used)
        if used.all():
            return self
        _renumber(self.faces, np.cumsum(used, dtype=np.int32) - np.int32(1))
        return Finished(self.vertices[used], self.faces, self.leaf)


@loop
def _mark(faces: Faces, used: NDArray[np.bool_]) -> None:
    for f in range(len(faces)):
        for k in range(3):
            used[faces[f, k]] = True


@loop
def _renumber(faces: Faces, number: Faces) -> None:
    for f in range(len(faces)):
        for k in range(3):
            faces[f, k] = number[faces[f, k]]


@loop
def _rows(first: int, last: int, points: Floats, vertices: Floats) -> None:
    for v in range(first, last):
        for axis in range(3):
            vertices[v, axis] = points[axis, v]


def finish(kernels: MesherKernels, surface: Unfinished, lattice: Floats, pool: Executor | None) -> Finished:
    """The triangles of quads: 2*e and 2*e + 1 of quad e, on leaf e; points and faces are changed in place."""
    points, count, faces, leaf, flaws = surface.points, surface.vertices, surface.faces, surface.leaf, surface.flaws
    flawed, suspects = np.flatnonzero(flaws & (FOLDED | FLAT | SHORT)), np.repeat(flaws & (FOLDED | TURNED) > 0, 2)
    adjacency = Adjacency(faces, points.shape[1]) if len(flawed) else None
    if adjacency is not None and (flaws & (FOLDED | FLAT)).any():
        tangled = np.flatnonzero(flaws & (FOLDED | FLAT))
        moved = untangle(kernels, adjacency, tangled, leaf, points, faces, lattice, pool)
        suspects.reshape(-1, 2)[moved] = True
    vertices = np.empty((count, 3))
    in_threads(lambda a, b: _rows(a, b, points, vertices), count, GRAIN, pool)
    whole = Finished(vertices, faces, np.repeat(leaf[: len(flaws)], 2))
    if adjacency is not None:
        whole, suspects = _edited(whole, adjacency, flawed, points[:, :count], suspects, lattice)
    some = np.flatnonzero(suspects)
    folded, _ = facing_inwards(CompiledLeaves(kernels), whole.vertices[whole.faces[some]], whole.leaf[some])
    if not folded.any():
        return whole
    return whole.some(unfold(kernels, whole.vertices, whole.faces, whole.leaf, some[folded], lattice, pool))


def _edited(
    whole: Finished,
    adjacency: Adjacency,
    flawed: Ints,
    points: Floats,
    suspects: NDArray[np.bool_],
    lattice: Floats,
) -> tuple[Finished, NDArray[np.bool_]]:
    """The triangles edited around their flaws, and which of them may face inwards."""
    found = edit(adjacency, flawed, points, whole.faces, whole.leaf, lattice)
    suspects[found.changed] = True
    if found.remain.all() and not len(found.faces):
        return whole, suspects
    if not (found.remain.any() or len(found.faces)):
        raise RsymError(
            "the body has no extent: its surface is points and curves",
            code="no-surface",
            remedy="check bounds and letters; take a higher resolution if the body is thin",
        )
    edited = Finished(
        np.concatenate([whole.vertices, found.points.T]),
        np.concatenate([whole.faces[found.remain], found.faces]),
        np.concatenate([whole.leaf[found.remain], found.leaf]),
    )
    return edited.renumbered(), np.concatenate([suspects[found.remain], np.ones(len(found.faces), np.bool_)])
