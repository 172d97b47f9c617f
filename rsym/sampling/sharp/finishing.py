"""The last stage, on the whole surface: folds out, vertices on one corner joined, arrays as a mesh has them.

Where vertices of an edge came to stand in the wrong order, they move along it. A vertex belongs to a cell, its feature
may pass beside that cell, and so two vertices on one edge may stand the wrong way round. Near such folds every vertex
moves to where it is the middle of its neighbours, those on an edge along that edge, corners not at all, and goes back
to its leaves by Newton's method; what does not end on the surface stays where it was. Vertices between two copies of
one corner end on that corner.
"""

from __future__ import annotations

from concurrent.futures import Executor
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rsym.arrays import Faces, Flags, Floats, Ints
from rsym.errors import RsymError
from rsym.sampling.kernels.mesher_kernels import MesherKernels, padded
from rsym.sampling.sharp.assembly import Unfinished
from rsym.sampling.sharp.corners import off_surface, on_surface, solve
from rsym.sampling.sharp.crossings import CompiledLeaves, evaluate
from rsym.sampling.sharp.edits import edit
from rsym.sampling.sharp.faces import (
    FLAT,
    FOLDED,
    SHORT,
    TURNED,
    Adjacency,
    BeyondRim,
    facing_inwards,
    find_flaws,
    turn_diagonals,
)
from rsym.sampling.sharp.loops import in_threads, loop
from rsym.sampling.sharp.unfolding import RINGS as UNFOLDED
from rsym.sampling.sharp.unfolding import unfold
from rsym.sampling.triangles import pair, pieces

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


@loop
def _rows(first: int, last: int, points: Floats, vertices: Floats) -> None:
    for v in range(first, last):
        for axis in range(3):
            vertices[v, axis] = points[axis, v]


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
    if not len(made.faces):
        raise RsymError(
            "the body has no extent: its surface is points and curves",
            code="no-surface",
            remedy="check bounds and letters; take a higher resolution if the body is thin",
        )
    whole = Finished(made.vertices, made.faces, made.leaf)
    return whole if made.remain is None else whole.renumbered()


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
    in_threads(lambda a, b: _rows(a, b, points, vertices), count, GRAIN, pool)
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


RINGS = 3
# One does it where leaves are planes; curved ones take two or three.
ROUNDS = 6
# Rounds in a row that make no cluster better, before the rest are given up: 129 of 131 flawed meshes of the models stay
# what they were, and the two others come closer to their volumes. With one, a fold more is left on a car.
PATIENCE = 2
PULLS = 3
# Quads of a patch, up to which handing its loops to threads takes longer than they do.
ALONE = 16384
# Steps of half again their length halve what is missing across a patch of eight vertices, and between two copies of a
# corner, where it counts, they leave nothing. What else is missing is made good by rounds.
FURTHER, SWEEPS = 1.5, 80


def untangle(
    kernels: MesherKernels,
    adjacency: Adjacency,
    folded: Ints,
    leaf: NDArray[np.int16],
    points: Floats,
    faces: Faces,
    lattice: Floats,
    pool: Executor | None,
) -> Ints:
    """Move vertices and turn diagonals around folded quads, in place; `leaf` is that of each quad. The quads touched.

    Where that leaves folds, the vertices of what is folded go to the seam beside them first, and lie flat there.
    """
    touched: list[Ints] = []
    for turn in range(1 + PULLS):
        patch = _Patch(kernels, adjacency, folded, leaf, points, faces, lattice, pool)
        if turn:
            patch.pull(to_corners=turn > 1)
        patch.relax()
        folded = patch.settle(points, faces)
        touched.append(patch.quads)
        if not len(folded):
            break
    return np.concatenate(touched)


