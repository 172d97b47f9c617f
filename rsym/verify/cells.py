"""Endless rows within bounds: the few cells that are seen, chosen by their borders.

The sawtooth t - h round(t/h) takes an angle, which jumps on every border. Between bounds it is t - h k, with a k that
is chosen: the same function, of which both sides of a border are known.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import sympy as sp

from rsym.model.choices import Choice
from rsym.model.symbols import rebuild
from rsym.model.symmetry.waves import SawtoothWave

MOST = 48  # cells; of more the wave stays as it is


def within_cells(
    expression: sp.Expr, coordinates: Sequence[sp.Symbol], bounds: Sequence[tuple[float, float]]
) -> sp.Expr:
    """The expression with each sawtooth of a coordinate written by choices.

    Both are equal within the bounds and as far beyond them as these are wide, for boxes that stick out.

    Examples
    --------
    >>> from rsym import x
    >>> within_cells(SawtoothWave(x, sp.Integer(2)), (x,), ((0.5, 1.5),))
    x - (2 if x > 1 else 0)
    """
    sides: Mapping[sp.Symbol, tuple[float, float]] = dict(zip(coordinates, bounds, strict=False))

    def chosen(part: sp.Basic) -> sp.Expr | None:
        if not isinstance(part, SawtoothWave) or part.args[0] not in sides or not part.args[1].is_Rational:
            return None
        t, period = part.args
        low, high = map(sp.Rational, sides[t])
        wide = high - low
        first, last = (math.floor(place / period + sp.S.Half) for place in (low - wide, high + wide))
        if last - first >= MOST:
            return None
        turn: sp.Expr = first * period
        for cell in range(first + 1, last + 1):
            turn = Choice(t, (cell - sp.S.Half) * period, cell * period, turn)
        return t - turn

    return rebuild(expression, chosen)
