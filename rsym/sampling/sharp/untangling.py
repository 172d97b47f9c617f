"""Folds out: where vertices of an edge came to stand in the wrong order, they move along it.

A vertex belongs to a cell, its feature may pass beside that cell, and so two vertices on one edge may stand the wrong
way round. Near such folds every vertex moves to where it is the middle of its neighbours, those on an edge along that
edge, corners not at all, and goes back to its leaves by Newton's method; what does not end on the surface stays where
it was. Vertices between two copies of one corner end on that corner.

Folds far from each other lie in clusters that do not touch: nothing of one depends on another.
"""

from __future__ import annotations

from concurrent.futures import Executor
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rsym.arrays import Faces, Flags, Floats, Ints, Shorts
from rsym.sampling.kernels.mesher_kernels import MesherKernels, padded
from rsym.sampling.sharp.corners import off_surface, on_surface, solve
from rsym.sampling.sharp.crossings import evaluate
from rsym.sampling.sharp.faces import FOLDED, Adjacency, find_flaws, quads_of_vertices, turn_diagonals
from rsym.sampling.sharp.loops import loop, step
from rsym.sampling.triangles import following, pieces

RINGS = 3
# One does it where leaves are planes; curved ones take two or three.
ROUNDS = 6
# A cluster that a round has not made better is given up until the next turn. Another round would leave all but one of
# twelve cars as they are, of 64 to 192 cells, and no mesh a fold less; it takes a sixth of the time of the car at 128.
PULLS = 3
# Clusters are put into so many groups, each for a thread, where these have so many quads at least: a call for fewer
# takes longer than it saves, and more groups make more calls.
GROUPS, GROUP = 2, 1000
# Steps of half again their length halve what is missing across a patch of eight vertices, and between two copies of a
# corner, where it counts, they leave nothing. What else is missing is made good by rounds.
FURTHER, SWEEPS = 1.5, 80
# Where a quad, on whichever diagonal, has its four corners among the six of its triangles.
FOUR = [0, 1, 2, 5]


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
        patch = _Patch(kernels, adjacency, folded, leaf, points, faces, lattice)
        if turn:
            patch.pull(to_corners=turn > 1)
        patch.relax(pool)
        folded = patch.settle(points, faces)
        touched.append(patch.quads)
        if not len(folded):
            break
    return np.concatenate(touched)


