"""Completing the square of a quadratic in one coordinate.

(b - x)*(x - a) uses x twice; interval bounds of it overestimate. As
((b - a)/2)**2 - (x - (a + b)/2)**2 it uses x once and its range is exact.
Only numbers are divided by: a letter as leading coefficient could be zero.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

import sympy as sp

from rsym.model.traversal import symbols_of
from rsym.program.builder import Builder


def two_linear_factors(b: Builder, part: sp.Mul, arguments: Sequence[int], numerator: Sequence[int]) -> list[int]:
    """In a product with just two varying factors p*v + c and q*v + d, p and q numbers, complete the square.

    (p v + c)(q v + d) = p q ((v + s)**2 - h**2), s = (c/p + d/q)/2, h = (c/p - d/q)/2.
    """
    varying = [
        (factor, number)
        for factor, number in zip(part.args, arguments, strict=True)
        if number in numerator and not b.uniform[number]
    ]
    lines = [_line(b, factor) for factor, _ in varying]
    if len(lines) != 2 or lines[0] is None or lines[1] is None or lines[0][0] != lines[1][0]:
        return list(numerator)
    (name, p, c), (_, q, d) = lines[0], lines[1]
    first, second = b.mul(b.const(1 / p), c), b.mul(b.const(1 / q), d)
    half = b.const(Fraction(1, 2))
    shift, reach = b.mul(half, b.add(first, second)), b.mul(half, b.sub(first, second))
    square = b.sub(b.square(b.add(b.input(name), shift)), b.square(reach))
    rest = list(numerator)
    for _, number in varying:
        rest.remove(number)
    return [*rest, b.const(p * q), square]


def _line(b: Builder, factor: sp.Expr) -> tuple[str, Fraction, int] | None:
    """(name, p, c) if the factor is p*v + c with a number p, a coordinate v and c free of coordinates."""
    from_terms = _linear_terms(b, factor)
    if from_terms is None:
        return None
    name, slope, rest = from_terms
    constant = b.const(0)
    for term in rest:
        lowered = _lower_uniform(b, term)
        if lowered is None:
            return None
        constant = b.add(constant, lowered)
    return name, slope, constant


def _linear_terms(b: Builder, factor: sp.Expr) -> tuple[str, Fraction, list[sp.Expr]] | None:
    name, slope, rest = "", Fraction(0), []
    for term in sp.Add.make_args(factor):
        coefficient, bare = term.as_coeff_Mul()
        if bare.is_Symbol and bare.name in b.coordinates and isinstance(coefficient, sp.Rational):
            if name:
                return None
            name, slope = bare.name, Fraction(int(coefficient.p), int(coefficient.q))
        else:
            rest.append(term)
    return (name, slope, rest) if name and slope else None


def _lower_uniform(b: Builder, term: sp.Expr) -> int | None:
    """A rational number, or a rational multiple of a letter."""
    coefficient, bare = term.as_coeff_Mul()
    if not isinstance(coefficient, sp.Rational):
        return None
    factor = b.const(Fraction(int(coefficient.p), int(coefficient.q)))
    if bare == 1:
        return factor
    if bare.is_Symbol and bare.name in b.letters:
        return b.mul(factor, b.input(bare.name))
    return None


def sum_with_squares_completed(b: Builder, part: sp.Add, arguments: Sequence[int]) -> int:
    """The sum of the terms in order; p*v**2 + q*v with a number p becomes p*(v + q/(2p))**2 - q**2/(4p)."""
    terms = dict(enumerate(zip(part.args, arguments, strict=True)))
    extra: list[int] = []
    for name in b.coordinates:
        pair = _square_and_line(b, name, [(k, term) for k, (term, _) in terms.items()])
        if pair is not None:
            square_at, leading, line_at, slope = pair
            del terms[square_at], terms[line_at]
            shift = b.mul(b.const(1 / (2 * leading)), slope)
            extra.append(b.mul(b.const(leading), b.square(b.add(b.input(name), shift))))
            extra.append(b.mul(b.const(-leading), b.square(shift)))
    numbers = [number for _, number in terms.values()] + extra
    result = numbers[0]
    for number in numbers[1:]:
        result = b.add(result, number)
    return result


def _square_and_line(
    b: Builder, name: str, terms: Sequence[tuple[int, sp.Expr]]
) -> tuple[int, Fraction, int, int] | None:
    square: tuple[int, Fraction] | None = None
    line: tuple[int, int] | None = None
    for position, term in terms:
        coefficient, bare = term.as_coeff_Mul()
        if bare.is_Pow and bare.exp == 2 and bare.base.is_Symbol and bare.base.name == name:
            if square is not None or not isinstance(coefficient, sp.Rational):
                return None
            square = (position, Fraction(int(coefficient.p), int(coefficient.q)))
        elif any(symbol.name == name for symbol in symbols_of(term)):
            slope = _slope(b, name, term)
            if slope is None or line is not None:
                return None  # the coordinate stands elsewhere too: nothing is gained
            line = (position, slope)
    return (*square, *line) if square is not None and line is not None else None


def _slope(b: Builder, name: str, term: sp.Expr) -> int | None:
    """The factor of v in number*v or number*letter*v."""
    factors = [factor for factor in sp.Mul.make_args(term) if not (factor.is_Symbol and factor.name == name)]
    if len(factors) != len(sp.Mul.make_args(term)) - 1:
        return None
    return _lower_uniform(b, sp.Mul(*factors))
