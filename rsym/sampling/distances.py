"""Distances to a boundary, found without its equation: what a value of omega is held against."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TypeAlias

import numpy as np
from scipy.spatial import cKDTree

from rsym.arrays import Floats
from rsym.sampling.mesh import Mesh

Feet: TypeAlias = Callable[[Floats, Floats], Floats]

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
    return _apart(points, nearest_on_lines(points, lines))


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
    return _apart(points, nearest_on_mesh(points, mesh))


def nearest_on_lines(points: Floats, lines: Sequence[Floats]) -> Floats:
    """The places (n, 2) of polylines that are nearest to points."""
    starts = np.concatenate([line[:-1] for line in lines])
    ends = np.concatenate([line[1:] for line in lines])
    return _nearest(points, np.stack([starts, ends], axis=1), _on_segments)


def nearest_on_mesh(points: Floats, mesh: Mesh) -> Floats:
    """The places (n, 3) of the triangles of a mesh that are nearest to points."""
    return _nearest(points, mesh.vertices[mesh.faces], _on_triangles)


def _nearest(points: Floats, elements: Floats, feet: Feet) -> Floats:
    """The nearest places of the elements whose middles are nearest."""
    tree = cKDTree(elements.mean(axis=1))
    found = np.empty(points.shape)
    for start in range(0, len(points), BATCH):
        part = points[start : start + BATCH]
        _, near = tree.query(part, k=min(NEAREST, len(elements)))
        near = near.reshape(len(part), -1)
        repeated = np.repeat(part, near.shape[1], axis=0)
        places = feet(repeated, elements[near.ravel()])
        least = _apart(repeated, places).reshape(near.shape).argmin(axis=1)
        found[start : start + BATCH] = places.reshape(*near.shape, -1)[np.arange(len(part)), least]
    return found


def _on_segments(points: Floats, segments: Floats) -> Floats:
    """The place of its segment (n, 2, dim) that is nearest to each point."""
    start, along = segments[:, 0], segments[:, 1] - segments[:, 0]
    squared = np.maximum(_dot(along, along), np.finfo(float).tiny)
    share = np.clip(_dot(points - start, along) / squared, 0.0, 1.0)
    return np.asarray(start + share[:, None] * along)


def _on_triangles(points: Floats, triangles: Floats) -> Floats:
    """The place of its triangle (n, 3, 3) that is nearest to each point: in its plane below it, else on its edges."""
    a, b, c = triangles.transpose(1, 0, 2)
    normal = np.cross(b - a, c - a)
    sides = [_dot(np.cross(end - start, points - start), normal) for start, end in ((a, b), (b, c), (c, a))]
    above = np.all(np.stack(sides) >= 0, axis=0, keepdims=True).T
    squared = np.maximum(_dot(normal, normal), np.finfo(float).tiny)
    edges = np.stack([_on_segments(points, triangles[:, pair]) for pair in ([0, 1], [1, 2], [2, 0])])
    least = np.linalg.norm(points - edges, axis=2).argmin(axis=0)
    below = points - (_dot(points - a, normal) / squared)[:, None] * normal
    return np.asarray(np.where(above, below, edges[least, np.arange(len(points))]))


def _apart(points: Floats, places: Floats) -> Floats:
    return np.asarray(np.linalg.norm(points - places, axis=1))


def _dot(left: Floats, right: Floats) -> Floats:
    return np.asarray(np.einsum("ij,ij->i", left, right))
