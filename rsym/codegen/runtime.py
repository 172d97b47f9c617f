"""What `sympy.lambdify` calls for an R-node: one small function for each, in any array package.

The package is taken from the arguments, so the same functions serve NumPy,
plain floats, mpmath, JAX (traced too) and PyTorch, none of which is imported here.
"""

from __future__ import annotations

import sys
from functools import reduce
from typing import Any

import numpy as np


class _Scalars:
    """mpmath numbers: no arrays, so a choice is a branch."""

    def __init__(self, package: Any) -> None:
        self.sqrt = package.sqrt

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
    package = _package(f, g)
    root, total = package.sqrt(f * f + g * g), f + g
    low, high = package.where(f < g, f, g), package.where(f < g, g, f)
    near, far = (low, high) if sign < 0 else (high, low)
    cancels = sign * total < 0
    divisor = package.where(cancels, total - sign * root, 1.0)
    value = package.where(cancels, 2 * near * (far / divisor), total + sign * root)
    return package.where(root == 0, near, value)


def _extremum(f: Any, g: Any, sign: int) -> Any:
    package = _package(f, g)
    value = package.where(sign * (f - g) > 0, f, g)
    return package.where(f != f, f, value)


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


def ahead(f: Any, g: Any) -> Any:
    """1 where f > g, 0 where f < g, NaN elsewhere."""
    package = _package(f, g)
    return package.where(f > g, 1.0, package.where(f < g, 0.0, float("nan")))


def trimming(f: Any, t: Any) -> Any:
    """sqrt(f**2 + ((sqrt(t**2 + f**4) - t)/2)**2)."""
    package = _package(f, t)
    s = f * f
    root = package.sqrt(t * t + s * s)
    positive = t > 0
    gap = package.where(positive, s * s / package.where(positive, 2 * (root + t), 1.0), (root - t) / 2)
    return package.sqrt(s + gap * gap)
