"""Features: the curves on a mesh along which its leaves meet."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from rsym.arrays import Floats, Integers


@dataclass(frozen=True, eq=False)
class Feature:
    """A curve along which two leaves meet, from one junction of such curves to the next, or closed.

    Attributes
    ----------
    points : (n, 3) float64
        Vertices of the mesh; a closed curve repeats its first point.
    leaves : two numbers of leaves, ascending
        The first lies to the left of the curve, seen from outside.
    names : two names
        Those of the leaves.
    normals : (n, 2, 3) float64
        The outward unit normals of both leaves at the points.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y, z
    >>> bounds = ((-1.2, 1.2), (-1.2, 1.2), (-0.2, 1.2))
    >>> dome = rsym.Shape(rsym.conjunction(1 - x**2 - y**2 - z**2, z), (x, y, z), bounds=bounds)
    >>> (rim,) = rsym.mesh(dome, 16).features
    >>> rim.names, rim.closed, round(rim.angle)
    (('-x**2 - y**2 - z**2 + 1', 'z'), True, 90)
    """

    points: Floats
    leaves: tuple[int, int]
    names: tuple[str, str]
    normals: Floats

    @property
    def angles(self) -> Floats:
        """The angles between both normals at the points, in degrees: small where one leaf goes on as the other."""
        u, v = self.normals[:, 0], self.normals[:, 1]
        across = np.linalg.norm(np.cross(u, v), axis=1)
        angles: Floats = np.degrees(np.arctan2(across, np.einsum("ij,ij->i", u, v)))
        return angles

    @property
    def angle(self) -> float:
        """The largest of them."""
        return float(self.angles.max())

    @property
    def closed(self) -> bool:
        """Whether the curve ends where it begins."""
        return bool((self.points[0] == self.points[-1]).all())

    def __repr__(self) -> str:
        kind = "closed" if self.closed else "open"
        return f"Feature({self.names[0]!r} | {self.names[1]!r}, {len(self.points)} points, {kind}, {self.angle:.3g}°)"


def features_of(
    vertices: Floats,
    faces: Integers,
    leaf: Integers,
    part: Integers,
    parts: Sequence[str],
    normals: Callable[[Integers], Floats],
) -> tuple[Feature, ...]:
    """The features of a mesh, in the order of their first vertices; where a part beside one ends, so does the feature.

    Parameters
    ----------
    vertices, faces, leaf, part, parts
        As in a mesh.
    normals : callable
        Numbers of faces (k,) to the unit normals of their corners (k, 3, 3).

    Examples
    --------
    >>> roof = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 1], [1, 1, 1], [0, 2, 0], [1, 2, 0.0]])
    >>> slopes = np.array([[0, 1, 2], [1, 3, 2], [2, 3, 4], [3, 5, 4]])
    >>> normals = np.array([[0, -1, 1], [0, 1, 1]])[:, None].repeat(3, axis=1) / 2**0.5
    >>> features_of(roof, slopes, *[np.array([0, 0, 1, 1])] * 2, ("south", "north"), lambda faces: normals[faces // 2])
    (Feature('south' | 'north', 2 points, open, 90°),)
    """
    _, side = np.unique(leaf.astype(np.int64) * len(parts) + part, return_inverse=True)
    seams = _seams(faces, leaf, side.reshape(-1), len(vertices))
    if not len(seams.start):
        return ()
    beside = _beside(seams, normals)
    found = []
    for chain in _chains(seams):
        line = np.append(seams.start[chain], seams.end[chain[-1]])
        first, second = (int(half[chain[0]] // 3) for half in (seams.left, seams.right))
        both = np.concatenate([beside[chain, 0], beside[chain[-1:], 1]])
        names = parts[part[first]], parts[part[second]]
        found.append(Feature(vertices[line], (int(leaf[first]), int(leaf[second])), names, both))
    return tuple(found)


class _Seams(NamedTuple):
    """Edges between faces of two leaves, from `start` to `end`: vertices, and half-edges 3*face + corner beside them.

    The left one runs along the edge, in the face of the lower leaf; the right one runs back.
    """

    start: Integers
    end: Integers
    left: Integers
    right: Integers
    pair: Integers


def _seams(faces: Integers, leaf: Integers, side: Integers, count: int) -> _Seams:
    """Where the leaves of faces differ; by `side` those of one leaf are told apart."""
    # Any one leaf of each vertex: faces that disagree with it find all vertices of two leaves, and few edges are left.
    one = np.zeros(count, leaf.dtype)
    one[faces] = leaf[:, None]
    mixed = np.zeros(count, np.bool_)
    mixed[faces[one[faces] != leaf[:, None]]] = True
    both = mixed[faces]
    half = np.flatnonzero(both & both[:, [1, 2, 0]])
    tail = faces.ravel()[half].astype(np.int64)
    head = faces.ravel()[half - half % 3 + (half + 1) % 3].astype(np.int64)
    key = np.minimum(tail, head) * count + np.maximum(tail, head)
    order = np.argsort(key, kind="stable")
    _, first, sides = np.unique(key[order], return_index=True, return_counts=True)
    first = first[sides == 2]
    a, b = order[first], order[first + 1]
    on_a, on_b = leaf[half[a] // 3], leaf[half[b] // 3]
    seam = (on_a != on_b) & (tail[a] == head[b])
    left, right = np.where(on_a < on_b, a, b)[seam], np.where(on_a < on_b, b, a)[seam]
    one, other = side[half[a] // 3][seam], side[half[b] // 3][seam]
    pair = np.minimum(one, other) << 32 | np.maximum(one, other)
    return _Seams(tail[left], head[left], half[left], half[right], pair)


def _chains(seams: _Seams) -> list[list[int]]:
    """The edges of each feature, head to tail: on while one comes in, one goes out and both join the same leaves."""
    vertices, ends = np.unique(np.concatenate([seams.start, seams.end]), return_inverse=True)
    start, end = np.split(ends, 2)
    edges = np.arange(len(start))
    comes, goes = np.zeros((2, len(vertices)), np.int64)
    comes[end], goes[start] = edges, edges
    passed = (np.bincount(start, minlength=len(vertices)) == 1) & (np.bincount(end, minlength=len(vertices)) == 1)
    passed &= seams.pair[comes] == seams.pair[goes]
    after = np.where(passed[end], goes[end], -1).tolist()
    # Closed curves without a junction come last: they may begin anywhere.
    begins = np.argsort(passed[start], kind="stable").tolist()
    done, chains = [False] * len(edges), []
    for edge in begins:
        chain = []
        while edge >= 0 and not done[edge]:
            done[edge] = True
            chain.append(edge)
            edge = after[edge]
        if chain:
            chains.append(chain)
    return chains


def _beside(seams: _Seams, normals: Callable[[Integers], Floats]) -> Floats:
    """The normals at both ends of each edge, on its left and on its right, (k, 2, 2, 3)."""
    edges = np.arange(len(seams.start))[:, None]
    # The right half-edge runs back: its start is the end of the edge.
    corners = (seams.left[:, None] + [0, 1]) % 3, (seams.right[:, None] + [1, 0]) % 3
    sides = (normals(half // 3)[edges, k] for half, k in zip((seams.left, seams.right), corners, strict=True))
    return np.stack(list(sides), axis=2)
