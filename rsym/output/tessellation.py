"""Patches as triangles to draw: exact at every vertex, with chosen parameter lines among the edges."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from rsym.arrays import Floats
from rsym.errors import RsymError
from rsym.sampling.mesh import Mesh
from rsym.surfaces import forms
from rsym.surfaces.meshes import grid_triangles
from rsym.surfaces.parameters import LetterValues
from rsym.surfaces.patch import Orders, Patch

# Triangles of a picture of two or three thousand points: smaller ones than a few pixels show nothing more.
CELLS = 32_000
LEAST = 12  # cells along a side of a patch, of however many
NOTHING = 1e-12  # of the size: a piece so short is rounding at a pole


class OnGrid:
    """A patch that has its derivatives on one grid of parameters at hand: they are computed together, by one kernel."""

    def __init__(self, patch: Patch, u: Floats, v: Floats, orders: Orders, letters: LetterValues) -> None:
        self.patch, self.u, self.v, self.letters = patch, u[:, None], v[None, :], letters
        self.domain = patch.domain
        found = patch.derivatives(self.u, self.v, orders, letters=letters)
        self._known = dict(zip(map(tuple, orders), found, strict=True))

    def derivatives(self, u: ArrayLike, v: ArrayLike, orders: Orders, *, letters: LetterValues = None) -> list[Floats]:
        """Several derivatives, anew where they are not at hand."""
        if u is self.u and v is self.v and all(tuple(order) in self._known for order in orders):
            return [self._known[tuple(order)] for order in orders]
        return self.patch.derivatives(u, v, orders, letters=letters)


@dataclass(frozen=True)
class Tessellation:
    """One patch over a grid: parameters u (r,) and v (s,), points (r, s, 3), normals (r, s, 3)."""

    name: str
    patch: Patch
    u: Floats
    v: Floats
    on_grid: OnGrid
    points: Floats
    normals: Floats

    def curvatures(self) -> tuple[Floats, Floats]:
        """The Gaussian and the mean curvature on the grid, (r, s)."""
        return forms.curvatures(self.on_grid, self.on_grid.u, self.on_grid.v, self.on_grid.letters)

    def lines(self, axis: int, parameters: Floats) -> Floats:
        """The pieces (n, 2, 3) of the lines u = const (axis 0) or v = const (axis 1) at parameters of the grid."""
        grid = (self.u, self.v)[axis]
        rows = np.moveaxis(self.points, axis, 0)[np.searchsorted(grid, parameters)]
        return pieces(rows)

    def edges(self) -> Floats:
        """The pieces (n, 2, 3) of the edges; none where the patch closes."""
        closed = self.patch.closed
        found = [self.lines(axis, (self.u, self.v)[axis][[0, -1]]) for axis in (0, 1) if not closed[axis]]
        return np.concatenate([np.zeros((0, 2, 3)), *found])


def tessellate(
    name: str,
    patch: Patch,
    cells: int,
    lines: Sequence[Floats],
    letters: LetterValues = None,
    *,
    curved: bool = False,
) -> Tessellation:
    """A patch over about so many cells along each direction, with the parameters of lines in u and v among them.

    `curved` says that curvatures will be asked for.
    """
    u, v = (_grid(interval, cells, chosen) for interval, chosen in zip(patch.domain, lines, strict=True))
    on_grid = OnGrid(patch, u, v, ((0, 0), *(forms.SECOND if curved else forms.SECOND[:2]), (1, 1)), letters)
    (points,) = on_grid.derivatives(on_grid.u, on_grid.v, ((0, 0),))
    if not np.isfinite(points).all():
        raise RsymError(f"patch {name} is not finite everywhere", code="patch", remedy="look at its curves and letters")
    return Tessellation(name, patch, u, v, on_grid, points, forms.normals(on_grid, on_grid.u, on_grid.v, letters))


def cells_of(count: int) -> int:
    """Cells along each direction of each of so many patches.

    Examples
    --------
    >>> cells_of(1), cells_of(8)
    (178, 63)
    """
    return max(int((CELLS / count) ** 0.5), LEAST)


def line_parameters(patch: Patch, lines: int | tuple[ArrayLike, ArrayLike]) -> list[Floats]:
    """The parameters of lines inside a patch: of so many intervals in each direction, or those given."""
    given = (lines, lines) if isinstance(lines, int) else lines
    found = []
    for (low, high), closed, chosen in zip(patch.domain, patch.closed, given, strict=True):
        if isinstance(chosen, int):
            values = np.linspace(low, high, max(chosen, 1) + 1)
            values = values[: 0 if chosen < 1 else -1] if closed else values[1:-1]
        else:
            values = np.unique(np.asarray(chosen, np.float64))
            if values.ndim != 1 or (values < low).any() or (values > high).any():
                raise RsymError(f"lines lie at parameters in [{low:g}, {high:g}], got {chosen!r}", code="domain")
        found.append(values)
    return found


def joined(parts: Sequence[Tessellation]) -> Mesh:
    """One mesh of all patches, side by side; each is a leaf of its name."""
    faces, first = [], 0
    for part in parts:
        rows, columns, _ = part.points.shape
        faces.append(grid_triangles(rows - 1, columns - 1) + first)
        first += rows * columns
    normals = np.concatenate([part.normals.reshape(-1, 3) for part in parts])
    leaf = np.repeat(np.arange(len(parts)), [len(one) for one in faces])
    corners = np.concatenate(faces)
    points = np.concatenate([part.points.reshape(-1, 3) for part in parts])
    return Mesh(points, corners, normals[corners], leaf=leaf, leaves=tuple(part.name for part in parts))


def pieces(lines: Floats) -> Floats:
    """The pieces (n, 2, 3) of polylines (..., k, 3); those of length 0, as at a pole, are left out.

    Examples
    --------
    >>> pieces(np.array([[0.0, 0, 0], [1, 0, 0], [1, 0, 0]])).tolist()
    [[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]]]
    """
    found = np.stack([lines[..., :-1, :], lines[..., 1:, :]], axis=-2).reshape(-1, 2, 3)
    lengths = np.abs(found[:, 1] - found[:, 0]).max(axis=1)
    return np.asarray(found[lengths > NOTHING * np.abs(found).max(initial=0.0)])


def _grid(interval: tuple[float, float], cells: int, chosen: Floats) -> Floats:
    """Parameters of an interval: its ends, those chosen, and enough between them, evenly from each to the next."""
    low, high = interval
    ends = np.unique(np.concatenate([[low], chosen, [high]]))
    counts = np.ceil(np.diff(ends) / (high - low) * cells - 1e-9).astype(np.int64).clip(1)
    spans = [np.linspace(a, b, count, endpoint=False) for a, b, count in zip(ends[:-1], ends[1:], counts, strict=True)]
    return np.concatenate([*spans, [high]])
