"""A triangle mesh; what is expensive to know of it is found when it is asked for."""

from __future__ import annotations

import reprlib
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, field
from functools import cached_property
from html import escape
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np

from rsym.arrays import Flags, Floats, Integers
from rsym.errors import RsymError
from rsym.model.shape import Bounds
from rsym.sampling.labels import Labels, labels_of
from rsym.sampling.lattice import BoundsSide
from rsym.sampling.manifolds import EnclosedSolid, area_of, checked, enclosed, measure, point
from rsym.sampling.progress import Progress
from rsym.sampling.sharp.features import Feature, features_of
from rsym.sampling.status import Findings, MeshStatus
from rsym.sampling.stills import surface_picture

# Leaves (k,) and points (k, 3) to outward directions (k, 3) of any length: -grad of the leaf there.
Outward: TypeAlias = Callable[[Integers, Floats], Floats]


@dataclass(frozen=True)
class MeshRequest:
    """What is asked of a mesher: the arguments of `rsym.mesh`, but for the shape and the method."""

    resolution: int | Sequence[int] = 128
    bounds: Any = None
    letters: Mapping[Any, float] | None = None
    cap: bool = True
    executor: Executor | None = None
    progress: Progress | None = None
    force: bool = False
    into: Path | None = None
    memory: Any = None
    backend: str | None = None


