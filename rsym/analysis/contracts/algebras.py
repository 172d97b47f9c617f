"""Two ways to evaluate a leaf along a random line: as a fraction, and as a Taylor series on its zeros."""

from __future__ import annotations

from collections.abc import Sequence
from random import Random
from typing import Any, TypeAlias

import sympy as sp

from rsym.analysis.contracts.towers import PRIME, Element, NotShown, Polynomial, Tower, common_divisor, divided, element

Fraction: TypeAlias = tuple[Element, Element]
Series: TypeAlias = list[Element]


class RandomLine:
    """Random values: all quantities are numbers but one, which is the unknown of the polynomials.

    They are drawn from the name of what is asked for, and so are the same each time.
    """

    def __init__(self, coordinates: Sequence[sp.Symbol], varied: tuple[sp.Expr, str] | None = None) -> None:
        self._coordinates = frozenset(coordinates)
        self._varied = varied
        self.varying: dict[tuple[sp.Expr, str], None] = {}  # what has been asked for and varies in space

    def along(self, varied: tuple[sp.Expr, str]) -> RandomLine:
        """The line along which one quantity varies."""
        return RandomLine(tuple(self._coordinates), varied)

    def at(self, quantity: Any, name: str = "") -> Polynomial:
        """The value of a symbol, or of an independent quantity that belongs to an expression."""
        if quantity.free_symbols & self._coordinates:
            self.varying[quantity, name] = None
        draw = Random(f"{name} {sp.srepr(quantity)}")
        start, step = draw.randrange(1, PRIME), draw.randrange(1, PRIME)
        return (start, step) if (quantity, name) == self._varied else (start,)


class Fractions:
    """Numerators and denominators, for the zeros of a leaf."""

    def __init__(self, line: RandomLine) -> None:
        self.line, self.tower = line, Tower()
        self.poles: list[Polynomial] = []

    def number(self, value: int) -> Fraction:
        """A whole number."""
        return element(value), element(1)

    def free(self, quantity: sp.Expr, name: str = "") -> Fraction:
        """An independent quantity."""
        return {0: self.line.at(quantity, name)}, element(1)

    def add(self, f: Fraction, g: Fraction) -> Fraction:
        """The sum."""
        (a, b), (c, d) = f, g
        add, multiply = self.tower.add, self.tower.multiply
        if b == d:
            return _cancelled(add(a, c), b)
        return _cancelled(add(multiply(a, d), multiply(c, b)), multiply(b, d))

    def multiply(self, f: Fraction, g: Fraction) -> Fraction:
        """The product."""
        return _cancelled(self.tower.multiply(f[0], g[0]), self.tower.multiply(f[1], g[1]))

    def inverse(self, f: Fraction) -> Fraction:
        """Return 1/f."""
        if not f[0]:
            raise NotShown
        self._note_poles(f[0])
        return f[1], f[0]

    def _note_poles(self, f: Element) -> None:
        """What has a single term is zero where a factor of it is."""
        if len(f) == 1:
            ((roots, polynomial),) = f.items()
            self.poles.append(polynomial)
            for radicand in self.tower.radicands_of(roots):
                self._note_poles(radicand)

    def root(self, number: int, f: Fraction) -> Fraction:
        """The square root of n/d, sqrt(n*d)/d."""
        self.tower.scales[number] = f[1]
        return self.tower.root(number, self.tower.multiply(*f)), f[1]

    def moved(self, quantity: Fraction, base: Fraction, exponent: Fraction) -> Fraction:
        """A power of a base: an independent quantity."""
        return quantity

    def turned(self, pair: tuple[Fraction, Fraction], angle: Fraction) -> tuple[Fraction, Fraction]:
        """Cosine and sine of an angle: a point of the circle."""
        return pair

    def grown(self, quantity: Fraction, exponent: Fraction) -> Fraction:
        """An exponential: an independent quantity."""
        return quantity

    def integrated(self, quantity: Fraction, slope: Any) -> Fraction:
        """A logarithm or an angle: an independent quantity."""
        return quantity


def _cancelled(numerator: Element, denominator: Element) -> Fraction:
    """Common factors of all polynomials taken out."""
    divisor: Polynomial = ()
    for polynomial in (*denominator.values(), *numerator.values()):
        divisor = common_divisor(polynomial, divisor)
        if len(divisor) == 1:
            return numerator, denominator
    return _over(numerator, divisor), _over(denominator, divisor)


def _over(f: Element, divisor: Polynomial) -> Element:
    return {roots: divided(polynomial, divisor)[0] for roots, polynomial in f.items()}


