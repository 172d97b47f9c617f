"""A surface in pieces on disk becomes a file of triangles: its vertices, then its faces, measured on the way."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Executor, ThreadPoolExecutor
from dataclasses import dataclass, replace
from functools import partial
from itertools import pairwise
from pathlib import Path
from typing import Any, BinaryIO, NamedTuple

import numpy as np

from rsym.arrays import Faces, Flags, Floats
from rsym.atomic import atomic_file
from rsym.errors import RsymError
from rsym.sampling.encoding import ply_header, ply_vertices, stl_faces, stl_header
from rsym.sampling.progress import Crew
from rsym.sampling.sharp.assembly import Job
from rsym.sampling.sharp.certificates import Unresolved
from rsym.sampling.sharp.corners import stray_vertices
from rsym.sampling.sharp.finishing import nothing_left
from rsym.sampling.sharp.loops import loop, step
from rsym.sampling.sharp.mending import Changes
from rsym.sampling.sharp.stored import StoredPiece, Surface
from rsym.sampling.status import OffSurface

# Rows on their way to the file at once.
ROWS = 1 << 18
# Indices of vertices in a file are 32-bit integers.
MOST_VERTICES = 2**31 - 1


class Streamed(NamedTuple):
    """What went into a file: how many of each, what was measured, which leaves have triangles, what was noted."""

    vertices: int
    faces: int
    unpaired: int
    volume: float
    area: float
    low: Floats
    high: Floats
    leaves: Flags
    unresolved: Unresolved
    strays: OffSurface | None
    pieces: int


@dataclass(frozen=True)
class _View:
    """Triangles of a piece as they end: faces (m, 3) count vertices, whose final numbers are ``numbers`` (n,).

    ``points`` (n, 3) and ``leaf`` (m,) are there if they were asked for. The first of the vertices are its own, of
    which some ``stay``.
    """

    numbers: Faces
    faces: Faces
    leaf: Any
    points: Floats
    stay: Flags


class MeshWriter:
    """Writes a surface with its changes, and measures it."""

    def __init__(self, job: Job, surface: Surface, changes: Changes, crew: Crew, pool: Executor) -> None:
        self._job, self._surface, self._changes, self._crew, self._pool = job, surface, changes, crew, pool
        self._strays: OffSurface | None = None
        self._sums, self._hash = np.zeros(2), np.zeros(1, np.uint64)
        self._ends = np.repeat([[np.inf], [-np.inf]], 3, axis=1)
        self._leaves = np.zeros(len(job.kernels.form.leaves), np.bool_)
        gone = len(changes.gone)
        self.vertices = surface.vertices + len(changes.new_vertices) - gone
        removed = int((changes.corners[:, 0] < 0).sum())
        self.faces = 2 * surface.crossings - removed + len(changes.new_faces)

    def found(self, notes: Unresolved) -> Streamed:
        """What was written and measured, and what was noted."""
        volume, area = float(self._sums[0]) / 6, float(self._sums[1]) / 2
        low, high = self._ends
        sums = (int(self._hash[0]), volume, area)
        count = len(self._surface.pieces)
        return Streamed(self.vertices, self.faces, *sums, low, high, self._leaves, notes, self._strays, count)

    def into(self, path: Path) -> None:
        """Write and measure."""
        if self.vertices > MOST_VERTICES:
            raise RsymError(
                f"{self.vertices} vertices are more than the {MOST_VERTICES} that a file can number",
                code="resolution",
                remedy="take a smaller resolution",
            )
        if not self.faces:
            raise nothing_left()
        total = len(self._surface.pieces)
        with atomic_file(path) as file:
            if path.suffix.lower() == ".ply":
                file.write(ply_header(self.vertices, self.faces))
                asked = [(piece, 0, 3) for piece in self._surface.pieces]
                for done, (view, piece) in enumerate(zip(self._ahead(asked), self._surface.pieces, strict=True)):
                    self._crew.stages.reach(0.6 * done / total)
                    # The loop asks for no threads: it may be one of them while rows are written.
                    measured = self._pool.submit(self._measure, view)
                    for a in range(0, piece.vertices, ROWS):
                        rows = slice(a, min(a + ROWS, piece.vertices))
                        file.write(ply_vertices(_some(view.points[rows], view.stay[rows])))
                    self._look_for_strays(view)
                    measured.result()
                new = self._new()
                self._measure(new)
                self._look_for_strays(new)
                file.write(ply_vertices(new.points[: len(new.stay)][new.stay]))
                self._faces(file, 0.6, _ply_rows, points=False)
            else:
                file.write(stl_header(self.faces))
                self._faces(file, 0.0, lambda view, rows: stl_faces(view.points[view.faces[rows]]), points=True)

    def _faces(self, file: BinaryIO, begin: float, encode: Callable[[_View, slice], Any], *, points: bool) -> None:
        """Write all triangles, and measure them if they come with points."""
        pieces = self._surface.pieces
        asked = [(piece, axis, axis + 1) for axis in range(3) for piece in pieces]
        for number, view in enumerate(self._ahead(asked, points=points)):
            self._crew.stages.reach(begin + (1 - begin) * number / len(asked))
            if points:
                self._measure(view)
                if number < len(pieces):
                    self._look_for_strays(view)
            _write(file, view, encode)
        new = self._new()
        if points:
            self._measure(new)
            self._look_for_strays(new)
        _write(file, new, encode)

    def _ahead(self, asked: Sequence[tuple[StoredPiece, int, int]], *, points: bool = True) -> Iterator[_View]:
        """The views asked for, each read while the one before is written."""
        with ThreadPoolExecutor(1, "rsym-reader") as reader:
            calls = [partial(self._view, *one, points=points) for one in asked]
            coming = reader.submit(calls[0])
            for call in calls[1:]:
                view = coming.result()
                coming = reader.submit(call)
                yield view
                del view
            yield coming.result()

    def _view(self, piece: StoredPiece, low: int, high: int, *, points: bool = True) -> _View:
        """The triangles of a piece along some axes."""
        changes = self._changes
        strange = self._surface.strangers(piece)
        numbers, stay = changes.stretch(piece.first, piece.vertices)
        quads = slice(*piece.axes[[low, high]].tolist())
        faces = piece.read_rows("faces", slice(2 * quads.start, 2 * quads.stop))
        leaf = np.repeat(piece.read_rows("leaf", quads), 2) if points else None
        ends = [-1]
        for axis in range(low, high):
            first, count = 2 * int(piece.begin[axis]), 2 * piece.per_axis[axis]
            a, b = np.searchsorted(changes.faces, [first, first + count])
            if a < b:
                rows = changes.faces[a:b] - first + 2 * int(piece.axes[axis] - quads.start)
                gone = changes.corners[a:b, 0] < 0
                # Whatever has changed has its vertices behind all others.
                known = np.searchsorted(changes.known, changes.corners[a:b][~gone])
                faces[rows[~gone]] = piece.vertices + len(strange) + known
                ends += rows[gone].tolist()
        if len(ends) > 1:  # few go: what lies between them is copied, which takes a seventh of choosing rows
            between = [slice(a + 1, b) for a, b in pairwise([*ends, len(faces)])]
            faces, leaf = (
                None if rows is None else np.concatenate([rows[part] for part in between]) for rows in (faces, leaf)
            )
        others = changes.numbers(np.concatenate([strange, changes.known])).astype(np.int32)
        places = np.empty((0, 3))
        if points:
            places = np.empty((len(numbers) + len(others), 3))
            places[: len(numbers)] = piece.read("points").T
            places[len(numbers) : len(numbers) + len(strange)] = piece.read("stranger_points").T
            places[len(numbers) + len(strange) :] = changes.known_points
            a, b = np.searchsorted(changes.moved, [piece.first, piece.first + piece.vertices])
            places[changes.moved[a:b] - piece.first] = changes.places[a:b]
            changes.move(strange, places[len(numbers) : len(numbers) + len(strange)])
        return _View(np.concatenate([numbers, others]), faces, leaf, places, stay)

    def _new(self) -> _View:
        """The triangles and vertices that come behind the others."""
        changes = self._changes
        new = changes.vertices + np.arange(len(changes.new_vertices))
        numbers = changes.numbers(np.concatenate([new, changes.known])).astype(np.int32)
        points = np.concatenate([changes.new_vertices, changes.known_points])
        faces = (len(new) + np.searchsorted(changes.known, changes.new_faces)).astype(np.int32)
        return _View(numbers, faces, changes.new_leaf, points, ~np.isin(new, changes.gone))

    def _measure(self, view: _View) -> None:
        if len(view.faces):
            _add(view.points, view.numbers, view.faces, view.leaf, self._sums, self._hash, self._ends, self._leaves)

    def _look_for_strays(self, view: _View) -> None:
        """Count the vertices that are off the surface."""
        for a in range(0, len(view.stay), ROWS):
            own = _some(view.points[a : min(a + ROWS, len(view.stay))], view.stay[a : a + ROWS])
            if len(own):
                found = stray_vertices(self._job.kernels, own, self._job.lattice, self._pool)
                self._strays = _both(self._strays, found)


def _some(points: Floats, which: Flags) -> Floats:
    """Some points, mostly all."""
    return points if which.all() else points[which]


def _write(file: BinaryIO, view: _View, encode: Callable[[_View, slice], Any]) -> None:
    for a in range(0, len(view.faces), ROWS):
        file.write(encode(view, slice(a, a + ROWS)))


def _ply_rows(view: _View, rows: slice) -> Any:
    """The bytes of `ply_faces`, in a tenth of its time."""
    faces = view.faces[rows]
    made = np.empty((len(faces), 13), np.uint8)
    _number(view.numbers, faces, made)
    return made


@loop
def _number(numbers: Any, faces: Any, rows: Any) -> None:
    """For each triangle a 3, then the numbers of its corners in four bytes each, the lowest first."""
    for f in range(len(faces)):
        rows[f, 0] = 3
        for k in range(3):
            number = numbers[faces[f, k]]
            for byte in range(4):
                rows[f, 1 + 4 * k + byte] = number >> 8 * byte & 255


def _both(one: OffSurface | None, other: OffSurface | None) -> OffSurface | None:
    if one is None or other is None:
        return one or other
    return replace(max(one, other, key=lambda found: found.cells), vertices=one.vertices + other.vertices)


@loop
def _add(
    points: Floats, numbers: Any, faces: Any, leaf: Any, sums: Floats, hashed: Any, ends: Floats, leaves: Flags
) -> None:
    """Add det(a, b, c) and |(b - a) x (c - a)| of triangles, and a hash of each edge with the sign of its direction.

    The box around them grows, and their leaves are marked.
    """
    volume, area, total = sums[0], sums[1], hashed[0]
    low, high, shared = ends[0], ends[1], False
    for f in range(len(faces)):
        a, b, c = faces[f, 0], faces[f, 1], faces[f, 2]
        px, py, pz = points[a, 0], points[a, 1], points[a, 2]
        qx, qy, qz = points[b, 0], points[b, 1], points[b, 2]
        rx, ry, rz = points[c, 0], points[c, 1], points[c, 2]
        ux, uy, uz, vx, vy, vz = qx - px, qy - py, qz - pz, rx - px, ry - py, rz - pz
        x, y, z = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
        volume += px * x + py * y + pz * z
        area += np.sqrt(x * x + y * y + z * z)
        leaves[leaf[f]] = True
        if not shared:
            widen(low, high, px, py, pz)
            widen(low, high, qx, qy, qz)
            total += hash_of(numbers[a], numbers[b])
        widen(low, high, rx, ry, rz)
        total += hash_of(numbers[b], numbers[c])
        # The second triangle of a quad has the third side of the first one in reverse, mostly: no sum, no new corners.
        shared = f + 1 < len(faces) and faces[f + 1, 0] == a and faces[f + 1, 1] == c and numbers[a] != numbers[c]
        if not shared:
            total += hash_of(numbers[c], numbers[a])
    sums[0], sums[1], hashed[0] = volume, area, total


@step
def widen(low: Floats, high: Floats, x: float, y: float, z: float) -> None:
    """A box that holds a point, too."""
    low[0], low[1], low[2] = min(low[0], x), min(low[1], y), min(low[2], z)
    high[0], high[1], high[2] = max(high[0], x), max(high[1], y), max(high[2], z)


@step
def hash_of(one: int, other: int) -> Any:
    """Of an edge the mixing of splitmix64, negative for one direction."""
    word = np.uint64(min(one, other)) << np.uint64(32) | np.uint64(max(one, other))
    word += np.uint64(0x9E3779B97F4A7C15)
    word = (word ^ word >> np.uint64(30)) * np.uint64(0xBF58476D1CE4E5B9)
    word = (word ^ word >> np.uint64(27)) * np.uint64(0x94D049BB133111EB)
    word ^= word >> np.uint64(31)
    return word if one < other else np.uint64(0) - word
