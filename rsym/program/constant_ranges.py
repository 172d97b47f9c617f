"""Ranges of constants made of fractions and square roots: sqrt(5/8 - sqrt(5)/8) has a radicand above 0."""

from __future__ import annotations

import math
from collections.abc import Sequence
from fractions import Fraction
from typing import TypeAlias

from rsym.program.program import Node

Range: TypeAlias = tuple[Fraction, Fraction]

SCALE = 2**64  # ends are rounded outwards to multiples of 1/SCALE
LARGE = Fraction(2**64)
CLEAR = Fraction(1, 2**32)  # what is above that is positive in float64 too


def constant_range(node: Node, inner: Sequence[Range | None]) -> Range | None:
    """Bounds of a node whose arguments have these; None where it is no such constant, or not of moderate size.

    Examples
    --------
    >>> low, high = constant_range(Node("sqrt", (0,), None), [(Fraction(2), Fraction(2))])
    >>> low**2 < 2 < high**2, high - low < 1e-18
    (True, True)
    """
    if node.operation == "const":
        return (node.data, node.data) if isinstance(node.data, Fraction) and abs(node.data) < LARGE else None
    known = [one for one in inner if one is not None]
    if len(known) < max(1, len(inner)) or node.operation not in {"add", "mul", "neg", "sqrt"}:
        return None
    (low, high), *others = known
    if node.operation == "add":
        low, high = low + others[0][0], high + others[0][1]
    elif node.operation == "mul":
        products = [a * b for a in (low, high) for b in others[0]]
        low, high = min(products), max(products)
    elif node.operation == "neg":
        low, high = -high, -low
    elif low < 0:
        return None
    else:
        low = Fraction(math.isqrt(math.floor(low * SCALE**2)), SCALE)
        high = Fraction(math.isqrt(math.ceil(high * SCALE**2)) + 1, SCALE)
    low, high = Fraction(math.floor(low * SCALE), SCALE), Fraction(math.ceil(high * SCALE), SCALE)
    return (low, high) if max(abs(low), abs(high)) < LARGE else None
