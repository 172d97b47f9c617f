"""`rsym letters`: the letters of a model as a table."""

from __future__ import annotations

import argparse
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from rsym.commands.options import Commands, add_command, add_model, load_model

if TYPE_CHECKING:
    from rsym.model.letters import Letter


GROUP = "models"


def add(commands: Commands) -> None:
    """Describe the command."""
    parser = add_command(
        commands,
        "letters",
        "list the letters of a model: value, range, unit, values of the variants, meaning",
        "rsym letters car --shape test1",
        run,
    )
    add_model(parser)


def run(options: argparse.Namespace) -> None:
    """Print the table: of all letters, or of those that the shape asked for needs."""
    chosen = load_model(options)
    print(letters_table(chosen.shape.letters if options.shape else chosen.letters, chosen.model.variants))


def letters_table(letters: Mapping[str, Letter], variants: Mapping[str, Mapping[str, Letter]]) -> str:
    """A row for each letter and a column for each variant; columns without an entry are left out.

    Examples
    --------
    >>> from rsym.model.letters import Letter
    >>> letters = {"a": Letter(5, minimum=1, maximum=10, doc="reach"), "b": Letter(0.5)}
    >>> print(letters_table(letters, {"wide": {"a": Letter(9)}}))
    letter  value  range    wide  meaning
    a       5      [1, 10]  9     reach
    b       0.5
    """
    heading = ["letter", "value", "range", "unit", *variants, "meaning"]
    rows = [
        [
            name,
            written(letter),
            letter.range,
            letter.unit,
            *(written(values[name]) if name in values else "" for values in variants.values()),
            letter.doc,
        ]
        for name, letter in letters.items()
    ]
    return aligned([heading, *rows]) if rows else "the model has no letters"


def written(letter: Letter) -> str:
    """The value of a letter, as short as it is exact to twelve digits."""
    return f"{float(letter.default):.12g}"


def aligned(rows: Sequence[Sequence[str]]) -> str:
    """Rows under a heading as text, each column as wide as its widest entry."""
    columns = [column for column in zip(*rows, strict=True) if any(column[1:])]
    widths = [max(map(len, column)) for column in columns]
    lines = zip(*columns, strict=True)
    return "\n".join("  ".join(map(str.ljust, line, widths)).rstrip() for line in lines)
