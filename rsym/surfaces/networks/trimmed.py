"""Lines on a patch, (u(t), v(t)), and the derivatives of the patch across them."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from math import comb, factorial
from typing import Any, TypeAlias

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from rsym.errors import RsymError
from rsym.surfaces import symbols
from rsym.surfaces.functions.callables import Called
from rsym.surfaces.functions.entries import entries_of, exact
from rsym.surfaces.functions.univariate import Curve, Formula, LetterValues
from rsym.surfaces.joints.edges import Edge
from rsym.surfaces.networks.reparametrisation import Part
from rsym.surfaces.parameters import inside
from rsym.surfaces.patch import Patch

Array: TypeAlias = NDArray[np.float64]
# Taylor coefficients of a function of one parameter about every t: order by order.
Jet: TypeAlias = list[Array]

ENDS_MEET = 1e-9


class Across(Curve):
    """The derivative of a patch of some order in the direction (-v'(t), u'(t)), to the left of a line on it.

    Order 0 is the line in space. A negative `side` means the right. Golovanov, 3.7.4, for order 1.

    Examples
    --------
    >>> from rsym.surfaces.parametric import ParametricSurface
    >>> from rsym.surfaces.symbols import t, u, v
    >>> bowl = ParametricSurface((u, v, u**2 + v**2))
    >>> line = as_line(bowl, (t, t**2))
    >>> Across(bowl, line, 0)(0.5).tolist(), Across(bowl, line, 1)(0.5).tolist()
    ([0.5, 0.25, 0.3125], [-1.0, 1.0, -0.5])
    """

    def __init__(self, patch: Patch, line: Curve, order: int, side: int = 1) -> None:
        self.patch, self.line, self.order, self.side = patch, line, order, side
        self.shape, self.domain = (3,), line.domain
        self.closed = line.closed
        self.letters = patch.letters.merge(line.letters)

    def evaluate(self, t: Array, orders: Sequence[int], letters: LetterValues = None) -> list[Array]:
        """The derivatives of these orders, through Taylor series of the line and the patch."""
        top, k = max(orders), self.order
        parts = self.line.evaluate(t, list(range(top + 2)), letters)
        u, v = ([part[..., axis] / factorial(m) for m, part in enumerate(parts)] for axis in (0, 1))
        own = None if letters is None else {name: letters[name] for name in self.patch.letters}
        needed = [(i, j) for i in range(k + top + 1) for j in range(k + top + 1 - i)]
        axes = zip((u[0], v[0]), self.patch.domain, self.patch.closed, "uv", strict=True)
        place = [inside(*one) for one in axes]
        known = dict(zip(needed, self.patch.evaluate(place[0], place[1], needed, own), strict=True))
        steps = _powers([0 * u[0], *u[1:-1]], top), _powers([0 * v[0], *v[1:-1]], top)
        left = (
            [-self.side * (m + 1) * v[m + 1] for m in range(top + 1)],
            [self.side * (m + 1) * u[m + 1] for m in range(top + 1)],
        )
        ways = _powers(left[0], k), _powers(left[1], k)
        series = [np.zeros((*t.shape, 3)) for _ in range(top + 1)]
        for i in range(k + 1):
            way = [comb(k, i) * one for one in _product(ways[0][i], ways[1][k - i])]
            for a in range(top + 1):
                for b in range(top + 1 - a):
                    factor = _product(way, _product(steps[0][a], steps[1][b]))
                    value = known[i + a, k - i + b] / (factorial(a) * factorial(b))
                    series = [old + one[..., None] * value for old, one in zip(series, factor, strict=True)]
        return [series[order] * factorial(order) for order in orders]

    def expressions(self) -> sp.ImmutableDenseNDimArray | None:
        """The formula, if patch and line have one."""
        line = self.line.expressions()
        if line is None:
            return None
        along_u, along_v = entries_of(line)[:2]
        t = symbols.t
        n_u, n_v = -self.side * along_v.diff(t), self.side * along_u.diff(t)
        point, k = self.patch.expression(), self.order
        total = [sp.Integer(0)] * 3
        for i in range(k + 1):
            part = point.diff(symbols.u, i).diff(symbols.v, k - i).xreplace({symbols.u: along_u, symbols.v: along_v})
            total = [old + comb(k, i) * n_u**i * n_v ** (k - i) * one for old, one in zip(total, part, strict=True)]
        return sp.ImmutableDenseNDimArray(total)


class Weighted(Curve):
    """The product, component by component, of two curves over one interval."""

    def __init__(self, weight: Curve, curve: Curve) -> None:
        self.weight, self.curve = weight, curve
        self.shape, self.domain, self.closed = curve.shape, curve.domain, curve.closed
        self.letters = curve.letters.merge(weight.letters)

    def evaluate(self, t: Array, orders: Sequence[int], letters: LetterValues = None) -> list[Array]:
        """The derivatives of these orders, by Leibniz' rule."""
        upto = list(range(max(orders) + 1))
        a, b = self.weight.evaluate(t, upto, letters), self.curve.evaluate(t, upto, letters)
        return [np.sum([comb(n, m) * a[m] * b[n - m] for m in range(n + 1)], axis=0) for n in orders]

    def expressions(self) -> sp.ImmutableDenseNDimArray | None:
        """The product, if both are formulas."""
        parts = self.weight.expressions(), self.curve.expressions()
        if parts[0] is None or parts[1] is None:
            return None
        return sp.ImmutableDenseNDimArray([a * b for a, b in zip(*map(entries_of, parts), strict=True)])