class _Patch:
    """A part of a mesh, in clusters that do not touch, and what is best of each so far.

    Of vertices: their `leaves` where these are one or two. Of quads: whether `folded`, and whether `stale`: their
    diagonal was not asked for since it was turned or a corner moved; to ask again would give the same.
    """

    def __init__(
        self,
        kernels: MesherKernels,
        adjacency: Adjacency,
        folded: Ints,
        leaf: NDArray[np.int16],
        points: Floats,
        faces: Faces,
        lattice: Floats,
    ) -> None:
        near, inner = adjacency.around(folded, RINGS)
        self.quads = quads = adjacency.around(near, 1)[0]  # all that the neighbours meet
        self.kernels, self.lattice = kernels, lattice
        own, number = faces.reshape(-1, 6)[quads], np.zeros(points.shape[1], np.int32)
        number[own] = 1
        self.ids = np.flatnonzero(number)
        count = len(self.ids)
        number[self.ids] = np.arange(count)
        self.faces, self.leaf = number[own].reshape(-1, 3), leaf[quads]
        self.points = np.zeros((3, padded(count)))
        self.points[:, :count] = points[:, self.ids]
        names = np.flatnonzero(np.bincount(self.leaf)).astype(np.int16)
        codes = np.searchsorted(names, self.leaf)
        self.meets = np.zeros((count, len(names)), np.bool_)
        self.meets[self._corners(FOUR), codes[:, None]] = True
        self.several = self.meets.sum(axis=1)
        first, last = self.meets.argmax(axis=1), len(names) - 1 - self.meets[:, ::-1].argmax(axis=1)
        self.leaves = np.stack([names[first], np.where(self.several > 1, names[last], np.int16(-1))])
        self.movable = (inner[self.ids] > 0) & (self.several <= 2)
        self.start, self.at = quads_of_vertices(self.faces, count)
        self.cluster = pieces(self.faces, count)
        self.of_quad = self.cluster[self.faces[::2, 0]]
        self.stale, self.folded = np.ones(len(quads), np.bool_), np.zeros(len(quads), np.bool_)
        self._judge(np.arange(len(quads)))
        self.best = self.points.copy(), self.faces.copy(), self.folded.copy()
        self.fewest = self._folds() + 1

    def relax(self, pool: Executor | None) -> None:
        """Vertices to the middles of their neighbours and back onto their leaves, until no fold is left or it is late.

        Those on a seam of leaves have neighbours along it; corners stay.
        """
        groups = self._groups()
        for _ in range(ROUNDS):
            list(map(self._round, groups) if pool is None or len(groups) < 2 else pool.map(self._round, groups))
            goes_on = (self._keep_better() & (self.fewest > 0))[self.of_quad]
            groups = [quads for quads in (quads[goes_on[quads]] for quads in groups) if len(quads)]
            if not groups:
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
            which = self._move(which, self.leaves[:, nearest], self.points[:, which])
        self.movable[which] = False
        moved = np.zeros(len(self.ids), np.bool_)
        moved[which] = True
        self._judge(np.flatnonzero(moved[self._corners(FOUR)].any(axis=1)))
        self._keep_better()

    def settle(self, points: Floats, faces: Faces) -> Ints:
        """Put what is best in its place in the mesh; the quads that are folded still."""
        self.points, self.faces, self.folded = self.best
        points[:, self.ids] = self.points[:, : len(self.ids)]
        faces.reshape(-1, 6)[self.quads] = self.ids[self.faces.reshape(-1, 6)]
        return self.quads[self.folded]

    def _groups(self) -> list[Ints]:
        """The quads of clusters, put together in groups of about one size."""
        size = np.bincount(self.of_quad)
        load, group = (
            np.zeros(max(1, min(len(size), GROUPS, len(self.quads) // GROUP)), np.int64),
            np.empty(len(size), np.int64),
        )
        for cluster in np.argsort(-size, kind="stable").tolist():
            group[cluster] = load.argmin()
            load[group[cluster]] += size[cluster]
        return [np.flatnonzero(group[self.of_quad] == k) for k in range(len(load))]

    def _round(self, quads: Ints) -> None:
        """Move the vertices of some clusters, and turn diagonals."""
        which, start = self._amid(quads)
        moved = np.zeros(len(self.ids), np.bool_)
        if len(which):
            moved[self._move(which, self.leaves[:, which], start)] = True
        changed: Flags = np.asarray(moved[self._corners(FOUR, quads)].any(axis=1))
        self.stale[quads] |= changed
        asked = self.stale[quads]
        some = quads[asked]
        before = self.faces[2 * some]
        turn_diagonals(self.kernels, some, self.points, self.faces, None)
        self.stale[some] = (self.faces[2 * some] != before).any(axis=1)
        changed[asked] |= self.stale[some]
        self._judge(quads[changed])

    def _amid(self, quads: Ints) -> tuple[Any, Floats]:
        """Vertices that have neighbours to follow, and places (3, m) amid these; all others are where they are."""
        count, movable = len(self.ids), np.zeros(len(self.ids), np.bool_)
        movable[self._corners(FOUR, quads)] = True
        which, start = np.empty(count, np.uint32), np.zeros(count + 1, np.int64)
        neighbour, places = np.empty(6 * len(quads), np.uint32), np.ascontiguousarray(self.points.T)
        mesh = (self.start, self.at, self.faces.ravel(), self.leaf, movable & self.movable, self.several)
        which = which[: _amid(*mesh, which, start, neighbour, places)]
        return which, places[which].T

    def _move(self, which: Ints, leaves: Shorts, start: Floats) -> Ints:
        """Onto their leaves from where they start; those that end there, not far from where they were."""
        moved = solve(self.kernels, leaves, start, self.lattice, None)
        near = (np.abs(moved - self.points[:, which]) < RINGS * self.lattice[3:].max()).all(axis=0)
        good: Flags = near & on_surface(off_surface(self.kernels, moved, self.lattice, None), self.lattice)
        done: Ints = which[good]
        self.points[:, done] = moved[:, good]
        return done

    def _keep_better(self) -> Flags:
        """Keep the clusters that have fewer folds than ever; which have."""
        folds = self._folds()
        better: Flags = folds < self.fewest
        if not better.any():
            return better
        self.fewest[better] = folds[better]
        points, faces, folded = self.best
        of_vertex, of_quad = better[self.cluster], better[self.of_quad]
        np.copyto(points[:, : len(of_vertex)], self.points[:, : len(of_vertex)], where=of_vertex)
        np.copyto(faces, self.faces, where=np.repeat(of_quad, 2)[:, None])
        np.copyto(folded, self.folded, where=of_quad)
        return better

    def _folds(self) -> Ints:
        """How many quads of each cluster are folded."""
        return np.bincount(self.of_quad[self.folded], minlength=self.cluster.max() + 1)

    def _judge(self, quads: Ints) -> None:
        """Find which of some quads are folded against the gradient of their leaf at the middle of their corners."""
        count = len(quads)
        if not count:
            return
        middles, gradients = np.zeros((3, padded(count))), np.zeros((3, padded(count)))
        which = np.full(padded(count), -1, np.int16)
        own = self._corners(slice(6), quads)
        for column in np.ascontiguousarray(own.T, np.intp):
            middles[:, :count] += self.points.take(column, axis=1)
        middles /= 6
        which[:count] = self.leaf[quads]
        evaluate(self.kernels, which, middles, np.empty(padded(count)), gradients, count, None)
        self.folded[quads] = find_flaws(own.reshape(-1, 3), self.points, gradients, self.lattice, None) & FOLDED > 0

    def _corners(self, columns: list[int] | slice, quads: Ints | slice = slice(None)) -> Faces:
        """The corners of the triangles of quads, some of the six."""
        return self.faces.reshape(-1, 6)[quads][:, columns]


@loop
def _amid(
    first: Any,
    at: Any,
    corners: Faces,
    leaf: Shorts,
    movable: Flags,
    several: Ints,
    which: Any,
    start: Ints,
    neighbour: Any,
    places: Floats,
) -> int:
    """Vertices amid their neighbours, along seams if they are on one: how many have such; the rest is filled.

    The quads of vertex v stand `at` ``first[v]`` and on; the `neighbour`s of vertex ``which[w]`` at
    ``start[w]`` and on. Successive over-relaxation: one vertex after the other to the middle, and beyond.
    """
    count, filled = 0, 0
    for v in range(len(movable)):
        if not movable[v]:
            continue
        for i in range(first[v], first[v + 1]):
            for half in range(6 * at[i], 6 * at[i] + 6):
                if corners[half] != v:
                    continue
                head = corners[following(half)]
                if several[v] == 1 or (several[head] > 1 and _is_seam(first, at, corners, leaf, v, head, at[i])):
                    neighbour[filled] = head
                    filled += 1
        if filled - start[count] >= 2:
            which[count] = v
            count += 1
        else:
            filled = start[count]
        start[count] = filled
    for _ in range(SWEEPS):
        moved = 0.0
        for w in range(count):
            v, many = which[w], start[w + 1] - start[w]
            x = y = z = 0.0
            for i in range(start[w], start[w + 1]):
                u = neighbour[i]
                x += places[u, 0]
                y += places[u, 1]
                z += places[u, 2]
            x = FURTHER * (x / many - places[v, 0])
            y = FURTHER * (y / many - places[v, 1])
            z = FURTHER * (z / many - places[v, 2])
            moved += abs(x) + abs(y) + abs(z)
            places[v, 0] += x
            places[v, 1] += y
            places[v, 2] += z
        if moved == 0.0:
            break
    return count


@step
def _is_seam(first: Faces, at: Faces, corners: Faces, leaf: Shorts, v: int, head: int, quad: int) -> bool:
    """Whether a half-edge from v in a quad has one mate, and that is of another leaf."""
    along, against, mate = 0, 0, 0
    for i in range(first[v], first[v + 1]):
        for half in range(6 * at[i], 6 * at[i] + 6):
            if corners[half] == v:
                along += corners[following(half)] == head
            elif corners[half] == head and corners[following(half)] == v:
                against += 1
                mate = at[i]
    return along == 1 and against == 1 and leaf[mate] != leaf[quad]
