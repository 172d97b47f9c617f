"""Operations whose operands have something in common.

An image over a box takes operands as independent, which is what makes u*u or u/|u| too wide. The few shapes that
lowering and differentiation make again and again are recognised here by their nodes and given a name.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

from rsym.program.program import Node

Relation = tuple[str, tuple[int, ...]]
ONE = Node("const", (), Fraction(1))


def relation(nodes: Sequence[Node], number: int) -> Relation | None:
    """The name and the nodes of a product or quotient with related operands, else None.

    ``square`` u**2; ``direction`` u/|u|; ``share`` f/sqrt(f**2 + g**2); ``norm_share`` f/(|f|**p + |g|**p)**(1/p);
    ``gap_share`` the gap of s and t over sqrt(t**2 + s**2).

    Examples
    --------
    >>> from rsym.program.builder import Builder
    >>> builder = Builder(("x",), ())
    >>> x = builder.input("x")
    >>> relation(builder.nodes, builder.div(x, builder.abs(x)))
    ('direction', (0,))
    """
    operation, arguments, _ = nodes[number]
    if operation == "mul":
        return _product(nodes, *arguments)
    return _quotient(nodes, *arguments) if operation == "div" else None


def _product(nodes: Sequence[Node], a: int, b: int) -> Relation | None:
    """a*a is a square; f*(1/sqrt(f**2 + g**2)) is a share of 1."""
    if a == b:
        return "square", (a,)
    for factor, other in ((a, b), (b, a)):
        if nodes[other].operation == "div" and nodes[nodes[other].arguments[0]] == ONE:
            leg = _other_leg(nodes, nodes[other].arguments[1], factor)
            if leg is not None:
                return "share", (factor, leg)
    return None


def _quotient(nodes: Sequence[Node], a: int, b: int) -> Relation | None:
    """u/|u| and |u|/u are signs; f over the root or norm of f and g, and a gap over its root, are shares of 1."""
    for size, value in ((a, b), (b, a)):
        if nodes[size].operation == "abs" and _bare(nodes, nodes[size].arguments[0]) == _bare(nodes, value):
            return "direction", (value,)
    leg = _other_leg(nodes, b, a)
    if leg is not None:
        return "share", (a, leg)
    if nodes[b].operation == "norm" and a in nodes[b].arguments[:2]:
        f, g, p = nodes[b].arguments
        return "norm_share", (a, g if a == f else f, p)
    if nodes[a].operation == "gap" and _other_leg(nodes, b, nodes[a].arguments[1]) == nodes[a].arguments[0]:
        return "gap_share", nodes[a].arguments
    return None


def _bare(nodes: Sequence[Node], number: int) -> int:
    return nodes[number].arguments[0] if nodes[number].operation == "neg" else number


def _other_leg(nodes: Sequence[Node], number: int, leg: int) -> int | None:
    """The g of a node sqrt(f**2 + g**2), f given."""
    total = nodes[nodes[number].arguments[0]] if nodes[number].operation == "sqrt" else None
    if total is None or total.operation != "add":
        return None
    terms = [nodes[term] for term in total.arguments]
    if any(term.operation != "mul" or term.arguments[0] != term.arguments[1] for term in terms):
        return None
    legs = [term.arguments[0] for term in terms]
    return legs[1 - legs.index(leg)] if leg in legs else None
