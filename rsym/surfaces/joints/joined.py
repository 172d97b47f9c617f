"""A patch that continues another one: its own surface and a loft of what it misses along the edge."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from math import comb
from typing import Any

import numpy as np
import sympy as sp

from rsym.arrays import Floats
from rsym.bounds.intervals import IntervalFunction
from rsym.errors import RsymError, warn
from rsym.model.letters import Letters
from rsym.surfaces import symbols
from rsym.surfaces.blends.blending import HermiteBlend
from rsym.surfaces.corrections import Correction, greatest, sizes
from rsym.surfaces.functions.curves import Called
from rsym.surfaces.functions.formulas import CompiledFormulas, exact
from rsym.surfaces.functions.univariate import Constant, Formula, Stack, Univariate, on_interval
from rsym.surfaces.joints.edges import PatchEdge
from rsym.surfaces.joints.meeting import apart
from rsym.surfaces.parameters import LetterValues
from rsym.surfaces.patch import Domain, Orders, Patch
from rsym.surfaces.transfinite import BooleanSum, Loft

# Intervals in which a formula k is looked at first; how often those that leave its sign open are halved, and how many.
PARTS, DEEPEST, MOST = 64, 40, 4096


class JoinedPatch(Patch):
    """The patch q + sum_n F_n(w) (W_n - q_n), where q_n are q's derivatives across its edge and W_n those wanted.

    F_n are the Hermite functions of the edge: the derivative of order n is 1 there and all others vanish there and at
    the opposite edge. So the edge becomes what is wanted and the opposite one stays. If q is a transfinite patch of
    the same blend, this is again one, with new data. `join` makes it; `correction` tells what it changed.
    """

    def __init__(
        self, first: PatchEdge, second: PatchEdge, k: Any, h: Any, depth: int, blend: HermiteBlend | None = None
    ) -> None:
        self.patch, self.depth = second.patch, depth
        self.edges = first, second
        factors = tuple(_factor(one, second.interval, name) for one, name in ((k, "k"), (h, "h")))
        _require_positive(factors[0])
        ribbons = [Ribbon(first, second, factors, order) for order in range(depth + 1)]
        across = Fading(_blend(blend, second, depth), second, depth)
        loft = Loft(across, Stack(ribbons))
        self.added = BooleanSum(along_u=loft) if second.across == 0 else BooleanSum(along_v=loft)

    @cached_property
    def correction(self) -> Correction:
        """The gap that there was between the edges, and how far points of q were moved; at the defaults of letters."""
        moved, (u, v) = greatest(lambda u, v: sizes(self.added(u, v)), *self.domain)
        return Correction(apart(*self.edges)[0], moved, (u, v))

    @property
    def domain(self) -> Domain:
        """The intervals of u and v."""
        return self.patch.domain

    @property
    def closed(self) -> tuple[bool, bool]:
        """Closed along the edge if both patches and the factors are."""
        own, added = self.patch.closed, self.added.closed
        return (own[0] and added[0], own[1] and added[1])

    @property
    def letters(self) -> Letters:
        """Those of both patches, of the factors and of the blend."""
        return self.patch.letters.merge(self.added.letters)

    def evaluate(self, u: Floats, v: Floats, orders: Orders, letters: LetterValues = None) -> list[Floats]:
        """The derivatives of these orders."""
        values = self.letters.values_with(letters)
        own = self.patch.evaluate(u, v, orders, _of(self.patch.letters, values))
        added = self.added.evaluate(u, v, orders, _of(self.added.letters, values))
        return [one + more for one, more in zip(own, added, strict=True)]

    def expression(self) -> sp.ImmutableMatrix:
        """The point as expressions in u, v and the letters."""
        return sp.ImmutableMatrix(self.patch.expression() + self.added.expression())


class Ribbon(Univariate):
    """W_n - q_n along the edge of q: what q must gain in its derivative of order n towards growing u (or v)."""

    def __init__(self, first: PatchEdge, second: PatchEdge, factors: tuple[Univariate, ...], order: int) -> None:
        self.first, self.second, self.factors, self.order = first, second, factors, order
        self.shape = (3,)
        self.domain = second.interval
        along = [edge.patch.closed[1 - edge.across] for edge in (first, second)]
        self.closed = all(along) and all(isinstance(one, Constant) for one in factors)
        letters = first.patch.letters.merge(second.patch.letters)
        for one in factors:
            letters = letters.merge(one.letters)
        self.letters = letters
        (a, b), (c, d) = first.interval, second.interval
        self.start, self.speed = (a, c), (b - a) / (d - c)

    def evaluate(self, t: Floats, orders: Sequence[int], letters: LetterValues = None) -> list[Floats]:
        """The derivatives of these orders."""
        values = self.letters.values_with(letters)
        highest, n = max(orders), self.order
        k, h = ([one[..., None] for one in factor.evaluate(t, range(highest + 1), values)] for factor in self.factors)
        tables = [self._derivatives(edge, t, highest, values) for edge in (self.first, self.second)]
        into_q = -1.0 if self.second.upper else 1.0
        found = []
        for order in orders:
            # (k d/dn + h d/dt)^n with k and h outside of the derivatives, each term differentiated along the edge.
            gained = -((-into_q) ** n) * tables[1][order, n]
            for power in range(n + 1):
                weights = [k] * power + [h] * (n - power)
                wanted = _product([*weights, [tables[0][i + n - power, power] for i in range(order + 1)]], order)
                gained = gained + into_q**n * comb(n, power) * wanted
            found.append(gained)
        return found

    def _derivatives(
        self, edge: PatchEdge, t: Floats, highest: int, values: dict[str, float]
    ) -> dict[tuple[int, int], Floats]:
        """All derivatives along and out of an edge that are needed, with respect to the parameter of q's edge."""
        n = self.order
        orders = [(i + n - power, power) for power in range(n + 1) for i in range(highest + 1)]
        own = PatchEdge(edge.patch, edge.name, edge.reverse, _of(edge.patch.letters, values))
        if edge is self.second:
            return dict(zip(orders, own.derivatives(t, orders), strict=True))
        (low, high), (a, c) = edge.interval, self.start
        found = own.derivatives(np.clip(a + (t - c) * self.speed, low, high), orders)
        return {order: self.speed ** order[0] * one for order, one in zip(orders, found, strict=True)}

    def expressions(self) -> sp.ImmutableDenseNDimArray | None:
        """The value, if both patches and the factors are formulas."""
        scalars = [factor.expressions() for factor in self.factors]
        if any(one is None for one in scalars):
            return None
        n = self.order
        k, h = (one[()] for one in scalars if one is not None)
        into_q = -1 if self.second.upper else 1
        gained = -_formula(self.second, 0, n, self.second.interval) * (-into_q) ** n
        for power in range(n + 1):
            wanted = _formula(self.first, n - power, power, self.domain)
            gained += into_q**n * comb(n, power) * k**power * h ** (n - power) * wanted
        return sp.ImmutableDenseNDimArray(list(gained), (3,))


