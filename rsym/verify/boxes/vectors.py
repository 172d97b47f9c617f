"""Balls and vectors of them: signs and lengths, and the numbers that a report gives for them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TypeAlias

from rsym.bounds.balls import arb, hypotenuse

Vector: TypeAlias = tuple[arb, arb, arb]


def sign_of(value: arb | None) -> int:
    """The sign that a ball certainly has, 0 where it may have several or there is none."""
    return 0 if value is None else 1 if value > 0 else -1 if value < 0 else 0


def dot(a: Sequence[arb], b: Sequence[arb]) -> arb:
    """The scalar product."""
    return sum((u * v for u, v in zip(a, b, strict=True)), arb(0))


def length(vector: Vector) -> arb:
    """The length of a vector."""
    return hypotenuse(hypotenuse(vector[0], vector[1]), vector[2])


def determinant(rows: Sequence[Sequence[arb]]) -> arb:
    """The determinant of three vectors."""
    (a, b, c), (d, e, f), (g, h, i) = rows
    return a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g)


def floats(vector: Sequence[arb]) -> tuple[float, ...]:
    """The middle of a box of vectors."""
    return tuple(float(part.mid()) for part in vector)


def error(value: arb) -> float:
    """The radius of a ball, and what rounding its middle to float64 adds."""
    return float(arb(value.rad()).upper()) + 2.0**-52 * float(abs(value).upper())


def radius_of(point: Sequence[arb]) -> float:
    """How far the truth can be from the rounded middle of a box."""
    return math.hypot(*map(error, point))
