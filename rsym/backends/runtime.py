"""What `sympy.lambdify` calls for an R-node: one small function for each, in any array package.

The package is taken from the arguments, so the same functions serve NumPy,
plain floats, mpmath, JAX (traced too) and PyTorch, none of which is imported here.
"""

from __future__ import annotations

import sys
from functools import reduce
from typing import Any

import numpy as np

from rsym.program.operations import OPERATIONS


class _Scalars:
    """mpmath numbers: no arrays, so a choice is a branch."""

    def __init__(self, package: Any) -> None:
        self.sqrt = package.sqrt
        self.expm1 = package.expm1
        self.log1p = package.log1p

    @staticmethod
    def where(condition: Any, yes: Any, no: Any) -> Any:
        return yes if condition else no


def _package(*operands: Any) -> Any:
    for operand in operands:
        root = type(operand).__module__.partition(".")[0]
        if root in {"jax", "jaxlib"}:
            return sys.modules["jax.numpy"]
        if root == "torch":
            return sys.modules["torch"]
        if root == "mpmath":
            return _Scalars(sys.modules["mpmath"])
    return np


def _pair(f: Any, g: Any, sign: int) -> Any:
    """F + g + sign*sqrt(f**2 + g**2) without cancellation; min or max where the root is 0."""
    return _with_root(f, g, _package(f, g).sqrt(f * f + g * g), 1, sign)


def _with_root(f: Any, g: Any, root: Any, scale: Any, sign: int) -> Any:
    """(f + g + sign*root)/scale without cancellation, root**2 = (f + g)**2 - 2*scale*f*g; min or max at root 0."""
    package, total = _package(f, g), f + g
    low, high = package.where(f < g, f, g), package.where(f < g, g, f)
    near, far = (low, high) if sign < 0 else (high, low)
    cancels = sign * total < 0
    divisor = package.where(cancels, total - sign * root, 1.0)
    value = package.where(cancels, 2 * near * (far / divisor), (total + sign * root) / scale)
    return package.where(root == 0, near, value)


def _extremum(f: Any, g: Any, sign: int) -> Any:
    package = _package(f, g)
    value = package.where(sign * (f - g) > 0, f, g)
    return package.where(f != f, f, value)


def _sheared_pair(f: Any, g: Any, alpha: Any, sign: int) -> Any:
    """(f + g + sign*r)/(1 + alpha) without cancellation, the radicand as a sum of squares."""
    root = _package(f, g).sqrt((f - alpha * g) ** 2 + (1 - alpha) * (1 + alpha) * g**2)
    return _with_root(f, g, root, 1 + alpha, sign)


def _by_size(f: Any, g: Any) -> tuple[Any, Any, Any]:
    """The operand larger in size, the other, and their ratio in size, 0 where both are 0."""
    package = _package(f, g)
    swap = abs(f) > abs(g)
    large, small = package.where(swap, f, g), package.where(swap, g, f)
    ratio = abs(small) / package.where(large == 0, 1.0, abs(large))
    return large, small, ratio


def _power_pair(f: Any, g: Any, p: Any, sign: int) -> Any:
    """F + g + sign*(|f|**p + |g|**p)**(1/p) without cancellation."""
    package = _package(f, g)
    large, small, ratio = _by_size(f, g)
    excess = package.expm1(package.log1p(ratio**p) / p)
    return small + package.where(sign * large < 0, -large * excess, large * (2 + excess))


def _joined(f: Any, g: Any, m: Any) -> Any:
    """The smaller size over (1 + ratio**m)**(1/m)."""
    _, small, ratio = _by_size(f, g)
    return abs(small) / (1 + ratio**m) ** (1 / m)


def _alike(f: Any, g: Any, m: Any) -> Any:
    """The same, negative where f and g differ in sign."""
    size = _joined(f, g, m)
    return _package(f, g).where((f < 0) != (g < 0), -size, size)


def r0_conjunction(*operands: Any) -> Any:
    """The left fold of f + g - sqrt(f**2 + g**2)."""
    return reduce(lambda f, g: _pair(f, g, -1), operands)


def r0_disjunction(*operands: Any) -> Any:
    """The left fold of f + g + sqrt(f**2 + g**2)."""
    return reduce(lambda f, g: _pair(f, g, 1), operands)


