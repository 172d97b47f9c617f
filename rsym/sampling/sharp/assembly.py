"""A sharp surface from its stages: blocks, signs, topology, crossings, vertices, faces.

A vertex stands for each patch of a cell, on the leaf, the edge or the corner that the patch shows: the crossings
around a patch know their leaves. One smooth leaf: the vertex goes from the middle of the crossings onto the leaf. Two
or three: Newton's method on all of them at once puts it on their edge or corner. Leaves with kinks inside, and what
Newton's method leaves, start from the minimiser of the quadratic error instead.
"""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Executor
from dataclasses import dataclass, replace
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from rsym.arrays import Flags, Floats, Ints, Shorts
from rsym.errors import RsymError
from rsym.sampling.kernels.mesher_kernels import MesherKernels, padded
from rsym.sampling.memory import Budget
from rsym.sampling.progress import Crew
from rsym.sampling.sharp.brackets import bring_back, cells_of, slid
from rsym.sampling.sharp.corners import settle
from rsym.sampling.sharp.crossings import Crossings, find_crossings, sample_signs
from rsym.sampling.sharp.faces import connect, find_flaws, turn_diagonals
from rsym.sampling.sharp.loops import in_threads, loop, step
from rsym.sampling.sharp.signs import BLOCK, Blocks, find_blocks, inside
from rsym.sampling.sharp.topology import Topology, scanned, topology

# What else to find out about blocks: a module's function, so that a process can be told its name.
Inspect: TypeAlias = Callable[[MesherKernels, Blocks, Floats, Executor], Any]


GRAIN = 4096
HALO = 1  # blocks beside a box that is computed on its own
COARSE = 4 * BLOCK  # boxes of so many cells a side tell how many blocks layers have

# Bytes that are held at once, by what is allocated: of a block its corner, words, signs, fields and ranks; of a
# cell and of a crossing their rows when the vertices are placed, when most is held. A plane has 64 cells and 64
# crossings in a block that it passes through the middle of.
BLOCK_BYTES, CELL_BYTES, CROSSING_BYTES = 700, 80, 110
USUAL_BYTES = BLOCK_BYTES + 64 * (CELL_BYTES + CROSSING_BYTES)
BESIDE_BYTES = BLOCK_BYTES + 24 * (CELL_BYTES + CROSSING_BYTES)  # of a block beside a box
# Places of cells are 512*block + cell, in 32 bits.
MOST_BLOCKS = 2**22
# Of boxes of the octree: corners, twice, words and what is kept.
BOX_BYTES = 100
# So many boxes of a level of the octree, not much more than four times those before it, foretell those of the last
# within a tenth on the paper's models, and those of one where little could be discarded yet within some tens: where
# they would need this many times what is free nobody need wait for them.
SETTLED, GROWTH, DOUBT, GREAT_DOUBT = 1000, 4.6, 2.0, 64.0


