"""Transfinite interpolation: one function that is each of several on its own part of the boundary.

The parts are where weights w_i vanish, w_i >= 0 elsewhere. The shares

    share_i = w_i**-k / sum of w_j**-k over all j

add up to 1, share_i is 1 where w_i = 0 and the others 0, to order k: u = sum of share_i * u_i has there the derivatives
of u_i below the k-th. Nothing is divided by zero: two shares are W/(W + w**k) and the rest, and the weight of what has
been put together, S = (sum of w_j**-k)**(-1/k), is an R-node, 0 where one w_j is.
Source: Rvachev, Sheiko, Shapiro and Tsukanov (2001), Transfinite interpolation over implicitly defined sets.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import sympy as sp

from rsym.analysis.differential import derivative
from rsym.model.nodes import ZeroWith
from rsym.model.rnodes import Equivalence
from rsym.model.symbols import substitute
from rsym.model.vectors import dot


class OnPart(NamedTuple):
    """A function, and the weight that vanishes where it is to be met."""

    function: sp.Expr
    weight: sp.Expr


def inverse_distances(pieces: Sequence[OnPart], power: int) -> sp.Expr:
    """The sum of share_i*u_i, shares by w_i**-k, k being the power.

    Where several weights vanish it is the first of their functions, which is the limit where these agree.

    Examples
    --------
    >>> from rsym import x, y
    >>> inverse_distances([OnPart(sp.Integer(0), x), OnPart(sp.Integer(2), y)], 2)
    2*x**2/(x**2 + y**2)
    """
    result = pieces[0].function
    for number in range(1, len(pieces)):
        before, piece = _joined([one.weight for one in pieces[:number]], power), pieces[number]
        share = _ratio(before**power, piece.weight**power)
        result = result * (1 - share) + piece.function * share
    return result


def joined_weights(pieces: Sequence[OnPart], power: int) -> sp.Expr:
    """The sum of share_i*u_i with share_i = o_i**k over the sum of all o_j**k.

    o_i = (sum of w_j**-k over all j but i)**(-1/k), the joining of the other weights: it vanishes where one of them
    does, and is normalised as they are. Of two parts it is the same as by inverse distances.

    Examples
    --------
    >>> from rsym import x, y
    >>> joined_weights([OnPart(sp.Integer(0), x), OnPart(sp.Integer(2), y)], 2)
    2*x**2/(x**2 + y**2)
    """
    plain = inverse_distances(pieces, power)
    if len(pieces) < 3:
        return plain
    weights = [piece.weight for piece in pieces]
    # Joining is associative: of those after each part it is made from the last on, and shared.
    after = [weights[-1]]
    for weight in weights[-2:0:-1]:
        after.insert(0, _joined([weight, after[0]], power))
    joined = [_joined([*weights[:k], *after[k : k + 1]], power) for k in range(len(pieces))]
    others = [one**power for one in joined]
    total = sp.Add(*others)
    blend = sp.Add(*(other * piece.function for other, piece in zip(others, pieces, strict=True)))
    # Where parts meet all of these weights vanish, and inverse distances know the limit.
    return plain + ZeroWith(total, blend / total - plain)


def taylor(weight: sp.Expr, coordinates: Sequence[sp.Symbol], slopes: Sequence[sp.Expr]) -> sp.Expr:
    """The generalised Taylor form: a function with these derivatives along the outward normal where a weight is 0.

        u = sum of (-1)**k * h_k(x - w grad w) * w**k / k!,    k = 0..m

    for the values h_0, the slopes h_1 and so on; w is to be normalised to order m and positive inside. With m = 1 the
    normaliser h(x - w grad w) is taken to first order, h - w*(grad w . grad h).
    Source: Rvachev; Sukumar and Srivastava (2022), (17)-(20).

    Examples
    --------
    >>> from rsym import x, y
    >>> taylor(1 - x, (x, y), [x**2 * y, sp.Integer(3)])
    x**2*y + (1 - x)*(2*x*y - 3)
    """
    value, *rest = slopes
    if not rest:
        return value
    way = [derivative(weight, symbol) for symbol in coordinates]
    if len(rest) == 1:
        along = dot(way, [derivative(value, symbol) for symbol in coordinates])
        return value + zero_with(weight, weight * (-along - rest[0]))
    places = {symbol: symbol - weight * slope for symbol, slope in zip(coordinates, way, strict=True)}
    terms = [
        substitute(slope, places) * (-weight) ** k / sp.factorial(k) for k, slope in enumerate(slopes) if slope != 0
    ]
    return value + zero_with(weight, sp.Add(*terms) - value)


def zero_with(weight: sp.Expr, product: sp.Expr) -> sp.Expr:
    """A product that vanishes with a weight, 0 at corners too, where the gradient of the weight does not exist."""
    return product if product == 0 else ZeroWith(weight, product)


def _joined(weights: Sequence[sp.Expr], power: int) -> sp.Expr:
    return Equivalence(sp.Integer(power), *weights)


def _ratio(one: sp.Expr, other: sp.Expr) -> sp.Expr:
    """u/(u + v), and 0 where both are."""
    return zero_with(one, one / (one + other))
