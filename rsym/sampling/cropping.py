"""Lines within bounds: the lattice that they are found on reaches beyond them by up to a cell."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import numpy as np

from rsym.arrays import Floats
from rsym.model.shape import Bounds

# What is beyond the bounds by no more than this share of their size touches them.
TOUCHING = 1e-9


def cropped(lines: Iterable[Floats], bounds: Bounds) -> tuple[list[Floats], list[tuple[int, int, int]]]:
    """What of lines (n, 2 and more columns) lies within the bounds, and the ends that this made.

    New ends are put where chords cross the border, their other columns in proportion; each is named by its line,
    its vertex, and the coordinate that the border fixes. A line that only touches the bounds stays as it is.

    Examples
    --------
    >>> lines, ends = cropped([np.array([[-1.0, 0.0], [1.0, 0.0], [1.0, 4.0]])], ((0, 2), (-1, 1)))
    >>> lines[0].tolist(), ends
    ([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]], [(0, 0, 0), (0, 2, 1)])
    """
    low, high = np.array(bounds, float).T
    slack = TOUCHING * float((high - low).max())
    low, high = low - slack, high + slack
    found: list[Floats] = []
    ends: list[tuple[int, int, int]] = []
    for line in lines:
        outside = ((line[:, :2] < low) | (line[:, :2] > high)).any(axis=1)
        if not outside.any():
            found.append(line)
            continue
        if (line[0] == line[-1]).all():  # closed: begin outside, so that no piece goes round
            first = int(np.argmax(outside))
            line = np.concatenate([line[first:-1], line[: first + 1]])
        for piece, borders in _pieces(line, low, high):
            for vertex, axis in borders:
                piece[vertex, axis] = min(bounds[axis], key=lambda border: abs(border - piece[vertex, axis]))
                ends.append((len(found), vertex, axis))
            found.append(piece)
    return found, ends


def _pieces(line: Floats, low: Floats, high: Floats) -> Iterator[tuple[Floats, list[tuple[int, int]]]]:
    """The pieces of one line within a box, with the vertices on its border and the coordinate that is fixed there."""
    start, step = line[:-1], np.diff(line, axis=0)
    with np.errstate(divide="ignore", invalid="ignore"):
        places = np.stack([(end - start[:, :2]) / step[:, :2] for end in (low, high)])
    # Along an axis without a step a chord is within the box or not: infinite places of both signs, or of one.
    first, last = places.min(axis=0), places.max(axis=0)
    entry, exit = first.max(axis=1), last.min(axis=1)
    begin, end = np.maximum(entry, 0), np.minimum(exit, 1)
    inside = begin < end
    begins = np.flatnonzero(inside & ~(np.r_[False, inside[:-1]] & (entry <= 0)))
    stops = np.flatnonzero(inside & ~(np.r_[inside[1:], False] & (exit >= 1)))
    for i, j in zip(begins, stops, strict=True):
        head, tail = start[i] + begin[i] * step[i], start[j] + end[j] * step[j]
        piece = np.concatenate([head[None], line[i + 1 : j + 1], tail[None]])
        borders = [(0, int(first[i].argmax()))] if entry[i] > 0 else []
        yield piece, borders + ([(len(piece) - 1, int(last[j].argmin()))] if exit[j] < 1 else [])
