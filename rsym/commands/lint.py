"""`rsym lint`: what keeps a model from being normalised, with place and remedy."""

from __future__ import annotations

import argparse
from collections.abc import Mapping
from pathlib import Path

from rsym.commands.options import (
    Commands,
    add_command,
    add_model,
    add_revolve,
    add_system,
    load_model,
    load_shape,
    progress_bar,
)

GROUP = "proofs"


def add(commands: Commands) -> None:
    """Describe the command."""
    parser = add_command(
        commands,
        "lint",
        "look for leaves that are not normalised, faces in common, terms that saturate, letters out of range",
        "rsym lint car --set h5=4.9",
        run,
    )
    add_model(parser)
    add_system(parser)
    add_revolve(parser)
    parser.add_argument("--json", action="store_true", help="print the report as JSON")


def run(options: argparse.Namespace) -> int:
    """Lint; the exit code is 0 where nothing was found, 1 where something was."""
    from rsym.verify.lint.linting import lint
    from rsym.verify.lint.report import located

    shape = load_shape(options)
    with progress_bar("step", "linting") as progress:
        report = lint(shape, progress=progress)
    report = located(report, _lines(load_model(options).path))
    print(report.to_json() if options.json else report)
    return 0 if report.clean else 1


def _lines(path: Path) -> Mapping[str, int]:
    """The line of every letter and every definition of a model file."""
    from rsym.language.loading import read_text
    from rsym.language.parser import parse
    from rsym.language.syntax import Assignment, LetterStatement
    from rsym.language.vm import is_vm

    if is_vm(path):
        return {}  # it names no parts
    statements = parse(read_text(path))
    return {one.name: one.place.line for one in statements if isinstance(one, Assignment | LetterStatement)}
