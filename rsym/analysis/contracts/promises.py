"""What a node of a formula promises of its value, given its operands."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TypeAlias

import sympy as sp

Order: TypeAlias = float | None  # a whole number, infinity for an exact distance, None where nothing is shown
Ends: TypeAlias = tuple[sp.Expr, sp.Expr]  # the lower and the upper end of an interval
Signs: TypeAlias = tuple[int, ...]


@dataclass(frozen=True)
class Singularity:
    """Where an operation is not analytic in its operands: the points at which all of `equations` vanish.

    equations: expressions, all zero together; continuity: k where the operation is of class C^k there, -1 where it is
    not continuous or has no value; operation: what loses smoothness.

    Examples
    --------
    >>> from rsym import x, y
    >>> Singularity((x, y), 0, "conjunction").generator
    x**2 + y**2
    """

    equations: tuple[sp.Expr, ...]
    continuity: int
    operation: str

    @property
    def generator(self) -> sp.Expr:
        """One expression whose zero set is the singular set: the equation, or the sum of the squares of several."""
        if len(self.equations) == 1:
            return self.equations[0]
        return sp.Add(*(equation**2 for equation in self.equations))


@dataclass(frozen=True)
class Promise:
    """What one node promises.

    operands : the expressions that the promise speaks of, in the order that all functions below take them
    through : what the node is smooth in, where that is more than the operands: Max(u, 0)**2 in u, a trimming in f**2
    law : the sign law in words; empty where there is none
    truth : the sign (-1, 0, 1) of the node from the signs of its operands, None where they do not decide it
    singular : where the node is not analytic in its operands
    order : the order of normalisation from those of the operands, at regular points of the boundary: off the singular
        sets, where one operand vanishes and its gradient does not
    exception : where, on the boundary, the order does not hold; empty if there is no such place
    monotone : +1 where the node never falls as this operand grows, -1 where it never grows, 0 where it does not depend
        on it, None where nothing is promised
    image : the ends of an interval that holds all values of the node, from the ends of its operands; an end that is
        undefined says nothing
    """

    operands: tuple[sp.Expr, ...]
    through: tuple[sp.Expr, ...] | None = None
    law: str = ""
    truth: Callable[[Signs], int | None] = lambda signs: None
    singular: tuple[Singularity, ...] = ()
    order: Callable[[Sequence[Order]], Order] = lambda orders: None
    exception: str = ""
    monotone: tuple[int | None, ...] = ()
    image: Callable[..., Ends] = lambda *ends: (sp.nan, sp.nan)


def weakest(*orders: Order) -> Order:
    """The least order; not shown if one is not, unless another is known to be 0.

    Examples
    --------
    >>> weakest(2, 1), weakest(1, None), weakest(0, None)
    (1, None, 0)
    """
    known = [order for order in orders if order is not None]
    least = min(known, default=math.inf)
    return least if len(known) == len(orders) or least == 0 else None
