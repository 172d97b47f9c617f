"""Branch and bound along a boundary: pieces are divided until their bounds are tight and every zero is settled.

Divided are, round by round, the pieces whose bound of a curvature or of its derivative exceeds what is attained at a
point of the boundary by more than the tolerance, and those in which a zero of either is neither excluded nor located.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import Any

from rsym.bounds.balls import arb, ctx
from rsym.sampling.progress import Effort
from rsym.verify.boxes.local import Box, Model
from rsym.verify.cover.covering import PRECISION, extent_of
from rsym.verify.fairness.bending import ArcBending, Arcs
from rsym.verify.fairness.pieces import ArcPiece, divided, narrowed, pieces_of
from rsym.verify.fairness.report import Peak
from rsym.verify.fairness.zeros import CurvatureZero, Settled, settle

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
