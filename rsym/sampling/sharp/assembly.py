"""A sharp mesh from its stages: blocks, signs, topology, crossings, vertices, faces."""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import Executor
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from rsym.codegen.surface_kernels import SurfaceKernels
from rsym.sampling.sharp.crossings import Crossings, find_crossings, sample_signs
from rsym.sampling.sharp.diagonals import turn_diagonals
from rsym.sampling.sharp.faces import connect
from rsym.sampling.sharp.loops import in_threads
from rsym.sampling.sharp.octree import Blocks, find_blocks
from rsym.sampling.sharp.patches import Topology, topology
from rsym.sampling.sharp.vertices import Vertices, place_vertices

Floats: TypeAlias = NDArray[np.float64]
GRAIN = 4096


@dataclass(frozen=True)
class Assembly:
    """What the stages made: `faces` (2*crossings, 3), `sharp` marks the quads at features."""

    blocks: Blocks
    surface: Topology
    crossings: Crossings
    vertices: Vertices
    faces: NDArray[np.int32]


def assemble(
    kernels: SurfaceKernels,
    smooth: NDArray[np.bool_],
    lattice: Floats,
    cells: Sequence[int],
    pool: Executor | None,
) -> Assembly:
    """The surface of a form on a lattice."""
    blocks = find_blocks(kernels, lattice, cells, pool)
    bits = sample_signs(kernels, blocks, lattice, pool)
    surface = topology(blocks.corner, bits, pool)
    crossings = find_crossings(kernels, blocks, surface, lattice, pool)
    vertices = place_vertices(kernels, smooth, surface, crossings, lattice, pool)
    faces = np.empty((2 * surface.crossings, 3), np.int32)
    sharp = np.zeros(surface.crossings, np.uint8)
    arrays = (surface.quads, vertices.points, crossings.gradients, vertices.feature, faces, sharp)
    in_threads(lambda a, b: connect(a, b, *arrays), surface.crossings, GRAIN, pool)
    turn_diagonals(kernels, sharp, vertices.points, faces, pool)
    return Assembly(blocks, surface, crossings, vertices, faces)
