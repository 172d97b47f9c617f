"""The last stage, on the whole surface: folds out, vertices on one corner joined, arrays as a mesh has them."""

from __future__ import annotations

from concurrent.futures import Executor
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rsym.arrays import Faces, Flags, Floats, Ints
from rsym.errors import RsymError
from rsym.sampling.kernels.mesher_kernels import MesherKernels
from rsym.sampling.sharp.assembly import Unfinished
from rsym.sampling.sharp.crossings import CompiledLeaves
from rsym.sampling.sharp.edits import edit
from rsym.sampling.sharp.faces import FLAT, FOLDED, SHORT, TURNED, Adjacency, BeyondRim, facing_inwards
from rsym.sampling.sharp.loops import in_threads, loop
from rsym.sampling.sharp.unfolding import RINGS as UNFOLDED
from rsym.sampling.sharp.unfolding import unfold
from rsym.sampling.sharp.untangling import untangle

GRAIN = 16384


@dataclass(frozen=True)
class Finished:
    """Vertices (n, 3), faces (m, 3), and the leaf of each face."""

    vertices: Floats
    faces: Faces
    leaf: NDArray[np.int16]

    def some(self, which: Flags) -> Finished:
        """Some of the faces, and their vertices."""
        return Finished(self.vertices, self.faces[which], self.leaf[which]).renumbered()

    def renumbered(self) -> Finished:
        """Without the vertices that no face has; the faces change in place."""
        used = np.zeros(len(self.vertices), np.bool_)
        mark(self.faces, used)
        if used.all():
            return self
        renumber(self.faces, np.cumsum(used, dtype=np.int32) - np.int32(1))
        return Finished(self.vertices[used], self.faces, self.leaf)


@loop
def mark(faces: Faces, used: Flags) -> None:
    """Mark the vertices of faces."""
    for f in range(len(faces)):
        for k in range(3):
            used[faces[f, k]] = True


@loop
def renumber(faces: Faces, number: Faces) -> None:
    """Give the vertices of faces other numbers, in place."""
    for f in range(len(faces)):
        for k in range(3):
            faces[f, k] = number[faces[f, k]]


@dataclass(frozen=True)
class Reworked:
    """The triangles without flaws, before vertices that no face has are left out.

    Vertices (n, 3): those given, then new ones. Faces (m, 3) with their leaves: of those given the ones that `remain`,
    all where that is None, then new ones.
    """

    vertices: Floats
    faces: Faces
    leaf: NDArray[np.int16]
    remain: Flags | None = None


def finish(kernels: MesherKernels, surface: Unfinished, lattice: Floats, pool: Executor | None) -> Finished:
    """The triangles of quads: 2*e and 2*e + 1 of quad e, on leaf e; points and faces are changed in place."""
    made = rework(kernels, surface, lattice, pool)
    if 2 * len(made.faces) < len(surface.faces):
        raise nothing_left()
    whole = Finished(made.vertices, made.faces, made.leaf)
    return whole if made.remain is None else whole.renumbered()


def nothing_left() -> RsymError:
    """Of a surface most was folds, which had to go: it says nothing of the body."""
    return RsymError(
        "at this resolution most of the surface folds onto itself, and nothing of the body is left of it",
        code="no-surface",
        remedy="take a higher resolution; if that is of no help the body may be points and curves: check its letters",
    )


def rework(
    kernels: MesherKernels, surface: Unfinished, lattice: Floats, pool: Executor | None, rim: Flags | None = None
) -> Reworked:
    """As `finish`, of a part of a surface too: `BeyondRim` if it matters what is beyond the vertices in `rim`."""
    points, count, faces, leaf, flaws = surface.points, surface.vertices, surface.faces, surface.leaf, surface.flaws
    flawed, suspects = np.flatnonzero(flaws & (FOLDED | FLAT | SHORT)), np.repeat(flaws & (FOLDED | TURNED) > 0, 2)
    adjacency = Adjacency(faces, points.shape[1], rim) if len(flawed) else None
    if adjacency is not None and (flaws & (FOLDED | FLAT)).any():
        tangled = np.flatnonzero(flaws & (FOLDED | FLAT))
        moved = untangle(kernels, adjacency, tangled, leaf, points, faces, lattice, pool)
        suspects.reshape(-1, 2)[moved] = True
    vertices = np.empty((count, 3))
    in_threads(lambda a, b: np.copyto(vertices[a:b], points[:, a:b].T), count, GRAIN, pool)
    made = Reworked(vertices, faces, np.repeat(leaf[: len(flaws)], 2))
    if adjacency is not None:
        made, suspects = _edited(made, adjacency, flawed, points[:, :count], suspects, lattice)
    some = np.flatnonzero(suspects)
    folded, _ = facing_inwards(CompiledLeaves(kernels), made.vertices[made.faces[some]], made.leaf[some])
    if not folded.any():
        return made
    if rim is not None:
        _check_rim(made.faces, some[folded], np.append(rim, np.zeros(len(made.vertices) - len(rim), np.bool_)))
    kept = unfold(kernels, made.vertices, made.faces, made.leaf, some[folded], lattice, pool)
    remain = np.ones(2 * len(flaws), np.bool_) if made.remain is None else made.remain.copy()
    given = np.flatnonzero(remain)
    remain[given] = kept[: len(given)]
    return Reworked(made.vertices, made.faces[kept], made.leaf[kept], remain)


def _check_rim(faces: Faces, folded: Ints, rim: Flags) -> None:
    """Refuse to unfold what reaches the rim."""
    around, held = np.zeros(len(faces), np.bool_), np.zeros(len(rim), np.bool_)
    around[folded] = True
    for _ in range(UNFOLDED + 1):
        held[faces[around]] = True
        around |= held[faces].any(axis=1)
    if (held & rim).any():
        raise BeyondRim(np.flatnonzero(held & rim))


def _edited(
    whole: Reworked,
    adjacency: Adjacency,
    flawed: Ints,
    points: Floats,
    suspects: Flags,
    lattice: Floats,
) -> tuple[Reworked, Flags]:
    """The triangles edited around their flaws, and which of them may face inwards."""
    found = edit(adjacency, flawed, points, whole.faces, whole.leaf, lattice)
    suspects[found.changed] = True
    if found.remain.all() and not len(found.faces):
        return whole, suspects
    edited = Reworked(
        np.concatenate([whole.vertices, found.points.T]),
        np.concatenate([whole.faces[found.remain], found.faces]),
        np.concatenate([whole.leaf[found.remain], found.leaf]),
        found.remain,
    )
    return edited, np.concatenate([suspects[found.remain], np.ones(len(found.faces), np.bool_)])
