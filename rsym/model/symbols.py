"""The coordinates, and one meaning for one name.

Every quantity of a model is real. A symbol written without ``real=True`` is
replaced by the real one of the same name, so that x is x wherever it came from.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable
from typing import Any

import sympy as sp

from rsym.errors import RsymError
from rsym.model.traversal import symbols_of

x: sp.Symbol = sp.Symbol("x", real=True)
y: sp.Symbol = sp.Symbol("y", real=True)
z: sp.Symbol = sp.Symbol("z", real=True)
PLANE = (x, y)
SPACE = (x, y, z)


def real_symbol(name: str) -> sp.Symbol:
    """The real symbol of that name."""
    return sp.Symbol(name, real=True)


def real_replacements(expressions: Iterable[sp.Basic]) -> dict[sp.Symbol, sp.Symbol]:
    """What each symbol becomes so that a name stands for one real symbol.

    A symbol that is already real and alone with its name (a positive letter,
    say) keeps what it knows of itself.
    """
    by_name: dict[str, list[sp.Symbol]] = defaultdict(list)
    for symbol in symbols_of(*expressions):
        by_name[symbol.name].append(symbol)
    return {
        symbol: real_symbol(name)
        for name, alike in by_name.items()
        for symbol in alike
        if len(alike) > 1 or not symbol.is_real
    }


def as_expression(value: Any) -> sp.Expr:
    """A real SymPy expression; text is refused, since turning text into SymPy would run it."""
    try:
        expression = sp.sympify(value, strict=True)
    except (sp.SympifyError, TypeError) as error:
        raise RsymError(
            f"expected a SymPy expression or a number, got {type(value).__name__} {value!r}",
            code="expression",
            remedy="build it from symbols; for text use rsym.loads",
        ) from error
    if not isinstance(expression, sp.Expr):
        raise RsymError(f"expected a real expression, got {type(expression).__name__}", code="expression")
    return expression
