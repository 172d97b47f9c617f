"""Method `smooth`: marching cubes for the connections, omega itself for the places.

scikit-image decides how the triangles connect, in float32; every vertex lies on
an edge of the lattice, and its place there is found again on omega in float64.
"""

from __future__ import annotations

import contextlib
from collections.abc import Generator, Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import replace
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from skimage.measure import marching_cubes

from rsym.arrays import Flags, Floats, Ints
from rsym.backends.kernel import Kernel, compile_program
from rsym.errors import RsymError
from rsym.logic.sign_form import surface_program
from rsym.model.shape import Shape
from rsym.sampling.detail import small_pieces, thin_walls
from rsym.sampling.lattice import Lattice, sides_of
from rsym.sampling.mesh import Mesh
from rsym.sampling.progress import Progress, Steps
from rsym.sampling.roots import bracketed_roots
from rsym.sampling.status import Findings

SLAB_POINTS = 2_000_000
# Vertices are moved onto the surface in so many blocks, so that a cancel waits a fraction of a second.
VERTEX_BLOCKS = 8
TOGETHER = 50_000  # so few vertices take a fraction of a second all together
# Scaled samples near the surface are about this large: far above the 1e-7 below which marching cubes takes
# its ambiguity tests for undecided, and far enough below the end of float32 for a range of 1e32.
NEAR_SURFACE = 1e3
LARGEST_SAMPLE = 1e18
# A vertex keeps this share of a cell away from lattice points, so that no two vertices coincide.
FROM_LATTICE_POINT = 1e-7


