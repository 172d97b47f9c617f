"""Patches as triangle meshes, with their exact normals."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from rsym.arrays import Floats, Ints
from rsym.errors import RsymError
from rsym.sampling.mesh import Mesh
from rsym.surfaces.parameters import LetterValues
from rsym.surfaces.patch import Patch, own_letters, patches_of

# Points of neighbouring patches this share of the whole apart are one vertex: far below a cell, far above rounding,
# unless the whole is far from the origin: coordinates of different formulas differ by some roundings of their size.
WELDING, ROUNDING = 1e-9, 16 * np.finfo(float).eps


def mesh_patches(
    patches: Patch | Sequence[Patch], resolution: int | tuple[int, int] = 64, *, letters: LetterValues = None
) -> Mesh:
    """One mesh of one or several patches, welded along the edges that they share.

    Parameters
    ----------
    patches : Patch or sequence of Patch
        What to mesh; triangles turn as p_u x p_v does.
    resolution : int or (int, int)
        Cells along u and v of each patch; one number for both.
    letters : mapping, optional
        Values of letters by name, for the patches that have them.

    Returns
    -------
    Mesh
        With exact unit normals, and on demand curvatures, at every corner of every triangle; a pole is one vertex, a
        closed direction closes.
        ``mesh.leaf`` numbers the patches.

    Raises
    ------
    RsymError
        For a resolution below 1, or a point that is not finite.

    Examples
    --------
    >>> import sympy as sp
    >>> from rsym.surfaces.parametric import ParametricSurface
    >>> from rsym.surfaces.symbols import u, v
    >>> ring = (sp.cos(u) * (2 + sp.cos(v)), sp.sin(u) * (2 + sp.cos(v)), sp.sin(v))
    >>> torus = ParametricSurface(ring, ((0, 2 * sp.pi), (0, 2 * sp.pi)), closed=(True, True))
    >>> mesh = mesh_patches(torus, (32, 16))
    >>> mesh.status.closed, mesh.status.euler_characteristic, len(mesh.vertices)
    (True, 0, 512)
    """
    given = patches_of(() if patches is None else patches)
    if not given:
        raise RsymError("expected patches, got none", code="patch", remedy="give a patch or a list of patches")
    cells = _cells(resolution)
    values = own_letters(given, letters)
    points, normals = [], []
    for number, (patch, own) in enumerate(zip(given, values, strict=True)):
        u, v = _places(patch, cells)
        at, across = patch(u, v, letters=own), patch.normal(u, v, letters=own)
        if not np.isfinite(at).all():
            raise RsymError(f"patch {number} is not finite everywhere", code="patch", remedy="look at its curves")
        points.append(at.reshape(-1, 3))
        normals.append(across.reshape(-1, 3))
    corners = grid_triangles(*cells)
    step = (cells[0] + 1) * (cells[1] + 1)
    faces = np.concatenate([corners + step * number for number in range(len(given))])
    leaf = np.repeat(np.arange(len(given)), len(corners))
    vertices, names = _welded(np.concatenate(points))
    welded = names[faces]
    kept = (welded != np.roll(welded, 1, axis=1)).all(axis=1)
    shading = np.concatenate(normals)[faces[kept]]
    leaves = tuple(f"patch {number}" for number in range(len(given)))

    def curvatures(name: str) -> Floats:
        found = [_curvature(patch, name, cells, own) for patch, own in zip(given, values, strict=True)]
        return np.asarray(np.concatenate(found)[faces[kept]])

    return Mesh(vertices, welded[kept], shading, leaf=leaf[kept], leaves=leaves, curvatures=curvatures)


def _cells(resolution: Any) -> tuple[int, int]:
    given = tuple(resolution) if isinstance(resolution, tuple | list) else (resolution, resolution)
    if len(given) != 2 or any(isinstance(n, bool) or not isinstance(n, int | np.integer) or n < 1 for n in given):
        raise RsymError(
            f"a resolution is a number of cells, or one for u and one for v, got {resolution!r}",
            code="resolution",
            remedy="resolution=64 or resolution=(64, 32)",
        )
    return int(given[0]), int(given[1])


def _places(patch: Patch, cells: tuple[int, int]) -> tuple[Floats, Floats]:
    """The parameters of a patch's grid, as they broadcast."""
    u, v = (np.linspace(*interval, count + 1) for interval, count in zip(patch.domain, cells, strict=True))
    return u[:, None], v[None, :]


def _curvature(patch: Patch, name: str, cells: tuple[int, int], letters: LetterValues) -> Floats:
    """The curvature of this name at the points of the grid of a patch, row by row."""
    u, v = _places(patch, cells)
    values: Floats = getattr(patch, name)(u, v, letters=letters)
    return values.reshape(u.size * v.size, *values.shape[2:])


def grid_triangles(rows: int, columns: int) -> Ints:
    """Two triangles for each cell of a grid, (2 rows columns, 3), turning from u to v."""
    i, j = (one.ravel() for one in np.meshgrid(np.arange(rows), np.arange(columns), indexing="ij"))
    first = i * (columns + 1) + j
    beside = first + columns + 1
    halves = np.stack([first, beside, beside + 1, first, beside + 1, first + 1], axis=-1)
    return halves.reshape(-1, 3)


def _welded(points: Floats) -> tuple[Floats, Ints]:
    """Vertices without repetition, and which of them each point is."""
    size = float(np.ptp(points, axis=0).max())
    room = max(WELDING * size, ROUNDING * float(np.abs(points).max()))
    pairs = cKDTree(points).query_pairs(room, output_type="ndarray")
    links = coo_array((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(len(points),) * 2)
    _, labels = connected_components(links, directed=False)
    _, first, names = np.unique(labels, return_index=True, return_inverse=True)
    # Vertices keep the order of their first points.
    order = np.argsort(first)
    rank = np.empty(len(order), np.int64)
    rank[order] = np.arange(len(order))
    return points[first[order]], rank[names]
