"""Level lines of an array of numbers, as they lie between its entries."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from skimage.measure import find_contours

from rsym.arrays import Flags, Floats, Ints

# The sides of a square of four entries, and the entries at their ends, which count by rows.
_T, _B, _L, _R = range(4)
_ENDS = np.array([(0, 1), (2, 3), (0, 2), (1, 3)]).T
# By which entries are high, 1 + 2 + 4 + 8: through which side a line comes in and goes out, high ones to its right.
# Two lines keep the low ones of a saddle apart.
_CASES = (
    (), (_T, _L), (_R, _T), (_R, _L), (_L, _B), (_T, _B), (_R, _T, _L, _B), (_R, _B),
    (_B, _R), (_T, _L, _B, _R), (_B, _T), (_B, _L), (_L, _R), (_T, _R), (_L, _T), (),
)  # fmt: skip
_COUNT = np.array([len(case) // 2 for case in _CASES])
_SIDES = np.array([[*case, 0, 0, 0, 0][:4] for case in _CASES]).reshape(-1, 2, 2)


def isolines(values: Floats, level: float, axes: Sequence[Floats]) -> list[Floats]:
    """Polylines (n, 2) on which the linear interpolation of an array has a value; they end beside NaN.

    Parameters
    ----------
    values : (k, m) array
        The numbers.
    level : float
        The value.
    axes : two arrays, (k,) and (m,)
        The coordinates of rows and columns, increasing.

    Examples
    --------
    >>> isolines(np.array([[0.0, 0.0], [1.0, 1.0]]), 0.25, ([2, 4], [0, 1]))[0].tolist()
    [[2.5, 0.0], [2.5, 1.0]]
    """
    lines = index_lines(values, level)
    numbers = [np.arange(len(axis)) for axis in axes]
    return [np.column_stack([np.interp(line[:, k], numbers[k], axes[k]) for k in (0, 1)]) for line in lines]


def index_lines(values: Floats, level: float) -> list[Floats]:
    """Those of `isolines` in indices, low entries to their left: `skimage.measure.find_contours`, to the bit.

    That goes from entry to entry and from point to point in Python; an array of 2000 entries a side takes a quarter of
    its time here.
    """
    start, end = _segments(values, level)
    if np.isfinite(start).all() and np.isfinite(end).all():
        keys = _keys(np.stack([start, end]), values.shape[1])
        real = keys[0] != keys[1]  # else an entry has the level, and the line is that of other squares
        start, end = start[real], end[real]
        after = _after(*keys[:, real])
        if after is not None:
            return [np.concatenate([start[line], end[line[-1:]]]) for line in _followed(after)]
    lines: list[Floats] = find_contours(values, level)
    return lines


def lines_through(middles: Ints, high: Flags) -> list[Ints]:
    """Lines through squares of any size by the middles of their sides, high ones to the left.

    Parameters
    ----------
    middles : (k, 4, 2) array of int
        Of the sides of smaller row, larger row, smaller column and larger column: they name what squares share.
    high : (k, 4) array of bool
        The corners, by rows.

    Examples
    --------
    >>> square = np.array([[[0, 1], [2, 1], [1, 0], [1, 2]]])
    >>> [line.tolist() for line in lines_through(square, np.array([[False, False, True, True]]))]
    [[[1, 2], [1, 0]]]
    """
    case = high @ np.array([1, 2, 4, 8])
    square = np.repeat(np.arange(len(case)), _COUNT[case])
    second = (np.diff(square, prepend=-1) == 0).astype(np.int64)
    goes, comes = middles[square[:, None], _SIDES[case[square], second]].swapaxes(0, 1)
    width = int(middles[..., 1].max(initial=0)) + 1
    after = _each_after(*(place @ np.array([width, 1]) for place in (comes, goes)))
    return [np.concatenate([comes[line], goes[line[-1:]]]) for line in _followed(after)]


def pieces(inside: Flags) -> Ints:
    """The pieces less the holes of sets of points (k, m, m): vertices less edges and squares."""
    across, along = inside[:, 1:] & inside[:, :-1], inside[:, :, 1:] & inside[:, :, :-1]
    squares = across[:, :, 1:] & across[:, :, :-1]
    counts = [np.count_nonzero(one, axis=(1, 2)) for one in (inside, across, along, squares)]
    return np.asarray(counts[0] - counts[1] - counts[2] + counts[3])


def beyond_chords(high: Flags, most: float) -> Flags:
    """In which cells (k, m, m) of samples one lies by more than `most` of their steps on the wrong side of the chord.

    That is between the sides that a line crosses, if there are two.

    Examples
    --------
    >>> corner, finger = np.eye(9, dtype=bool), np.eye(9, dtype=bool)
    >>> corner[1:], finger[7:] = False, False
    >>> beyond_chords(np.array([corner, finger]), 2.5).tolist()
    [False, True]
    """
    at = np.indices(high.shape[1:])
    crossed = np.zeros((*high.shape[:1], 4), np.bool_)
    places = np.zeros((*crossed.shape, 2))
    for side, (axis, end) in enumerate(((0, 0), (0, high.shape[1] - 1), (1, 0), (1, high.shape[1] - 1))):
        samples = high.take(end, 1 + axis)
        crossed[:, side] = samples[:, 0] != samples[:, -1]
        places[:, side, axis] = end
        places[:, side, 1 - axis] = np.argmax(samples != samples[:, :1], axis=1) - 0.5
    two = np.flatnonzero(np.count_nonzero(crossed, axis=1) == 2)
    start, end = places[two][crossed[two]].reshape(-1, 2, 2).transpose(1, 0, 2)
    (p, q), length = (end - start).T, np.linalg.norm(end - start, axis=1)
    away = p[:, None, None] * (at[1] - start[:, 1, None, None]) - q[:, None, None] * (at[0] - start[:, 0, None, None])
    away /= length[:, None, None]
    corners = away[:, [0, 0, -1, -1], [0, -1, 0, -1]]
    largest, own = np.argmax(np.abs(corners), axis=1), np.arange(len(two))
    above = high[two][:, [0, 0, -1, -1], [0, -1, 0, -1]][own, largest]
    away *= np.where((corners[own, largest] > 0) == above, 1, -1)[:, None, None]
    far = np.zeros(len(high), np.bool_)
    far[two] = ((np.abs(away) > most) & ((away > 0) != high[two])).any(axis=(1, 2))
    return far


def _segments(values: Floats, level: float) -> tuple[Floats, Floats]:
    """Where the lines come into the squares, by rows, and where they leave them, in indices (n, 2)."""
    high = values > level
    across = high[:, 1:] != high[:, :-1]
    crossed = np.flatnonzero(across[:-1] | across[1:] | (high[1:, :-1] != high[:-1, :-1]))
    row, column = np.divmod(crossed, values.shape[1] - 1)
    entries = np.array([values[row + k, column + j] for k in (0, 1) for j in (0, 1)])
    known = ~np.isnan(entries).any(axis=0)
    row, column, entries = row[known], column[known], entries[:, known]
    case = ((entries > level) * np.array([[1], [2], [4], [8]])).sum(axis=0)
    low, high_end = entries[_ENDS]
    with np.errstate(all="ignore"):
        share = np.where(low == high_end, 0, (level - low) / (high_end - low))
    points = np.empty((4, len(case), 2))
    points[[_T, _B], :, 0], points[[_L, _R], :, 1] = (row, row + 1), (column, column + 1)
    points[[_L, _R], :, 0] = row + share[[_L, _R]]
    points[[_T, _B], :, 1] = column + share[[_T, _B]]
    square = np.repeat(np.arange(len(case)), _COUNT[case])
    second = (np.diff(square, prepend=-1) == 0).astype(np.int64)
    comes, goes = _SIDES[case[square], second].T
    return points[comes, square], points[goes, square]


def _keys(points: Floats, columns: int) -> Ints:
    """Numbers that are the same where points on the sides of squares are."""
    whole = np.floor(points)
    row, column = np.moveaxis(whole.astype(np.int64), -1, 0)
    below, beside = np.moveaxis(points > whole, -1, 0)
    return np.asarray(3 * (columns * row + column) + 2 * below + beside)


def _after(start: Ints, end: Ints) -> Ints | None:
    """Which segment comes after each, -1 where none does; None where several meet, whose order decides then."""
    order = np.argsort(start, kind="stable")
    first = start[order]
    place = np.searchsorted(first, end)
    goes_on = place < len(first)
    goes_on[goes_on] = first[place[goes_on]] == end[goes_on]
    followers = order[place[goes_on]]
    if (first[1:] == first[:-1]).any() or (np.bincount(followers) > 1).any():
        return None
    after = np.full(len(start), -1)
    after[goes_on] = followers
    return after


def _each_after(start: Ints, end: Ints) -> Ints:
    """Which segment comes after each, -1 where none does; of several that meet the first comes after the first."""
    order, ends = np.argsort(start, kind="stable"), np.argsort(end, kind="stable")
    place = np.empty(len(end), np.int64)
    place[ends] = np.arange(len(end)) - np.searchsorted(end[ends], end[ends]) + np.searchsorted(start[order], end[ends])
    goes_on = place < len(start)
    goes_on[goes_on] = start[order[place[goes_on]]] == end[goes_on]
    return np.asarray(np.where(goes_on, order[np.where(goes_on, place, 0)], -1)) if len(start) else place


def _followed(after: Ints) -> list[Ints]:
    """The segments of each line as they follow each other, lines by their first ones; the last closes what is closed.

    Each looks twice as far ahead as in the round before, so that all lines are followed at once.
    """
    here = np.arange(len(after))
    rounds = range(len(after).bit_length())
    greatest, ahead = here, np.where(after < 0, here, after)
    for _ in rounds:
        greatest, ahead = np.maximum(greatest, greatest[ahead]), ahead[ahead]
    ends = (after < 0) | ((after[ahead] >= 0) & (greatest == here))
    last = np.where(ends, here, after)
    left = (last != here).astype(np.int64)  # segments to the end of the line
    for _ in rounds:
        left, last = left + left[last], last[last]
    order = np.lexsort((-left, last))
    lines = np.split(order, np.flatnonzero(np.diff(last[order])) + 1) if len(order) else []
    return sorted(lines, key=np.min)
