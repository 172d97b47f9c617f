"""Lines on a picture of a body: antialiased, hidden where the body hides them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rsym.arrays import Floats, Ints
from rsym.output.rasteriser import ScreenTriangles, picked
from rsym.output.shading import linear
from rsym.sampling.sharp.features import Feature

INK = "#20242b"
SMOOTH = 10.0  # degrees: where leaves meet at a smaller angle nobody sees an edge
# Where surfaces touch, points that are a little off their common curve have any angle between the normals up to 60
# degrees, but a quarter of them has less than 10.
TOUCHING = 0.25
RIM = 1.4  # points: what is left white around a dot
SHADES = 1 << 20  # of ink: far more than a picture has
# Samples between two dots of a line, nearer ones look the same; as a share of its width they leave the border of a wide
# line straight to a 250th of it.
STEP, STRIDE = 0.5, 0.125
# What hides a line is nearer by this many samples; a plane beside it is followed so far, as it may be seen at a slant.
NEAR, SLANT = 1.0, 20.0
AROUND = [(row, column) for row in (-1, 0, 1) for column in (-1, 0, 1)]


@dataclass(frozen=True)
class Stroke:
    """Straight pieces (n, 2, 3) in space to draw with a body; one whose ends are equal is a round dot.

    `colour` is one for all, as matplotlib writes colours, or the linear light (n, 3) of each; `width` is in points;
    `hidden` is the share of the ink that is left where the body hides a piece.
    """

    pieces: Floats
    colour: str | Floats = INK
    width: float = 0.7
    hidden: float = 0.0


def draw_lines(
    samples: NDArray[np.float32],
    nearest: Ints,
    triangles: ScreenTriangles,
    lines: Floats,
    width: float,
    colour: str | Floats = INK,
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
    dots, lines_of = _dots(lines, max(STEP, STRIDE * width))
    visible = _is_visible(dots, nearest, triangles)
    inks = [(1.0, *_spread(dots[visible], lines_of[visible], width, nearest.shape))]
    if hidden:
        inks.insert(0, (hidden, *_spread(dots[~visible], lines_of[~visible], width, nearest.shape)))
    colours = linear(colour)[None] if isinstance(colour, str) else colour
    flat = samples.reshape(-1, 4)
    for strength, where, share, line in inks:
        ink = (strength * share)[:, None]
        flat[where] *= 1 - ink
        flat[where, :3] += ink * colours[line if len(colours) > 1 else 0]
        flat[where, 3:] += ink


def _dots(lines: Floats, step: float) -> tuple[Floats, Ints]:
    """Points (n, 3) along the lines, at most a step of the picture apart, and which line each is on."""
    starts, ways = lines[:, 0], lines[:, 1] - lines[:, 0]
    counts = np.ceil(np.hypot(ways[:, 0], ways[:, 1]) / step).astype(np.int64).clip(1)
    which = np.repeat(np.arange(len(counts)), counts)
    share = (np.arange(len(which)) - np.repeat(np.cumsum(counts) - counts, counts) + 0.5) / counts[which]
    dots: Floats = starts[which] + share[:, None] * ways[which]
    return dots, which


def _is_visible(dots: Floats, nearest: Ints, triangles: ScreenTriangles) -> NDArray[np.bool_]:
    """Whether a triangle beside a dot, extended to it, does not hide it; a line is on such a triangle if it is seen."""
    height, width = nearest.shape
    row, column = np.floor(dots[:, 1]).astype(np.int64), np.floor(dots[:, 0]).astype(np.int64)
    inside = (row >= 0) & (row < height) & (column >= 0) & (column < width)
    row, column, padded = np.where(inside, row, 0), np.where(inside, column, 0), np.pad(nearest, 1, constant_values=-1)
    sample = np.ptp(triangles.depth) / max(nearest.shape)
    visible, empty = np.zeros(len(dots), np.bool_), np.ones(len(dots), np.bool_)
    limits = triangles.depth.max(axis=1, initial=-np.inf) + SLANT * sample
    for i, j in AROUND:
        face = padded[row + 1 + i, column + 1 + j]
        there = np.flatnonzero(face >= 0)
        face, dot = face[there], picked(dots, there)
        plane = triangles.depths(face, dot[:, 0], dot[:, 1])
        visible[there] |= dot[:, 2] <= np.minimum(plane, limits[face]) + NEAR * sample
        empty[there] = False
    return np.asarray(inside & (visible | empty))


def _spread(dots: Floats, names: Ints, width: float, size: tuple[int, ...]) -> tuple[Ints, Floats, Ints]:
    """The samples that round dots cover, the share of each, and the name of the dot that covers it most, the last."""
    best = np.zeros(size[0] * size[1], np.int64)
    reach = int(np.ceil(width / 2 + 0.5))
    x, y = dots[:, 0].copy(), dots[:, 1].copy()
    left, bottom = np.floor(x).astype(np.int64), np.floor(y).astype(np.int64)
    for i in range(-reach, reach + 1):
        row = bottom + i
        across, inside = (row + 0.5 - y) ** 2, (row >= 0) & (row < size[0])
        for j in range(-reach, reach + 1):
            column = left + j
            square = across + (column + 0.5 - x) ** 2
            near = inside & (square < (width / 2 + 0.5) ** 2) & (column >= 0) & (column < size[1])
            there = np.flatnonzero(near)
            share = np.clip(width / 2 + 0.5 - np.sqrt(square[there]), 0.0, min(width, 1.0))
            keys = np.rint(share * SHADES).astype(np.int64) << 32 | names[there]
            np.maximum.at(best, row[there] * size[1] + column[there], keys)
    where = np.flatnonzero(best)
    return where, (best[where] >> 32) / SHADES, best[where] & 0xFFFFFFFF


def dots(points: Floats, colour: str | Floats, size: float, hidden: float) -> list[Stroke]:
    """Round dots with a white rim, so that they stand out from lines and dark surfaces."""
    twice = np.stack([points, points], axis=1)
    return [Stroke(twice, "white", size + RIM), Stroke(twice, colour, size, hidden)]


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
