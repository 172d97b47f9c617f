"""`rsym view`: the surface in the browser."""

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
    add_system,
    load_shape,
    progress_bar,
)
from rsym.errors import RsymWarning

GROUP = "meshes"


def add(commands: Commands) -> None:
    """Describe the command."""
    parser = add_command(
        commands, "view", "open the surface in the browser, to turn and zoom", "rsym view car --colour-by part", run
    )
    add_model(parser)
    add_system(parser)
    add_revolve(parser)
    add_resolution(parser, 128)
    parser.add_argument("--colour-by", choices=["part"], help="a colour for each part of the model")
    add_output(parser, "keep the page: a name that ends in .html")
    parser.add_argument("--verbose", action="store_true", help="every place that is unresolved, not the worst alone")
    parser.add_argument("--no-open", action="store_true", help="only write the page, and print where it is")


def run(options: argparse.Namespace) -> None:
    """Mesh the shape, write the page, open it."""
    from rsym.commands.mesh import told
    from rsym.output.viewing import check_page, view
    from rsym.sampling.meshing import mesh

    if options.output is not None:
        check_page(options.output)
    shape = load_shape(options)
    with progress_bar("step", "meshing") as progress, warnings.catch_warnings():
        warnings.simplefilter("ignore", RsymWarning)  # the status, printed below, says the same
        result = mesh(shape, options.resolution, progress=progress, force=options.force)
    print(view(result, colour_by=options.colour_by, path=options.output, browser=not options.no_open))
    print(*told(result.status, verbose=options.verbose), sep="\n")
