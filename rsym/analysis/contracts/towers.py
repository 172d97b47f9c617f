"""Numbers with formal square roots: sums of products of roots w_k, w_k**2 = e_k, with polynomials before them.

An element maps a set of roots, the bits of a number, to a polynomial in one
unknown over the integers modulo a prime, a tuple of coefficients, the constant first. Modulo M the polynomials are
those of the zeros of M; there a root may have a value: on the boundary of the disc R - w it is R.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeAlias

Polynomial: TypeAlias = tuple[int, ...]

PRIME = 2**61 - 1  # Mersenne's ninth: a false identity of degree d passes with probability d/2**61


def trimmed(coefficients: list[int]) -> Polynomial:
    """Without leading zeros, every coefficient from 0 to PRIME - 1."""
    reduced = [coefficient % PRIME for coefficient in coefficients]
    while reduced and reduced[-1] == 0:
        reduced.pop()
    return tuple(reduced)


def added(f: Polynomial, g: Polynomial) -> Polynomial:
    """The sum.

    Examples
    --------
    >>> added((1, 2), (4, PRIME - 2))
    (5,)
    """
    if len(f) < len(g):
        f, g = g, f
    return trimmed([u + v for u, v in zip(f, g, strict=False)] + list(f[len(g) :]))


def multiplied(f: Polynomial, g: Polynomial) -> Polynomial:
    """The product.

    Examples
    --------
    >>> multiplied((1, 1), (2, 1))
    (2, 3, 1)
    """
    if not f or not g:
        return ()
    result = [0] * (len(f) + len(g) - 1)
    for i, u in enumerate(f):
        for j, v in enumerate(g):
            result[i + j] += u * v
    return trimmed(result)


def divided(f: Polynomial, g: Polynomial) -> tuple[Polynomial, Polynomial]:
    """Quotient and remainder.

    Examples
    --------
    >>> divided((3, 3, 1), (1, 1))
    ((2, 1), (1,))
    """
    rest, quotient = list(f), [0] * max(0, len(f) - len(g) + 1)
    inverse = pow(g[-1], -1, PRIME)
    for shift in range(len(f) - len(g), -1, -1):
        factor = rest[shift + len(g) - 1] * inverse % PRIME
        quotient[shift] = factor
        for k, v in enumerate(g):
            rest[shift + k] = (rest[shift + k] - factor * v) % PRIME
    return trimmed(quotient), trimmed(rest[: len(g) - 1] if len(f) >= len(g) else rest)


def common_divisor(f: Polynomial, g: Polynomial) -> Polynomial:
    """The greatest common divisor, up to a factor."""
    while g:
        f, g = g, divided(f, g)[1]
    return f


def inverted(f: Polynomial, modulus: Polynomial) -> Polynomial | None:
    """The inverse modulo a polynomial; None where the two have a common divisor.

    Examples
    --------
    >>> multiplied((1, 1), inverted((1, 1), (0, 0, 1))) == added((1,), (0, 0, PRIME - 1))
    True
    """
    before: tuple[Polynomial, Polynomial] = modulus, ()
    after: tuple[Polynomial, Polynomial] = divided(f, modulus)[1], (1,)
    while len(after[0]) > 1:
        quotient, rest = divided(before[0], after[0])
        step = added(before[1], multiplied((PRIME - 1,), multiplied(quotient, after[1])))
        before, after = after, (rest, step)
    if not after[0]:
        return None
    return divided(multiplied((pow(after[0][0], -1, PRIME),), after[1]), modulus)[1]


def square_free(f: Polynomial) -> Polynomial:
    """The product of the distinct factors."""
    derivative = trimmed([k * coefficient for k, coefficient in enumerate(f)][1:])
    return divided(f, common_divisor(f, derivative))[0] if derivative else f


Element: TypeAlias = dict[int, Polynomial]
Relation: TypeAlias = tuple[Element, Element]  # a + b w = 0

_EFFORT = 12_000  # products of polynomials: a lidinoid takes 5 700
_ROOTS = 5  # 32 products of roots; the fenders of a car have one, a torus by its distance two
_DEGREE = 160  # along a line: a gyroid, six sines and cosines of degree 2, has 36


class NotShown(Exception):
    """The algebra of a leaf is too large, or divides by what vanishes."""


def element(number: int) -> Element:
    """A number."""
    return {0: (number % PRIME,)} if number % PRIME else {}


class Tower:
    """The roots that have been met; with a modulus and relations, what is known of them on the zeros of a function."""

    def __init__(
        self,
        modulus: Polynomial | None = None,
        relations: dict[int, Relation] | None = None,
        scales: dict[int, Element] | None = None,
    ) -> None:
        self.modulus = modulus
        self._relations = relations or {}
        self.scales = scales or {}  # the roots of the relations are those of here times these
        self._radicands: dict[int, Element] = {}
        self._roots: dict[int, Element] = {}
        self._effort = 0

    def _reduced(self, polynomial: Polynomial) -> Polynomial:
        if self.modulus is not None:
            return divided(polynomial, self.modulus)[1] if len(polynomial) >= len(self.modulus) else polynomial
        if len(polynomial) > _DEGREE:
            raise NotShown
        return polynomial

    def reduced(self, f: Element) -> Element:
        """An element modulo M."""
        return {roots: rest for roots, polynomial in f.items() if (rest := self._reduced(polynomial))}

    def add(self, f: Element, g: Element) -> Element:
        """The sum."""
        result = dict(f)
        for roots, polynomial in g.items():
            total = added(result.pop(roots, ()), polynomial)
            if total:
                result[roots] = total
        return result

    def multiply(self, f: Element, g: Element) -> Element:
        """The product; the square of a root is its radicand."""
        self._effort += len(f) * len(g)
        if self._effort > _EFFORT:
            raise NotShown
        result: Element = {}
        for first, u in f.items():
            for second, v in g.items():
                both = first & second
                term = self.reduced({first ^ second: multiplied(u, v)})
                for number in range(both.bit_length()):
                    if both >> number & 1:
                        term = self.multiply(term, self._radicands[number])
                result = self.add(result, term)
        return result

    def scale(self, number: int, f: Element) -> Element:
        """A multiple."""
        return self.multiply(element(number), f)

    def root(self, number: int, radicand: Element) -> Element:
        """The root with that number, of that radicand; one that is equal on the zeros of M is the same."""
        if number in self._roots:
            return self._roots[number]
        if number >= _ROOTS:
            raise NotShown
        twins = [self._roots[k] for k, other in self._radicands.items() if other == radicand]
        self._radicands[number] = radicand
        if number in self._relations:
            plain, slope = map(self._met, self._relations[number])
            scaled = self.multiply(slope, self._met(self.scales[number]))
            self._roots[number] = self.scale(-1, self.multiply(plain, self.inverse(scaled)))
        else:
            self._roots[number] = twins[0] if twins and self.modulus is not None else {1 << number: (1,)}
        return self._roots[number]

    def radicands_of(self, roots: int) -> list[Element]:
        """The radicands of a set of roots."""
        return [radicand for number, radicand in self._radicands.items() if roots >> number & 1]

    def _met(self, f: Element) -> Element:
        """An element of the free tower in this one."""
        result: Element = {}
        for roots, polynomial in f.items():
            term = self.reduced({0: polynomial})
            for number in range(roots.bit_length()):
                if roots >> number & 1:
                    term = self.multiply(term, self.multiply(self._roots[number], self._met(self.scales[number])))
            result = self.add(result, term)
        return result

    def _norm(self, last: int, plain: Element, slope: Element) -> Element:
        """Return a**2 - b**2 e, zero where a + b w or a - b w is."""
        square = self.multiply(self.multiply(slope, slope), self._radicands[last])
        return self.add(self.multiply(plain, plain), self.scale(-1, square))

    def inverse(self, f: Element) -> Element:
        """Return 1/f = (a - b w)/(a**2 - b**2 e), down to polynomials."""
        last, plain, slope = _parted(f)
        if last >= 0:
            conjugate = self.add(plain, self.multiply(slope, {1 << last: (PRIME - 1,)}))
            return self.multiply(conjugate, self.inverse(self._norm(last, plain, slope)))
        assert self.modulus is not None
        result = inverted(plain[0], self.modulus) if plain else None
        if result is None:
            raise NotShown
        return {0: result}

    def on_the_zeros_of(self, f: Element, poles: Sequence[Polynomial] = ()) -> Tower | None:
        """The tower in which f = 0: its roots get values, its last norm is the modulus.

        Zeros of the poles do not count. None where f has no zero.
        """
        relations: dict[int, Relation] = {}
        while (parts := _parted(f))[0] >= 0:
            last, plain, slope = parts
            relations[last] = plain, slope
            f = self._norm(last, plain, slope)
        if not f:
            raise NotShown
        modulus = square_free(f[0])
        for pole in poles:
            modulus = divided(modulus, common_divisor(modulus, pole))[0]
        return None if len(modulus) == 1 else Tower(modulus, relations, self.scales)

    def vanishes_somewhere(self, f: Element) -> bool:
        """Whether an element is zero on a part of the zeros of M."""
        assert self.modulus is not None
        divisor = self.modulus
        for polynomial in f.values():
            divisor = common_divisor(divisor, polynomial)
        return len(divisor) > 1


def _parted(f: Element) -> tuple[int, Element, Element]:
    """The last root w of f and the parts a, b of f = a + b w; -1 where there is none."""
    last = max(f, default=0).bit_length() - 1
    if last < 0:
        return last, f, {}
    bit = 1 << last
    plain = {roots: polynomial for roots, polynomial in f.items() if not roots & bit}
    return last, plain, {roots ^ bit: polynomial for roots, polynomial in f.items() if roots & bit}
