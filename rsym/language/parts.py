"""Built pieces of a formula: exact numbers, other constants, and what depends on coordinates or letters."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import sympy as sp
from sympy.core.function import AppliedUndef

from rsym.language.exact import checked, division_by_zero
from rsym.language.extent import Extent, joined
from rsym.language.syntax import Position
from rsym.model.nodes import Held, RealNode
from rsym.model.symbols import real_symbol


@dataclass(frozen=True, slots=True)
class Built:
    """A piece: `exact` if it is rational, `number` if it is any constant, neither if it is open.

    `items` and `text` are those of a vector and of a quoted choice, which only pieces of shapes take.

    The expression of a constant is unevaluated throughout; `outer` wraps it so that SymPy cannot look inside.
    """

    expression: sp.Expr
    extent: Extent
    exact: Fraction | None = None
    number: float | None = None
    items: tuple[Built, ...] | None = None
    text: str | None = None

    @property
    def outer(self) -> sp.Expr:
        """The piece as it stands among open pieces."""
        return Held(self.expression) if self.number is not None and self.exact is None else self.expression


def exact_part(value: Fraction) -> Built:
    """A rational constant."""
    bits = value.numerator.bit_length() + value.denominator.bit_length()
    return Built(sp.Rational(value.numerator, value.denominator), Extent(bits=bits), value, float(value))


def symbol_part(name: str) -> Built:
    """A letter, a coordinate, or an assigned name that is shown as such."""
    return Built(real_symbol(name), Extent())


def vector_part(items: Sequence[Built]) -> Built:
    """A list of parts."""
    extent = joined((Extent(), *(item.extent for item in items)))
    return Built(sp.Tuple(*(item.outer for item in items)), extent, items=tuple(items))


def text_part(text: str) -> Built:
    """A quoted choice."""
    return Built(sp.Symbol(text), Extent(), text=text)


def constant_part(
    expression: sp.Expr, extent: Extent, place: Position, numeric: Callable[..., float], *numbers: Any
) -> Built:
    """A constant that is not rational, its approximate value numeric(*numbers)."""
    try:
        value = numeric(*numbers)
    except ZeroDivisionError:
        raise division_by_zero(place) from None
    except ValueError:
        raise place.refuse("this constant is not a real number", "not-real", "correct the formula") from None
    except OverflowError:
        value = math.inf
    if not math.isfinite(value):
        raise place.refuse("this constant is too large for float64", "number-too-large", "correct the formula")
    return Built(expression, extent, None, value)


def open_part(expression: sp.Expr, extent: Extent, place: Position) -> Built:
    """What SymPy made of an operation on open pieces; a number if the variables have cancelled.

    Such a number must leave here, lest the next operation make SymPy evaluate it.
    """
    if expression.is_Rational:
        return exact_part(checked(Fraction(int(expression.p), int(expression.q)), place))
    if not _varies(expression):
        raise place.refuse(
            f"coordinates and letters cancel and leave the constant {expression}",
            "constant",
            "write that constant, or correct the formula",
        )
    return Built(expression, extent)


def _varies(expression: sp.Expr) -> bool:
    """Whether there is a symbol in it or a node that SymPy does not look into; unlike is_number without recursion."""
    stack = [expression]
    while stack:
        part = stack.pop()
        if part.is_Symbol or isinstance(part, RealNode | AppliedUndef):
            return True
        stack.extend(part.args)
    return False
