"""`rsym mesh`: the surface as triangles."""

from __future__ import annotations

import argparse
import math
import sys
import warnings
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from rsym.commands.options import (
    AUTOMATIC,
    AUTOMATICALLY,
    Commands,
    add_command,
    add_model,
    add_output,
    add_resolution,
    add_revolve,
    add_system,
    explain,
    load_shape,
    progress_bar,
)
from rsym.errors import RsymError, RsymWarning

if TYPE_CHECKING:
    from rsym.model.shape import Shape
    from rsym.sampling.mesh import Mesh
    from rsym.sampling.mesh_file import FileStatus
    from rsym.sampling.status import MeshStatus


GROUP = "meshes"


def add(commands: Commands) -> None:
    """Describe the command."""
    parser = add_command(
        commands,
        "mesh",
        "triangulate the surface and write it",
        "rsym mesh car -o car.stl --variant b --resolution 256 --features edges.dxf",
        run,
    )
    add_model(parser)
    add_system(parser)
    explain(add_output(parser, "", required=True), "the mesh, in the format of its suffix: %(known)s", _formats)
    add_revolve(parser)
    add_resolution(parser, AUTOMATIC, AUTOMATICALLY)
    parser.add_argument(
        "--method",
        choices=["sharp", "smooth"],
        default="sharp",
        help="sharp: exact edges and corners; smooth: marching cubes (default: sharp)",
    )
    parser.add_argument("--open", action="store_true", help="leave the surface open where it leaves the bounds")
    add_output(parser, "also write the curves where parts meet: .dxf", "--features")
    parser.add_argument("--size", metavar="LENGTH", help="how long the longest side gets: 120mm, 4.5in")
    parser.add_argument("--scale", type=float, metavar="FACTOR", help="units to one unit of the model (default: 1)")
    parser.add_argument(
        "--unit", help="of lengths in the file: mm, cm, m or in; .3mf states it, .glb is converted to metres"
    )
    parser.add_argument(
        "--memory",
        metavar="SIZE",
        help="write a .ply or .stl in pieces within so much memory, as 1GB; without it only a mesh that does not fit",
    )
    parser.add_argument("--verbose", action="store_true", help="every place that is unresolved, not the worst alone")
    colours = parser.add_argument("--colour-by", choices=["part"])
    explain(colours, "a colour for each part of the model: %(known)s", _coloured_formats)


def _formats() -> str:
    from rsym.output.formats import listed_formats

    return listed_formats()


def _coloured_formats() -> str:
    from rsym.output.formats import coloured_formats

    return coloured_formats()


def run(options: argparse.Namespace) -> None:
    """Mesh the shape, write it, and say what is known of the mesh."""
    from rsym.output.files import check_features, mesh_format
    from rsym.output.units import check_size

    mesh_format(options.output, options.colour_by)
    if options.features:
        check_features(options.features)
    check_size(unit=options.unit, size=options.size, scale=options.scale)
    shape = load_shape(options)
    if options.memory is not None:
        if not _may_stream(options):
            raise RsymError(
                "a mesh within --memory goes into a .ply or .stl as it is",
                code="streamed",
                remedy="leave out --method smooth, --open, --features, --size, --scale, --unit and --colour-by",
            )
        _streamed(shape, options)
        return
    try:
        result = _in_memory(shape, options)
    except RsymError as error:
        if error.code != "memory" or not _may_stream(options):
            raise
        print(f"{error.message}: in pieces", file=sys.stderr)
        try:
            _streamed(shape, options)
        except RsymError as narrower:
            if narrower.code != "memory":
                raise
            raise error from narrower  # not even pieces fit: what it says of --force holds
    else:
        _written(result, options)


def _in_memory(shape: Shape, options: argparse.Namespace) -> Mesh:
    from rsym.sampling.meshing import mesh

    with progress_bar("step", "meshing") as progress, warnings.catch_warnings():
        warnings.simplefilter("ignore", RsymWarning)  # the status, printed later, says the same
        return mesh(
            shape,
            options.resolution,
            method=options.method,
            cap=not options.open,
            progress=progress,
            force=options.force,
        )


def _written(mesh: Mesh, options: argparse.Namespace) -> None:
    from rsym.output.files import write, write_features
    from rsym.output.units import sized

    result, unit = sized(mesh, unit=options.unit, size=options.size, scale=options.scale)
    if options.features:
        print(write_features(result, options.features, unit=unit or "mm"))
    print(write(result, options.output, unit=unit, colour_by=options.colour_by))
    _tell(result.status, options)
    if (options.size, options.scale, options.unit) != (None, None, None):
        sides = " x ".join(f"{high - low:.6g}" for low, high in result.bounds)
        print(f"size {sides} {unit or ''}".rstrip())


def _may_stream(options: argparse.Namespace) -> bool:
    """Whether the file can hold a mesh in pieces, and nothing is asked that takes the whole."""
    from rsym.sampling.mesh_file import SUFFIXES

    whole = (options.features, options.size, options.scale, options.unit, options.colour_by)
    suffix = "." + options.output.rpartition(".")[2].lower()
    return suffix in SUFFIXES and options.method == "sharp" and not options.open and whole == (None,) * 5


def _streamed(shape: Shape, options: argparse.Namespace) -> None:
    """The mesh in pieces, straight into the file."""
    from rsym.sampling.meshing import mesh

    with progress_bar("step", "meshing") as progress, warnings.catch_warnings():
        warnings.simplefilter("ignore", RsymWarning)
        made = mesh(shape, options.resolution, progress=progress, into=options.output, memory=options.memory)
    print(made.path)
    _tell(made.status, options)


def _tell(status: MeshStatus | FileStatus, options: argparse.Namespace) -> None:
    """What is known of the mesh, below the resolution where it was looked for."""
    if options.resolution == AUTOMATIC:
        print(f"resolution {status.resolution}")
    print(*told(status, verbose=options.verbose), sep="\n")


def told(status: MeshStatus | FileStatus, *, verbose: bool = False) -> Iterator[str]:
    """The status, its remarks one to a line; unless `verbose` in three lines at most, with the resolution to take.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y, z
    >>> ball = rsym.Shape(1 - x**2 - y**2 - z**2, (x, y, z), bounds=((-2, 2), (-2, 2), (-2, 0.5)))
    >>> with warnings.catch_warnings(action="ignore"):
    ...     print(*list(told(rsym.mesh(ball, 8).status))[1:])
    - The body leaves the bounds and is clipped at the upper end of z; flat caps close it there.
    """
    yield str(status).removesuffix("".join(f" {line}" for line in status.brief))
    lines = list(status.remarks if verbose else status.brief)
    hints = []
    if status.finer is not None and status.resolution is not None and not verbose:
        cells = status.resolution if isinstance(status.resolution, Sequence) else [status.resolution]
        finer = ",".join(str(math.ceil(status.finer * count)) for count in cells)
        hints.append(f"--resolution {finer} puts 2 cells across every wall and gap")
    if len(status.unresolved) > 1 and not verbose:
        hints.append(f"--verbose tells all {len(status.unresolved)} places")
    if hints:
        lines.insert(2, " ".join([*lines[2:], f"{'; '.join(hints)}."]))
    yield from (f"- {line}" for line in lines[: None if verbose else 3])
