"""Expansion of the systems with a parameter, of equivalence and joining: in forms that keep the sign."""

from __future__ import annotations

from collections.abc import Callable

from rsym.program.builder import Builder
from rsym.program.powers import (
    expm1,
    high,
    log1p,
    low,
    power,
    radical,
    root,
    signed_like,
    smallest,
    where_fails,
    whole,
    whole_power,
)
from rsym.program.program import Node

Expansion = Callable[[Builder, Node], int]


def _pair(b: Builder, sign: int, f: int, g: int, root: int, divisor: int) -> int:
    """(f + g + s r)/d where the sum does not cancel, else 2 m (M/(f + g - s r)), m the operand that decides.

    Both forms are equal where r**2 = (f + g)**2 - 2 d f g.
    """
    total = b.add(f, g)
    near, far = (low(b, f, g), high(b, f, g)) if sign < 0 else (high(b, f, g), low(b, f, g))
    signed_root = root if sign > 0 else b.neg(root)
    product = b.mul(b.mul(b.const(2), near), b.make("div", far, b.sub(total, signed_root)))
    plain = b.div(b.add(total, signed_root), divisor)
    zero = b.const(0)
    value = b.select(total, zero, product, plain) if sign < 0 else b.select(zero, total, product, plain)
    return where_fails(b, root, near, value)


def _r0(sign: int) -> Expansion:
    def expansion(b: Builder, node: Node) -> int:
        f, g = node.arguments
        return _pair(b, sign, f, g, root(b, f, g), b.const(1))

    return expansion


def _r_alpha(sign: int) -> Expansion:
    """R = sqrt((f - alpha g)**2 + (1 - alpha**2) g**2), a sum of squares, which rounding cannot make negative.

    For alpha = 1 that is |f - g|, which is finite where f + g + r is not: there the operation is written as min, max.
    """

    def expansion(b: Builder, node: Node) -> int:
        f, g, alpha = node.arguments
        if b.value(alpha) == 1:
            return b.make("min" if sign < 0 else "max", f, g)
        alpha = _within(b, alpha, -1, _at_most(b, alpha, 1))
        rest = b.sqrt(b.mul(b.sub(b.const(1), alpha), b.add(b.const(1), alpha)))
        sheared = root(b, b.sub(f, b.mul(alpha, g)), b.mul(rest, g))
        return _pair(b, sign, f, g, sheared, b.add(b.const(1), alpha))

    return expansion


def _versine(b: Builder, node: Node) -> int:
    """(g/r) (g/(r + f)) where f > 0, else 1 - f/r."""
    f, g = node.arguments
    size = root(b, f, g)
    product = b.mul(b.make("div", g, size), b.make("div", g, b.add(size, f)))
    return b.select(f, b.const(0), product, b.sub(b.const(1), b.make("div", f, size)))


def _within(b: Builder, number: int, low: int, value: int) -> int:
    """The value where the number is above `low`, else NaN."""
    return b.select(number, b.const(low), value, b.undefined())


def _at_most(b: Builder, number: int, high: int) -> int:
    return b.select(number, b.const(high), b.undefined(), number)


def _at_least_one(b: Builder, order: int, value: int) -> int:
    """The value where the order is 1 or more, else NaN."""
    return b.select(b.const(1), order, b.undefined(), value)


def _r0m(sign: int) -> Expansion:
    """The operation of R_0 times r**m; a product too small for the number format keeps its sign."""

    def expansion(b: Builder, node: Node) -> int:
        f, g, m = node.arguments
        plain, zero, tiny = _r0(sign)(b, Node("", (f, g))), b.const(0), smallest(b)
        product = b.mul(plain, power(b, root(b, f, g), _at_least_one(b, m, m)))
        kept = b.select(plain, zero, tiny, b.select(zero, plain, b.neg(tiny), plain))
        return b.select(b.abs(product), zero, product, b.select(b.abs(plain), zero, _at_least_one(b, m, kept), plain))

    return expansion


def _r0m_partial(b: Builder, node: Node) -> int:
    """(1 - f/r) r**m + m (f/r) (f + g - r) r**(m - 1): where f, g > 0 nothing cancels."""
    f, g, m = node.arguments
    m = _at_least_one(b, m, m)
    size, pair = root(b, f, g), Node("", (f, g))
    first = b.mul(_versine(b, pair), power(b, size, m))
    second = b.mul(b.mul(m, b.div(f, size)), b.mul(_r0(-1)(b, pair), power(b, size, b.sub(m, b.const(1)))))
    return b.select(size, b.const(0), b.add(first, second), size)


