"""The order to which a leaf is normalised, by algebra.

On a random line through space, with random letters, a leaf vanishes at the
zeros of a polynomial N. Modulo N, and with formal square roots, its Taylor
series along its own gradient is s + c_2 s**2 + ...: it is normalised to order m
if the coefficient of s is 1 and those to m vanish. All numbers are taken modulo
the prime 2**61 - 1, where an identity that is false passes with a probability
below 1e-15 (Schwartz 1980, Zippel 1979); nothing is measured, nothing rounded.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import sympy as sp

from rsym.model.contracts.algebras import Fractions, Line, Series, TaylorSeries
from rsym.model.contracts.evaluation import Evaluation
from rsym.model.contracts.promises import Order
from rsym.model.contracts.towers import Element, NotShown, Tower, element
from rsym.model.nodes import Held, RealNode, expand_nodes
from rsym.model.powers import AbsolutePower
from rsym.model.traversal import postorder

HIGHEST = 6  # trimming keeps no more
_PARTS = 600  # of a leaf: an ellipsoid under a rotation has 90
_NODES = 3  # R-operations inside a leaf, each a root


def leaf_order(leaf: sp.Expr, coordinates: Sequence[sp.Symbol]) -> Order:
    """The order of a leaf: infinity for a distance, to HIGHEST, 0 where it is not normalised, None where not shown.

    Examples
    --------
    >>> import sympy as sp
    >>> from rsym import x, y
    >>> r = sp.Symbol("r", positive=True)
    >>> disc, circle = r**2 - x**2 - y**2, sp.sqrt(x**2 + y**2)
    >>> [leaf_order(leaf, (x, y)) for leaf in (disc, disc / (2 * r), r - circle, x * y)]
    [0, 1, inf, 0]
    """
    if not leaf.free_symbols & set(coordinates):
        return math.inf
    try:
        return _order(_plain(leaf), Line(coordinates), tuple(coordinates))
    except NotShown:
        return None


def _plain(leaf: sp.Expr) -> sp.Expr:
    """The leaf in elementary functions."""
    parts = postorder(leaf)
    nodes = [part for part in parts if isinstance(part, RealNode) and not isinstance(part, AbsolutePower | Held)]
    if len(nodes) > _NODES:
        raise NotShown
    plain = expand_nodes(leaf) if nodes else leaf
    if len(postorder(plain)) > _PARTS:
        raise NotShown
    return plain


def _order(leaf: sp.Expr, line: Line, coordinates: Sequence[sp.Symbol]) -> Order:
    anywhere = Tower((line.at(sp.S.One, "anywhere")[0], 1))
    if _square(anywhere, _gradient(leaf, line, anywhere, coordinates)) == element(1):
        return math.inf
    fractions = Fractions(line)
    numerator, _ = Evaluation(fractions, leaf).value(leaf)
    boundary = fractions.tower.on_the_zeros_of(numerator, fractions.poles)
    if boundary is None:
        return math.inf  # no zero, no boundary
    gradient = _gradient(leaf, line, boundary, coordinates)
    lost = boundary.add(_square(boundary, gradient), element(-1))
    if lost:
        return None if boundary.vanishes_somewhere(lost) else 0
    normal = dict(zip(coordinates, gradient, strict=True))
    for length in (3, HIGHEST + 1):
        series = _series(leaf, line, boundary, normal, length)
        if series[0]:
            raise NotShown
        broken = [k for k in range(2, length) if series[k]]
        if broken:
            return broken[0] - 1
    return HIGHEST


def _gradient(leaf: sp.Expr, line: Line, tower: Tower, coordinates: Sequence[sp.Symbol]) -> list[Element]:
    return [_series(leaf, line, tower, {symbol: element(1)}, 2)[1] for symbol in coordinates]


def _series(leaf: sp.Expr, line: Line, tower: Tower, direction: dict[sp.Symbol, Element], length: int) -> Series:
    result: Series = Evaluation(TaylorSeries(line, tower, direction, length), leaf).value(leaf)
    return result


def _square(tower: Tower, vector: Sequence[Element]) -> Element:
    result: Element = {}
    for component in vector:
        result = tower.add(result, tower.multiply(component, component))
    return result
