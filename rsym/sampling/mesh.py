"""A triangle mesh and what is known of it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from rsym.errors import RsymError
from rsym.sampling.detail import Detail, small_pieces

Ints = NDArray[np.int64]

# Walls of constant thickness below this share of a cell leave crumbs, which are told as small pieces anyway.
KNIFE_EDGE = 0.1


@dataclass(frozen=True)
class MeshStatus:
    """What was found out about a mesh while it was made.

    `boundary_edges` counts directed edges whose reverse is missing, `repeated_edges`
    directed edges that occur more than once; both are zero for a closed manifold.
    `clipped_at` names the sides of the bounds through which the surface leaves.
    `thin` are walls and gaps thinner than a cell, `small` pieces of less than three cells.
    """

    triangles: int
    components: int
    euler_characteristic: int
    volume: float
    boundary_edges: int
    repeated_edges: int
    clipped_at: tuple[str, ...] = ()
    nudged_zeros: int = 0
    unresolved: int = 0
    thin: Detail | None = None
    small: Detail | None = None

    @property
    def closed(self) -> bool:
        """Whether every directed edge occurs once and its reverse once."""
        return self.boundary_edges == 0 and self.repeated_edges == 0

    @property
    def clipped(self) -> bool:
        """Whether all open edges lie on the sides of the bounds."""
        return bool(self.clipped_at)

    def __str__(self) -> str:
        if self.closed:
            state = f"closed: every edge joins two of them, and they enclose a volume of {self.volume:.6g}"
        elif self.clipped:
            state = f"clipped: {self.boundary_edges} open edges on the sides of the bounds"
        else:
            state = f"open: {self.boundary_edges} edges have one triangle, {self.repeated_edges} more than two"
        pieces = "one piece" if self.components == 1 else f"{self.components} pieces"
        text = f"{self.triangles} triangles in {pieces}, {state}; Euler characteristic {self.euler_characteristic}."
        if self.unresolved:
            # No remark: float32 put them on a lattice point, so they are off by a ten-thousandth of a cell.
            text += f" Vertices unresolved, kept where linear interpolation put them: {self.unresolved}."
        return " ".join([text, *self.remarks])

    @property
    def remarks(self) -> tuple[str, ...]:
        """What one should know before using the mesh, a sentence each; `rsym.mesh` warns of them."""
        remarks = []
        if self.clipped_at:
            remarks.append(f"The surface leaves the bounds at {', '.join(self.clipped_at)}; wider bounds close it.")
        if self.nudged_zeros:
            samples = _plural(self.nudged_zeros, "sample", "samples")
            remarks.append(
                f"{samples} lay exactly on the surface and were counted as inside; another resolution may avoid them."
            )
        if self.thin is not None:
            remarks.append(
                f"At {_plural(self.thin.places, 'place', 'places')} a wall or a gap is thinner than a cell, at worst"
                f" {self.thin.cells:.2g} cells near {self.thin.finest}; {_finer(2, self.thin)}."
            )
        if self.small is not None:
            remarks.append(
                f"{_plural(self.small.places, 'piece is', 'pieces are')} smaller than three cells, the smallest"
                f" {self.small.cells:.2g} cells near {self.small.finest}; {_finer(6, self.small)}."
            )
        return tuple(remarks)


def _plural(count: int, one: str, many: str) -> str:
    return f"{count} {one if count == 1 else many}"


def _finer(cells: int, detail: Detail) -> str:
    """The resolution that puts so many cells across a detail; an edge like a knife's has none."""
    if detail.cells < KNIFE_EDGE:
        return "it may taper to an edge, which no resolution resolves"
    return f"{cells / detail.cells:.2g} times the resolution puts {cells} cells across it"


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
    sides: Mapping[str, NDArray[np.bool_]] | None = None,
    spacing: Sequence[float] | None = None,
    nudged_zeros: int = 0,
    unresolved: int = 0,
    thin: Detail | None = None,
) -> MeshStatus:
    """Count edges, pieces and volume.

    `sides` marks, by name, the vertices on each side of the bounds, where a surface may be clipped;
    with the `spacing` of the lattice small pieces are counted too.

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
    start, end = faces.astype(np.int32).ravel(), faces[:, [1, 2, 0]].astype(np.int32).ravel()
    # As a matrix: directed edges are entries, repeated ones add up, and reverse ones are those of its transpose.
    times = sparse.csr_array((np.ones(len(start), np.int32), (start, end)), shape=(count, count))
    edges = times.astype(bool)
    boundary = edges > edges.T
    used = np.flatnonzero(np.bincount(start, minlength=count))
    _, label = sparse.csgraph.connected_components(times, directed=False)
    components = len(np.unique(label[used]))
    small = small_pieces(vertices[used], label[used], spacing) if spacing and components > 1 else None
    return MeshStatus(
        triangles=len(faces),
        components=components,
        euler_characteristic=len(used) - (edges.nnz + boundary.nnz) // 2 + len(faces),
        volume=signed_volume(vertices, faces),
        boundary_edges=boundary.nnz,
        repeated_edges=int((times.data > 1).sum()),
        clipped_at=_clipped_at(sides or {}, *boundary.nonzero()),
        nudged_zeros=nudged_zeros,
        unresolved=unresolved,
        thin=thin,
        small=small,
    )


def _clipped_at(sides: Mapping[str, NDArray[np.bool_]], start: Ints, end: Ints) -> tuple[str, ...]:
    """The sides that hold open edges; none if an edge lies on no side."""
    on_side = {name: marks[start] & marks[end] for name, marks in sides.items()}
    if not on_side or not np.any(list(on_side.values()), axis=0).all():
        return ()
    return tuple(name for name, marks in on_side.items() if marks.any())


def signed_volume(vertices: NDArray[np.float64], faces: NDArray[np.int64]) -> float:
    """The sum of a . (b x c)/6 over the triangles, taken from the middle of the mesh."""
    a, b, c = (vertices - vertices.mean(axis=0))[faces].transpose(1, 0, 2)
    return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6)