def _monomial(b: Builder, node: Node) -> int:
    """(f/r)**a (g/r)**b r**(m + a + b + c), which neither overflows early nor is 0/0 at r = 0."""
    assert isinstance(node.data, tuple)
    (f, g, m), (first, second, rest) = node.arguments, node.data
    size, degree = root(b, f, g), b.add(m, b.const(first + second + rest))
    value = power(b, size, degree)
    for operand, exponent in ((f, first), (g, second)):
        value = b.mul(whole_power(b, b.div(operand, size), exponent), value)
    limit = b.select(degree, b.const(0), b.const(0), b.undefined())
    return b.select(size, b.const(0), value, b.add(limit, size))


def _norm(b: Builder, node: Node) -> int:
    """M (1 + (m/M)**p)**(1/p), M the larger and m the smaller size."""
    f, g, p = node.arguments
    small, large = _sizes(b, f, g)
    value = b.mul(large, radical(b, b.add(b.const(1), power(b, b.div(small, large), p)), p))
    return where_fails(b, large, large, value)


def _sizes(b: Builder, f: int, g: int) -> tuple[int, int]:
    """The smaller and the larger absolute value; both NaN if one is."""
    return b.make("min", b.abs(f), b.abs(g)), b.make("max", b.abs(f), b.abs(g))


def _rp(sign: int) -> Expansion:
    """With b the larger in size and a the other: a - b e or a + b (2 + e), (|f|**p + |g|**p)**(1/p) = |b| (1 + e)."""

    def expansion(b: Builder, node: Node) -> int:
        f, g, p = node.arguments
        p = _within(b, p, 1, p)
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


def _excess(b: Builder, s: int, p: int) -> int:
    """(1 + s)**(1/p) - 1 for s >= 0; for an integer p it is s/(1 + q + ... + q**(p - 1)) with q = (1 + s)**(1/p)."""
    integer = whole(b, p)
    if integer is None:
        return expm1(b, b.div(log1p(b, s), p))
    return b.div(s, _geometric_sum(b, radical(b, b.add(b.const(1), s), p), integer))


def _geometric_sum(b: Builder, q: int, terms: int) -> int:
    """1 + q + ... + q**(terms - 1)."""
    result = b.const(1)
    for _ in range(terms - 1):
        result = b.add(b.const(1), b.mul(q, result))
    return result


def _rp_versine(b: Builder, node: Node) -> int:
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
    share = power(b, b.div(b.abs(f), _norm(b, node)), less)
    plain = b.select(f, b.const(0), b.sub(b.const(1), share), b.add(b.const(1), share))
    return b.select(f, b.abs(g), close, plain)


def _joining(b: Builder, node: Node) -> int:
    """m/(1 + (m/M)**k)**(1/k), m the smaller and M the larger size, k the order; what rounds to 0 is m."""
    f, g, order = node.arguments
    order = _at_least_one(b, order, order)
    small, large = _sizes(b, f, g)
    value = b.div(small, radical(b, b.add(b.const(1), power(b, b.div(small, large), order)), order))
    return where_fails(b, large, small, signed_like(b, small, value))


def _equivalence(b: Builder, node: Node) -> int:
    f, g, _ = node.arguments
    size, zero = _joining(b, node), b.const(0)
    agree = b.select(g, zero, size, b.neg(size))
    return b.select(f, zero, agree, b.neg(agree))


def _absolute_power(b: Builder, node: Node) -> int:
    base, exponent = node.arguments
    return power(b, b.abs(base), exponent)


def _signed_power(b: Builder, node: Node) -> int:
    """sign(u)|u|**a; at u = 0 zero where a > 0, NaN elsewhere."""
    base, exponent = node.arguments
    size, zero = power(b, b.abs(base), exponent), b.const(0)
    at_zero = b.add(b.select(exponent, zero, zero, b.undefined()), base)
    return b.select(base, zero, size, b.select(zero, base, b.neg(size), at_zero))


SYSTEM_EXPANSIONS: dict[str, Expansion] = {
    "r0_conjunction": _r0(-1),
    "r0_disjunction": _r0(1),
    "r_alpha_conjunction": _r_alpha(-1),
    "r_alpha_disjunction": _r_alpha(1),
    "r0m_conjunction": _r0m(-1),
    "r0m_disjunction": _r0m(1),
    "versine": _versine,
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
