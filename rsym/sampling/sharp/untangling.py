"""Folds taken out of a mesh: where vertices of an edge came to stand in the wrong order, they move along it.

A vertex belongs to a cell, its feature may pass beside that cell, and so two vertices on one edge may stand the wrong
way round. Near such folds every vertex moves to where it is the middle of its neighbours, those on an edge along that
edge, corners not at all, and goes back to its leaves by Newton's method; what does not end on the surface stays where
it was. Vertices between two copies of one corner end on that corner.
"""

from __future__ import annotations

from concurrent.futures import Executor
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse.linalg import splu

from rsym.codegen.surface_kernels import SurfaceKernels, padded
from rsym.sampling.sharp.corners import ON_SURFACE, off_surface, solve
from rsym.sampling.sharp.crossings import evaluate
from rsym.sampling.sharp.diagonals import turn_diagonals
from rsym.sampling.sharp.flaws import FOLDED, Surroundings, find_flaws

Floats: TypeAlias = NDArray[np.float64]
Ints: TypeAlias = NDArray[np.int64]
Faces: TypeAlias = NDArray[np.int32]

# Cells that a vertex may move.
FAR = 3
# One does it where leaves are planes; curved ones take two or three.
ROUNDS = 6
PATIENCE = 2  # rounds without fewer folds
# A ring of vertices without a fixed one stays near its place.
PULL = 1e-12


def untangle(
    kernels: SurfaceKernels,
    around: Surroundings,
    leaf: NDArray[np.int16],
    points: Floats,
    faces: Faces,
    lattice: Floats,
    pool: Executor | None,
) -> None:
    """Move vertices and turn diagonals around folds, in place; `leaf` is that of each quad.

    What is not better after some rounds stays as it was.
    """
    quads, inner = around
    ids, local = np.unique(faces.reshape(-1, 6)[quads], return_inverse=True)
    part = np.ascontiguousarray(local.reshape(-1, 3), np.int32)
    places, on = np.zeros((3, padded(len(ids)))), np.ascontiguousarray(leaf[quads])
    places[:, : len(ids)] = points[:, ids]
    names, codes = np.unique(on, return_inverse=True)
    meets = np.zeros((len(ids), len(names)), np.bool_)
    meets[part.ravel(), np.repeat(codes, 6)] = True
    movable = (inner[ids] > 0) & (meets.sum(axis=1) <= 2)
    worst = _folds(kernels, on, part, places, lattice, pool)
    best, kept, patience = worst + 1, (places, part), PATIENCE
    for _ in range(ROUNDS):
        _relax(kernels, names, codes, meets, movable, part, places, lattice, pool)
        turn_diagonals(kernels, np.ones(len(quads), np.uint8), places, part, pool)
        count = _folds(kernels, on, part, places, lattice, pool)
        if count < best:
            best, kept, patience = count, (places.copy(), part.copy()), PATIENCE
        else:
            patience -= 1
        if not count or not patience:
            break
    if best <= worst:
        points[:, ids] = kept[0][:, : len(ids)]
        faces.reshape(-1, 6)[quads] = ids[kept[1].reshape(-1, 6)]


def _relax(
    kernels: SurfaceKernels,
    names: NDArray[np.int16],
    codes: Ints,
    meets: NDArray[np.bool_],
    movable: NDArray[np.bool_],
    faces: Faces,
    points: Floats,
    lattice: Floats,
    pool: Executor | None,
) -> None:
    """Each movable vertex to the middle of its neighbours, on a seam of leaves those along it; then onto its leaves."""
    tail, head = faces.ravel(), faces[:, [1, 2, 0]].ravel()
    follows = movable[tail] & ((meets.sum(axis=1)[tail] == 1) | _seams(tail, head, np.repeat(codes, 6)))
    vertex, neighbour = tail[follows], head[follows]
    count = np.bincount(vertex, minlength=len(meets))
    which = np.flatnonzero(count >= 2)
    if not len(which):
        return
    middles = _harmonic(which, vertex, neighbour, count, points)
    leaves = np.full((3, len(which)), -1, np.int16)
    for row, vertex_meets in enumerate(meets[which]):
        own = names[vertex_meets]
        leaves[: len(own), row] = own
    moved = solve(kernels, leaves, middles, lattice, pool)
    near = (np.abs(moved - points[:, which]) < FAR * lattice[3:, None]).all(axis=0)
    good = near & (off_surface(kernels, moved, lattice, pool) < ON_SURFACE)
    points[:, which[good]] = moved[:, good]


def _seams(tail: Faces, head: Faces, code: Ints) -> NDArray[np.bool_]:
    """Which half-edges have another leaf on the other side."""
    low, high = np.minimum(tail, head).astype(np.int64), np.maximum(tail, head)
    key = low * (int(head.max()) + 1) + high
    order = np.argsort(key, kind="stable")
    twins = np.flatnonzero(np.diff(key[order]) == 0)
    one, other = order[twins], order[twins + 1]
    seam = np.zeros(len(tail), np.bool_)
    seam[one] = seam[other] = code[one] != code[other]
    return seam


def _harmonic(which: Ints, vertex: Ints, neighbour: Ints, count: Ints, points: Floats) -> Floats:
    """Places (3, m) of some vertices that are the middles of their neighbours; all others are where they are."""
    size = len(count)
    share = np.where(count >= 2, 1 - PULL, 0.0)[vertex] / count[vertex]
    mean = sparse.csr_array((share, (vertex, neighbour)), shape=(size, size))[which]
    own = np.zeros(size, np.bool_)
    own[which] = True
    right = mean @ np.where(own, 0.0, points[:, :size]).T + PULL * points[:, which].T
    matrix = sparse.eye_array(len(which), format="csc") - mean[:, which].tocsc()
    return np.asarray(splu(matrix).solve(right), np.float64).T


def _folds(
    kernels: SurfaceKernels,
    leaf: NDArray[np.int16],
    faces: Faces,
    points: Floats,
    lattice: Floats,
    pool: Executor | None,
) -> int:
    """How many quads are folded against the gradient of their leaf at the middle of their corners."""
    count = len(leaf)
    middles, gradients = np.zeros((3, padded(count))), np.zeros((3, padded(count)))
    which = np.full(padded(count), -1, np.int16)
    middles[:, :count] = points[:, faces.reshape(-1, 6)].mean(axis=2)
    which[:count] = leaf
    evaluate(kernels, which, middles, np.empty(padded(count)), gradients, count, pool)
    return int((find_flaws(faces, points, gradients, lattice, pool) & FOLDED).sum())
