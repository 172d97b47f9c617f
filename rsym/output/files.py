"""Meshes to files: the format by suffix, the file whole or not at all."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from rsym.atomic import write_atomically
from rsym.errors import RsymError
from rsym.model.requirements import file_path, require_kind
from rsym.model.shape import Shape
from rsym.model.wording import documented
from rsym.output.design.pages import DesignPage, page_of
from rsym.output.dxf import features_dxf
from rsym.output.exchange import Resolution, vtu_of_field
from rsym.output.field_data import FIELDS, Field
from rsym.output.formats import FORMATS, coloured_formats, table_of_formats
from rsym.output.images import Image
from rsym.output.units import check_unit, sized
from rsym.sampling.mesh import Mesh
from rsym.sampling.sharp.features import Feature
from rsym.verify.answers.singular import SingularCurve


@documented(formats=table_of_formats(), coloured=coloured_formats().replace(" or ", "`` and ``"))
def write(
    mesh: Mesh | Image | Shape | Field,
    path: str | os.PathLike[str],
    *,
    unit: str | None = None,
    size: float | str | None = None,
    scale: float | None = None,
    colour_by: str | None = None,
    resolution: int | Sequence[int] | None = None,
) -> Path:
    """Write a mesh to a file, in the format that the suffix names; a rendered picture as ``.png``; a shape as a page.

    The page of a shape, ``.html``, has a slider for each letter. What `solve`, `modes`, `torsion` or `elasticity`
    answered is written as ``.vtu`` of ParaView, on cells that fill the shape; `to_meshio` tells which, and the names of
    the data.

    {formats}

    The page of a shape is another one: it draws the equation itself, without a mesh, and its letters move.

    The file appears whole or not at all: an older one stays as it is until
    the new one is safe on the disk. The same mesh gives the same bytes.

    Lengths: ``.3mf`` states its unit, millimetres if none is given. ``.glb`` is in metres by definition: the numbers of
    a mesh without a unit are taken for metres, those in a unit are converted. The others hold numbers without a unit,
    those in the unit given; who prints takes those of ``.stl`` for millimetres. A page shows no lengths.

    Parameters
    ----------
    mesh : Mesh, Image, Shape, Solution, Spectrum, Torsion or ElasticSolution
        The triangles, in the order and with the orientation of ``mesh.faces``; or what `render` gave, which takes none
        of the options; or a shape, which is written as ``.html`` alone; or a field, which takes `resolution` alone.
    path : str or path-like
        Where to; the folder must exist.
    unit : {"mm", "cm", "m", "in"}, optional
        The unit of lengths in the file; without it that of `size`, if it names one.
    size : number or text, optional
        How long the longest side of the mesh gets, in `unit`, or as in "120mm".
    scale : float, optional
        How many units one unit of the model becomes, in place of `size`; by default 1.
    colour_by : "part", optional
        Give each part its colour, and in ``.glb`` an object of its name: only in ``{coloured}``.
    resolution : int or one for each axis, optional
        Of a field: cells along the longest side; 160 in the plane and 32 in space without it.

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
    of_a_mesh = unit, size, scale, colour_by
    if isinstance(mesh, Image):
        if any(option is not None for option in (*of_a_mesh, resolution)):
            raise RsymError("a picture has neither units nor sizes", code="picture", remedy="give the path alone")
        return mesh.save(path)
    path = file_path(path)
    if isinstance(mesh, FIELDS):
        return _write_field(mesh, path, resolution, *of_a_mesh)
    if isinstance(mesh, Shape):
        return _write_page(mesh, path, *of_a_mesh, resolution)
    require_kind(Mesh, mesh, "mesh")
    row = FORMATS.get(path.suffix.lower())
    if colour_by not in (None, "part") or (colour_by and not (row and row.coloured)):
        raise RsymError(
            f"files are coloured by part, as {coloured_formats()}, got colour_by={colour_by!r} for {path.name}",
            code="colour-by",
            where=str(path),
            remedy='leave colour_by out, or write colour_by="part" to one of them',
        )
    if row is None:
        raise RsymError(
            f"a mesh is written as {', '.join(FORMATS)}, got the suffix {path.suffix!r}",
            code="file-format",
            where=str(path),
            remedy=f"end the name with one of: {', '.join(FORMATS)}",
        )
    if resolution is not None:
        raise RsymError(
            "a mesh has the resolution it was made with", code="resolution", remedy="rsym.mesh(shape, resolution)"
        )
    mesh, unit = sized(mesh, unit=unit, size=size, scale=scale)
    encode = row.coloured if colour_by and row.coloured else row.encode
    return write_atomically(path, encode(mesh, unit))


def _write_field(field: Field, path: Path, resolution: Resolution, *of_a_mesh: float | str | None) -> Path:
    if path.suffix.lower() != ".vtu" or any(option is not None for option in of_a_mesh):
        raise RsymError(
            "a field is written as .vtu, without options of a mesh",
            code="file-format",
            where=str(path),
            remedy="end the name with .vtu; rsym.to_meshio(field).write(path) has other formats",
        )
    return write_atomically(path, vtu_of_field(field, resolution))


def _write_page(shape: Shape, path: Path, *of_a_mesh: Any) -> Path:
    if path.suffix.lower() != ".html" or any(option is not None for option in of_a_mesh):
        raise RsymError(
            "a shape is written as .html, without options of a mesh",
            code="file-format",
            where=str(path),
            remedy="write rsym.mesh(shape), or end the name with .html",
        )
    return DesignPage(page_of(shape, title=path.stem)).write(path)


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
