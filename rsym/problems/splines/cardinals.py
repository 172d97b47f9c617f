"""The pieces of cardinal B-splines, and the derivatives of products."""

from __future__ import annotations

from fractions import Fraction
from functools import cache
from itertools import product
from math import comb, prod
from typing import NamedTuple

import numpy as np

from rsym.arrays import Floats, Ints


@cache
def pieces(degree: int) -> Floats:
    """The coefficients of the ``degree + 1`` splines that live on one cell, by powers of the place t in [0, 1].

    The spline whose support ends first is first.

    Examples
    --------
    >>> pieces(1).tolist()
    [[1.0, -1.0], [0.0, 1.0]]
    >>> float(pieces(5).sum().round(12))
    1.0
    """
    rows = [[Fraction(1)]]
    for d in range(1, degree + 1):
        made = [[Fraction(0)] * (d + 1) for _ in range(d + 1)]
        for i in range(d + 1):
            # N_i = ((t + d - i) N_(i-1) + (1 + i - t) N_i)/d, of the functions of one degree less.
            for row, slope, shift in ((i - 1, 1, d - i), (i, -1, 1 + i)):
                if 0 <= row < d:
                    for power, value in enumerate(rows[row]):
                        made[i][power] += value * shift / d
                        made[i][power + 1] += value * slope / d
        rows = made
    return np.array(rows, np.float64)


class ProductTerm(NamedTuple):
    """``times * (derivative left of one) * (derivative right of other)`` in the derivative `whole` of their product."""

    whole: int
    left: int
    right: int
    times: int


@cache
def derivatives(dimension: int, order: int) -> tuple[tuple[int, ...], ...]:
    """Multi-indices of the derivatives up to an order, lower orders first.

    Examples
    --------
    >>> derivatives(2, 2)
    ((0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2))
    """
    every = (index for index in product(range(order, -1, -1), repeat=dimension) if sum(index) <= order)
    return tuple(sorted(every, key=lambda index: (sum(index), tuple(-k for k in index))))


@cache
def product_terms(dimension: int, order: int) -> tuple[ProductTerm, ...]:
    """Leibniz's rule for all derivatives up to an order.

    Examples
    --------
    >>> [tuple(term) for term in product_terms(2, 1)]
    [(0, 0, 0, 1), (1, 1, 0, 1), (1, 0, 1, 1), (2, 2, 0, 1), (2, 0, 2, 1)]
    """
    every = derivatives(dimension, order)
    found = []
    for whole, index in enumerate(every):
        for right, other in enumerate(every):
            if all(b <= a for a, b in zip(index, other, strict=True)):
                rest = tuple(a - b for a, b in zip(index, other, strict=True))
                times = prod(comb(a, b) for a, b in zip(index, other, strict=True))
                found.append(ProductTerm(whole, every.index(rest), right, times))
    return tuple(found)


def multiplied(one: Floats, other: Floats, dimension: int, order: int) -> Floats:
    """The derivatives (kinds, ...) up to an order of a product, of those of both factors, which broadcast.

    Examples
    --------
    >>> multiplied(np.array([2.0, 1.0, 0.0]), np.array([3.0, 0.0, 5.0]), 2, 1).tolist()
    [6.0, 3.0, 10.0]
    """
    found = np.zeros(np.broadcast_shapes(one.shape, other.shape))
    for term in product_terms(dimension, order):
        found[term.whole] += term.times * one[term.left] * other[term.right]
    return found


@cache
def digits(count: int, dimension: int) -> Ints:
    """The indices (count**dimension, dimension) of a cube of so many on each side, the last coordinate fastest."""
    return np.stack(np.unravel_index(np.arange(count**dimension), (count,) * dimension), axis=1).astype(np.int64)
