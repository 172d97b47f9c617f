"""Meshes and fields as other packages hold them: trimesh, pyvista and meshio, the last two where they are installed.

Each gets the vertices as they are, shared across edges, so that closed stays closed, and the part of each face. Exact
normals belong to face corners, for which none of these packages has a place. A field goes on a mesh of the inside.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from rsym.arrays import Floats
from rsym.errors import RsymError
from rsym.model.requirements import optional_package, require_kind
from rsym.output.field_data import FIELDS, Field, field_mesh
from rsym.sampling.fillings import Filling
from rsym.sampling.mesh import Mesh

Resolution: TypeAlias = int | Sequence[int] | None


def to_trimesh(mesh: Mesh) -> Any:
    """The mesh as a ``trimesh.Trimesh``: vertices, faces, and what is known of parts.

    ``face_attributes["part"]`` is the number of the part of each face, (m,), and ``metadata["parts"]`` the names.

    Raises
    ------
    RsymError
        For what is no mesh.

    Examples
    --------
    >>> import rsym
    >>> bored = rsym.sphere(1).named("ball") - rsym.cylinder(0.4).named("bore")
    >>> body = rsym.to_trimesh(rsym.mesh(bored, 16, bounds=((-1.2, 1.2),) * 3))
    >>> body.is_watertight, body.metadata["parts"], body.face_attributes["part"].shape == body.faces.shape[:1]
    (True, ('ball', 'bore'), True)
    """
    require_kind(Mesh, mesh, "mesh")
    trimesh = optional_package("trimesh", "to_trimesh")
    names, part = _parts(mesh)
    known = {} if part is None else {"face_attributes": {"part": part}, "metadata": {"parts": names}}
    return trimesh.Trimesh(mesh.vertices.copy(), mesh.faces.astype(np.int64), process=False, **known)


def to_pyvista(mesh: Mesh | Field, *, resolution: Resolution = None) -> Any:
    """The mesh as a ``pyvista.PolyData``: ``cell_data["part"]`` numbers the names in ``field_data["parts"]``.

    What `solve`, `modes`, `torsion` or `elasticity` answered becomes a ``pyvista.UnstructuredGrid`` of the cells and
    with the data that `to_meshio` tells.

    Raises
    ------
    RsymError
        For what is neither, or where the package pyvista is missing.

    Examples
    --------
    >>> import rsym
    >>> mesh = rsym.mesh(rsym.sphere(1), 16)
    >>> rsym.to_pyvista(mesh).plot(scalars="part")  # doctest: +SKIP
    """
    if isinstance(mesh, FIELDS):
        pyvista = optional_package("pyvista", "to_pyvista")
        made, data = field_mesh(mesh, resolution)
        kind = getattr(pyvista.CellType, _kind(made).upper())
        grid = pyvista.UnstructuredGrid({kind: made.cells}, _in_space(made.points))
        grid.point_data.update(data)
        return grid
    _require_mesh(mesh, resolution)
    pyvista = optional_package("pyvista", "to_pyvista")
    names, part = _parts(mesh)
    surface = pyvista.PolyData(mesh.vertices.copy(), np.insert(mesh.faces, 0, 3, axis=1).astype(np.int64).ravel())
    if part is not None:
        surface.cell_data["part"] = part
        surface.field_data["parts"] = np.array(names)
    return surface


def to_meshio(mesh: Mesh | Field, *, resolution: Resolution = None) -> Any:
    """The mesh as a ``meshio.Mesh`` of triangles: ``cell_data["part"]`` numbers the parts.

    ``field_data`` has for the name of part k ``[k + 1, 2]``, as Gmsh counts surfaces: a number and the dimension.

    What `solve`, `modes`, `torsion` or `elasticity` answered goes on the inside of its shape: in the plane triangles up
    to the outline, whose corners are exact, about an axis those of half the section; in space tetrahedra up to the
    surface, blunt along edges. ``point_data`` has, of a solution ``u`` and its ``gradient``; of modes ``mode_1``,
    ``mode_2`` ...; of a shaft Prandtl's function ``u`` and the shear ``stress``; of an elastic body ``displacement``,
    ``stress`` (xx, yy, zz, xy, yz, xz, the order of VTK) and ``von_mises``. Vectors have three components, z = 0 in the
    plane; what is infinite at a corner is NaN.

    Parameters
    ----------
    mesh : Mesh, Solution, Spectrum, Torsion or ElasticSolution
        What to hand over.
    resolution : int or one for each axis, optional
        Of a field: cells along the longest side; 160 in the plane and 32 in space without it.

    Raises
    ------
    RsymError
        For what is neither, where the package meshio is missing, and for a shape that has nothing inside on so few
        cells.

    Warns
    -----
    RsymWarning
        Where cells have another area or volume than the shape, of which something is smaller than they are.

    Examples
    --------
    >>> import rsym
    >>> mesh = rsym.mesh(rsym.sphere(1), 16)
    >>> rsym.to_meshio(mesh).write("ball.xdmf")  # doctest: +SKIP
    >>> u = rsym.solve(rsym.disc(1), "-laplacian(u) = 1", 0, cells=8)
    >>> rsym.to_meshio(u, resolution=40)  # doctest: +SKIP
    """
    meshio = optional_package("meshio", "to_meshio")
    if isinstance(mesh, FIELDS):
        made, data = field_mesh(mesh, resolution)
        return meshio.Mesh(_in_space(made.points), [(_kind(made), made.cells)], point_data=data)
    _require_mesh(mesh, resolution)
    names, part = _parts(mesh)
    return meshio.Mesh(
        mesh.vertices.copy(),
        [("triangle", mesh.faces.astype(np.int64))],
        cell_data={} if part is None else {"part": [part]},
        field_data={name: np.array([number + 1, 2]) for number, name in enumerate(names)},
    )


def _require_mesh(mesh: Any, resolution: Any) -> None:
    require_kind(Mesh, mesh, "mesh")
    if resolution is not None:
        raise RsymError(
            "a mesh has the resolution it was made with", code="resolution", remedy="rsym.mesh(shape, resolution)"
        )


def _kind(made: Filling) -> str:
    """What meshio and VTK call its cells."""
    return "triangle" if made.points.shape[1] == 2 else "tetra"


def _in_space(points: Floats) -> Floats:
    """Points (n, 3), of the plane with z = 0, where VTK and its readers want them."""
    return np.pad(points, ((0, 0), (0, 3 - points.shape[1])))


def vtu_of_field(field: Field, resolution: Resolution) -> bytes:
    """Encode a field on the inside of its shape as ``.vtu`` of ParaView."""
    return _bytes(to_meshio(field, resolution=resolution), ".vtu", "vtu")


def vtu(mesh: Mesh, unit: str | None) -> bytes:
    """Encode as ``.vtu`` of ParaView, with its parts as cell data."""
    return _by_meshio(mesh, ".vtu", "vtu")


def msh(mesh: Mesh, unit: str | None) -> bytes:
    """Encode as ``.msh`` of Gmsh, parts as physical surfaces; text of version 2.2, which every reader of it knows."""
    return _by_meshio(mesh, ".msh", "gmsh22", binary=False)


def _by_meshio(mesh: Mesh, suffix: str, name: str, **options: bool) -> bytes:
    optional_package("meshio", f"a file {suffix}")
    given = to_meshio(mesh)
    if suffix == ".msh" and given.cell_data:
        tags = [given.cell_data.pop("part")[0] + 1]
        given.cell_data = {"gmsh:physical": tags, "gmsh:geometrical": tags}
    return _bytes(given, suffix, name, **options)


def _bytes(given: Any, suffix: str, name: str, **options: bool) -> bytes:
    """The bytes of a file by the name that meshio has for its format: its own choice by suffix is another program's."""
    meshio = optional_package("meshio", f"a file {suffix}")
    with TemporaryDirectory() as folder:
        path = Path(folder, f"mesh{suffix}")
        meshio.write(path, given, file_format=name, **options)
        return path.read_bytes()


def _parts(mesh: Mesh) -> tuple[tuple[str, ...], NDArray[np.int64] | None]:
    """The names of the parts that are on the surface, and the number of each face's, where they are known."""
    if mesh.leaf is None:
        return (), None
    seen, number = np.unique(mesh.part, return_inverse=True)
    return tuple(mesh.parts[part] for part in seen), number.reshape(-1)
