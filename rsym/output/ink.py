"""Lines on a picture of a body: antialiased, hidden where the body hides them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rsym.output.rasteriser import Triangles
from rsym.output.shading import linear
from rsym.sampling.sharp.features import Feature

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

INK = "#20242b"
SMOOTH = 10.0  # degrees: where leaves meet at a smaller angle nobody sees an edge
# Where surfaces touch, points that are a little off their common curve have any angle between the normals up to 60
# degrees, but a quarter of them has less than 10.
TOUCHING = 0.25
STEP = 0.5  # samples between two dots of a line: nearer ones look the same
# What hides a line is nearer by this many samples; a plane beside it is followed so far, as it may be seen at a slant.
NEAR, SLANT = 1.0, 20.0
AROUND = [(row, column) for row in (-1, 0, 1) for column in (-1, 0, 1)]


@dataclass(frozen=True)
class Stroke:
    """Straight pieces (n, 2, 3) in space to draw with a body; one whose ends are equal is a round dot.

    `width` is in points; `hidden` is the share of the ink that is left where the body hides a piece.
    """

    pieces: Floats
    colour: str = INK
    width: float = 0.7
    hidden: float = 0.0


def draw_lines(
    samples: NDArray[np.float32],
    nearest: Ints,
    triangles: Triangles,
    lines: Floats,
    width: float,
    colour: str = INK,
    hidden: float = 0.0,
) -> None:
    """Draw straight lines on a body, or in the space around it, into its picture.

    Parameters
    ----------
    samples : (h, w, 4) array
        Light times coverage and coverage, changed in place.
    nearest : (h, w) array
        Which of the triangles each sample shows, -1 where there is none.
    triangles : Triangles
        The body.
    lines : (n, 2, 3) array
        x and y in samples and depth of both ends.
    width : float
        In samples.
    colour, hidden
        As in a `Stroke`.

    Examples
    --------
    >>> from rsym.output.rasteriser import rasterise, snap
    >>> wall, post = [[0.0, 0, 1], [30, 0, 1], [0, 30, 1]], [[3.0, 0, 0], [8, 0, 0], [3, 30, 0]]
    >>> scene = snap(np.array([wall, post]))
    >>> samples = np.zeros((4, 10, 4), np.float32)
    >>> draw_lines(samples, rasterise(scene, (4, 10)), scene, np.array([[[0.0, 1.5, 0.5], [10.0, 1.5, 0.5]]]), 1.0)
    >>> (samples[1, :, 3] > 0.5).astype(int)
    array([1, 1, 1, 1, 0, 0, 0, 1, 1, 1])
    """
    dots = _dots(lines)
    visible = _is_visible(dots, nearest, triangles)
    ink = _spread(dots[visible], width, nearest.shape)
    if hidden:
        ink = np.maximum(ink, hidden * _spread(dots[~visible], width, nearest.shape))
    share = ink.reshape(nearest.shape)[..., None]
    samples *= 1 - share
    samples[..., :3] += share * linear(colour)
    samples[..., 3:] += share


def _dots(lines: Floats) -> Floats:
    """Points (n, 3) along the lines, closer than half a sample."""
    starts, ways = lines[:, 0], lines[:, 1] - lines[:, 0]
    counts = np.ceil(np.hypot(ways[:, 0], ways[:, 1]) / STEP).astype(np.int64).clip(1)
    which = np.repeat(np.arange(len(counts)), counts)
    share = (np.arange(len(which)) - np.repeat(np.cumsum(counts) - counts, counts) + 0.5) / counts[which]
    dots: Floats = starts[which] + share[:, None] * ways[which]
    return dots


def _is_visible(dots: Floats, nearest: Ints, triangles: Triangles) -> NDArray[np.bool_]:
    """Whether a triangle beside a dot, extended to it, does not hide it; a line is on such a triangle if it is seen."""
    height, width = nearest.shape
    row, column = np.floor(dots[:, 1]).astype(np.int64), np.floor(dots[:, 0]).astype(np.int64)
    inside = (row >= 0) & (row < height) & (column >= 0) & (column < width)
    row, column, padded = np.where(inside, row, 0), np.where(inside, column, 0), np.pad(nearest, 1, constant_values=-1)
    sample = np.ptp(triangles.depth) / max(nearest.shape)
    visible, empty = np.zeros(len(dots), np.bool_), np.ones(len(dots), np.bool_)
    for i, j in AROUND:
        face = padded[row + 1 + i, column + 1 + j]
        there = np.flatnonzero(face >= 0)
        face, dot = face[there], dots[there]
        plane = triangles.depths(face, dot[:, 0], dot[:, 1])
        farthest = triangles.depth[face].max(axis=1) + SLANT * sample
        visible[there] |= dot[:, 2] <= np.minimum(plane, farthest) + NEAR * sample
        empty[there] = False
    return np.asarray(inside & (visible | empty))


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


def visible(features: Sequence[Feature], least: float) -> list[Feature]:
    """The features that one sees as edges: at three quarters of their points or more the angle is not below the least.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y, z
    >>> half = rsym.Shape(rsym.conjunction(1 - x**2 - y**2 - z**2, z), (x, y, z), bounds=((-1.2, 1.2),) * 3)
    >>> rims = rsym.mesh(half, 16).features
    >>> len(visible(rims, 10)), len(visible(rims, 100))
    (1, 0)
    """
    return [one for one in features if np.quantile(one.angles, TOUCHING) >= least]
