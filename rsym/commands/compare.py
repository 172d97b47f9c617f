"""`rsym compare`: designs side by side, each with what is proved of its curvature; or R-systems."""

from __future__ import annotations

import argparse
from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING

from rsym.commands.options import (
    Commands,
    add_command,
    add_model_name,
    add_output,
    add_revolve,
    load_model,
    load_shape,
    made_body,
    progress_bar,
    system_named,
)
from rsym.errors import RsymError

if TYPE_CHECKING:
    from rsym.commands.options import Chosen


GROUP = "proofs"


def add(commands: Commands) -> None:
    """Describe the command."""
    parser = add_command(
        commands,
        "compare",
        "compare designs by continuity, curvature, its variation and extrema",
        "rsym compare skeleton --letters blunt.json sharp.json -o designs.png",
        run,
    )
    add_model_name(parser)
    parser.add_argument(
        "--letters",
        nargs="+",
        metavar="FILE",
        help="one design each, as rsym.save_letters writes them (default: the variants of the model)",
    )
    parser.add_argument("--shape", metavar="NAME", help="another definition of the model than omega or the last")
    parser.add_argument(
        "--set", action="append", default=[], metavar="LETTER=VALUE", help="a value of all designs, before their own"
    )
    add_revolve(parser)
    parser.add_argument(
        "--systems",
        nargs="+",
        metavar="SYSTEM",
        help='R-systems instead of designs: class, order, operations, slope on the boundary; R0 R1 "Rp 4" "R0m 2"',
    )
    parser.add_argument("--json", action="store_true", help="print the table with all reports as JSON")
    add_output(parser, "a picture of the designs: .png, .svg, .pdf or .eps")


def run(options: argparse.Namespace) -> None:
    """Judge all designs and print the table."""
    from rsym.output.designs import plot_designs
    from rsym.output.pictures import picture_suffix, write_picture
    from rsym.verify.fairness.designs import compare_designs

    if options.output is not None:
        picture_suffix(options.output)
    if options.systems:
        print(_systems(options))
        return
    files = options.letters
    options.letters = options.variant = None
    chosen = load_model(options)
    designs = _files(chosen, files) if files else _variants(chosen)
    shape = made_body(chosen.shape, options)
    with progress_bar("design", "comparing") as progress:
        table = compare_designs(shape, designs, progress=progress)
    if options.output is not None:
        write_picture(plot_designs(table), options.output)
    print(table.to_json() if options.json else table)


def _systems(options: argparse.Namespace) -> str:
    """The table of R-systems, at the letters of one file if there is one."""
    from rsym.output.systems import compare_systems

    if options.output is not None or len(options.letters or ()) > 1:
        raise RsymError(
            "R-systems are compared in a table, at one choice of letters",
            code="designs",
            remedy="leave -o out, and give at most one file to --letters",
        )
    options.letters, options.variant = (options.letters or [None])[0], None
    systems = [system_named(text) for text in options.systems]
    shape = load_shape(options)
    with progress_bar("system", "comparing") as progress:
        table = compare_systems(shape, systems, progress=progress)
    return table.to_json() if options.json else str(table)


def _files(chosen: Chosen, files: list[str]) -> dict[str, dict[str, float]]:
    """The letters of each file that the shape needs, named by the file without its folder if that tells them apart."""
    from rsym.model.letters import Letters
    from rsym.output.models import load_letters
    from rsym.verify.fairness.designs import named

    letters, designs = Letters(chosen.model.letters), {}
    stems = Counter(Path(file).stem for file in files)
    for file in files:
        values = load_letters(file)
        with named(file):
            letters.changed(values)  # a file is written for the whole model: only what that does not know is refused
        name = Path(file).stem if stems[Path(file).stem] == 1 else file
        if name in designs:
            raise RsymError("this file is given twice", code="designs", where=file, remedy="give each design once")
        designs[name] = {key: value for key, value in values.items() if key in chosen.shape.letters}
    return designs


def _variants(chosen: Chosen) -> dict[str, dict[str, float]]:
    variants = chosen.model.variants
    if not variants:
        raise RsymError(
            "this model has no variants to compare",
            code="designs",
            where=str(chosen.path),
            remedy="give --letters with a file for each design; rsym.save_letters writes one",
        )
    needed = chosen.shape.letters
    return {
        variant: {name: float(letter.default) for name, letter in letters.items() if name in needed}
        for variant, letters in variants.items()
    }
