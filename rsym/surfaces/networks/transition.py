"""Transition surfaces: from a line on one patch to a line on another, as smooth as wished."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from math import comb, factorial
from typing import Any, TypeAlias

import numpy as np
import sympy as sp

from rsym.arrays import Floats
from rsym.errors import RsymError
from rsym.surfaces import symbols
from rsym.surfaces.blends.blending import HermiteBlend
from rsym.surfaces.functions.curves import Called, as_curve
from rsym.surfaces.functions.formulas import entries_of, exact
from rsym.surfaces.functions.univariate import Formula, Stack, Univariate, backwards, on_interval
from rsym.surfaces.joints.edges import PatchEdge
from rsym.surfaces.networks.reparametrisation import Part
from rsym.surfaces.parameters import LetterValues, inside
from rsym.surfaces.patch import Patch
from rsym.surfaces.transfinite import BooleanSum, Loft

SAMPLES = 65
# Mean cosine of the directions across with the way to the other line, below which it does not tell the side.
UNDECIDED = 0.05

# Taylor coefficients of a function of one parameter about every t: order by order.
Jet: TypeAlias = list[Floats]

ENDS_MEET = 1e-9


class TransitionSurface(BooleanSum):
    """The surface that leaves one patch across a line and enters another one across another line.

    p(t, w) = F0(w) r1(t) + F1(w) r2(t) + k1 G0(w) q1(t) + k2 G1(w) q2(t), 0 <= w <= 1, with r = s(u(t), v(t)) the
    lines on the patches s and q = +-(-v'(t) s_u + u'(t) s_v) their derivatives across; on an edge +-s_u or +-s_v. The
    normals are those of the patches along the whole lines (up to the sign of q). For class 3 the terms
    k1**2 H0(w) q1' and k2**2 H1(w) q2', with the second derivatives q' of the patches in the same directions, match
    the curvature too.

    Parameters
    ----------
    first, first_edge, second, second_edge : Patch, line
        A line is an edge, "u0", "u1", "v0" or "v1"; or (u(t), v(t)): two expressions or functions over [0, 1], one
        function of t, or a `Formula` of two expressions over its own interval. The parameter t of the first serves
        both. A closed line makes a closed surface.
    order : {2, 3}
        The class: 2 (cubic, G1) or 3 (quintic, G2).
    k1, k2 : numbers, expressions in t or functions, positive
        How far the surface keeps the direction that it starts with, and ends with.
    reverse : bool
        Whether the second line is run through from its end.
    sides : pair of "left", "right" or None
        To which side of each line, as its own t runs in the plane of (u, v), the surface goes. By default out of the
        first patch at its edge and into the second at its edge; from a line inside a patch towards the other line.
    blend : HermiteBlend, optional
        Of the class; cubic or quintic by default.
    letters : mapping, optional
        Of the lines and k1, k2: symbols or names to numbers or `rsym.Letter`. Those of the patches stay.

    Notes
    -----
    Golovanov, (3.7.4), with k1 = k2 = 1 and edges. Lines that are no edges are done as the theory of that section has
    it; the choice of sides and class 3 are ours.

    Examples
    --------
    >>> from rsym.surfaces.parametric import ParametricSurface
    >>> from rsym.surfaces.symbols import u, v
    >>> floor = ParametricSurface((u, v, 0))
    >>> wall = ParametricSurface((2, v, 1 + u))
    >>> fillet = TransitionSurface(floor, "u1", wall, "u0")
    >>> fillet(0.5, [0, 0.5, 1]).tolist()
    [[1.0, 0.5, 0.0], [1.625, 0.5, 0.375], [2.0, 0.5, 1.0]]
    >>> fillet.derivative(0.5, [0, 1], (0, 1)).tolist()
    [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]
    """

    def __init__(
        self,
        first: Patch,
        first_edge: Any,
        second: Patch,
        second_edge: Any,
        *,
        order: int = 2,
        k1: Any = 1,
        k2: Any = 1,
        reverse: bool = False,
        sides: tuple[str | None, str | None] = (None, None),
        blend: HermiteBlend | None = None,
        letters: Mapping[Any, Any] | None = None,
    ) -> None:
        functions = _blend(order, blend)
        patches, edges = (first, second), (first_edge, second_edge)
        lines = [as_line(patch, edge, letters) for patch, edge in zip(patches, edges, strict=True)]
        interval = lines[0].domain

        def placed(number: int, k: int, side: int = 1) -> Univariate:
            curve = Across(patches[number], lines[number], k, side)
            return on_interval(backwards(curve) if reverse and number else curve, *interval)

        self.sides = tuple(_side(number, patches[number], edges[number], sides[number], placed) for number in (0, 1))
        weights = [_positive(given, name, interval, letters) for given, name in ((k1, "k1"), (k2, "k2"))]
        rows: list[Univariate] = []
        for k in range(order):
            for number in (0, 1):
                curve = placed(number, k, self.sides[number])
                for _ in range(k):
                    curve = Weighted(weights[number], curve)
                rows.append(curve)
        super().__init__(along_v=Loft(functions.curve, Stack(rows)))
        self.order = order

    def _repr_latex_(self) -> str:
        """The sum, its functions and lines by name; `expression` writes them out."""
        terms = ["F_0(v)\\, r_1(u) + F_1(v)\\, r_2(u)", "k_1 G_0(v)\\, q_1(u) + k_2 G_1(v)\\, q_2(u)"]
        terms += ["k_1^2 H_0(v)\\, q_1'(u) + k_2^2 H_1(v)\\, q_2'(u)"] if self.order == 3 else []
        return f"$\\displaystyle p(u, v) = {' + '.join(terms)}$"


def _blend(order: int, given: HermiteBlend | None) -> HermiteBlend:
    known = {2: HermiteBlend.cubic, 3: HermiteBlend.quintic}
    if order not in known:
        raise RsymError(f"the class of a transition is 2 or 3, got {order!r}", code="class", remedy="order=2")
    blend = known[order]() if given is None else given
    if blend.order != order:
        raise RsymError(
            f"a transition of class {order} needs a blend of class {order}, got one of class {blend.order}",
            code="blend",
            remedy=f"order={blend.order}",
        )
    return blend


def _positive(given: Any, name: str, interval: tuple[float, float], letters: Mapping[Any, Any] | None) -> Univariate:
    """A positive number, expression or function as a curve with three equal components."""
    threefold = (lambda t: (given(t) + 0 * t,) * 3) if callable(given) else (given,) * 3
    weight = as_curve(threefold, letters, interval, what=name)
    values = weight(np.linspace(*interval, SAMPLES))[:, 0]
    if not values.min() > 0:
        place = interval[0] + (interval[1] - interval[0]) * int(values.argmin()) / (SAMPLES - 1)
        raise RsymError(
            f"{name} must be positive, got {values.min():.6g} at t = {place:.6g}",
            code="weight",
            remedy=f"sides= turns the surface to the other side; {name} says only how far it keeps its direction",
        )
    return weight


def _side(number: int, patch: Patch, edge: Any, asked: str | None, placed: Any) -> int:
    """1 for the left of the line, -1 for the right."""
    if asked is not None:
        if asked not in ("left", "right"):
            raise RsymError(
                f"a side is left or right of a line, got {asked!r}", code="side", remedy='sides=("left", None)'
            )
        return 1 if asked == "left" else -1
    if isinstance(edge, str):
        # A patch lies to the left of its boundary, run through anticlockwise.
        inwards = 1 if PatchEdge(patch, edge).anticlockwise else -1
        return inwards if number else -inwards
    low, high = placed(0, 0).domain
    places = np.linspace(low, high, SAMPLES)
    way = placed(1, 0)(places) - placed(0, 0)(places)
    share = float(np.mean(_cosines(placed(number, 1)(places), way)))
    if abs(share) < UNDECIDED:
        which = ("first", "second")[number]
        raise RsymError(
            f"on which side of the {which} line the transition goes does not show: the directions across it and the "
            f"way to the other line have a mean cosine of {share:.2g}",
            code="side",
            remedy='say it: sides=("left", None), left as t runs in the plane of (u, v)',
        )
    return 1 if share > 0 else -1


def _cosines(a: Floats, b: Floats) -> Floats:
    lengths = np.sqrt((a * a).sum(axis=-1) * (b * b).sum(axis=-1))
    return np.asarray((a * b).sum(axis=-1) / np.where(lengths > 0, lengths, 1.0))


# Lines on a patch, (u(t), v(t)), and the derivatives of the patch across them.
class Across(Univariate):
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

    def __init__(self, patch: Patch, line: Univariate, order: int, side: int = 1) -> None:
        self.patch, self.line, self.order, self.side = patch, line, order, side
        self.shape, self.domain = (3,), line.domain
        self.closed = line.closed
        self.letters = patch.letters.merge(line.letters)

    def evaluate(self, t: Floats, orders: Sequence[int], letters: LetterValues = None) -> list[Floats]:
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


class Weighted(Univariate):
    """The product, component by component, of two curves over one interval."""

    def __init__(self, weight: Univariate, curve: Univariate) -> None:
        self.weight, self.curve = weight, curve
        self.shape, self.domain, self.closed = curve.shape, curve.domain, curve.closed
        self.letters = curve.letters.merge(weight.letters)

    def evaluate(self, t: Floats, orders: Sequence[int], letters: LetterValues = None) -> list[Floats]:
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


def as_line(patch: Patch, given: Any, letters: Mapping[Any, Any] | None = None) -> Univariate:
    """A line on the patch: an edge by its name, or u(t), v(t) as expressions, functions, one function, or a curve.

    The parameter of an edge is that of the patch along it; expressions and functions run over [0, 1], a `Formula` of
    two expressions over its own interval.
    """
    if isinstance(given, str):
        return _edge(patch, given)
    if isinstance(given, Univariate) and given.shape in ((2,), (3,)):
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
    edge = PatchEdge(patch, name)
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
