"""The functions of the language: what they are to SymPy, and as plain numbers."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import sympy as sp

from rsym.model.nodes import Trimming
from rsym.model.systems import R0, R1, RSystem

SYSTEMS: dict[str, RSystem] = {"R0": R0, "R1": R1}


@dataclass(frozen=True)
class Operation:
    """One function, three times over; SymPy never evaluates `symbolic`, `exact` is there where rationals stay so.

    `sorts` says that SymPy puts the arguments into an order of its own.
    """

    symbolic: Callable[..., sp.Expr]
    numeric: Callable[..., float]
    exact: Callable[..., Fraction] | None = None
    sorts: bool = False


def operations(system: RSystem) -> dict[str, Operation]:
    """Every function by name, the logical ones in the given R-system."""
    both, either = _node(system.conjunction), _node(system.disjunction)
    return {
        **_ELEMENTARY,
        "rfAND": both,
        "conjunction": both,
        "rfOR": either,
        "disjunction": either,
        "trimming": _node(Trimming),
    }


def _node(build: Callable[..., sp.Expr]) -> Operation:
    """An R-node; its number is the node's own high-precision value."""
    return Operation(build, lambda *values: float(build(*map(sp.Float, values)).evalf()))


def _held_back(function: Any) -> Callable[..., sp.Expr]:
    """A SymPy function that does not start to simplify itself, which could take for ever."""
    return lambda *arguments: function(*arguments, evaluate=False)


_ELEMENTARY = {
    "abs": Operation(_held_back(sp.Abs), abs, abs),
    "min": Operation(_held_back(sp.Min), min, min, sorts=True),
    "max": Operation(_held_back(sp.Max), max, max, sorts=True),
    "sin": Operation(_held_back(sp.sin), math.sin),
    "cos": Operation(_held_back(sp.cos), math.cos),
    "tan": Operation(_held_back(sp.tan), math.tan),
    "exp": Operation(_held_back(sp.exp), math.exp),
    "log": Operation(_held_back(sp.log), math.log),
    "atan2": Operation(_held_back(sp.atan2), math.atan2),
}