def smooth_mesh(
    shape: Shape,
    lattice: Lattice,
    letters: Mapping[Any, float] | None,
    executor: Executor | None,
    progress: Progress | None,
) -> Mesh:
    """Mesh omega = 0 on the lattice."""
    per_slab = max(1, SLAB_POINTS // (lattice.counts[1] * lattice.counts[2]))
    slabs = [slice(start, start + per_slab) for start in range(0, lattice.counts[0], per_slab)]
    # Beside slabs and blocks: the connections, the normals, the counting.
    steps = Steps(len(slabs) + VERTEX_BLOCKS + 3, progress)
    samples = sample(shape, lattice, slabs, letters, executor, steps)
    scaled, zeros = _for_marching_cubes(samples)
    index, faces, _, _ = marching_cubes(scaled, 0.0, gradient_direction="ascent")
    del scaled
    steps.advance()
    kernel = _surface_kernel(shape, "value")
    vertices, kept = _on_surface(kernel, letters, lattice, samples, index.astype(np.float64), steps)
    del samples
    normals = _vertex_normals(shape, letters, vertices)
    steps.advance()
    found = _findings(shape, lattice, index, vertices, normals, faces)
    steps.advance()
    return Mesh(vertices, faces.astype(np.int64), normals[faces], replace(found, nudged_zeros=zeros, kept=kept))


def _findings(
    shape: Shape, lattice: Lattice, index: Floats, vertices: Floats, normals: Floats, faces: NDArray[np.int32]
) -> Findings:
    """What bounds and resolution cut or lose."""
    from rsym.sampling.triangles import pieces

    ends = lattice.points(np.array([[0, 0, 0], np.array(lattice.counts) - 1])).T
    sides = sides_of([symbol.name for symbol in shape.coordinates], ends.tolist())
    last = np.array(lattice.counts) - 1
    on_side = [bool((index[:, side.axis] == (k % 2) * last[side.axis]).any()) for k, side in enumerate(sides)]
    piece = pieces(faces, len(vertices))
    return Findings(
        clipped_at=tuple(side.name for side, held in zip(sides, on_side, strict=True) if held),
        sides=sides,
        thin=thin_walls(index, vertices, normals, lattice),
        small=small_pieces(vertices, piece, lattice.spacing) if piece.max() else None,
    )


def sample(
    shape: Shape,
    lattice: Lattice,
    slabs: Sequence[slice],
    letters: Mapping[Any, float] | None,
    executor: Executor | None,
    steps: Steps,
) -> Floats:
    """Omega on the lattice, slab by slab; NaN is refused."""
    axes = lattice.open_axes()
    samples = np.empty(lattice.counts)
    tasks = [(shape, letters, [axes[0][slab], axes[1], axes[2]]) for slab in slabs]
    with contextlib.closing(_slab_values(tasks, executor)) as results:
        for slab, values in zip(slabs, results, strict=True):
            samples[slab] = values
            steps.advance()
    undefined = np.isnan(samples)
    if undefined.any():
        place = lattice.points(np.argwhere(undefined)[:1])[0]
        raise RsymError(
            f"omega is undefined at {int(undefined.sum())} samples, first at {tuple(float(v) for v in place.round(6))}",
            code="undefined",
            remedy="choose bounds inside the domain of the formula",
        )
    return samples


def _slab_values(tasks: Sequence[tuple[Any, ...]], executor: Executor | None) -> Generator[Floats, None, None]:
    """The values of each slab in order; closed early, slabs that still wait are not computed."""
    if executor is None:
        for task in tasks:
            yield _sample_slab(*task)
        return
    futures = [executor.submit(_sample_slab, *task) for task in tasks][::-1]
    try:
        while futures:
            yield futures.pop().result()
    finally:
        for future in futures:
            future.cancel()


def _sample_slab(shape: Shape, letters: Mapping[Any, float] | None, axes: list[Floats]) -> Floats:
    return _surface_kernel(shape, "value")(*axes, letters=letters)["value"]


@lru_cache(maxsize=8)
def _surface_kernel(shape: Shape, field: str) -> Kernel:
    """Lowered and compiled once for all slabs, in each process that computes some."""
    return compile_program(surface_program(shape, (field,)), (field,), shape)


def _for_marching_cubes(samples: Floats) -> tuple[NDArray[np.float32], int]:
    """The samples divided by one scale, as float32 with every sign kept; a zero counts as inside."""
    inside = samples >= 0
    if inside.all() or not inside.any():
        sign = "positive" if inside.all() else "negative"
        raise RsymError(
            f"the surface does not meet the bounds: omega is {sign} at all samples",
            code="no-surface",
            remedy="widen the bounds, or refine the resolution if the body is thin",
        )
    largest = max(float(np.abs(plane[np.isfinite(plane)]).max(initial=0)) for plane in samples)
    scale = max(_near_surface(samples, inside) / NEAR_SURFACE, largest / LARGEST_SAMPLE) or 1.0
    tiny = np.finfo(np.float32).tiny
    scaled = np.empty(samples.shape, np.float32)
    for plane, sign_of, target in zip(samples, inside, scaled, strict=True):
        divided = np.clip(plane, -largest, largest) / scale  # the clip is for infinite samples alone
        target[...] = np.where(np.abs(divided) < tiny, np.where(sign_of, tiny, -tiny), divided)
    return scaled, int(samples.size - np.count_nonzero(samples))


def _near_surface(samples: Floats, inside: Flags) -> float:
    """The median size of samples before a change of sign along the first axis that has one."""
    for axis in range(3):
        before = (slice(None),) * axis + (slice(None, -1),)
        after = (slice(None),) * axis + (slice(1, None),)
        change = inside[before] != inside[after]
        if change.any():
            sizes = np.abs(samples[before][change])
            return float(np.median(sizes[np.isfinite(sizes)])) if np.isfinite(sizes).any() else 0.0
    return 0.0


def _on_surface(
    kernel: Kernel,
    letters: Mapping[Any, float] | None,
    lattice: Lattice,
    samples: Floats,
    index: Floats,
    steps: Steps,
) -> tuple[Floats, int]:
    """Each vertex moved along its lattice edge to the root of omega; how many could not be."""
    lower, axis, known = _edges(samples, index)
    which = np.flatnonzero(known)
    corner, along = lower[which], axis[which]
    start = samples[tuple(corner.T)]
    upper = corner.copy()
    upper[np.arange(len(which)), along] += 1
    end = samples[tuple(upper.T)]

    roots = np.empty(len(which))
    parts = np.array_split(np.arange(len(which)), 1 if len(which) <= TOGETHER else VERTEX_BLOCKS)
    for block in parts:
        roots[block] = _edge_roots(kernel, letters, lattice, corner[block], along[block], start[block], end[block])
        steps.advance()
    for _ in range(VERTEX_BLOCKS - len(parts)):
        steps.advance()
    roots = np.clip(roots, FROM_LATTICE_POINT, 1 - FROM_LATTICE_POINT)
    place = index.copy()
    place[which] = corner
    place[which, along] += roots
    return lattice.points(place), int(len(index) - len(which))


def _edge_roots(
    kernel: Kernel,
    letters: Mapping[Any, float] | None,
    lattice: Lattice,
    corner: Ints,
    along: Ints,
    start: Floats,
    end: Floats,
) -> Floats:
    """Where omega is zero on edges of the lattice, from 0 to 1; `start` and `end` are its values there."""

    def omega(t: Floats, active: Ints) -> Floats:
        place = corner[active].astype(np.float64)
        place[np.arange(len(active)), along[active]] += t
        points = lattice.points(place)
        return kernel(points[:, 0], points[:, 1], points[:, 2], letters=letters)["value"]

    return bracketed_roots(omega, start, end)


def _edges(samples: Floats, index: Floats) -> tuple[Ints, Ints, Flags]:
    """The lattice edge of each vertex: its lower end, its axis, and whether it has one.

    A vertex that float32 rounded onto a lattice point takes an edge of that point that nobody else has.
    """
    lower = np.floor(index).astype(np.int64)
    fraction = index - lower
    axis = fraction.argmax(axis=1)
    off_lattice = (fraction > 0).sum(axis=1)
    known = off_lattice == 1
    candidates = [(k, edge) for k in np.flatnonzero(off_lattice == 0) for edge in _crossing_edges(samples, lower[k])]
    if candidates:
        others = _edge_numbers(samples, np.column_stack([lower, axis])[known])
        taken = np.isin(_edge_numbers(samples, [edge for _, edge in candidates]), others)
        used: set[tuple[int, int, int, int]] = set()
        for (k, edge), is_taken in zip(candidates, taken, strict=True):
            if not is_taken and not known[k] and edge not in used:
                used.add(edge)
                lower[k], axis[k], known[k] = edge[:3], edge[3], True
    return lower, axis, known


def _edge_numbers(samples: Floats, edges: ArrayLike) -> Ints:
    """One integer for each edge (i, j, k, axis)."""
    i, j, k, axis = np.asarray(edges, np.int64).reshape(-1, 4).T
    return np.asarray(np.ravel_multi_index((i, j, k), samples.shape) * 3 + axis, np.int64)


def _crossing_edges(samples: Floats, point: Ints) -> list[tuple[int, int, int, int]]:
    """The edges of a lattice point along which omega changes sign."""
    edges = []
    for axis in range(3):
        for step in (-1, 1):
            other = point.copy()
            other[axis] += step
            if 0 <= other[axis] < samples.shape[axis] and (samples[tuple(point)] >= 0) != (samples[tuple(other)] >= 0):
                low = np.minimum(point, other)
                edges.append((int(low[0]), int(low[1]), int(low[2]), axis))
    return edges


def _vertex_normals(shape: Shape, letters: Mapping[Any, float] | None, vertices: Floats) -> Floats:
    """-grad/|grad| at each vertex; NaN where it does not exist."""
    gradient = _surface_kernel(shape, "gradient")(*vertices.T, letters=letters)["gradient"]
    with np.errstate(all="ignore"):
        normals: Floats = -gradient / np.linalg.norm(gradient, axis=1, keepdims=True)
    return np.where(np.isfinite(normals).all(axis=1, keepdims=True), normals, np.nan)
