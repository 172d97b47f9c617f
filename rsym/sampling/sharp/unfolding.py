"""Folds that no move along an edge takes out: there the triangles themselves change.

A vertex goes to a feature up to four cells away. Where leaves touch along a line, or corners lie closer together than
a cell, vertices then stand in another order than their cells do, and triangles face inwards that vertices moved along
their edge cannot turn. Around these a diagonal is turned, an edge contracted or a vertex put amid its neighbours,
whichever step leaves the fewest folds; first such steps that keep every vertex on its edge, then any. Each step must
also turn less area away from the leaves: a triangle counts twice its area minus that of its projection along the
gradient. So folds and area only fall, and the mesh stays the manifold it was.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator
from concurrent.futures import Executor
from dataclasses import dataclass
from itertools import chain
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from rsym.arrays import Faces, Flags, Floats, Ints
from rsym.sampling.kernels.mesher_kernels import MesherKernels
from rsym.sampling.sharp.corners import off_surface, on_active_leaf, on_surface, solve
from rsym.sampling.sharp.crossings import CompiledLeaves
from rsym.sampling.sharp.edits import Corners, Edge
from rsym.sampling.sharp.faces import facing_inwards
from rsym.sampling.sharp.loops import loop

# Around a fold: steps change the triangles around its corners and their neighbours, and make way for further steps.
RINGS = 4
# Cells from the middle of its neighbours, within which a vertex finds its place.
REACH = 1.0
# What a step must leave at most of what turns away, if it folds no triangle less: it makes way for one that does.
LESS = 0.9


class Gain(NamedTuple):
    """The folds before a change and after it, then what turns away before and after."""

    folds: int
    fewer: int
    area: float
    less: float


UNKNOWN = Gain(0, 0, 0.0, 0.0)


@dataclass(eq=False)
class Change:
    """Faces that go, and the corners of those that take their place, in order; the last ones have none.

    A change is found once, and goes as soon as faces around it do.
    """

    faces: tuple[int, ...]
    corners: tuple[Corners, ...]
    gain: Gain = UNKNOWN

    def __lt__(self, other: Change) -> bool:
        return (self.faces, self.corners) < (other.faces, other.corners)


class Contraction(NamedTuple):
    """An edge contracted into one of its ends, and whether the other one may slide there."""

    change: Change
    slides: bool


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
        _mark_faces(faces, _corners(faces, around, np.zeros(len(vertices), np.bool_)), around)
    near, remain = np.flatnonzero(around), ~around
    region = _Region(kernels, vertices, faces[near], leaf[near], lattice, pool)
    beyond = _corners(faces, remain, np.zeros(len(vertices), np.bool_))
    region.free -= {corner for corner, fixed in enumerate(beyond[region.ids].tolist()) if fixed}
    while region.improve(keep=True) or region.improve(keep=False):
        pass
    home = region.ids[np.array(region.home)]
    kept = near[list(region.corners)]
    faces[kept], remain[kept] = home[np.array(list(region.corners.values())).reshape(-1, 3)], True
    used = list(region.at)
    vertices[home[used]] = region.points[used]
    return remain


def _corners(faces: Faces, which: Flags, held: Flags) -> Flags:
    """Mark which vertices some faces have."""
    held[faces[which]] = True
    return held


@loop
def _mark_faces(faces: Faces, held: Flags, which: Flags) -> None:
    """Mark which faces have some vertices."""
    for f in range(len(faces)):
        if held[faces[f, 0]] or held[faces[f, 1]] or held[faces[f, 2]]:
            which[f] = True


class _Region:
    """Triangles around folds: `corners` of each face, the faces `at` each vertex; a vertex that moves is a new one.

    Vertices are numbered here, in the order of their `ids` in the mesh; a new one has the `home` of the one it was.
    What was found around a vertex is kept until faces there change.
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
        self.leaf: list[int] = leaf.tolist()
        self.folded, self.turned = np.zeros(len(leaf), np.bool_), np.zeros(len(leaf))
        self.ids, local = np.unique(faces, return_inverse=True)
        self.corners: dict[int, Corners] = {
            face: _turn((a, b, c)) for face, (a, b, c) in enumerate(local.reshape(-1, 3).tolist())
        }
        self.at: dict[int, set[int]] = defaultdict(set)
        for face, corners in self.corners.items():
            for corner in corners:
                self.at[corner].add(face)
        self.home = list(range(len(self.ids)))
        self.points = vertices[self.ids]
        self.free = set(self.at)
        self._rings: dict[int, set[int]] = {}
        self._seams: dict[int, list[int]] = {}
        self._turns: dict[Edge, Change | None] = {}
        self._contractions: dict[Edge, list[Contraction]] = {}
        self._moves: dict[tuple[int, bool], list[Change]] = {}
        self._judge(list(self.corners))

    def improve(self, keep: bool) -> bool:
        """Take the best of the steps that do not meet; whether there was any. `keep`: no vertex leaves its edge."""
        folded = [face for face in np.flatnonzero(self.folded).tolist() if face in self.corners]
        edges = dict.fromkeys(edge for face in folded for edge in _edges(self.corners[face]))
        ends = list(dict.fromkeys(chain.from_iterable(edges)))
        steps = [*self._turned(edges), *self._contracted(ends, keep), *self._moved(ends, keep)]
        self._weigh([step for step in steps if step.gain is UNKNOWN])
        ranked = []
        for step in steps:
            folds, fewer, area, less = step.gain
            even = not keep and fewer == folds > 0 and less < LESS * area
            if even or (fewer < folds and less < area):
                ranked.append((fewer - folds, less - area, step))
        touched: set[int] = set()
        changed: list[int] = []
        for _, _, step in sorted(ranked):
            if touched.isdisjoint(step.faces):
                touched.update(*(self.at[corner] for face in step.faces for corner in self.corners[face]))
                self._take(step)
                changed += step.faces[: len(step.corners)]
        self._judge(changed)
        return bool(touched)

    def _turned(self, edges: Iterable[Edge]) -> Iterator[Change]:
        """Each edge turned within the quad of its two triangles, if they have one leaf."""
        for edge in edges:
            if edge not in self._turns:
                self._turns[edge] = self._turn_of(*edge)
            change = self._turns[edge]
            if change is not None:
                yield change

    def _turn_of(self, u: int, v: int) -> Change | None:
        one, other = self._beside(u, v)
        if one < 0 or other < 0 or self.leaf[one] != self.leaf[other] or not {u, v} <= self.free:
            return None
        (w,), (x,) = set(self.corners[one]) - {u, v}, set(self.corners[other]) - {u, v}
        if min(len(self.at[u]), len(self.at[v])) <= 3 or w == x or not self.at[w].isdisjoint(self.at[x]):
            return None
        return Change((one, other), (_turn((w, u, x)), _turn((x, v, w))))

    def _contracted(self, ends: Iterable[int], keep: bool) -> Iterator[Change]:
        """Each edge at some vertices contracted into either of its ends."""
        edges = dict.fromkeys((min(u, v), max(u, v)) for v in ends if v in self.free for u in sorted(self._ring(v)))
        for edge in edges:
            if edge not in self._contractions:
                self._contractions[edge] = list(self._contractions_of(*edge))
            for change, slides in self._contractions[edge]:
                if slides or not keep:
                    yield change

    def _contractions_of(self, u: int, v: int) -> Iterator[Contraction]:
        """An edge contracted into either of its ends, where that changes a fold."""
        both = self.at[u] & self.at[v]
        if len(both) != 2 or u not in self.free or v not in self.free:
            return
        across = set(chain.from_iterable(self.corners[face] for face in both)) - {u, v}
        # The condition under which the surface stays the manifold it was (Dey, Edelsbrunner, Guha, Nekhayev 1999).
        if (
            self._ring(u) & self._ring(v) == across
            and len(self._ring(u) | self._ring(v)) > 4
            and min(len(self.at[w]) for w in across) > 3
        ):
            gone = tuple(sorted(both))
            for one, other in ((v, u), (u, v)):
                if any(self.folded[face] for face in self.at[one]):
                    kept = tuple(sorted(self.at[one] - both))
                    corners = tuple([self._with(face, one, other) for face in kept])
                    yield Contraction(Change((*kept, *gone), corners), self._may_slide(one, other))

    def _may_slide(self, v: int, u: int) -> bool:
        """Whether v comes to u along its edge of the body, or has none."""
        seam = self._seam(v)
        return not seam or (len(seam) == 2 and u in seam and len(self._leaves(v)) == 2)

    def _moved(self, ends: Iterable[int], keep: bool) -> Iterator[Change]:
        """Each vertex amid its neighbours, those along its edge if it has one; or on whichever leaf is there."""
        ends = [v for v in ends if v in self.free]
        wanted: list[tuple[int, Floats, list[int]]] = []
        for v in ends:
            if (v, keep) not in self._moves:
                self._moves[v, keep] = []
                wanted += self._wanted(v, keep)
        if wanted:
            self._move(wanted, keep)
        return chain.from_iterable(self._moves[v, keep] for v in ends)

    def _wanted(self, v: int, keep: bool) -> list[tuple[int, Floats, list[int]]]:
        """The places that a vertex may move to, with the leaves that it is to lie on; without any on the active one."""
        seam, leaves = self._seam(v), sorted(self._leaves(v))
        if keep and seam:
            return [(v, self._middle(seam), leaves)] if len(seam) == len(leaves) == 2 else []
        middle = self._middle(self._ring(v))
        return [(v, middle, leaves)] if keep else [(v, middle, []), *((v, middle, [one]) for one in leaves)]

    def _move(self, wanted: list[tuple[int, Floats, list[int]]], keep: bool) -> None:
        start, ids = np.stack([place for _, place, _ in wanted], axis=1), np.full((3, len(wanted)), -1, np.int16)
        for row, (_, _, leaves) in enumerate(wanted):
            ids[: len(leaves), row] = leaves
        points, loose = solve(self.kernels, ids, start, self.lattice, self.pool), ids[0] < 0
        if loose.any():
            points[:, loose] = on_active_leaf(self.kernels, start[:, loose], self.lattice, self.pool)
        good = on_surface(off_surface(self.kernels, points, self.lattice, self.pool), self.lattice)
        good &= (np.abs(points - start) <= REACH * self.lattice[3:].max()).all(axis=0)
        for row in np.flatnonzero(good).tolist():
            v, new = wanted[row][0], len(self.home)
            self.home.append(self.home[v])
            faces = tuple(sorted(self.at[v]))
            self._moves[v, keep].append(Change(faces, tuple([self._with(face, v, new) for face in faces])))
        self.points = np.concatenate([self.points, points[:, good].T])

    def _take(self, step: Change) -> None:
        old = set(chain.from_iterable(self.corners[face] for face in step.faces))
        self._forget(old)
        for face in step.faces:
            for corner in self.corners.pop(face):
                self.at[corner].discard(face)
        for face, corners in zip(step.faces, step.corners, strict=False):
            self.corners[face] = corners
            for corner in corners:
                self.at[corner].add(face)
                self.free.update({corner} - old)
        for corner in old:
            if not self.at[corner]:
                del self.at[corner]

    def _forget(self, vertices: set[int]) -> None:
        """Drop what was found around vertices whose faces change: steps of their neighbours look at these too."""
        for v in vertices.union(*(self._ring(v) for v in vertices)):
            for u in self._ring(v):
                self._contractions.pop((min(u, v), max(u, v)), None)
                self._turns.pop((u, v), None)
                self._turns.pop((v, u), None)
            self._moves.pop((v, True), None)
            self._moves.pop((v, False), None)
        for v in vertices:
            self._rings.pop(v, None)
            self._seams.pop(v, None)

    def _judge(self, faces: list[int]) -> None:
        """Which of some faces are folded, and how far they turn away."""
        if faces:
            self.folded[faces], self.turned[faces] = self._judged([self.corners[face] for face in faces], faces)

    def _judged(self, corners: list[Corners], faces: list[int]) -> tuple[Flags, Floats]:
        leaf = np.array([self.leaf[face] for face in faces], np.int16)
        return facing_inwards(CompiledLeaves(self.kernels), self.points[np.array(corners)], leaf)

    def _weigh(self, steps: list[Change]) -> None:
        """What each step gains."""
        if not steps:
            return
        corners = list(chain.from_iterable(step.corners for step in steps))
        folded, turned = self._judged(
            corners, list(chain.from_iterable(step.faces[: len(step.corners)] for step in steps))
        )
        after = np.repeat(np.arange(len(steps)), [len(step.corners) for step in steps])
        before = np.repeat(np.arange(len(steps)), [len(step.faces) for step in steps])
        faces = list(chain.from_iterable(step.faces for step in steps))
        folds, area = np.bincount(before, self.folded[faces]), np.bincount(before, self.turned[faces])
        fewer, less = np.bincount(after, folded, len(steps)), np.bincount(after, turned, len(steps))
        sums = (folds.astype(int).tolist(), fewer.astype(int).tolist(), area.tolist(), less.tolist())
        for step, *gain in zip(steps, *sums, strict=True):
            step.gain = Gain(*gain)

    def _beside(self, u: int, v: int) -> tuple[int, int]:
        """The face that has the half-edge from u to v, and the one that has its reverse; -1 where there is none."""
        both = self.at[u] & self.at[v]
        one = [face for face in both if (u, v) in _edges(self.corners[face])]
        other = [face for face in both if (v, u) in _edges(self.corners[face])]
        return (one[0], other[0]) if len(one) == len(other) == 1 else (-1, -1)

    def _ring(self, v: int) -> set[int]:
        if v not in self._rings:
            self._rings[v] = set(chain.from_iterable([self.corners[face] for face in self.at[v]])) - {v}
        return self._rings[v]

    def _leaves(self, v: int) -> set[int]:
        return {self.leaf[face] for face in self.at[v]}

    def _seam(self, v: int) -> list[int]:
        """The neighbours along edges that have another leaf on the other side."""
        if v not in self._seams:
            leaves: dict[int, set[int]] = defaultdict(set)
            for face in self.at[v]:
                for u in self.corners[face]:
                    leaves[u].add(self.leaf[face])
            self._seams[v] = sorted(u for u, own in leaves.items() if u != v and len(own) > 1)
        return self._seams[v]

    def _middle(self, vertices: Iterable[int]) -> Floats:
        return np.asarray(self.points[sorted(vertices)].mean(axis=0))

    def _with(self, face: int, v: int, u: int) -> Corners:
        a, b, c = self.corners[face]
        return _turn((u if a == v else a, u if b == v else b, u if c == v else c))


def _turn(corners: Corners) -> Corners:
    """The same triangle, its lowest corner first."""
    a, b, c = corners
    return (a, b, c) if a <= b and a <= c else (b, c, a) if b <= c else (c, a, b)


def _edges(corners: Corners) -> tuple[Edge, Edge, Edge]:
    a, b, c = corners
    return (a, b), (b, c), (c, a)
