"""The order to which a leaf is normalised, by algebra.

Where one quantity varies, a coordinate or the sine of one, and all others and
the letters have random values, a leaf vanishes at the zeros of a polynomial N.
Modulo N, and with formal square roots, its Taylor series along its own gradient
is s + c_2 s**2 + ...: it is normalised to order m if the coefficient of s is 1
and those to m vanish. Each quantity varies in turn, so that no part of the
boundary is missed. All numbers are taken modulo the prime 2**61 - 1, where an
identity that is false passes with a probability below 1e-15 (Schwartz 1980,
Zippel 1979); nothing is measured, nothing rounded.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import lru_cache

import sympy as sp

from rsym.analysis.contracts.algebras import Fractions, RandomLine, Series, TaylorSeries
from rsym.analysis.contracts.evaluation import Evaluation
from rsym.analysis.contracts.promises import Order, weakest
from rsym.analysis.contracts.towers import Element, NotShown, Tower, element
from rsym.model.nodes import Held, RealNode, expand_nodes, without_zeros
from rsym.model.powers import AbsolutePower
from rsym.model.traversal import postorder

HIGHEST = 6  # trimming keeps no more
_PARTS = 800  # of a leaf: an ellipsoid normalised to order 2 has 250, an ellipse to order 3 2 700 and takes 10 s
_NODES = 3  # R-operations inside a leaf, each a root


@lru_cache(maxsize=1024)
def leaf_order(leaf: sp.Expr, coordinates: tuple[sp.Symbol, ...]) -> Order:
    """The order of a leaf: infinity for a distance, to HIGHEST, 0 where it is not normalised, None where not shown.

    Of a sum A + A**2 B + ... with a common factor A only the zeros of A count: see `boundary_of`.

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
        plain = _plain(leaf)
        boundary, line = boundary_of(plain), RandomLine(coordinates)
        if _Along(plain, boundary, line, coordinates).is_distance():
            return math.inf
        lines = map(line.along, line.varying)
        order = weakest(*(_Along(plain, boundary, each, coordinates).order() for each in lines))
    except NotShown:
        return None
    # What floats have been rounded to may well break an identity that was meant.
    return None if order == 0 and leaf.has(sp.Float) else order


def boundary_of(leaf: sp.Expr) -> sp.Expr:
    """The common factor of all terms of a sum, else the leaf itself.

    Normalising to order 2 and more subtracts multiples of powers of omega, which brings new zeros far away.

    Examples
    --------
    >>> from rsym import x, y
    >>> boundary_of(x + x**3 * y), boundary_of(x + y)
    (x, x + y)
    """
    shared = _factors(leaf) if leaf.is_Add else {leaf}
    return sp.Mul(*sorted(shared, key=sp.default_sort_key)) if shared else leaf


def _factors(expression: sp.Expr) -> set[sp.Expr]:
    """What makes an expression zero where it is zero: any factor of a product, what all terms of a sum share."""
    if expression.is_Add:
        return set.intersection(*map(_factors, expression.args)) or {expression}
    found: set[sp.Expr] = set()
    for base, power in expression.as_powers_dict().items():
        if power.is_positive and not base.is_Rational:
            found |= _factors(base) if base.is_Add else {base}
    return found


def _plain(leaf: sp.Expr) -> sp.Expr:
    """The leaf in elementary functions."""
    leaf = without_zeros(leaf)
    parts = postorder(leaf)
    nodes = [part for part in parts if isinstance(part, RealNode) and not isinstance(part, AbsolutePower | Held)]
    if len(nodes) > _NODES:
        raise NotShown
    plain = expand_nodes(leaf) if nodes else leaf
    if len(postorder(plain)) > _PARTS:
        raise NotShown
    return plain


@dataclass(frozen=True)
class _Along:
    """A leaf on a line."""

    leaf: sp.Expr
    boundary: sp.Expr
    line: RandomLine
    coordinates: tuple[sp.Symbol, ...]
    roots: dict[sp.Expr, int] = field(default_factory=dict)  # their numbers, in the order in which they are met

    def is_distance(self) -> bool:
        """Whether the gradient has the length 1 anywhere."""
        anywhere = Tower((self.line.at(sp.S.One, "anywhere")[0], 1))
        return _square(anywhere, self._gradient(anywhere)) == element(1)

    def order(self) -> Order:
        """The order on those zeros that move along the line."""
        fractions = Fractions(self.line)
        evaluation = Evaluation(fractions, self.leaf, self.roots)
        numerator, _ = evaluation.value(self.boundary)
        zeros = fractions.tower.on_the_zeros_of(numerator, fractions.poles)
        if zeros is None:
            return math.inf  # no zero, no boundary
        gradient = self._gradient(zeros)
        lost = zeros.add(_square(zeros, gradient), element(-1))
        if lost:
            return None if evaluation.assumes or zeros.vanishes_somewhere(lost) else 0
        normal = dict(zip(self.coordinates, gradient, strict=True))
        for length in (3, HIGHEST + 1):
            series = self._series(zeros, normal, length)
            if series[0]:
                raise NotShown
            broken = [k for k in range(2, length) if series[k]]
            if broken:
                return broken[0] - 1
        return HIGHEST

    def _gradient(self, tower: Tower) -> list[Element]:
        return [self._series(tower, {symbol: element(1)}, 2)[1] for symbol in self.coordinates]

    def _series(self, tower: Tower, direction: dict[sp.Symbol, Element], length: int) -> Series:
        evaluation = Evaluation(TaylorSeries(self.line, tower, direction, length), self.leaf, self.roots)
        evaluation.value(self.boundary)  # its roots come first, as they did for its zeros
        result: Series = evaluation.value(self.leaf)
        return result


def _square(tower: Tower, vector: Sequence[Element]) -> Element:
    result: Element = {}
    for component in vector:
        result = tower.add(result, tower.multiply(component, component))
    return result
