r"""Equations as LaTeX: one line where it can be read, else a line for each named part."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence

import sympy as sp

from rsym.model.abridging import ROOM, abridged, weight
from rsym.model.equation import Equation
from rsym.model.folds import Fold
from rsym.model.names import symbol_names
from rsym.model.sharing import in_common_parts
from rsym.model.symbols import real_symbol
from rsym.model.traversal import substitute, symbols_of

MOST = 1800  # characters of an equation at a glance


def latex(shape: Equation) -> str:
    r"""The equation as LaTeX; where a model file named its parts, the definitions one by one.

    A formula of more parts than a line can take is written in named common parts.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> print(latex(rsym.Shape(rsym.conjunction(x, y), (x, y))))
    \omega\left(x, y\right) = x \wedge_0 y
    """
    if shape.definitions:
        return aligned(_definitions(shape))
    return written({title(shape): shape.expression}, taken=shape.letters)


def title(shape: Equation) -> str:
    """Omega of its coordinates."""
    return rf"\omega\left({', '.join(map(printed, shape.coordinates))}\right)"


def written(
    sides: Mapping[str, sp.Expr], known: Mapping[str, sp.Expr] | None = None, taken: Collection[str] = ()
) -> str:
    """Left sides and their expressions: one line if there is one and it is short, else common parts line by line."""
    if len(sides) == 1 and not known:
        ((left, expression),) = sides.items()
        if weight(expression, ROOM) <= ROOM:
            return f"{left} = {line(expression)}"
    return aligned(lines_of(sides, known, taken))


def lines_of(
    sides: Mapping[str, sp.Expr], known: Mapping[str, sp.Expr] | None = None, taken: Collection[str] = ()
) -> list[str]:
    """A line for each common part and each side, to be set one under the other."""
    parts, results = in_common_parts(list(sides.values()), known, taken)
    return [
        *(f"{printed(real_symbol(part.name))} &:= {line(part.expression)}" for part in parts),
        *(f"{left} &= {line(result)}" for left, result in zip(sides, results, strict=True)),
    ]


def known_parts(shape: Equation) -> dict[str, sp.Expr]:
    """The names of a model file and what they stand for, written out in coordinates and letters."""
    known: dict[sp.Symbol, sp.Expr] = {}
    for name, value in shape.definitions[:-1]:
        known[real_symbol(name)] = substitute(value, known)
    return {symbol.name: value for symbol, value in known.items()}


def at_a_glance(shape: Equation) -> list[str]:
    """The equation in lines of bounded length; what is left out is said."""
    if not shape.definitions:
        return _glimpse(title(shape), shape.expression, shape.letters)
    *parts, (_, last) = shape.definitions
    ending = _glimpse(title(shape), last, [*shape.letters, *(name for name, _ in parts)])
    room, shown = MOST - sum(map(len, ending)), list[str]()
    for number, (name, value) in enumerate(parts):
        text = f"{_name(name)} &= {line(value)}" if weight(value, ROOM) <= ROOM else f"{_name(name)} &= \\dots"
        room -= len(text)
        if room < 0:
            shown.append(rf"& \text{{and {len(parts) - number} more parts}}")
            break
        shown.append(text)
    return [*shown, ending[0].replace(" = ", " &= ", 1), *(f"& {text}" for text in ending[1:])]


def _glimpse(left: str, expression: sp.Expr, taken: Iterable[str]) -> list[str]:
    short, named = abridged(expression, [*taken])
    text = line(short)
    if len(text) > MOST:
        return [rf"{left} = \dots"]
    return [f"{left} = {text}", *(rf"{_name(part.name)}: \text{{{part.words}}}" for part in named)]


def aligned(lines: Sequence[str]) -> str:
    """Lines under each other."""
    return r"\begin{aligned}" + r"\\ ".join(lines) + r"\end{aligned}"


def _definitions(shape: Equation) -> list[str]:
    *parts, (_, last) = shape.definitions
    return [*(f"{_name(name)} &= {line(value)}" for name, value in parts), f"{title(shape)} &= {line(last)}"]


def _name(name: str) -> str:
    return printed(real_symbol(name))


def printed(expression: sp.Expr) -> str:
    """LaTeX with names as the source prints them."""
    text: str = sp.latex(expression, symbol_names=symbol_names(symbols_of(expression)))
    return text


def line(expression: sp.Expr) -> str:
    """The right side of an equation: the outer brackets of an R-operation are not needed."""
    text = printed(expression)
    return text.removeprefix(r"\left(").removesuffix(r"\right)") if isinstance(expression, Fold) else text
