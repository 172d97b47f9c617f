"""Nodes made as they stand, at a cost that does not grow with what is below them.

SymPy looks every new node up in a cache. There an equal one that is not the same object is compared part by part, by
recursion and sharing forgotten: of formulas ten thousand levels deep that ends in an error.
"""

from __future__ import annotations

from functools import cache
from typing import Any

import sympy as sp

from rsym.model.nodes import RealNode
from rsym.model.symbols import symbols_inside


def unevaluated(kind: Any, *arguments: sp.Expr, symbols: frozenset[sp.Symbol] | None = None) -> sp.Expr:
    """A node of a class of SymPy or rsym over real arguments, nothing evaluated.

    symbols: those inside an R-node, where they are known.

    Examples
    --------
    >>> from rsym import x
    >>> unevaluated(sp.Add, x, x), unevaluated(sp.sin, sp.S.Zero)
    (x + x, sin(0))
    """
    if issubclass(kind, sp.Add | sp.Mul):
        return kind._from_args(arguments, True)
    node = sp.Expr.__new__(kind, *arguments)
    if kind is sp.Pow:
        node.is_commutative = True
        return node
    node.nargs = _argument_counts(kind, len(arguments))
    if issubclass(kind, RealNode):
        node._free_symbols = symbols_inside(arguments) if symbols is None else symbols
    else:
        # Asked now SymPy asks the arguments alone; asked later it would go down to the symbols.
        bool(node.is_commutative)
    return node


@cache
def _argument_counts(kind: Any, count: int) -> sp.Set:
    """What SymPy notes in each of its functions."""
    return kind(*(sp.Dummy(real=True) for _ in range(count)), evaluate=False).nargs
