"""`rsym measure`: area or volume, length or surface, centroid and moments."""

from __future__ import annotations

import argparse

from rsym.commands.options import Commands, add_command, add_model, add_revolve, load_shape

GROUP = "fields on shapes"


def add(commands: Commands) -> None:
    """Describe the command."""
    parser = add_command(
        commands,
        "measure",
        "measure a shape by its equation: area or volume, length or surface, centroid, moments",
        "rsym measure gear",
        run,
    )
    add_model(parser)
    add_revolve(parser)
    parser.add_argument(
        "--tolerance", type=float, default=1e-12, metavar="SHARE", help="of the errors, estimated (default: 1e-12)"
    )
    parser.add_argument("--cells", type=int, metavar="CELLS", help="along the longest side; without refinement")
    parser.add_argument("--timeout", type=float, metavar="SECONDS", help="then what is known is printed")
    parser.add_argument("--json", action="store_true", help="print the report as JSON")


def run(options: argparse.Namespace) -> None:
    """Measure, and print the report."""
    from rsym.sampling.rules.measures import measure

    found = measure(load_shape(options), tolerance=options.tolerance, cells=options.cells, timeout=options.timeout)
    print(found.to_json() if options.json else found)
