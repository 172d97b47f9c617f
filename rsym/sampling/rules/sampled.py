"""Rules on pieces in space of which nothing is proved: lines on which the sign of the form is asked at some places.

There leaves are singular, or touch. What they hold is not resolved, and said to be open, however well lines meet it.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from rsym.arrays import Flags, Floats, Ints
from rsym.sampling.rules.columns import CellRule, LeftOpen, gauss
from rsym.sampling.rules.curves import across, along, placed
from rsym.sampling.rules.division import CutPieces

BASE, ASKED = 3, 5  # Gauss points along each direction of the base, and places on a line
HALVINGS = 30
AT_ONCE = 2**21  # values of leaves


def sampled_rule(functions: Any, pieces: CutPieces) -> tuple[CellRule, LeftOpen]:
    """The rule on pieces in space, and all that they hold as not resolved."""
    x, w = gauss(BASE)
    low, side = (across(a, pieces.axis) for a in (pieces.lower, pieces.upper - pieces.lower))
    base = np.stack(
        [
            (low[0][:, None, None] + side[0][:, None, None] * x[:, None] + 0 * x).ravel(),
            (low[1][:, None, None] + side[1][:, None, None] * x + 0 * x[:, None]).ravel(),
        ]
    )
    share = (np.prod(side, axis=0)[:, None, None] * w[:, None] * w).ravel()
    piece = np.repeat(np.arange(len(pieces)), BASE**2)
    axis, begin, end = pieces.axis[piece], *(along(a, pieces.axis)[piece] for a in (pieces.lower, pieces.upper))
    heights = begin + np.linspace(0, 1, ASKED)[:, None] * (end - begin)

    def inside(which: Ints, height: Floats) -> Flags:
        size = max(1, AT_ONCE // functions.count)
        points = placed(axis[which], base[:, which], height)
        some = [functions.sign(points[:, k : k + size]) > 0 for k in range(0, points.shape[1], size)]
        return np.concatenate(some) if some else np.empty(0, np.bool_)

    line = np.tile(np.arange(len(piece)), ASKED)
    signs = inside(line, heights.ravel()).reshape(ASKED, -1)
    step, which = np.nonzero(signs[1:] != signs[:-1])
    lower, upper, rising = heights[step, which], heights[step + 1, which], signs[step + 1, which]
    for _ in range(HALVINGS):
        middle = (lower + upper) / 2
        right = inside(which, middle) == rising
        lower, upper = np.where(right, lower, middle), np.where(right, middle, upper)
    root = (lower + upper) / 2
    first, last = heights[:-1].copy(), heights[1:].copy()
    first[step[rising], which[rising]] = root[rising]
    last[step[~rising], which[~rising]] = root[~rising]
    held = signs[1:] | signs[:-1]
    own = np.nonzero(held)[1]
    places, wide = (first[held] + last[held]) / 2, (last - first)[held]
    tall = (pieces.upper - pieces.lower).max(axis=0)
    edge = placed(axis[which], base[:, which], root)
    leaf, slope = _nearest(functions, edge)
    with np.errstate(all="ignore"):
        longer = np.sqrt((slope**2).sum(axis=0)) / np.abs(along(slope, axis[which]))
    # Not more than the sides of the piece hold.
    weight = np.fmin(share[which] * longer, tall[piece[which]] ** 2 / BASE**2)
    made = CellRule(
        placed(axis[own], base[:, own], places),
        share[own] * wide,
        pieces.owner[piece[own]],
        edge,
        weight,
        leaf,
        pieces.owner[piece[which]],
    )
    content = np.prod(pieces.upper - pieces.lower, axis=0).sum()
    return made, LeftOpen(float(content), float((tall**2).sum()))


def _nearest(functions: Any, points: Floats) -> tuple[Ints, Floats]:
    """The leaves (n,) that are closest to zero at points, and their gradients there (dim, n)."""
    count, every = points.shape[1], np.arange(functions.count)
    size = max(1, AT_ONCE // functions.count)
    leaves = []
    for k in range(0, count, size):
        some = points[:, k : k + size]
        value, _ = functions.evaluate(np.repeat(every, some.shape[1]), np.tile(some, functions.count))
        size_of = np.where(np.isfinite(value), np.abs(value), np.inf).reshape(functions.count, -1)
        leaves.append(np.argmin(size_of, axis=0))
    leaf = np.concatenate(leaves) if leaves else np.empty(0, np.int64)
    return leaf, functions.evaluate(leaf, points)[1]
