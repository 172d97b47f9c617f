"""Where neighbouring pixels of a picture see different things, to a share of a pixel: smooth edges, lines of ink."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from rsym.arrays import Flags, Floats, Integers, Ints, Shorts
from rsym.output.ink import SMOOTH
from rsym.output.sights import UNDECIDED, Sight

Single: TypeAlias = NDArray[np.float32]
# A surface goes on from one pixel to the next if each lies on the other's tangent plane but for so many pixels: even
# beside an outline a ball of any size strays by less than one.
STRAY = 2.5
# What another ray says of the place of an edge between two pixels, each time by half: to a 16th of a pixel.
HALVINGS = 3

# The leaves that the rays of places (n,), columns and rows, see as `Sight.labels` says it, and their depths.
Look: TypeAlias = Callable[[Floats, Floats], tuple[Shorts, Floats]]


@dataclass(frozen=True)
class Edges:
    """Pairs of neighbouring pixels between which something ends.

    Attributes
    ----------
    first, second : (n,) int64
        The pixels by number, row by row; the second is on the right of the first, or below it.
    place : (n,) float32
        Where between their middles the edge is, from 0 to 1.
    size : (int, int)
        Height and width of the picture.
    """

    first: Ints
    second: Ints
    place: Single
    size: tuple[int, int]

    @property
    def pixels(self) -> Ints:
        """The pixels beside an edge, in order."""
        mask = np.zeros(self.size[0] * self.size[1], np.bool_)
        mask[self.first] = True
        mask[self.second] = True
        return np.flatnonzero(mask)


def edges_of(sight: Sight, size: tuple[int, int], look: Look) -> Edges:
    """Find the edges of a picture of so many pixels, height and width, whose pixels see what a sight says.

    An outline, where something covers what is farther away, is found by rays between the two pixels; a crease, where
    two leaves meet at an angle, where their tangent planes do. Pixels that are undecided have no edges.
    """
    leaf, depth = sight.labels.reshape(size), sight.depths.reshape(size)
    if not len(sight.depth):
        nothing = np.zeros(0, np.int64)
        return Edges(nothing, nothing, np.zeros(0, np.float32), size)
    steep = STRAY * np.float32(sight.view.pixel_at(sight.depth.min()))
    first, second, found = _candidates(leaf, depth, steep)
    flat, rows = leaf.reshape(-1), sight.number
    seen = (flat[first] >= 0) & (flat[second] >= 0)
    outline, crease = _kinds(sight, rows, first, second, seen, found)
    kept = outline | crease
    first, second, outline = first[kept], second[kept], outline[kept]
    place = np.full(len(first), 0.5, np.float32)
    meeting = np.flatnonzero(~outline)
    place[meeting], apart = _meetings(sight, rows[first[meeting]], rows[second[meeting]])
    outline[meeting[apart]] = True
    between = np.flatnonzero(outline)
    place[between] = _between(first[between], second[between], flat, depth.reshape(-1), size[1], look)
    return Edges(first, second, place, size)


def _candidates(leaf: Shorts, depth: Single, steep: np.float32) -> tuple[Ints, Ints, Flags]:
    """Neighbours that see different leaves, or one leaf at depths that differ by more than so much; which of both."""
    width, parts = leaf.shape[1], []
    for step, one, other in ((1, np.s_[:, :-1], np.s_[:, 1:]), (width, np.s_[:-1], np.s_[1:])):
        differ = leaf[one] != leaf[other]
        with np.errstate(invalid="ignore"):
            found = differ | (np.abs(depth[one] - depth[other]) > steep)
        found &= (leaf[one] > UNDECIDED) & (leaf[other] > UNDECIDED)
        row, column = np.nonzero(found)
        parts.append((row * width + column, row * width + column + step, differ[row, column]))
    first, second, differ = (np.concatenate(part) for part in zip(*parts, strict=True))
    return first, second, differ


def _kinds(
    sight: Sight, rows: NDArray[np.int32], first: Ints, second: Ints, seen: Flags, differ: Flags
) -> tuple[Flags, Flags]:
    """Which pairs have an outline between them, and which a crease."""
    outline, crease = ~seen, np.zeros(len(first), np.bool_)
    both = np.flatnonzero(seen)
    one, other = rows[first[both]], rows[second[both]]
    way = sight.points_at(other) - sight.points_at(one)
    strays = [np.abs(np.einsum("ij,ij->i", sight.normals[end], way)) for end in (one, other)]
    pixel = sight.view.pixel_at(np.minimum(sight.depth[one], sight.depth[other]))
    outline[both] = np.maximum(*strays) > STRAY * pixel
    turned = np.einsum("ij,ij->i", sight.normals[one], sight.normals[other]) < np.cos(np.radians(SMOOTH))
    crease[both] = turned & differ[both] & ~outline[both]
    return outline, crease


def _meetings(sight: Sight, one: Integers, other: Integers) -> tuple[Single, Flags]:
    """Where between pixels their tangent planes meet; and which of them do not meet there."""
    before = _plane_depth(sight, other, one) - sight.depth[one]
    behind = sight.depth[other] - _plane_depth(sight, one, other)
    with np.errstate(all="ignore"):
        place = before / (before - behind)
    apart = ~((place >= 0) & (place <= 1))
    return np.where(apart, 0.5, place).astype(np.float32), apart


def _plane_depth(sight: Sight, plane: Integers, at: Integers) -> Floats:
    """How far the rays of places go to the tangent planes of others."""
    origins, ways = sight.view.rays(sight.column[at], sight.row[at])
    normals = sight.normals[plane]
    with np.errstate(all="ignore"):
        depths: Floats = np.einsum("ij,ij->i", normals, sight.points_at(plane) - origins)
        depths /= np.einsum("ij,ij->i", normals, ways)
    return depths


def _between(first: Ints, second: Ints, leaf: Shorts, depth: Single, width: int, look: Look) -> Single:
    """Where between pixels rays cease to see what the first sees and see what the second does."""
    low, high = np.zeros(len(first)), np.ones(len(first))
    row, column = np.divmod(first, width)
    right = second == first + 1
    for _ in range(HALVINGS if len(first) else 0):
        middle = (low + high) / 2
        seen, far = look(column + np.where(right, middle, 0.0), row + np.where(right, 0.0, middle))
        with np.errstate(invalid="ignore"):
            nearer = np.abs(far - depth[first]) <= np.abs(far - depth[second])
        like = np.where((seen == leaf[first]) == (seen == leaf[second]), nearer, seen == leaf[first])
        low, high = np.where(like, middle, low), np.where(like, high, middle)
    return ((low + high) / 2).astype(np.float32)


def smoothed(edges: Edges, light: Single) -> tuple[Ints, Single]:
    """The pixels that edges cross off their middle, and what they show: each the share of either side.

    `light` is (h*w, 4), light times coverage and coverage. An edge is taken for straight and across the two pixels
    beside it, which is exact along rows and columns (Persson 2011, geometric antialiasing).
    """
    crossed = np.where(edges.place < 0.5, edges.first, edges.second)
    other = np.where(edges.place < 0.5, edges.second, edges.first)
    share = np.abs(0.5 - edges.place)
    order = np.lexsort((share, crossed))
    last = np.append(np.diff(crossed[order]) > 0, np.ones(min(len(order), 1), np.bool_))
    most = order[last]
    crossed, other, weight = crossed[most], other[most], share[most][:, None]
    return crossed, (1 - weight) * light[crossed] + weight * light[other]


def inked(edges: Edges, width: float) -> tuple[Ints, Single]:
    """The pixels that lines of so many pixels' width along the edges cover, and the share of each."""
    pieces = _pieces(edges)
    height, columns = edges.size
    reach = width / 2 + 0.5
    cell = np.floor(pieces.min(axis=1)).astype(np.int64)
    way = pieces[:, 1] - pieces[:, 0]
    square = np.maximum(np.einsum("ij,ij->i", way, way), np.float32(1e-12))
    nearest = np.full(height * columns, np.inf, np.float32)
    span = int(np.ceil(reach))
    for i in range(1 - span, span + 1):
        row = cell[:, 0] + i
        down = row.astype(np.float32) - pieces[:, 0, 0]
        for j in range(1 - span, span + 1):
            column = cell[:, 1] + j
            right = column.astype(np.float32) - pieces[:, 0, 1]
            along = np.clip((down * way[:, 0] + right * way[:, 1]) / square, 0.0, 1.0)
            distance = (down - along * way[:, 0]) ** 2 + (right - along * way[:, 1]) ** 2
            near = (distance < reach**2) & (row >= 0) & (row < height) & (column >= 0) & (column < columns)
            there = np.flatnonzero(near)
            np.minimum.at(nearest, row[there] * columns + column[there], distance[there])
    where = np.flatnonzero(nearest < np.inf)
    share = np.clip(reach - np.sqrt(nearest[where]), 0.0, min(width, 1.0))
    return where, share.astype(np.float32)


