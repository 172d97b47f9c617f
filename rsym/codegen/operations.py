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
    "gap": Operation(2, gap),
    "trimming": Operation(2, trimming),
    "normalised": Operation(2, normalised),
}

# What a backend must be able to do; expansion rewrites everything else into these.
PRIMITIVES: frozenset[str] = frozenset(
    "const input undefined add mul div neg sqrt abs min max select sin cos exp log pow atan2".split()
)
