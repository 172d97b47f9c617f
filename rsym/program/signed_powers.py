"""Rows of |u|**a and sign(u)*|u|**a."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from rsym.model.powers import absolute_power, signed_power
from rsym.program.powers import power
from rsym.program.program import Node
from rsym.program.row import Nodes, Operation, nonnegative, nonzero, positive
from rsym.program.sides import of_power


def _signed_meaning(np: Any, u: Any, a: Any) -> Any:
    """For a = 0 undefined at u = 0."""
    return np.where(u == 0, np.where(a > 0, 0.0, np.nan), np.sign(u) * np.float_power(np.abs(u), a))


def _signed_expansion(b: Nodes, node: Node) -> int:
    """At u = 0 zero where a > 0, NaN elsewhere."""
    base, exponent = node.arguments
    size, zero = power(b, b.abs(base), exponent), b.const(0)
    at_zero = b.add(b.select(exponent, zero, zero, b.undefined()), base)
    return b.select(base, zero, size, b.select(zero, base, b.neg(size), at_zero))


def _absolute(b: Nodes, number: int, node: Node, d: Sequence[int]) -> int:
    base, exponent = node.arguments
    return b.mul(b.mul(exponent, b.signed_power(base, b.sub(exponent, b.const(1)))), d[0])


def _signed(b: Nodes, number: int, node: Node, d: Sequence[int]) -> int:
    base, exponent = node.arguments
    return b.mul(b.mul(exponent, b.absolute_power(base, b.sub(exponent, b.const(1)))), d[0])


SIGNED_POWERS: dict[str, Operation] = {
    "absolute_power": Operation(
        2,
        lambda np, u, a: np.float_power(np.abs(u), a),
        lambda b, node: power(b, b.abs(node.arguments[0]), node.arguments[1]),
        _absolute,
        of_power,
        formula=absolute_power,
        domain=((*nonzero(0), *nonnegative(1)),),
        analytic=(nonzero(0),),
        nonnegative=True,
        parity="even",
        zeros=("0+",),
    ),
    "signed_power": Operation(
        2,
        _signed_meaning,
        _signed_expansion,
        _signed,
        of_power,
        formula=signed_power,
        domain=((*nonzero(0), *positive(1)),),
        analytic=(nonzero(0),),
        strict=True,
        parity="odd",
        zeros=("0+",),
    ),
}
