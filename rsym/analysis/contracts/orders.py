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
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any, TypeAlias

import sympy as sp

from rsym.analysis.contracts.algebras import Fractions, RandomLine, Series, TaylorSeries
from rsym.analysis.contracts.promises import Order, weakest
from rsym.analysis.contracts.towers import PRIME, Element, NotShown, Tower, element
from rsym.model.nodes import Held, RealNode, expand_nodes, without_zeros
from rsym.model.powers import AbsolutePower
from rsym.model.symbols import postorder

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


Value: TypeAlias = Any
Algebra: TypeAlias = Fractions | TaylorSeries

_ANGLE = 60  # parts of an angle or an exponent, which is expanded


class Evaluation:
    """The value of an expression in an algebra; roots are numbered as they are first met.

    Sines and cosines of c*m, c a number, are those of a fraction of m that all angles of the expression are whole
    multiples of, so sin(2 k z) and cos(k z) know of one another; powers and exponentials alike.
    """

    def __init__(self, algebra: Algebra, expression: sp.Expr, roots: dict[sp.Expr, int]) -> None:
        self.algebra: Any = algebra
        self._roots = roots
        self._shares = _shares(expression)
        self._circles: dict[sp.Expr, tuple[Value, Value]] = {}
        self.assumes = False  # whether quantities are taken as independent that need not be, so that nothing is refuted

    def value(self, expression: sp.Expr) -> Value:
        """The value."""
        known: dict[int, Value] = {}
        for part in postorder(expression):
            known[id(part)] = self._rule(part, [known[id(argument)] for argument in part.args])
        return known[id(expression)]

    def _rule(self, part: sp.Expr, inner: list[Value]) -> Value:
        if isinstance(part, sp.Rational):
            if part.q % PRIME == 0:
                raise NotShown
            return self.algebra.number(int(part.p) * pow(int(part.q), -1, PRIME))
        if isinstance(part, sp.Float):
            return self._rule(sp.Rational(part), [])
        if part.is_Symbol or isinstance(part, sp.NumberSymbol):
            return self.algebra.free(part)
        if part.is_Add:
            return _folded(self.algebra.add, inner)
        if part.is_Mul:
            return _folded(self.algebra.multiply, inner)
        if isinstance(part, sp.exp):
            return self._exponential(part.args[0])
        if part.is_Pow:
            return self._exponential(part.exp) if part.base == sp.E else self._power(part.base, part.exp, inner[0])
        if isinstance(part, sp.Abs):
            return self._size(part.args[0], inner[0])
        if isinstance(part, sp.Min | sp.Max):
            return self._extremum(part, inner)
        if isinstance(part, AbsolutePower):
            return self._absolute_power(part, inner[0])
        return self._function(part, inner)

    def _function(self, part: sp.Expr, inner: list[Value]) -> Value:
        if isinstance(part, Held):
            return inner[0]
        if isinstance(part, sp.sin | sp.cos | sp.tan):
            angle = part.args[0]
            if angle not in self._circles:
                self._circles[angle] = self._circle(angle)
            cosine, sine = self._circles[angle]
            ratio = isinstance(part, sp.tan)
            return self._over(sine, cosine) if ratio else sine if isinstance(part, sp.sin) else cosine
        if isinstance(part, sp.sinh | sp.cosh | sp.tanh):
            return self._hyperbolic(part)
        if isinstance(part, sp.log):
            self.assumes = True
            return self.algebra.integrated(self.algebra.free(part, "log"), [self.algebra.inverse(inner[0]), inner[0]])
        if isinstance(part, sp.atan2 | sp.atan):
            v, u = inner if len(inner) == 2 else (inner[0], self.algebra.number(1))
            return self._angle(part, v, u)
        raise NotShown

    def _over(self, f: Value, g: Value) -> Value:
        return self.algebra.multiply(f, self.algebra.inverse(g))

    def _raised(self, base: Value, exponent: int) -> Value:
        if exponent < 0:
            return self.algebra.inverse(self._raised(base, -exponent))
        if exponent > 60:
            raise NotShown
        return _folded(self.algebra.multiply, [base] * exponent) if exponent else self.algebra.number(1)

    def _rooted(self, key: sp.Expr, radicand: Value) -> Value:
        return self.algebra.root(self._roots.setdefault(key, len(self._roots)), radicand)

    def _size(self, base: sp.Expr, value: Value) -> Value:
        return self._rooted(base**2, self.algebra.multiply(value, value))

    def _extremum(self, part: sp.Expr, inner: list[Value]) -> Value:
        """(u + v -+ |u - v|)/2, folded; both branches of the root count."""
        half, (result, *rest) = self._over(self.algebra.number(1), self.algebra.number(2)), inner
        for k, value in enumerate(rest):
            gap = self.algebra.add(result, self._negated(value))
            size = self._rooted(sp.Tuple(part, k), self.algebra.multiply(gap, gap))
            total = self.algebra.add(result, value)
            turned = self._negated(size) if isinstance(part, sp.Min) else size
            result = self.algebra.multiply(half, self.algebra.add(total, turned))
        return result

    def _power(self, base: sp.Expr, exponent: sp.Expr, value: Value) -> Value:
        if exponent.is_Integer:
            return self._raised(value, int(exponent))
        if exponent.is_Rational and exponent.q == 2:
            whole, _ = divmod(int(exponent.p), 2)
            if exponent == sp.Rational(-1, 2):
                return self.algebra.inverse(self._rooted(base, value))
            return self.algebra.multiply(self._raised(value, whole), self._rooted(base, value))
        return self._general_power(base, exponent, value, lambda: value)

    def _absolute_power(self, part: AbsolutePower, value: Value) -> Value:
        base, exponent = part.args
        if exponent.is_Integer and exponent % 2 == 0:
            return self._raised(value, int(exponent))
        return self._general_power(sp.Abs(base, evaluate=False), exponent, value, lambda: self._size(base, value))

    def _general_power(self, base: sp.Expr, exponent: sp.Expr, value: Value, size: Callable[[], Value]) -> Value:
        """u**(k + c m + ...), k whole: u**k times whole powers of independent quantities u**(m/share)."""
        result = self.algebra.number(1)
        for coefficient, monomial in _terms(exponent):
            if monomial == 1:
                whole = int(sp.floor(coefficient))
                result = self.algebra.multiply(result, self._raised(size() if whole % 2 else value, whole))
                coefficient -= whole
            if coefficient:
                self.assumes = self.assumes or monomial == 1
                share = coefficient.q
                unit = self.algebra.free(sp.Tuple(base, monomial, share), "power")
                step = self._over(self.value(monomial), self.algebra.number(share))
                moved = self.algebra.moved(unit, value, step)
                result = self.algebra.multiply(result, self._raised(moved, int(coefficient.p)))
        return result

    def _circle(self, angle: sp.Expr) -> tuple[Value, Value]:
        """Cosine and sine of a sum, by the addition theorem."""
        cosine, sine = self.algebra.number(1), self.algebra.number(0)
        for coefficient, monomial in _terms(angle):
            share = self._shares.get(monomial, 1)
            unit = self._unit(monomial, share)
            count = int(coefficient * share)
            if abs(count) > 12:
                raise NotShown
            if count < 0:
                unit = unit[0], self.algebra.multiply(self.algebra.number(-1), unit[1])
            for _ in range(abs(count)):
                cosine, sine = self._turned(cosine, sine, *unit)
        return cosine, sine

    def _turned(self, c: Value, s: Value, cosine: Value, sine: Value) -> tuple[Value, Value]:
        add, multiply = self.algebra.add, self.algebra.multiply
        less = multiply(self.algebra.number(-1), multiply(s, sine))
        return add(multiply(c, cosine), less), add(multiply(s, cosine), multiply(c, sine))

    def _unit(self, monomial: sp.Expr, share: int) -> tuple[Value, Value]:
        """A point of the circle for m/share: (1 - t**2, 2 t)/(1 + t**2)."""
        number, multiply = self.algebra.number, self.algebra.multiply
        t = self.algebra.free(sp.Tuple(monomial, share), "angle")
        square = multiply(t, t)
        below = self.algebra.add(number(1), square)
        above = self.algebra.add(number(1), multiply(number(-1), square))
        pair = self._over(above, below), self._over(multiply(number(2), t), below)
        turned: tuple[Value, Value] = self.algebra.turned(pair, self._over(self.value(monomial), number(share)))
        return turned

    def _exponential(self, exponent: sp.Expr) -> Value:
        self.assumes = True
        result = self.algebra.number(1)
        for coefficient, monomial in _terms(exponent):
            share = self._shares.get(monomial, 1)
            unit = self.algebra.free(sp.Tuple(monomial, share), "exponential")
            grown = self.algebra.grown(unit, self._over(self.value(monomial), self.algebra.number(share)))
            result = self.algebra.multiply(result, self._raised(grown, int(coefficient * share)))
        return result

    def _hyperbolic(self, part: sp.Expr) -> Value:
        up, down = self._exponential(part.args[0]), self._exponential(-part.args[0])
        sine, cosine = self.algebra.add(up, self._negated(down)), self.algebra.add(up, down)
        if isinstance(part, sp.tanh):
            return self._over(sine, cosine)
        return self._over(sine if isinstance(part, sp.sinh) else cosine, self.algebra.number(2))

    def _negated(self, f: Value) -> Value:
        return self.algebra.multiply(self.algebra.number(-1), f)

    def _angle(self, part: sp.Expr, v: Value, u: Value) -> Value:
        """The derivative of atan2(v, u) is (u v' - v u')/(u**2 + v**2)."""
        self.assumes = True
        add, multiply = self.algebra.add, self.algebra.multiply
        below = self.algebra.inverse(add(multiply(u, u), multiply(v, v)))
        slopes = [multiply(u, below), v, self._negated(multiply(v, below)), u]
        return self.algebra.integrated(self.algebra.free(part, "angle"), slopes)


def _folded(function: Any, values: Sequence[Value]) -> Value:
    result, *rest = values
    for value in rest:
        result = function(result, value)
    return result


def _terms(expression: sp.Expr) -> list[tuple[sp.Rational, sp.Expr]]:
    """The terms of a sum: a number and what it multiplies."""
    if len(postorder(expression)) > _ANGLE:
        raise NotShown
    terms = (term.as_coeff_Mul(rational=True) for term in sp.Add.make_args(sp.expand(expression)))
    return [(sp.Rational(coefficient), monomial) for coefficient, monomial in terms if coefficient != 0]


def _shares(expression: sp.Expr) -> dict[sp.Expr, int]:
    """For what angles and exponents are multiples of, the common denominator."""
    result: dict[sp.Expr, int] = {}
    for part in postorder(expression):
        exponential = isinstance(part, sp.exp) or (part.is_Pow and part.base == sp.E)
        if exponential or isinstance(part, sp.sin | sp.cos | sp.tan | sp.sinh | sp.cosh | sp.tanh):
            for coefficient, monomial in _terms(part.exp if part.is_Pow else part.args[0]):
                result[monomial] = math.lcm(result.get(monomial, 1), int(coefficient.q))
    return result
