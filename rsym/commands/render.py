"""`rsym render`: a picture straight from the equation."""

from __future__ import annotations

import argparse

from rsym.commands.options import (
    Commands,
    add_command,
    add_model,
    add_output,
    add_revolve,
    add_section,
    add_system,
    explain,
    load_shape,
    numbers,
)

GROUP = "pictures"


def add(commands: Commands) -> None:
    """Describe the command."""
    parser = add_command(
        commands,
        "render",
        "draw a body by rays cast at its equation",
        "rsym render car -o car.png --view front-left --colour-by part --section x=0",
        run,
    )
    add_model(parser)
    add_system(parser)
    add_output(parser, "the picture: .png", required=True)
    add_revolve(parser)
    add_section(parser)
    explain(parser.add_argument("--view", metavar="NAME"), "where the eye stands: %(known)s", _views)
    angles = parser.add_argument_group("another place of the eye")
    angles.add_argument("--elevation", type=float, metavar="DEGREES", help="above the xy-plane")
    angles.add_argument("--azimuth", type=float, metavar="DEGREES", help="from the x-axis towards the y-axis")
    angles.add_argument("--field-of-view", type=float, metavar="DEGREES", help="perspective; without it parallel rays")
    angles.add_argument("--zoom", type=float, default=1.0, metavar="FACTOR", help="larger than what just fits")
    explain(parser.add_argument("--colour-by", metavar="MAP"), "what colours show: %(known)s", _colourings)
    parser.add_argument("--size", type=pixels, default=(1600, 1200), metavar="WIDTHxHEIGHT", help="default: 1600x1200")
    parser.add_argument("--samples", type=int, default=1, metavar="RAYS", help="for each pixel beside an edge: 4, 16")
    parser.add_argument("--no-lines", action="store_true", help="no outlines and edges in ink")
    parser.add_argument("--shadows", action="store_true", help="soft shadows, and less light in corners")
    parser.add_argument("--transparent", action="store_true", help="no background")


def _views() -> str:
    from rsym.output.cameras import VIEWS

    return ", ".join(VIEWS)


def _colourings() -> str:
    from rsym.output.brushes import COLOURINGS

    return ", ".join(COLOURINGS)


def pixels(text: str) -> tuple[int, int]:
    """The size of a picture as it is typed.

    Examples
    --------
    >>> pixels("1600x1200")
    (1600, 1200)
    """
    try:
        width, height = (int(side) for side in text.lower().split("x"))
    except ValueError:
        raise argparse.ArgumentTypeError(f"expected a size such as 1600x1200, got {text!r}") from None
    return width, height


def run(options: argparse.Namespace) -> None:
    """Render the shape, write the picture, and say what is not certain in it."""
    from dataclasses import replace

    from rsym.output.cameras import camera_of
    from rsym.output.images import check_picture
    from rsym.output.rendering import render

    check_picture(options.output)
    camera = camera_of(options.view)
    given = {name: getattr(options, name) for name in ("elevation", "azimuth", "field_of_view", "zoom")}
    camera = replace(camera, **{name: value for name, value in given.items() if value is not None})
    image = render(
        load_shape(options),
        camera=camera,
        size=options.size,
        colour_by=options.colour_by,
        section=numbers(options.section, "--section"),
        lines=not options.no_lines,
        shadows=options.shadows,
        background=None if options.transparent else "white",
        samples=options.samples,
    )
    print(image.save(options.output))
    print(image.status)