def r1_conjunction(*operands: Any) -> Any:
    """The smallest."""
    return reduce(lambda f, g: _extremum(f, g, -1), operands)


def r1_disjunction(*operands: Any) -> Any:
    """The largest."""
    return reduce(lambda f, g: _extremum(f, g, 1), operands)


def r_alpha_conjunction(alpha: Any, *operands: Any) -> Any:
    """The left fold of (f + g - sqrt(f**2 + g**2 - 2*alpha*f*g))/(1 + alpha)."""
    return reduce(lambda f, g: _sheared_pair(f, g, alpha, -1), operands)


def r_alpha_disjunction(alpha: Any, *operands: Any) -> Any:
    """The left fold of (f + g + sqrt(f**2 + g**2 - 2*alpha*f*g))/(1 + alpha)."""
    return reduce(lambda f, g: _sheared_pair(f, g, alpha, 1), operands)


def r0m_conjunction(m: Any, *operands: Any) -> Any:
    """The left fold of (f + g - r)*r**m with r = sqrt(f**2 + g**2)."""
    return reduce(lambda f, g: _pair(f, g, -1) * _package(f, g).sqrt(f * f + g * g) ** m, operands)


def r0m_disjunction(m: Any, *operands: Any) -> Any:
    """The left fold of (f + g + r)*r**m with r = sqrt(f**2 + g**2)."""
    return reduce(lambda f, g: _pair(f, g, 1) * _package(f, g).sqrt(f * f + g * g) ** m, operands)


def rp_conjunction(p: Any, *operands: Any) -> Any:
    """The left fold of f + g - (|f|**p + |g|**p)**(1/p)."""
    return reduce(lambda f, g: _power_pair(f, g, p, -1), operands)


def rp_disjunction(p: Any, *operands: Any) -> Any:
    """The left fold of f + g + (|f|**p + |g|**p)**(1/p)."""
    return reduce(lambda f, g: _power_pair(f, g, p, 1), operands)


def equivalence(m: Any, *operands: Any) -> Any:
    """The left fold of f*g/(|f|**m + |g|**m)**(1/m)."""
    return reduce(lambda f, g: _alike(f, g, m), operands)


def joining(m: Any, *operands: Any) -> Any:
    """The left fold of |f|*|g|/(|f|**m + |g|**m)**(1/m)."""
    return reduce(lambda f, g: _joined(f, g, m), operands)


def absolute_power(u: Any, a: Any) -> Any:
    """|u|**a."""
    return abs(u) ** a


def signed_power(u: Any, a: Any) -> Any:
    """sign(u)*|u|**a; undefined at u = 0 where a = 0."""
    package = _package(u)
    sign = package.where(u > 0, 1.0, package.where(u < 0, -1.0, float("nan") if a == 0 else 0.0))
    return sign * abs(u) ** a


def ahead(f: Any, g: Any) -> Any:
    """1 where f > g, 0 where f < g, NaN elsewhere."""
    package = _package(f, g)
    return package.where(f > g, 1.0, package.where(f < g, 0.0, float("nan")))


def choice(a: Any, b: Any, yes: Any, no: Any) -> Any:
    """`yes` where a > b, `no` elsewhere."""
    return _package(a, b).where(a > b, yes, no)


def zero_with(f: Any, g: Any) -> Any:
    """G, and 0 where f is."""
    return _package(f, g).where(f == 0, 0.0, g)


def trimming(f: Any, t: Any) -> Any:
    """sqrt(f**2 + ((sqrt(t**2 + f**4) - t)/2)**2)."""
    package = _package(f, t)
    s = f * f
    root = package.sqrt(t * t + s * s)
    positive = t > 0
    gap = package.where(positive, s * s / package.where(positive, 2 * (root + t), 1.0), (root - t) / 2)
    return package.sqrt(s + gap * gap)


def __getattr__(name: str) -> Any:
    """The plain meaning, on NumPy arrays, of an operation that has no function of its own here: a left fold."""
    row = OPERATIONS.get(name)
    if row is None:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    count = int(row.parameter is not None)

    def function(*arguments: Any) -> Any:
        parameters, operands = arguments[:count], arguments[count:]
        if row.arity == 1:
            return row.meaning(np, *operands)
        return reduce(lambda f, g: row.meaning(np, f, g, *parameters), operands)

    return function