class _Patch:
    """A part of a mesh, in clusters that do not touch, and what is best of each so far."""

    def __init__(
        self,
        kernels: MesherKernels,
        adjacency: Adjacency,
        folded: Ints,
        leaf: NDArray[np.int16],
        points: Floats,
        faces: Faces,
        lattice: Floats,
        pool: Executor | None,
    ) -> None:
        near, inner = adjacency.around(folded, RINGS)
        self.quads = quads = adjacency.around(near, 1)[0]  # all that the neighbours meet
        self.kernels, self.lattice, self.pool = kernels, lattice, pool if len(quads) > ALONE else None
        own, number = faces.reshape(-1, 6)[quads], np.zeros(points.shape[1], np.int32)
        number[own] = 1
        self.ids = np.flatnonzero(number)
        number[self.ids] = np.arange(len(self.ids))
        self.faces = number[own].reshape(-1, 3)
        self.points, self.leaf = np.zeros((3, padded(len(self.ids)))), np.ascontiguousarray(leaf[quads])
        self.points[:, : len(self.ids)] = points[:, self.ids]
        self.names, self.codes = np.unique(self.leaf, return_inverse=True)
        self.meets = np.zeros((len(self.ids), len(self.names)), np.bool_)
        self.meets[self.faces.ravel(), np.repeat(self.codes, 6)] = True
        self.several = self.meets.sum(axis=1)
        self.movable = (inner[self.ids] > 0) & (self.several <= 2)
        self.cluster = pieces(self.faces, len(self.ids))
        self.folded = self._folds()
        self.best = self.points.copy(), self.faces.copy(), self.folded
        self.fewest = self._count(self.folded) + 1

    def relax(self) -> None:
        """Vertices to the middles of their neighbours and back onto their leaves, until no fold is left or it is late.

        Those on a seam of leaves have neighbours along it; corners stay.
        """
        waited = 0
        for _ in range(ROUNDS):
            tail, head = self.faces.ravel(), self.faces[:, [1, 2, 0]].ravel()
            seam = _seams(self.faces, len(self.ids), self.codes)
            follows = self.movable[tail] & ((self.several[tail] == 1) | seam)
            count = np.bincount(tail[follows], minlength=len(self.ids))
            which = np.flatnonzero(count >= 2)
            if len(which):
                self._move(which, self.meets[which], _harmonic(which, tail[follows], head[follows], count, self.points))
            turn_diagonals(self.kernels, np.ones(len(self.quads), np.uint8), self.points, self.faces, self.pool)
            waited = 0 if self._keep_better() else waited + 1
            if waited == PATIENCE or not self.fewest.any():
                break

    def pull(self, to_corners: bool) -> None:
        """The vertices of folded triangles to the nearest seam beside them, or those on seams to the nearest corner."""
        tail, head = self.faces[:, [0, 1, 2, 1, 2, 0]].ravel(), self.faces[:, [1, 2, 0, 0, 1, 2]].ravel()
        folded = np.zeros(len(self.ids), np.bool_)
        folded[self.faces.reshape(-1, 6)[self.folded]] = True
        good = (folded & self.movable & (self.several == 1 + to_corners))[tail]
        good &= ((self.several > 2) if to_corners else (self.several == 2))[head]
        tail, head = tail[good], head[good]
        good = (self.meets[tail] <= self.meets[head]).all(axis=1)
        tail, head = tail[good], head[good]
        order = np.lexsort((np.linalg.norm(self.points[:, tail] - self.points[:, head], axis=0), tail))
        which, first = np.unique(tail[order], return_index=True)
        nearest = head[order[first]]
        if to_corners:
            self.points[:, which] = self.points[:, nearest]
        elif len(which):
            which = self._move(which, self.meets[nearest], self.points[:, which])
        self.movable[which] = False
        self._keep_better()

    def settle(self, points: Floats, faces: Faces) -> Ints:
        """Put what is best in its place in the mesh; the quads that are folded still."""
        self.points, self.faces, self.folded = self.best
        points[:, self.ids] = self.points[:, : len(self.ids)]
        faces.reshape(-1, 6)[self.quads] = self.ids[self.faces.reshape(-1, 6)]
        return self.quads[self.folded]

    def _move(self, which: Ints, meets: Flags, start: Floats) -> Ints:
        """Onto their leaves from where they start; those that end there, not far from where they were."""
        leaves = np.full((3, len(which)), -1, np.int16)
        row, own = np.nonzero(meets)
        leaves[np.arange(len(row)) - np.searchsorted(row, row), row] = self.names[own]
        moved = solve(self.kernels, leaves, start, self.lattice, self.pool)
        near = (np.abs(moved - self.points[:, which]) < RINGS * self.lattice[3:].max()).all(axis=0)
        good: Flags = near & on_surface(off_surface(self.kernels, moved, self.lattice, self.pool), self.lattice)
        self.points[:, which[good]] = moved[:, good]
        done: Ints = which[good]
        return done

    def _keep_better(self) -> bool:
        """Keep the clusters that have fewer folds than ever; whether one has."""
        self.folded = self._folds()
        folds = self._count(self.folded)
        better = folds < self.fewest
        self.fewest[better] = folds[better]
        of_vertex = better[self.cluster]
        if not better.any():
            return False
        of_quad = of_vertex[self.faces[::2, 0]]
        points, faces, folded = self.best
        points = np.where(
            np.append(of_vertex, np.zeros(points.shape[1] - len(of_vertex), np.bool_)), self.points, points
        )
        self.best = (
            points,
            np.where(np.repeat(of_quad, 2)[:, None], self.faces, faces),
            np.where(of_quad, self.folded, folded),
        )
        return True

    def _count(self, folds: Flags) -> Ints:
        return np.bincount(self.cluster[self.faces[::2, 0]][folds], minlength=self.cluster.max() + 1)

    def _folds(self) -> Flags:
        """Which quads are folded against the gradient of their leaf at the middle of their corners."""
        count = len(self.leaf)
        middles, gradients = np.zeros((3, padded(count))), np.zeros((3, padded(count)))
        which = np.full(padded(count), -1, np.int16)
        for column in np.ascontiguousarray(self.faces.reshape(-1, 6).T, np.intp):
            middles[:, :count] += self.points.take(column, axis=1)
        middles /= 6
        which[:count] = self.leaf
        evaluate(self.kernels, which, middles, np.empty(padded(count)), gradients, count, self.pool)
        return find_flaws(self.faces, self.points, gradients, self.lattice, self.pool) & FOLDED > 0


