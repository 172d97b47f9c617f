"""The last stage, on the whole surface: folds out, vertices on one corner joined, arrays as a mesh has them."""

from __future__ import annotations

from concurrent.futures import Executor
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from rsym.codegen.surface_kernels import SurfaceKernels
from rsym.errors import RsymError
from rsym.sampling.sharp.edits import edit
from rsym.sampling.sharp.flaws import FLAT, FOLDED
from rsym.sampling.sharp.untangling import untangle

Floats: TypeAlias = NDArray[np.float64]
Faces: TypeAlias = NDArray[np.int32]


@dataclass(frozen=True)
class Triangles:
    """Vertices (n, 3), faces (m, 3), and the leaf of each face."""

    vertices: Floats
    faces: Faces
    leaf: NDArray[np.int16]

    def used(self) -> Triangles:
        """Without the vertices that no face has."""
        return self.some(np.ones(len(self.faces), np.bool_))

    def some(self, which: NDArray[np.bool_]) -> Triangles:
        """Some of the faces, and their vertices."""
        faces = self.faces[which]
        used = np.zeros(len(self.vertices), np.bool_)
        used[faces] = True
        number = np.cumsum(used, dtype=np.int32) - 1
        return Triangles(self.vertices[used], number[faces], self.leaf[which])


def finish(
    kernels: SurfaceKernels,
    points: Floats,
    count: int,
    faces: Faces,
    leaf: NDArray[np.int16],
    flaws: NDArray[Any],
    lattice: Floats,
    pool: Executor | None,
) -> Triangles:
    """The triangles of quads: points (3, m) of which `count` are vertices, faces 2*e and 2*e + 1 of quad e on leaf e.

    `flaws` (quads,) as `find_flaws` tells them; points and faces are changed in place.
    """
    tangled = np.flatnonzero(flaws & (FOLDED | FLAT))
    if len(tangled):
        untangle(kernels, tangled, leaf, points, faces, lattice, pool)
    points, leaf = points[:, :count], np.repeat(leaf[: len(flaws)], 2)
    flawed = np.flatnonzero(flaws)
    if not len(flawed):
        return Triangles(np.ascontiguousarray(points.T), faces, leaf)
    remain, *new = edit(flawed, points, faces, leaf, lattice, pool)
    if not (remain.any() or len(new[1])):
        raise RsymError(
            "the body has no extent: its surface is points and curves",
            code="no-surface",
            remedy="check bounds and letters; take a higher resolution if the body is thin",
        )
    points, faces, leaf = (
        np.concatenate([old, more], axis=axis)
        for old, more, axis in zip((points, faces[remain], leaf[remain]), new, (1, 0, 0), strict=True)
    )
    return Triangles(np.ascontiguousarray(points.T), faces, leaf).used()
