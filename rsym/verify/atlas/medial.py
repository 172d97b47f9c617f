"""The middle of a strip: where a harmonic function with 1 on one bank and -1 on the other is zero."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter1d
from scipy.sparse import coo_array
from scipy.sparse.linalg import spsolve

from rsym.sampling.isolines import isolines
from rsym.verify.atlas.grid import Floats, Grid, Ints, narrowest

Marks = NDArray[np.bool_]
# Pixels across the narrowest strip, and along each side of the picture at least and at most.
ACROSS, FEWEST, MOST = 6, 240, 1200
SMOOTHING = (3.0, 1.5, 0.75)  # standard deviations tried, in widths of the strip


def middle_lines(grid: Grid, kinds: Ints, strips: Sequence[Marks]) -> list[tuple[Floats, ...]]:
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


def _smoothed(line: Floats, width: float, grid: Grid, strip: Marks) -> Floats:
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


def _straight_ends(line: Floats, length: int, grid: Grid, strip: Marks) -> Floats:
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


def _harmonic(values: Floats, free: Marks) -> Floats:
    """The array with its free entries replaced by the mean of their neighbours; those that are 0 have no say."""
    number = np.full(values.shape, -1, np.int64)
    number[free] = np.arange(np.count_nonzero(free))
    rows: list[Ints] = []
    columns: list[Ints] = []
    right = np.zeros(np.count_nonzero(free))
    degree = np.zeros(len(right))
    for axis in (0, 1):
        for way in (slice(None, -1), slice(1, None)):
            here, there = ((way, slice(None)), (_other(way), slice(None)))
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


def _other(way: slice) -> slice:
    return slice(1, None) if way == slice(None, -1) else slice(None, -1)