class Fading(Univariate):
    """The Hermite functions of one end of an interval, (depth + 1,): 1 in one derivative there, 0 at the other end."""

    def __init__(self, blend: HermiteBlend, edge: PatchEdge, depth: int) -> None:
        low, high = edge.patch.domain[edge.across]
        self.inner = on_interval(blend.curve, low, high)
        self.picked = [2 * order + int(edge.upper) for order in range(depth + 1)]
        self.scales = [(high - low) ** order for order in range(depth + 1)]
        self.shape, self.domain, self.letters = (depth + 1,), (low, high), blend.letters

    def evaluate(self, t: Floats, orders: Sequence[int], letters: LetterValues = None) -> list[Floats]:
        """The derivatives of these orders."""
        return [part[..., self.picked] * self.scales for part in self.inner.evaluate(t, orders, letters)]

    def expressions(self) -> sp.ImmutableDenseNDimArray | None:
        """The functions."""
        inner = self.inner.expressions()
        if inner is None:
            return None
        terms = [exact(scale) * inner[place] for place, scale in zip(self.picked, self.scales, strict=True)]
        return sp.ImmutableDenseNDimArray(terms, self.shape)


class ScalarFunction(Univariate):
    """A scalar function that Python gives."""

    def __init__(self, function: Any, domain: tuple[float, float]) -> None:
        self.inner = Called(lambda t: (function(t), 0.0, 0.0), domain=domain)
        self.shape, self.domain = (), domain

    def evaluate(self, t: Floats, orders: Sequence[int], letters: LetterValues = None) -> list[Floats]:
        """The derivatives of these orders."""
        return [part[..., 0] for part in self.inner.evaluate(t, orders, letters)]


