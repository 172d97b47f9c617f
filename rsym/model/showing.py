"""A shape in a line of text, as an equation and as a table: short and quick, whatever its formula is."""

from __future__ import annotations

from html import escape

import sympy as sp

from rsym.model.abridging import abridged
from rsym.model.equation import Equation
from rsym.model.latex import aligned, at_a_glance, printed
from rsym.model.wording import within

MOST = 2000  # characters of a formula as text
LETTERS = 24  # of a shape that are written out
_IN_A_LINE = 8  # letters


def text(shape: Equation) -> str:
    """Shape(expression, coordinates, ...), its deep parts by name."""
    short, named = abridged(shape.expression, shape.letters)
    formula = sp.sstr(short)
    given = [
        formula if len(formula) <= MOST else f"{formula[:MOST]}...",
        f"({', '.join(symbol.name for symbol in shape.coordinates)})",
    ]
    if shape.letters:
        letters = [f"{name}: {float(letter.default):g}" for name, letter in shape.letters.items()]
        given.append(f"letters={{{', '.join(within(letters, 600))}}}")
    if shape.bounds:
        given.append(f"bounds={shape.bounds}")
    if shape.parts:
        given.append(f"parts: {', '.join(within([name for name, _ in shape.parts], 300))}")
    given += [f"{part.name}: {part.words}" for part in named]
    return f"Shape({', '.join(given)})"


def latex(shape: Equation) -> str:
    """The equation, the bounds and the letters for a notebook."""
    box = zip(map(printed, shape.coordinates), shape.bounds or (), strict=False)
    places = [rf"{name} \in [{low:g}, {high:g}]" for name, (low, high) in box]
    letters = [
        f"{printed(sp.Symbol(name))} = {float(letter.default):g}"
        for name, letter in list(shape.letters.items())[:LETTERS]
    ]
    if len(shape.letters) > LETTERS:
        letters.append(rf"\text{{and {len(shape.letters) - LETTERS} more letters}}")
    groups = [places, *(letters[start : start + _IN_A_LINE] for start in range(0, len(letters), _IN_A_LINE))]
    equation = at_a_glance(shape)
    lines = [r",\quad ".join(group) for group in groups if group]
    first = aligned(equation) if shape.definitions else r" \\ & ".join(equation)
    if not lines and (len(equation) == 1 or shape.definitions):
        return rf"$\displaystyle {first}$"
    whole = r" \\ & ".join([first, *lines])
    return rf"$\displaystyle \begin{{aligned}} & {whole} \end{{aligned}}$"


def table(shape: Equation) -> str:
    """The equation over the table of the letters."""
    letters = shape.letters.table(room=1500) if shape.letters else ""
    return f"<div>{escape(latex(shape), quote=False)}{letters}</div>"
