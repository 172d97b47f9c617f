"""What vanishes all along an edge, by exact arithmetic, and a bound of the difference of curvatures."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from rsym.bounds.ball_series import arb, truncated
from rsym.bounds.balls import ball, exact
from rsym.surfaces.proofs.algebra import Polynomial, Quotient
from rsym.surfaces.proofs.enclosures import BITS, Pair
from rsym.surfaces.proofs.exact_values import exact_values
from rsym.surfaces.proofs.sides import Side, difference, dot, linkage, sides
from rsym.surfaces.proofs.specialised import NoProof, Part


@dataclass(frozen=True)
class Facts:
    """Which of gap, angle and jump vanish identically, and whether both patches have normals.

    `standing` are the patches, 0 and 1, whose derivative across the edge vanishes identically.
    `linkage` bounds the difference II1(D2, D2) - II2(D2, D2) times |N1|**3, where the angle vanishes; None if unknown.
    """

    vanishing: tuple[bool, bool, bool] = (False, False, False)
    regular: bool = True
    linkage: float | None = None
    standing: tuple[int, ...] = ()


def facts(pair: Pair, levels: int) -> Facts:
    """What exact arithmetic says of the first so many levels on a part of an edge."""
    try:
        first, second = sides(exact_values(pair.nodes, pair.outputs))
        met = all(one.is_zero for one in difference(first.point, second.point))
        if levels < 2:
            return Facts((met, False, False))
        normals = first.normal, second.normal
        if any(all(one.is_zero for one in normal) for normal in normals):
            still = tuple(k for k, side in enumerate((first, second)) if all(one.is_zero for one in side.out))
            return Facts(regular=False, standing=still)
        flat = met and dot(normals[0], second.out).is_zero
        return _of_curvature(pair, first, second) if flat and levels > 2 else Facts((met, flat, False))
    except NoProof:
        return Facts()


def _of_curvature(pair: Pair, first: Side, second: Side) -> Facts:
    """The third level, where the first two vanish: by one axis if it vanishes, bounded by all three if not."""
    axes = [k for _, k in sorted((len(one.above), k) for k, one in enumerate(first.normal) if not one.is_zero)]
    try:
        if linkage(first, second, axes[:1]).is_zero:
            return Facts((True, True, True))
        return Facts((True, True, False), linkage=greatest(linkage(first, second), pair.part))
    except NoProof:
        return Facts((True, True, False))


# How great the values of the field of `algebra` are: sums of sizes of coefficients, over an interval of t.
def greatest(value: Quotient, part: Part) -> float | None:
    """No |value| on a part of the edge is greater; None where a generator or a denominator is not bounded.

    Numbers, pi and roots among them, are summed first: what they leave of a difference may be small.

    Examples
    --------
    >>> from fractions import Fraction
    >>> from rsym.surfaces.proofs.algebra import EdgeField, T
    >>> field = EdgeField()
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
