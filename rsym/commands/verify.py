"""`rsym verify`: is the curvature of the boundary continuous, and is it proved."""

from __future__ import annotations

import argparse

from rsym.commands.options import Commands, add_command, add_model, add_revolve, load_shape, ranges

# Exit codes of the design: proved, refuted, neither.
CODES = {"CERTIFIED": 0, "REFUTED": 1, "DEGENERATE": 3, "UNDECIDED": 3}


def add(commands: Commands) -> None:
    """Describe the command."""
    parser = add_command(
        commands,
        "verify",
        "prove or refute that the curvature of the boundary is continuous",
        "rsym verify skeleton --set a2=5.32:8 -o report.png",
        run,
    )
    add_model(parser, "a value that comes first; a2=5.32:8 asks for every value between")
    add_revolve(parser)
    parser.add_argument("--json", action="store_true", help="print the report as JSON")
    parser.add_argument("-o", "--output", metavar="FILE", help="a picture of the verdict: .png, .svg or .pdf")


def run(options: argparse.Namespace) -> int:
    """Verify, say what is proved, and answer with the exit code of the verdict."""
    from rsym.output.pictures import picture_suffix, write_picture
    from rsym.output.verdicts import plot_verdict
    from rsym.verify.smoothness import verify_smoothness

    if options.output is not None:
        picture_suffix(options.output)
    options.set, intervals = ranges(options.set, "--set")
    shape = load_shape(options)
    report = verify_smoothness(shape, letters=intervals)
    if options.output is not None:
        write_picture(plot_verdict(report, shape), options.output)
    print(report.to_json() if options.json else report)
    return CODES[report.verdict]
