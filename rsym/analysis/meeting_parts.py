"""Values on two parts of the boundary that meet: one function, smooth at the corner too.

u_1 on part 1 and u_2 on part 2 agree where the parts meet, their slopes do not, and shares by distance, which do not
depend on how far the corner is, would have second derivatives like 1/r. Let d = u_2 - u_1, and Q_i a map that leaves
part i where it is and, about the corner, goes to part i along the level lines of the function that is 0 on the other.
Then

    u = u_1 + d(Q_2(x)) - d(Q_2(Q_1(x))) * share_1,    share_1 = w_2/(w_1 + w_2)

is u_1 where w_1 = 0, for there Q_1(x) = x, and u_2 where w_2 = 0. The last term alone has the shares: it vanishes as
does the distance of Q_2(Q_1(x)) from the corner, altogether between straight parts. This is the Boolean sum of Coons
and Gordon. Data are never looked at outside of the shape: instead of d(x + h) stands its Taylor polynomial about x,
and what is left of the shares at a corner is of the order r**(degree + 1) between straight parts,
of r**2 between curved ones.
Source: Gordon (1971), Blending-function methods of bivariate and multivariate interpolation and approximation.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product
from typing import NamedTuple

import sympy as sp

from rsym.analysis.differential import derivative
from rsym.analysis.transfinite import OnPart, zero_with
from rsym.model.symbols import substitute, symbols_of
from rsym.model.vectors import Vector, dot, squared

PLAIN_ANGLE = sp.Rational(1, 10)  # the least sin**2 between straight parts whose maps need no bounds


class Vanishing(NamedTuple):
    """A smooth function that is 0 on a part, and beyond it, and how steep it is."""

    function: sp.Expr
    slope: sp.Expr


class MeetingParts(NamedTuple):
    """Where two parts meet: what is 0 on each; how far away maps are good; the degree of Taylor's polynomials."""

    first: Vanishing
    second: Vanishing
    length: sp.Expr
    degree: int


def joined_values(one: OnPart, other: OnPart, coordinates: Sequence[sp.Symbol], corner: MeetingParts | None) -> sp.Expr:
    """A function with values on two parts; without a corner by shares alone.

    Examples
    --------
    >>> from rsym import x, y
    >>> corner = MeetingParts(Vanishing(x, sp.S.One), Vanishing(y, sp.S.One), sp.S.One, 2)
    >>> sp.expand(joined_values(OnPart(y**2, x), OnPart(x**2, y), (x, y), corner))
    x**2 + y**2
    >>> joined_values(OnPart(y**2, x), OnPart(x**2, y), (x, y), None)
    y**2 + x*(x**2 - y**2)/(x + y)
    """
    difference = other.function - one.function
    if difference == 0:
        return one.function
    total = one.weight + other.weight
    if corner is None:
        return one.function + zero_with(one.weight, one.weight / total * difference)
    to_second = _way(corner.second, corner.first, corner.length, coordinates)
    to_first = _way(corner.first, corner.second, corner.length, coordinates)
    there = {symbol: symbol + step for symbol, step in zip(coordinates, to_first, strict=True)}
    both = tuple(step + substitute(more, there) for step, more in zip(to_first, to_second, strict=True))
    once, twice = (_taylor(difference, coordinates, way, corner.degree) for way in (to_second, both))
    return one.function + once - zero_with(other.weight, other.weight / total * twice)


def by_pairs(pieces: Sequence[OnPart], met: Sequence[tuple[tuple[int, ...], sp.Expr]]) -> sp.Expr:
    """The sum of share_P*u_P over pairs of parts that meet, and parts alone that meet none.

    share_P is the product of the weights of all other parts over the sum of such products. u_P has the values of its
    own parts. Where the parts of a pair meet its product is not 0, so that shares are as smooth as weights.

    Examples
    --------
    >>> from rsym import x, y
    >>> sides = [OnPart(sp.Integer(k), w) for k, w in enumerate((x, y, 1 - x, 1 - y))]
    >>> sp.factor(by_pairs(sides, [((0, 1), sp.S.Zero), ((1, 2), sp.S.One), ((2, 3), sp.S.One), ((3, 0), sp.S.Zero)]))
    x
    """
    if len(met) == 1:
        return met[0][1]
    shares = [sp.Mul(*(one.weight for k, one in enumerate(pieces) if k not in pair)) for pair, _ in met]
    first, total = pieces[0].function, sp.Add(*shares)
    more = sp.Add(*(share * (function - first) for share, (_, function) in zip(shares, met, strict=True)))
    return first + zero_with(total, more / total)


def _way(to: Vanishing, along: Vanishing, length: sp.Expr, coordinates: Sequence[sp.Symbol]) -> Vector:
    """From a point to the zeros of one function along the level lines of the other, near zeros of both; nought on them.

    Newton's step is -p*v/(v . grad p), v the part of grad p across grad q: v . grad p is Gram's determinant G times
    what v is divided by. With 1/(G + (distance/length)**2) for 1/G steps to curved parts are of bounded length: smooth
    functions were less wavy than with more Newton steps, or with a sharper bound.
    """
    p, q = to.function, along.function
    own, level = ([derivative(f, symbol) for symbol in coordinates] for f in (p, q))
    across = dot(own, level)
    gram = squared(own) * squared(level) - across**2
    straight = not set(symbols_of(*own, *level)) & set(coordinates)
    if straight:
        gram = sp.expand(gram)
    if gram == 0:
        return (sp.S.Zero,) * len(coordinates)
    lengths = sp.expand(squared(own) * squared(level))
    if gram.is_number and lengths.is_number and (gram - PLAIN_ANGLE * lengths).is_positive:
        inverse = 1 / gram
    else:
        away = (p**2 * along.slope**2 + q**2 * to.slope**2) / length**2
        inverse = 1 / (gram + away)
    return tuple(-p * inverse * (squared(level) * a - across * b) for a, b in zip(own, level, strict=True))


def _taylor(function: sp.Expr, coordinates: Sequence[sp.Symbol], way: Sequence[sp.Expr], degree: int) -> sp.Expr:
    """The polynomial of Taylor about a point, at a way from it."""
    found = {(0,) * len(way): function}
    terms = [function]
    for index in sorted(product(range(degree + 1), repeat=len(way)), key=sum):
        if not 0 < sum(index) <= degree:
            continue
        axis = next(k for k, times in enumerate(index) if times)
        before = tuple(times - (k == axis) for k, times in enumerate(index))
        found[index] = derivative(found[before], coordinates[axis])
        steps = sp.Mul(*(step**times / sp.factorial(times) for step, times in zip(way, index, strict=True)))
        terms.append(found[index] * steps)
    return sp.Add(*terms)
