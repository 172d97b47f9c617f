"""From a program back to SymPy: what a node computes as an expression, R-nodes kept."""

from __future__ import annotations

from collections.abc import Sequence

import sympy as sp

from rsym.model.symbols import real_symbol
from rsym.program.operations import OPERATIONS
from rsym.program.program import Node, live


def raised(nodes: Sequence[Node], number: int) -> sp.Expr:
    """The expression that a node computes; equal parts are one object.

    Examples
    --------
    >>> from rsym.program.builder import Builder
    >>> b = Builder(("x", "y"), ("a",))
    >>> product = b.mul(b.input("a"), b.square(b.input("x")))
    >>> raised(b.nodes, b.make("r0_conjunction", product, b.input("y")))
    conjunction(a*x**2, y)
    """
    made: dict[int, sp.Expr] = {}
    for part in live(nodes, [number]):
        made[part] = raised_node(nodes[part], [made[argument] for argument in nodes[part].arguments])
    return made[number]


def raised_node(node: Node, inner: Sequence[sp.Expr]) -> sp.Expr:
    """The expression of one node, those of its arguments being given."""
    operation, _, data = node
    if operation == "const":
        return {"pi": sp.pi, "e": sp.E}[data] if isinstance(data, str) else sp.Rational(data)
    if operation == "input":
        return real_symbol(str(data))
    formula = OPERATIONS[operation].formula
    assert formula is not None, operation
    return formula(*inner) if data is None else formula(*inner, data)
