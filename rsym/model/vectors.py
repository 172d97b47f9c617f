"""Vectors of expressions: sums of products, lengths, what lies between two points."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TypeAlias

import sympy as sp

Vector: TypeAlias = tuple[sp.Expr, ...]


def dot(a: Iterable[sp.Expr], b: Iterable[sp.Expr]) -> sp.Expr:
    """The scalar product."""
    return sp.Add(*(p * q for p, q in zip(a, b, strict=True)))


def cross(a: Sequence[sp.Expr], b: Sequence[sp.Expr]) -> Vector:
    """The vector product."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def squared(vector: Iterable[sp.Expr]) -> sp.Expr:
    """The square of the length."""
    return sp.Add(*(component**2 for component in vector))


def norm(vector: Iterable[sp.Expr]) -> sp.Expr:
    """The length."""
    return sp.sqrt(squared(vector))


def minus(a: Iterable[sp.Expr], b: Iterable[sp.Expr]) -> Vector:
    """The way from b to a.

    Examples
    --------
    >>> from rsym import x, y
    >>> minus((x, y), (1, 0))
    (x - 1, y)
    """
    return tuple(p - q for p, q in zip(a, b, strict=True))
