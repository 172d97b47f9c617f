"""How great the values of the field of `algebra` are: sums of sizes of coefficients, over an interval of t."""

from __future__ import annotations

import math
from typing import Any

from rsym.bounds.ball_series import arb, truncated
from rsym.bounds.balls import ball, exact
from rsym.surfaces.proofs.algebra import Polynomial, Value
from rsym.surfaces.proofs.enclosures import BITS
from rsym.surfaces.proofs.specialised import Part


def greatest(value: Value, part: Part) -> float | None:
    """No |value| on a part of the edge is greater; None where a generator or a denominator is not bounded.

    Numbers, pi and roots among them, are summed first: what they leave of a difference may be small.

    Examples
    --------
    >>> from fractions import Fraction
    >>> from rsym.surfaces.proofs.algebra import Field, T
    >>> field = Field()
    >>> round(greatest(field.generator(T) * field.rational(Fraction(3)), (Fraction(-2), Fraction(1))), 6)
    6.0
    """
    with truncated(0, BITS):
        known = value.field.balls(ball(exact(part[0]), exact(part[1])))
        above = _size(value.above, known, value.field.varying)
        for one, exponent in value.below.items():
            below = _constant(one, known, value.field.varying)
            if below is None or below.contains(arb(0)) or above is None:
                return None
            for _ in range(exponent):
                above = above / abs(below)
        if above is None or not above.is_finite():
            return None
        return math.nextafter(float(above.upper()), math.inf)


def _size(polynomial: Polynomial, known: dict[int, Any], varying: frozenset[int]) -> Any | None:
    """The sum of the sizes of the coefficients of products of varying generators, times those of the products."""
    rows: dict[tuple[tuple[int, int], ...], Any] = {}
    for monomial, coefficient in polynomial.items():
        powers = [(k, exponent) for k, exponent in enumerate(monomial) if exponent]
        moving = tuple(pair for pair in powers if pair[0] in varying)
        if any(k not in known for k, _ in powers):
            return None
        term = _product([pair for pair in powers if pair[0] not in varying], known)
        term = term * arb(int(coefficient.numerator)) / arb(int(coefficient.denominator))
        rows[moving] = rows.get(moving, arb(0)) + term
    return sum((abs(total) * abs(_product(moving, known)) for moving, total in rows.items()), arb(0))


def _constant(polynomial: Polynomial, known: dict[int, Any], varying: frozenset[int]) -> Any | None:
    """The ball of a polynomial of constant generators."""
    total = arb(0)
    for monomial, coefficient in polynomial.items():
        powers = [(k, exponent) for k, exponent in enumerate(monomial) if exponent]
        if any(k in varying or k not in known for k, _ in powers):
            return None
        total = total + _product(powers, known) * arb(int(coefficient.numerator)) / arb(int(coefficient.denominator))
    return total


def _product(powers: Any, known: dict[int, Any]) -> Any:
    total = arb(1)
    for k, exponent in powers:
        for _ in range(exponent):
            total = total * known[k]
    return total
