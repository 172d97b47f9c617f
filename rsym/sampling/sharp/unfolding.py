"""Folds that no move along an edge takes out: there the triangles themselves change.

A vertex goes to a feature up to four cells away. Where leaves touch along a line, or corners lie closer together than
a cell, vertices then stand in another order than their cells do, and triangles face inwards that vertices moved along
their edge cannot turn. Around these a diagonal is turned, an edge contracted or a vertex put amid its neighbours,
whichever step leaves the fewest folds; first such steps that keep every vertex on its edge, then any. Each step must
also turn less area away from the leaves: a triangle counts twice its area minus that of its projection along the
gradient. So folds and area only fall, and the mesh stays the manifold it was.
"""

from __future__ import annotations

from concurrent.futures import Executor
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rsym.arrays import Faces, Flags, Floats, Ints
from rsym.sampling.kernels.mesher_kernels import MesherKernels
from rsym.sampling.sharp.corners import off_surface, on_active_leaf, on_surface, solve
from rsym.sampling.sharp.crossings import CompiledLeaves
from rsym.sampling.sharp.faces import facing_inwards, ranges
from rsym.sampling.sharp.loops import loop
from rsym.sampling.triangles import pieces

# Around a fold: steps change the triangles around its corners and their neighbours, and make way for further steps.
RINGS = 4
# Cells from the middle of its neighbours, within which a vertex finds its place.
REACH = 1.0
# What a step must leave at most of what turns away, if it folds no triangle less: it makes way for one that does.
LESS = 0.9


def unfold(
    kernels: MesherKernels,
    vertices: Floats,
    faces: Faces,
    leaf: NDArray[np.int16],
    folded: Ints,
    lattice: Floats,
    pool: Executor | None,
) -> Flags:
    """Turn folded faces outwards where that can be done, in place; which faces remain."""
    around = np.zeros(len(faces), np.bool_)
    around[folded] = True
    for _ in range(RINGS):
        _mark_faces(faces, _corners(faces, np.flatnonzero(around), np.zeros(len(vertices), np.bool_)), around)
    near, remain = np.flatnonzero(around), ~around
    region = _Region(kernels, vertices, faces[near], leaf[near], lattice, pool)
    _mark_faces(faces, _corners(faces, near, np.zeros(len(vertices), np.bool_)), around)
    beyond = _corners(faces, np.flatnonzero(around & remain), np.zeros(len(vertices), np.bool_))
    region.free &= ~beyond[region.home]
    while region.improve(keep=True) or region.improve(keep=False):
        pass
    left = np.flatnonzero(region.there)
    corners = region.corners[left]
    faces[near[left]], remain[near[left]] = region.home[corners], True
    vertices[region.home[corners]] = region.points[corners]
    return remain


def _corners(faces: Any, which: Ints, held: Flags) -> Flags:
    """Mark which vertices some faces have."""
    held[faces[which]] = True
    return held


@loop
def _mark_faces(faces: Faces, held: Flags, which: Flags) -> None:
    """Mark which faces have some vertices."""
    for f in range(len(faces)):
        if held[faces[f, 0]] or held[faces[f, 1]] or held[faces[f, 2]]:
            which[f] = True


@dataclass(frozen=True)
class _Steps:
    """Steps one after the other: each gives faces other corners, and some go.

    Of step ``step[k]`` face ``faces[k]`` has ``corners[k]`` afterwards, the faces of a step ascend; ``gone[i]`` are the
    two that go, -1 if none does. Of ``count`` steps.
    """

    count: int
    step: Ints
    faces: Ints
    corners: Ints
    gone: Ints


def _joined(parts: list[_Steps]) -> _Steps:
    first = np.cumsum([0, *(part.count for part in parts)])
    return _Steps(
        int(first[-1]),
        np.concatenate([part.step + begin for part, begin in zip(parts, first[:-1], strict=True)]),
        np.concatenate([part.faces for part in parts]),
        _lowest_first(np.concatenate([part.corners for part in parts])),
        np.concatenate([part.gone for part in parts]),
    )


