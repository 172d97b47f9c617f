"""Operators that interpolate at the crossings of lines and keep the means along them.

Lines omega_k = a_k x + b_k y - c_k = 0, k = 1 .. M, no two parallel and no three through one point, cross at the nodes
P_ij of a bounded convex domain D. <f>_k is the mean of f along the chord of line k, pi_k the product of all other
omega_m. With

    If = sum_ij f(P_ij) l_ij,   l_ij = prod omega_m / prod omega_m(P_ij), m other than i and j     (Chung and Yao 1977),
    Lf = If + sum_k (<f>_k - <If>_k) g_k/<g_k>_k,   g_k = pi_k ("min") or pi_k**2 ("squared"),

Lf = f at the nodes, <Lf>_k = <f>_k and LL = L. O. O. Lytvyn and Ye. L. Khurdei (2013) announce such operators for
M = 3 and 4; their page states the properties. The formulas are derived for rsym.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from types import MappingProxyType
from typing import Any

import numpy as np
import sympy as sp
from numpy.typing import ArrayLike, NDArray

from rsym.backends.kernel import compile
from rsym.errors import RsymError
from rsym.model.abridging import ROOM, in_words, weight
from rsym.model.letters import as_letters
from rsym.model.shape import Shape
from rsym.model.symbols import substitute, symbols_of, x, y
from rsym.surfaces.chords.domain_chords import as_domain, chord_of
from rsym.surfaces.chords.lines import (
    NEGLIGIBLE,
    Chord,
    Line,
    Nodes,
    as_line,
    crossings,
    real_expression,
    refuse_parallel,
)
from rsym.surfaces.parameters import LetterValues
from rsym.surfaces.parametric import ParametricSurface
from rsym.surfaces.patch import Domain
from rsym.surfaces.symbols import u, v

# In the mean, of the root mean square: below that "auto" takes the square. A mean of 0.2 makes g_k/<g_k>_k five times
# as large as its mean along the chord, beyond which the surface swings; squares stay below that for evenly cut chords.
WEAK = 0.2
KINDS = ("auto", "min", "squared")


@dataclass(frozen=True, init=False, eq=False)
class ProjectionOperator:
    """L: functions on a domain to polynomials with the same values at the nodes and the same means along the lines.

    Parameters
    ----------
    lines : sequence
        At least two: (a, b, c) for a*x + b*y = c, two points, or an equation of first degree in x and y.
    domain : Shape, expression in x and y, or corners
        Convex and bounded, >= 0 inside; or the corners of a convex polygon.
    kind : {"auto", "min", "squared"}
        "min" has the degree M - 1 and reproduces the polynomials of that degree, but does not exist where a mean
        <pi_k>_k is 0; "squared" has the degree 2M - 2, reproduces degree M - 2 and always exists. "auto" chooses line
        by line: "min" where |<pi_k>_k| > 0.2 rms(pi_k).

    Raises
    ------
    RsymError
        For less than two lines; two that are parallel or three through one point; a line that misses the domain, a
        node outside of it, a domain that is not convex or not bounded along a line; "min" where it does not exist.

    Examples
    --------
    >>> triangle = [(0, 0), (1, 0), (0, 1)]
    >>> L = ProjectionOperator([y, x, x + y - 1], triangle)
    >>> L.nodes[0, 1], L.kinds
    ((0, 0), ('min', 'min', 'min'))
    >>> L(x**2 + y).expression.expand()
    x**2 + y
    >>> L(L(x**5 * y)).expression.equals(L(x**5 * y).expression)
    True
    """

    lines: tuple[Line, ...]
    domain: Shape
    kind: str
    chords: tuple[Chord, ...]
    nodes: Nodes
    kinds: tuple[str, ...]

    def __init__(self, lines: Sequence[Any], domain: Any, kind: str = "auto") -> None:
        if kind not in KINDS:
            raise RsymError(f"no kind {kind!r}", code="kind", remedy=f"choose from {', '.join(KINDS)}")
        if len(lines) < 2:
            raise RsymError(f"expected at least two lines, got {len(lines)}", code="lines")
        store: Callable[[str, Any], None] = lambda name, value: object.__setattr__(self, name, value)  # noqa: E731
        store("lines", tuple(as_line(line, f"lines[{k}]") for k, line in enumerate(lines)))
        refuse_parallel(self.lines)
        store("domain", as_domain(domain))
        store("kind", kind)
        store("chords", tuple(chord_of(self.domain, line, f"lines[{k}]") for k, line in enumerate(self.lines)))
        store("nodes", crossings(self.lines, self.chords))
        store("kinds", tuple(self._kind_of(k) for k in range(len(self.lines))))

    @property
    def degree(self) -> int:
        """The degree of the polynomials Lf."""
        return len(self.lines) - 1 if set(self.kinds) == {"min"} else 2 * len(self.lines) - 2

    @property
    def reproduces(self) -> int:
        """The degree up to which Lf = f for polynomials f."""
        return len(self.lines) - 1 if set(self.kinds) == {"min"} else len(self.lines) - 2

    def __call__(self, f: Any) -> ProjectionInterpolant:
        """Lf of an expression in x and y, of a function of two numbers, or of another Lf."""
        if isinstance(f, ProjectionInterpolant):
            f = f.expression
        if callable(f) and not isinstance(f, sp.Basic):
            values = {ij: sp.Float(f(*map(float, node))) for ij, node in self.nodes.items()}
            return self.of_data(values, [chord.mean_of(f) for chord in self.chords])
        function = real_expression(f)
        values = {ij: function.subs(dict(zip((x, y), node, strict=True))) for ij, node in self.nodes.items()}
        return self.of_data(values, [chord.mean(function) for chord in self.chords])

    def of_data(
        self,
        values: Mapping[tuple[int, int], Any] | Sequence[Any],
        means: Sequence[Any] | None = None,
        *,
        integrals: Sequence[Any] | None = None,
    ) -> ProjectionInterpolant:
        """Lf of numbers or expressions: values at the nodes, by pair or in the order of `nodes`; one mean per line.

        Integrals along the chords may be given in place of the means.

        Examples
        --------
        >>> L = ProjectionOperator([y, x], [(0, 0), (1, 0), (0, 1)])
        >>> L.of_data([sp.Symbol("f")], [sp.Symbol("m_x"), sp.Symbol("m_y")]).expression
        f + 2*x*(-f + m_x) + 2*y*(-f + m_y)
        """
        if (means is None) == (integrals is None):
            raise RsymError("give either the means along the lines or the integrals", code="projection")
        given = means if integrals is None else integrals
        count = len(self.lines)
        pairs = list(self.nodes)
        if not isinstance(values, Mapping):
            values = dict(zip(pairs, values, strict=True)) if len(values) == len(pairs) else {}
        if set(values) != set(pairs) or given is None or len(given) != count:
            raise RsymError(
                f"{count} lines need {len(pairs)} values at the nodes and {count} projections along the lines,"
                f" got {len(values)} and {len(given or ())}",
                code="projection",
                remedy=f"the nodes are {', '.join(map(str, pairs))}",
            )
        data = {ij: _datum(values[ij], f"the value where lines[{ij[0]}] and lines[{ij[1]}] cross") for ij in pairs}
        numbers = [_datum(one, f"the projection along lines[{k}]") for k, one in enumerate(given)]
        if integrals is not None:
            numbers = [one / chord.length for one, chord in zip(numbers, self.chords, strict=True)]
        return ProjectionInterpolant(self, MappingProxyType(data), tuple(numbers))

    def product(self, *left_out: int) -> sp.Expr:
        """The product of the omega_m of all lines but some."""
        return sp.Mul(*(line.value for m, line in enumerate(self.lines) if m not in left_out))

    @cached_property
    def node_functions(self) -> Mapping[tuple[int, int], sp.Expr]:
        """The l_ij: 1 at one node, 0 at all others."""
        result = {}
        for (i, j), node in self.nodes.items():
            others = [line.at(node) for m, line in enumerate(self.lines) if m not in (i, j)]
            result[i, j] = sp.radsimp(1 / sp.Mul(*others)) * self.product(i, j)
        return MappingProxyType(result)

    @cached_property
    def line_functions(self) -> tuple[sp.Expr, ...]:
        """The g_k/<g_k>_k: 0 at the nodes and along all lines but one, along which their mean is 1."""
        result = []
        for k, (chord, kind) in enumerate(zip(self.chords, self.kinds, strict=True)):
            g = self.product(k) if kind == "min" else self.product(k) ** 2
            result.append(sp.radsimp(1 / chord.mean(g)) * g)
        return tuple(result)

    def _kind_of(self, k: int) -> str:
        """What is asked for, or what serves line k."""
        if self.kind == "squared":
            return "squared"
        product = self.product(k)
        mean, square = (float(self.chords[k].mean(one)) for one in (product, product**2))
        share = abs(mean) / math.sqrt(square)
        if self.kind == "auto":
            return "min" if share > WEAK else "squared"
        if share < NEGLIGIBLE:
            raise RsymError(
                f"the operator of the kind 'min' does not exist: along {self.lines[k]} the product of the other lines"
                " has the mean 0, so the mean of f cannot be met",
                code="no-operator",
                where=f"lines[{k}]",
                remedy="kind='auto' or 'squared', or move a line",
            )
        return "min"


@dataclass(frozen=True, eq=False)
class ProjectionInterpolant:
    """Lf: the polynomial with given values at the nodes and given means along the lines.

    Attributes
    ----------
    operator : ProjectionOperator
    values : mapping
        f(P_ij) by pair of lines.
    means : tuple
        <f>_k by line.

    Examples
    --------
    >>> L = ProjectionOperator([y, x, x + y - 1], [(0, 0), (1, 0), (0, 1)])
    >>> f = L(lambda px, py: px * py)
    >>> f(0.25, [0.25, 0.5]).round(12).tolist()
    [0.0625, 0.125]
    >>> f.graph(((0, 1), (0, 1)))(0.25, 0.5).round(12).tolist()
    [0.25, 0.5, 0.125]
    """

    operator: ProjectionOperator
    values: Mapping[tuple[int, int], sp.Expr]
    means: tuple[sp.Expr, ...]

    @cached_property
    def expression(self) -> sp.Expr:
        """Lf(x, y), products of lines kept."""
        cardinals = self.operator.node_functions
        result = sp.Add(*(self.values[ij] * cardinals[ij] for ij in cardinals))
        for k, (mean, function) in enumerate(zip(self.means, self.operator.line_functions, strict=True)):
            chord = self.operator.chords[k]
            # Along a line only the node functions of its own nodes are not 0.
            own = [self.values[ij] * chord.mean(cardinals[ij]) for ij in cardinals if k in ij]
            result += sp.expand(mean - sp.Add(*own)) * function
        return result

    def __call__(self, px: ArrayLike, py: ArrayLike, *, letters: LetterValues = None) -> NDArray[np.float64]:
        """Values at coordinates that broadcast; symbols among the data take their numbers from `letters`."""
        return np.asarray(compile(self.shape(letters))(px, py)["value"])

    def shape(self, letters: LetterValues = None) -> Shape:
        """Lf as a shape of the plane, for level lines and derivatives; symbols among the data are its letters."""
        bounds = self.operator.domain.bounds
        return Shape(self.expression, (x, y), letters=as_letters(letters), bounds=bounds)

    def graph(self, bounds: Domain, letters: LetterValues = None) -> ParametricSurface:
        """The surface z = Lf(x, y) over a rectangle ((xmin, xmax), (ymin, ymax)), with u = x and v = y."""
        height = substitute(self.expression, {x: u, y: v})
        return ParametricSurface((u, v, height), bounds, letters=letters)

    def _repr_latex_(self) -> str:
        if weight(self.expression, ROOM) > ROOM:
            return rf"$L f: \text{{{in_words(self.expression)}}}$"
        names = {symbol: sp.latex(symbol) for symbol in symbols_of(self.expression)}
        return rf"$\displaystyle L f = {sp.latex(self.expression, symbol_names=names)}$"


def _datum(value: Any, what: str) -> sp.Expr:
    """A number or an expression without x and y."""
    datum = real_expression(value)
    if {x, y} & set(symbols_of(datum)):
        raise RsymError(f"{what} depends on x or y: {datum}", code="projection", remedy="operator(f) takes functions")
    if datum.is_number and not (datum.is_real and datum.is_finite):
        raise RsymError(f"{what} must be a finite real number, got {datum}", code="number")
    return datum