@dataclass(frozen=True, eq=False, repr=False)
class Mesh:
    """Triangles with outward orientation.

    `normals`, `features`, `findings`, `status` and the measures are computed at the first use and kept; a mesh that is
    pickled carries its normals and findings along.

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
        The names of the leaves, ``A / B`` of one that two parts share.
    curvatures : callable, optional
        For a surface without an equation: ``mean_curvature``, ``gaussian_curvature``, ``principal_curvatures`` to the
        values at the corners of faces, (m, 3) or (m, 3, 2). A mesh that is pickled does without.
    called : Labels, or a function of points (k, 3) and leaves (k,) that gives them
        What the faces are called; without it, like their leaves.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y, z
    >>> ball = rsym.Shape(1 - x**2 - y**2 - z**2, (x, y, z), bounds=((-1.2, 1.2),) * 3)
    >>> mesh = rsym.mesh(ball, 16)
    >>> mesh.vertices.shape[1], mesh.faces.shape[1], mesh.normals.shape[1:], mesh.status.closed
    (3, 3, (3, 3), True)
    """

    vertices: Floats
    faces: Integers
    shading: Floats | Outward | None = None
    found: Findings | Callable[[], Findings] = field(default_factory=Findings)
    leaf: Integers | None = None
    leaves: tuple[str, ...] = ()
    curvatures: Callable[[str], Floats] | None = None
    called: Labels | Callable[[Floats, Integers], Labels] | None = field(default=None, repr=False)

    @cached_property
    def normals(self) -> Floats:
        """The outward unit normal of each corner of each face, (m, 3, 3); that of the triangle where there is none."""
        return self.normals_of(np.arange(len(self.faces)))

    def normals_of(self, which: Integers) -> Floats:
        """The normals (k, 3, 3) of a few faces (k,), for which those of all others need not be computed."""
        if self.shading is None:
            return np.repeat(self._flat(which)[:, None], 3, axis=1)
        if callable(self.shading):
            given = self._outward(self.shading, np.repeat(which, 3), self.vertices[self.faces[which].ravel()])
            given = given.reshape(-1, 3, 3)
        else:
            given = self.shading[which]
        normals = _unit(given)
        missing: Flags = np.any(np.isnan(normals), axis=2)
        bare = np.flatnonzero(np.any(missing, axis=1))
        normals[bare] = np.where(missing[bare][:, :, None], self._flat(which[bare])[:, None], normals[bare])
        return normals

    @cached_property
    def labels(self) -> Labels:
        """Which parts faces belong to, as a point inside of each tells; -1 where leaves are not known."""
        if self.leaf is None:
            return labels_of(np.full(len(self.faces), -1), ())
        if callable(self.called):
            return self.called(self.vertices[self.faces].mean(axis=1), self.leaf)
        return labels_of(self.leaf, self.leaves) if self.called is None else self.called

    @property
    def part(self) -> Integers:
        """The part of each face, (m,): an index into `parts`; -1 where leaves are not known.

        A leaf may stand in several parts, as the plane of the lids of boxes of one height does; each face belongs to
        that which bounds the body there, to ``A / B`` where two do. Where two begin or end to do so no edge need run:
        a triangle over it is called by its middle, so that areas of parts are those of `measure` to a cell.
        """
        return self.labels.number

    @property
    def parts(self) -> tuple[str, ...]:
        """The names of the parts, in the order of the leaves, whether any face has them or not."""
        return self.labels.names

    @cached_property
    def features(self) -> tuple[Feature, ...]:
        """The curves along which the leaves meet, the edges of the body among them; none where leaves are not known."""
        if self.leaf is None:
            return ()
        return features_of(self.vertices, self.faces, self.leaf, self.part, self.parts, self.normals_of)

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

    @cached_property
    def _enclosed(self) -> EnclosedSolid:
        return enclosed(self.vertices, self.faces)

    @property
    def volume(self) -> float:
        """The volume that the triangles enclose, sum a x b . c/6 over them; negative if they face inwards.

        Raises RsymError for an open mesh, and names its open edges.
        """
        return self._enclosed.volume

    @cached_property
    def area(self) -> float:
        """The area of the triangles, of open meshes too."""
        return area_of(self.vertices, self.faces)

    @property
    def centroid(self) -> Floats:
        """The centroid of the enclosed volume, (3,); RsymError for a mesh that is open or encloses nothing."""
        self._require_volume()
        return self._enclosed.centroid.copy()

    @property
    def inertia(self) -> Floats:
        """The inertia of the enclosed volume about its centroid m, of density 1, (3, 3).

        I = integral of |p - m|^2 1 - (p - m)(p - m)' over the volume: moments of inertia on the diagonal, the negative
        products beside it. In units of length to the fifth; times the density it is that of the body.
        Raises RsymError for a mesh that is open or encloses nothing.
        """
        self._require_volume()
        return self._enclosed.inertia.copy()

    @cached_property
    def bounds(self) -> Bounds:
        """The box around the triangles, ((xmin, xmax), (ymin, ymax), (zmin, zmax)), as a shape takes it."""
        vertices, faces = checked(self.vertices, self.faces)
        used = vertices[np.unique(faces)]
        return tuple(zip(used.min(axis=0).tolist(), used.max(axis=0).tolist(), strict=True))

    def _require_volume(self) -> None:
        if not self.volume:
            raise RsymError(
                "a centroid needs a volume, the mesh has a volume of 0",
                code="no-volume",
                remedy="take a mesh of a body",
            )

    def scale(self, factor: Any) -> Mesh:
        """The mesh enlarged about the origin, by one factor or by one for each axis; a negative one mirrors.

        As `transform` of a diagonal matrix.

        Raises
        ------
        RsymError
            For factors that are not one or three finite numbers other than 0.

        Examples
        --------
        >>> import rsym
        >>> mesh = rsym.mesh(rsym.box(1, 2, 3), 12, bounds=((-1, 1), (-2, 2), (-2, 2)))
        >>> round(mesh.scale(10).volume, 6), round(mesh.scale([1, 1, 2]).volume, 6)
        (6000.0, 12.0)
        """
        factors = _numbers(factor)
        if factors is None or factors.shape not in ((), (3,)) or not factors.all():
            raise RsymError(
                f"expected a factor, or one for each axis, of finite numbers other than 0, got {reprlib.repr(factor)}",
                code="factor",
                remedy="for example scale(25.4) or scale([1, 1, 2])",
            )
        return self._moved(np.diag(np.broadcast_to(factors, 3)), np.zeros(3))

    def transform(self, matrix: Any) -> Mesh:
        """The mesh at the places A p + t.

        Normals become those of the image, A^-T n made unit vectors; where det A < 0 the triangles are turned round, so
        that the outside stays outside. Leaves, parts and findings come along, of the sides of the bounds those that are
        square to an axis still. Curvatures that a surface without an equation brings are kept by similarities, else
        given up. The mesh is then no longer one of its shape: to colour it by fields move the shape and mesh that.

        Parameters
        ----------
        matrix : (3, 3), (3, 4) or (4, 4) array
            A; or A and t beside it; or with (0, 0, 0, 1) below.

        Raises
        ------
        RsymError
            For another shape, numbers that are not finite, another last row, or a matrix that flattens.

        Examples
        --------
        >>> import rsym
        >>> mesh = rsym.mesh(rsym.box(1, 2, 3), 12, bounds=((-1, 1), (-2, 2), (-2, 2)))
        >>> moved = mesh.transform([[0, -1, 0, 5], [1, 0, 0, 0], [0, 0, 1, 0]])
        >>> moved.centroid.round(12).tolist()[0], round(moved.volume, 12)
        (5.0, 6.0)
        """
        given = _numbers(matrix)
        if given is not None and given.shape == (4, 4) and given[3].tolist() == [0, 0, 0, 1]:
            given = given[:3]
        if given is None or given.shape not in ((3, 3), (3, 4)) or np.linalg.matrix_rank(given[:, :3]) < 3:
            raise RsymError(
                "expected a matrix of finite numbers that does not flatten, (3, 3), (3, 4), or (4, 4) with the last row"
                f" (0, 0, 0, 1), got {reprlib.repr(matrix)}",
                code="matrix",
                remedy="for example [[1, 0, 0, 5], [0, 1, 0, 0], [0, 0, 1, 0]] to move by 5 along x",
            )
        return self._moved(given[:, :3], given[:, 3] if given.shape == (3, 4) else np.zeros(3))

    def _moved(self, matrix: Floats, shift: Floats) -> Mesh:
        back = np.linalg.inv(matrix)
        turned = slice(None, None, -1 if np.linalg.slogdet(matrix)[0] < 0 else 1)
        given, shading = self.shading, self.shading
        if callable(given):
            rule = given

            def outward(leaf: Integers, points: Floats) -> Floats:
                return rule(leaf, (points - shift) @ back.T) @ back

            shading = outward
        elif given is not None:
            shading = (given @ back)[:, turned]

        def found() -> Findings:
            sides = (_image(side, matrix, shift) for side in self.findings.sides)
            return self.findings.moved(
                lambda place: point(matrix @ place + shift), tuple(side for side in sides if side is not None)
            )

        return Mesh(
            self.vertices @ matrix.T + shift,
            self.faces[:, turned],
            shading,
            found,
            self.leaf,
            self.leaves,
            _bent(self.curvatures, matrix, turned),
            lambda points, leaf: self.labels,
        )

    def _outward(self, rule: Outward, which: Integers, points: Floats) -> Floats:
        """The rule at points (k, 3), each on one of the faces (k,)."""
        return rule(np.zeros(len(which), np.int16) if self.leaf is None else self.leaf[which], points)

    def _flat(self, which: Integers) -> Floats:
        """The normals of triangles; zero where they have none."""
        a, b, c = (self.vertices[self.faces[which, k]] for k in range(3))
        return np.nan_to_num(_unit(np.cross(b - a, c - a)))

    def __repr__(self) -> str:
        return f"Mesh({len(self.vertices)} vertices, {len(self.faces)} triangles)"

    def _repr_html_(self) -> str:
        return f"<div>{surface_picture(self.vertices, self.faces)}<br>{escape(repr(self)[5:-1])}</div>"

    def __reduce__(self) -> tuple[type[Mesh], tuple[Any, ...]]:
        """Pickle the normals themselves: the function they come from holds compiled code."""
        return Mesh, (self.vertices, self.faces, self.normals, self.findings, self.leaf, self.leaves, None, self.labels)


