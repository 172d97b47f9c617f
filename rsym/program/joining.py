"""Rows of joining |f||g|/n and of equivalence, joining with signs; n = (|f|**m + |g|**m)**(1/m), for m >= 1.

Joining grows with |f|, |g| and m, for n falls as m grows.
"""

from __future__ import annotations

from typing import Any

from rsym.model.rnodes import Equivalence, Joining
from rsym.program.powers import at_least_one, power, radical, signed_like, sizes, where_fails
from rsym.program.program import Node
from rsym.program.row import UP, UP_IN_SIZE, Admissible, Given, Nodes, Operation, homogeneous, lipschitz, nonzero
from rsym.program.rp import stretch


def _joining_meaning(np: Any, f: Any, g: Any, m: Any) -> Any:
    """The smaller where that root is 0 or infinite or the quotient rounds to 0."""
    both = np.abs(f), np.abs(g)
    small, large = np.minimum(*both), np.maximum(*both)
    m = np.where(m >= 1, m, np.nan)
    value = small * np.float_power(1 + np.float_power(small / large, m), -1 / m)
    return np.where(((large == 0) | np.isinf(large) | (value == 0)) & ~np.isnan(m), small, value)


def _joining_expansion(b: Nodes, node: Node) -> int:
    """m/(1 + (m/M)**k)**(1/k), m the smaller and M the larger size, k the order; what rounds to 0 is m."""
    f, g, order = node.arguments
    order = at_least_one(b, order, order)
    small, large = sizes(b, f, g)
    value = b.div(small, radical(b, b.add(b.const(1), power(b, b.div(small, large), order)), order))
    return where_fails(b, large, small, signed_like(b, small, value))


def _equivalence_expansion(b: Nodes, node: Node) -> int:
    f, g, _ = node.arguments
    size, zero = _joining_expansion(b, node), b.const(0)
    agree = b.select(g, zero, size, b.neg(size))
    return b.select(f, zero, agree, b.neg(agree))


def _equivalence(b: Nodes, number: int, node: Node, d: Given) -> int:
    """sign(g)(|g|/n)**(m + 1) f', and f and g exchanged, n the norm of order m."""
    f, g, m = node.arguments
    size, more = b.make("norm", f, g, m), b.add(m, b.const(1))
    u, v = (b.signed_power(b.div(operand, size), more) for operand in (g, f))
    return b.add(b.mul(u, d[0]), b.mul(v, d[1]))


def _joining(b: Nodes, number: int, node: Node, d: Given) -> int:
    """sign(f)(|g|/n)**(m + 1) f', and f and g exchanged; no sign where an operand cannot be negative."""
    f, g, m = node.arguments
    size, more = b.make("norm", f, g, m), b.add(m, b.const(1))

    def partial(u: int, v: int) -> int:
        share = b.absolute_power(b.div(v, size), more)
        return share if b.nonnegative[u] else b.mul(b.signed_power(u, b.const(0)), share)

    u, v = partial(f, g), partial(g, f)
    return b.add(b.mul(u, d[0]), b.mul(v, d[1]))


def _joining_at(f: Any, g: Any, m: Any) -> Any:
    """For f, g >= 0: the smaller over (1 + (m/M)**k)**(1/k)."""
    small, large = f.min(g), f.max(g)
    return 0 * small if small.is_zero() else small * (-stretch(small / large, m)).exp()


JOINING: dict[str, Operation] = {
    "equivalence": Operation(
        3,
        lambda np, f, g, m: np.sign(f) * np.sign(g) * _joining_meaning(np, f, g, m),
        _equivalence_expansion,
        _equivalence,
        lipschitz(1),
        homogeneous,
        lambda f, g, m: Equivalence(m, f, g),
        parameter=Admissible(1, closed=True),
        analytic=(nonzero(0), nonzero(1)),
        analytic_even=(nonzero(0, 1),),
        strict=True,
        symmetric=True,
        homogeneous=True,
        parity="odd",
        zeros=("0*", "*0"),
    ),
    "joining": Operation(
        3,
        _joining_meaning,
        _joining_expansion,
        _joining,
        lipschitz(1),
        homogeneous,
        lambda f, g, m: Joining(m, f, g),
        grows=(UP_IN_SIZE, UP_IN_SIZE, UP),
        at=_joining_at,
        rounding="powers",
        parameter=Admissible(1, closed=True),
        analytic=(nonzero(0), nonzero(1)),
        strict=True,
        nonnegative=True,
        symmetric=True,
        homogeneous=True,
        parity="even",
        zeros=("0*", "*0"),
    ),
}
