"""Rows of R_0 and of what else is made of one square root: versine, gap, trimming, normalisation.

Monotone by the partial derivatives, r = sqrt(f**2 + g**2): R_0 has 1 -+ f/r >= 0; gap and trimming fall with t and grow
with |s|; versine falls with f and moves away from 1 as |g| falls; normalised grows with f and goes to 0 as q grows.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from typing import Any

import sympy as sp

from rsym.model.rnodes import R0Conjunction, R0Disjunction
from rsym.program.powers import high, low, root, where_fails
from rsym.program.program import Node
from rsym.program.row import (
    DOWN,
    HALF,
    SELF,
    UP,
    UP_IN_SIZE,
    Far,
    Given,
    Nodes,
    Operation,
    Rule,
    homogeneous,
    lipschitz,
    nonnegative,
    nonzero,
    positive,
    raised,
    summed,
    within,
)


def r0_meaning(sign: int) -> Callable[..., Any]:
    """F + g + sign*sqrt(f**2 + g**2) without cancellation; min or max where the root is 0 or infinite."""

    def meaning(np: Any, f: Any, g: Any) -> Any:
        f, g = np.asarray(f), np.asarray(g)
        least, most = np.minimum(f, g), np.maximum(f, g)
        size, total = np.sqrt(f * f + g * g), f + g
        if sign < 0:
            value = np.where(total > 0, 2 * least * (most / (total + size)), total - size)
        else:
            value = np.where(total < 0, 2 * most * (least / (total - size)), total + size)
        return np.where((size == 0) | np.isinf(size), least if sign < 0 else most, value)

    return meaning


def pair(b: Nodes, sign: int, f: int, g: int, size: int, divisor: int) -> int:
    """(f + g + s r)/d where the sum does not cancel, else 2 m (M/(f + g - s r)), m the operand that decides.

    Both forms are equal where r**2 = (f + g)**2 - 2 d f g.
    """
    total = b.add(f, g)
    near, far = (low(b, f, g), high(b, f, g)) if sign < 0 else (high(b, f, g), low(b, f, g))
    signed_root = size if sign > 0 else b.neg(size)
    product = b.mul(b.mul(b.const(2), near), b.make("div", far, b.sub(total, signed_root)))
    plain = b.div(b.add(total, signed_root), divisor)
    zero = b.const(0)
    value = b.select(total, zero, product, plain) if sign < 0 else b.select(zero, total, product, plain)
    return where_fails(b, size, near, value)


def r0_expansion(sign: int) -> Callable[[Nodes, int, int], int]:
    """The stable form."""
    return lambda b, f, g: pair(b, sign, f, g, root(b, f, g), b.const(1))


def _partials(sign: int) -> Rule:
    """(1 + s f/r) f' + (1 + s g/r) g'."""

    def rule(b: Nodes, number: int, node: Node, d: Given) -> int:
        f, g = node.arguments
        along_f = b.mul(b.make("versine", f if sign < 0 else b.neg(f), g), d[0])
        return b.add(along_f, b.mul(b.make("versine", g if sign < 0 else b.neg(g), f), d[1]))

    return rule


def _conjunction_at(f: Any, g: Any) -> Any:
    """2 f g/(f + g + r) does not cancel where f + g > 0."""
    total, radius = f + g, (f * f + g * g).sqrt()
    return 2 * f * g / (total + radius) if total > 0 else total - radius


def versine_meaning(np: Any, f: Any, g: Any) -> Any:
    """1 - f/sqrt(f**2 + g**2), one minus the cosine of the polar angle of (f, g)."""
    size = np.sqrt(f * f + g * g)
    return np.where(f > 0, (g / size) * (g / (size + f)), 1 - f / size)


def versine_expansion(b: Nodes, f: int, g: int) -> int:
    """(g/r) (g/(r + f)) where f > 0, else 1 - f/r."""
    size = root(b, f, g)
    product = b.mul(b.make("div", g, size), b.make("div", g, b.add(size, f)))
    return b.select(f, b.const(0), product, b.sub(b.const(1), b.make("div", f, size)))


def _versine(b: Nodes, number: int, node: Node, d: Given) -> int:
    """G (f g' - g f')/r**3, written with f/r and g/r, which cannot overflow."""
    f, g = node.arguments
    inverse = b.div(b.const(1), b.sqrt(b.add(b.square(f), b.square(g))))
    cosine, sine = b.mul(f, inverse), b.mul(g, inverse)
    return b.mul(b.mul(sine, inverse), b.sub(b.mul(cosine, d[1]), b.mul(sine, d[0])))


def _jump_of_versine(b: Nodes, number: int, node: Node, jumps: Given) -> int:
    """No partial derivative of 1 - f/r is larger than 1/r; the values lie in [0, 2]."""
    f, g = node.arguments
    return within(b, b.sqrt(b.add(b.square(f), b.square(g))), summed(b, jumps), 2)


def _gap_meaning(np: Any, s: Any, t: Any) -> Any:
    """(sqrt(t**2 + s**2) - t)/2."""
    size = np.sqrt(t * t + s * s)
    return np.where(t > 0, s * s / (2 * (size + t)), (size - t) / 2)


def _trimming_meaning(np: Any, s: Any, t: Any) -> Any:
    """sqrt(s + gap(s, t)**2), s the square of the trimmed function."""
    excess = _gap_meaning(np, s, t)
    return np.sqrt(s + excess * excess)


def _gap_expansion(b: Nodes, node: Node) -> int:
    """s**2/(2 (q + t)) where t > 0, else (q - t)/2."""
    s, t = node.arguments
    size = root(b, t, s)
    quotient = b.make("div", b.square(s), b.mul(b.const(2), b.add(size, t)))
    return b.select(t, b.const(0), quotient, b.mul(b.const(HALF), b.sub(size, t)))


def _gap(b: Nodes, number: int, node: Node, d: Given) -> int:
    """(s s'/2 - u t')/q with q = sqrt(t**2 + s**2), u the node."""
    s, t = node.arguments
    size = b.sqrt(b.add(b.square(t), b.square(s)))
    return b.div(b.sub(b.mul(b.mul(b.const(HALF), s), d[0]), b.mul(number, d[1])), size)


def _trimming(b: Nodes, number: int, node: Node, d: Given) -> int:
    """((1 + u s/q) s'/2 - (u**2/q) t')/rho with q = sqrt(t**2 + s**2), u = (q - t)/2, rho the node."""
    s, t = node.arguments
    gap = b.make("gap", s, t)
    ratio = b.div(gap, b.sqrt(b.add(b.square(t), b.square(s))))
    along_s = b.mul(b.mul(b.const(HALF), b.add(b.const(1), b.mul(ratio, s))), d[0])
    return b.div(b.sub(along_s, b.mul(b.mul(ratio, gap), d[1])), number)


def _gap_at(s: Any, t: Any) -> Any:
    radius = (t * t + s * s).sqrt()
    return s * s / (2 * (radius + t)) if t > 0 else (radius - t) / 2


def _trimming_at(s: Any, t: Any) -> Any:
    excess = _gap_at(s, t)
    return (s + excess * excess).sqrt()


def _gap_formula(s: sp.Expr, t: sp.Expr) -> sp.Expr:
    return (sp.sqrt(t**2 + s**2) - t) / 2


def _normalised_meaning(np: Any, f: Any, q: Any) -> Any:
    """f/sqrt(f**2 + q); where the root is 0 or infinite, the sign of f (NaN at f = 0)."""
    size = np.sqrt(f * f + q)
    return np.where((size == 0) | np.isinf(size), f / np.abs(f), f / size)


def _normalised_expansion(b: Nodes, node: Node) -> int:
    f, q = node.arguments
    size = b.sqrt(b.add(b.square(f), q))
    return where_fails(b, size, b.make("div", f, b.abs(f)), b.make("div", f, size))


def _normalised(b: Nodes, number: int, node: Node, d: Given) -> int:
    """(q f' - f q'/2)/(f**2 + q)**(3/2)."""
    f, q = node.arguments
    inverse = b.div(b.const(1), b.sqrt(b.add(b.square(f), q)))
    change = b.sub(b.mul(q, d[0]), b.mul(b.mul(b.const(Fraction(1, 2)), f), d[1]))
    return b.mul(change, b.powi(inverse, 3))


def _jump_of_normalised(b: Nodes, number: int, node: Node, jumps: Given) -> int:
    """f/r, r**2 = f**2 + q: for j_f < r/4 and j_q < r**2/4 r stays above half of it, and J <= 2 j_f/r + 2 j_q/r**2."""
    (f, q), (p, s) = node.arguments, jumps
    size = b.sqrt(b.add(b.square(f), q))
    return within(b, size, b.add(p, b.make("div", s, size)), 2)


def _far_normalised(b: Nodes, node: Node, parts: Sequence[Far]) -> Far:
    """f/sqrt(f**2 + q): q has twice the degree of f."""
    f, q = parts
    degree = max(f.degree, -(-q.degree // 2))
    return Far(b.normalised(raised(b, f, degree), raised(b, q, 2 * degree)), 0)


def _operation(sign: int) -> Operation:
    return Operation(
        2,
        r0_meaning(sign),
        lambda b, node: r0_expansion(sign)(b, *node.arguments),
        _partials(sign),
        lipschitz(2),
        homogeneous,
        R0Conjunction if sign < 0 else R0Disjunction,
        grows=(UP, UP),
        at=_conjunction_at if sign < 0 else lambda f, g: -_conjunction_at(-f, -g),
        rounding="root",
        analytic=(nonzero(0, 1),),
        strict=True,
        symmetric=True,
        homogeneous=True,
        logic="and" if sign < 0 else "or",
        zeros=("00", "0+", "+0") if sign < 0 else ("00", "0-", "-0"),
    )


R0: dict[str, Operation] = {
    "r0_conjunction": _operation(-1),
    "r0_disjunction": _operation(1),
    "versine": Operation(
        2,
        versine_meaning,
        lambda b, node: versine_expansion(b, *node.arguments),
        _versine,
        _jump_of_versine,
        formula=lambda f, g: 1 - f / sp.sqrt(f**2 + g**2),
        domain=(nonzero(0, 1),),
        analytic=(nonzero(0, 1),),
        strict=True,
        nonnegative=True,
        zeros=("+0",),
    ),
    "gap": Operation(
        2,
        _gap_meaning,
        _gap_expansion,
        _gap,
        lipschitz(1),
        homogeneous,
        _gap_formula,
        grows=(UP_IN_SIZE, DOWN),
        at=_gap_at,
        rounding="root",
        analytic=(nonzero(0, 1),),
        strict=True,
        nonnegative=True,
        homogeneous=True,
        parity="even",
        zeros=("00", "0+"),
    ),
    "trimming": Operation(
        2,
        _trimming_meaning,
        lambda b, node: b.sqrt(b.add(node.arguments[0], b.square(_gap_expansion(b, node)))),
        _trimming,
        formula=lambda s, t: sp.sqrt(s + _gap_formula(s, t) ** 2),
        grows=(UP, DOWN),
        at=_trimming_at,
        rounding="root",
        domain=(nonnegative(0),),
        analytic=(positive(SELF),),
        strict=True,
        nonnegative=True,
        zeros=("00", "0+"),
    ),
    "normalised": Operation(
        2,
        _normalised_meaning,
        _normalised_expansion,
        _normalised,
        _jump_of_normalised,
        _far_normalised,
        lambda f, q: f / sp.sqrt(f**2 + q),
        domain=((*nonzero(0), *positive(1)),),
        analytic=((*nonzero(0), *positive(1)),),
        strict=True,
        parity="odd",
        zeros=("0+",),
    ),
}
