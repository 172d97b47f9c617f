"""Distances to a boundary, found without its equation: what a value of omega is held against."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TypeAlias

import numpy as np
from scipy.spatial import cKDTree

from rsym.arrays import Floats
from rsym.sampling.mesh import Mesh

Distances: TypeAlias = Callable[[Floats, Floats], Floats]

NEAREST = 12  # elements whose middles are nearest to a point; the nearest element is among them on even meshes
BATCH = 20_000  # points at once


def distance_to_lines(points: Floats, lines: Sequence[Floats]) -> Floats:
    """Return the distance of points (n, 2) from polylines, each (m, 2).

    Examples
    --------
    >>> corner = np.array([[0, 0], [2, 0], [2, 2.0]])
    >>> distance_to_lines(np.array([[1, 0.5], [3, 1.0]]), [corner])
    array([0.5, 1. ])
    """
    starts = np.concatenate([line[:-1] for line in lines])
    ends = np.concatenate([line[1:] for line in lines])
    return _nearest(points, np.stack([starts, ends], axis=1), _to_segments)


def distance_to_mesh(points: Floats, mesh: Mesh) -> Floats:
    """Return the distance of points (n, 3) from the triangles of a mesh.

    Examples
    --------
    >>> corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]])
    >>> faces = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    >>> body = Mesh(corners, faces)
    >>> distance_to_mesh(np.array([[0.2, 0.2, -0.5], [-3, 0, -4.0]]), body)
    array([0.5, 5. ])
    """
    return _nearest(points, mesh.vertices[mesh.faces], _to_triangles)


def _nearest(points: Floats, elements: Floats, distances: Distances) -> Floats:
    """Return the least distance to the elements whose middles are nearest."""
    tree = cKDTree(elements.mean(axis=1))
    least = np.empty(len(points))
    for start in range(0, len(points), BATCH):
        part = points[start : start + BATCH]
        _, near = tree.query(part, k=min(NEAREST, len(elements)))
        near = near.reshape(len(part), -1)
        repeated = np.repeat(part, near.shape[1], axis=0)
        least[start : start + BATCH] = distances(repeated, elements[near.ravel()]).reshape(near.shape).min(axis=1)
    return least


def _to_segments(points: Floats, segments: Floats) -> Floats:
    """Return the distance of each point from its segment (n, 2, dim)."""
    start, along = segments[:, 0], segments[:, 1] - segments[:, 0]
    squared = np.maximum(_dot(along, along), np.finfo(float).tiny)
    share = np.clip(_dot(points - start, along) / squared, 0.0, 1.0)
    return np.asarray(np.linalg.norm(points - start - share[:, None] * along, axis=1))


def _to_triangles(points: Floats, triangles: Floats) -> Floats:
    """Return the distance of each point from its triangle (n, 3, 3): from its plane above it, else from its edges."""
    a, b, c = triangles.transpose(1, 0, 2)
    normal = np.cross(b - a, c - a)
    sides = [_dot(np.cross(end - start, points - start), normal) for start, end in ((a, b), (b, c), (c, a))]
    above = (np.stack(sides) >= 0).all(axis=0)
    length = np.maximum(np.linalg.norm(normal, axis=1), np.finfo(float).tiny)
    edges = [_to_segments(points, triangles[:, pair]) for pair in ([0, 1], [1, 2], [2, 0])]
    result: Floats = np.where(above, np.abs(_dot(points - a, normal)) / length, np.min(edges, axis=0))
    return result


def _dot(left: Floats, right: Floats) -> Floats:
    return np.asarray(np.einsum("ij,ij->i", left, right))
