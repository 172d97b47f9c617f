"""`rsym sections`: cuts by parallel planes."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

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
    values,
)

GROUP = "pictures"


def add(commands: Commands) -> None:
    """Describe the command."""
    parser = add_command(
        commands,
        "sections",
        "cut a shape in space by parallel planes: layers in true scale, or a picture of the stack",
        "rsym sections car --axis z --values=-2.5:7.5:0.5 -o layers.svg --unit mm --scale 10",
        run,
    )
    add_model(parser)
    add_system(parser)
    add_output(parser, "the layers: .svg or .dxf; the stack seen from above: .png or .pdf", required=True)
    parser.add_argument(
        "--values", required=True, type=values, metavar="V,V,...", help="where the planes lie: 1,2,4 or 1:4:0.5"
    )
    parser.add_argument("--axis", default="z", metavar="NAME", help="the coordinate that they fix (default: z)")
    parser.add_argument("--unit", default="mm", help="of the layers: mm, cm, m or in (default: mm)")
    parser.add_argument("--scale", type=float, default=1.0, help="units to one unit of the model (default: 1)")
    add_revolve(parser)
    add_resolution(parser, 512)


def run(options: argparse.Namespace) -> None:
    """Cut, and write the layers or the picture."""
    from rsym.output.layers import LAYERS
    from rsym.output.pictures import picture_suffix, write_picture
    from rsym.output.sections import plot_sections, write_sections
    from rsym.sampling.sections import sections

    layered = Path(options.output).suffix.lower() in LAYERS
    if not layered:
        picture_suffix(options.output)
    shape = load_shape(options)
    with progress_bar("section", "cutting") as progress:
        layers = sections(
            shape,
            options.values,
            axis=options.axis,
            resolution=options.resolution,
            progress=progress,
            force=options.force,
        )
    if layered:
        print(write_sections(layers, options.output, unit=options.unit, scale=options.scale))
    else:
        figure: Any = plot_sections(layers).get_figure()
        print(write_picture(figure, options.output))
