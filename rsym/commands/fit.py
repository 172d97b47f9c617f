"""`rsym fit`: letters from measured points."""

from __future__ import annotations

import argparse

from rsym.commands.options import (
    Commands,
    add_command,
    add_model,
    add_output,
    add_revolve,
    add_section,
    load_shape,
    numbers,
)

GROUP = "models"


def add(commands: Commands) -> None:
    """Describe the command."""
    parser = add_command(
        commands,
        "fit",
        "find the letters for which the boundary is nearest to measured points",
        "rsym fit skeleton points.csv --find a1,a2,p1 -o letters.json",
        run,
    )
    parser.description = f"{parser.description} Other commands take what -o writes by --letters."
    add_model(parser, "a value to start from, or one that stays")
    parser.add_argument("points", metavar="POINTS", help="a text file, a row of numbers for each point: x,y or x,y,z")
    parser.add_argument("--find", required=True, metavar="LETTER,...", help="the letters to find")
    add_output(parser, "the letters of the shape: .json")
    add_output(parser, "the boundary and the points: .png, .svg, .pdf or .eps", "--picture")
    parser.add_argument(
        "--loss", default="linear", metavar="LOSS", help="linear, or for data with outliers huber, soft_l1, cauchy"
    )
    add_section(parser)
    parser.add_argument(
        "--silhouette", metavar="AXIS", help="the points are those of an outline, seen along this coordinate"
    )
    add_revolve(parser)


def run(options: argparse.Namespace) -> None:
    """Find the letters, print them with their standard errors, and write what is asked for."""
    from rsym.output.fits import plot_fit
    from rsym.output.models import save_letters
    from rsym.output.pictures import figure_of, picture_suffix, write_picture
    from rsym.output.points import load_points
    from rsym.sampling.fitting import fit

    if options.picture:
        picture_suffix(options.picture)
    shape, section = load_shape(options), numbers(options.section, "--section")
    flat = len(section) + (options.silhouette is not None)
    found = fit(
        shape,
        load_points(options.points, shape.dimension - min(flat, 1)),
        [name.strip() for name in options.find.split(",")],
        loss=options.loss,
        section=section or None,
        silhouette=options.silhouette,
    )
    print(found)
    if options.output:
        print(save_letters(found.shape, options.output))
    if options.picture:
        print(write_picture(figure_of(plot_fit(found)), options.picture))
