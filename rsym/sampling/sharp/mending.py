"""The last stage of a surface that lies in pieces on disk: the parts around its flaws, finished as the whole would be.

What is finished around a flaw depends on a few rings of quads. All blocks within `AROUND` blocks of a flaw are put
together as one part, in the order of the whole, and finished at once: each step then sees the same quads in the same
order as on the whole. Whether it asked for what lies beyond the part is watched, and where it did the part grows.
"""

from __future__ import annotations

from concurrent.futures import Executor
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rsym.arrays import Faces, Flags, Floats, Ints
from rsym.sampling.kernels.mesher_kernels import MesherKernels, padded
from rsym.sampling.memory import Budget
from rsym.sampling.sharp.assembly import CROSSING_BYTES, Unfinished
from rsym.sampling.sharp.crossings import CompiledLeaves
from rsym.sampling.sharp.faces import FLAT, FOLDED, SHORT, TURNED, BeyondRim, facing_inwards
from rsym.sampling.sharp.finishing import rework
from rsym.sampling.sharp.pieces import Piece, blocks_of_names
from rsym.sampling.sharp.stored import StoredPiece, Surface

# Twice the cells that steps around a flaw usually ask for.
AROUND = 2
# The quads of a vertex begin in its block or the seven after it.
UPPER = np.array([[i, j, k] for i in (0, 1) for j in (0, 1) for k in (0, 1)])
# Of a part: its quads twice, as fetched and in order, the quads around each vertex, and what edits hold.
PART = 4


