"""The functions of the language: what they are to SymPy, and as plain numbers."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from functools import partial
from typing import Any

import sympy as sp

from rsym.model.blends.rho import Rho
from rsym.model.blends.sardf import Sardf
from rsym.model.functions import FUNCTIONS
from rsym.model.nodes import Trimming
from rsym.model.operations import difference, equivalence, exclusive_or, implication, joining
from rsym.model.systems import R0, R1, R0m, RAlpha, Rp, RSystem

SYSTEMS: dict[str, RSystem] = {"R0": R0, "R1": R1}
# Systems with a parameter, and an example of it.
FAMILIES: dict[str, tuple[Callable[[Any], RSystem], str]] = {
    "Ralpha": (RAlpha, "0.5"),
    "R0m": (R0m, "2"),
    "Rp": (Rp, "4"),
    "Rho": (Rho, "0.2"),
    "Sardf": (Sardf, "0.5"),
}


def written_system(system: RSystem) -> str:
    """The system as a model file names it.

    Examples
    --------
    >>> written_system(R1), written_system(Rp(4))
    ('R1', 'Rp 4')
    """
    for word, known in SYSTEMS.items():
        if system == known:
            return word
    word, parameter = next(
        (word, system.parameters[0]) for word, (family, _) in FAMILIES.items() if family is type(system)
    )
    return f"{word} {float(parameter)!r}" if parameter.is_Float else f"{word} {parameter}"


@dataclass(frozen=True)
class TextFunction:
    """One function, three times over; SymPy never evaluates `symbolic`, `exact` is there where rationals stay so.

    Without `numeric` a call on constants stays as it is: a letter is hidden in it.
    `sorts` says that SymPy puts the arguments into an order of its own.
    """

    symbolic: Callable[..., sp.Expr]
    numeric: Callable[..., float] | None
    exact: Callable[..., Fraction] | None = None
    sorts: bool = False


def operations(system: RSystem) -> dict[str, TextFunction]:
    """Every function by name, the logical ones in the given R-system."""
    has_letter = any(parameter.free_symbols for parameter in system.parameters)

    def logical(build: Callable[..., sp.Expr]) -> TextFunction:
        return TextFunction(build, None) if has_letter else _node(build)

    both, either = logical(system.conjunction), logical(system.disjunction)
    return {
        **{
            name: TextFunction(_held_back(row.kind), row.number, row.exact, row.sorts)
            for name, row in FUNCTIONS.items()
        },
        "rfAND": both,
        "conjunction": both,
        "rfOR": either,
        "disjunction": either,
        "difference": logical(partial(difference, system=system)),
        "implication": logical(partial(implication, system=system)),
        "exclusive_or": logical(partial(exclusive_or, system=system)),
        "equivalence": _node(equivalence),
        "joining": _node(joining),
        "trimming": _node(Trimming),
    }


def _node(build: Callable[..., sp.Expr]) -> TextFunction:
    """An R-node; its number is the node's own high-precision value."""
    return TextFunction(build, lambda *values: float(build(*map(sp.Float, values)).evalf()))


def _held_back(function: Any) -> Callable[..., sp.Expr]:
    """A SymPy function that does not start to simplify itself, which could take for ever."""
    return lambda *arguments: function(*arguments, evaluate=False)
