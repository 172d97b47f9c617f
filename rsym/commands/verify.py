"""`rsym verify`: is the curvature of the boundary continuous, and is it proved."""

from __future__ import annotations

import argparse
from collections.abc import Collection, Mapping

from rsym.commands.options import (
    Commands,
    add_command,
    add_model,
    add_output,
    add_revolve,
    add_system,
    add_timeout,
    load_shape,
    progress_bar,
    ranges,
)
from rsym.errors import RsymError

# Exit codes of the design: proved, refuted, neither.
CODES = {"CERTIFIED": 0, "REFUTED": 1, "DEGENERATE": 3, "UNDECIDED": 3}


GROUP = "proofs"


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
    add_system(parser)
    add_revolve(parser)
    parser.add_argument(
        "--method",
        choices=["auto", "space"],
        default="auto",
        help="auto: a body of revolution by its meridian; space: any body by boxes in space (default: auto)",
    )
    parser.add_argument("--json", action="store_true", help="print the report as JSON")
    add_output(parser, "a picture of the verdict: .png, .svg, .pdf or .eps")
    add_timeout(parser, "what is not settled by then counts as undecided")
    instead = parser.add_mutually_exclusive_group()
    instead.add_argument(
        "--normalisation",
        type=int,
        metavar="ORDER",
        help="verify instead that omega is normalised to this order on the boundary",
    )
    instead.add_argument(
        "--threshold",
        metavar="LETTER",
        help="bracket instead the value of a letter where the verdict changes, between LOW and HIGH of its --set",
    )


def run(options: argparse.Namespace) -> int:
    """Verify, say what is proved, and answer with the exit code of the verdict."""
    options.set, intervals = ranges(options.set, "--set")
    if options.threshold is not None:
        return _threshold(options, intervals)
    if options.normalisation is not None:
        return _normalisation(options, intervals)
    from rsym.output.pictures import picture_suffix, write_picture
    from rsym.output.verdicts import plot_verdict
    from rsym.verify.smoothness import verify_smoothness

    if options.output is not None:
        picture_suffix(options.output)
    shape = load_shape(options)
    with progress_bar("step", "verifying") as progress:
        report = verify_smoothness(
            shape, letters=intervals, method=options.method, timeout=options.timeout, progress=progress
        )
    if options.output is not None:
        write_picture(plot_verdict(report, shape), options.output)
    print(report.to_json() if options.json else report)
    return CODES[report.verdict]


def _threshold(options: argparse.Namespace, intervals: Mapping[str, tuple[float, float]]) -> int:
    """Bracket a letter; the exit code is 0, for both ends are proved."""
    from rsym.verify.threshold import smoothness_threshold

    name = options.threshold
    _refuse(options, "--threshold", intervals.keys() - {name})
    shape = load_shape(options)
    with progress_bar("verdict", "bracketing") as progress:
        found = smoothness_threshold(
            shape, name, between=intervals.get(name), timeout=options.timeout, progress=progress
        )
    print(found.to_json() if options.json else found)
    return 0


def _normalisation(options: argparse.Namespace, intervals: Mapping[str, tuple[float, float]]) -> int:
    """Verify the derivatives along the normal."""
    from rsym.verify.normalisation.normalisation import verify_normalisation

    _refuse(options, "--normalisation", intervals.keys())
    shape = load_shape(options)
    with progress_bar("step", "verifying") as progress:
        report = verify_normalisation(shape, options.normalisation, timeout=options.timeout, progress=progress)
    print(report.to_json() if options.json else report)
    return CODES[report.verdict]


def _refuse(options: argparse.Namespace, question: str, ranged: Collection[str]) -> None:
    """What only the verdict on smoothness can do."""
    if options.output is not None or ranged:
        what = "a range of " + ", ".join(sorted(ranged)) if ranged else "a picture"
        raise RsymError(f"{question} does not go with {what}", code="options", remedy=f"leave out {what}")
