"""A blend as a person writes it."""

from __future__ import annotations

from collections.abc import Sequence

import sympy as sp

from rsym.model.abridging import weight
from rsym.model.names import symbol_names
from rsym.model.traversal import symbols_of
from rsym.surfaces.blends.blend_families import F0, F1, G0, G1

LONGEST = 120  # parts of a formula that is written out


def blend_latex(formulas: Sequence[sp.Expr]) -> str:
    r"""One line for each function; a function may speak of those already known.

    Examples
    --------
    >>> from rsym.surfaces.blends.blend_families import LINEAR
    >>> print(blend_latex(LINEAR))
    $\displaystyle \begin{aligned} F_{0}(t) &= 1 - t \\ F_{1}(t) &= t \end{aligned}$
    """
    text = r" \\ ".join(blend_lines(formulas))
    return rf"$\displaystyle \begin{{aligned}} {text} \end{{aligned}}$"


def blend_lines(formulas: Sequence[sp.Expr], mark: str = "") -> list[str]:
    """The definition of each function, its name marked if there are others of that name."""
    names = [f"{mark}{letter}_{{{end}}}(t)" for letter in "FGH" for end in (0, 1)]
    return [f"{name} &= {_written(formula, mark)}" for name, formula in zip(names, formulas, strict=False)]


def _written(formula: sp.Expr, mark: str) -> str:
    if weight(formula, LONGEST) > LONGEST:
        return r"\dots"
    marks = {call: sp.Dummy(mark + _called(call)) for call in formula.atoms(F0, F1, G0, G1)}
    marked = formula.xreplace(marks)
    names = {**symbol_names(symbols_of(marked)), **{mark: mark.name for mark in marks.values()}}
    text: str = sp.latex(marked, symbol_names=names)
    return text


def _called(call: sp.Expr) -> str:
    letter, end = call.func.__name__.split("_")
    return f"{letter}_{{{end}}}({sp.latex(call.args[0])})"
