"""`rsym mesh`: the surface as triangles."""

from __future__ import annotations

import argparse
import warnings

from rsym.commands.options import (
    Commands,
    add_command,
    add_model,
    add_output,
    add_resolution,
    add_revolve,
    load_shape,
    progress_bar,
)
from rsym.errors import RsymWarning


def add(commands: Commands) -> None:
    """Describe the command."""
    parser = add_command(
        commands,
        "mesh",
        "triangulate the surface and write it",
        "rsym mesh car -o car.stl --variant b --resolution 256",
        run,
    )
    add_model(parser)
    add_output(parser, "the mesh: .stl .ply .obj .off .glb .3mf, or .html to look at")
    add_revolve(parser)
    add_resolution(parser, 128)
    parser.add_argument("--colour-by", choices=["part"], help="a colour for each part of the model: .glb and .html")


def run(options: argparse.Namespace) -> None:
    """Mesh the shape, write it, and say what is known of the mesh."""
    from rsym.output.files import write
    from rsym.sampling.meshing import mesh

    shape = load_shape(options)
    with progress_bar("step", "meshing") as progress, warnings.catch_warnings():
        warnings.simplefilter("ignore", RsymWarning)  # the status, printed below, says the same
        result = mesh(shape, options.resolution, progress=progress)
    print(write(result, options.output, colour_by=options.colour_by))
    print(result.status)