class TaylorSeries:
    """Series in the distance along a direction, on the zeros of a leaf."""

    def __init__(self, line: RandomLine, tower: Tower, directions: dict[sp.Symbol, Element], length: int) -> None:
        self.line, self.tower, self.directions, self.length = line, tower, directions, length

    def number(self, value: int) -> Series:
        """A whole number."""
        return self._constant(element(value))

    def _constant(self, value: Element) -> Series:
        return [value, *({} for _ in range(self.length - 1))]

    def free(self, quantity: sp.Expr, name: str = "") -> Series:
        """A coordinate, which moves, or a quantity that stands for one."""
        result = self._constant(self.tower.reduced({0: self.line.at(quantity, name)}))
        if quantity in self.directions and not name:
            result[1] = self.directions[quantity]
        return result

    def add(self, f: Series, g: Series) -> Series:
        """The sum."""
        return [self.tower.add(u, v) for u, v in zip(f, g, strict=True)]

    def multiply(self, f: Series, g: Series) -> Series:
        """The product, cut off."""
        result: Series = [{} for _ in range(self.length)]
        for i, u in enumerate(f):
            for j, v in enumerate(g[: self.length - i]):
                if u and v:
                    result[i + j] = self.tower.add(result[i + j], self.tower.multiply(u, v))
        return result

    def inverse(self, f: Series) -> Series:
        """Return 1/f."""
        first = self.tower.inverse(f[0])
        result = [first]
        for k in range(1, self.length):
            known = _convolved(self.tower, f, result, k)
            result.append(self.tower.scale(-1, self.tower.multiply(first, known)))
        return result

    def root(self, number: int, f: Series) -> Series:
        """The square root."""
        first = self.tower.root(number, f[0])
        half = self.tower.inverse(self.tower.scale(2, first))
        result = [first]
        for k in range(1, self.length):
            known: Element = {}
            for i in range(1, k):
                known = self.tower.add(known, self.tower.multiply(result[i], result[k - i]))
            rest = self.tower.add(f[k], self.tower.scale(-1, known))
            result.append(self.tower.multiply(half, rest))
        return result

    def moved(self, quantity: Series, base: Series, exponent: Series) -> Series:
        """A power P of a base u: u P' = a P u'."""
        first = self.tower.inverse(base[0])
        result = [quantity[0]]
        for k in range(1, self.length):
            total: Element = {}
            for i in range(1, k + 1):
                weight = self.tower.add(self.tower.scale(i, exponent[0]), element(i - k))
                step = self.tower.multiply(weight, self.tower.multiply(base[i], result[k - i]))
                total = self.tower.add(total, step)
            result.append(self.tower.multiply(first, self.tower.scale(pow(k, -1, PRIME), total)))
        return result

    def turned(self, pair: tuple[Series, Series], angle: Series) -> tuple[Series, Series]:
        """Cosine and sine of an angle u: c' = -s u', s' = c u'."""
        cosine, sine = [pair[0][0]], [pair[1][0]]
        for k in range(1, self.length):
            share = pow(k, -1, PRIME)
            falls = self.tower.scale(-share, _weighted(self.tower, angle, sine, k))
            grows = self.tower.scale(share, _weighted(self.tower, angle, cosine, k))
            cosine.append(falls)
            sine.append(grows)
        return cosine, sine

    def grown(self, quantity: Series, exponent: Series) -> Series:
        """An exponential e of u: e' = e u'."""
        result = [quantity[0]]
        for k in range(1, self.length):
            result.append(self.tower.scale(pow(k, -1, PRIME), _weighted(self.tower, exponent, result, k)))
        return result

    def integrated(self, quantity: Series, slope: Any) -> Series:
        """What has the derivative slope[0]*slope[1]' + slope[2]*slope[3]' and so on."""
        result = [quantity[0], *({} for _ in range(self.length - 1))]
        for factor, inner in zip(slope[::2], slope[1::2], strict=True):
            for k in range(1, self.length):
                share = self.tower.scale(pow(k, -1, PRIME), _weighted(self.tower, inner, factor, k))
                result[k] = self.tower.add(result[k], share)
        return result


def _convolved(tower: Tower, f: Series, g: Series, k: int) -> Element:
    """The sum of f_i g_(k - i), i from 1."""
    result: Element = {}
    for i in range(1, k + 1):
        result = tower.add(result, tower.multiply(f[i], g[k - i]))
    return result


def _weighted(tower: Tower, f: Series, g: Series, k: int) -> Element:
    """The sum of i f_i g_(k - i): k times the coefficient k of what has the derivative f' g."""
    result: Element = {}
    for i in range(1, k + 1):
        result = tower.add(result, tower.scale(i, tower.multiply(f[i], g[k - i])))
    return result