def as_line(patch: Patch, given: Any, letters: Mapping[Any, Any] | None = None) -> Curve:
    """A line on the patch: an edge by its name, or u(t), v(t) as expressions, functions, one function, or a curve.

    The parameter of an edge is that of the patch along it; expressions and functions run over [0, 1], a `Formula` of
    two expressions over its own interval.
    """
    if isinstance(given, str):
        return _edge(patch, given)
    if isinstance(given, Curve) and given.shape in ((2,), (3,)):
        line = given
    elif callable(given):
        line = Called(_padded(given))
    elif isinstance(given, Sequence) and len(given) == 2 and all(map(callable, given)):
        first, second = given
        line = Called(lambda t: (first(t), second(t), 0 * t))
    elif isinstance(given, Sequence) and len(given) == 2:
        line = Formula(given, letters, what="a line on a patch")
    else:
        raise RsymError(
            f"a line on a patch is one of u0, u1, v0, v1 or (u(t), v(t)), got {given!r}",
            code="edge",
            remedy='"u0" is the edge where u is at its lower end',
        )
    ends = [line(np.array(line.domain), order) for order in (0, 1)]
    closed = all(bool(np.abs(one[1] - one[0]).max() <= ENDS_MEET * (1 + np.abs(one).max())) for one in ends)
    return line if line.closed == closed else Part(line, line.domain, closed=closed)


def _edge(patch: Patch, name: str) -> Formula:
    edge = Edge(patch, name)
    low, high = patch.domain[edge.across]
    fixed = exact(high if edge.upper else low)
    pair = (fixed, symbols.t) if edge.across == 0 else (symbols.t, fixed)
    return Formula(pair, domain=edge.interval, closed=patch.closed[1 - edge.across])


def _padded(function: Callable[[Any], Any]) -> Callable[[Any], Any]:
    """A function t -> (u, v) as one to three coordinates."""

    def points(t: Any) -> Any:
        u, v = function(t)
        return u, v, 0 * t

    return points


def _product(a: Jet, b: Jet) -> Jet:
    return [np.sum([a[m] * b[n - m] for m in range(n + 1)], axis=0) for n in range(len(a))]


def _powers(jet: Jet, top: int) -> list[Jet]:
    powers: list[Jet] = [[np.ones_like(jet[0]), *(np.zeros_like(one) for one in jet[1:])]]
    for _ in range(top):
        powers.append(_product(powers[-1], jet))
    return powers
