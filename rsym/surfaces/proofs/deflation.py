"""Normals beside a pole: they vanish there exactly, and over the distance to it they do not."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import Any

from rsym.bounds.ball_series import arb, truncated
from rsym.bounds.balls import ball, exact
from rsym.model.vectors import cross
from rsym.surfaces.proofs.enclosures import BITS, ORDER, Pair
from rsym.surfaces.proofs.exact_values import exact_values
from rsym.surfaces.proofs.sides import Side, Vector, dot, sides
from rsym.surfaces.proofs.specialised import NoProof, Part

AXES = 3


def regular_end(pair: Pair, end: Fraction, part: Part) -> bool:
    """Whether both normals on a part that begins or stops at a pole are their distance to it times what is not zero.

    N(end + h) = h (c_1 + c_2 h + ... + R_n h**(n-1)) if N(end) = 0 exactly, by the arithmetic of `algebra`.
    """
    try:
        values = sides(exact_values(pair.nodes, pair.outputs, end))
    except NoProof:
        return False
    gone = [all(one.is_zero for one in side.normal) for side in values]
    sign = 1 if end == part[0] else -1
    with truncated(ORDER, BITS):
        here, all_over = pair.sides(exact(end)), pair.sides(ball(exact(part[0]), exact(part[1])))
        if here is None or all_over is None:
            return False
        ways = _powers(exact(part[1] - part[0]), sign)
        normals = [(one.normal, other.normal) for one, other in zip(here, all_over, strict=True)]
        return all(dot(*[_over(*pairs, ways, int(zero))] * 2) > 0 for pairs, zero in zip(normals, gone, strict=True))


def is_cuspidal(values: Sequence[Any], third: Sequence[Any]) -> bool:
    """Whether a patch ends in an edge of regression, of which curvatures are unbounded, by balls at one place.

    values: the eighteen of a jet, of which the derivative D across the edge vanishes all along, by exact arithmetic;
    third: the third derivative across. With d the distance to the edge in the parameter p = P(t) + d**2 B/2 + d**3
    C/6 + ...; in the plane across the edge the sheet is a curve with the tangent B, and C across it: like y = x**(3/2).
    """
    side = Side(*(values[k : k + AXES] for k in range(0, len(values), AXES)))
    volume = dot(cross(side.along, side.out_out), third)
    return bool(volume > 0 or volume < 0)


def _powers(step: Any, sign: int) -> list[Any]:
    """Balls for the powers of all numbers from 0 to a step, or to minus it."""
    powers = [arb(1)]
    for _ in range(ORDER):
        powers.append(powers[-1] * step * sign)
    return [powers[0], *(ball(arb(0), one) if one > 0 else ball(one, arb(0)) for one in powers[1:])]


def _over(middle: Vector, whole: Vector, ways: Sequence[Any], order: int) -> Sequence[Any]:
    """Balls for a vector over a power of the distance to where its series begin."""
    pairs = zip(middle, whole, strict=True)
    return [
        sum((one[k] * ways[k - order] for k in range(order, ORDER)), rest[ORDER] * ways[ORDER - order])
        for one, rest in pairs
    ]
