"""Where in a model a formula stands: the part of the surface that it makes, and the definition that writes it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import sympy as sp

from rsym.model.shape import Shape
from rsym.model.symbols import postorder, real_symbol, substitute

LONGEST = 60  # characters of a formula in a message
MOST_PIECES = 60  # a formula of more is not written out: its text may be exponentially longer than it is stored


@dataclass(frozen=True)
class ModelPlace:
    """A formula of a model: its text, the part that it belongs to, the definition that writes it, and the line of that.

    What there is not is empty, or line 0; a letter is its own definition.

    Examples
    --------
    >>> str(ModelPlace("z - h5", "side windows", "fo1"))
    'side windows, fo1: z - h5'
    """

    formula: str
    part: str = ""
    definition: str = ""
    line: int = 0

    def __str__(self) -> str:
        names = ", ".join(dict.fromkeys(name for name in (self.part, self.definition) if name))
        line = f"line {self.line}, " if self.line else ""
        return f"{line}{names}: {self.formula}" if names else self.formula


def places_of(shape: Shape, wanted: Sequence[sp.Expr]) -> tuple[ModelPlace, ...]:
    """Where each formula, or its negation, stands in a shape: the smallest part and the first definition with it.

    Examples
    --------
    >>> import rsym
    >>> shape = rsym.loads('f = rfAND(1 - x^2, y) "window"; omega = rfOR(f, y - x)')
    >>> conjunction, difference = shape.expression.operands
    >>> [str(place) for place in places_of(shape, [conjunction.operands[1], difference])]
    ['window, f: y', 'omega: -x + y']
    """
    resolved: dict[sp.Basic, sp.Basic] = {}
    for name, value in shape.definitions:
        resolved[real_symbol(name)] = substitute(value, resolved)
    parts = _first(
        wanted, sorted(((set(postorder(value)), name) for name, value in shape.parts), key=lambda item: len(item[0]))
    )
    definitions = _first(wanted, [(set(postorder(value)), symbol.name) for symbol, value in resolved.items()])
    return tuple(
        ModelPlace(shortened(one), *names)
        for one, names in zip(wanted, zip(parts, definitions, strict=True), strict=True)
    )


def shortened(formula: sp.Expr) -> str:
    """A formula as text, a long one cut."""
    if len(postorder(formula)) > MOST_PIECES:
        return "..."
    written = text_of(formula)
    return written if len(written) <= LONGEST else f"{written[: LONGEST - 4]} ..."


def text_of(formula: sp.Expr) -> str:
    """A formula in the words of the model language."""
    plain: str = sp.sstr(formula)
    return plain.replace("Abs(", "abs(").replace("**", "^")


def _first(wanted: Sequence[sp.Expr], contents: Sequence[tuple[set[sp.Basic], str]]) -> list[str]:
    return [next((name for inside, name in contents if one in inside or -one in inside), "") for one in wanted]
