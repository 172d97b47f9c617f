"""Patches as the textbook writes them: blending functions on either side of a matrix of points."""

from __future__ import annotations

from collections.abc import Sequence

import sympy as sp

from rsym.model.abridging import symbol_names, weight
from rsym.model.symbols import symbols_of
from rsym.surfaces.blends.blend_families import blend_lines
from rsym.surfaces.blends.blending import HermiteBlend
from rsym.surfaces.functions.formulas import entries_of
from rsym.surfaces.functions.univariate import Univariate

DIGITS = 5
LONGEST = 60  # parts of an entry of a matrix
ROOM = 3600  # characters
BREAK = r" \\ "


def bicubic_latex(data: Univariate, blend_u: HermiteBlend, blend_v: HermiteBlend) -> str:
    r"""P = f(u)^T Q g(v) with the corner information Q and the blending functions."""
    g = "f" if blend_u == blend_v else "g"
    size = data.shape[0]
    entries = entries_of(data.expressions())
    rows = [[_point(entries[3 * (a * size + b) :][:3]) for b in range(size)] for a in range(size)]
    return _aligned([f"p(u, v) &= f(u)^T Q \\, {g}(v)", f"Q &= {_matrix(rows)}", *_blends(blend_u, blend_v, g)])


def coons_latex(corners: Univariate, lofts: Sequence[Univariate], blend_u: HermiteBlend, blend_v: HermiteBlend) -> str:
    """P = -(-1, f(u)^T) M (-1, g(v)) with the boundary information M: edges and ribbons first, then corners.

    `lofts` are those across u, functions of v, and those across v, functions of u.
    """
    g = "f" if blend_u == blend_v else "g"
    size = corners.shape[0]
    across_u, across_v = (_entries(one, name) for one, name in zip(lofts, ("v", "u"), strict=True))
    inner = _entries(corners, "t")
    rows = [["0", *across_v]] + [[across_u[a], *inner[a * size : (a + 1) * size]] for a in range(size)]
    formula = (
        rf"p(u, v) &= -\begin{{pmatrix}} -1 & f(u)^T \end{{pmatrix}} M \begin{{pmatrix}} -1 \\ {g}(v) \end{{pmatrix}}"
    )
    return _aligned([formula, f"M &= {_matrix(rows)}", *_blends(blend_u, blend_v, g)])


def _entries(curve: Univariate, parameter: str) -> list[str]:
    flat = [one.xreplace({sp.Symbol("t", real=True): sp.Symbol(parameter)}) for one in entries_of(curve.expressions())]
    return [_point(flat[k : k + 3]) for k in range(0, len(flat), 3)]


def _blends(blend_u: HermiteBlend, blend_v: HermiteBlend, g: str) -> list[str]:
    """The names of the functions, and the functions of both blends."""
    count = len(blend_u.functions)
    names = [f"{letter}_{{{end}}}" for letter in "FGH" for end in (0, 1)][:count]
    lines = [f"f &= ({', '.join(names)})^T", *blend_lines(blend_u.formulas)]
    if g == "f":
        return lines
    others = ", ".join(rf"\hat {name}" for name in names)
    return [*lines, f"g &= ({others})^T", *blend_lines(blend_v.formulas, r"\hat ")]


def _point(coordinates: Sequence[sp.Expr]) -> str:
    return f"({', '.join(_written(one) for one in coordinates)})"


def _written(expression: sp.Expr) -> str:
    """An expression, its long fractions as decimals; dots for a long one."""
    if weight(expression, LONGEST) > LONGEST:
        return r"\dots"
    long = {one: sp.Float(one, DIGITS) for one in expression.atoms(sp.Rational) if one.q > 10**DIGITS}
    text: str = sp.latex(expression.xreplace(long), symbol_names=symbol_names(symbols_of(expression)))
    return text


def _matrix(rows: Sequence[Sequence[str]]) -> str:
    return rf"\begin{{pmatrix}} {BREAK.join(' & '.join(row) for row in rows)} \end{{pmatrix}}"


def _aligned(lines: Sequence[str]) -> str:
    """Lines under each other; what would fill a page is left at its name, the longest first."""
    lines = list(lines)
    while sum(map(len, lines)) > ROOM:
        longest = max(range(len(lines)), key=lambda k: len(lines[k]))
        lines[longest] = lines[longest].partition("&=")[0] + r"&= \dots"
    return rf"$\displaystyle \begin{{aligned}} {BREAK.join(lines)} \end{{aligned}}$"
