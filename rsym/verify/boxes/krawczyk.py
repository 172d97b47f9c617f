"""Krawczyk's operator: where n equations in n unknowns have exactly one common zero, and where none.

K(B) = m - Y H(m) + (I - Y H'(B))(B - m), with m the middle of the box B and Y near the inverse of H'(m): all zeros
of H in B lie in K(B); if K(B) lies in the interior of B there is exactly one. Source: Krawczyk (1969); Moore,
Kearfott and Cloud, Introduction to Interval Analysis (2009), chapter 8.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TypeAlias

from flint import arb_mat

from rsym.bounds.balls import arb, ctx
from rsym.verify.boxes.local import PRECISE, Local

Point: TypeAlias = tuple[arb, ...]
Matrix: TypeAlias = Sequence[Sequence[arb]]

# Convergence is quadratic in the end, but a wide box may lose only a tenth of its width at first.
REFINEMENTS, SLOWEST = 60, 0.95


@dataclass(frozen=True)
class Zero:
    """The result: `exists` and is unique in the box it was sought in, and lies in `box`; else there is none."""

    exists: bool
    box: Point = ()

    def meets(self, local: Local) -> bool:
        """Whether there is a zero, and it may lie in a box."""
        return self.exists and all(a.overlaps(b) for a, b in zip(self.box, local.sides, strict=False))


def common_zero(local: Local, numbers: tuple[int, ...]) -> Zero | None:
    """The only common zero in a box of as many nodes as there are coordinates, or that there is none; None if open."""
    return unique_zero(*_equations(local, numbers), tuple(local.sides[: len(numbers)]))


def narrowed_zero(local: Local, numbers: tuple[int, ...], zero: Zero) -> Local:
    """A box around such a zero, as narrow as the letters allow."""
    with ctx.workprec(max(ctx.prec, PRECISE)):
        return local.model.on([*refined(*_equations(local, numbers), zero.box), *local.sides[len(numbers) :]])


def _equations(
    local: Local, numbers: tuple[int, ...]
) -> tuple[Callable[[Point], Sequence[arb]], Callable[[Point], Matrix]]:
    rest = local.sides[len(numbers) :]

    def values(point: Point) -> Sequence[arb]:
        return local.model.on([*point, *rest]).balls(numbers)

    def jacobian(point: Point) -> Matrix:
        at = local.model.on([*point, *rest])
        return [at.gradient(number) for number in numbers]

    return values, jacobian


def unique_zero(
    values: Callable[[Point], Sequence[arb]], jacobian: Callable[[Point], Matrix], box: Point
) -> Zero | None:
    """Whether the equations have exactly one common zero in a box, or none; None if that stays open."""
    current = box
    for _ in range(8):
        moved = _image(values, jacobian, current)
        if moved is None:
            return None
        if any(not side.overlaps(wanted) for side, wanted in zip(moved, current, strict=True)):
            return Zero(False)
        if all(wanted.contains_interior(side) for side, wanted in zip(moved, current, strict=True)):
            return Zero(True, moved)
        narrowed = _meet(moved, current)
        if all(float(new.rad()) > 0.7 * float(old.rad()) for new, old in zip(narrowed, current, strict=True)):
            return None
        current = narrowed
    return None


def refined(values: Callable[[Point], Sequence[arb]], jacobian: Callable[[Point], Matrix], box: Point) -> Point:
    """The box of a unique zero, as narrow as the working precision and the letters allow."""
    for _ in range(REFINEMENTS):
        moved = _image(values, jacobian, box)
        if moved is None or not all(a.overlaps(b) for a, b in zip(moved, box, strict=True)):
            break
        narrowed = _meet(moved, box)
        if all(float(new.rad()) >= SLOWEST * float(old.rad()) for new, old in zip(narrowed, box, strict=True)):
            break
        box = narrowed
    return box


def inverse(matrix: Matrix) -> list[list[arb]] | None:
    """Numbers near the inverse of the middles of a matrix; None if these have none."""
    size = len(matrix)
    middles = arb_mat(size, size, [entry.mid() for row in matrix for entry in row])
    try:
        found = middles.inv()
    except ZeroDivisionError:
        return None
    rows = [[entry.mid() for entry in row] for row in found.tolist()]
    return rows if all(entry.is_finite() for row in rows for entry in row) else None


def image(near: Matrix, value: Sequence[arb], slopes: Matrix, box: Point) -> Point | None:
    """K(B) of the values at the middle of a box and the slopes on it, with Y = `near`; None where it has no bound."""
    middle = [side.mid() for side in box]
    result = []
    for row, weights in enumerate(near):
        side = middle[row] - sum((weight * one for weight, one in zip(weights, value, strict=True)), arb(0))
        for column in range(len(box)):
            turned = sum((weight * line[column] for weight, line in zip(weights, slopes, strict=True)), arb(0))
            side += ((1 if row == column else 0) - turned) * (box[column] - middle[column])
        if not side.is_finite():
            return None
        result.append(side)
    return tuple(result)


def _image(values: Callable[[Point], Sequence[arb]], jacobian: Callable[[Point], Matrix], box: Point) -> Point | None:
    middle = tuple(side.mid() for side in box)
    near = inverse(jacobian(middle))
    return None if near is None else image(near, values(middle), jacobian(box), box)


def _meet(one: Point, other: Point) -> Point:
    return tuple(a.intersection(b) for a, b in zip(one, other, strict=True))
