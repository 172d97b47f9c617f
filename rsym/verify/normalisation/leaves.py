"""Where omega is one of its leaves: all along its boundary but at corners and edges, to the order its operations keep.

On f = 0 < g the R-operations that keep an order m of normalisation have the derivatives of f along the normal up to
that order: R_0 to the first, R_p below p, min and max to any. So omega is normalised there if f is, however near a
corner; at f = g = 0 it has no gradient. Where the gradients of f and g are nowhere parallel on a box, the common zeros
are a point at most in the plane, a curve in space: all other points of the boundary belong to one leaf alone.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
import sympy as sp

from rsym.analysis.contracts.table import promise
from rsym.arrays import Flags, Floats
from rsym.model.nodes import ZeroWith
from rsym.program.lowering import lower_all
from rsym.verify.boxes.local import Model

Ends = tuple[Floats, Floats]
ROUNDING = 1e-15  # of the sum of the sizes: three float64 operations round by less


@dataclass(frozen=True)
class LeafGate:
    """A conjunction (sign 1) or disjunction (-1) of leaves, by their numbers, and of others."""

    sign: int
    operands: tuple[LeafGate | int, ...]


def leaves_of(model: Model, expression: sp.Expr, order: int) -> tuple[LeafGate | int, list[int]]:
    """How leaves make up a function as far as its operations keep an order, and the node of each occurrence of one.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> shape = rsym.Shape(rsym.conjunction(x, -rsym.conjunction(y, 1 - x)), (x, y))
    >>> leaves_of(Model(shape, {}), shape.expression, 1)[0]
    LeafGate(sign=1, operands=(0, LeafGate(sign=-1, operands=(1, 2))))
    >>> leaves_of(Model(shape, {}), shape.expression, 2)[0]
    0
    """
    found: list[sp.Expr] = []

    def joined(part: sp.Expr, sign: int) -> LeafGate | int:
        while part.is_Mul and part.args[0] == -1 and len(part.args) == 2:
            part, sign = part.args[1], -sign
        if isinstance(part, ZeroWith):
            return joined(part.args[1], sign)
        made = promise(part)
        if made.truth in (min, max) and made.order([order] * len(made.operands)) == order:
            meets = 1 if made.truth is min else -1
            return LeafGate(sign * meets, tuple(joined(operand, sign) for operand in made.operands))
        found.append(part if sign > 0 else -part)
        return len(found) - 1

    tree = joined(expression, 1)
    return tree, [model.root] if isinstance(tree, int) else lower_all(model.builder, found)


def active(tree: LeafGate | int, ends: Sequence[Ends]) -> Flags:
    """Which occurrences of leaves may make up the boundary in a box, (n, occurrences), by bounds of each.

    Examples
    --------
    >>> of = lambda low, high: (np.array([low]), np.array([high]))
    >>> active(LeafGate(1, (0, 1)), [of(-1.0, 1.0), of(2.0, 3.0)])
    array([[ True, False]])
    """
    flags = np.zeros((len(ends[0][0]), len(ends)), bool)

    def over(part: LeafGate | int) -> Ends:
        if isinstance(part, int):
            return ends[part]
        lower, upper = zip(*map(over, part.operands), strict=True)
        pick = np.minimum if part.sign > 0 else np.maximum
        return pick.reduce(lower), pick.reduce(upper)

    def walk(part: LeafGate | int, needed: Flags) -> None:
        if isinstance(part, int):
            flags[:, part] = needed
            return
        for operand in part.operands:
            lower, upper = over(operand)
            walk(operand, needed & ~((lower > 0) | (upper < 0)))

    lower, upper = over(tree)
    walk(tree, ~((lower > 0) | (upper < 0)))
    return flags


def crosses(first: Floats, second: Floats) -> Flags:
    """On which boxes two gradients, by the ends of their components (2, dim, n), are nowhere parallel and nowhere zero.

    Examples
    --------
    >>> east, turned = np.array([[[1.0], [0.0]], [[2.0], [0.1]]]), np.array([[[-0.5], [0.5]], [[0.5], [1.0]]])
    >>> crosses(east, turned), crosses(east, east)
    (array([ True]), array([False]))
    """
    found = np.zeros(first.shape[-1], bool)
    for a, b in combinations(range(first.shape[1]), 2):
        one, other = _product(first[:, a], second[:, b]), _product(first[:, b], second[:, a])
        slack = ROUNDING * np.abs([*one, *other]).sum(axis=0)
        found |= (one[0] - other[1] > slack) | (other[0] - one[1] > slack)
    return found


def _product(a: Floats, b: Floats) -> tuple[Floats, Floats]:
    products = [x * y for x in a for y in b]
    return np.minimum.reduce(products), np.maximum.reduce(products)
