"""Whether vectors of intervals are linearly independent, for many boxes at once, rounding included."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from rsym.arrays import Floats

Ends: TypeAlias = tuple[Floats, Floats]

UNIT = 2.0**-51  # of the size of an operand: two roundings, and the rounding of that bound


def independent(vectors: Sequence[Ends]) -> NDArray[np.bool_]:
    """Where one to three vectors, each (3, n) lower and upper ends, are independent whatever they are inside these.

    One vector is where a component excludes zero, two are where a component of the vector product does, three where
    the determinant does; more never are.

    Examples
    --------
    >>> x, y = (np.array([[a], [b], [0.0]]) for a, b in ((1.0, 0.0), (0.2, 1.0)))
    >>> independent([(x - 0.1, x + 0.1), (y - 0.1, y + 0.1)]), independent([(x - 0.1, x + 0.1), (x, x)])
    (array([ True]), array([False]))
    """
    minors = [(low, high) for low, high in zip(*vectors[0], strict=True)]
    if len(vectors) > 3:
        return np.zeros(len(minors[0][0]), bool)
    if len(vectors) > 1:
        p, q = ([(low, high) for low, high in zip(*vector, strict=True)] for vector in vectors[:2])
        minors = [_difference(_product(p[i], q[j]), _product(p[j], q[i])) for i, j in ((1, 2), (2, 0), (0, 1))]
    if len(vectors) == 3:
        parts = [_product(minor, (low, high)) for minor, low, high in zip(minors, *vectors[2], strict=True)]
        minors = [_sum(_sum(parts[0], parts[1]), parts[2])]
    result: NDArray[np.bool_] = np.logical_or.reduce([(low > 0) | (high < 0) for low, high in minors])
    return result


def apart(values: Sequence[Ends], slopes: Sequence[Ends], reach: Floats) -> NDArray[np.bool_]:
    """Where two functions certainly have no common zero in a box.

    By the mean-value theorem f - m*g lies in f(c) - m*g(c) + (grad f - m grad g)(x - c) with the slopes over the box;
    m is that multiple for which the slopes nearly cancel along grad g. A common zero is a zero of that too.

    Parameters
    ----------
    values : two pairs of (n,) arrays
        Ends of f and g in the middle c of each box.
    slopes : two pairs of (3, n) arrays
        Ends of their gradients over the boxes.
    reach : (3, n) array
        How far the boxes reach from c.

    Examples
    --------
    >>> zero, one = np.array([0.0]), np.array([1.0])
    >>> along, across = np.stack([one, zero, zero]), np.stack([zero, one, zero])
    >>> parallel = apart([(zero, zero), (one / 4, one / 4)], [(along, along)] * 2, np.full((3, 1), 0.5))
    >>> crossing = apart([(zero, zero), (one / 4, one / 4)], [(along, along), (across, across)], np.full((3, 1), 0.5))
    >>> parallel, crossing
    (array([ True]), array([False]))
    """
    (f, g), (p, q) = values, slopes
    with np.errstate(all="ignore"):
        middle = (p[0] + p[1]) / 2, (q[0] + q[1]) / 2
        multiple = -np.einsum("kn,kn->n", *middle) / np.square(middle[1]).sum(axis=0)
        multiple = np.where(np.isfinite(multiple), multiple, 0.0)
    scale = multiple, multiple
    total = _sum(f, _product(g, scale))
    for k in range(3):
        slope = _sum((p[0][k], p[1][k]), _product((q[0][k], q[1][k]), scale))
        total = _sum(total, _product(slope, (-reach[k], reach[k])))
    result: NDArray[np.bool_] = (total[0] > 0) | (total[1] < 0)
    return result


def step_to_both(values: Sequence[Ends], slopes: Sequence[Ends]) -> Floats:
    """The shortest step (3, n) to where both functions vanish to first order; not finite where there is none.

    Examples
    --------
    >>> zero, one = np.array([0.0]), np.array([1.0])
    >>> planes = [np.stack([one, zero, zero]), np.stack([zero, one, zero])]
    >>> step_to_both([(one, one), (2 * one, 2 * one)], [(plane, plane) for plane in planes]).T.tolist()
    [[-1.0, -2.0, -0.0]]
    """
    with np.errstate(all="ignore"):  # ends may be infinite
        f, g = ((low + high) / 2 for low, high in values)
        p, q = ((low + high) / 2 for low, high in slopes)
        pp, pq, qq = ((u * v).sum(axis=0) for u, v in ((p, p), (p, q), (q, q)))
        determinant = pp * qq - pq * pq
        step: Floats = ((pq * g - qq * f) * p + (pq * f - pp * g) * q) / determinant
    return step


def _product(a: Ends, b: Ends) -> Ends:
    with np.errstate(all="ignore"):
        corners = np.stack([u * v for u, v in product(a, b)])
        known = np.isfinite(corners).all(axis=0)
        slack = UNIT * np.abs(corners).max(axis=0) + 1e-300
        low, high = corners.min(axis=0) - slack, corners.max(axis=0) + slack
    return np.where(known, low, -np.inf), np.where(known, high, np.inf)


def _sum(a: Ends, b: Ends) -> Ends:
    with np.errstate(all="ignore"):
        low, high = a[0] + b[0], a[1] + b[1]
        slack = UNIT * (np.abs(low) + np.abs(high))
        low, high = low - slack, high + slack
    return np.where(np.isnan(low), -np.inf, low), np.where(np.isnan(high), np.inf, high)


def _difference(a: Ends, b: Ends) -> Ends:
    return _sum(a, (-b[1], -b[0]))