@dataclass(frozen=True)
class Job:
    """A surface to compute: kernels with their letters, which leaves are smooth, lattice, and cells along each axis."""

    kernels: MesherKernels
    smooth: Flags
    lattice: Floats
    cells: tuple[int, ...]
    inspect: Inspect | None = None

    @property
    def extent(self) -> tuple[int, int, int]:
        """Blocks along each axis."""
        i, j, k = (-(-count // BLOCK) for count in self.cells)
        return i, j, k

    def blocks(self, crew: Crew, budget: Budget, box: Ints | None = None) -> Blocks:
        """The blocks that the surface may meet, or those of a box and beside it."""
        region = None if box is None else self._around(box)
        before = 0

        def claim(corner: Floats, size: int) -> None:
            nonlocal before  # and of boxes that reach beyond this one nothing is foretold
            own = np.ones(corner.shape[1], np.bool_) if box is None else inside(corner, box - [[0], [size - 1]])
            kept = int(np.count_nonzero(own))
            expected = kept * (size // BLOCK) ** 2 * USUAL_BYTES
            budget.claim(8 * len(own) * BOX_BYTES, expected)
            if kept >= SETTLED:
                budget.claim(expected / (DOUBT if kept < GROWTH * before else GREAT_DOUBT), expected)
            before = kept

        return find_blocks(self.kernels, self.lattice, self.cells, crew, region, claim)

    def layers(self, crew: Crew, budget: Budget, box: Ints, axis: int) -> Floats:
        """About how many blocks there are in each layer of a box along an axis, the layers beside it first and last."""
        region = self._around(box)
        size = COARSE if (region[1] - region[0] >= 2 * COARSE).all() else BLOCK
        cells, claim = self.cells, (lambda corner, size: budget.claim(8 * corner.shape[1] * BOX_BYTES))
        boxes = find_blocks(self.kernels, self.lattice, cells, crew, region, claim, size)
        each, (first, last) = size // BLOCK, (box[:, axis] // BLOCK).tolist()
        count = np.bincount(boxes.corner[axis] // size, minlength=-(-cells[axis] // size))
        return np.pad(np.repeat(count * float(each), each), HALO)[first : last + 2 * HALO]

    def _around(self, box: Ints) -> tuple[Ints, Ints]:
        """The cells of a box and of the blocks beside it."""
        return np.maximum(box[0] - HALO * BLOCK, 0), np.minimum(box[1] + HALO * BLOCK, self.cells)

    def notes(self, blocks: Blocks, crew: Crew) -> tuple[Any, ...]:
        """What `inspect` says of blocks."""
        return () if self.inspect is None else (self.inspect(self.kernels, blocks, self.lattice, crew),)

    def place(self, box: Ints) -> str:
        """The words for a box, its cells and coordinates."""
        low, high = self.lattice[:3] + self.lattice[3:] * box
        ends = ", ".join(f"{a:.4g}..{b:.4g}" for a, b in zip(low, high, strict=True))
        return f"cells {box[0].tolist()} to {(box[1] - 1).tolist()}, coordinates {ends}"


@dataclass(frozen=True)
class Unfinished:
    """Triangles 2*e and 2*e + 1 of each crossing e, and the leaf of the crossing; what was noted beside them.

    ``points`` (3, m), of which the first `vertices` count; ``faces`` (2*crossings, 3); ``leaf`` and ``flaws``
    (crossings,). ``blocks`` are there if they have not been inspected yet, else ``notes``.
    """

    points: Floats
    vertices: int
    faces: NDArray[np.int32]
    leaf: NDArray[np.int16]
    flaws: NDArray[np.uint8]
    notes: tuple[Any, ...] = ()
    blocks: Blocks | None = None


@dataclass(frozen=True)
class Assembly:
    """What the stages made of blocks: points (3, vertices), padded; leaf, flaws of crossings; faces (2*crossings, 3).

    The `surface` comes without the rings, which take much memory and are of no more use.
    """

    surface: Topology
    points: Floats
    leaf: NDArray[np.int16]
    faces: NDArray[np.int32]
    flaws: NDArray[np.uint8]


def whole(job: Job, crew: Crew, budget: Budget) -> Unfinished:
    """The surface in one piece; its blocks are not inspected yet."""
    crew.stage(20, loops=6)
    blocks = job.blocks(crew, budget)
    made = assemble(job, blocks, crew, budget)
    return Unfinished(made.points, made.surface.vertices, made.faces, made.leaf, made.flaws, blocks=blocks)


def claim_whole(job: Job, budget: Budget) -> None:
    """Claim what `whole` would take."""
    blocks, crew = job.blocks(Crew(), budget), Crew()
    claim = claim_of(blocks, budget)
    cells, edges = scanned(sample_signs(job.kernels, blocks, job.lattice, crew), crew)
    claim(int(np.bitwise_count(cells).sum()), int(np.bitwise_count(edges).sum()))


def assemble(job: Job, blocks: Blocks, crew: Crew, budget: Budget, box: Ints | None = None) -> Assembly:
    """The surface in some blocks: signs of lattice points, what hangs together, crossings, vertices, faces.

    Each array is dropped as soon as no later stage reads it. Of blocks beside a box there is what its quads need.
    """
    kernels, lattice, claim = job.kernels, job.lattice, claim_of(blocks, budget, box)
    crew.stage(70)
    bits = sample_signs(kernels, blocks, lattice, crew)
    crew.stage(120, loops=3)
    surface = topology(blocks.corner, bits, crew, claim, box)
    crew.stage(160, loops=4)
    crossings = find_crossings(kernels, blocks, surface, lattice, crew)
    crew.stage(200, loops=4)
    vertices = place_vertices(kernels, job.smooth, surface, crossings, lattice, crew)
    none = np.empty(0, np.int32)
    surface = replace(surface, ring=none, ring_start=none)
    crossings = replace(crossings, points=np.empty((3, 0)))
    faces = _faces(kernels, surface, crossings, vertices, crew)
    flaws = find_flaws(faces, vertices.points, crossings.gradients, lattice, crew)
    return Assembly(surface, vertices.points, crossings.leaf[: surface.crossings], faces, flaws)


def claim_of(blocks: Blocks, budget: Budget, box: Ints | None = None) -> Callable[[int, int], None]:
    """Claim memory for blocks, and later for the cells and crossings in them, mostly in a box."""
    count = blocks.corner.shape[1]
    own = count if box is None else int(np.count_nonzero(inside(blocks.corner, box)))
    budget.claim(count * BLOCK_BYTES, count * BLOCK_BYTES + own * (USUAL_BYTES - BLOCK_BYTES))
    if count > MOST_BLOCKS:
        raise RsymError(
            f"the surface meets {count} blocks of cells, more than the {MOST_BLOCKS} that can be numbered at once",
            code="resolution",
            remedy="give an executor: pieces have numbers of their own",
        )
    return lambda cells, crossings: budget.claim(count * BLOCK_BYTES + cells * CELL_BYTES + crossings * CROSSING_BYTES)


def _faces(
    kernels: MesherKernels, surface: Topology, crossings: Crossings, vertices: Vertices, crew: Crew
) -> NDArray[np.int32]:
    crew.stage(100)
    faces = np.empty((2 * surface.crossings, 3), np.int32)
    sharp = np.zeros(surface.crossings, np.uint8)
    arrays = (surface.quads, vertices.points, crossings.gradients, vertices.feature, faces, sharp)
    in_threads(lambda a, b: connect(a, b, *arrays), surface.crossings, GRAIN, crew)
    crew.stage(30, loops=5)
    turn_diagonals(kernels, np.flatnonzero(sharp), vertices.points, faces, crew)
    return faces


# Directions in which the tangent planes hardly differ say nothing: those below this share of the largest eigenvalue.
FLAT = 0.02
FIT_GRAIN = 1024
CLOSE = 0.5  # cells beyond its own in which a fitted vertex may lie


@dataclass(frozen=True)
class Vertices:
    """Points (3, n), padded; `feature` (n,) is not 0 on edges and corners; `off` counts vertices off the surface."""

    points: Floats
    feature: NDArray[np.uint8]


def place_vertices(
    kernels: MesherKernels,
    smooth: Flags,
    surface: Topology,
    crossings: Crossings,
    lattice: Floats,
    pool: Executor | None,
) -> Vertices:
    """The vertices of a surface; `smooth` tells which leaves have no kinks."""
    count = surface.vertices
    points = np.zeros((3, padded(count)))
    single, feature = np.full(points.shape[1], -1, np.int16), np.zeros(points.shape[1], np.uint8)
    arrays = (surface.ring_start, surface.ring, crossings.points, crossings.leaf, smooth, points, single, feature)
    in_threads(lambda a, b: middles(a, b, *arrays), count, GRAIN, pool)
    lost = slid(kernels, single, points, surface, crossings, lattice, pool)
    # A gradient that a smooth leaf has not, as that of a root at 0, is a kink.
    feature[:count][~np.isfinite(points[:, :count].sum(axis=0))] = 1
    several = np.flatnonzero(feature[:count])
    if len(several):
        start = fitted(several, surface, crossings, lattice, pool)
        points[:, several] = settle(kernels, several, start, surface, crossings, lattice, pool)
    bring_back(kernels, lost, several, points, surface, crossings, lattice, pool)
    return Vertices(points, feature)


@loop
def middles(
    first: int,
    last: int,
    ring_start: Any,
    ring: Any,
    crossing: Floats,
    leaf: Shorts,
    smooth: Flags,
    points: Floats,
    single: Shorts,
    feature: NDArray[np.uint8],
) -> None:
    """The middle of the crossings of each patch; its leaf where it has one and that is smooth, else it is a feature."""
    for v in range(first, last):
        begin, end = ring_start[v], ring_start[v + 1]
        one = leaf[ring[begin]]
        alone = smooth[one]
        x = y = z = 0.0
        for at in range(begin, end):
            c = ring[at]
            x += crossing[0, c]
            y += crossing[1, c]
            z += crossing[2, c]
            alone &= leaf[c] == one
        share = 1.0 / (end - begin)
        points[0, v], points[1, v], points[2, v] = x * share, y * share, z * share
        if alone:
            single[v] = one
        else:
            feature[v] = 1


def fitted(
    which: NDArray[np.integer[Any]],
    surface: Topology,
    crossings: Crossings,
    lattice: Floats,
    pool: Executor | None,
) -> Floats:
    """Minimisers (3, n) of the quadratic error of tangent planes, for some vertices.

    Sum of (n_i . (x - p_i))**2 over crossings p_i with unit normals n_i, least norm from the middle of the crossings
    (Ju, Losasso, Schaefer and Warren 2002), kept near the cell.
    """
    first = cells_of(which, surface)
    low = lattice[:3, None] + lattice[3:, None] * (first - CLOSE)
    high = low + lattice[3:, None] * (1 + 2 * CLOSE)
    points = np.empty((3, len(which)))
    rings, tangents = (surface.ring_start, surface.ring), (crossings.points, crossings.gradients)
    arrays = (which, *rings, *tangents, low, high, points)

    def piece(first: int, last: int) -> None:
        minimise(first, last, *arrays, np.empty((3, 3)), np.empty((3, 3)), np.empty((2, 3)))

    in_threads(piece, len(which), FIT_GRAIN, pool)
    return points


@loop
def minimise(
    first: int,
    last: int,
    which: Any,
    ring_start: Any,
    ring: Any,
    crossing: Floats,
    gradient: Floats,
    low: Floats,
    high: Floats,
    out: Floats,
    matrix: Floats,
    vectors: Floats,
    sums: Floats,
) -> None:
    """The fit for each of some vertices, clamped between low and high.

    `matrix`, `vectors` (3, 3) and `sums` (2, 3), the middle of the crossings and the right-hand side, are scratch.
    """
    for w in range(first, last):
        begin, end = ring_start[which[w]], ring_start[which[w] + 1]
        for a in range(3):
            sums[0, a] = sums[1, a] = 0.0
            for q in range(3):
                matrix[a, q] = 0.0
        for at in range(begin, end):
            for a in range(3):
                sums[0, a] += crossing[a, ring[at]] / (end - begin)
        for at in range(begin, end):
            c = ring[at]
            square = 0.0
            for a in range(3):
                square += gradient[a, c] * gradient[a, c]
            if not 0 < square < np.inf:  # no tangent plane
                continue
            height = 0.0
            for a in range(3):
                height += gradient[a, c] * (crossing[a, c] - sums[0, a])
            for a in range(3):
                sums[1, a] += gradient[a, c] * height / square
                for q in range(3):
                    matrix[a, q] += gradient[a, c] * gradient[q, c] / square
        diagonalise(matrix, vectors)
        top = matrix[0, 0]
        for a in range(3):
            top = matrix[a, a] if matrix[a, a] > top else top
            out[a, w] = sums[0, a]
        for k in range(3):
            if matrix[k, k] > FLAT * top:
                step = 0.0
                for a in range(3):
                    step += vectors[a, k] * sums[1, a]
                step /= matrix[k, k]
                for a in range(3):
                    out[a, w] += step * vectors[a, k]
        for a in range(3):
            if low[a, w] > out[a, w]:
                out[a, w] = low[a, w]
            if high[a, w] < out[a, w]:
                out[a, w] = high[a, w]


@step
def diagonalise(matrix: Floats, vectors: Floats) -> None:
    """Eigenvalues of a symmetric 3x3 matrix on its diagonal, vectors in the columns: cyclic Jacobi rotations."""
    for i in range(3):
        for j in range(3):
            vectors[i, j] = i == j
    for _ in range(6):
        if abs(matrix[0, 1]) + abs(matrix[0, 2]) + abs(matrix[1, 2]) < 1e-15 * (
            matrix[0, 0] + matrix[1, 1] + matrix[2, 2]
        ):
            break
        for p, q in ((0, 1), (0, 2), (1, 2)):
            if matrix[p, q] == 0:
                continue
            half = (matrix[q, q] - matrix[p, p]) / (2 * matrix[p, q])
            tangent = (1 if half >= 0 else -1) / (abs(half) + np.sqrt(half * half + 1))
            cosine = 1 / np.sqrt(tangent * tangent + 1)
            sine = tangent * cosine
            for k in range(3):
                u, v = matrix[k, p], matrix[k, q]
                matrix[k, p], matrix[k, q] = cosine * u - sine * v, sine * u + cosine * v
            for k in range(3):
                u, v = matrix[p, k], matrix[q, k]
                matrix[p, k], matrix[q, k] = cosine * u - sine * v, sine * u + cosine * v
            for k in range(3):
                u, v = vectors[k, p], vectors[k, q]
                vectors[k, p], vectors[k, q] = cosine * u - sine * v, sine * u + cosine * v
