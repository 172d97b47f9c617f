"""Blends taken apart for meshes: the same sign and the same zero set, the operands under min and max.

Positive factors go as well.

A blend as a whole is one function, smooth on its fillet and with the edges of its
operands elsewhere. Taken apart, those edges lie between functions that are smooth.
"""

from __future__ import annotations

import sympy as sp

from rsym.model.blends.folds import BlendOperation
from rsym.model.blends.sardf import SardfOperation
from rsym.model.nodes import Scaled
from rsym.model.rnodes import ROperation
from rsym.model.symbols import postorder


def without_rounded_levels(expression: sp.Expr) -> sp.Expr:
    """An expression of the same sign wherever it is defined: SARDF operations with a number for a ratio as min and max.

    Their level lines are rounded, their zero set is not: it is that of min or max. In R-operations alone, for inside
    other operations their values count.

    Examples
    --------
    >>> from rsym import Sardf, conjunction, x, y
    >>> without_rounded_levels(conjunction(x, conjunction(x, y, system=Sardf())))
    conjunction(x, conjunction(x, y, system=R1))
    """

    def is_gate(part: sp.Basic) -> bool:
        return isinstance(part, SardfOperation) and all(one.is_number for one in part.parameters)

    parts = postorder(expression)
    if not any(is_gate(part) for part in parts):
        return expression
    done: dict[int, sp.Expr] = {}
    for part in parts:
        arguments = [done.get(id(argument), argument) for argument in part.args]
        if is_gate(part):
            done[id(part)] = part.gates(arguments[part.parameter_count :])
        elif (isinstance(part, ROperation) and not isinstance(part, BlendOperation)) or _is_scaled(part):
            same = all(new is old for new, old in zip(arguments, part.args, strict=True))
            done[id(part)] = part if same else part.func(*arguments)
    return done.get(id(expression), expression)


def with_gates(expression: sp.Expr) -> sp.Expr:
    """An expression of the same sign everywhere, in which no blend that R-operations combine is left whole.

    Examples
    --------
    >>> from rsym import Sardf, conjunction, x, y
    >>> with_gates(conjunction(x, conjunction(x, y, system=Sardf())))
    conjunction(x, conjunction(x, y, system=R1))
    """
    parts = postorder(expression)
    if not any(isinstance(part, BlendOperation | Scaled) for part in parts):
        return expression
    done: dict[int, sp.Expr] = {}
    for part in parts:
        arguments = [done.get(id(argument), argument) for argument in part.args]
        if isinstance(part, BlendOperation):
            done[id(part)] = part.gates(arguments[part.parameter_count :])
        elif isinstance(part, Scaled):
            done[id(part)] = arguments[0]
        elif isinstance(part, ROperation) or _is_scaled(part):
            same = all(new is old for new, old in zip(arguments, part.args, strict=True))
            done[id(part)] = part if same else part.func(*arguments)
    return done.get(id(expression), expression)


def _is_scaled(part: sp.Basic) -> bool:
    return bool(part.is_Mul) and len(part.args) == 2 and bool(part.args[0].is_Number)
