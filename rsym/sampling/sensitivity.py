"""Sensitivity: how the boundary moves, and volume or area change, when one letter moves.

A point that stays on the zero set of f while a letter p grows moves along the outer normal at the speed

    V = (df/dp)/|grad f|

f being omega, or the leaf of the sign form that the point lies on: beside an edge and on it each side has its own. By
Reynolds' transport theorem the volume inside grows at the rate dW/dp = integral of V over the boundary, sides of the
bounds standing still. In space that is a rule of degree 4 on each triangle, each of its points p moved to the nearest
one of the leaf: a piece of a triangle inclined by t, at the distance d outside, stands for cos t/(1 + 2 H d) of its
area there, but for d**2. In the plane the boundary is a graph over each chord, m across it: V ds = (df/dp)/|grad f . m|
dx.

Source: J. Sokolowski, J.-P. Zolesio (1992), Introduction to shape optimization, 2.31; D. A. Dunavant (1985), High
degree efficient symmetrical Gaussian quadrature rules for the triangle, table II.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from rsym.analysis.differential import boundary_speed
from rsym.arrays import Floats, Ints
from rsym.backends.kernel import Kernel, compile_program
from rsym.errors import RsymError, warn
from rsym.logic.sign_form import shape_form
from rsym.model.requirements import require_count, require_shape
from rsym.model.shape import Bounds, Shape
from rsym.model.wording import listing, proposal
from rsym.program.by_letters import refuse_parameter
from rsym.program.differentiation import derivative
from rsym.reports.document import Document, Sentence
from rsym.reports.numbers import number, short
from rsym.reports.render import Report
from rsym.sampling.boundaries import BEND, NODES, WEIGHTS
from rsym.sampling.leaf_fields import BY_LETTER, LeafFields
from rsym.sampling.level_lines import level_lines
from rsym.sampling.mesh import Mesh
from rsym.sampling.meshing import mesh
from rsym.sampling.plane_leaves import NEWTON_STEPS, PlaneLeaves, leaves_of
from rsym.sampling.windows import bounds_or_extent

RESOLUTION = {2: 256, 3: 64}
# Six points of a triangle and their shares, exact to degree 4.
INNER, OUTER = 0.445948490915965, 0.091576213509771
TRIANGLE = np.array([np.roll((1 - 2 * one, one, one), k) for one in (INNER, OUTER) for k in range(3)])
SHARES = np.repeat([0.223381589678011, 0.109951743655322], 3)
UNKNOWN = 1e-6  # of the boundary: a speed that is undefined on less is no matter
HALVINGS = 6  # a quarter of a circle becomes chords of 1.4 degrees
STRETCH = (0.5, 2.0)  # what of a curved piece over its triangle is believed: beyond, the mesh does not resolve it


@dataclass(frozen=True, eq=False, repr=False)
class Sensitivity(Report):
    """How the boundary moves outwards, in units of length to one of the letter, when the letter grows.

    Nothing is meshed or traced before it is asked for.

    Attributes
    ----------
    shape : Shape
    letter : str
    letters : {name: value}
        Of all letters, at which the speed is taken.
    resolution : int
        Of the mesh, or of the lattice in the plane.
    bounds : pairs
        Within which the boundary is taken.

    Examples
    --------
    >>> import rsym, sympy as sp
    >>> r = sp.Symbol("r", real=True)
    >>> found = rsym.sensitivity(rsym.disc(r, letters={r: 2}), r)
    >>> found.expression
    (1 - (r**2/2 - x**2/2 - y**2/2)/r**2)/sqrt(x**2/r**2 + y**2/r**2)
    >>> found.at([[2, 0], [0, -2]]).round(12).tolist(), round(found.area_derivative / np.pi, 9)
    ([1.0, 1.0], 4.0)
    """

    shape: Shape
    letter: str
    letters: Mapping[str, float]
    resolution: int
    bounds: Bounds

    @cached_property
    def expression(self) -> Any:
        """(d omega/d letter)/|grad omega|, R-nodes kept: on the boundary the speed, off it that of the level sets."""
        return boundary_speed(self.shape, self.letter)

    def at(self, points: Any) -> Floats:
        """The speed at points (n, dim) of the boundary: that of the leaf that bounds the body there."""
        given = np.asarray(points, np.float64)
        if given.ndim != 2 or given.shape[1] != self.shape.dimension:
            raise RsymError(
                f"expected points (n, {self.shape.dimension}), got the shape {given.shape}",
                code="points",
                remedy="a row for each point",
            )
        if self.shape.dimension == 2:
            _, gradient, active = self._leaves.of_active(given)
            return self._of_leaves(given, active, gradient)
        fields = self._fields
        return _speed(fields.at(fields.active(given), given))

    @cached_property
    def mesh(self) -> Mesh:
        """The surface; RsymError for a shape in the plane."""
        self._require(3, "a mesh", "lines")
        return mesh(self.shape, self.resolution, bounds=self.bounds, letters=self.letters)

    @cached_property
    def lines(self) -> tuple[Floats, ...]:
        """The boundary in the plane as lines (k, 2), the inside to their left.

        Raises RsymError for a shape in space.
        """
        self._require(2, "lines", "mesh")
        return tuple(level_lines(self.shape, resolution=self.resolution, bounds=self.bounds, letters=self.letters))

    @cached_property
    def values(self) -> Floats | tuple[Floats, ...]:
        """The speed at the corners of the faces of `mesh`, (m, 3), each that of the leaf of its face.

        In the plane for each line the speed at both ends of each chord, (k - 1, 2). Sides of the bounds stand still.
        """
        if self.shape.dimension == 2:
            return tuple(self._at_ends(line) for line in self.lines)
        corners = self.mesh.faces.ravel()
        leaf = self._fields.of_corners(self.mesh).ravel()
        count = len(self.mesh.vertices)
        keys, place = np.unique(leaf * count + corners, return_inverse=True)
        found = _speed(self._fields.at(keys // count, self.mesh.vertices[keys % count]))
        return np.asarray(found[place].reshape(-1, 3))

    @cached_property
    def volume_derivative(self) -> float:
        """How fast the volume grows within the bounds: the integral of the speed over the surface."""
        self._require(3, "a volume", "area_derivative")
        faces = np.repeat(np.arange(len(self.mesh.faces)), len(SHARES))
        weights = np.tile(TRIANGLE, (len(self.mesh.faces), 1))
        found = self._fields.on_faces(self.mesh)(faces, weights)
        a, b, c = (self.mesh.vertices[self.mesh.faces[:, k]] for k in range(3))
        flat = np.repeat(np.cross(b - a, c - a) / 2, len(SHARES), axis=0)
        areas = np.linalg.norm(flat, axis=1)
        with np.errstate(all="ignore"):
            normals = -found["gradient"] / np.linalg.norm(found["gradient"], axis=1)[:, None]
            start = np.einsum("ij,ijk->ik", weights, self.mesh.vertices[self.mesh.faces[faces]])
            off = np.einsum("ij,ij->i", start - found["point"], normals)
            stretch = (1 + 2 * found["mean_curvature"] * off) / np.einsum("ij,ij->i", normals, flat / areas[:, None])
        stretch = np.where((stretch > STRETCH[0]) & (stretch < STRETCH[1]), stretch, 1.0)
        return _summed(_speed(found), np.tile(SHARES, len(self.mesh.faces)) * areas / stretch)

    @cached_property
    def area_derivative(self) -> float:
        """How fast the area in the plane grows within the bounds: the integral of the speed along the boundary."""
        self._require(2, "an area in the plane", "volume_derivative")
        lines = [np.empty((0, 2)), *self.lines]
        start, end = (np.concatenate([line[part] for line in lines]) for part in (slice(None, -1), slice(1, None)))
        length = np.hypot(*(end - start).T)
        start, end = start[length > 0], end[length > 0]
        leaf = self._leaves.active((start + end) / 2)[1]
        start, end, leaf = self._straightened(start, end, leaf)
        total = 0.0
        for node, share in zip(NODES, WEIGHTS, strict=True):
            points = self._over(start, end, node, leaf)
            ((_, gradient),) = self._leaves.of(points, leaf)
            across, length = _across(start, end)
            with np.errstate(all="ignore"):
                outwards = np.abs(np.einsum("ij,ij->i", gradient, across))
                slope = np.linalg.norm(gradient, axis=1)
                total += _summed(self._of_leaves(points, leaf, gradient) * slope / outwards, share * length)
        return total

    def _over(self, start: Floats, end: Floats, node: float, leaf: Ints) -> Floats:
        """The points of the leaf over a share of each chord."""
        across, length = _across(start, end)
        points = start + node * (end - start)
        for _ in range(NEWTON_STEPS):
            ((value, gradient),) = self._leaves.of(points, leaf)
            with np.errstate(all="ignore"):
                step = value / np.einsum("ij,ij->i", gradient, across)
            points = points - np.where(np.abs(step) <= length, step, 0.0)[:, None] * across
        return points

    def _straightened(self, start: Floats, end: Floats, leaf: Ints) -> tuple[Floats, Floats, Ints]:
        """Chords halved until their leaves hardly turn over them, those of small holes above all."""
        for _ in range(HALVINGS):
            ((_, before),), ((_, after),) = (self._leaves.of(points, leaf) for points in (start, end))
            bent = np.abs(np.angle((before @ [1, 1j]) * (after @ [1, -1j]))) > BEND
            if not bent.any():
                break
            middle = self._over(start[bent], end[bent], 0.5, leaf[bent])
            start, rest = np.concatenate([start, middle]), end[bent]
            end = np.concatenate([end, rest])
            end[: -len(rest)][bent] = middle
            leaf = np.concatenate([leaf, leaf[bent]])
        return start, end, leaf

    def document(self) -> Document:
        """What a unit of the letter does."""
        space = self.shape.dimension == 3
        rate = self.volume_derivative if space else self.area_derivative
        values = np.concatenate([np.zeros(0), *(one.ravel() for one in self.values)])
        values = values[np.isfinite(values)]
        low, high = (float(values.min()), float(values.max())) if len(values) else (np.nan, np.nan)
        size = max(abs(low), abs(high))
        told = f"between {short(low, size)} and {short(high, size)}"
        return Document(
            "sensitivity",
            Sentence(
                f"When {self.letter} grows from {number(self.letters[self.letter])}, the boundary moves outwards by "
                f"{told} to a unit of it, and the {'volume' if space else 'area'} grows by {short(rate)}.",
                False,
            ),
            data={
                "letter": self.letter,
                "letters": dict(self.letters),
                "least": low,
                "greatest": high,
                "volume_derivative" if space else "area_derivative": rate,
                "resolution": self.resolution,
            },
        )

    def __repr__(self) -> str:
        return f"<Sensitivity to {self.letter} = {number(self.letters[self.letter])}>"

    def _require(self, dimension: int, what: str, other: str) -> None:
        if self.shape.dimension != dimension:
            where = ["in the plane", "in space"][self.shape.dimension - 2]
            raise RsymError(f"no {what.split(' ', 1)[-1]} of a shape {where}", code="dimension", remedy=f"ask .{other}")

    @cached_property
    def _fields(self) -> LeafFields:
        return LeafFields(self.shape, ("mean_curvature",), self.letters, self.letter)

    @cached_property
    def _leaves(self) -> PlaneLeaves:
        return leaves_of(self.shape, (0, 1), {}, self.letters, self.bounds)

    @cached_property
    def _by_letter(self) -> Kernel:
        """The derivatives of all leaves by the letter, in the plane."""
        form = shape_form(self.shape)
        outputs = {f"leaf {k}": derivative(form.builder, leaf, self.letter) for k, leaf in enumerate(form.leaves)}
        return compile_program(form.builder.program(outputs), tuple(outputs), self.shape)

    def _of_leaves(self, points: Floats, leaf: Ints, gradient: Floats) -> Floats:
        """The speed of a leaf at each point (n, 2), with its gradient (n, 2) there."""
        found = self._by_letter(*points.T, letters=self.letters)
        rows, at = np.stack([found[name] for name in self._by_letter.fields]), np.arange(len(points))
        return _speed({BY_LETTER: rows[leaf, at], "gradient": gradient})

    def _at_ends(self, line: Floats) -> Floats:
        """The speed at both ends of each chord of a line, that of the leaf at the middle of the chord."""
        leaf = self._leaves.active((line[1:] + line[:-1]) / 2)[1]
        ends = []
        for points in (line[:-1], line[1:]):
            ((_, gradient),) = self._leaves.of(points, leaf)
            ends.append(self._of_leaves(points, leaf, gradient))
        return np.stack(ends, axis=1)


def _across(start: Floats, end: Floats) -> tuple[Floats, Floats]:
    """Unit vectors across chords, and their lengths."""
    along = end - start
    length = np.hypot(*along.T)
    return np.stack([along[:, 1], -along[:, 0]], axis=1) / length[:, None], length


def sensitivity(
    shape: Shape,
    letter: Any,
    *,
    letters: Mapping[Any, float] | None = None,
    bounds: Any = None,
    resolution: int | None = None,
) -> Sensitivity:
    """How fast the boundary moves when a letter moves, as a formula, a field on the boundary, and a rate of volume.

    The speed along the outer normal is V = (d omega/d letter)/|grad omega|: positive where the body grows.

    Parameters
    ----------
    shape : Shape
        In the plane or in space.
    letter : name or symbol
        One of its letters.
    letters, bounds
        Override those of the shape; what lies outside of the bounds does not count.
    resolution : int, optional
        Of the mesh, by default 64, or of the lattice in the plane, 256.

    Returns
    -------
    Sensitivity
        ``.expression``, ``.at(points)``, ``.values`` on ``.mesh`` or ``.lines``, ``.volume_derivative`` or
        ``.area_derivative``; `plot_sensitivity` draws it.

    Raises
    ------
    RsymError
        For an unknown letter, one that is a parameter of an operation, and a shape that goes on without end and has no
        bounds.

    Examples
    --------
    >>> import rsym, sympy as sp
    >>> r = sp.Symbol("r", real=True)
    >>> found = rsym.sensitivity(rsym.sphere(r, letters={r: 2}), "r", resolution=32)
    >>> bool(abs(found.values - 1).max() < 1e-12), round(found.volume_derivative / np.pi, 3)
    (True, 16.0)
    """
    require_shape(shape)
    name = str(letter)
    if name not in shape.letters:
        known = listing(shape.letters)
        raise RsymError(
            f"no letter {name!r}; the letters are: {known}",
            code="unknown-letter",
            remedy=proposal(name, shape.letters, f"choose from: {known}"),
        )
    if resolution is not None:
        require_count("resolution", resolution, "for example 64")
    form = shape_form(shape)
    for leaf in form.leaves:
        refuse_parameter(form.builder, leaf, name)
    chosen = shape.letters.values_with(letters)
    box = bounds_or_extent(shape, bounds, chosen)
    return Sensitivity(shape, name, chosen, resolution or RESOLUTION[shape.dimension], box)


def _speed(found: Mapping[str, Floats]) -> Floats:
    with np.errstate(all="ignore"):
        speed: Floats = found[BY_LETTER] / np.linalg.norm(found["gradient"], axis=-1)
    return speed


def _summed(speed: Floats, sizes: Floats) -> float:
    """The sum of what is known; at tips and kinks of leaves nothing is."""
    known = np.isfinite(speed)
    missing = float(sizes[~known].sum())
    if missing > UNKNOWN * float(sizes.sum()):
        warn(
            f"the speed is undefined on {missing / sizes.sum():.2g} of the boundary, which was left out of the integral"
        )
    return float(speed[known] @ sizes[known])
