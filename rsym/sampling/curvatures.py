"""Curvatures of the surface at the vertices of a mesh: those of the leaf that each face lies on."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from rsym.arrays import Flags, Floats, Ints
from rsym.model.requirements import require_shape
from rsym.model.shape import Shape
from rsym.sampling.leaf_fields import LeafFields, distances, longest_side, refuse_foreign
from rsym.sampling.mesh import Mesh

CURVATURES = ("mean_curvature", "gaussian_curvature", "principal_curvatures", "principal_directions")
# Farther from the leaf of its face, as a share of the size of the body, a vertex is moved onto it.
ON_LEAF = 1e-9
# Of the way to the middle of a face: where a leaf has a kink, what lies so far inside tells which side is the face's.
INWARDS = 1e-4
# Between a corner and there curvature and normal change by less than this, in units of the former or of 1/size.
STEADY = 1e-2
# Sides of a vertex that differ by less than this are one surface.
ALIKE = 1e-6
# A radius below this share of the size of the body: to float64 that is a tip or an edge.
POINTED = 1e-9


def corner_curvatures(mesh: Mesh, shape: Shape, *, letters: Mapping[Any, float] | None = None) -> dict[str, Floats]:
    """The exact curvatures at each corner of each face, on the side of the face.

    They are those of the leaf f that the face lies on, H = -div(grad f/|grad f|)/2 and so on. Beside an edge, where the
    second derivatives of omega are as large as one likes, and on it, where they do not exist, both sides have theirs.

    Parameters
    ----------
    mesh : Mesh
        A mesh of the shape. Where the faces do not tell their leaf, as of method "smooth", each vertex takes the leaf
        that is active there.
    shape, letters
        What the mesh was made of.

    Returns
    -------
    dict
        ``mean_curvature`` (m, 3), ``gaussian_curvature`` (m, 3), ``principal_curvatures`` (m, 3, 2), the larger first,
        ``principal_directions`` (m, 3, 2, 3), unit vectors; positive where the inside is convex, NaN at the tip of a
        cone and wherever else the leaf itself has none.

    Raises
    ------
    RsymError
        For a shape in the plane, and a mesh that is not one of the shape.

    Examples
    --------
    >>> import rsym
    >>> mesh = rsym.mesh(rsym.cylinder(2) & rsym.slab(-1, 1), 16, bounds=((-2.5, 2.5), (-2.5, 2.5), (-1.5, 1.5)))
    >>> mean = corner_curvatures(mesh, rsym.cylinder(2) & rsym.slab(-1, 1))["mean_curvature"]
    >>> np.unique(mean.round(12)).tolist()
    [0.0, 0.25]
    """
    known = _known(mesh, shape, letters)
    return {name: known.found[name][known.place] for name in CURVATURES}


def vertex_curvatures(mesh: Mesh, shape: Shape, *, letters: Mapping[Any, float] | None = None) -> dict[str, Floats]:
    """The exact curvatures at the vertices of a mesh, from the equation and not from the triangles.

    Parameters
    ----------
    mesh : Mesh
        A mesh of the shape.
    shape, letters
        What the mesh was made of.

    Returns
    -------
    dict
        ``mean_curvature`` (n,), ``gaussian_curvature`` (n,), ``principal_curvatures`` (n, 2), the larger first,
        ``principal_directions`` (n, 2, 3), unit vectors; NaN where normals or curvatures of the face corners at a
        vertex differ, as on edges: `corner_curvatures` has those of both sides.

    Raises
    ------
    RsymError
        For a shape in the plane, and a mesh that is not one of the shape.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y, z
    >>> ball = rsym.Shape(4 - x**2 - y**2 - z**2, (x, y, z), bounds=((-2.2, 2.2),) * 3)
    >>> curvatures = rsym.vertex_curvatures(rsym.mesh(ball, 8), ball)
    >>> bool(abs(curvatures["principal_curvatures"] - 0.5).max() < 1e-12)
    True
    """
    require_shape(shape)
    known = _known(mesh, shape, letters)
    alike, first = _alike(known, len(mesh.vertices), 1 / _size(mesh))
    result = {}
    for name in CURVATURES:
        values = known.found[name]
        result[name] = np.full((len(mesh.vertices), *values.shape[1:]), np.nan)
        result[name][alike] = values[first[alike]]
    return result


@dataclass(frozen=True)
class _KnownFields:
    """Fields at places: vertices (k,) on one side each; the place of each face corner (m, 3)."""

    vertex: Ints
    place: Ints
    found: dict[str, Floats]


def _known(mesh: Mesh, shape: Shape, letters: Mapping[Any, float] | None) -> _KnownFields:
    """The fields once for each leaf at a vertex; of a leaf that may have kinks, once for each face corner."""
    fields = LeafFields(shape, CURVATURES, letters)
    leaf = fields.of_corners(mesh).ravel()
    vertex, own = mesh.faces.ravel().astype(np.int64), fields.kinked[leaf]
    keys = np.where(
        own, len(mesh.vertices) * len(fields.kinked) + np.arange(len(leaf)), vertex * len(fields.kinked) + leaf
    )
    _, first, place = np.unique(keys, return_index=True, return_inverse=True)
    points, reach = mesh.vertices[vertex[first]], longest_side(mesh)
    found = fields.at(leaf[first], points)
    off = np.flatnonzero((leaf[first] < len(fields.form.leaves)) & (distances(found) > ON_LEAF * _size(mesh)))
    for name, values in fields.at(leaf[first[off]], points[off], reach).items():
        found[name][off] = values
    refuse_foreign(found, reach)
    kinked = np.flatnonzero(own[first])
    if kinked.size:
        middles = mesh.vertices[mesh.faces[first[kinked] // 3]].mean(axis=1)
        inside = points[kinked] + INWARDS * (middles - points[kinked])
        side = leaf[first[kinked]]
        moved = ~_steady({name: found[name][kinked] for name in found}, fields.at(side, inside), 1 / _size(mesh))
        for name, values in fields.at(side[moved], inside[moved], reach).items():
            found[name][kinked[moved]] = values
    with np.errstate(invalid="ignore"):
        blunt = np.abs(found["principal_curvatures"]).max(axis=1) * POINTED * _size(mesh) <= 1
    for name in CURVATURES:
        found[name][~blunt] = np.nan
    return _KnownFields(vertex[first], place.reshape(mesh.faces.shape), found)


def _steady(here: Mapping[str, Floats], there: Mapping[str, Floats], unit: float) -> Flags:
    """Whether fields at points are those of points close by."""
    one, other = (_bending(found) for found in (here, there))
    sizes = np.maximum(np.abs(other[:, 3:]).max(axis=1), unit)
    with np.errstate(invalid="ignore"):
        turned = np.abs(one[:, :3] - other[:, :3]).max(axis=1)
        return np.asarray((turned < STEADY) & (np.abs(one[:, 3:] - other[:, 3:]).max(axis=1) < STEADY * sizes))


def _bending(found: Mapping[str, Floats]) -> Floats:
    """The unit normal and the shape operator, (k, 3 + 6): what two sides of a smooth surface have in common."""
    with np.errstate(all="ignore"):
        normal = found["gradient"] / np.linalg.norm(found["gradient"], axis=1)[:, None]
    curvature, direction = found["principal_curvatures"], found["principal_directions"]
    operator = np.einsum("ki,kip,kiq->kpq", curvature, direction, direction)
    return np.concatenate([normal, operator[:, *np.triu_indices(3)]], axis=1)


def _alike(known: _KnownFields, count: int, unit: float) -> tuple[Flags, Ints]:
    """Which vertices have one normal and one shape operator on all their sides, and a place of each."""
    order = np.argsort(known.vertex, kind="stable")
    vertex, starts = np.unique(known.vertex[order], return_index=True)
    bending = _bending(known.found)[order]
    alike, first = np.zeros(count, bool), np.zeros(count, np.int64)
    first[vertex] = order[starts]
    low, high = np.minimum.reduceat(bending, starts), np.maximum.reduceat(bending, starts)
    sizes = np.maximum(np.maximum(np.abs(low), np.abs(high))[:, 3:].max(axis=1), unit)
    with np.errstate(invalid="ignore"):
        apart = (high - low) / np.concatenate([np.ones((len(sizes), 3)), np.repeat(sizes[:, None], 6, axis=1)], axis=1)
        alike[vertex] = apart.max(axis=1) <= ALIKE
    return alike, first


def _size(mesh: Mesh) -> float:
    return float(np.ptp(mesh.vertices, axis=0).max())
