"""A field of polynomials for functions of t: what vanishes there vanishes exactly.

The field has the generators t, pi and e, the sines and cosines of a common measure of all angles, square roots of
primes, and one generator for every other function of a value. Relations s**2 = 1 - c**2 and g**2 = u are applied
everywhere. They hold for the functions, so a value that reduces to zero is zero; one that does not may be zero too.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import gcd, lcm
from typing import Any, TypeAlias

import sympy as sp
from sympy.polys.orderings import lex
from sympy.polys.rings import PolyElement, PolyRing

from rsym.bounds.balls import arb
from rsym.program.program import Data, Node, live
from rsym.surfaces.proofs.specialised import NoProof

Polynomial: TypeAlias = PolyElement
# A polynomial in t, pi and so on for each kind of angle: t, pi t, 1.
Angle: TypeAlias = tuple[Fraction, Fraction, Fraction, Fraction]
GENERATORS = 20
T, PI, E = GENERATORS - 1, GENERATORS - 2, GENERATORS - 3
# Polynomials that are longer cost more time than balls do: those of exact arcs have 132 terms, those of arcs whose
# corner data are rounded a thousand, and take seconds.
MOST_TERMS = 300
# Sines of greater multiples of the measure are polynomials of higher degree.
MOST_MULTIPLE = 24
# Integers under a root are factored if they are shorter.
FACTORED_BITS = 64
TWELFTH = 12


@dataclass(frozen=True)
class Quotient:
    """A quotient: a polynomial over powers of others, none of which is zero."""

    field: EdgeField
    above: Polynomial
    below: Mapping[Polynomial, int]

    def __add__(self, other: Quotient) -> Quotient:
        if self.below == other.below:
            return self.field.value(self.above + other.above, self.below)
        whole = {one: max(self.below.get(one, 0), other.below.get(one, 0)) for one in {**self.below, **other.below}}
        parts = [self.field.raised(one, whole) for one in (self, other)]
        return self.field.value(parts[0] + parts[1], whole)

    def __neg__(self) -> Quotient:
        return Quotient(self.field, -self.above, self.below)

    def __sub__(self, other: Quotient) -> Quotient:
        return self + -other

    def __mul__(self, other: Quotient) -> Quotient:
        whole = {one: self.below.get(one, 0) + other.below.get(one, 0) for one in {**self.below, **other.below}}
        return self.field.value(self.above * other.above, whole)

    def __truediv__(self, other: Quotient) -> Quotient:
        return self * self.field.inverse(other)

    def __pow__(self, exponent: int) -> Quotient:
        total = self.field.rational(Fraction(1))
        for _ in range(exponent):
            total = total * self
        return total

    @property
    def is_zero(self) -> bool:
        """Whether it is proved to vanish."""
        return not self.above


class EdgeField:
    """The field of one edge; generators are made as they are needed.

    Examples
    --------
    >>> field = EdgeField()
    >>> root = field.root(field.rational(Fraction(2)))
    >>> (root * root - field.rational(Fraction(2))).is_zero
    True
    """

    def __init__(self) -> None:
        self.ring = PolyRing([f"g{k}" for k in range(GENERATORS)], sp.QQ, lex)
        self._free = E - 1
        self._squares: dict[int, Polynomial] = {}
        self._known: dict[Any, Quotient] = {}
        # The primes whose roots generators are.
        self.primes: dict[int, int] = {}
        self.measures: list[Fraction] = [Fraction(0)] * 4

    def value(self, above: Polynomial, below: Mapping[Polynomial, int]) -> Quotient:
        """A quotient, reduced by the relations."""
        reduced = self._reduced(above)
        if len(reduced) > MOST_TERMS:
            raise NoProof("the formulas are too long for exact arithmetic")
        return Quotient(self, reduced, below if reduced else {})

    def cancelled(self, value: Quotient) -> Quotient:
        """The same without the denominators that divide the numerator."""
        above, left = value.above, dict(value.below)
        for one in value.below:
            while left.get(one):
                quotient, rest = above.div(one)
                if rest:
                    break
                above, left[one] = quotient, left[one] - 1
        return Quotient(self, above, {one: exponent for one, exponent in left.items() if exponent})

    def rational(self, number: Fraction) -> Quotient:
        """A number."""
        return Quotient(self, self.ring.ground_new(sp.QQ(number.numerator, number.denominator)), {})

    def generator(self, number: int) -> Quotient:
        """A generator."""
        return Quotient(self, self.ring.gens[number], {})

    def raised(self, value: Quotient, below: Mapping[Polynomial, int]) -> Polynomial:
        """The numerator over a greater denominator."""
        total = value.above
        for one, exponent in below.items():
            for _ in range(exponent - value.below.get(one, 0)):
                total = self._reduced(total * one)
        return total

    def inverse(self, value: Quotient) -> Quotient:
        """One over a value."""
        if value.is_zero:
            raise NoProof("a denominator vanishes on the edge")
        total = self.rational(Fraction(1))
        for one, exponent in value.below.items():
            total = total * Quotient(self, one, {}) ** exponent
        if value.above.is_ground:
            return total * Quotient(self, self.ring.ground_new(1 / value.above.LC), {})
        leading = value.above.LC
        return self.value(total.above * (1 / leading), {value.above * (1 / leading): 1})

    def root(self, value: Quotient) -> Quotient:
        """A square root: of a rational number by those of primes, of others a generator of its own."""
        if value.below:
            raise NoProof("a root of a quotient has no place in exact arithmetic here")
        if not value.above.is_ground:
            return self.named(("sqrt", value.above), value.above)
        number = Fraction(int(value.above.LC.numerator), int(value.above.LC.denominator)) if value.above else Fraction()
        whole = number.numerator * number.denominator
        if whole < 0 or whole.bit_length() > FACTORED_BITS:
            raise NoProof("a root of a number that is negative or too long")
        total = self.rational(Fraction(1, number.denominator))
        for prime, exponent in sp.factorint(whole).items() if whole else []:
            total = total * self.rational(Fraction(int(prime) ** (exponent // 2)))
            if exponent % 2:
                root = self.named(("sqrt", int(prime)), self.ring.ground_new(int(prime)))
                self.primes[root.above.LM.index(1)] = int(prime)
                total = total * root
        return total if whole else self.rational(Fraction())

    def named(self, key: Any, square: Polynomial | None = None) -> Quotient:
        """The generator of this name, with the polynomial that its square is, if it is one."""
        if key not in self._known:
            if self._free < 0:
                raise NoProof("the formulas have too many different functions")
            self._known[key] = self.generator(self._free)
            if square is not None:
                self._squares[self._free] = square
            self._free -= 1
        return self._known[key]

    def balls(self, t: Any) -> dict[int, Any]:
        """Balls for the generators of which one is known, over a ball of t: cosines and sines lie in [-1, 1]."""
        known = {T: t, PI: arb.pi(), E: arb.const_e()}
        known |= {number: arb(prime).sqrt() for number, prime in self.primes.items()}
        turning = [value.above.LM for key, value in self._known.items() if key[0] in {"cos", "sin"}]
        return known | {powers.index(1): arb(0, 1) for powers in turning}

    @property
    def varying(self) -> frozenset[int]:
        """The generators that are not known to be constant."""
        return frozenset(range(GENERATORS)) - {PI, E, *self.primes}

    def turned(self, value: Quotient) -> tuple[Quotient, Quotient]:
        """The cosine and the sine of a value."""
        angle = angle_of(value)
        if angle is None:
            return self._pair(("angle", value.above, frozenset(value.below.items())))
        cosine, sine = self.rational(Fraction(1)), self.rational(Fraction())
        for kind, (part, measure) in enumerate(zip(angle, self.measures, strict=True)):
            if part:
                c, s = self._multiple(kind, part, measure)
                cosine, sine = cosine * c - sine * s, sine * c + cosine * s
        return cosine, sine

    def _multiple(self, kind: int, part: Fraction, measure: Fraction) -> tuple[Quotient, Quotient]:
        """The cosine and sine of an angle of one kind by those of its measure."""
        if kind == 3 and (part * TWELFTH).denominator == 1:
            return tuple(self._constant(one(sp.pi * sp.Rational(part))) for one in (sp.cos, sp.sin))  # type: ignore[return-value]
        times = part / measure if measure else Fraction(1, 2)
        if times.denominator != 1 or abs(times) > MOST_MULTIPLE:
            raise NoProof("the angles of the formulas have no simple common measure")
        c, s = self._pair(("measure", kind))
        cosine, sine = self.rational(Fraction(1)), self.rational(Fraction())
        for _ in range(abs(int(times))):
            cosine, sine = cosine * c - sine * s, sine * c + cosine * s
        return cosine, sine if times > 0 else -sine

    def _pair(self, key: Any) -> tuple[Quotient, Quotient]:
        """Generators of a cosine and a sine."""
        cosine = self.named(("cos", key))
        return cosine, self.named(("sin", key), self.ring.one - cosine.above**2)

    def _constant(self, number: sp.Expr) -> Quotient:
        """A number of square roots, as SymPy writes sines of twelfths of pi."""
        if number.is_Rational:
            return self.rational(Fraction(int(number.p), int(number.q)))
        inner = [self._constant(one) for one in number.args] if number.is_Add or number.is_Mul else []
        if number.is_Pow and number.exp == sp.Rational(1, 2):
            return self.root(self._constant(number.base))
        if not inner:
            raise NoProof(f"the number {number} has no place in exact arithmetic here")
        total = inner[0]
        for one in inner[1:]:
            total = total + one if number.is_Add else total * one
        return total

    def _reduced(self, polynomial: Polynomial) -> Polynomial:
        """No square of a generator that has a relation; later generators first, their relations have earlier ones."""
        for number in sorted(self._squares):
            if any(monomial[number] > 1 for monomial in polynomial):
                polynomial = self._replaced(polynomial, number, self._squares[number])
        return polynomial

    def _replaced(self, polynomial: Polynomial, number: int, square: Polynomial) -> Polynomial:
        """The polynomial with g**2 replaced."""
        parts: dict[int, dict[tuple[int, ...], Any]] = {}
        for monomial, coefficient in polynomial.items():
            halves, rest = divmod(monomial[number], 2)
            left = (*monomial[:number], rest, *monomial[number + 1 :])
            parts.setdefault(halves, {})[left] = coefficient
        total, power = self.ring.zero, self.ring.one
        for halves in range(max(parts) + 1):
            if halves in parts:
                total = total + power * self.ring.from_dict(parts[halves])
            power = power * square
        return total


def angle_of(value: Quotient) -> Angle | None:
    """(a, b, c, d) if the value is a t + b pi t + c + d pi with rational numbers."""
    found = [Fraction(0)] * 4
    if value.below:
        return None
    for monomial, coefficient in value.above.items():
        exponents = (monomial[T], monomial[PI])
        if sum(monomial) != sum(exponents) or max(exponents) > 1:
            return None
        kind = {(1, 0): 0, (1, 1): 1, (0, 0): 2, (0, 1): 3}[exponents]
        found[kind] = Fraction(int(coefficient.numerator), int(coefficient.denominator))
    return found[0], found[1], found[2], found[3]


def exact_values(nodes: Sequence[Node], outputs: Sequence[int], at: Fraction | None = None) -> list[Quotient]:
    """The values of some nodes as functions of t, or at one place.

    Raises
    ------
    NoProof
        For what has no place in this arithmetic.

    Examples
    --------
    >>> from rsym.program.builder import Builder
    >>> builder = Builder(("t",), ())
    >>> t = builder.input("t")
    >>> double = builder.make("sin", builder.mul(builder.const(2), t))
    >>> product = builder.mul(builder.const(2), builder.mul(builder.make("sin", t), builder.make("cos", t)))
    >>> [one.is_zero for one in exact_values(builder.nodes, [builder.sub(double, product), double])]
    [True, False]
    """
    field, order = EdgeField(), live(nodes, outputs)
    parameter = field.generator(T) if at is None else field.rational(at)
    angles: list[Angle] = []
    _evaluated(field, nodes, order, parameter, angles)
    field.measures = [_measure([angle[kind] for angle in angles]) for kind in range(4)]
    known = _evaluated(field, nodes, order, parameter, None)
    return [field.cancelled(value) for number in outputs if (value := known[number]) is not None]


def _measure(parts: Sequence[Fraction]) -> Fraction:
    """The greatest common measure of some numbers; 0 of none."""
    used = [abs(one) for one in parts if one]
    if not used:
        return Fraction(0)
    below = lcm(*(one.denominator for one in used))
    return Fraction(gcd(*(int(one * below) for one in used)), below)


def _evaluated(
    field: EdgeField, nodes: Sequence[Node], order: Sequence[int], parameter: Quotient, angles: list[Angle] | None
) -> dict[int, Quotient | None]:
    """All values; with a list for angles only those that need no sines, and the angles are collected."""
    known: dict[int, Quotient | None] = {}
    for number in order:
        operation, arguments, data = nodes[number]
        inner = [known[one] for one in arguments]
        values = [one for one in inner if one is not None]
        if len(values) < len(inner):
            known[number] = None
        elif operation in {"sin", "cos"} and angles is not None:
            angle = angle_of(values[0])
            angles += [] if angle is None else [angle]
            known[number] = None
        elif operation == "input":
            known[number] = parameter
        else:
            known[number] = _image(field, operation, values, data)
    return known


def _image(field: EdgeField, operation: str, values: Sequence[Quotient], data: Data) -> Quotient:
    if operation == "const":
        if isinstance(data, Fraction):
            return field.rational(data)
        return field.generator({"pi": PI, "e": E}[str(data)])
    if operation == "powi" and isinstance(data, int) and data >= 0:
        return values[0] ** data
    if operation in {"sin", "cos"}:
        return field.turned(values[0])[operation == "sin"]
    if operation == "sqrt":
        return field.root(values[0])
    image = _FIELD.get(operation)
    if image is not None:
        return image(*values)
    return field.named((operation, data, *((one.above, frozenset(one.below.items())) for one in values)))


_FIELD: Mapping[str, Callable[..., Quotient]] = {
    "add": lambda a, b: a + b,
    "mul": lambda a, b: a * b,
    "neg": lambda a: -a,
    "div": lambda a, b: a / b,
}
