"""Statements of MATLAB that say nothing of a shape: housekeeping, grids of points, drawing."""

from __future__ import annotations

import re
from typing import NamedTuple

HOUSEKEEPING = ("clear", "clearvars", "clc", "close", "format", "more")
DRAWING = (
    *("figure", "hold", "axis", "contour", "contourf", "contour3", "surf", "surfc", "mesh", "meshc", "plot", "plot3"),
    *("fimplicit", "fimplicit3", "ezplot", "isosurface", "patch", "colorbar", "colormap", "shading", "title"),
    *("xlabel", "ylabel", "zlabel", "legend", "view", "camlight", "lighting", "print", "saveas", "drawnow", "grid"),
    *("subplot", "set", "disp", "fprintf", "pause"),
)
UNSUPPORTED = ("while", "if", "else", "elseif", "function", "switch", "try", "return", "global")

# To the end of the statement; a semicolon in brackets or in a text does not end it.
# Nothing is tried twice: a text without its bracket must not be searched for ever.
_GOES_ON = r"\.\.\.[^\n]*\n"
_BRACKETS = rf"\((?:{_GOES_ON}|[^()\n]|\((?:{_GOES_ON}|[^()\n])*+\))*+\)"
_REST = rf"""(?:"[^"\n]*"|'[^'\n]*'|{_BRACKETS}|\[(?:{_GOES_ON}|[^\]\n])*+\]|{_GOES_ON}|[^;\n%#"'(\[])*+"""
_NUMBER = r"[-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]+)?"
_WORDS = re.compile(rf"({'|'.join((*HOUSEKEEPING, *DRAWING))})\b(?![ \t]*=(?!=))({_REST})")
_GRID = re.compile(rf"\[([^\]\n]*)\][ \t]*=[ \t]*(meshgrid|ndgrid)\b({_REST})")
_RUN = re.compile(
    rf"([A-Za-z]\w*)[ \t]*=[ \t]*(?:linspace\b{_REST}"
    rf"|\[?{_NUMBER}[ \t]*:[ \t]*{_NUMBER}(?:[ \t]*:[ \t]*{_NUMBER})?\]?(?=[ \t]*(?:[;\n%#]|$)))"
)
_ENDS = re.compile(
    rf"({_NUMBER})[ \t]*:(?:[ \t]*{_NUMBER}[ \t]*:)?[ \t]*({_NUMBER})"
    rf"|linspace\([ \t]*({_NUMBER})[ \t]*,[ \t]*({_NUMBER})"
)


class Passed(NamedTuple):
    """Where a statement ends, and what to tell whoever wrote it."""

    end: int
    note: str = ""


def passed_over(text: str, position: int) -> Passed | None:
    """The statement that begins here, if it is one that says nothing of a shape.

    Examples
    --------
    >>> passed_over("clear all; w = x", 0)
    Passed(end=9, note='')
    >>> passed_over("[x, y] = meshgrid(-5:0.1:5, -4:0.1:4);", 0).note
    'meshgrid is passed over, rsym takes its own points; the box of pictures is said by: bounds x [-5, 5] y [-4, 4]'
    >>> passed_over("w = x", 0)
    """
    if found := _WORDS.match(text, position):
        word = found.group(1)
        note = f"{word} is passed over: a model says what a shape is; rsym fields and rsym mesh draw it"
        return Passed(found.end(), "" if word in HOUSEKEEPING else note)
    if found := _GRID.match(text, position):
        names = re.findall(r"\w+", found.group(1))
        return Passed(found.end(), _said(found.group(2), names, found.group(3)))
    if found := _RUN.match(text, position):
        return Passed(found.end(), _said(f"a row of values of {found.group(1)}", [found.group(1)], found.group()))
    return None


def _said(what: str, names: list[str], text: str) -> str:
    ends = [tuple(filter(None, groups)) for groups in _ENDS.findall(text)]
    if len(ends) == 1 < len(names):
        ends *= len(names)  # meshgrid(v) is meshgrid(v, v)
    known = len(ends) == len(names)
    box = zip(names, ends, strict=True) if known else zip(("x", "y"), (("-5", "5"),) * 2, strict=True)
    example = " ".join(f"{name.lower()} [{low}, {high}]" for name, (low, high) in box)
    return f"{what} is passed over, rsym takes its own points; the box of pictures is said by: bounds {example}"
