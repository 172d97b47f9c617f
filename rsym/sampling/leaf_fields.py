"""Fields of the leaves of a shape: what calculus says of a surface on one side of its edges.

Beside an edge the derivatives of omega are those of an R-function beside its corner, and a rounding error away from it
as large as one likes; those of the leaf that a triangle lies on are ordinary numbers up to the edge and on it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from rsym.arrays import Flags, Floats, Integers
from rsym.backends.kernel import Kernel, compile_program
from rsym.errors import RsymError
from rsym.logic.leaf_names import leaf_names
from rsym.logic.sign_form import SignForm, has_kinks, shape_form
from rsym.model.requirements import require_shape
from rsym.model.shape import Shape
from rsym.program.calculus import Calculus
from rsym.program.differentiation import derivative
from rsym.program.fields import outputs_of
from rsym.sampling.active_leaves import active_leaf, ends_last
from rsym.sampling.mesh import Mesh

BY_LETTER = "by_letter"  # the derivative by a letter, beside the fields
NEWTON_STEPS = 3
SIDES = 6  # of the bounds, behind the leaves of a shape
# A mesh with more vertices than this share farther from a shape than a triangle is long is one of another shape, or was
# moved; so many of them are looked at.
FOREIGN, LOOKED_AT = 0.5, 1000
# The cosine of ten degrees: leaves whose normals differ by less go on as each other, as features do that are not drawn.
GOES_ON = np.cos(np.radians(10.0))


@dataclass(frozen=True)
class LeafFields:
    """Value, gradient and other fields of the leaves of a shape in space, each compiled when it is asked for.

    With a letter the derivative by it is a field too, ``by_letter``.
    """

    shape: Shape
    fields: Sequence[str] = ()
    letters: Mapping[Any, float] | None = None
    letter: str | None = None
    _kernels: dict[int, Kernel] = field(default_factory=dict, repr=False)

    def __post_init__(self) -> None:
        require_shape(self.shape)
        if self.shape.dimension != 3:
            raise RsymError(
                "a surface needs a shape in space, got one in the plane",
                code="dimension",
                remedy="use revolve(shape) first",
            )

    @cached_property
    def form(self) -> SignForm:
        """The leaves and what joins them."""
        return shape_form(self.shape)

    @cached_property
    def names(self) -> tuple[str, ...]:
        """The fields that are computed."""
        return tuple(dict.fromkeys(("value", "gradient", *self.fields)))

    @cached_property
    def kinked(self) -> Flags:
        """Which leaves may have kinks, the sides of the bounds last."""
        return np.array([*(has_kinks(self.form.builder, leaf) for leaf in self.form.leaves), *[False] * SIDES])

    @cached_property
    def leaves(self) -> tuple[str, ...]:
        """What the leaves are called."""
        return leaf_names(self.form, self.shape)

    def of_corners(self, mesh: Mesh) -> Integers:
        """The leaf of each face corner, (m, 3)."""
        if self._tells(mesh):
            return np.repeat(np.asarray(mesh.leaf, np.int64)[:, None], 3, axis=1)
        return self.active(mesh.vertices)[mesh.faces]

    def on_faces(self, mesh: Mesh) -> Callable[[Integers, Floats], dict[str, Floats]]:
        """The fields inside faces (n,), by the weights of their corners (n, 3), on the surface.

        A face is on its leaf up to an edge. Where leaves go on as each other, triangles end beside the seam, and the
        leaf is the one that is active.
        """
        reach, tells = longest_side(mesh), self._tells(mesh)
        some = np.arange(0, len(mesh.faces), 1 + len(mesh.faces) // LOOKED_AT)
        refuse_foreign(self.at(self.of_corners(mesh)[some, 0], mesh.vertices[mesh.faces[some, 0]]), reach)
        seam = _on_seams(mesh) if tells else np.zeros(len(mesh.faces), bool)

        def found(faces: Integers, weights: Floats) -> dict[str, Floats]:
            points = np.einsum("ij,ijk->ik", weights, mesh.vertices[mesh.faces[faces]])
            leaf = np.asarray(mesh.leaf, np.int64)[faces] if tells else self.active(points)
            result = self.at(leaf, points, reach)
            (near,) = np.nonzero(seam[faces] & (leaf < len(self.form.leaves)))
            other = self.active(result["point"][near])
            near, other = near[other != leaf[near]], other[other != leaf[near]]
            if near.size:
                beyond = self.at(other, points[near], reach)
                goes_on = _cosine(result["gradient"][near], beyond["gradient"]) > GOES_ON
                for name, values in beyond.items():
                    result[name][near[goes_on]] = values[goes_on]
            return result

        return found

    def _tells(self, mesh: Mesh) -> bool:
        """Whether the faces of a mesh know their leaves of this shape, and not those of another one."""
        return mesh.leaf is not None and mesh.leaves in (self.leaves, (*self.leaves, *mesh.leaves[-SIDES:]))

    def active(self, points: Floats) -> Integers:
        """The leaf that gives omega its sign at points (n, 3)."""
        return active_leaf(self.form.gates, self.values(points))[1]

    def bounding(self, points: Floats) -> Integers:
        """The same on the boundary: an end of a domain only where no other leaf is zero."""
        if not self.form.walls:
            return self.active(points)
        walls = np.array(sorted(self.form.walls), np.int64)
        values = np.array(np.broadcast_arrays(*self.values(points)))
        slopes = np.array([self.at(np.full(len(points), wall), points)["gradient"] for wall in walls])
        return active_leaf(self.form.gates, ends_last(values, walls, slopes, points))[1]

    def values(self, points: Floats) -> list[Floats]:
        """The values of the leaves at points (n, 3)."""
        found = self._values(*points.T, letters=self.letters)
        return [found[name] for name in self._values.fields]

    def at(self, leaf: Integers, points: Floats, reach: float = 0.0) -> dict[str, Floats]:
        """The fields of leaf[k] at point k of (n, 3), after Newton steps of no more than `reach` together.

        ``point`` says where. Each step doubles the power of the triangle's size by which a point of it is off, the
        square at first: what is constant on a surface is so to rounding on coarse meshes too.
        """
        result: dict[str, Floats] = {}
        for number in np.unique(leaf).tolist():
            at = np.flatnonzero(leaf == number)
            for name, values in self._on(number, points[at], reach).items():
                result.setdefault(name, np.empty((len(points), *values.shape[1:])))[at] = values
        return result

    def _on(self, number: int, points: Floats, reach: float) -> dict[str, Floats]:
        kernel, start = self._kernel(number), points
        found = kernel(*points.T, letters=self.letters)
        for _ in range(NEWTON_STEPS if reach > 0 and number < len(self.form.leaves) else 0):
            moved = points - _step(found)
            with np.errstate(all="ignore"):
                short = np.einsum("ij,ij->i", moved - start, moved - start) <= reach**2
            points = np.where(short[:, None], moved, points)
            found = kernel(*points.T, letters=self.letters)
        return found | {"point": points}

    def _kernel(self, number: int) -> Kernel:
        if number not in self._kernels:
            b, node = self.form.builder, self._node(number)
            calculus = Calculus(b, node)
            outputs = {name: part for field in self.names for name, part in outputs_of(calculus, field).items()}
            if self.letter is not None:
                outputs[BY_LETTER] = derivative(b, node, self.letter)
            names = (*self.names, *(() if self.letter is None else (BY_LETTER,)))
            self._kernels[number] = compile_program(b.program(outputs), names, self.shape)
        return self._kernels[number]

    def _node(self, number: int) -> int:
        """The node of a leaf; behind the leaves of the shape are the sides of the bounds, up to a constant."""
        b, side = self.form.builder, number - len(self.form.leaves)
        if side < 0:
            return self.form.leaves[number]
        along = b.input(b.coordinates[side // 2])
        return along if side % 2 == 0 else b.neg(along)

    @cached_property
    def _values(self) -> Kernel:
        outputs = {f"leaf {k}": leaf for k, leaf in enumerate(self.form.leaves)}
        return compile_program(self.form.builder.program(outputs), tuple(outputs), self.shape)


def _step(found: Mapping[str, Floats]) -> Floats:
    """How far Newton's method says that points are from the zero of their leaf, along its gradient."""
    with np.errstate(all="ignore"):
        squared = np.einsum("ij,ij->i", found["gradient"], found["gradient"])
        step: Floats = (found["value"] / squared)[:, None] * found["gradient"]
    return step


