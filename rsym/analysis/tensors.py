"""The tensor of the derivatives of one order: symmetric, so each of its entries is made once."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from fractions import Fraction
from typing import TypeVar

Index = tuple[int, ...]
S = TypeVar("S")
T = TypeVar("T")


def indices(dimension: int, order: int) -> list[Index]:
    """How often each coordinate is differentiated, for all partial derivatives of an order.

    Examples
    --------
    >>> indices(2, 2)
    [(2, 0), (1, 1), (0, 2)]
    """
    if dimension == 1:
        return [(order,)]
    return [(first, *rest) for first in range(order, -1, -1) for rest in indices(dimension - 1, order - first)]


def weight(index: Index) -> Fraction:
    """1/(k_1! ... k_n!): the share of a derivative in 1/m! times the contraction of the tensor of order m.

    The derivative stands m!/(k_1! ... k_n!) times in the tensor.

    Examples
    --------
    >>> weight((2, 1))
    Fraction(1, 2)
    """
    return Fraction(1, math.prod(math.factorial(count) for count in index))


def partials(value: T, order: int, symbols: Sequence[S], derive: Callable[[T, S], T]) -> dict[Index, T]:
    """All partial derivatives up to an order, each from one of the order below.

    Examples
    --------
    >>> found = partials("f", 2, "xy", lambda value, name: value + name)
    >>> found[1, 1], found[0, 2]
    ('fxy', 'fyy')
    """
    found: dict[Index, T] = {(0,) * len(symbols): value}
    for total in range(1, order + 1):
        for index in indices(len(symbols), total):
            axis = max(k for k, count in enumerate(index) if count)
            below = tuple(count - (k == axis) for k, count in enumerate(index))
            found[index] = derive(found[below], symbols[axis])
    return found


def unit_index(dimension: int, axis: int) -> Index:
    """The index of the first derivative with respect to one coordinate.

    Examples
    --------
    >>> unit_index(3, 1)
    (0, 1, 0)
    """
    return tuple(int(k == axis) for k in range(dimension))
