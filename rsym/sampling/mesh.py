"""A triangle mesh; what is expensive to know of it is found when it is asked for."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from html import escape
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from rsym.sampling.manifolds import checked, measure
from rsym.sampling.sharp.features import Feature, features_of
from rsym.sampling.status import Findings, MeshStatus
from rsym.sampling.stills import surface_picture

Array: TypeAlias = NDArray[np.float64]
Ints: TypeAlias = NDArray[np.integer[Any]]
# Leaves (k,) and points (k, 3) to outward directions (k, 3) of any length: -grad of the leaf there.
Outward: TypeAlias = Callable[[Ints, Array], Array]


@dataclass(frozen=True, eq=False, repr=False)
class Mesh:
    """Triangles with outward orientation.

    `normals`, `features`, `findings` and `status` are computed at the first use and kept; a mesh that is pickled
    carries its normals and findings along.

    Attributes
    ----------
    vertices : (n, 3) float64
    faces : (m, 3) int, counter-clockwise seen from outside
    shading : (m, 3, 3) array, a function of leaves (k,) and points (k, 3), or None
        Where the normals come from; without it they are those of the triangles.
    found : Findings, or a function that gives them
        What the mesher knows beside the triangles.
    leaf : (m,) int, optional
        The leaf of the sign form that each face lies on: an index into `leaves`.
    leaves : tuple of str
        The names of the leaves.
    curvatures : callable, optional
        For a surface without an equation: ``mean_curvature``, ``gaussian_curvature``, ``principal_curvatures`` to the
        values at the corners of faces, (m, 3) or (m, 3, 2). A mesh that is pickled does without.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y, z
    >>> ball = rsym.Shape(1 - x**2 - y**2 - z**2, (x, y, z), bounds=((-1.2, 1.2),) * 3)
    >>> mesh = rsym.mesh(ball, 16)
    >>> mesh.vertices.shape[1], mesh.faces.shape[1], mesh.normals.shape[1:], mesh.status.closed
    (3, 3, (3, 3), True)
    """

    vertices: Array
    faces: Ints
    shading: Array | Outward | None = None
    found: Findings | Callable[[], Findings] = field(default_factory=Findings)
    leaf: Ints | None = None
    leaves: tuple[str, ...] = ()
    curvatures: Callable[[str], Array] | None = None

    @cached_property
    def normals(self) -> Array:
        """The outward unit normal of each corner of each face, (m, 3, 3); that of the triangle where there is none."""
        return self.normals_of(np.arange(len(self.faces)))

    def normals_of(self, which: Ints) -> Array:
        """The normals (k, 3, 3) of a few faces (k,), for which those of all others need not be computed."""
        if self.shading is None:
            return np.repeat(self._flat(which)[:, None], 3, axis=1)
        if callable(self.shading):
            given = self._outward(self.shading, np.repeat(which, 3), self.vertices[self.faces[which].ravel()])
            given = given.reshape(-1, 3, 3)
        else:
            given = self.shading[which]
        normals = _unit(given)
        missing: NDArray[np.bool_] = np.any(np.isnan(normals), axis=2)
        bare = np.flatnonzero(np.any(missing, axis=1))
        normals[bare] = np.where(missing[bare][:, :, None], self._flat(which[bare])[:, None], normals[bare])
        return normals

    @cached_property
    def features(self) -> tuple[Feature, ...]:
        """The curves along which the leaves meet, the edges of the body among them; none where leaves are not known."""
        if self.leaf is None:
            return ()
        return features_of(self.vertices, self.faces, self.leaf, self.leaves, self.normals_of)

    @cached_property
    def findings(self) -> Findings:
        """What the mesher knows beside the triangles: what its lattice may have missed above all."""
        return self.found() if callable(self.found) else self.found

    @cached_property
    def status(self) -> MeshStatus:
        """What is known of the mesh."""
        outward = None
        if callable(self.shading):
            from rsym.sampling.triangles import middles

            points = middles(*checked(self.vertices, self.faces))
            outward = self._outward(self.shading, np.arange(len(self.faces)), points)
        elif self.shading is not None:
            outward = self.shading[:, 0] + self.shading[:, 1] + self.shading[:, 2]
        measures = measure(self.vertices, self.faces, outward, self.findings.sides)
        return MeshStatus(**vars(measures), **vars(self.findings))

    def _outward(self, rule: Outward, which: Ints, points: Array) -> Array:
        """The rule at points (k, 3), each on one of the faces (k,)."""
        return rule(np.zeros(len(which), np.int16) if self.leaf is None else self.leaf[which], points)

    def _flat(self, which: Ints) -> Array:
        """The normals of triangles; zero where they have none."""
        a, b, c = (self.vertices[self.faces[which, k]] for k in range(3))
        return np.nan_to_num(_unit(np.cross(b - a, c - a)))

    def __repr__(self) -> str:
        return f"Mesh({len(self.vertices)} vertices, {len(self.faces)} triangles)"

    def _repr_html_(self) -> str:
        return f"<div>{surface_picture(self.vertices, self.faces)}<br>{escape(repr(self)[5:-1])}</div>"

    def __reduce__(self) -> tuple[type[Mesh], tuple[Any, ...]]:
        """Pickle the normals themselves: the function they come from holds compiled code."""
        return Mesh, (self.vertices, self.faces, self.normals, self.findings, self.leaf, self.leaves)


def _unit(vectors: Array) -> Array:
    """Vectors (..., 3) of length 1; NaN for those without direction."""
    with np.errstate(all="ignore"):
        unit: Array = vectors / np.sqrt(np.einsum("...i,...i->...", vectors, vectors))[..., None]
    return unit