def distances(found: Mapping[str, Floats]) -> Floats:
    """How far points are from their leaf, to first order."""
    step = _step(found)
    return np.asarray(np.sqrt(np.einsum("ij,ij->i", step, step)))


def refuse_foreign(found: Mapping[str, Floats], reach: float) -> None:
    """Refuse the fields at vertices of a mesh if most of them are farther from their leaf than `reach`."""
    with np.errstate(invalid="ignore"):
        foreign = float(np.mean(distances(found) > reach))
    if foreign > FOREIGN:
        raise RsymError(
            f"the mesh is not one of this shape: {foreign:.0%} of its vertices are far from it",
            code="mesh",
            remedy="mesh the shape with these letters; of a mesh that was moved move the shape too",
        )


def longest_side(mesh: Mesh) -> float:
    """The longest side of a triangle: what is farther from the surface is not of it."""
    corners = mesh.vertices[mesh.faces]
    sides = corners - np.roll(corners, 1, axis=1)
    return float(np.sqrt(np.einsum("ijk,ijk->ij", sides, sides).max()))


def _on_seams(mesh: Mesh) -> Flags:
    """Which faces have a vertex where two leaves meet that go on as each other."""
    vertex, leaf = mesh.faces.ravel(), np.repeat(np.asarray(mesh.leaf), 3)
    order = np.lexsort((leaf, vertex))
    following = np.flatnonzero((vertex[order][1:] == vertex[order][:-1]) & (leaf[order][1:] != leaf[order][:-1]))
    one, other = order[following], order[following + 1]
    normals = np.zeros((len(vertex), 3))
    faces = np.unique(np.concatenate([one, other]) // 3)
    normals.reshape(-1, 3, 3)[faces] = mesh.normals_of(faces)
    seams = vertex[one[_cosine(normals[one], normals[other]) > GOES_ON]]
    return np.asarray(np.isin(mesh.faces, seams).any(axis=1))


def _cosine(u: Floats, v: Floats) -> Floats:
    """The cosine of the angles between vectors (n, 3)."""
    with np.errstate(all="ignore"):
        sizes = np.sqrt(np.einsum("ij,ij->i", u, u) * np.einsum("ij,ij->i", v, v))
        cosine: Floats = np.einsum("ij,ij->i", u, v) / sizes
    return cosine
