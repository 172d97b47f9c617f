"""`rsym sweep`: one letter as a strip of small multiples."""

from __future__ import annotations

import argparse

from rsym.commands.options import (
    Commands,
    add_command,
    add_model,
    add_output,
    add_resolution,
    add_revolve,
    add_section,
    add_system,
    load_shape,
    numbers,
    progress_bar,
    values,
)

GROUP = "pictures"


def add(commands: Commands) -> None:
    """Describe the command."""
    parser = add_command(
        commands,
        "sweep",
        "draw a shape at several values of one letter, side by side",
        "rsym sweep skeleton --letter p1 --values 20,40,80 --revolve x -o strip.png",
        run,
    )
    add_model(parser)
    add_system(parser)
    add_output(parser, "the picture: .png, .svg, .pdf or .eps", required=True)
    parser.add_argument("--letter", required=True, metavar="NAME", help="the letter that changes")
    parser.add_argument(
        "--values",
        required=True,
        type=values,
        metavar="V,V,...",
        help="its values; if the first is negative, write --values=-1,2",
    )
    parser.add_argument("--columns", type=int, metavar="COUNT", help="panels in a row")
    add_section(parser)
    add_revolve(parser)
    add_resolution(parser, None, "300 in the plane, 192 in space")
    parser.add_argument("--elevation", type=float, default=22.0, metavar="DEGREES", help="of the eye (default: 22)")
    parser.add_argument("--azimuth", type=float, default=48.0, metavar="DEGREES", help="of the eye (default: 48)")


def run(options: argparse.Namespace) -> None:
    """Draw the strip and write it."""
    from rsym.output.pictures import picture_suffix, write_picture
    from rsym.output.sweep import plot_sweep

    picture_suffix(options.output)
    shape, section = load_shape(options), numbers(options.section, "--section")
    with progress_bar("panel", options.letter) as progress:
        figure = plot_sweep(
            shape,
            options.letter,
            options.values,
            columns=options.columns,
            resolution=options.resolution,
            section=section,
            elevation=options.elevation,
            azimuth=options.azimuth,
            progress=progress,
            force=options.force,
        )
    print(write_picture(figure, options.output))
