"""Triangles to pixels: a z-buffer that finds, for every pixel, the nearest triangle.

Corners are snapped to a fine integer grid. Edge functions are then exact, so
two triangles that share an edge leave neither a hole nor a doubtful pixel
between them, whatever their size. Every triangle becomes rows of pixels and
every row one span, so only pixels that are really covered cost time.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rsym.arrays import Floats, Ints

SUBPIXELS = 256
# Beyond this many pixels a corner is moved back: products of two coordinates must fit 63 bits.
FARTHEST = 2.0**21
# Rows, or pixels, worked on at once: bounds the memory to some 100 MB for any number of triangles.
BUDGET = 1 << 20
EMPTY = np.iinfo(np.int64).max


@dataclass(frozen=True)
class ScreenTriangles:
    """Edge functions a*x + b*y + c of snapped triangles, positive inside, and the depths of their corners.

    Edge k runs from corner k to corner k + 1. `area` is twice the area, `facing`
    the sign of the area before the edges were turned to be positive inside:
    +1 counter-clockwise (y upwards), -1 clockwise, 0 degenerate or not finite.
    """

    a: Ints
    b: Ints
    c: Ints
    area: Ints
    facing: Ints
    bottom: Ints
    top: Ints
    depth: Floats

    def __getitem__(self, names: Ints) -> ScreenTriangles:
        return ScreenTriangles(**{field.name: picked(getattr(self, field.name), names) for field in fields(self)})

    def values(self, faces: Ints, rows: Ints, columns: Ints) -> Ints:
        """Return the (n, 3) edge functions of `faces` at the middles of pixels."""
        x, y = columns * SUBPIXELS + SUBPIXELS // 2, rows * SUBPIXELS + SUBPIXELS // 2
        edges = zip(self.a.T, self.b.T, self.c.T, strict=True)
        return np.stack([a[faces] * x + b[faces] * y + c[faces] for a, b, c in edges]).T

    def weights(self, faces: Ints, rows: Ints, columns: Ints) -> Floats:
        """Return the (n, 3) barycentric coordinates of the middles of pixels."""
        first, second, third = self.values(faces, rows, columns).T
        return (np.stack([second, third, first]) / self.area[faces]).T

    def depths(self, faces: Ints, x: Floats, y: Floats) -> Floats:
        """Return the depths, at places in pixels, of the planes of `faces`."""
        total = np.zeros(len(faces))
        for k, corner in enumerate((2, 0, 1)):
            value = self.a[:, k][faces] * (x * SUBPIXELS) + self.b[:, k][faces] * (y * SUBPIXELS) + self.c[:, k][faces]
            total += value * self.depth[:, corner][faces]
        depths: Floats = total / self.area[faces]
        return depths

    def distances(self, faces: Ints, rows: Ints, columns: Ints) -> Floats:
        """Return the (n,) distances, in pixels, from the middles of pixels to the nearest edge line."""
        lengths = np.hypot(picked(self.a, faces), picked(self.b, faces)) * SUBPIXELS
        nearest: Floats = (self.values(faces, rows, columns) / np.maximum(lengths, 1)).min(axis=1)
        return nearest


def picked(table: NDArray[Any], names: Ints) -> NDArray[Any]:
    """Rows of a table, or entries of a list, by number; in memory column stands after column.

    What follows then runs along thousands of rows, not along three columns.

    Examples
    --------
    >>> picked(np.array([[1, 2], [3, 4], [5, 6]]), np.array([2, 0])).tolist()
    [[5, 6], [1, 2]]
    """
    return table[names] if table.ndim == 1 else np.stack([column[names] for column in table.T]).T


def snap(corners: NDArray[np.floating]) -> ScreenTriangles:
    """Prepare triangles for drawing.

    Parameters
    ----------
    corners : (m, 3, 3) array
        x and y in pixels (the middle of the first pixel is 0.5, 0.5) and depth, of each corner of each triangle.
    """
    finite = np.isfinite(corners).all(axis=(1, 2))
    clean = np.where(finite[:, None, None], corners, 0.0)
    places = clean.transpose(2, 1, 0).copy()  # coordinate after coordinate, corner after corner
    x, y = np.rint(np.clip(places[:2], -FARTHEST, FARTHEST) * SUBPIXELS).astype(np.int64).transpose(0, 2, 1)
    a, b = y - np.roll(y, -1, axis=1), np.roll(x, -1, axis=1) - x
    area = b[:, 0] * a[:, 2] - a[:, 0] * b[:, 2]
    facing = np.sign(area)
    a, b = a * facing[:, None], b * facing[:, None]
    half = SUBPIXELS // 2
    bottom, top = -((half - y.min(axis=1)) // SUBPIXELS), (y.max(axis=1) - half) // SUBPIXELS
    return ScreenTriangles(a, b, -(a * x + b * y), np.abs(area), facing, bottom, top, places[2].T)


def rasterise(triangles: ScreenTriangles, size: tuple[int, int], *, budget: int = BUDGET) -> Ints:
    """Return the (h, w) index of the nearest triangle of each pixel, -1 where there is none.

    A pixel belongs to a triangle that holds its middle, edges included. The
    smallest depth is nearest; of equal depths the lowest index wins, so the
    answer depends neither on chunks nor on threads.

    Examples
    --------
    >>> corner = [[0.0, 0.0, 1.0], [4.0, 0.0, 1.0], [0.0, 3.0, 1.0]]
    >>> rasterise(snap(np.array([corner])), (3, 4))
    array([[ 0,  0,  0, -1],
           [ 0,  0, -1, -1],
           [ 0, -1, -1, -1]])
    """
    height, width = size
    nearest = np.full(height * width, EMPTY)
    bits = len(triangles.area).bit_length()
    planes = _depth_planes(triangles, bits)
    first = np.maximum(triangles.bottom, 0)
    counts = np.where(triangles.facing != 0, np.minimum(triangles.top, height - 1) - first + 1, 0).clip(0)
    for part in _chunks(counts, budget):
        faces, rows = _unroll(np.arange(part.start, part.stop), first[part], counts[part])
        left, right = _spans(triangles, faces, rows, width)
        lengths = (right - left + 1).clip(0)
        for piece in _chunks(lengths, budget):
            keys, pixels = _fragments(planes, faces[piece], rows[piece], left[piece], lengths[piece], width, bits)
            np.minimum.at(nearest, pixels, keys)
    return np.where(nearest == EMPTY, -1, nearest & ((1 << bits) - 1)).reshape(size)


def _chunks(counts: Ints, budget: int) -> Iterator[slice]:
    """Cut a list of counts into slices whose sums stay near the budget (a single count may exceed it)."""
    total = np.cumsum(counts)
    start = 0
    while start < len(counts):
        done = total[start - 1] if start else 0
        stop = max(int(np.searchsorted(total, done + budget, side="right")), start + 1)
        yield slice(start, stop)
        start = stop


def _unroll(names: Ints, first: Ints, counts: Ints) -> tuple[Ints, Ints]:
    """Repeat each name count times beside the numbers first, first + 1, ..."""
    ends = np.cumsum(counts)
    numbers = np.arange(ends[-1]) + np.repeat(first - ends + counts, counts)
    return np.repeat(names, counts), numbers


def _spans(triangles: ScreenTriangles, faces: Ints, rows: Ints, width: int) -> tuple[Ints, Ints]:
    """Return the first and last covered column of each row of each triangle (last < first: none).

    A level edge sets no bound: the rows between bottom and top lie on its inner side.
    """
    left, right = np.zeros(len(faces), np.int64), np.full(len(faces), width - 1)
    for k in range(3):
        a = triangles.a[faces, k]
        rest = triangles.b[faces, k] * (rows * SUBPIXELS + SUBPIXELS // 2) + triangles.c[faces, k]
        rest += a * (SUBPIXELS // 2)
        bound = rest // np.maximum(np.abs(a) * SUBPIXELS, 1)
        np.maximum(left, -bound, out=left, where=a > 0)
        np.minimum(right, bound, out=right, where=a < 0)
    return left, right


def _depth_planes(triangles: ScreenTriangles, bits: int) -> Floats:
    """Return (m, 5): depth = p0 + p1*column + p2*row, and its least and greatest value, scaled to whole levels."""
    used = triangles.depth[triangles.facing != 0]
    low, high = (used.min(), used.max()) if len(used) else (0.0, 0.0)
    depth = (triangles.depth - low) / ((high - low) or 1.0) * 2.0 ** (62 - bits)
    opposite = depth[:, [2, 0, 1]] / np.maximum(triangles.area, 1)[:, None]
    slopes = [np.einsum("ij,ij->i", edge.astype(float), opposite) for edge in (triangles.c, triangles.a, triangles.b)]
    middle = slopes[0] + (slopes[1] + slopes[2]) * (SUBPIXELS // 2)
    return np.stack(
        [middle, slopes[1] * SUBPIXELS, slopes[2] * SUBPIXELS, depth.min(axis=1), depth.max(axis=1)], axis=1
    )


def _fragments(
    planes: Floats, faces: Ints, rows: Ints, left: Ints, lengths: Ints, width: int, bits: int
) -> tuple[Ints, Ints]:
    """Return key and pixel of each covered pixel; a key is the depth's level with the face's index below it."""
    start, slope, climb, least, greatest = planes[faces].T
    spans, columns = _unroll(np.arange(len(faces)), left, lengths)
    depth = (start + climb * rows)[spans] + slope[spans] * columns
    # A sliver's slope is huge and its plane ill-conditioned; its corners bound the depth all the same.
    depth = np.clip(depth, least[spans], greatest[spans])
    keys = (depth.astype(np.int64) << bits) | faces[spans]
    return keys, (rows * width)[spans] + columns