def to_mend(kernels: MesherKernels, piece: Piece) -> Ints:
    """The crossings of a piece whose quads have a flaw, or a triangle that faces inwards."""
    surface = piece.surface
    turned = np.flatnonzero(np.repeat(surface.flaws & (FOLDED | TURNED) > 0, 2))
    flawed = np.flatnonzero(surface.flaws & (FOLDED | FLAT | SHORT))
    if not len(turned):
        return flawed
    ids, local = np.unique(surface.faces[turned], return_inverse=True)
    count = int(np.searchsorted(ids, surface.vertices))
    points = [surface.points[:, ids[:count]], piece.stranger_points[:, ids[count:] - surface.vertices]]
    corners = np.concatenate(points, axis=1).T[local.reshape(-1, 3)]
    folded, _ = facing_inwards(CompiledLeaves(kernels), corners, surface.leaf[turned // 2])
    return np.union1d(flawed, turned[folded] // 2)


@dataclass(frozen=True)
class Changes:
    """What becomes of a surface of `vertices` vertices; new ones are numbered behind these.

    Vertices ``moved`` (k,), ascending, to ``places`` (k, 3); ``faces`` (m,), ascending, of two for each crossing, get
    ``corners`` (m, 3), those of -1 go; ``new_vertices``, ``new_faces`` and their ``new_leaf`` come behind the others;
    vertices ``gone`` (g,), ascending, leave the numbering. ``known`` (k,), ascending, are the vertices of corners and
    of new faces, ``known_points`` (k, 3) where they end.
    """

    vertices: int
    moved: Ints
    places: Floats
    faces: Ints
    corners: Ints
    new_vertices: Floats
    new_faces: Ints
    new_leaf: NDArray[np.int16]
    gone: Ints
    known: Ints
    known_points: Floats

    def numbers(self, ids: Ints) -> Ints:
        """The final numbers of vertices."""
        return np.asarray(ids - np.searchsorted(self.gone, ids)) if len(self.gone) else ids

    def stretch(self, first: int, count: int) -> tuple[Faces, Flags]:
        """Final numbers of so many vertices from a first one, and which of them stay."""
        a, b = np.searchsorted(self.gone, [first, first + count])
        stay = np.ones(count, np.bool_)
        if a == b:
            return np.arange(first - a, first - a + count, dtype=np.int32), stay
        stay[self.gone[a:b] - first] = False
        return np.cumsum(stay, dtype=np.int32) + np.int32(first - a - 1), stay

    def move(self, ids: Ints, points: Floats) -> None:
        """Put vertices (n,) that were given at points (n, 3) where they end, in place."""
        if len(self.moved):
            at = np.minimum(np.searchsorted(self.moved, ids), len(self.moved) - 1)
            changed = np.flatnonzero(self.moved[at] == ids)
            points[changed] = self.places[at[changed]]


def mend(kernels: MesherKernels, surface: Surface, lattice: Floats, pool: Executor | None, budget: Budget) -> Changes:
    """What finishing changes."""
    seeds = _blocks_of_seeds(surface)
    none = np.empty(0, np.int64)
    changes = Changes(
        surface.vertices, none, np.empty((0, 3)), none, np.empty((0, 3), np.int64), np.empty((0, 3)),
        np.empty((0, 3), np.int64), np.empty(0, np.int16), none, none, np.empty((0, 3)),
    )  # fmt: skip
    while len(seeds):
        part = _Part(surface, _around(seeds), budget)
        try:
            return part.finished(kernels, lattice, pool)
        except BeyondRim as beyond:
            more = part.block[beyond.vertices][:, None] + UPPER
            seeds = np.unique(np.concatenate([seeds, more.reshape(-1, 3)]), axis=0)
    return changes


def _blocks_of_seeds(surface: Surface) -> Ints:
    """The blocks (n, 3) that hold crossings to mend."""
    found = [np.empty((0, 3), np.int64)]
    for piece in surface.pieces:
        seeds = piece.read("seeds")
        if len(seeds):
            crossings = piece.read("crossings")
            ends = np.cumsum(crossings.ravel())
            block = np.searchsorted(ends, seeds, "right") % crossings.shape[1]
            found.append(piece.read("corner")[:, block].T >> 3)
    return np.unique(np.concatenate(found), axis=0)


def _around(seeds: Ints) -> Ints:
    """All blocks near some."""
    span = np.arange(-AROUND, AROUND + 1)
    offsets = np.stack(np.meshgrid(span, span, span, indexing="ij")).reshape(3, -1).T
    return np.unique((seeds[:, None] + offsets).reshape(-1, 3), axis=0)


class _Part:
    """The quads of some blocks as a surface of its own, in the order of the whole."""

    def __init__(self, surface: Surface, blocks: Ints, budget: Budget) -> None:
        self._surface = surface
        self._low, self._size = blocks.min(axis=0), np.ptp(blocks, axis=0) + 2
        self._keys = self._key(blocks)
        rows = [self._rows(piece) for piece in surface.pieces]
        budget.claim(PART * CROSSING_BYTES * sum(map(len, rows)))
        crossing, faces, leaf, flaws, ids, points, block = ([] for _ in range(7))
        for piece, local in zip(surface.pieces, rows, strict=True):
            if not len(local):
                continue
            quads = piece.read_rows("faces", np.stack([2 * local, 2 * local + 1], axis=1)).reshape(-1, 6)
            used, corners = np.unique(quads, return_inverse=True)
            numbers, given, where = self._vertices(piece, used)
            crossing.append(piece.crossing(local))
            faces.append(numbers[corners.reshape(quads.shape)])
            leaf.append(piece.read_rows("leaf", local))
            flaws.append(piece.read_rows("flaws", local))
            ids.append(numbers)
            points.append(given)
            block.append(where)
        self._assemble(crossing, faces, leaf, flaws, ids, points, block)

    def _key(self, blocks: Ints) -> Ints:
        """One number for each block (n, 3), -1 for those that lie outside."""
        place = blocks - self._low
        inside = ((place >= 0) & (place < self._size)).all(axis=1)
        key = (place[:, 0] * self._size[1] + place[:, 1]) * self._size[2] + place[:, 2]
        return np.asarray(np.where(inside, key, -1))

    def _holds(self, blocks: Ints) -> Flags:
        return np.isin(self._key(blocks), self._keys)

    def _rows(self, piece: StoredPiece) -> Ints:
        """The crossings of a piece that lie in the blocks."""
        corner, crossings = piece.read("corner"), piece.read("crossings")
        held = self._holds(corner.T >> 3)
        return np.flatnonzero(np.repeat(np.tile(held, 3), crossings.ravel()))

    def _vertices(self, piece: StoredPiece, used: Ints) -> tuple[Ints, Floats, Ints]:
        """Numbers, points and blocks of some vertices of a piece, ascending, strangers last."""
        count = int(np.searchsorted(used, piece.vertices))
        own, strange = used[:count], used[count:] - piece.vertices
        number, there = self._surface.strangers(piece)[strange], piece.read("stranger_points")[:, strange]
        block = np.searchsorted(np.cumsum(piece.read("vertices")), own, "right")
        names = piece.read("strangers")[strange]
        return (
            np.concatenate([piece.first + own, number]),
            np.concatenate([piece.read_rows("points", np.s_[:, own]), there], axis=1),
            np.concatenate([piece.read("corner")[:, block].T >> 3, blocks_of_names(names, self._surface.extent)]),
        )

    def _assemble(self, crossing: Any, faces: Any, leaf: Any, flaws: Any, ids: Any, points: Any, block: Any) -> None:
        number = np.concatenate(crossing)
        order = np.argsort(number)
        self.crossing = number[order]
        vertices, blocks = np.concatenate(ids), np.concatenate(block)
        self.ids, chosen = np.unique(vertices, return_index=True)
        self.block = blocks[chosen]
        self.given = np.zeros((3, padded(len(chosen))))
        self.given[:, : len(chosen)] = np.concatenate(points, axis=1)[:, chosen]
        corners = np.searchsorted(self.ids, np.concatenate(faces)[order]).astype(np.int32)
        self.faces = np.ascontiguousarray(corners.reshape(-1, 3))
        self.leaf, self.flaws = np.concatenate(leaf)[order], np.concatenate(flaws)[order]
        self.rim = ~np.all([self._holds(self.block + one) for one in UPPER], axis=0)

    def finished(self, kernels: MesherKernels, lattice: Floats, pool: Executor | None) -> Changes:
        """What finishing changes here."""
        count, faces = len(self.ids), self.faces.copy()
        part = Unfinished(self.given.copy(), count, faces, self.leaf, self.flaws)
        made = rework(kernels, part, lattice, pool, self.rim)
        remain = np.ones(len(faces), np.bool_) if made.remain is None else made.remain
        kept = int(remain.sum())
        new = np.full((len(faces), 3), -1, np.int64)
        # New vertices follow all that the surface has.
        ids = np.concatenate([self.ids, self._surface.vertices + np.arange(len(made.vertices) - count)])
        new[remain] = ids[made.faces[:kept]]
        changed = np.flatnonzero((new != self.ids[self.faces]).any(axis=1))
        before = np.ascontiguousarray(self.given[:, :count].T)
        moved = np.flatnonzero((made.vertices[:count].view(np.int64) != before.view(np.int64)).any(axis=1))
        gone = np.empty(0, np.int64)
        if made.remain is not None:
            used = np.zeros(len(ids), np.bool_)
            used[:count] = self.rim
            used[made.faces] = True
            gone = ids[~used]
        known = np.unique(np.concatenate([new[changed], ids[made.faces[kept:]]]))
        known = known[known >= 0]
        return Changes(
            self._surface.vertices,
            self.ids[moved],
            made.vertices[moved],
            2 * self.crossing[changed // 2] + changed % 2,
            new[changed],
            made.vertices[count:],
            ids[made.faces[kept:]],
            made.leaf[kept:],
            gone,
            known,
            made.vertices[np.searchsorted(ids, known)],
        )