def _seams(faces: Faces, count: int, code: Ints) -> Flags:
    """Which half-edges have another leaf on the other side; `code` tells the leaves of quads apart."""
    mates, *_ = pair(faces, count)
    code = np.repeat(code, 6)
    return np.asarray((mates >= 0) & (code != code[mates]))


def _harmonic(which: Ints, vertex: Ints, neighbour: Ints, count: Ints, points: Floats) -> Floats:
    """Places (3, m) of some vertices that are the middles of their neighbours; all others are where they are."""
    chosen = np.flatnonzero(count[vertex] >= 2)
    order = chosen[np.argsort(vertex[chosen], kind="stable")]
    start = np.concatenate([[0], np.cumsum(count[which])])
    places = np.ascontiguousarray(points.T)
    _sweep(which, start, np.ascontiguousarray(neighbour[order]), float(np.spacing(np.abs(points).max())), places)
    return places[which].T


@loop
def _sweep(which: Ints, start: Ints, neighbour: Any, rounding: float, points: Floats) -> None:
    """Successive over-relaxation: one vertex after the other to the middle of its neighbours, and beyond."""
    for _ in range(SWEEPS):
        moved = 0.0
        for w in range(len(which)):
            v, many = which[w], start[w + 1] - start[w]
            x = y = z = 0.0
            for at in range(start[w], start[w + 1]):
                u = neighbour[at]
                x += points[u, 0]
                y += points[u, 1]
                z += points[u, 2]
            x = FURTHER * (x / many - points[v, 0])
            y = FURTHER * (y / many - points[v, 1])
            z = FURTHER * (z / many - points[v, 2])
            for size in (abs(x), abs(y), abs(z)):
                moved = size if size > moved else moved
            points[v, 0] += x
            points[v, 1] += y
            points[v, 2] += z
        if moved <= rounding:
            break
