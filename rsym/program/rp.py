"""Rows of R_p: f + g -+ n with the norm n = (|f|**p + |g|**p)**(1/p), for p > 1, and of the norm itself.

n falls as p grows: its logarithm has the derivative -(entropy of the two shares)/p**2. R_p grows with f and g, for
1 -+ (|f|/n)**(p - 1) >= 0; a conjunction grows with p, a disjunction falls.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import sympy as sp

from rsym.model.powers import absolute_power, signed_power
from rsym.model.rnodes import RpConjunction, RpDisjunction
from rsym.program.powers import (
    expm1,
    log1p,
    power,
    radical,
    signed_like,
    sizes,
    where_above,
    where_fails,
    whole,
    whole_power,
)
from rsym.program.program import Node
from rsym.program.row import (
    DOWN,
    UP,
    UP_IN_SIZE,
    Admissible,
    Expansion,
    Given,
    Nodes,
    Operation,
    Rule,
    homogeneous,
    lipschitz,
    nonzero,
)


def norm_meaning(np: Any, f: Any, g: Any, p: Any) -> Any:
    """(|f|**p + |g|**p)**(1/p), without overflow."""
    both = np.abs(f), np.abs(g)
    small, large = np.minimum(*both), np.maximum(*both)
    value = large * np.float_power(1 + np.float_power(small / large, p), 1 / p)
    return np.where((large == 0) | np.isinf(large), large, value)


def _meaning(sign: int) -> Callable[..., Any]:
    """F + g + sign*(|f|**p + |g|**p)**(1/p); min or max where that root is 0 or infinite or the sign would be lost."""

    def meaning(np: Any, f: Any, g: Any, p: Any) -> Any:
        p = np.where(p > 1, p, np.nan)
        swap = np.abs(f) > np.abs(g)
        large, small = np.where(swap, f, g), np.where(swap, g, f)
        excess = np.expm1(np.log1p(np.float_power(np.abs(small / large), p)) / p)
        value = small + np.where(sign * large < 0, -large * excess, large * (2 + excess))
        near = np.minimum(f, g) if sign < 0 else np.maximum(f, g)
        fails = (large == 0) | np.isinf(large) | ((np.sign(value) != np.sign(near)) & ~np.isnan(value))
        return np.where(fails & ~np.isnan(small + p), near, value)

    return meaning


def _versine_meaning(np: Any, f: Any, g: Any, p: Any) -> Any:
    """1 - sign(f)*(|f|/n)**(p - 1), n the norm."""
    ratio = np.float_power(np.abs(g / f), p)
    share = np.float_power(np.abs(f) / norm_meaning(np, f, g, p), p - 1)
    return np.where(f > np.abs(g), -np.expm1(-(p - 1) / p * np.log1p(ratio)), 1 - np.sign(f) * share)


def norm_expansion(b: Nodes, f: int, g: int, p: int) -> int:
    """M (1 + (m/M)**p)**(1/p), M the larger and m the smaller size."""
    small, large = sizes(b, f, g)
    value = b.mul(large, radical(b, b.add(b.const(1), power(b, b.div(small, large), p)), p))
    return where_fails(b, large, large, value)


def _expansion(sign: int) -> Expansion:
    """With b the larger in size and a the other: a - b e or a + b (2 + e), (|f|**p + |g|**p)**(1/p) = |b| (1 + e)."""

    def expansion(b: Nodes, node: Node) -> int:
        f, g, p = node.arguments
        p = where_above(b, p, 1, p)
        swap = (b.abs(f), b.abs(g))
        large, small = b.select(*swap, f, g), b.select(*swap, g, f)
        excess = _excess(b, power(b, b.abs(b.div(small, large)), p), p)
        differs = b.sub(small, b.mul(large, excess))
        adds = b.add(small, b.mul(large, b.add(b.const(2), excess)))
        zero = b.const(0)
        value = b.select(large, zero, differs, adds) if sign < 0 else b.select(zero, large, differs, adds)
        near = b.make("min" if sign < 0 else "max", f, g)
        return where_fails(b, b.abs(large), near, signed_like(b, near, value))

    return expansion


def _excess(b: Nodes, s: int, p: int) -> int:
    """(1 + s)**(1/p) - 1 for s >= 0; for an integer p it is s/(1 + q + ... + q**(p - 1)) with q = (1 + s)**(1/p)."""
    integer = whole(b, p)
    if integer is None:
        return expm1(b, b.div(log1p(b, s), p))
    return b.div(s, _geometric_sum(b, radical(b, b.add(b.const(1), s), p), integer))


def _geometric_sum(b: Nodes, q: int, terms: int) -> int:
    """1 + q + ... + q**(terms - 1)."""
    result = b.const(1)
    for _ in range(terms - 1):
        result = b.add(b.const(1), b.mul(q, result))
    return result


def _versine_expansion(b: Nodes, node: Node) -> int:
    """1 - sign(f)(|f|/n)**(p - 1); where f > |g| by way of (1 + s)**(1/p) - 1, s = |g/f|**p, free of cancellation."""
    f, g, p = node.arguments
    ratio = power(b, b.abs(b.div(g, f)), p)
    integer, less = whole(b, p), b.sub(p, b.const(1))
    if integer is None:
        close = b.neg(expm1(b, b.neg(b.mul(b.div(less, p), log1p(b, ratio)))))
    else:
        q = radical(b, b.add(b.const(1), ratio), p)
        sums = [_geometric_sum(b, q, terms) for terms in (integer - 1, integer)]
        close = b.div(b.mul(ratio, sums[0]), b.mul(sums[1], whole_power(b, q, integer - 1)))
    share = power(b, b.div(b.abs(f), norm_expansion(b, f, g, p)), less)
    plain = b.select(f, b.const(0), b.sub(b.const(1), share), b.add(b.const(1), share))
    return b.select(f, b.abs(g), close, plain)


def _norm(b: Nodes, number: int, node: Node, d: Given) -> int:
    """sign(f)(|f|/n)**(p - 1) f' + sign(g)(|g|/n)**(p - 1) g'."""
    f, g, p = node.arguments
    less = b.sub(p, b.const(1))
    u, v = (b.signed_power(b.div(operand, number), less) for operand in (f, g))
    return b.add(b.mul(u, d[0]), b.mul(v, d[1]))


def _derivative(sign: int) -> Rule:
    """1 + s sign(f)(|f|/n)**(p - 1), and f and g exchanged."""

    def rule(b: Nodes, number: int, node: Node, d: Given) -> int:
        f, g, p = node.arguments
        u, v = (f, g) if sign < 0 else (b.neg(f), b.neg(g))
        first, second = b.make("rp_versine", u, g, p), b.make("rp_versine", v, f, p)
        return b.add(b.mul(first, d[0]), b.mul(second, d[1]))

    return rule


def _versine(b: Nodes, number: int, node: Node, d: Given) -> int:
    """(p - 1)|c|**(p - 2) sign(s)|s|**(p - 1) (c g' - s f')/n with c = f/n, s = g/n, n the norm."""
    f, g, p = node.arguments
    size = b.make("norm", f, g, p)
    c, s, less = b.div(f, size), b.div(g, size), b.sub(p, b.const(1))
    factor = b.mul(b.absolute_power(c, b.sub(p, b.const(2))), b.signed_power(s, less))
    return b.div(b.mul(b.mul(less, factor), b.sub(b.mul(c, d[1]), b.mul(s, d[0]))), size)


def stretch(ratio: Any, p: Any) -> Any:
    """log((1 + ratio**p)**(1/p)) at a point."""
    return (ratio**p).log1p() / p


def _conjunction_at(f: Any, g: Any, p: Any) -> Any:
    """B the larger in size and a the other: a - b e or a + b (2 + e) with norm = |b| (1 + e)."""
    small, large = (f, g) if abs(f) <= abs(g) else (g, f)
    excess = 0 * small if small.is_zero() else stretch(abs(small / large), p).expm1()
    return small - large * excess if large > 0 else small + large * (2 + excess)


def norm_formula(f: sp.Expr, g: sp.Expr, p: sp.Expr) -> sp.Expr:
    """The norm in SymPy."""
    return (absolute_power(f, p) + absolute_power(g, p)) ** (1 / p)


def _operation(sign: int) -> Operation:
    kind = RpConjunction if sign < 0 else RpDisjunction
    return Operation(
        3,
        _meaning(sign),
        _expansion(sign),
        _derivative(sign),
        lipschitz(2),
        homogeneous,
        lambda f, g, p: kind(p, f, g),
        grows=(UP, UP, UP if sign < 0 else DOWN),
        at=_conjunction_at if sign < 0 else lambda f, g, p: -_conjunction_at(-f, -g, p),
        rounding="sum",
        parameter=Admissible(1),
        analytic=(nonzero(0), nonzero(1)),
        analytic_even=(nonzero(0, 1),),
        strict=True,
        symmetric=True,
        homogeneous=True,
        logic="and" if sign < 0 else "or",
        zeros=("00", "0+", "+0") if sign < 0 else ("00", "0-", "-0"),
    )


RP: dict[str, Operation] = {
    "norm": Operation(
        3,
        norm_meaning,
        lambda b, node: norm_expansion(b, *node.arguments),
        _norm,
        lipschitz(1),
        homogeneous,
        norm_formula,
        grows=(UP_IN_SIZE, UP_IN_SIZE, DOWN),
        parameter=Admissible(0),
        analytic=(nonzero(0), nonzero(1)),
        analytic_even=(nonzero(0, 1),),
        strict=True,
        nonnegative=True,
        symmetric=True,
        homogeneous=True,
        parity="even",
        zeros=("00",),
    ),
    "rp_conjunction": _operation(-1),
    "rp_disjunction": _operation(1),
    "rp_versine": Operation(
        3,
        _versine_meaning,
        _versine_expansion,
        _versine,
        formula=lambda f, g, p: 1 - signed_power(f, p - 1) / norm_formula(f, g, p) ** (p - 1),
        domain=(nonzero(0, 1),),
        parameter=Admissible(1),
        analytic=(nonzero(0), nonzero(1)),
        strict=True,
        nonnegative=True,
        zeros=("+0",),
    ),
}
