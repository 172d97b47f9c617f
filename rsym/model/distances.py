"""Leaves that are functions of a distance alone, and that distance.

A function f whose gradient has a length that depends on the value of f alone is called transnormal: its level sets are
parallel. Where |grad f|**2 = A - B*f with constants A > 0 and B, as for a plane (B = 0) and for every leaf
(R**2 - d**2)/(2*R), where A = 1 and B = 2/R, the signed distance from f = 0 is

    2*f/(sqrt(A) + sqrt(A - B*f)) = (2/B)*(sqrt(A) - sqrt(A - B*f)),

exact as far as the focal set A = B*f: the middle of a slab, the axis of a cylinder, the centre of a ball, the circle
within a torus. The identity is held against 32 random places at four scales, to 25 of 40 digits.

Source: Wang, "Isoparametric functions on Riemannian manifolds I" (1987), for the name.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from random import Random
from typing import Any, TypeAlias

import sympy as sp
from mpmath import isfinite, mpf, workdps  # what SymPy evaluates with

from rsym.model.arguments import LetterMapping, default
from rsym.model.nodes import RealNode, Scaled, expand_nodes, written_out
from rsym.model.symbols import postorder, substitute, symbols_of

Coordinates: TypeAlias = tuple[sp.Symbol, ...]

PARTS = 400  # of a leaf: a capsule along (1, 2, 3) has 120
SCALES, AT_EACH = (0.1, 1.0, 10.0, 100.0), 8  # random places
DIGITS = 40
EXACT, ROUNDED = 1e-25, 1e-9  # what is nothing beside the sizes of the terms: of exact numbers, and of floats
SIMPLE = 10**6  # the largest denominator of what is taken for a fraction


@dataclass(frozen=True)
class Transnormal:
    """A function with |grad f|**2 = slope**2 - bend*f; its sign and its zero set are those of the leaf."""

    function: sp.Expr
    coordinates: Coordinates
    slope: sp.Expr
    bend: sp.Expr

    def distance(self, letters: LetterMapping = None) -> sp.Expr:
        """The signed distance from f = 0.

        Examples
        --------
        >>> from rsym import x, y
        >>> transnormal((4 - x**2 - y**2) / 4, (x, y)).distance()
        2 - sqrt(x**2 + y**2)
        """
        if self.bend == 0:
            return self.function / self.slope
        radius = 2 * self.slope / self.bend
        return radius - (1 if default(radius, letters) > 0 else -1) * self._from_the_middle(radius)

    def _from_the_middle(self, radius: sp.Expr) -> sp.Expr:
        """The distance from the focal set: sqrt(radius**2 - 2*radius*f/slope), rounding set aside."""
        moving = set(self.coordinates)
        varying = [part for part in sp.Mul.make_args(self.function) if part.free_symbols & moving]
        across = sp.expand(sp.Add(*varying))
        if len(varying) == 2 and not across.free_symbols & moving:  # (b - s)*(s - a)
            return sp.Abs(radius * sp.expand(varying[0] - varying[1]) / across)
        square = sp.expand_mul(radius**2) - sp.expand_mul(2 * radius * self.function / self.slope)
        sums = all(_is_square(term) for term in sp.Add.make_args(square))
        return sp.sqrt(square) if sums else sp.sqrt(sp.Abs(square, evaluate=False))

    def moved(self, distance: sp.Expr, letters: LetterMapping = None) -> sp.Expr:
        """A function that is zero where the signed distance is -distance, normalised to order 1 there.

        It is as smooth as f where numbers tell that the level set lies before the focal set.

        Examples
        --------
        >>> import sympy as sp
        >>> from rsym import x, y
        >>> disc = transnormal((4 - x**2 - y**2) / 4, (x, y))
        >>> disc.moved(sp.Integer(2)), disc.moved(sp.Integer(-3))
        (-x**2/8 - y**2/8 + 2, -sqrt(x**2 + y**2) - 1)
        """
        if self.bend == 0:
            return self.function / self.slope + distance
        slope = self.slope + self.bend * distance / 2
        if not (slope.is_number and slope > 0):
            return self.distance(letters) + distance
        return (self.function + self.slope * distance + self.bend * distance**2 / 4) / slope


@lru_cache(maxsize=4096)
def transnormal(leaf: sp.Expr, coordinates: Coordinates) -> Transnormal | None:
    """The leaf as a function of a distance, up to a positive factor; None where that is not shown.

    Examples
    --------
    >>> from rsym import x, y
    >>> transnormal(3 * x + 4 * y - 2, (x, y))
    Transnormal(function=3*x + 4*y - 2, coordinates=(x, y), slope=5, bend=0)
    >>> transnormal(1 - x**2 - 2 * y**2, (x, y)) is None
    True
    """
    function = _without_roots_below(leaf.args[0] if isinstance(leaf, Scaled) else leaf)
    plain = _plain(function)
    if plain is None or not plain.free_symbols & set(coordinates):
        return None
    slopes = [sp.diff(plain, symbol) for symbol in coordinates]
    near = ROUNDED if plain.has(sp.Float) else EXACT
    squares = sp.Add(*(slope**2 for slope in slopes))
    with workdps(DIGITS):
        if squares.is_number:
            groups: list[tuple[Any, Any] | None] = [(mpf(sp.N(squares, DIGITS)), mpf(0))]
        else:
            values = _values([plain, squares], coordinates)
            groups = [None] if values is None else [_constants(group, near) for group in values]
        constants = [found for found in groups if found is not None]
        if len(constants) < len(groups):
            return None
        square, bend = (_common(numbers, near) for numbers in zip(*constants, strict=True))
    if square is None or not square > 0:
        return None
    if bend is None:  # an expression in letters, from one place
        place = dict(zip(coordinates, map(sp.Integer, (1, 2, 3)), strict=False))
        value, size = (substitute(part, place) for part in (plain, squares))
        bend = _cancelled((square - size) / value)
    return Transnormal(function, coordinates, sp.sqrt(square), bend)


def _cancelled(ratio: sp.Expr) -> sp.Expr:
    """A ratio in lowest terms, sine and cosine of a number being fractions of the tangent of its half."""
    halves = {angle: sp.Dummy() for part in ratio.atoms(sp.sin, sp.cos) if (angle := part.args[0]).is_number}
    fractions = {sp.sin(angle): 2 * half / (1 + half**2) for angle, half in halves.items()}
    fractions |= {sp.cos(angle): (1 - half**2) / (1 + half**2) for angle, half in halves.items()}
    cancelled = sp.cancel(ratio.xreplace(fractions))
    return cancelled.xreplace({half: sp.tan(angle / 2) for angle, half in halves.items()})


def _plain(leaf: sp.Expr) -> sp.Expr | None:
    """The leaf in elementary functions, if it is not too long."""
    if len(postorder(leaf)) > PARTS:
        return None
    plain = expand_nodes(written_out(leaf)) if leaf.has(RealNode) else leaf
    return plain if len(postorder(plain)) <= PARTS else None


def _without_roots_below(leaf: sp.Expr) -> sp.Expr:
    """A product without the roots that it is divided by, which are positive."""
    kept = [part for part in sp.Mul.make_args(leaf) if part.is_number or not _divides_by_a_root(part)]
    return sp.Mul(*kept) if len(kept) < len(sp.Mul.make_args(leaf)) else leaf


def _divides_by_a_root(part: sp.Expr) -> bool:
    return bool(part.is_Pow and part.exp.is_Rational and part.exp.q == 2 and part.exp < 0)


def _values(parts: Sequence[sp.Expr], coordinates: Coordinates) -> list[list[list[Any]]] | None:
    """The parts at random places, for some choices of letters; None where too many have no value."""
    letters = [symbol for symbol in symbols_of(*parts) if symbol not in coordinates]
    function: Callable[..., Any] = sp.lambdify((*coordinates, *letters), list(parts), modules="mpmath")
    draw, groups = Random(1), []
    for _ in range(3 if letters else 1):
        chosen = [mpf(draw.uniform(0.3, 3.0)) for _ in letters]
        group = []
        for scale in SCALES:
            for _ in range(AT_EACH):
                place = [mpf(draw.uniform(-scale, scale)) for _ in coordinates]
                try:
                    value = function(*place, *chosen)
                except (ValueError, ZeroDivisionError, TypeError, OverflowError):
                    continue
                if all(not hasattr(one, "imag") or one.imag == 0 for one in value) and all(map(isfinite, value)):
                    group.append([one.real if hasattr(one, "real") else one for one in value])
        if len(group) < len(SCALES) * AT_EACH // 2:
            return None
        groups.append(group)
    return groups


def _constants(group: Sequence[Sequence[Any]], near: float) -> tuple[Any, Any] | None:
    """A and B of |grad f|**2 = A - B f, from the places with the least and the largest value."""
    low, high = min(group, key=lambda pair: pair[0]), max(group, key=lambda pair: pair[0])
    if low[0] == high[0]:
        return None
    bend = (low[1] - high[1]) / (high[0] - low[0])
    square = low[1] + bend * low[0]
    fits = all(abs(g - square + bend * f) <= near * (abs(g) + abs(square) + abs(bend * f)) for f, g in group)
    if not fits:
        return None
    largest = max(abs(f) for f, _ in group)
    return square, 0 if abs(bend) * largest <= near * abs(square) else bend


def _common(numbers: Sequence[Any], near: float) -> sp.Expr | None:
    """One number for all choices of letters, a fraction if it is one; None where they differ."""
    first, close = numbers[0], 1e3 * EXACT if near == EXACT else 4e-14
    if any(abs(number - first) > 1e3 * near * abs(first) for number in numbers):
        return None
    value = sp.Float(str(first), DIGITS)
    for candidate, power in ((value, sp.S.One), (value**2, sp.S.Half)):
        fraction = sp.Rational(str(candidate)).limit_denominator(SIMPLE)
        if abs(fraction - candidate) <= close * abs(candidate):
            return fraction**power * (1 if value >= 0 or power == 1 else -1)
    return sp.Float(float(first))


def _is_square(term: sp.Expr) -> bool:
    coefficient, rest = term.as_coeff_Mul()
    return bool(coefficient > 0 and rest.is_nonnegative)
