"""`rsym fields`: the sheet of six fields."""

from __future__ import annotations

import argparse

from rsym.commands.options import (
    Commands,
    add_command,
    add_model,
    add_output,
    add_resolution,
    add_section,
    add_system,
    load_shape,
    numbers,
    progress_bar,
)

GROUP = "pictures"


def add(commands: Commands) -> None:
    """Describe the command."""
    parser = add_command(
        commands,
        "fields",
        "draw the level lines of six fields",
        "rsym fields car --section z=3 -o sheet.png",
        run,
    )
    add_model(parser)
    add_system(parser)
    add_output(parser, "the picture: .png, .svg, .pdf or .eps", required=True)
    add_section(parser)
    add_resolution(parser, 400)


def run(options: argparse.Namespace) -> None:
    """Draw the sheet and write it."""
    from rsym.output.fields import plot_fields
    from rsym.output.pictures import picture_suffix, write_picture
    from rsym.sampling.progress import tell

    picture_suffix(options.output)
    shape, section = load_shape(options), numbers(options.section, "--section")
    with progress_bar("field", "drawing") as progress:
        figure = plot_fields(
            shape, resolution=options.resolution, section=section, progress=progress, force=options.force
        )
        tell(progress, "writing", 1, 1)
        written = write_picture(figure, options.output)
    print(written)
