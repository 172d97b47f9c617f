"""`rsym repair`: the smallest changes that make the boundary curvature-continuous, with their prices."""

from __future__ import annotations

import argparse

from rsym.commands.options import (
    Commands,
    add_command,
    add_model,
    add_output,
    add_revolve,
    add_timeout,
    load_shape,
    progress_bar,
)

GROUP = "proofs"


def add(commands: Commands) -> None:
    """Describe the command."""
    parser = add_command(
        commands,
        "repair",
        "the smallest changes that make the curvature of the boundary continuous, each proved, with its price",
        "rsym repair skeleton --move letter --move round -o nose.png",
        run,
    )
    add_model(parser)
    add_revolve(parser)
    parser.add_argument(
        "--move", action="append", metavar="NAME", help="a move to try: letter, round, rho or pasko (default: all)"
    )
    parser.add_argument("--vary", action="append", metavar="LETTER", help="a letter that may be moved (default: all)")
    parser.add_argument("--curvature", type=float, metavar="K", help="the largest curvature allowed")
    parser.add_argument("--radius", type=float, metavar="R", help="the size of roundings and blends, a length")
    add_timeout(parser, "what was not tried by then is rejected")
    parser.add_argument("--json", action="store_true", help="print the candidates as JSON")
    add_output(parser, "a picture of the candidates: .png, .svg, .pdf or .eps")


def run(options: argparse.Namespace) -> int:
    """Look for candidates and print them; the exit code is 0 if there are some or none is needed, else 1."""
    from rsym.output.pictures import picture_suffix, write_picture
    from rsym.output.repairs import plot_repair
    from rsym.verify.repair.repairing import repair

    if options.output is not None:
        picture_suffix(options.output)
    shape = load_shape(options)
    with progress_bar("verdict", "repairing") as progress:
        report = repair(
            shape,
            moves=options.move,
            vary=options.vary,
            curvature=options.curvature,
            radius=options.radius,
            timeout=options.timeout,
            progress=progress,
        )
    print(report.to_json() if options.json else report)
    if options.output is not None and report.candidates:
        write_picture(plot_repair(report), options.output)
    return 0 if report.candidates or not report.needed else 1
