"""Krawczyk's operator: where two equations in the plane have exactly one common zero, and where none.

K(B) = m - Y H(m) + (I - Y H'(B))(B - m), with m the middle of the box B and Y near the inverse of H'(m): all zeros
of H in B lie in K(B); if K(B) lies in the interior of B there is exactly one. Source: Krawczyk (1969); Moore,
Kearfott and Cloud, Introduction to Interval Analysis (2009), chapter 8.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from rsym.codegen.balls import arb

Point = tuple[arb, arb]

# Convergence is quadratic in the end, but a wide box may lose only a tenth of its width at first.
REFINEMENTS, SLOWEST = 60, 0.95


@dataclass(frozen=True)
class Zero:
    """The result: `exists` and is unique in the box it was sought in, and lies in `box`; else there is none."""

    exists: bool
    box: Point | None = None


def unique_zero(
    values: Callable[[Point], Sequence[arb]], jacobian: Callable[[Point], Sequence[Sequence[arb]]], box: Point
) -> Zero | None:
    """Whether two equations have exactly one common zero in a box, or none; None if that stays open."""
    current = box
    for _ in range(8):
        image = _image(values, jacobian, current)
        if image is None:
            return None
        if any(not side.overlaps(wanted) for side, wanted in zip(image, current, strict=True)):
            return Zero(False)
        if all(wanted.contains_interior(side) for side, wanted in zip(image, current, strict=True)):
            return Zero(True, image)
        narrowed = (image[0].intersection(current[0]), image[1].intersection(current[1]))
        if all(float(new.rad()) > 0.7 * float(old.rad()) for new, old in zip(narrowed, current, strict=True)):
            return None
        current = narrowed
    return None


def refined(
    values: Callable[[Point], Sequence[arb]], jacobian: Callable[[Point], Sequence[Sequence[arb]]], box: Point
) -> Point:
    """The box of a unique zero, as narrow as the working precision and the letters allow."""
    for _ in range(REFINEMENTS):
        image = _image(values, jacobian, box)
        if image is None or not all(a.overlaps(b) for a, b in zip(image, box, strict=True)):
            break
        narrowed = (image[0].intersection(box[0]), image[1].intersection(box[1]))
        if all(float(new.rad()) > SLOWEST * float(old.rad()) for new, old in zip(narrowed, box, strict=True)):
            break
        box = narrowed
    return box


def _image(
    values: Callable[[Point], Sequence[arb]], jacobian: Callable[[Point], Sequence[Sequence[arb]]], box: Point
) -> Point | None:
    middle = (box[0].mid(), box[1].mid())
    (a, b), (c, d) = jacobian(middle)
    determinant = a.mid() * d.mid() - b.mid() * c.mid()
    if not determinant.is_finite() or determinant.contains(0):
        return None
    inverse = [
        [(d / determinant).mid(), (-b / determinant).mid()],
        [(-c / determinant).mid(), (a / determinant).mid()],
    ]
    value, slopes = values(middle), jacobian(box)
    result = []
    for row in range(2):
        y0, y1 = inverse[row]
        side = middle[row] - (y0 * value[0] + y1 * value[1])
        for column in range(2):
            rest = (1 if row == column else 0) - (y0 * slopes[0][column] + y1 * slopes[1][column])
            side += rest * (box[column] - middle[column])
        if not side.is_finite():
            return None
        result.append(side)
    return result[0], result[1]
