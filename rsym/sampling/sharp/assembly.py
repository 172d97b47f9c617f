"""A sharp surface from its stages: signs, topology, crossings, vertices, faces."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from rsym.errors import RsymError
from rsym.sampling.kernels.surface_kernels import SurfaceKernels
from rsym.sampling.memory import Budget
from rsym.sampling.progress import Crew
from rsym.sampling.sharp.crossings import Crossings, find_crossings, sample_signs
from rsym.sampling.sharp.diagonals import turn_diagonals
from rsym.sampling.sharp.faces import connect
from rsym.sampling.sharp.flaws import find_flaws
from rsym.sampling.sharp.loops import in_threads
from rsym.sampling.sharp.octree import Blocks
from rsym.sampling.sharp.patches import Topology, scanned, topology
from rsym.sampling.sharp.vertices import Vertices, place_vertices

Floats: TypeAlias = NDArray[np.float64]
GRAIN = 4096

# Bytes that are held at once, by what is allocated: of a block its corner, words, signs, fields and ranks; of a
# cell and of a crossing their rows when the vertices are placed, when most is held. A plane has 64 cells and 64
# crossings in a block that it passes through the middle of.
BLOCK_BYTES, CELL_BYTES, CROSSING_BYTES = 700, 80, 110
USUAL_BYTES = BLOCK_BYTES + 64 * (CELL_BYTES + CROSSING_BYTES)
# Places of cells are 512*block + cell, in 32 bits.
MOST_BLOCKS = 2**22


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


def assemble(
    kernels: SurfaceKernels,
    smooth: NDArray[np.bool_],
    lattice: Floats,
    blocks: Blocks,
    crew: Crew,
    budget: Budget,
) -> Assembly:
    """The surface of a form in blocks of a lattice.

    Each array is dropped as soon as no later stage reads it.
    """
    claim = claim_of(blocks, budget)
    crew.stage(70)
    bits = sample_signs(kernels, blocks, lattice, crew)
    crew.stage(120, loops=3)
    surface = topology(blocks.corner, bits, crew, claim)
    crew.stage(160, loops=4)
    crossings = find_crossings(kernels, blocks, surface, lattice, crew)
    crew.stage(200, loops=4)
    vertices = place_vertices(kernels, smooth, surface, crossings, lattice, crew)
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


def claim_only(kernels: SurfaceKernels, lattice: Floats, blocks: Blocks, crew: Crew, budget: Budget) -> None:
    """Claim what `assemble` would take."""
    claim = claim_of(blocks, budget)
    cells, edges = scanned(sample_signs(kernels, blocks, lattice, crew), crew)
    claim(int(np.bitwise_count(cells).sum()), int(np.bitwise_count(edges).sum()))


def _faces(
    kernels: SurfaceKernels, surface: Topology, crossings: Crossings, vertices: Vertices, crew: Crew
) -> NDArray[np.int32]:
    crew.stage(100)
    faces = np.empty((2 * surface.crossings, 3), np.int32)
    sharp = np.zeros(surface.crossings, np.uint8)
    arrays = (surface.quads, vertices.points, crossings.gradients, vertices.feature, faces, sharp)
    in_threads(lambda a, b: connect(a, b, *arrays), surface.crossings, GRAIN, crew)
    crew.stage(30, loops=5)
    turn_diagonals(kernels, sharp, vertices.points, faces, crew)
    return faces
