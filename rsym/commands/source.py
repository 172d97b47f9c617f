"""`rsym source`: the program of a model in another language."""

from __future__ import annotations

import argparse

from rsym.commands.options import (
    Commands,
    add_command,
    add_model,
    add_output,
    add_revolve,
    add_system,
    explain,
    load_shape,
)

GROUP = "models"


def add(commands: Commands) -> None:
    """Describe the command."""
    parser = add_command(
        commands,
        "source",
        "print a model as source text of another language, with its derivatives",
        "rsym source car --language javascript --fields value,gradient -o car.mjs",
        run,
    )
    add_model(parser)
    add_system(parser)
    add_revolve(parser)
    explain(parser.add_argument("--language", required=True, metavar="LANGUAGE"), "%(known)s", _languages)
    parser.add_argument(
        "--fields",
        default="value",
        metavar="FIELDS",
        help="what the function gives, as rsym.compile has it: value,gradient,hessian (default: value)",
    )
    parser.add_argument(
        "--constants", action="store_true", help="the letters as numbers in the text, not as arguments of the function"
    )
    add_output(parser, "write the text there (default: print it)")


def run(options: argparse.Namespace) -> None:
    """Print the text, or write it."""
    from rsym.atomic import write_atomically
    from rsym.backends.source import source

    fields = [name.strip() for name in options.fields.split(",")]
    text = source(load_shape(options), options.language, fields, letters="constants" if options.constants else None)
    if options.output is None:
        print(text, end="")
    else:
        print(write_atomically(options.output, text.encode()))


def _languages() -> str:
    from rsym.backends.source import KNOWN

    return f"{', '.join(KNOWN[:-1])} or {KNOWN[-1]}"
