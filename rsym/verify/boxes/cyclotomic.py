"""Numbers of turns: cosines and sines of fractions of a turn, and roots of fractions, as elements of one real field.

With a = 2 cos(2 pi/M) the field Q(a) holds 2 cos(2 pi k/M) = C_k(a), where C_0 = 2, C_1 = a, C_{k+1} = a C_k - C_{k-1}.
It holds the sines for a multiple M of 4, and the root of a whole number D for a multiple M of 4 D. An element is a
polynomial in a with rational coefficients, of a degree below that of the minimal polynomial of a: it is zero if these
are. So equality is decided, which no enclosure does; the sign of what is not zero is that of an enclosure.

Other roots, as sqrt(2 + sqrt(2)) = 2 cos(pi/8), are guessed by a relation of whole numbers between enclosures, and
proved by their square and their sign.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from functools import cached_property
from math import comb, lcm
from typing import Any

import sympy as sp
from flint import fmpz, fmpz_mat, fmpz_poly

from rsym.bounds.balls import arb, ctx, exact

HIGHEST = 40  # degree of a field; a fan of 48 sectors takes 32
GUARD = 32  # bits for each element of a relation that is guessed
FIRST = 128  # bits of the first enclosure of a sign


class Field:
    """Q(2 cos(2 pi/M)). Elements are those of its `domain`, the field as SymPy knows it.

    Examples
    --------
    >>> field = Field(16)
    >>> cosine = field.cosine(Fraction(1, 16))
    >>> root = field.root(field.domain.one * 2)
    >>> cosine**2 * 4 == field.domain.one * 2 + root, field.sign(cosine - root), field.written(root)
    (True, -1, 2*cos(pi/4))
    """

    def __init__(self, order: int) -> None:
        self.order = order // 2 if order % 4 == 2 else order
        minimal = fmpz_poly.cos_minpoly(self.order)
        self.degree = minimal.degree()
        self.domain: Any = sp.QQ
        self._generator: Any = sp.QQ(int(-minimal[0]))
        if self.degree > 1:
            symbol = sp.Dummy()
            polynomial = sp.Poly([int(minimal[k]) for k in range(self.degree, -1, -1)], symbol, domain=sp.QQ)
            self.domain = sp.QQ.algebraic_field((polynomial, 2 * _cosine(Fraction(1, self.order))))
            self._generator = self.domain([1, 0])

    @staticmethod
    def degree_of(order: int) -> int:
        """The degree of the field of an M."""
        return max(1, int(fmpz(order).euler_phi()) // 2)

    @cached_property
    def basis(self) -> Sequence[Any]:
        """1 and C_k(a) for all k below the degree."""
        found = [self.domain.one * 2, self._generator]
        while len(found) < self.degree:
            found.append(self._generator * found[-1] - found[-2])
        return [self.domain.one, *found[1 : self.degree]]

    def rational(self, value: Fraction) -> Any:
        """A fraction as an element."""
        return self.domain.convert(sp.QQ(value.numerator, value.denominator))

    def cosine(self, share: Fraction) -> Any:
        """The cosine of this share of a turn; None where it is not in the field."""
        for half in (False, True):  # cos(t) = -cos(t + pi)
            steps = (share + Fraction(half, 2)) * self.order
            if steps.denominator == 1:
                double = self._multiple(int(steps) % self.order) / (self.domain.one * 2)
                return -double if half else double
        return None

    def _multiple(self, k: int) -> Any:
        before, now = self.domain.one * 2, self._generator
        if k == 0:
            return before
        for _ in range(min(k, self.order - k) - 1):
            before, now = now, self._generator * now - before
        return now

    def sign(self, element: Any) -> int:
        """1, 0 or -1."""
        if element == self.domain.zero:
            return 0
        precision = FIRST
        while True:
            with ctx.workprec(precision):
                value = self.enclosure(element)
                if value > 0 or value < 0:
                    return 1 if value > 0 else -1
            precision *= 2

    def enclosure(self, element: Any) -> arb:
        """A ball around an element at the working precision."""
        shares = self._shares(element)
        return sum((exact(part) * self._balls()[k] for k, part in enumerate(shares)), arb(0))

    def _balls(self) -> Sequence[arb]:
        """The elements of the basis."""
        return [arb(1), *((2 * (2 * k * arb.pi() / self.order).cos()) for k in range(1, self.degree))]

    def _shares(self, element: Any) -> list[Fraction]:
        """The element as a sum over the basis: a**k is the sum of comb(k, i) exp(2 pi (k - 2i)/M) over i."""
        powers = list(reversed(element.to_list())) if self.degree > 1 else [element]
        found = [Fraction(0)] * self.degree
        for k, value in enumerate(powers):
            factor = Fraction(int(value.numerator), int(value.denominator))
            for i in range(k // 2 + 1):
                found[k - 2 * i] += factor * comb(k, i)
        return found

    def written(self, element: Any) -> sp.Expr:
        """The element by fractions and cosines."""
        parts = [sp.Rational(share.numerator, share.denominator) for share in self._shares(element)]
        waves = (2 * part * _cosine(Fraction(k, self.order)) for k, part in enumerate(parts) if k and part)
        return sp.Add(parts[0], *waves)

    def root(self, element: Any) -> Any:
        """The square root that is not negative; None where none is found in the field."""
        if self.sign(element) <= 0:
            return element if element == self.domain.zero else None
        bits = GUARD * (self.degree + 2)
        with ctx.workprec(2 * bits):
            values = [self.enclosure(element).sqrt(), *self._balls()]
            scaled = [int(str((value * arb(2) ** bits).mid().floor().unique_fmpz())) for value in values]
        relation = _relation(scaled)
        if not relation[0]:
            return None
        parts = (
            self.rational(Fraction(-k, relation[0])) * one for k, one in zip(relation[1:], self.basis, strict=True)
        )
        found = sum(parts, self.domain.zero)
        if found**2 != element:
            return None
        return found if self.sign(found) > 0 else -found


def _relation(values: Sequence[int]) -> list[int]:
    """Small whole numbers, not all zero, with which the sum of whole multiples of values is small."""
    count = len(values)
    rows = [[int(k == n) for n in range(count)] + [value] for k, value in enumerate(values)]
    reduced = fmpz_mat(rows).lll()
    return [int(reduced[0, n]) for n in range(count)]


def _cosine(share: Fraction) -> sp.Expr:
    """Not evaluated: SymPy makes roots within roots of it."""
    return sp.cos(2 * sp.pi * sp.Rational(share.numerator, share.denominator), evaluate=False)


def order_for_root(value: Fraction) -> int:
    """An M whose field has the square root of a positive fraction."""
    free = 1
    for prime, power in fmpz(value.numerator * value.denominator).factor():
        free *= int(prime) if power % 2 else 1
    return free if free % 4 == 1 else 4 * free


def order_for_turns(shares: Sequence[Fraction]) -> int:
    """An M whose field has the cosines of these shares of a turn."""
    return lcm(1, *(share.denominator for share in shares))
