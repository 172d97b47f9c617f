"""Where omega is one of its leaves: all along its boundary but at corners and edges, to the order its operations keep.

On f = 0 < g the R-operations that keep an order m of normalisation have the derivatives of f along the normal up to
that order: R_0 to the first, R_p below p, min and max to any. So omega is normalised there if f is, however near a
corner; at f = g = 0 it has no gradient. Where the gradients of f and g are nowhere parallel on a box, the common zeros
are a point at most in the plane, a curve in space: all other points of the boundary belong to one leaf alone.
A composition that is normalised as a whole to order 1 has there the derivative of its leaf, normalised by itself.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations

import numpy as np
import sympy as sp

from rsym.analysis.contracts.table import known_compositions, promise
from rsym.analysis.differential import derivative
from rsym.arrays import Flags, Floats
from rsym.logic.gates import Gate, through
from rsym.logic.sign_form import Operand
from rsym.model.nodes import ZeroWith, without_zeros
from rsym.model.primitives.formulas import normalised
from rsym.model.symbols import real_symbol
from rsym.model.vectors import squared
from rsym.program.lowering import lower_all
from rsym.verify.boxes.local import Model

Ends = tuple[Floats, Floats]
ROUNDING = 1e-15  # of the sum of the sizes: three float64 operations round by less


PICK = {"min": np.minimum, "max": np.maximum}


def leaves_of(model: Model, expression: sp.Expr, order: int) -> tuple[tuple[Gate, ...], list[int]]:
    """The gates by which leaves make up a function as far as its operations keep an order, and each leaf's node.

    A leaf that stands in several places is as many leaves.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> shape = rsym.Shape(rsym.conjunction(x, -rsym.conjunction(y, 1 - x)), (x, y))
    >>> leaves_of(Model(shape, {}), shape.expression, 1)[0]
    (Gate(operation='max', first=1, second=2), Gate(operation='min', first=0, second=3))
    >>> leaves_of(Model(shape, {}), shape.expression, 2)[0]
    ()
    """
    found: list[sp.Expr] = []
    joined: list[tuple[str, Operand, Operand]] = []
    made: list[Operand] = []
    coordinates = [real_symbol(name) for name in model.builder.coordinates]
    stack: list[tuple[sp.Expr, int, int, sp.Expr | None]] = [(known_compositions(expression), 1, 0, None)]
    while stack:
        part, sign, count, length = stack.pop()
        if count:  # its operands are made
            meets = (promise(part).truth is min) == (sign > 0)
            first, *others = made[-count:]
            for other in others:
                joined.append(("min" if meets else "max", first, other))
                first = Operand(True, len(joined) - 1)
            made[-count:] = [first]
        elif part.is_Mul and part.args[0] == -1 and len(part.args) == 2:
            stack.append((part.args[1], -sign, 0, length))
        elif isinstance(part, ZeroWith):
            whole = _length(part, coordinates) if order == 1 and length is None else None
            stack.append((part.args[1] if whole is None else part.args[0], sign, 0, whole or length))
        elif _keeps(part, order):
            operands = promise(part).operands
            stack.append((part, sign, len(operands), None))
            stack += [(operand, sign, 0, length) for operand in reversed(operands)]
        else:
            made.append(Operand(False, len(found)))
            leaf = without_zeros(part if sign > 0 else -part)
            found.append(leaf if length is None else _normalised(leaf, coordinates, length))
    gates = tuple(Gate(op, *(operand.after(len(found)) for operand in operands)) for op, *operands in joined)
    return gates, lower_all(model.builder, found) if gates else [model.root]


def _normalised(part: sp.Expr, coordinates: Sequence[sp.Symbol], length: sp.Expr) -> sp.Expr:
    return normalised(part, squared(derivative(part, symbol) for symbol in coordinates), length)


def _length(part: ZeroWith, coordinates: Sequence[sp.Symbol]) -> sp.Expr | None:
    """The length with which the first operand was normalised to order 1 as a whole, if the second is that."""
    inner, made = part.args
    return next(
        (one for one in (sp.S.One, made.as_coeff_Mul()[0]) if made == _normalised(inner, coordinates, one)), None
    )


def _keeps(part: sp.Expr, order: int) -> bool:
    """Whether a part is a conjunction or disjunction that keeps an order of normalisation."""
    made = promise(part)
    return made.truth in (min, max) and made.order([order] * len(made.operands)) == order


def active(gates: Sequence[Gate], ends: Sequence[Ends]) -> Flags:
    """Which leaves may make up the boundary in a box, (n, leaves), by bounds of each.

    Examples
    --------
    >>> of = lambda low, high: (np.array([low]), np.array([high]))
    >>> active([Gate("min", 0, 1)], [of(-1.0, 1.0), of(2.0, 3.0)])
    array([[ True, False]])
    """

    def join(gate: Gate, first: Ends, second: Ends) -> Ends:
        pick = PICK[gate.operation]
        return pick(first[0], second[0]), pick(first[1], second[1])

    needed = [~((lower > 0) | (upper < 0)) for lower, upper in through(gates, ends, join)]
    for gate, own in zip(reversed(gates), reversed(needed), strict=False):  # from the top down
        needed[gate.first] &= own
        needed[gate.second] &= own
    return np.stack(needed[: len(ends)], axis=1)


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
