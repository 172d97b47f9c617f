"""Thresholds: the undecided strips of an atlas between what is certified and what is refuted."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_dilation, label

from rsym.reports.document import CERTIFIED, REFUTED, UNDECIDED
from rsym.verify.atlas.grid import KINDS, Floats, Grid, Ints, grid_of, narrowest
from rsym.verify.atlas.medial import middle_lines
from rsym.verify.atlas.outlines import chains
from rsym.verify.atlas.threshold_curve import ThresholdCurve

Marks = NDArray[np.bool_]
TOUCHING = np.ones((3, 3))


def thresholds_of(rectangles: Floats, verdicts: Sequence[str], letters: tuple[str, str]) -> tuple[ThresholdCurve, ...]:
    """One curve for each strip of undecided rectangles with certified ones on one side and refuted ones on another."""
    grid = grid_of(rectangles)
    kinds = np.array([KINDS[verdict] for verdict in verdicts])[grid.owner]
    strips, count = label(kinds == KINDS[UNDECIDED], TOUCHING)
    found = [strips == number for number in range(1, count + 1)]
    banks = [kinds == KINDS[word] for word in (CERTIFIED, REFUTED)]
    parting = [strip for strip in found if all((binary_dilation(strip) & bank).any() for bank in banks)]
    widths = narrowest(kinds, grid.shares)
    middles = middle_lines(grid, kinds, parting)
    result = []
    for strip, middle in zip(parting, middles, strict=True):
        graph, span = next((k, span) for k in (0, 1, None) if (span := _span(grid, strip, kinds, k)) is not None)
        result.append(
            ThresholdCurve(
                letters=letters,
                middle=middle,
                strip=rectangles[np.unique(grid.owner[strip])],
                certified_side=tuple(_side(grid, strip, banks[0])),
                refuted_side=tuple(_side(grid, strip, banks[1])),
                graph=None if graph is None else letters[graph],
                span=span,
                share=float(widths[strip].max()),
            )
        )
    return tuple(result)


def _span(grid: Grid, strip: Marks, kinds: Ints, axis: int | None) -> tuple[float, float] | None:
    """For which values of the other letter a strip, seen along an axis, lies between certified and refuted values.

    None if these values have a gap, or if the two change places: then the threshold is no graph over the other letter.
    At a value where the strip leaves the region one of the two is missing.
    """
    if axis is None:
        return math.nan, math.nan
    one, seen = np.moveaxis(strip, axis, 0), np.pad(np.moveaxis(kinds, axis, 0), ((1, 1), (0, 0)))
    columns = np.flatnonzero(one.any(axis=0))
    first, last = one.argmax(axis=0)[columns], len(one) - 1 - one[::-1].argmax(axis=0)[columns]
    before, after = seen[first, columns], seen[last + 2, columns]
    whole = columns[before * after == -1]
    if not len(whole) or (before * after == 1).any() or np.ptp(before[before * after == -1]) > 0:
        return None
    if len(whole) != whole[-1] - whole[0] + 1:
        return None
    line = grid.lines[1 - axis]
    return float(line[whole[0]]), float(line[whole[-1] + 1])


def _side(grid: Grid, strip: Marks, beside: Marks) -> Iterator[Floats]:
    """The lines along which a strip borders on marked cells."""
    edges: list[tuple[tuple[int, int], tuple[int, int]]] = []
    for axis in (0, 1):
        one, other = np.moveaxis(strip, axis, 0), np.moveaxis(beside, axis, 0)
        touching = (one[1:] & other[:-1]) | (one[:-1] & other[1:])
        for row, column in np.argwhere(touching).tolist():
            ends = (row + 1, column), (row + 1, column + 1)
            edges.append(ends if axis == 0 else (ends[0][::-1], ends[1][::-1]))
    for chain in chains(edges):
        corners: Ints = np.array(chain)
        yield np.column_stack([grid.lines[k][corners[:, k]] for k in (0, 1)])
