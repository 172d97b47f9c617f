"""A triangle mesh and what is known of it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from rsym.errors import RsymError


@dataclass(frozen=True)
class MeshStatus:
    """What was found out about a mesh while it was made.

    `boundary_edges` counts directed edges whose reverse is missing, `repeated_edges`
    directed edges that occur more than once; both are zero for a closed manifold.
    """

    triangles: int
    components: int
    euler_characteristic: int
    volume: float
    boundary_edges: int
    repeated_edges: int
    clipped: bool
    nudged_zeros: int = 0
    unresolved: int = 0

    @property
    def closed(self) -> bool:
        """Whether every directed edge occurs once and its reverse once."""
        return self.boundary_edges == 0 and self.repeated_edges == 0

    def __str__(self) -> str:
        if self.closed:
            state = f"closed: every edge joins two of them, and they enclose a volume of {self.volume:.6g}"
        elif self.clipped:
            state = f"clipped: the surface leaves the bounds through {self.boundary_edges} open edges on the box"
        else:
            state = f"open: {self.boundary_edges} edges have one triangle, {self.repeated_edges} more than two"
        pieces = "one piece" if self.components == 1 else f"{self.components} pieces"
        text = f"{self.triangles} triangles in {pieces}, {state}; Euler characteristic {self.euler_characteristic}."
        if self.nudged_zeros:
            text += f" {self.nudged_zeros} samples lay exactly on the surface and were counted as inside."
        if self.unresolved:
            text += f" {self.unresolved} vertices are unresolved: they keep the place that linear interpolation gave."
        return text


@dataclass(frozen=True)
class Mesh:
    """Triangles with outward orientation.

    Attributes
    ----------
    vertices : (n, 3) float64
    faces : (m, 3) int64, counter-clockwise seen from outside
    normals : (m, 3, 3) float64, outward unit normal of each corner of each face
    status : MeshStatus

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y, z
    >>> ball = rsym.Shape(1 - x**2 - y**2 - z**2, (x, y, z), bounds=((-1.2, 1.2),) * 3)
    >>> mesh = rsym.mesh(ball, 16)
    >>> mesh.vertices.shape[1], mesh.faces.shape[1], mesh.normals.shape[1:]
    (3, 3, (3, 3))
    """

    vertices: NDArray[np.float64]
    faces: NDArray[np.int64]
    normals: NDArray[np.float64]
    status: MeshStatus


def examine(
    vertices: NDArray[np.float64],
    faces: NDArray[np.int64],
    *,
    on_box: NDArray[np.bool_] | None = None,
    nudged_zeros: int = 0,
    unresolved: int = 0,
) -> MeshStatus:
    """Count edges, pieces and volume; `on_box` marks vertices on the box's faces, where a surface may be clipped.

    Examples
    --------
    >>> import numpy as np
    >>> corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]])
    >>> faces = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    >>> print(examine(corners, faces))
    4 triangles in one piece, closed: every edge joins two of them, and they enclose a volume of 0.166667; \
Euler characteristic 2.
    """
    if not len(faces):
        raise RsymError("a mesh needs at least one triangle, got none", code="empty-mesh")
    count = len(vertices)
    start, end = faces[:, [0, 1, 2]].ravel(), faces[:, [1, 2, 0]].ravel()
    keys, occurrences = np.unique(start * count + end, return_counts=True)
    reverse = keys % count * count + keys // count
    boundary = keys[~np.isin(reverse, keys, assume_unique=True)]
    ends = np.concatenate([boundary // count, boundary % count])
    clipped = bool(len(boundary)) and on_box is not None and bool(on_box[ends].all())
    used = np.unique(faces)
    graph = sparse.coo_array((np.ones(len(start), bool), (start, end)), shape=(count, count))
    _, label = sparse.csgraph.connected_components(graph, directed=False)
    edges = len(np.unique(np.minimum(keys, reverse)))
    return MeshStatus(
        triangles=len(faces),
        components=len(np.unique(label[used])),
        euler_characteristic=len(used) - edges + len(faces),
        volume=signed_volume(vertices, faces),
        boundary_edges=len(boundary),
        repeated_edges=int((occurrences > 1).sum()),
        clipped=clipped,
        nudged_zeros=nudged_zeros,
        unresolved=unresolved,
    )


def signed_volume(vertices: NDArray[np.float64], faces: NDArray[np.int64]) -> float:
    """The sum of a . (b x c)/6 over the triangles, taken from the middle of the mesh."""
    corners = (vertices - vertices.mean(axis=0))[faces]
    triple = np.einsum("ij,ij->i", corners[:, 0], np.cross(corners[:, 1], corners[:, 2]))
    return float(triple.sum() / 6)