def _require_positive(k: Univariate) -> None:
    """Refuse a factor that is not proved positive all along the edge; of a function of Python the least value is told.

    A formula is enclosed on intervals, those that leave the sign open are halved; at the defaults of letters.
    """
    low, high = k.domain
    _, (place,) = greatest(lambda t: -np.nan_to_num(k(t), nan=-np.inf), k.domain)
    lowest, formula = float(k(place)), k.expressions()
    if formula is None and lowest > 0:
        warn(
            f"that k is positive is not proved of a function of Python: the least value seen is {lowest:.6g}, at "
            f"t = {place:.6g}; a SymPy expression is proved"
        )
        return
    if formula is not None and lowest > 0:
        program = CompiledFormulas([formula[()]], (symbols.t.name,), k.letters, (k.domain,)).program([(0,)])
        function = IntervalFunction(program, "numpy", sharpened=tuple(number for _, number in program.outputs))
        ends = np.linspace(low, high, PARTS + 1)
        lower, upper = ends[:-1], ends[1:]
        for _ in range(DEEPEST):
            ((least_there, _),) = function([lower], [upper], k.letters.values_with(None)).values()
            lower, upper = lower[~(least_there > 0)], upper[~(least_there > 0)]
            if not 0 < len(lower) <= MOST:
                break
            middle = lower / 2 + upper / 2
            lower, upper = np.append(lower, middle), np.append(middle, upper)
        if not len(lower):
            return
        place = float(lower[np.argmin(k(lower))])
        lowest = float(k(place))
    told = f"got {lowest:.6g} at {place:.6g}{', near which it is not proved' if lowest > 0 else ''}"
    raise RsymError(
        f"k must be positive all along the edge, {told}",
        code="k",
        remedy="k < 0 would fold q back over p, k = 0 makes it singular",
    )


def _factor(given: Any, domain: tuple[float, float], name: str) -> Univariate:
    """A factor as a scalar function of the parameter of the edge."""
    if isinstance(given, Univariate):
        return on_interval(given, *domain)
    if isinstance(given, sp.Expr):
        return Formula(given, domain=domain, what=f"the factor {name}")
    if callable(given):
        return ScalarFunction(given, domain)
    if isinstance(given, int | float | np.number) and np.isfinite(given):
        return Constant(float(given), domain)
    raise RsymError(f"{name} is a number, an expression or a function of t, got {given!r}", code="k")


def _blend(given: HermiteBlend | None, edge: PatchEdge, depth: int) -> HermiteBlend:
    """What fades: the one given, q's own across the edge if it reaches so deep, or the polynomial one."""
    own = getattr(edge.patch, "blend_u" if edge.across == 0 else "blend_v", None)
    if given is None:
        enough = isinstance(own, HermiteBlend) and own.order > depth
        return own if enough and own is not None else (HermiteBlend.cubic(), HermiteBlend.quintic())[depth - 1]
    if given.order <= depth:
        raise RsymError(
            f"a join of order {depth} needs a blend of class {depth + 1} or more, got one of class {given.order}",
            code="blend",
            remedy="HermiteBlend.quintic() for G2",
        )
    return given


def _of(letters: Letters, values: dict[str, float]) -> dict[str, float]:
    return {name: values[name] for name in letters}


def _product(factors: list[list[Floats]], order: int) -> Floats:
    """The derivative of a product from those of its factors (Leibniz)."""
    first, *rest = factors
    if not rest:
        return first[order]
    total: Floats = np.zeros(())
    for i in range(order + 1):
        total = total + comb(order, i) * first[i] * _product(rest, order - i)
    return total


def _formula(edge: PatchEdge, along: int, outwards: int, domain: tuple[float, float]) -> sp.Matrix:
    """A derivative of a patch on its edge, as expressions in t over an interval."""
    names = (symbols.u, symbols.v)
    runs, constant = names[1 - edge.across], names[edge.across]
    point = sp.Matrix(edge.patch.expression())
    (a, b), (c, d) = (tuple(map(exact, one)) for one in (edge.interval, domain))
    place = a + (symbols.t - c) * (b - a) / (d - c)
    signs = (1 if edge.upper else -1) ** outwards * ((-1 if edge.reverse else 1) * (b - a) / (d - c)) ** along
    found = point.diff(runs, along).diff(constant, outwards)
    end = exact(edge.patch.domain[edge.across][int(edge.upper)])
    return sp.Matrix(signs * found.subs(constant, end).subs(runs, a + b - place if edge.reverse else place))
