"""The operations of a program and their plain meaning on arrays.

This table is the truth: the interpreter evaluates with it, every backend is
tested against it, and every kernel is checked against it when it is built.
It shares no code with the expansion that the backends run on.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np

Array: TypeAlias = Any  # float64 arrays and scalars alike
TINY = 5e-324  # the smallest positive float64


@dataclass(frozen=True)
class Operation:
    """How many arguments, and what it means."""

    arity: int
    meaning: Callable[..., Any]


def select(a: Array, b: Array, yes: Array, no: Array) -> Array:
    """Return `yes` where a > b, elsewhere `no`."""
    return np.where(a > b, yes, no)


def r0(sign: int) -> Callable[[Array, Array], Array]:
    """F + g + sign*sqrt(f**2 + g**2) without cancellation; min or max where the root is 0 or infinite."""

    def meaning(f: Array, g: Array) -> Array:
        f, g = np.asarray(f), np.asarray(g)
        low, high = np.minimum(f, g), np.maximum(f, g)
        root, total = np.sqrt(f * f + g * g), f + g
        if sign < 0:
            value = np.where(total > 0, 2 * low * (high / (total + root)), total - root)
        else:
            value = np.where(total < 0, 2 * high * (low / (total - root)), total + root)
        return np.where((root == 0) | np.isinf(root), low if sign < 0 else high, value)

    return meaning


def versine(f: Array, g: Array) -> Array:
    """1 - f/sqrt(f**2 + g**2), one minus the cosine of the polar angle of (f, g)."""
    root = np.sqrt(f * f + g * g)
    return np.where(f > 0, (g / root) * (g / (root + f)), 1 - f / root)


def gap(s: Array, t: Array) -> Array:
    """(sqrt(t**2 + s**2) - t)/2."""
    root = np.sqrt(t * t + s * s)
    return np.where(t > 0, s * s / (2 * (root + t)), (root - t) / 2)


def trimming(s: Array, t: Array) -> Array:
    """sqrt(s + gap(s, t)**2), s the square of the trimmed function."""
    excess = gap(s, t)
    return np.sqrt(s + excess * excess)


def normalised(f: Array, q: Array) -> Array:
    """f/sqrt(f**2 + q); where the root is 0 or infinite, the sign of f (NaN at f = 0)."""
    root = np.sqrt(f * f + q)
    return np.where((root == 0) | np.isinf(root), f / np.abs(f), f / root)


def zero_with(f: Array, g: Array) -> Array:
    """The value of g, which goes to 0 where f does; 0 where f is, even if g is undefined."""
    return np.where(np.abs(f) > 0, g, f)


def r_alpha(sign: int) -> Callable[[Array, Array, Array], Array]:
    """(f + g + sign*r)/(1 + alpha), r**2 = f**2 + g**2 - 2*alpha*f*g; min or max where r is 0 or infinite."""

    def meaning(f: Array, g: Array, alpha: Array) -> Array:
        f, g, alpha = np.broadcast_arrays(f, g, np.where((alpha > -1) & (alpha <= 1), alpha, np.nan))
        low, high = np.minimum(f, g), np.maximum(f, g)
        near, far = (low, high) if sign < 0 else (high, low)
        root, total = np.hypot(f - alpha * g, np.sqrt((1 - alpha) * (1 + alpha)) * g), f + g
        cancels = sign * total < 0
        value = np.where(cancels, 2 * near * (far / (total - sign * root)), (total + sign * root) / (1 + alpha))
        fails = (f * f + g * g == 0) | np.isinf(f * f + g * g) | (alpha == 1)
        return np.where(fails & ~np.isnan(alpha), near, value)

    return meaning


def r0m(sign: int) -> Callable[[Array, Array, Array], Array]:
    """(f + g + sign*r)*r**m with r = sqrt(f**2 + g**2); a product too small for float64 keeps its sign."""

    def meaning(f: Array, g: Array, m: Array) -> Array:
        plain = r0(sign)(f, g)
        value = plain * np.float_power(np.sqrt(np.square(f) + np.square(g)), np.where(m >= 1, m, np.nan))
        return np.where((plain == 0) | (value == 0), np.sign(plain) * TINY, value)

    return meaning


def r0m_partial(f: Array, g: Array, m: Array) -> Array:
    """(1 - f/r)*r**m + m*f*(f + g - r)*r**(m - 2) with r = sqrt(f**2 + g**2); 0 at r = 0."""
    root, m = np.sqrt(np.square(f) + np.square(g)), np.where(m >= 1, m, np.nan)
    first = versine(f, g) * np.float_power(root, m)
    return np.where(root == 0, root, first + m * (f / root) * r0(-1)(f, g) * np.float_power(root, m - 1))


def monomial(f: Array, g: Array, m: Array, powers: tuple[int, int, int]) -> Array:
    """f**a * g**b * r**(m + c) with r = sqrt(f**2 + g**2); at r = 0 its limit 0, or NaN if there is none."""
    a, b, c = powers
    root, degree = np.sqrt(np.square(f) + np.square(g)), m + (a + b + c)
    value = np.float_power(f / root, a) * np.float_power(g / root, b) * np.float_power(root, degree)
    return np.where(root == 0, np.where(degree > 0, 0.0, np.nan), value)


def norm(f: Array, g: Array, p: Array) -> Array:
    """(|f|**p + |g|**p)**(1/p), without overflow."""
    sizes = np.abs(f), np.abs(g)
    small, large = np.minimum(*sizes), np.maximum(*sizes)
    value = large * np.float_power(1 + np.float_power(small / large, p), 1 / p)
    return np.where((large == 0) | np.isinf(large), large, value)


def rp(sign: int) -> Callable[[Array, Array, Array], Array]:
    """F + g + sign*(|f|**p + |g|**p)**(1/p); min or max where that root is 0 or infinite or the sign would be lost."""

    def meaning(f: Array, g: Array, p: Array) -> Array:
        p = np.where(p > 1, p, np.nan)
        swap = np.abs(f) > np.abs(g)
        large: Array = np.where(swap, f, g)
        small: Array = np.where(swap, g, f)
        excess = np.expm1(np.log1p(np.float_power(np.abs(small / large), p)) / p)
        value = small + np.where(sign * large < 0, -large * excess, large * (2 + excess))
        near = np.minimum(f, g) if sign < 0 else np.maximum(f, g)
        fails = (large == 0) | np.isinf(large) | ((np.sign(value) != np.sign(near)) & ~np.isnan(value))
        return np.where(fails & ~np.isnan(small + p), near, value)

    return meaning


def rp_versine(f: Array, g: Array, p: Array) -> Array:
    """1 - sign(f)*(|f|/n)**(p - 1), n the norm."""
    ratio = np.float_power(np.abs(g / f), p)
    share = np.float_power(np.abs(f) / norm(f, g, p), p - 1)
    return np.where(f > np.abs(g), -np.expm1(-(p - 1) / p * np.log1p(ratio)), 1 - np.sign(f) * share)


def joining(f: Array, g: Array, m: Array) -> Array:
    """|f|*|g|/(|f|**m + |g|**m)**(1/m); the smaller where that root is 0 or infinite or the quotient rounds to 0."""
    sizes = np.abs(f), np.abs(g)
    small, large = np.minimum(*sizes), np.maximum(*sizes)
    m = np.where(m >= 1, m, np.nan)
    value = small * np.float_power(1 + np.float_power(small / large, m), -1 / m)
    return np.where(((large == 0) | np.isinf(large) | (value == 0)) & ~np.isnan(m), small, value)


def equivalence(f: Array, g: Array, m: Array) -> Array:
    """f*g/(|f|**m + |g|**m)**(1/m)."""
    return np.sign(f) * np.sign(g) * joining(f, g, m)


def signed_power(u: Array, a: Array) -> Array:
    """sign(u)*|u|**a; for a = 0 undefined at u = 0."""
    return np.where(u == 0, np.where(a > 0, 0.0, np.nan), np.sign(u) * np.float_power(np.abs(u), a))


OPERATIONS: dict[str, Operation] = {
    "const": Operation(0, lambda: None),  # data: Fraction, "pi" or "e"
    "input": Operation(0, lambda: None),  # data: the name
    "undefined": Operation(0, lambda: np.float64(np.nan)),
    "add": Operation(2, np.add),
    "mul": Operation(2, np.multiply),
    "div": Operation(2, np.divide),
    "neg": Operation(1, np.negative),
    "powi": Operation(1, np.float_power),  # data: the exponent, at least 3
    "pow": Operation(2, np.float_power),
    "sqrt": Operation(1, np.sqrt),
    "abs": Operation(1, np.abs),
    "sign": Operation(1, np.sign),
    "min": Operation(2, np.minimum),
    "max": Operation(2, np.maximum),
    "select": Operation(4, select),
    "sin": Operation(1, np.sin),
    "cos": Operation(1, np.cos),
    "exp": Operation(1, np.exp),
    "log": Operation(1, np.log),
    "atan2": Operation(2, np.arctan2),
    "r0_conjunction": Operation(2, r0(-1)),
    "r0_disjunction": Operation(2, r0(1)),
    "versine": Operation(2, versine),
    "r_alpha_conjunction": Operation(3, r_alpha(-1)),  # parameters come last
    "r_alpha_disjunction": Operation(3, r_alpha(1)),
    "r0m_conjunction": Operation(3, r0m(-1)),
    "r0m_disjunction": Operation(3, r0m(1)),
    "r0m_partial": Operation(3, r0m_partial),
    "monomial": Operation(3, monomial),  # data: (a, b, c)
    "norm": Operation(3, norm),
    "rp_conjunction": Operation(3, rp(-1)),
    "rp_disjunction": Operation(3, rp(1)),
    "rp_versine": Operation(3, rp_versine),
    "equivalence": Operation(3, equivalence),
    "joining": Operation(3, joining),
    "absolute_power": Operation(2, lambda u, a: np.float_power(np.abs(u), a)),
    "signed_power": Operation(2, signed_power),
    "gap": Operation(2, gap),
    "trimming": Operation(2, trimming),
    "normalised": Operation(2, normalised),
    "zero_with": Operation(2, zero_with),
}

# What a backend must be able to do; expansion rewrites everything else into these.
PRIMITIVES: frozenset[str] = frozenset(
    "const input undefined add mul div neg sqrt abs min max select sin cos exp log pow atan2".split()
)
