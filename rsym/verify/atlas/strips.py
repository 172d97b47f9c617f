"""Thresholds: the undecided strips of an atlas between what is certified and what is refuted."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from typing import TypeAlias

import numpy as np
from scipy.ndimage import binary_dilation, gaussian_filter1d, label
from scipy.sparse import coo_array
from scipy.sparse.linalg import spsolve

from rsym.arrays import Flags, Floats, Ints
from rsym.reports.document import CERTIFIED, REFUTED, UNDECIDED
from rsym.sampling.isolines import isolines
from rsym.verify.atlas.grid import KINDS, Grid, grid_of, narrowest
from rsym.verify.atlas.report import ThresholdCurve

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


def _span(grid: Grid, strip: Flags, kinds: Ints, axis: int | None) -> tuple[float, float] | None:
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


def _side(grid: Grid, strip: Flags, beside: Flags) -> Iterator[Floats]:
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


# The middle of a strip: where a harmonic function with 1 on one bank and -1 on the other is zero.
# Pixels across the narrowest strip, and along each side of the picture at least and at most.
ACROSS, FEWEST, MOST = 6, 240, 1200
SMOOTHING = (3.0, 1.5, 0.75)  # standard deviations tried, in widths of the strip


def middle_lines(grid: Grid, kinds: Ints, strips: Sequence[Flags]) -> list[tuple[Floats, ...]]:
    """For each strip, given by cells of the grid, the lines in its middle; numerical, to about a pixel.

    Examples
    --------
    >>> from rsym.verify.atlas.grid import grid_of
    >>> grid = grid_of(np.array([[[0, 1], [0, 1]], [[1, 2], [0, 1]], [[2, 4], [0, 1]]], dtype=float))
    >>> kinds = np.array([[1], [0], [-1]])
    >>> ((line,),) = middle_lines(grid, kinds, [kinds == 0])
    >>> bool(abs(line[:, 0] - 1.5).max() < 0.01)
    True
    """
    if not strips:
        return []
    finest = min(share.min() for share in grid.shares)
    size = int(np.clip(ACROSS / finest, FEWEST, MOST))
    axes = [line[0] + (line[-1] - line[0]) * (np.arange(size) + 0.5) / size for line in grid.lines]
    places = np.ix_(*(np.searchsorted(line, axis) - 1 for line, axis in zip(grid.lines, axes, strict=True)))
    banks = np.where(np.abs(kinds) == 1, kinds, 0).astype(np.float64)
    height = _harmonic(banks[places], np.any(strips, axis=0)[places])
    result = []
    for strip in strips:
        near = strip[places]
        near[1:] |= near[:-1]
        near[:-1] |= near[1:]
        near[:, 1:] |= near[:, :-1]
        near[:, :-1] |= near[:, 1:]
        width = float(np.median(narrowest(np.where(strip, 0, kinds), grid.shares)[strip])) * size
        lines = isolines(np.where(near, height, np.nan), 0.0, axes)
        result.append(tuple(_smoothed(line, width, grid, strip) for line in lines if len(line) > width))
    return result


def _smoothed(line: Floats, width: float, grid: Grid, strip: Flags) -> Floats:
    """The line without its waves, which are those of the steps of the strip, as far as that keeps it in the strip."""
    closed = bool((line[0] == line[-1]).all())
    for share in SMOOTHING:
        reach = max(1, min(round(3 * share * width), len(line) - 2))
        before, after = line[-1 - reach : -1], line[1 : reach + 1]
        if not closed:
            before, after = 2 * line[0] - line[reach:0:-1], 2 * line[-1] - line[-2 : -2 - reach : -1]
        padded = np.concatenate([before, line, after])
        smooth: Floats = gaussian_filter1d(padded, share * width, axis=0, truncate=3.0)[reach:-reach]
        if strip[_cells(grid, smooth)].all():
            line = smooth
            break
    return line if closed else _straight_ends(line, round(width), grid, strip)


def _straight_ends(line: Floats, length: int, grid: Grid, strip: Flags) -> Floats:
    """The line with both ends drawn straight on: harmonic functions have level lines at right angles to the border."""
    for _ in range(2):
        line = line[::-1]
        if len(line) > 3 * length:
            kept = line[length:]
            slope = (kept[0] - kept[length]) / length
            drawn = kept[0] + np.arange(3 * length, 0, -1)[:, None] * slope
            low, high = np.array([side[[0, -1]] for side in grid.lines]).T
            inside = ((low <= drawn) & (drawn <= high)).all(axis=1) & strip[_cells(grid, drawn)]
            outside = np.flatnonzero(~inside)
            line = np.concatenate([drawn[outside[-1] + 1 if len(outside) else 0 :], kept])
    return line


def _cells(grid: Grid, points: Floats) -> tuple[Ints, Ints]:
    """Rows and columns of the cells of points."""
    first, second = (
        np.clip(np.searchsorted(side, column) - 1, 0, len(side) - 2)
        for side, column in zip(grid.lines, points.T, strict=True)
    )
    return first, second


def _harmonic(values: Floats, free: Flags) -> Floats:
    """The array with its free entries replaced by the mean of their neighbours; those that are 0 have no say."""
    number = np.full(values.shape, -1, np.int64)
    number[free] = np.arange(np.count_nonzero(free))
    rows: list[Ints] = []
    columns: list[Ints] = []
    right = np.zeros(np.count_nonzero(free))
    degree = np.zeros(len(right))
    for axis in (0, 1):
        for way, back in ((slice(None, -1), slice(1, None)), (slice(1, None), slice(None, -1))):
            here, there = ((way, slice(None)), (back, slice(None)))
            if axis:
                here, there = here[::-1], there[::-1]
            inner = free[here] & (free[there] | (values[there] != 0))
            one, other = number[here][inner], number[there][inner]
            degree += np.bincount(one, minlength=len(right))
            right += np.bincount(one, np.where(other < 0, values[there][inner], 0.0), minlength=len(right))
            rows.append(one[other >= 0])
            columns.append(other[other >= 0])
    row, column = np.concatenate(rows), np.concatenate(columns)
    everything = np.arange(len(right))
    system = coo_array(
        (
            np.concatenate([degree, -np.ones(len(row))]),
            (np.concatenate([everything, row]), np.concatenate([everything, column])),
        )
    )
    result = values.copy()
    result[free] = spsolve(system.tocsc(), right)
    return result


# Edges of a lattice, joined to lines.
Node: TypeAlias = tuple[int, int]


def chains(edges: Iterable[tuple[Node, Node]]) -> list[list[Node]]:
    """The lines that edges make, each edge once: open ones first, a closed one ends where it begins.

    Nodes at which a line goes straight on are left out.

    Examples
    --------
    >>> chains([((0, 1), (0, 2)), ((0, 0), (0, 1)), ((0, 2), (1, 2))])
    [[(0, 0), (0, 2), (1, 2)]]
    """
    ends: dict[Node, list[Node]] = {}
    for first, second in sorted(edges):
        ends.setdefault(first, []).append(second)
        ends.setdefault(second, []).append(first)
    starts = [node for node in sorted(ends) if len(ends[node]) % 2] + sorted(ends)
    found = (_walk(ends, start) for start in starts)
    return [_straightened(line) for line in found if len(line) > 1]


def _walk(ends: dict[Node, list[Node]], start: Node) -> list[Node]:
    """A line from a node along edges that are taken away.

    Where lines cross one turns: two strips that touch in a corner have borders that do.
    """
    line = [start]
    while ends[line[-1]]:
        here = line[-1]
        there = min(ends[here], key=lambda node: (len(line) > 1 and _is_straight(line[-2], line[-1], node), node))
        ends[here].remove(there)
        ends[there].remove(here)
        line.append(there)
    return line


def _is_straight(a: Node, b: Node, c: Node) -> bool:
    return (b[0] - a[0]) * (c[1] - b[1]) == (b[1] - a[1]) * (c[0] - b[0])


def _straightened(line: list[Node]) -> list[Node]:
    inner = [b for a, b, c in zip(line, line[1:], line[2:], strict=False) if not _is_straight(a, b, c)]
    return [line[0], *inner, line[-1]]