def _numbers(given: Any) -> Floats | None:
    """Finite real numbers as an array, or None."""
    try:
        numbers = np.asarray(given)
        numbers = numbers.astype(np.float64) if numbers.dtype.kind in "iufO" else np.array(np.nan)
    except (TypeError, ValueError):
        return None
    return numbers if np.isfinite(numbers).all() else None


def _image(side: BoundsSide, matrix: Floats, shift: Floats) -> BoundsSide | None:
    """A side of the bounds where it has moved to, if it is square to an axis still."""
    row = np.linalg.inv(matrix)[side.axis]  # its points q have row . (q - shift) = value
    (axes,) = np.nonzero(row)
    if len(axes) > 1:
        return None
    return BoundsSide(side.name, int(axes[0]), float(side.value / row[axes[0]] + shift[axes[0]]))


def _bent(curvatures: Callable[[str], Floats] | None, matrix: Floats, turned: slice) -> Callable[[str], Floats] | None:
    """The curvatures of the image under a similarity of a factor k: 1/k times the old ones, Gauss's 1/k^2."""
    size = float(np.exp(np.linalg.slogdet(matrix)[1] / 3))
    if curvatures is None or not np.allclose(matrix @ matrix.T, size**2 * np.eye(3), rtol=0, atol=1e-12 * size**2):
        return None
    return lambda name: curvatures(name)[:, turned] / (size**2 if name == "gaussian_curvature" else size)


def _unit(vectors: Floats) -> Floats:
    """Vectors (..., 3) of length 1; NaN for those without direction."""
    with np.errstate(all="ignore"):
        unit: Floats = vectors / np.sqrt(np.einsum("...i,...i->...", vectors, vectors))[..., None]
    return unit
