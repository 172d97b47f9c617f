"""Rows of R_0**m, the operations of R_0 times r**m for m >= 1, and of their derivatives: monomials of f, g and r."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import sympy as sp

from rsym.model.rnodes import R0mConjunction, R0mDisjunction
from rsym.program.powers import at_least_one, power, root, smallest, whole_power
from rsym.program.program import Node
from rsym.program.r0 import r0_expansion, r0_meaning, versine_expansion, versine_meaning
from rsym.program.row import Admissible, Expansion, Given, Nodes, Operation, Rule, nonzero, summed

TINY = 5e-324  # the smallest positive float64


def _meaning(sign: int) -> Callable[..., Any]:
    """(f + g + sign*r)*r**m with r = sqrt(f**2 + g**2); a product too small for float64 keeps its sign."""

    def meaning(np: Any, f: Any, g: Any, m: Any) -> Any:
        plain = r0_meaning(sign)(np, f, g)
        value = plain * np.float_power(np.sqrt(np.square(f) + np.square(g)), np.where(m >= 1, m, np.nan))
        return np.where((plain == 0) | (value == 0), np.sign(plain) * TINY, value)

    return meaning


def _partial_meaning(np: Any, f: Any, g: Any, m: Any) -> Any:
    """(1 - f/r)*r**m + m*f*(f + g - r)*r**(m - 2) with r = sqrt(f**2 + g**2); 0 at r = 0."""
    size, m = np.sqrt(np.square(f) + np.square(g)), np.where(m >= 1, m, np.nan)
    first = versine_meaning(np, f, g) * np.float_power(size, m)
    return np.where(size == 0, size, first + m * (f / size) * r0_meaning(-1)(np, f, g) * np.float_power(size, m - 1))


def _monomial_meaning(np: Any, f: Any, g: Any, m: Any, powers: tuple[int, int, int]) -> Any:
    """f**a * g**b * r**(m + c) with r = sqrt(f**2 + g**2); at r = 0 its limit 0, or NaN if there is none."""
    a, b, c = powers
    size, degree = np.sqrt(np.square(f) + np.square(g)), m + (a + b + c)
    value = np.float_power(f / size, a) * np.float_power(g / size, b) * np.float_power(size, degree)
    return np.where(size == 0, np.where(degree > 0, 0.0, np.nan), value)


def _expansion(sign: int) -> Expansion:
    """The operation of R_0 times r**m; a product too small for the number format keeps its sign."""

    def expansion(b: Nodes, node: Node) -> int:
        f, g, m = node.arguments
        plain, zero, tiny = r0_expansion(sign)(b, f, g), b.const(0), smallest(b)
        product = b.mul(plain, power(b, root(b, f, g), at_least_one(b, m, m)))
        kept = b.select(plain, zero, tiny, b.select(zero, plain, b.neg(tiny), plain))
        return b.select(b.abs(product), zero, product, b.select(b.abs(plain), zero, at_least_one(b, m, kept), plain))

    return expansion


def _partial_expansion(b: Nodes, node: Node) -> int:
    """(1 - f/r) r**m + m (f/r) (f + g - r) r**(m - 1): where f, g > 0 nothing cancels."""
    f, g, m = node.arguments
    m = at_least_one(b, m, m)
    size = root(b, f, g)
    first = b.mul(versine_expansion(b, f, g), power(b, size, m))
    less = power(b, size, b.sub(m, b.const(1)))
    second = b.mul(b.mul(m, b.div(f, size)), b.mul(r0_expansion(-1)(b, f, g), less))
    return b.select(size, b.const(0), b.add(first, second), size)


def _monomial_expansion(b: Nodes, node: Node) -> int:
    """(f/r)**a (g/r)**b r**(m + a + b + c), which neither overflows early nor is 0/0 at r = 0."""
    assert isinstance(node.data, tuple)
    (f, g, m), (first, second, rest) = node.arguments, node.data
    size, degree = root(b, f, g), b.add(m, b.const(first + second + rest))
    value = power(b, size, degree)
    for operand, exponent in ((f, first), (g, second)):
        value = b.mul(whole_power(b, b.div(operand, size), exponent), value)
    limit = b.select(degree, b.const(0), b.const(0), b.undefined())
    return b.select(size, b.const(0), value, b.add(limit, size))


def _derivative(sign: int) -> Rule:
    """(1 - f/r) r**m + m f (f + g - r) r**(m - 2) and f and g exchanged; for the disjunction at (-f, -g)."""

    def rule(b: Nodes, number: int, node: Node, d: Given) -> int:
        f, g, m = node.arguments
        u, v = (f, g) if sign < 0 else (b.neg(f), b.neg(g))
        first, second = b.make("r0m_partial", u, v, m), b.make("r0m_partial", v, u, m)
        return b.add(b.mul(first, d[0]), b.mul(second, d[1]))

    return rule


def _partial(b: Nodes, number: int, node: Node, d: Given) -> int:
    """The derivative of r**m - (m + 1) f r**(m - 1) + m (f**2 + f g) r**(m - 2), term by term.

    Every term is homogeneous of degree m - 1, so for m > 1 the sum goes to 0 at the corner.
    """
    f, g, m = node.arguments
    factors = (b.const(1), b.neg(b.add(m, b.const(1))), m, m)
    total = b.const(0)
    for factor, exponents in zip(factors, ((0, 0, 0), (1, 0, -1), (2, 0, -2), (1, 1, -2)), strict=True):
        term = b.make("monomial", f, g, m, data=exponents)
        total = b.add(total, b.mul(factor, _monomial(b, term, b.nodes[term], d)))
    return total


def _monomial(b: Nodes, number: int, node: Node, d: Given) -> int:
    """The derivative of f**i g**j r**(m + c): three monomials of one degree less."""
    assert isinstance(node.data, tuple)
    (f, g, m), (i, j, rest) = node.arguments, node.data

    def partial(own: int, lowered: tuple[int, int, int], more: tuple[int, int, int]) -> int:
        outer = b.mul(b.add(m, b.const(rest)), b.make("monomial", f, g, m, data=more))
        return b.add(b.mul(b.const(own), b.make("monomial", f, g, m, data=lowered)), outer) if own else outer

    along_f = partial(i, (i - 1, j, rest), (i + 1, j, rest - 2))
    along_g = partial(j, (i, j - 1, rest), (i, j + 1, rest - 2))
    return b.add(b.mul(along_f, d[0]), b.mul(along_g, d[1]))


def _jump(b: Nodes, number: int, node: Node, jumps: Given) -> int:
    """No partial derivative is larger than (2 + 3 m) r**m."""
    f, g, order = node.arguments
    total = summed(b, jumps[:2])
    size = b.add(b.sqrt(b.add(b.square(f), b.square(g))), total)
    slope = b.mul(b.add(b.const(2), b.mul(b.const(3), order)), b.absolute_power(size, order))
    return b.mul(slope, total)


def _monomial_formula(f: sp.Expr, g: sp.Expr, m: sp.Expr, powers: tuple[int, int, int]) -> sp.Expr:
    """f**a * g**b * r**(m + c), its limit at r = 0."""
    a, b, c = powers
    squares = f**2 + g**2
    limit = sp.Piecewise((0, m + a + b + c > 0), (sp.S.NaN, True))
    return sp.Piecewise((f**a * g**b * squares ** ((m + c) / 2), squares > 0), (limit, True))


def _partial_formula(f: sp.Expr, g: sp.Expr, m: sp.Expr) -> sp.Expr:
    """The derivative of the conjunction of R_0^m with respect to f, 0 at f = g = 0."""
    squares = f**2 + g**2
    size = sp.sqrt(squares)
    partial = (1 - f / size) * size**m + m * f * (f + g - size) * size ** (m - 2)
    return sp.Piecewise((partial, squares > 0), (0, True))


def _operation(sign: int) -> Operation:
    kind = R0mConjunction if sign < 0 else R0mDisjunction
    return Operation(
        3,
        _meaning(sign),
        _expansion(sign),
        _derivative(sign),
        _jump,
        formula=lambda f, g, m: kind(m, f, g),
        parameter=Admissible(1, closed=True),
        analytic=(nonzero(0, 1),),
        strict=True,
        symmetric=True,
        logic="and" if sign < 0 else "or",
        zeros=("00", "0+", "+0") if sign < 0 else ("00", "0-", "-0"),
    )


R0M: dict[str, Operation] = {
    "r0m_conjunction": _operation(-1),
    "r0m_disjunction": _operation(1),
    "r0m_partial": Operation(
        3,
        _partial_meaning,
        _partial_expansion,
        _partial,
        formula=_partial_formula,
        parameter=Admissible(1, closed=True),
        analytic=(nonzero(0, 1),),
        strict=True,
        zeros=("00", "+0"),
    ),
    "monomial": Operation(  # data: (a, b, c)
        3,
        _monomial_meaning,
        _monomial_expansion,
        _monomial,
        formula=_monomial_formula,
        domain=(nonzero(0, 1),),
        analytic=(nonzero(0, 1),),
    ),
}
