"""Meshes, shapes and fields to files: the format by suffix, the file whole or not at all."""

from __future__ import annotations

import os
from collections.abc import Collection, Mapping, Sequence
from pathlib import Path
from typing import Any

from rsym.atomic import target_of, write_atomically
from rsym.errors import RsymError
from rsym.model.requirements import file_path, path_ending, require_kind
from rsym.model.shape import Shape
from rsym.model.wording import documented
from rsym.output.design.pages import DesignPage, page_of
from rsym.output.dxf import features_dxf
from rsym.output.exchange import vtu_of_field
from rsym.output.field_data import FIELDS, Field
from rsym.output.formats import FORMATS, Format, coloured_formats, table_of_formats
from rsym.output.images import Image
from rsym.output.layers import LAYERS, level_layers, longest_side, write_layers
from rsym.output.units import check_unit, factor_of, sized
from rsym.sampling.mesh import Mesh
from rsym.sampling.plane import GivenField
from rsym.sampling.sharp.features import Feature
from rsym.verify.answers.singular import SingularCurve

_OF_SHAPES = {
    2: "a picture is the figure of rsym.plot_fields(shape), a body rsym.mesh(rsym.extrude(shape, 0, 1))",
    3: "rsym.write(rsym.mesh(shape), path) has the formats of meshes, rsym.render(shape).save(path) is a picture",
}
_OF_FIELDS = "rsym.to_meshio(field).write(path) has other formats"


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
    levels: float | Sequence[float] | None = None,
) -> Path:
    """Write a mesh to a file, in the format that the suffix names; a rendered picture as ``.png``; a shape as a page.

    The page of a shape, ``.html``, has a slider for each letter. What `solve`, `modes`, `torsion` or `elasticity`
    answered is written as ``.vtu`` of ParaView, on cells that fill the shape; `to_meshio` tells which, and the names of
    the data. A shape in the plane, what `solve` found on one and the stress lines of `torsion` are lines too, ``.svg``
    or ``.dxf``, in true scale: the outline with its corners is the layer ``outline``, level lines are layers as
    ``u=0.5``, of a shape ``omega=0.5``, in DXF ``U_0P5``.

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
        of the options, as the page of a shape; or a field, which as ``.vtu`` takes `resolution` alone. Lines take all
        but `colour_by`.
    path : str or path-like
        Where to; the folder must exist.
    unit : {"mm", "cm", "m", "in"}, optional
        The unit of lengths in the file; without it that of `size`, if it names one. That of lines is "mm" then.
    size : number or text, optional
        How long the longest side of the mesh gets, in `unit`, or as in "120mm".
    scale : float, optional
        How many units one unit of the model becomes, in place of `size`; by default 1.
    colour_by : "part", optional
        Give each part its colour, and in ``.glb`` an object of its name: only in ``{coloured}``.
    resolution : int or one for each axis, optional
        Of a field: cells along the longest side; 160 in the plane and 32 in space without it, of lines 512.
    levels : number or sequence of numbers, optional
        Of lines; without it those of a solution are round, as those of `plot_field`, and a shape has its outline alone.

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
    lengths = {"unit": unit, "size": size, "scale": scale}
    given = {**lengths, "colour_by": colour_by, "resolution": resolution, "levels": levels}
    if isinstance(mesh, Image):
        _require_options("a picture", given, ())
        return mesh.save(path)
    path = file_path(path)
    target_of(path)
    suffix = path.suffix.lower()
    if suffix in LAYERS and isinstance(mesh, Shape | GivenField):
        _require_options(f"level lines as {suffix}", given, (*lengths, "resolution", "levels"))
        layers = level_layers(mesh, levels, resolution)
        factor, unit = factor_of(longest_side(layers), **lengths)
        return write_layers(layers, path, unit or "mm", factor)
    if isinstance(mesh, FIELDS):
        _require_written_as("a field", path, (".vtu", *(LAYERS if isinstance(mesh, GivenField) else ())), _OF_FIELDS)
        _require_options("a field as .vtu", given, ("resolution",))
        return write_atomically(path, vtu_of_field(mesh, resolution))
    if isinstance(mesh, Shape):
        _require_written_as("a shape", path, (".html", *LAYERS), _OF_SHAPES[mesh.dimension])
        _require_options("the page of a shape", given, ())
        return DesignPage(page_of(mesh, title=path.stem)).write(path)
    require_kind(Mesh, mesh, "mesh")
    row = mesh_format(path, colour_by)
    _require_options("a mesh", given, (*lengths, "colour_by"), "; rsym.mesh(shape, resolution) makes a finer one")
    mesh, unit = sized(mesh, unit=unit, size=size, scale=scale)
    encode = row.coloured if colour_by and row.coloured else row.encode
    return write_atomically(path, encode(mesh, unit))


def mesh_format(path: str | os.PathLike[str], colour_by: str | None = None) -> Format:
    """The format of a mesh, of which another suffix is refused: asked before the work, not after it."""
    path = file_path(path)
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
    return row


def _require_options(what: str, given: Mapping[str, Any], taken: Collection[str], instead: str = "") -> None:
    """Refuse options that what is written does not take."""
    wrong = [name for name, value in given.items() if value is not None and name not in taken]
    if wrong:
        raise RsymError(
            f"{what} takes {', '.join(taken) or 'no options'}, got {', '.join(wrong)}",
            code="options",
            remedy=f"leave {', '.join(wrong)} out{instead}",
        )


def _require_written_as(what: str, path: Path, suffixes: Sequence[str], instead: str) -> None:
    """Refuse another suffix."""
    if path.suffix.lower() not in suffixes:
        raise RsymError(
            f"{what} is written as {' or '.join(suffixes)}, got {path.name}",
            code="file-format",
            where=str(path),
            remedy=f"end the name with {' or '.join(suffixes)}; {instead}",
        )


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
    path = check_features(path)
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


def check_features(path: str | os.PathLike[str]) -> Path:
    """The path of curves, if it ends in ``.dxf``."""
    return path_ending(path, ".dxf", "features are")
