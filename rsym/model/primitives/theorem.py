"""Rvachev's theorem where the gradient can be written down."""

from __future__ import annotations

from typing import Any

import sympy as sp

from rsym.model.vectors import squared


def normalised(function: sp.Expr, squared: sp.Expr, length: Any = 1) -> sp.Expr:
    """L u/sqrt(u**2 + L**2 |grad u|**2): normalised to order 1 where u = 0 and grad u is not; at most L in size.

    `squared` is |grad u|**2 as a sum of terms that are visibly not negative;
    then a program holds the quotient as one operation.
    Source: Rvachev (1982).

    Examples
    --------
    >>> from rsym import x, y
    >>> normalised(x - y**2, 1 + 4 * y**2)
    (x - y**2)/sqrt(4*y**2 + (x - y**2)**2 + 1)
    """
    # In this order: SymPy would multiply a number into a sum that is not yet divided, and u would stand there no more.
    return length * (function / sp.sqrt(function**2 + length**2 * squared))


def by_differentiation(function: sp.Expr, coordinates: tuple[sp.Symbol, ...], length: Any = 1) -> sp.Expr:
    """The same of an analytic function, the gradient taken by SymPy.

    Examples
    --------
    >>> from rsym import x, y
    >>> by_differentiation(3 * x, (x, y))
    3*x/sqrt(9*x**2 + 9)
    """
    return normalised(function, squared(sp.diff(function, symbol) for symbol in coordinates), length)
