"""Lines on a picture of a body: antialiased, hidden where the body hides them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from rsym.output.shading import linear

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

INK = "#20242b"
SMOOTH = 10.0  # degrees: where leaves meet at a smaller angle nobody sees an edge
STEP = 0.5  # samples between two dots of a line: nearer ones look the same
# A line lies on the surface, a sample beside it up to this many samples' depth in front: surfaces are steep there.
NEAR, STEEP = 2.0, 4.0
AROUND = [(row, column) for row in (-1, 0, 1) for column in (-1, 0, 1)]


def draw_lines(samples: NDArray[np.float32], depth: Floats, lines: Floats, width: float) -> None:
    """Draw straight lines into a picture.

    Parameters
    ----------
    samples : (h, w, 4) array
        Light times coverage and coverage, changed in place.
    depth : (h, w) array
        The depth of the body at each sample, NaN where there is none.
    lines : (n, 2, 3) array
        x and y in samples and depth of both ends.
    width : float
        In samples.

    Examples
    --------
    >>> samples, depth = np.zeros((4, 6, 4), np.float32), np.full((4, 6), 1.0)
    >>> depth[:, 3:] = 0.0
    >>> draw_lines(samples, depth, np.array([[[0.0, 1.5, 0.5], [6.0, 1.5, 0.5]]]), 1.0)
    >>> samples[1, :, 3] > 0.5
    array([ True,  True,  True,  True, False, False])
    """
    dots = _dots(lines)
    dots = dots[_is_visible(dots, depth)]
    ink = _spread(dots, width, depth.shape).reshape(depth.shape)[..., None]
    samples *= 1 - ink
    samples[..., :3] += ink * linear(INK)
    samples[..., 3:] += ink


def _dots(lines: Floats) -> Floats:
    """Points (n, 3) along the lines, closer than half a sample."""
    starts, ways = lines[:, 0], lines[:, 1] - lines[:, 0]
    counts = np.ceil(np.hypot(ways[:, 0], ways[:, 1]) / STEP).astype(np.int64).clip(1)
    which = np.repeat(np.arange(len(counts)), counts)
    share = (np.arange(len(which)) - np.repeat(np.cumsum(counts) - counts, counts) + 0.5) / counts[which]
    dots: Floats = starts[which] + share[:, None] * ways[which]
    return dots


def _is_visible(dots: Floats, depth: Floats) -> NDArray[np.bool_]:
    """Whether no sample hides a dot: one beside it at least is as far away, or nothing is there."""
    height, width = depth.shape
    row, column = np.floor(dots[:, 1]).astype(np.int64), np.floor(dots[:, 0]).astype(np.int64)
    padded = np.pad(depth, 1, constant_values=np.nan)
    inside = (row >= 0) & (row < height) & (column >= 0) & (column < width)
    row, column = np.where(inside, row, 0), np.where(inside, column, 0)
    around = np.stack([padded[row + 1 + i, column + 1 + j] for i, j in AROUND])
    nearest, farthest = np.fmin.reduce(around), np.fmax.reduce(around)
    known = depth[np.isfinite(depth)]
    slack = NEAR * np.ptp(known) / max(depth.shape) if known.size else 0.0
    hidden = dots[:, 2] > farthest + slack + np.minimum(farthest - nearest, STEEP * slack)
    visible: NDArray[np.bool_] = inside & ~hidden
    return visible


def _spread(dots: Floats, width: float, size: tuple[int, ...]) -> NDArray[np.float32]:
    """The share of each sample (h*w,) that round dots cover."""
    ink = np.zeros(size[0] * size[1], np.float32)
    reach = int(np.ceil(width / 2 + 0.5))
    corner = np.floor(dots[:, :2]).astype(np.int64)
    for i in range(-reach, reach + 1):
        for j in range(-reach, reach + 1):
            row, column = corner[:, 1] + i, corner[:, 0] + j
            away = np.hypot(column + 0.5 - dots[:, 0], row + 0.5 - dots[:, 1])
            share = np.clip(width / 2 + 0.5 - away, 0.0, min(width, 1.0))
            there = (share > 0) & (row >= 0) & (row < size[0]) & (column >= 0) & (column < size[1])
            np.maximum.at(ink, row[there] * size[1] + column[there], share[there].astype(np.float32))
    return ink
