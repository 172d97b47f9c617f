"""Branch and bound along a boundary: pieces are divided until their bounds are tight and every zero is settled.

Divided are, round by round, the pieces whose bound of a curvature or of its derivative exceeds what is attained at a
point of the boundary by more than the tolerance, and those in which a zero of either is neither excluded nor located.
A zero is excluded where the ball does not contain it; it is located by Krawczyk's operator on {F = 0, k' = 0}, which
proves that there is exactly one in a box around the piece. A zero of k without a change of sign is one of k' too.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import Any

from rsym.bounds.balls import arb, ctx
from rsym.sampling.progress import Effort
from rsym.verify.boxes.borders import is_within
from rsym.verify.boxes.krawczyk import common_zero, narrowed_zero
from rsym.verify.boxes.local import PRECISE, PRECISION, Box, Model, side
from rsym.verify.boxes.vanishing import vanishes_with
from rsym.verify.cover.covering import extent_of
from rsym.verify.fairness.bending import ArcBending, Arcs, BendingBalls
from rsym.verify.fairness.pieces import (
    GROWN,
    POINT_BITS,
    ArcPiece,
    divided,
    goes_on,
    grown,
    narrowed,
    pieces_of,
    point_above,
)
from rsym.verify.fairness.report import Peak

ZERO = 2.0**-80  # a ball of `POINT_BITS` around 0 narrower than this is called numerically zero
SMALLEST = 2.0**-24  # of the extent: pieces so narrow are not divided
# The variation is at least this share of the square of the largest curvature to be bounded with the tolerance.
VARIATION = 1e-3


@dataclass
class Found:
    """The pieces with their curvatures, what is settled of their zeros, and boxes of which nothing is known."""

    done: list[tuple[ArcBending, Settled]] = field(default_factory=list)
    lost: list[Box] = field(default_factory=list)
    examined: int = 0


def search(
    arcs: Arcs,
    boxes: Iterable[Box],
    bounds: Box,
    *,
    tolerance: float,
    budget: int,
    effort: Effort | None = None,
) -> Found:
    """All pieces of the boundary in settled boxes, divided to the tolerance, or until budget or time end."""
    model, result, extent, effort = arcs.model, Found(), extent_of(bounds), effort or Effort()
    todo: list[ArcPiece] = []
    with ctx.workprec(PRECISION):
        for box in boxes:
            pieces = pieces_of(model, box, extent)
            todo += pieces or []
            if pieces is None:
                result.lost.append(box)
        while todo:
            for piece in todo:
                result.examined += 1
                narrow = narrowed(model, piece)
                if narrow is not None:
                    bent = arcs.bent(narrow)
                    result.done.append((bent, settle(arcs, bent)))
                if result.examined % 64 == 0:
                    effort.reach(result.examined / budget)
            todo = [] if effort.is_over else _next(model, result, tolerance, budget, SMALLEST * extent)
    effort.finish()
    return result


def _next(model: Model, result: Found, tolerance: float, budget: int, smallest: float) -> list[ArcPiece]:
    """Take pieces that are not yet good enough out of those done, in parts.

    Once half the budget is spent, bounds come first. Narrow pieces come last: those next to a singular point would
    take all.
    """
    wide = _too_wide(result.done, tolerance)
    opened = [settled.open for _, settled in result.done]
    either = [a or b for a, b in zip(wide, opened, strict=True)]
    flags = (either,) if 2 * result.examined < budget else (wide, opened)
    widths = [bent.piece.width for bent, _ in result.done]
    choices = ([n for n, width in enumerate(widths) if some[n] and width > smallest] for some in flags)
    wanted = sorted(next(filter(None, choices), []), key=lambda number: -widths[number])
    parts: dict[int, list[ArcPiece]] = {}
    left = budget - result.examined
    for number in wanted:
        if left <= 0:
            break
        parts[number] = divided(model, result.done[number][0].piece)
        left -= len(parts[number])
    result.done = [pair for number, pair in enumerate(result.done) if number not in parts]
    return [piece for some in parts.values() for piece in some]


def _too_wide(done: Sequence[tuple[ArcBending, Settled]], tolerance: float) -> list[bool]:
    """Which pieces have a bound that exceeds what is attained by more than the tolerance."""
    result = [False] * len(done)
    for number in range(len(done[0][0].curvatures) if done else 0):
        low, high, variation = peaks(done, number)
        scale = max(abs(low.attained), abs(high.attained))
        for k, (bent, settled) in enumerate(done):
            own = bent.curvatures[number]
            steep = max(variation.attained, scale**2 * (1 if settled.alike else VARIATION))
            result[k] |= not (
                float(own.value.upper()) <= high.attained + tolerance * scale
                and float(own.value.lower()) >= low.attained - tolerance * scale
                and float(abs(own.first).upper()) <= variation.attained + tolerance * steep
            )
    return result


def peaks(done: Sequence[tuple[ArcBending, Settled]], number: int) -> tuple[Peak, Peak, Peak]:
    """The least and the greatest value of a curvature, and the greatest size of its derivative along the arc."""
    values = [bent.curvatures[number].value for bent, _ in done]
    slopes = [abs(bent.curvatures[number].first) for bent, _ in done]
    points = [(bent.at[number].value, bent.place) for bent, _ in done if bent.own]
    points += [(zero.value, zero.place) for _, settled in done for zero in settled.zeros if zero.number == number]
    steep = [(abs(bent.at[number].first), bent.place) for bent, _ in done if bent.own]
    return (
        _peak(min(float(value.lower()) for value in values), min(points, key=_middle, default=None)),
        _peak(max(float(value.upper()) for value in values), max(points, key=_middle, default=None)),
        _peak(max(float(slope.upper()) for slope in slopes), max(steep, key=_middle, default=None)),
    )


def _middle(pair: tuple[arb, Any]) -> float:
    return float(pair[0].mid())


def _peak(bound: float, best: tuple[arb, Sequence[arb] | None] | None) -> Peak:
    if best is None or best[1] is None:
        return Peak(bound, math.nan, ())
    return Peak(bound, float(best[0].mid()), tuple(float(ball.mid()) for ball in best[1]))


def distinct(zeros: Iterable[CurvatureZero]) -> list[CurvatureZero]:
    """Neighbouring pieces may find the same zero; of one that is proved here and doubted there the doubt stays."""
    result: list[CurvatureZero] = []
    for zero in sorted(zeros, key=lambda zero: zero.proved):
        same = (
            other.number == zero.number
            and other.kind == zero.kind
            and other.proved == zero.proved
            and all(a.overlaps(b) for a, b in zip(other.place, zero.place, strict=True))
            for other in result
        )
        if not any(same):
            result.append(zero)
    return result


@dataclass(frozen=True)
class CurvatureZero:
    """A zero of the first derivative of a curvature, kind "maximum" or "minimum", or of it, kind "inflection".

    `number` says of which curvature; `value` and `place` are balls. `flat`: the curvature vanishes at its extremum,
    `flat_proved` says that exactly.
    """

    number: int
    kind: str
    place: tuple[arb, ...]
    value: arb
    flat: bool = False
    flat_proved: bool = False

    @property
    def proved(self) -> bool:
        """Whether there is such a zero, and no doubt about its kind."""
        return self.flat_proved or not self.flat


@dataclass(frozen=True)
class Settled:
    """What is known of the zeros on a piece: those located, and what stays open or looks constant, unproved."""

    zeros: tuple[CurvatureZero, ...] = ()
    open: bool = False
    alike: bool = False


def settle(arcs: Arcs, bent: ArcBending) -> Settled:
    """The zeros of all curvatures of a piece and of their derivatives."""
    zeros: list[CurvatureZero] = []
    is_open = alike = False
    constant = arcs.constant(bent.piece.arc.function)
    for number, enclosed in enumerate(bent.curvatures):
        if constant[number]:
            continue
        extremum = _extremum(arcs, bent, number, enclosed)
        if extremum is None and _looks_constant(arcs, bent, number):
            alike = True
            continue
        inflection = _inflection(arcs, bent, number, enclosed, extremum)
        zeros += [*(extremum or ()), *(inflection or ())]
        is_open |= extremum is None or inflection is None
    return Settled(tuple(zeros), is_open, alike)


def _extremum(arcs: Arcs, bent: ArcBending, number: int, enclosed: BendingBalls) -> tuple[CurvatureZero, ...] | None:
    """The extremum on the piece, if there is one; None where that stays open."""
    if not enclosed.first.contains(0):
        return ()
    if enclosed.second.contains(0) or not bent.piece.analytic:
        return None
    quantity = arcs.quantities(bent.piece.arc.function)[number]
    found = _located(arcs.model, bent.piece, quantity.first)
    if not found:
        return None if found is None else ()
    with ctx.workprec(POINT_BITS):
        at = arcs.model.on(found)
        there = arcs.enclosed(at, bent.piece.arc.function)[number]
        flat = _is_zero(there.value)
        proved = flat and vanishes_with(at, (bent.piece.arc.function, quantity.first), quantity.value)
    kind = "maximum" if there.second < 0 else "minimum"
    return (CurvatureZero(number, kind, found, there.value, flat, proved),)


def _inflection(
    arcs: Arcs, bent: ArcBending, number: int, enclosed: BendingBalls, extremum: tuple[CurvatureZero, ...] | None
) -> tuple[CurvatureZero, ...] | None:
    """The change of sign on the piece, if there is one; None where that stays open."""
    if not enclosed.value.contains(0):
        return ()
    if enclosed.first.contains(0):
        # Where k'' is not zero, k is strictly convex or concave along the piece: it touches 0 in its extremum alone.
        flat = any(one.flat and _is_in(one.place, bent.piece.box) for one in extremum or ())
        return () if flat and bent.piece.crosses else None
    if not bent.piece.analytic:
        return None
    found = _located(arcs.model, bent.piece, arcs.quantities(bent.piece.arc.function)[number].value)
    if not found:
        return None if found is None else ()
    return (CurvatureZero(number, "inflection", found, arb(0)),)


def _located(model: Model, piece: ArcPiece, node: int) -> tuple[arb, ...] | None:
    """The zero of a node on the arc, empty if none is on this part of the boundary, None if that stays open."""
    box = _roomy(piece)
    if not goes_on(model, piece, box):
        return None
    ends = piece.arc.function, node
    zero = common_zero(model.over(box), ends)
    if zero is None or not zero.exists:
        return None if zero is None else ()
    at = narrowed_zero(model.over(box), ends, zero)
    place = tuple(at.sides)
    with ctx.workprec(PRECISE):
        within = is_within(at, ends)
        if within is False or not _is_in(place, piece.whole):
            return ()
        if within is None:
            return None  # on the border of the bounds, or a hair beside it
        if piece.joined and not at.sign(piece.arc.side) > 0:
            return ()  # on the continuation of the arc, or in the joint itself, of which others speak
    return place


def _is_in(place: tuple[arb, ...], box: Box) -> bool:
    return all(ball.overlaps(side(*ends)) for ball, ends in zip(place, box, strict=True))


def _roomy(piece: ArcPiece) -> Box:
    """The box of a piece as wide across the arc as half along it, and a rim: Krawczyk's image must lie inside."""
    box = piece.box
    if piece.free is not None:
        across = 1 - piece.free
        half = (box[piece.free][1] - box[piece.free][0]) / 4
        middle = sum(box[across]) / 2
        low, high = box[across]
        wide = (min(low, middle - half), max(high, middle + half))
        box = (*box[:across], wide, *box[across + 1 :])
    return grown(grown(box, 0, GROWN), 1, GROWN)


def _looks_constant(arcs: Arcs, bent: ArcBending, number: int) -> bool:
    """Whether the derivative vanishes to the working precision at two points of the piece."""
    piece = bent.piece
    if not bent.at or piece.free is None or not _is_zero(bent.at[number].first):
        return False
    low, high = piece.box[piece.free]
    other = point_above(arcs.model, piece, arb(low + 0.3 * (high - low)))
    if other is None:
        return False
    with ctx.workprec(POINT_BITS):
        return _is_zero(arcs.enclosed(arcs.model.on(other), piece.arc.function, 1)[number].first)


def _is_zero(ball: arb) -> bool:
    """Whether a value is zero as far as the working precision can tell, which proves nothing."""
    return bool(ball.contains(0)) and bool(abs(ball) < ZERO)
