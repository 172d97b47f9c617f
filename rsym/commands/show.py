"""`rsym show`: a model as it is understood, as text or as LaTeX, and what calculus makes of it."""

from __future__ import annotations

import argparse
import textwrap
from typing import TYPE_CHECKING

from rsym.commands.letters import written
from rsym.commands.options import Chosen, Commands, add_command, add_model, load_model
from rsym.errors import RsymError

if TYPE_CHECKING:
    from rsym.language.listing import Definition

WIDTH = 100  # characters in a line
DOCUMENT = r"""\documentclass{article}
\usepackage{amsmath}
\usepackage[margin=2cm]{geometry}
\allowdisplaybreaks
\begin{document}
\noindent %s
\begin{align*}
%s
\end{align*}
\end{document}"""


GROUP = "models"


def add(commands: Commands) -> None:
    """Describe the command."""
    parser = add_command(
        commands,
        "show",
        "print a model: coordinates, bounds, system, letters, and the formulas that the shape needs",
        "rsym show car --shape test4 --latex --field laplacian > car.tex",
        run,
    )
    add_model(parser)
    parser.add_argument(
        "--model",
        dest="model_file",
        action="store_true",
        help="a model file of the shape, operation by operation, as rsym.save writes it",
    )
    parser.add_argument("--latex", action="store_true", help="a LaTeX document instead of text")
    parser.add_argument(
        "--field",
        help="with --latex: gradient, laplacian, normalised, normalised_2, curvature ..., in named common parts",
    )


def run(options: argparse.Namespace) -> None:
    """Print the model."""
    from rsym.language.listing import definitions

    chosen = load_model(options)
    if options.model_file and (options.latex or options.field):
        raise RsymError("--model prints a model file, --latex a document", code="show", remedy="ask for one of them")
    if options.model_file:
        from rsym.language.writing import dumps

        print(dumps(chosen.shape), end="")
        return
    if options.field and options.field != "value":
        print(_field(chosen, options.field, options.latex))
        return
    formulas = definitions(chosen.path, shape=options.shape)
    print(
        _document(chosen, [one.latex.replace(" = ", " &= ", 1) for one in formulas])
        if options.latex
        else _text(chosen, formulas)
    )


def _text(chosen: Chosen, formulas: tuple[Definition, ...]) -> str:
    from rsym.language.functions import written_system

    shape = chosen.shape
    names = [symbol.name for symbol in shape.coordinates]
    box = [f"{name} [{low:g}, {high:g}]" for name, (low, high) in zip(names, shape.bounds or (), strict=False)]
    letters = [f"{name} = {written(letter)}" for name, letter in shape.letters.items()]
    parts = {
        "coordinates": " ".join(names),
        "bounds": "  ".join(box) or "none",
        "system": written_system(chosen.model.system),
        "letters": ", ".join(letters) or "none",
    }
    lines = [_wrapped(f"{name:<13}{text}", 13) for name, text in parts.items()]
    texts = [f"{one.name} = {one.expression}" + (f'  "{one.doc}"' if one.doc else "") for one in formulas]
    return "\n".join([*lines, "", *(_wrapped(text, 4) for text in texts)])


def _wrapped(text: str, indent: int) -> str:
    return textwrap.fill(text, WIDTH, subsequent_indent=" " * indent, break_long_words=False, break_on_hyphens=False)


def _field(chosen: Chosen, field: str, latex: bool) -> str:
    """The document of a derived field."""
    from rsym.analysis.latex import field_lines

    if not latex:
        raise RsymError("a field is shown as LaTeX", code="show", remedy="add --latex")
    return _document(chosen, field_lines(chosen.shape, field))


def _document(chosen: Chosen, lines: list[str]) -> str:
    from rsym.model.abridging import typeset_name

    shape = chosen.shape
    names = [typeset_name(symbol.name) for symbol in shape.coordinates]
    box = shape.bounds or ()
    places = [rf"${name} \in [{low:g}, {high:g}]$" for name, (low, high) in zip(names, box, strict=False)]
    letters = [f"${typeset_name(name)} = {written(letter)}$" for name, letter in shape.letters.items()]
    sentences = [", ".join(part) + "." for part in (places, letters) if part]
    return DOCUMENT % ("\n\n\\noindent ".join(sentences), "\\\\\n".join(lines))
