"""Derivatives of the systems with a parameter, of equivalence and joining; parameters do not vary."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from rsym.program.builder import Builder
from rsym.program.program import Node

Rule = Callable[[Builder, int, Node, Sequence[int]], int]


def _sum_of_products(b: Builder, u: Sequence[int], v: Sequence[int]) -> int:
    return b.add(b.mul(u[0], v[0]), b.mul(u[1], v[1]))


def _r_alpha(sign: int) -> Rule:
    """(1 + s (f - alpha g)/r) f'/(1 + alpha) and the same with f and g exchanged: the versine of a sheared pair."""

    def rule(b: Builder, number: int, node: Node, d: Sequence[int]) -> int:
        f, g, alpha = node.arguments
        one = b.const(1)
        rest = b.sqrt(b.mul(b.sub(one, alpha), b.add(one, alpha)))

        def partial(u: int, v: int) -> int:
            sheared = b.sub(u, b.mul(alpha, v))
            return b.make("versine", sheared if sign < 0 else b.neg(sheared), b.mul(rest, v))

        return b.div(_sum_of_products(b, (partial(f, g), partial(g, f)), d), b.add(one, alpha))

    return rule


def _r0m(sign: int) -> Rule:
    """(1 - f/r) r**m + m f (f + g - r) r**(m - 2) and f and g exchanged; for the disjunction at (-f, -g)."""

    def rule(b: Builder, number: int, node: Node, d: Sequence[int]) -> int:
        f, g, m = node.arguments
        u, v = (f, g) if sign < 0 else (b.neg(f), b.neg(g))
        return _sum_of_products(b, (b.make("r0m_partial", u, v, m), b.make("r0m_partial", v, u, m)), d)

    return rule


def _r0m_partial(b: Builder, number: int, node: Node, d: Sequence[int]) -> int:
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


def _monomial(b: Builder, number: int, node: Node, d: Sequence[int]) -> int:
    """The derivative of f**i g**j r**(m + c): three monomials of one degree less."""
    assert isinstance(node.data, tuple)
    (f, g, m), (i, j, rest) = node.arguments, node.data

    def partial(own: int, lowered: tuple[int, int, int], raised: tuple[int, int, int]) -> int:
        outer = b.mul(b.add(m, b.const(rest)), b.make("monomial", f, g, m, data=raised))
        return b.add(b.mul(b.const(own), b.make("monomial", f, g, m, data=lowered)), outer) if own else outer

    along_f = partial(i, (i - 1, j, rest), (i + 1, j, rest - 2))
    along_g = partial(j, (i, j - 1, rest), (i, j + 1, rest - 2))
    return _sum_of_products(b, (along_f, along_g), d)


def _norm(b: Builder, number: int, node: Node, d: Sequence[int]) -> int:
    """sign(f)(|f|/n)**(p - 1) f' + sign(g)(|g|/n)**(p - 1) g'."""
    f, g, p = node.arguments
    less = b.sub(p, b.const(1))
    return _sum_of_products(b, [b.signed_power(b.div(u, number), less) for u in (f, g)], d)


def _rp(sign: int) -> Rule:
    """1 + s sign(f)(|f|/n)**(p - 1), and f and g exchanged."""

    def rule(b: Builder, number: int, node: Node, d: Sequence[int]) -> int:
        f, g, p = node.arguments
        u, v = (f, g) if sign < 0 else (b.neg(f), b.neg(g))
        return _sum_of_products(b, (b.make("rp_versine", u, g, p), b.make("rp_versine", v, f, p)), d)

    return rule


def _rp_versine(b: Builder, number: int, node: Node, d: Sequence[int]) -> int:
    """(p - 1)|c|**(p - 2) sign(s)|s|**(p - 1) (c g' - s f')/n with c = f/n, s = g/n, n the norm."""
    f, g, p = node.arguments
    size = b.make("norm", f, g, p)
    c, s, less = b.div(f, size), b.div(g, size), b.sub(p, b.const(1))
    factor = b.mul(b.absolute_power(c, b.sub(p, b.const(2))), b.signed_power(s, less))
    return b.div(b.mul(b.mul(less, factor), b.sub(b.mul(c, d[1]), b.mul(s, d[0]))), size)


def _equivalence(b: Builder, number: int, node: Node, d: Sequence[int]) -> int:
    """sign(g)(|g|/n)**(m + 1) f', and f and g exchanged, n the norm of order m."""
    f, g, m = node.arguments
    size, more = b.make("norm", f, g, m), b.add(m, b.const(1))
    return _sum_of_products(b, [b.signed_power(b.div(u, size), more) for u in (g, f)], d)


def _joining(b: Builder, number: int, node: Node, d: Sequence[int]) -> int:
    """sign(f)(|g|/n)**(m + 1) f', and f and g exchanged; no sign where an operand cannot be negative."""
    f, g, m = node.arguments
    size, more = b.make("norm", f, g, m), b.add(m, b.const(1))

    def partial(u: int, v: int) -> int:
        share = b.absolute_power(b.div(v, size), more)
        return share if b.nonnegative[u] else b.mul(b.signed_power(u, b.const(0)), share)

    return _sum_of_products(b, (partial(f, g), partial(g, f)), d)


def _absolute_power(b: Builder, number: int, node: Node, d: Sequence[int]) -> int:
    base, exponent = node.arguments
    return b.mul(b.mul(exponent, b.signed_power(base, b.sub(exponent, b.const(1)))), d[0])


def _signed_power(b: Builder, number: int, node: Node, d: Sequence[int]) -> int:
    base, exponent = node.arguments
    return b.mul(b.mul(exponent, b.absolute_power(base, b.sub(exponent, b.const(1)))), d[0])


SYSTEM_RULES: dict[str, Rule] = {
    "r_alpha_conjunction": _r_alpha(-1),
    "r_alpha_disjunction": _r_alpha(1),
    "r0m_conjunction": _r0m(-1),
    "r0m_disjunction": _r0m(1),
    "r0m_partial": _r0m_partial,
    "monomial": _monomial,
    "norm": _norm,
    "rp_conjunction": _rp(-1),
    "rp_disjunction": _rp(1),
    "rp_versine": _rp_versine,
    "equivalence": _equivalence,
    "joining": _joining,
    "absolute_power": _absolute_power,
    "signed_power": _signed_power,
}