def _pieces(edges: Edges) -> Single:
    """Straight pieces (n, 2, 2) of the edges, row and column of both ends, each between four pixels.

    Between the middles of four pixels two crossings are joined; one, three or four by way of their mean.
    """
    width = edges.size[1]
    row, column = np.divmod(edges.first, width)
    right = edges.second == edges.first + 1
    crossing = np.stack([row + np.where(right, 0, edges.place), column + np.where(right, edges.place, 0)], axis=1)
    crossing = crossing.astype(np.float32)
    # A crossing to the right lies on the cells above and below it, one downwards on those left and right of it.
    cells = (width + 1) * (row + 1) + column + 1
    cell = np.concatenate([cells, cells - np.where(right, width + 1, 1)])
    name, ends = np.tile(np.arange(len(cells)), 2), np.tile(crossing, (2, 1))
    order = np.lexsort((name, cell))
    cell, ends = cell[order], ends[order]
    start = np.flatnonzero(np.append(np.ones(min(len(cell), 1), np.bool_), np.diff(cell) > 0))
    count = np.diff(np.append(start, len(cell)))
    two = start[count == 2]
    middle = np.add.reduceat(ends, start) / count[:, None].astype(np.float32) if len(start) else ends
    others = np.repeat(count != 2, count)
    stars = np.stack([ends[others], np.repeat(middle, count, axis=0)[others]], axis=1)
    return np.concatenate([np.stack([ends[two], ends[two + 1]], axis=1), stars])
