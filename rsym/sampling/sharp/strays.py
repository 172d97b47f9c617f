"""Vertices that are not on the surface."""

from __future__ import annotations

from concurrent.futures import Executor
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from rsym.sampling.kernels.surface_kernels import SurfaceKernels, columns, padded
from rsym.sampling.sharp.corners import off_surface, on_surface
from rsym.sampling.sharp.flaws import smallest
from rsym.sampling.sharp.loops import in_threads
from rsym.sampling.status import OffSurface

Floats: TypeAlias = NDArray[np.float64]

# Leaves have gradients of length 1 to 2, by and large: a value below this share of what counts needs no second look.
CLEARLY = 1e-3
GRAIN = 4096


def stray_vertices(
    kernels: SurfaceKernels, vertices: Floats, lattice: Floats, pool: Executor | None
) -> OffSurface | None:
    """How many of the vertices (n, 3) are off the surface, and the worst of them."""
    count = len(vertices)
    points = columns(vertices.T)
    value, leaf = np.empty(padded(count)), np.empty(padded(count), np.int16)
    in_threads(lambda a, b: kernels.value(b - a, points, value, leaf, first=a), count, GRAIN, pool)
    doubtful = np.flatnonzero(~(np.abs(value[:count]) < CLEARLY * smallest(lattice)))
    if not len(doubtful):
        return None
    cells = np.nan_to_num(off_surface(kernels, points[:, doubtful], lattice, pool), nan=np.inf)
    strays = ~on_surface(cells, lattice)
    if not strays.any():
        return None
    worst = int(cells.argmax())
    x, y, z = (float(f"{coordinate:.4g}") for coordinate in points[:, doubtful[worst]])
    return OffSurface(int(strays.sum()), float(cells[worst]), (x, y, z))
