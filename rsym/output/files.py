"""Meshes to files: the format by suffix, the file whole or not at all."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path
from types import MappingProxyType

from rsym.errors import RsymError
from rsym.model.requirements import file_path, require_kind
from rsym.output import formats
from rsym.output.atomic import write_atomically
from rsym.output.dxf import features_dxf
from rsym.output.exchange import by_meshio
from rsym.output.interactive import page, page_of_parts
from rsym.output.units import UNITS, check_unit, sized
from rsym.sampling.mesh import Mesh
from rsym.sampling.sharp.features import Feature
from rsym.verify.bodies.singular import SingularCurve

# Formats that hold colours.
COLOURED: Mapping[str, Callable[[Mesh], bytes]] = MappingProxyType(
    {".glb": formats.glb_of_parts, ".html": page_of_parts}
)
FORMATS: Mapping[str, Callable[[Mesh], bytes]] = MappingProxyType(
    {
        ".stl": formats.stl,
        ".ply": formats.ply,
        ".obj": formats.obj,
        ".off": formats.off,
        ".glb": formats.glb,
        ".3mf": formats.three_mf,
        ".html": page,
    }
)
# Formats that the package meshio writes, where it is installed.
BY_MESHIO: Mapping[str, Callable[[Mesh], bytes]] = MappingProxyType(
    {suffix: partial(by_meshio, suffix=suffix) for suffix in (".vtu", ".msh")}
)


def write(
    mesh: Mesh,
    path: str | os.PathLike[str],
    *,
    unit: str | None = None,
    size: float | str | None = None,
    scale: float | None = None,
    colour_by: str | None = None,
) -> Path:
    """Write a mesh to a file, in the format that the suffix names.

    ========= ===============================================================================================
    ``.stl``  binary, float32, triangles without shared vertices
    ``.ply``  binary, float64
    ``.obj``  text, float64 in full, a normal for each corner of each face
    ``.off``  text, float64 in full
    ``.glb``  binary glTF 2.0, float32, y up (so x, z, -y), normals, copies along sharp edges
    ``.3mf``  float64 in full, for printing: states its unit, closed bodies alone
    ``.html`` a page that opens offline, turns with the mouse and zooms
    ``.vtu``  of ParaView, float64, parts as numbers; by the package meshio
    ``.msh``  of Gmsh, text of version 2.2, float64 in full, parts as physical surfaces; by the package meshio
    ========= ===============================================================================================

    The file appears whole or not at all: an older one stays as it is until
    the new one is safe on the disk. The same mesh gives the same bytes.

    Lengths: ``.3mf`` states its unit, millimetres if none is given. ``.glb`` is in metres by definition: the numbers of
    a mesh without a unit are taken for metres, those in a unit are converted. The others hold numbers without a unit,
    those in the unit given; who prints takes those of ``.stl`` for millimetres. A page shows no lengths.

    Parameters
    ----------
    mesh : Mesh
        The triangles, in the order and with the orientation of ``mesh.faces``.
    path : str or path-like
        Where to; the folder must exist.
    unit : {"mm", "cm", "m", "in"}, optional
        The unit of lengths in the file; without it that of `size`, if it names one.
    size : number or text, optional
        How long the longest side of the mesh gets, in `unit`, or as in "120mm".
    scale : float, optional
        How many units one unit of the model becomes, in place of `size`; by default 1.
    colour_by : "part", optional
        Give each part its colour, and in ``.glb`` an object of its name: only in ``.glb`` and ``.html``.

    Returns
    -------
    Path
        The path of the file.

    Raises
    ------
    RsymError
        If the suffix is unknown, a package that it needs is missing, the folder is missing or cannot be written, or
        the format cannot hold the mesh or its colours; for another unit, a size or a scale that is not positive, or
        both of them.

    Examples
    --------
    >>> import tempfile
    >>> import numpy as np
    >>> corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]])
    >>> faces = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    >>> mesh = Mesh(corners, faces)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     print(write(mesh, Path(folder, "corner.off")).read_text())
    OFF
    4 4 0
    0.0 0.0 0.0
    1.0 0.0 0.0
    0.0 1.0 0.0
    0.0 0.0 1.0
    3 0 2 1
    3 0 1 3
    3 0 3 2
    3 1 2 3
    <BLANKLINE>
    """
    require_kind(Mesh, mesh, "mesh")
    path = file_path(path)
    if colour_by not in (None, "part") or (colour_by and path.suffix.lower() not in COLOURED):
        raise RsymError(
            f"files are coloured by part, as {' or '.join(COLOURED)}, got colour_by={colour_by!r} for {path.name}",
            code="colour-by",
            where=str(path),
            remedy='leave colour_by out, or write colour_by="part" to one of them',
        )
    known = {**FORMATS, **BY_MESHIO}
    encode = (COLOURED if colour_by else known).get(path.suffix.lower())
    if encode is None:
        raise RsymError(
            f"a mesh is written as {', '.join(known)}, got the suffix {path.suffix!r}",
            code="file-format",
            where=str(path),
            remedy=f"end the name with one of: {', '.join(known)}",
        )
    mesh, unit = sized(mesh, unit=unit, size=size, scale=scale)
    if path.suffix.lower() == ".3mf":
        return write_atomically(path, formats.three_mf(mesh, unit or "mm"))
    if path.suffix.lower() == ".glb" and unit is not None:
        mesh = mesh.scale(UNITS[unit].metres)
    return write_atomically(path, encode(mesh))


def write_features(
    mesh: Mesh | Sequence[Feature | SingularCurve],
    path: str | os.PathLike[str],
    *,
    unit: str = "mm",
    scale: float = 1.0,
) -> Path:
    """Write the curves along which the leaves of a mesh meet as polylines in space, in DXF (release 12, ASCII).

    The curves between two parts are on one layer, named after both: ``BONNET-WHEEL_ARCHES``.
    The file appears whole or not at all, and the same curves give the same bytes.

    Parameters
    ----------
    mesh : Mesh or sequence of curves
        A mesh with features, so of method "sharp"; or some of them, or the singular curves of a `BodyReport`.
    path : str or path-like
        Where to; the name ends in ``.dxf``.
    unit : {"mm", "cm", "m", "in"}
        The unit of the file.
    scale : float
        How many units one unit of the model becomes.

    Raises
    ------
    RsymError
        For another suffix or unit, a scale that is not positive, or no curves.

    Examples
    --------
    >>> import tempfile, rsym
    >>> from rsym import x, y, z
    >>> ball = rsym.Shape(1 - x**2 - y**2 - z**2, (x, y, z), bounds=((-2, 2),) * 3)
    >>> half = rsym.mesh(ball & rsym.Shape(x, (x, y, z)), 32)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     text = write_features(half, folder + "/rim.dxf").read_text()
    >>> text.count("POLYLINE")
    1
    """
    path = file_path(path)
    if path.suffix.lower() != ".dxf":
        raise RsymError(
            f"features are written as .dxf, got {str(path)!r}", code="suffix", remedy="end the name with .dxf"
        )
    check_unit(unit, scale)
    features = mesh.features if isinstance(mesh, Mesh) else mesh
    if not features:
        raise RsymError(
            "the mesh has no features: its leaves meet nowhere, or are not known"
            if isinstance(mesh, Mesh)
            else "expected curves, got none",
            code="no-features",
            remedy='take a mesh of method="sharp", or a report with curves',
        )
    return write_atomically(path, features_dxf(features, unit, scale))
