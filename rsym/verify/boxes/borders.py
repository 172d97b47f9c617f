"""Borders of the bounds: a verdict speaks of the closed box of the bounds, and of nothing beside it."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

from rsym.verify.boxes.local import Local
from rsym.verify.boxes.vanishing import vanishes_with


def is_within(at: Local, given: Sequence[int] = ()) -> bool | None:
    """Whether a place certainly lies within the bounds of its model, or certainly outside; None where neither is sure.

    `at` is a narrow box around the place, `given` are nodes of which it is the only common zero in that box: with
    them a place on the border is known to be there where its coordinate follows exactly. The border is within.
    """
    builder, sure = at.model.builder, True
    for name, place, (low, high) in zip(builder.coordinates, at.sides, at.model.bounds or (), strict=False):
        if place < low or place > high:
            return False
        for border, inner in ((low, place >= low), (high, place <= high)):
            if inner:
                continue
            if not given:
                sure = False
                continue
            beyond = builder.sub(builder.input(name), builder.const(Fraction(border)))
            sure = sure and vanishes_with(at, given, beyond)
    return True if sure else None
