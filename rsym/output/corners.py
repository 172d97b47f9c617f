"""Vertices that carry one normal each: what viewers want of a mesh whose normals belong to corners of faces."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rsym.arrays import Floats
from rsym.output.shading import unit
from rsym.sampling.mesh import Mesh

Ints = NDArray[np.integer[Any]]

# Blender and most viewers call an edge sharp from 30 degrees on; normals of triangles stand for a smooth surface below.
SHARP = np.cos(np.radians(30.0))
# Normals of leaves are exact: they differ where two leaves meet, and only there.
KINK = np.cos(np.radians(1.0))


@dataclass(frozen=True)
class ShadedVertices:
    """Vertices (k, 3) with a unit normal (k, 3) each, the faces (m, 3) among them, and whose copies they are (k,)."""

    vertices: Floats
    normals: Floats
    faces: Ints
    source: Ints


def split_sharp(mesh: Mesh) -> ShadedVertices:
    """Copy each vertex once for every direction its corners face, so that smooth shading keeps sharp edges crisp.

    Corners of one vertex share a copy where their normals lie within 30 degrees
    of the first, on one leaf and within one degree if the faces know their leaves;
    the copy takes their mean. Vertices of no face are left out.

    Examples
    --------
    >>> corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]])
    >>> faces = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    >>> len(split_sharp(Mesh(corners, faces)).vertices)
    12
    """
    vertex = mesh.faces.ravel().astype(np.int64)
    corner = vertex if mesh.leaf is None else vertex * (int(mesh.leaf.max()) + 1) + np.repeat(mesh.leaf, 3)
    limit = SHARP if mesh.leaf is None else KINK
    normals = mesh.normals.reshape(-1, 3)
    copy = np.zeros(len(corner), np.int64)
    left = np.arange(len(corner))
    while left.size:
        names, first = np.unique(corner[left], return_index=True)
        seeds = normals[left[first]][np.searchsorted(names, corner[left])]
        apart = np.einsum("ij,ij->i", seeds, normals[left]) < limit
        # The seeds themselves stay whatever rounding says, so each round has fewer corners left.
        apart[first] = False
        left = left[apart]
        copy[left] += 1
    _, first, faces = np.unique(corner * (copy.max() + 1) + copy, return_index=True, return_inverse=True)
    sums: Floats = np.stack([np.bincount(faces, normals[:, k]) for k in range(3)], axis=1).astype(np.float64)
    source = vertex[first]
    return ShadedVertices(mesh.vertices[source], unit(sums), faces.reshape(-1, 3).astype(np.int64), source)
