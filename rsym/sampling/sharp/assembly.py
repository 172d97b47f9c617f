"""A sharp surface from its stages: blocks, signs, topology, crossings, vertices, faces."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Executor
from dataclasses import dataclass, replace
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from rsym.arrays import Floats, Ints
from rsym.errors import RsymError
from rsym.sampling.kernels.mesher_kernels import MesherKernels
from rsym.sampling.memory import Budget
from rsym.sampling.progress import Crew
from rsym.sampling.sharp.crossings import Crossings, find_crossings, sample_signs
from rsym.sampling.sharp.faces import connect, find_flaws, turn_diagonals
from rsym.sampling.sharp.loops import in_threads
from rsym.sampling.sharp.octree import BLOCK, Blocks, find_blocks
from rsym.sampling.sharp.topology import Topology, scanned, topology
from rsym.sampling.sharp.vertices import Vertices, place_vertices

# What else to find out about blocks: a module's function, so that a process can be told its name.
Inspect: TypeAlias = Callable[[MesherKernels, Blocks, Floats, Executor], Any]


GRAIN = 4096
HALO = 1  # blocks beside a box that is computed on its own

# Bytes that are held at once, by what is allocated: of a block its corner, words, signs, fields and ranks; of a
# cell and of a crossing their rows when the vertices are placed, when most is held. A plane has 64 cells and 64
# crossings in a block that it passes through the middle of.
BLOCK_BYTES, CELL_BYTES, CROSSING_BYTES = 700, 80, 110
USUAL_BYTES = BLOCK_BYTES + 64 * (CELL_BYTES + CROSSING_BYTES)
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
    smooth: NDArray[np.bool_]
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
        region = None
        if box is not None:
            region = np.maximum(box[0] - HALO * BLOCK, 0), np.minimum(box[1] + HALO * BLOCK, self.cells)

        before = 0

        def claim(kept: int, size: int) -> None:
            nonlocal before
            expected = kept * (size // BLOCK) ** 2 * USUAL_BYTES
            budget.claim(8 * kept * BOX_BYTES, expected)
            if kept >= SETTLED:
                budget.claim(expected / (DOUBT if kept < GROWTH * before else GREAT_DOUBT), expected)
            before = kept

        return find_blocks(self.kernels, self.lattice, self.cells, crew, region, claim)

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

    points: NDArray[np.float64]
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


def assemble(job: Job, blocks: Blocks, crew: Crew, budget: Budget) -> Assembly:
    """The surface in some blocks: signs of lattice points, what hangs together, crossings, vertices, faces.

    Each array is dropped as soon as no later stage reads it.
    """
    kernels, lattice, claim = job.kernels, job.lattice, claim_of(blocks, budget)
    crew.stage(70)
    bits = sample_signs(kernels, blocks, lattice, crew)
    crew.stage(120, loops=3)
    surface = topology(blocks.corner, bits, crew, claim)
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


def claim_of(blocks: Blocks, budget: Budget) -> Callable[[int, int], None]:
    """Claim memory for blocks, and later for the cells and crossings in them."""
    count = blocks.corner.shape[1]
    budget.claim(count * BLOCK_BYTES, count * USUAL_BYTES)
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
    turn_diagonals(kernels, sharp, vertices.points, faces, crew)
    return faces
