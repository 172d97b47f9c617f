"""Straight lines of the plane, their chords and where they cross, in exact numbers wherever they were given so."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from types import MappingProxyType
from typing import Any, TypeAlias

import numpy as np
import sympy as sp
from scipy.integrate import quad

from rsym.backends.kernel import compile
from rsym.errors import RsymError
from rsym.model.shape import Shape
from rsym.model.symbols import as_expression, real_replacements, substitute, symbols_of, x, y
from rsym.surfaces.functions.formulas import exact
from rsym.surfaces.symbols import t

Point: TypeAlias = tuple[sp.Expr, sp.Expr]
# Rounding of float64 stays two decimals below this share of what it is compared with.
NEGLIGIBLE = 1e-12


@dataclass(frozen=True)
class Line:
    """The points with a*x + b*y = c.

    Examples
    --------
    >>> line = Line(*map(sp.Integer, (1, 1, 2)))
    >>> line, line.value, line.meet(Line(*map(sp.Integer, (1, -1, 0))))
    (x + y = 2, x + y - 2, (1, 1))
    """

    a: sp.Expr
    b: sp.Expr
    c: sp.Expr

    def __repr__(self) -> str:
        return f"{self.a * x + self.b * y} = {self.c}"

    @property
    def value(self) -> sp.Expr:
        """a*x + b*y - c."""
        return self.a * x + self.b * y - self.c

    def at(self, point: Point) -> sp.Expr:
        """The value at a point."""
        return sp.expand(self.a * point[0] + self.b * point[1] - self.c)

    @property
    def normal(self) -> tuple[float, float]:
        """(a, b)."""
        return float(self.a), float(self.b)

    @property
    def foot(self) -> Point:
        """The point next to the origin."""
        square = self.a**2 + self.b**2
        return self.a * self.c / square, self.b * self.c / square

    def meet(self, other: Line) -> Point:
        """The point that two lines share, which are not parallel."""
        area = self.a * other.b - self.b * other.a
        place = (self.c * other.b - self.b * other.c, self.a * other.c - self.c * other.a)
        return sp.radsimp(place[0] / area), sp.radsimp(place[1] / area)


@dataclass(frozen=True)
class Chord:
    """The segment middle + t*direction, t**2 <= square.

    The square keeps a chord of a disc rational, whose ends are not.

    Examples
    --------
    >>> diameter = Chord((sp.Integer(0), sp.Integer(0)), (sp.Integer(1), sp.Integer(1)), sp.Rational(1, 2))
    >>> diameter.ends
    ((-sqrt(2)/2, -sqrt(2)/2), (sqrt(2)/2, sqrt(2)/2))
    >>> diameter.mean(x * y), diameter.length
    (1/6, 2)
    """

    middle: Point
    direction: Point
    square: sp.Expr

    @property
    def ends(self) -> tuple[Point, Point]:
        """Its two points on the boundary."""
        half = sp.sqrt(self.square)
        (x0, y0), (dx, dy) = self.middle, self.direction
        return (x0 - half * dx, y0 - half * dy), (x0 + half * dx, y0 + half * dy)

    @property
    def length(self) -> sp.Expr:
        """The distance of the ends."""
        return 2 * sp.sqrt(self.square * (self.direction[0] ** 2 + self.direction[1] ** 2))

    def along(self, expression: sp.Expr) -> sp.Expr:
        """A function of x and y as one of t."""
        (x0, y0), (dx, dy) = self.middle, self.direction
        return substitute(expression, {x: x0 + dx * t, y: y0 + dy * t})

    def mean(self, expression: sp.Expr) -> sp.Expr:
        """The mean of a function of x and y: exact for what is a polynomial along the line, else by quadrature."""
        restricted = self.along(expression)
        if restricted.is_polynomial(t):
            powers = sp.Poly(restricted, t).terms()
            terms = [c * self.square ** (n // 2) / (n + 1) for (n,), c in powers if n % 2 == 0]
            return sp.radsimp(sp.expand(sum(terms, sp.S.Zero)))
        letters = [symbol.name for symbol in symbols_of(restricted) if symbol != t]
        if letters:
            raise RsymError(
                f"the mean of {expression} along a line is not found with {', '.join(letters)} in it",
                code="projection",
                remedy="put numbers for them, or give values and means instead of the function",
            )
        kernel = compile(Shape(expression, (x, y)))
        return self.mean_of(lambda px, py: float(kernel(px, py)["value"]))

    def mean_of(self, function: Any) -> sp.Float:
        """The mean of a callable function of two numbers, by adaptive quadrature."""
        (start, end) = np.array(self.ends, np.float64)

        def along(share: float) -> float:
            place = (1 - share) * start + share * end
            return float(function(float(place[0]), float(place[1])))

        # What is said beside value and error comes as a warning unless all is asked for.
        value, error = quad(along, 0.0, 1.0, epsabs=1e-13, epsrel=1e-13, limit=200, full_output=1)[:2]
        if not error <= 1e-9 * max(1.0, abs(value)):
            raise RsymError(
                f"the function has no mean along {start} to {end} that quadrature finds: {value:g} +- {error:g}",
                code="projection",
                remedy="give its means as numbers",
            )
        return sp.Float(value)


def real_expression(value: Any) -> sp.Expr:
    """A real expression; a symbol of another kind becomes the real one of its name."""
    expression = as_expression(value)
    return substitute(expression, real_replacements([expression]))


def real_constant(value: Any, what: str) -> sp.Expr:
    """A finite real number as SymPy holds it; a float is the shortest decimal that is read as it."""
    number = as_expression(value)
    if number.free_symbols or not number.is_real or not number.is_finite:
        raise RsymError(f"{what} must be a finite real number, got {number}", code="number")
    return exact(float(number)) if isinstance(number, sp.Float) else number


def point_of(given: Sequence[Any], what: str) -> Point:
    """A point of the plane as two numbers."""
    if not isinstance(given, list | tuple | np.ndarray | sp.Point) or len(given) != 2:
        raise RsymError(f"{what} must be a point (x, y), got {given!r}", code="point")
    return real_constant(given[0], what), real_constant(given[1], what)


def as_line(given: Any, where: str) -> Line:
    """A line from (a, b, c), from two points, or from an equation or expression in x and y.

    Examples
    --------
    >>> as_line((1, 2, 3), ""), as_line(((0, 0), (1, 1)), ""), as_line(sp.Eq(x, 2 * y + 1), "")
    (x + 2*y = 3, -x + y = 0, x - 2*y = 1)
    """
    if isinstance(given, sp.Expr | sp.Equality):
        a, b, c = _coefficients(given, where)
    elif isinstance(given, list | tuple | np.ndarray) and len(given) == 3:
        a, b, c = (real_constant(one, f"a coefficient of {where}") for one in given)
    elif isinstance(given, list | tuple | np.ndarray) and len(given) == 2:
        (x0, y0), (x1, y1) = (point_of(one, f"a point of {where}") for one in given)
        a, b = y0 - y1, x1 - x0
        c = sp.expand(a * x0 + b * y0)
    else:
        raise _no_line(given, where)
    if a == 0 and b == 0:
        raise RsymError(f"a line needs a or b other than 0, got {given!r}", code="line", where=where)
    return Line(a, b, c)


def _coefficients(given: sp.Expr | sp.Equality, where: str) -> tuple[sp.Expr, sp.Expr, sp.Expr]:
    """a, b and c of an equation or of an expression that is zero on the line."""
    difference = real_expression(given.lhs - given.rhs if isinstance(given, sp.Equality) else given)
    if set(symbols_of(difference)) - {x, y} or not difference.is_polynomial(x, y):
        raise _no_line(given, where)
    polynomial = sp.Poly(difference, x, y)
    if polynomial.total_degree() > 1:
        raise _no_line(given, where)
    a, b, c = (polynomial.coeff_monomial(one) for one in (x, y, 1))
    return tuple(real_constant(one, f"a coefficient of {where}") for one in (a, b, -c))


def _no_line(given: Any, where: str) -> RsymError:
    return RsymError(
        f"expected a line, got {given!r}",
        code="line",
        where=where,
        remedy="give (a, b, c) for a*x + b*y = c, two points, or an equation of first degree in x and y",
    )


Nodes: TypeAlias = Mapping[tuple[int, int], Point]


def crossings(lines: Sequence[Line], chords: Sequence[Chord]) -> Nodes:
    """The points where two lines cross, by the pair of their numbers.

    Raises
    ------
    RsymError
        Where three lines go through one point, or two cross outside of their chords.
    """
    pairs = combinations(range(len(lines)), 2)
    nodes = MappingProxyType({(i, j): lines[i].meet(lines[j]) for i, j in pairs})
    _refuse_concurrent(lines, chords, nodes)
    _refuse_outside(lines, chords, nodes)
    return nodes


def refuse_parallel(lines: Sequence[Line]) -> None:
    """Refuse lines of which two do not cross."""
    for (i, first), (j, second) in combinations(enumerate(lines), 2):
        (a, b), (c, d) = first.normal, second.normal
        if abs(a * d - b * c) <= NEGLIGIBLE * math.hypot(a, b) * math.hypot(c, d):
            raise RsymError(
                f"the lines {first} and {second} are parallel",
                code="lines",
                where=f"lines[{i}] and lines[{j}]",
                remedy="any two must cross: turn one of them, or leave one out",
            )


def _refuse_concurrent(lines: Sequence[Line], chords: Sequence[Chord], nodes: Nodes) -> None:
    reach = max(float(chord.length) for chord in chords)
    for (i, j), node in nodes.items():
        for k in range(j + 1, len(lines)):
            line = lines[k]
            if abs(float(line.at(node))) <= NEGLIGIBLE * reach * math.hypot(*line.normal):
                raise RsymError(
                    f"three lines go through one point, ({float(node[0]):g}, {float(node[1]):g})",
                    code="lines",
                    where=f"lines[{i}], lines[{j}] and lines[{k}]",
                    remedy="any two must cross at a point of their own: shift one of them",
                )


def _refuse_outside(lines: Sequence[Line], chords: Sequence[Chord], nodes: Nodes) -> None:
    for pair, node in nodes.items():
        for k in pair:
            chord = chords[k]
            steps = [float(d) for d in chord.direction]
            share = sum(float(p - m) * d for p, m, d in zip(node, chord.middle, steps, strict=True))
            half = math.sqrt(float(chord.square)) * math.hypot(*steps) ** 2
            if abs(share) > half * (1 + NEGLIGIBLE):
                raise RsymError(
                    f"the lines {lines[pair[0]]} and {lines[pair[1]]} cross outside the domain,"
                    f" at ({float(node[0]):g}, {float(node[1]):g})",
                    code="lines",
                    where=f"lines[{pair[0]}] and lines[{pair[1]}]",
                    remedy="widen the domain, or move one of the lines",
                )