class _Region:
    """Triangles around folds: the `corners` of each face that is `there`; a vertex that moves is a new one.

    Vertices are numbered here, in the order of their names in the mesh; `home` is that of each, or of the one it was.
    A piece of the region that a round has left as it was is `quiet`: another round would do so too.
    """

    def __init__(
        self,
        kernels: MesherKernels,
        vertices: Floats,
        faces: Faces,
        leaf: NDArray[np.int16],
        lattice: Floats,
        pool: Executor | None,
    ) -> None:
        self.kernels, self.lattice, self.pool = kernels, lattice, pool
        self.leaf, self.there = leaf, np.ones(len(leaf), np.bool_)
        self.home, local = np.unique(faces, return_inverse=True)
        count, local = len(self.home), local.reshape(-1, 3)
        self.piece = pieces(local.astype(np.int32), count)[local[:, 0]]
        self.quiet = np.zeros((2, self.piece.max() + 1), np.bool_)
        self.corners, self.points = _lowest_first(local), vertices[self.home]
        self.free = np.ones(count, np.bool_)
        # Places that vertices may move to: of which round, of which vertex, its new number; and of which all are known.
        self.moves, self.known = np.empty((3, 0), np.int64), np.zeros((2, count), np.bool_)
        self.folded, self.turned = self._judged(self.corners, np.arange(len(leaf)))

    def improve(self, keep: bool) -> bool:
        """Take the best of the steps that do not meet; whether there was any. `keep`: no vertex leaves its edge."""
        loud = self.there & ~self.quiet[int(keep), self.piece]
        self.quiet[int(keep)] = True
        if not (loud & self.folded).any():
            return False
        around = _Surroundings(self._near(np.flatnonzero(loud)), self.corners, self.leaf, len(self.home))
        folded = self.folded[around.faces]
        ends = around.corners[folded].ravel()
        ends = ends[np.sort(np.unique(ends, return_index=True)[1])]  # in this order moved ones are numbered
        ends = ends[self.free[ends]]
        parts = [self._turned(around, folded), self._contracted(around, folded, ends, keep)]
        steps = _joined([*parts, self._moved(around, ends, keep)])
        inwards, away = self._judged(steps.corners, steps.faces)
        gone = np.flatnonzero(steps.gone[:, 0] >= 0)
        before = np.concatenate([steps.step, np.repeat(gone, 2)])
        faces = np.concatenate([steps.faces, steps.gone[gone].ravel()])
        folds, area = (np.bincount(before, some[faces], steps.count) for some in (self.folded, self.turned))
        fewer, less = (np.bincount(steps.step, some, steps.count) for some in (inwards, away))
        good = (fewer < folds) & (less < area)
        if not keep:
            good |= (fewer == folds) & (folds > 0) & (less < LESS * area)
        taken = self._chosen(around, steps, np.flatnonzero(good), fewer - folds, less - area)
        if not len(taken):
            return False
        self._take(around, steps, taken, inwards, away)
        return True

    def _near(self, faces: Ints) -> Ints:
        """Of some faces those around folded ones, up to all that steps look at: two rings."""
        near = faces[self.folded[faces]]
        for _ in range(2):
            held = _corners(self.corners, near, np.zeros(len(self.home), np.bool_))
            near = faces[held[self.corners[faces]].any(axis=1)]
        return near

    def _turned(self, around: _Surroundings, folded: Flags) -> _Steps:
        """Each edge of folded faces turned within the quad of its two triangles, if they have one leaf."""
        half = np.flatnonzero(np.repeat(folded, 3) & (around.mates >= 0))
        mate = around.mates[half]
        one, other = around.faces[half // 3], around.faces[mate // 3]
        u, v, w, x = around.tail[half], around.head[half], around.apex[half], around.apex[mate]
        good = (self.leaf[one] == self.leaf[other]) & self.free[u] & self.free[v] & (w != x)
        good &= np.minimum(around.degree[u], around.degree[v]) > 3
        some = np.flatnonzero(good)
        some = some[around.edges_between(w[some], x[some]) < 0]
        u, v, w, x = u[some], v[some], w[some], x[some]
        corners = np.stack([w, u, x, x, v, w], axis=1).reshape(-1, 3)
        step, count = np.repeat(np.arange(len(some)), 2), len(some)
        both = np.stack([one[some], other[some]], axis=1)
        return _Steps(count, step, both.ravel(), corners, np.full((count, 2), -1))

    def _contracted(self, around: _Surroundings, folded: Flags, ends: Ints, keep: bool) -> _Steps:
        """Each edge at some vertices contracted into either of its ends, where that changes a fold."""
        end, changes = np.zeros(len(self.home), np.bool_), np.zeros(len(self.home), np.bool_)
        end[ends], changes[around.corners[folded]] = True, True
        low, high = around.low, around.high
        good = (around.many == 2) & self.free[low] & self.free[high] & (end[low] | end[high])
        some = np.flatnonzero(good & (changes[low] | changes[high]))
        halves = around.halves[around.first[some] + np.arange(2)[:, None]]
        one, other = around.apex[halves]
        common = around.common(low[some], high[some])
        # The condition under which the surface stays the manifold it was (Dey, Edelsbrunner, Guha, Nekhayev 1999).
        good = (common == 1 + (one != other)) & (
            around.ring_size[low[some]] + around.ring_size[high[some]] - common > 4
        )
        good &= np.minimum(around.degree[one], around.degree[other]) > 3
        some, gone = some[good], np.sort(around.faces[halves[:, good] // 3], axis=0).T
        edge, gone = np.tile(some, 2), np.tile(gone, (2, 1))
        goes, stays = np.concatenate([high[some], low[some]]), np.concatenate([low[some], high[some]])
        good = changes[goes]
        if keep:
            # A vertex comes to the other along its edge of the body, or has none.
            along = (around.seam_size[goes] == 2) & around.seam[edge] & (around.leaves[goes] == 2)
            good &= (around.seam_size[goes] == 0) | along
        goes, stays, gone = goes[good], stays[good], gone[good]
        step, place = ranges(around.start[goes], around.degree[goes])
        faces = around.at[place]
        left = (faces[:, None] != gone[step]).all(axis=1)
        step, faces = step[left], faces[left]
        return _Steps(len(goes), step, faces, self._with(faces, goes[step], stays[step]), gone)

    def _moved(self, around: _Surroundings, ends: Ints, keep: bool) -> _Steps:
        """Each vertex amid its neighbours, those along its edge if it has one; or on whichever leaf is there."""
        new = ends[~self.known[int(keep), ends]]
        self.known[int(keep), new] = True
        if len(new):
            self._move(*self._wanted(around, new, keep), keep)
        asked = np.zeros(len(self.home), np.bool_)
        asked[ends] = True
        _, vertex, moved = self.moves[:, (self.moves[0] == keep) & asked[self.moves[1]]]
        step, place = ranges(around.start[vertex], around.degree[vertex])
        faces, gone = around.at[place], np.full((len(vertex), 2), -1)
        return _Steps(len(vertex), step, faces, self._with(faces, vertex[step], moved[step]), gone)

    def _wanted(self, around: _Surroundings, which: Ints, keep: bool) -> tuple[Ints, Floats, NDArray[np.int16]]:
        """The vertices, where they start and the leaves (3, n) they are to lie on; without any on the active one."""
        if not keep:
            count = around.leaves[which]
            row, place = ranges(around.leaf_start[which], count)
            # For each vertex the active leaf first, then each of its leaves.
            owner = np.repeat(np.arange(len(which)), count + 1)
            ids = np.full((3, len(owner)), -1, np.int16)
            ids[0, np.arange(len(row)) + row + 1] = around.own_leaves[place]
            return which[owner], around.middles(which, self.points, seams=False).take(owner, axis=1), ids
        seam, leaves = around.seam_size[which], around.leaves[which]
        which = which[(seam == 0) | ((seam == 2) & (leaves == 2))]
        along = around.seam_size[which] > 0
        start = np.empty((3, len(which)))
        for seams in (False, True):
            start[:, along == seams] = around.middles(which[along == seams], self.points, seams=seams)
        ids = np.full((3, len(which)), -1, np.int16)
        row, place = ranges(around.leaf_start[which], around.leaves[which])
        ids[place - around.leaf_start[which][row], row] = around.own_leaves[place]
        return which, start, ids

    def _move(self, which: Ints, start: Floats, ids: NDArray[np.int16], keep: bool) -> None:
        """Find the places of vertices, and number those that are on the surface."""
        points, loose = solve(self.kernels, ids, start, self.lattice, self.pool), ids[0] < 0
        if loose.any():
            points[:, loose] = on_active_leaf(self.kernels, start[:, loose], self.lattice, self.pool)
        good = on_surface(off_surface(self.kernels, points, self.lattice, self.pool), self.lattice)
        good &= (np.abs(points - start) <= REACH * self.lattice[3:].max()).all(axis=0)
        which, first = which[good], len(self.home)
        self.home = np.append(self.home, self.home[which])
        self.points = np.concatenate([self.points, points[:, good].T])
        self.free = np.append(self.free, np.zeros(len(which), np.bool_))
        self.known = np.concatenate([self.known, np.zeros((2, len(which)), np.bool_)], axis=1)
        made = np.stack([np.full(len(which), int(keep)), which, first + np.arange(len(which))])
        self.moves = np.concatenate([self.moves, made], axis=1)

    def _chosen(self, around: _Surroundings, steps: _Steps, good: Ints, folds: Any, area: Any) -> Ints:
        """Of good steps those that take the most folds out, then those that turn the most area; none near another."""
        good = good[np.lexsort((area[good], folds[good]))]
        even = np.flatnonzero((np.diff(area[good]) == 0) & (np.diff(folds[good]) == 0))
        if len(even):
            good = self._in_order(steps, good, even)
        first, last = np.searchsorted(steps.step, [good, good + 1])
        place = ranges(first, last - first)[1]
        faces, ends = steps.faces[place].tolist(), np.cumsum(last - first).tolist()
        taken, touched, begin = [], {-1}, 0
        for step, end, gone in zip(good.tolist(), ends, steps.gone[good].tolist(), strict=True):
            if touched.isdisjoint(faces[begin:end]) and (gone[0] < 0 or touched.isdisjoint(gone)):
                own = faces[begin:end] + gone * (gone[0] >= 0)
                touched.update(around.beside(self.corners[own].ravel()).tolist())
                taken.append(step)
            begin = end
        return np.array(taken, np.int64)

    def _in_order(self, steps: _Steps, good: Ints, even: Ints) -> Ints:
        """Steps that gain as much as the one after them, `even`, and that one, in the order of faces and corners."""
        good = good.copy()
        for run in np.split(even, np.flatnonzero(np.diff(even) > 1) + 1):
            own = good[run[0] : run[-1] + 2].tolist()

            def told(step: int) -> tuple[list[int], list[list[int]]]:
                first, last = np.searchsorted(steps.step, [step, step + 1])
                gone = [face for face in steps.gone[step].tolist() if face >= 0]
                return steps.faces[first:last].tolist() + gone, steps.corners[first:last].tolist()

            good[run[0] : run[-1] + 2] = sorted(own, key=told)
        return good

    def _take(self, around: _Surroundings, steps: _Steps, taken: Ints, inwards: Flags, away: Floats) -> None:
        chosen = np.zeros(steps.count, np.bool_)
        chosen[taken] = True
        some = chosen[steps.step]
        changed, gone = steps.faces[some], steps.gone[taken]
        gone = gone[gone >= 0]
        old = np.unique(self.corners[np.concatenate([changed, gone])])
        self.quiet[:, self.piece[changed]] = False
        # Steps of their neighbours look at these vertices too.
        self.known[:, self.corners[around.beside(old)]] = False
        self.moves = self.moves[:, self.known[self.moves[0], self.moves[1]]]
        self.there[gone] = False
        self.corners[changed], self.folded[changed], self.turned[changed] = (
            steps.corners[some],
            inwards[some],
            away[some],
        )
        self.free[np.setdiff1d(steps.corners[some], old)] = True

    def _judged(self, corners: Ints, faces: Ints) -> tuple[Flags, Floats]:
        """Which faces are folded with some corners, and how far they turn away."""
        return facing_inwards(CompiledLeaves(self.kernels), self.points[corners], self.leaf[faces])

    def _with(self, faces: Ints, one: Ints, other: Ints) -> Ints:
        """The corners of faces with another vertex instead of one."""
        return np.where(self.corners[faces] == one[:, None], other[:, None], self.corners[faces])


class _Surroundings:
    """How some faces hang together: half-edge 3*k + i runs from corner i of the k-th of them to the next.

    Of half-edges `tail`, `head`, the vertex across, `apex`, and the one mate, -1 where there are not two. Of vertices
    the `degree` and the faces `at` ``start[v]`` and on, in order; how many neighbours, and how many of these along
    seams; how many `leaves`, these being `own_leaves` at ``leaf_start[v]`` and on. Of edges the ends `low` and `high`,
    of how `many` faces they are, whether on a `seam` of leaves, and their `halves` at ``first[e]`` and on.
    """

    def __init__(self, faces: Ints, corners: Ints, leaf: NDArray[np.int16], vertices: int) -> None:
        self.faces, self.corners, self._vertices = faces, corners[faces], vertices
        self.tail = self.corners.ravel()
        self.head, self.apex = self.corners[:, [1, 2, 0]].ravel(), self.corners[:, [2, 0, 1]].ravel()
        self.degree = np.bincount(self.tail, minlength=vertices)
        self.start = np.cumsum(self.degree) - self.degree
        self.at = faces[np.argsort(self.tail, kind="stable") // 3]
        low, high = np.minimum(self.tail, self.head), np.maximum(self.tail, self.head)
        key = low * vertices + high
        self.halves = np.argsort(key, kind="stable")
        self._keys, self.first, self.many = np.unique(key[self.halves], return_index=True, return_counts=True)
        self.low, self.high = np.divmod(self._keys, vertices)
        own = np.repeat(leaf[faces], 3)
        of_halves = own[self.halves]
        self.seam = np.minimum.reduceat(of_halves, self.first) != np.maximum.reduceat(of_halves, self.first)
        pairs = self.halves[self.first[self.many == 2] + np.arange(2)[:, None]]
        pairs = pairs[:, self.tail[pairs[0]] != self.tail[pairs[1]]]
        self.mates = np.full(len(self.tail), -1)
        self.mates[pairs] = pairs[::-1]
        tail = np.concatenate([self.low, self.high])
        self._ring_keys = tail * vertices + np.concatenate([self.high, self.low])
        order = np.argsort(self._ring_keys)
        self._ring_keys = self._ring_keys[order]
        self._ring, self._along = self._ring_keys % vertices, np.tile(self.seam, 2)[order]
        self.ring_size = np.bincount(tail, minlength=vertices)
        self.seam_size = np.bincount(tail, np.tile(self.seam, 2), vertices).astype(np.int64)
        several = int(own.max()) + 1
        leaves = np.unique(self.tail * several + own)
        self.own_leaves = leaves % several
        self.leaves = np.bincount(leaves // several, minlength=vertices)
        self.leaf_start = np.cumsum(self.leaves) - self.leaves

    def edges_between(self, one: Ints, other: Ints) -> Ints:
        """The edge that joins two vertices, -1 where there is none."""
        return _found(self._keys, np.minimum(one, other) * self._vertices + np.maximum(one, other))

    def common(self, one: Ints, other: Ints) -> Ints:
        """How many neighbours two vertices share."""
        owner, place = ranges((np.cumsum(self.ring_size) - self.ring_size)[one], self.ring_size[one])
        shared = _found(self._ring_keys, other[owner] * self._vertices + self._ring[place]) >= 0
        return np.bincount(owner[shared], minlength=len(one))

    def beside(self, which: Ints) -> Ints:
        """The faces at some vertices."""
        return self.at[ranges(self.start[which], self.degree[which])[1]]

    def middles(self, which: Ints, points: Floats, *, seams: bool) -> Floats:
        """The means (3, n) of the neighbours of vertices, or of those along seams, each summed in order."""
        ring, size = self._ring, self.ring_size
        if seams:
            ring, size = ring[self._along], self.seam_size
        start, size = (np.cumsum(size) - size)[which], size[which]
        total = points[ring[start]]
        for k in range(1, int(size.max(initial=0))):
            more = np.flatnonzero(size > k)
            total[more] += points[ring[start[more] + k]]
        return np.asarray((total / size[:, None]).T)


def _found(keys: Ints, wanted: Ints) -> Ints:
    """Where numbers are among ascending ones, -1 for those that are not."""
    place = np.minimum(np.searchsorted(keys, wanted), len(keys) - 1)
    return np.where(keys[place] == wanted, place, -1)


def _lowest_first(corners: Ints) -> Ints:
    """The same triangles, the lowest corner of each first."""
    turn = (corners.argmin(axis=1)[:, None] + np.arange(3)) % 3
    return np.take_along_axis(corners, turn, axis=1)
