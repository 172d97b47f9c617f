"""Measures of a triangle mesh: how its triangles hang together, and what they look like."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rsym.arrays import Floats, Integers
from rsym.errors import RsymError
from rsym.sampling.lattice import BoundsSide

Point = tuple[float, float, float]

# An open edge this close to a side, against the length of the loop, lies on it: rounding of the lattice is below 1e-14.
ON_SIDE = 1e-9


@dataclass(frozen=True)
class Loop:
    """A closed chain of open edges: its vertices in order, the body to the left seen from outside, and the sides.

    `sides` names the sides of the bounds that hold its edges; none if an edge lies on no side.
    """

    vertices: tuple[int, ...]
    sides: tuple[str, ...] = ()


@dataclass(frozen=True)
class EnclosedSolid:
    """What closed triangles enclose, of density 1: the volume, its centroid (3,), and the inertia (3, 3) about that."""

    volume: float
    centroid: Floats
    inertia: Floats


@dataclass(frozen=True, kw_only=True)
class Measures:
    """What the triangles alone tell.

    Attributes
    ----------
    triangles, components, euler_characteristic : int
    genera : tuple of int
        The genus of each piece, largest number of triangles first; empty unless the mesh is a manifold.
    volume, area : float
        The signed volume, positive if the triangles face outwards, and the area.
    boundary_edges, repeated_edges : int
        Directed edges whose reverse is missing, and those that occur more than once; zero for a closed manifold.
    pinched : int
        Vertices whose triangles are not one fan.
    duplicates : int
        Triangles that have the same three vertices as an earlier one.
    degenerate : int
        Triangles without area.
    folded, folded_share : int, float
        Triangles that face inwards, and their share of the area.
    worst_angle : float
        The smallest angle of a triangle in degrees.
    worst_angle_at : tuple of three floats
        Where it is.
    loops : tuple of Loop
        The open edges, chained.
    """

    triangles: int
    components: int
    euler_characteristic: int
    genera: tuple[int, ...]
    volume: float
    area: float
    boundary_edges: int
    repeated_edges: int
    pinched: int
    duplicates: int
    degenerate: int
    folded: int
    folded_share: float
    worst_angle: float
    worst_angle_at: Point
    loops: tuple[Loop, ...]


def measure(
    vertices: Floats, faces: Integers, outward: Floats | None = None, sides: Sequence[BoundsSide] = ()
) -> Measures:
    """Count, add up and look for the worst.

    Parameters
    ----------
    vertices : (n, 3) array
    faces : (m, 3) array of int
    outward : (m, 3) array, optional
        A direction of any length for each triangle that it ought to face; NaN or zero where it is unknown.
        Without it triangles are compared with their neighbours.
    sides : sequence of BoundsSide
        Where open edges are looked for.

    Examples
    --------
    >>> import numpy as np
    >>> corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]])
    >>> faces = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    >>> found = measure(corners, faces)
    >>> found.euler_characteristic, found.genera, round(found.volume, 6), round(found.worst_angle, 6)
    (2, (0,), 0.166667, 45.0)
    """
    # numba takes a third of a second to import, which those who only pass a mesh on need not wait for.
    from rsym.sampling import triangles

    vertices, faces = checked(vertices, faces)
    mates, edges, boundary, repeated = triangles.pair(faces, len(vertices))
    label = triangles.pieces(faces, len(vertices))
    pinched = triangles.pinched(faces, mates, len(vertices))
    chain, begins = triangles.loops(faces, mates)
    manifold = repeated == 0 and pinched == 0
    sums, angle, corner, degenerate, normals = triangles.shapes(vertices, faces)
    if outward is None:
        folded = triangles.turned_from_neighbours(normals, mates)
    else:
        folded = np.einsum("ij,ij->i", normals, outward) < 0
    double_area = np.sqrt(np.einsum("ij,ij->i", normals[folded], normals[folded])).sum()
    return Measures(
        triangles=len(faces),
        components=int(label.max()) + 1,
        euler_characteristic=int(np.count_nonzero(label >= 0)) - edges + len(faces),
        genera=_genera(label, faces, mates, chain[begins[:-1]]) if manifold else (),
        volume=float(sums[0]) / 6,
        area=float(sums[1]) / 2,
        boundary_edges=boundary,
        repeated_edges=repeated,
        pinched=pinched,
        duplicates=_duplicates(faces) if repeated or triangles.back_to_back(mates) else 0,
        degenerate=degenerate,
        folded=int(np.count_nonzero(folded)),
        folded_share=float(double_area / sums[1]) if sums[1] else 0.0,
        worst_angle=math.degrees(angle),
        worst_angle_at=point(vertices[corner]),
        loops=_loops(vertices, np.split(faces.ravel()[chain], begins[1:-1]) if len(chain) else [], sides),
    )


def area_of(vertices: Floats, faces: Integers) -> float:
    """The area of the triangles.

    Examples
    --------
    >>> area_of(np.array([[0, 0, 0], [2, 0, 0], [0, 3, 0.0]]), np.array([[0, 1, 2]]))
    3.0
    """
    vertices, faces = checked(vertices, faces)
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    normals = np.cross(b - a, c - a)
    return float(np.sqrt(np.einsum("ij,ij->i", normals, normals)).sum()) / 2


def enclosed(vertices: Floats, faces: Integers) -> EnclosedSolid:
    """The volume, centroid and inertia of a closed polyhedron, exact but for rounding.

    By the divergence theorem each is the sum over the triangles (a, b, c) of that of the tetrahedron (o, a, b, c), with
    its sign; o does not matter. With det = (a - o) x (b - o) . (c - o) and s = a + b + c - 3 o

        V = sum det/6        V (m - o) = sum det s/24        C = sum det (s s' + the outer squares of a - o, ...)/120

    the centroid is m, and the inertia tr(D) 1 - D where D = C - V (m - o)(m - o)'. Centroid and inertia of a volume
    of 0 are NaN. Every directed edge must occur as often as its reverse.

    Examples
    --------
    >>> corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]])
    >>> found = enclosed(corners, np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]))
    >>> round(found.volume, 12), found.centroid.round(12).tolist(), found.inertia.round(12).tolist()[0]
    (0.166666666667, [0.25, 0.25, 0.25], [0.0125, 0.002083333333, 0.002083333333])
    """
    vertices, faces = checked(vertices, faces)
    _require_closed(vertices, faces)
    used = vertices[np.unique(faces)]
    middle = (used.min(axis=0) + used.max(axis=0)) / 2
    corners = (vertices - middle)[faces]
    whole = corners.sum(axis=1)
    det = np.einsum("ij,ij->i", np.cross(corners[:, 0], corners[:, 1]), corners[:, 2])
    volume = float(det.sum()) / 6
    squares = np.einsum("i,ip,iq->pq", det, whole, whole) + np.einsum("i,ikp,ikq->pq", det, corners, corners)
    with np.errstate(all="ignore"):
        centroid = np.asarray(det @ whole / 24 / np.float64(volume))
    about = squares / 120 - volume * np.outer(centroid, centroid)
    return EnclosedSolid(volume, middle + centroid, np.trace(about) * np.eye(3) - about)


def _require_closed(vertices: Floats, faces: Integers) -> None:
    """Refuse triangles that leave an edge open, and say how many and where the first is."""
    starts, ends = faces.ravel().astype(np.int64), np.roll(faces, -1, axis=1).ravel().astype(np.int64)
    keys = np.minimum(starts, ends) * len(vertices) + np.maximum(starts, ends)
    edges, number = np.unique(keys, return_inverse=True)
    excess = np.bincount(number, np.sign(ends - starts))  # exact: counts
    open_ = np.flatnonzero(excess)
    if len(open_):
        first, last = divmod(int(edges[open_[0]]), len(vertices))
        count = f"{len(open_)} open edge{'s' * (len(open_) > 1)}"
        raise RsymError(
            f"the mesh encloses nothing: {count}, which no triangle passes the other way, the first from"
            f" {_place(vertices[first])} to {_place(vertices[last])}",
            code="open-mesh",
            remedy="mesh(shape) with cap=True, or with bounds=... that hold the body; area and bounds need no inside",
        )


def _place(vertex: Floats) -> str:
    return "(" + ", ".join(f"{value:.4g}" for value in vertex) + ")"


def checked(vertices: Floats, faces: Integers) -> tuple[Floats, NDArray[np.int32]]:
    """Arrays as the loops want them, which look up what they are told to."""
    if not len(faces):
        raise RsymError("a mesh needs at least one triangle, got none", code="empty-mesh")
    vertices = np.ascontiguousarray(vertices, np.float64)
    if vertices.shape[1:] != (3,) or faces.shape[1:] != (3,) or not np.isfinite(vertices).all():
        raise RsymError(
            f"a mesh has finite vertices (n, 3) and faces (m, 3), got {vertices.shape} and {faces.shape}", code="mesh"
        )
    if faces.min() < 0 or faces.max() >= len(vertices):
        raise RsymError(
            f"faces number the vertices from 0 to {len(vertices) - 1}, got {faces.min()} to {faces.max()}", code="mesh"
        )
    return vertices, np.ascontiguousarray(faces, np.int32)


def _genera(label: Integers, faces: Integers, mates: Integers, heads: Integers) -> tuple[int, ...]:
    """V - E + F = 2 - 2 genus - loops for each piece, with 2 E = 3 F + the half-edges without a mate."""
    of_face, corners = label[faces[:, 0]], faces.ravel()
    count = int(label.max()) + 1
    v, f, loops, free = (
        np.bincount(which, minlength=count)
        for which in (label[label >= 0], of_face, label[corners[heads]], of_face[np.flatnonzero(mates < 0) // 3])
    )
    genus = (2 - loops - v + (3 * f + free) // 2 - f) // 2
    return tuple(genus[np.argsort(-f, kind="stable")].tolist())


def _loops(vertices: Floats, chains: Sequence[Integers], sides: Sequence[BoundsSide]) -> tuple[Loop, ...]:
    found = []
    for chain in chains:
        places = vertices[chain]
        near = ON_SIDE * float(np.ptp(places, axis=0).max())
        on = np.array([np.abs(places[:, side.axis] - side.value) <= near for side in sides], bool)
        edges = on & np.roll(on, -1, axis=-1)
        names = [side.name for side, held in zip(sides, edges, strict=True) if held.any()]
        found.append(Loop(tuple(chain.tolist()), tuple(names) if edges.any(axis=0).all() else ()))
    return tuple(found)


def _duplicates(faces: Integers) -> int:
    """Equal triangles share edges: they repeat one, or are mates along all three. Only then is it worth a sort."""
    return len(faces) - len(np.unique(np.sort(faces, axis=1), axis=0))


def point(place: Sequence[float] | Floats) -> Point:
    """A place to four digits, as one tells it."""
    x, y, z = (float(f"{value:.4g}") for value in place)
    return x, y, z
