"""Cells divided until each is inside, outside, or such that along one axis every leaf that matters only rises or falls.

The bounds of leaves over a cell give signs; gates whose operands decide nothing there are left out. What remains
*matters*: leaves of open sign. An axis serves as the height if all of these have a slope along it that is bounded away
from zero, or none at all: then each meets a line along the axis once at most, or contains it.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any, Protocol

import numpy as np

from rsym.arrays import Flags, Floats, Ints
from rsym.sampling.compiled import loop

INSIDE, OPEN, OUTSIDE = 1, 0, -1
# A leaf may climb so steeply over the axes across; or as steeply as it likes if its slope along the height changes by
# this factor at most in the cell.
STEEP, EVEN = 3.0, 1.3
# A leaf is flat along an axis if it is so much steeper along another; next to cusps all changes are roundings.
FLAT = 1e-9
FLAT_SCORE = 0.3  # of an axis along which a leaf does not change: better than a steep one
GRADED = 28  # levels of division towards a given point
SMALL = 40.0  # binary digits: cells nearer to a point than so small a share of an integral are not divided
SLOPE = 0.25  # points of a rule less, from a cell to one of half the side, where integrals fall with its side
LEAST = 3  # points of rules on small parts
PIECES_AT_ONCE = 2048  # parts of cells of which rules are made at once
FEWEST = 2  # points along each direction of the smallest cells


class BoundedFunctions(Protocol):
    """What divides a cell: functions with bounds."""

    @property
    def dimension(self) -> int:
        """2 or 3."""

    @property
    def tolerance(self) -> float:
        """A value up to this is zero to rounding."""

    @property
    def domain_ends(self) -> Any:
        """Which functions are ends of domains: of those that have one surface another one bounds."""

    @property
    def folds(self) -> Any:
        """Which functions bound nothing, but what is integrated is not smooth where they are zero."""

    @property
    def faint(self) -> float:
        """A gradient up to this may be all of rounding."""

    @property
    def gates(self) -> Any:
        """Rows of whole numbers; None: every part is wanted, and the functions only part the cells."""

    @property
    def walls(self) -> Flags:
        """Of functions that part cells, which are the boundary's."""

    def judge(self, pieces: CutPieces, value: Floats) -> tuple[Any, Ints, Flags]:
        """From bounds of values the signs of all leaves, the verdict on each piece, and which of its leaves matter.

        The pieces have bounds of gradients: where these vanish values are as small as their squares.
        """

    def evaluate(self, leaf: Ints, points: Floats) -> tuple[Floats, Floats]:
        """Values (n,) of leaf[k] at point k of (dim, n), and gradients (dim, n)."""

    def enclose(self, leaf: Ints, lower: Floats, upper: Floats) -> tuple[Floats, Floats]:
        """Bounds (2, n) of leaf[k] over box k of (dim, n), and (dim, 2, n) of its gradient."""


@dataclass(frozen=True)
class Grading:
    """Points (k, dim) towards which cells are divided.

    exponents : (k,), the integral over a disc about a point is as large as this power of its radius: where it is small
        cells are divided less often, and have rules of fewer points. With 0 nothing is known.
    falling : so many points less along each direction for each halving of a cell after the first, where not all digits
        are asked for: what a part holds falls with it.
    enough : what is open of a cell is not divided any more where it takes so much of the area of its faces, in the
        plane of the length of its sides.

    Examples
    --------
    >>> Grading(np.zeros((3, 2)), np.array([0.0, 4 / 3, 4.0])).levels.tolist()
    [28, 28, 10]
    """

    points: Floats
    exponents: Floats
    falling: float = 0.0
    enough: float = 0.0

    def __len__(self) -> int:
        return len(self.points)

    @property
    def levels(self) -> Ints:
        """How often cells are divided towards each."""
        with np.errstate(divide="ignore"):
            return np.minimum(np.ceil(SMALL / self.exponents), GRADED).astype(np.int64)

    def orders(self, lower: Floats, upper: Floats, size: float, order: int) -> Ints:
        """The points along each direction (n,) of rules on parts (dim, n) of cells of a size.

        About a point are rings of parts, each of half the width of the one before, and a rule of q points on these is
        off by the same share of a power of q; so in a ring of a smaller share of the whole q may be smaller.
        """
        found = np.full(lower.shape[1], order, np.int64)
        if self.falling:
            halvings = np.log2(size / (upper - lower).max(axis=0, initial=0.0))
            found = np.maximum(np.ceil(order - self.falling * np.maximum(halvings - 1, 0)), min(order, LEAST))
            found = found.astype(np.int64)
        if not len(self) or not self.exponents.any():
            return found
        nearest, which = np.full(len(found), np.inf), np.zeros(len(found), np.int64)
        half = (upper - lower).max(axis=0) / 2
        for number, point in enumerate(self.points[:, :, None]):
            away = np.maximum(np.maximum(lower - point, point - upper), 0.0).max(axis=0) + half
            closer = away < nearest
            nearest[closer], which[closer] = away[closer], number
        rings = np.maximum(np.log2(size / nearest) - 1, 0.0)
        fewer = np.ceil(order - SLOPE * self.exponents[which] * rings)
        found[:] = np.minimum(found, np.maximum(fewer, min(order, FEWEST)))
        return found


@dataclass(frozen=True)
class CutPieces:
    """Parts of cells, and the leaves that matter in each.

    Attributes
    ----------
    lower, upper : (dim, n)
    owner : (n,)
        The cell that each is a part of.
    signs : (n, leaves) int8
        What is known of all leaves.
    start, leaf : (n + 1,), (m,)
        Leaves ``leaf[start[k]:start[k + 1]]`` matter in piece k.
    gradient : (dim, 2, m)
        Bounds of their gradients.
    axis : (n,)
        The height, where there is one.
    proved : (n,)
        Whether that is proved.
    """

    lower: Floats
    upper: Floats
    owner: Ints
    signs: Any
    start: Ints
    leaf: Ints
    gradient: Floats
    axis: Ints
    proved: Flags

    def __len__(self) -> int:
        return len(self.owner)

    @property
    def piece(self) -> Ints:
        """The piece in which each leaf matters."""
        return np.repeat(np.arange(len(self)), np.diff(self.start))

    def chosen(self, which: Flags, kept: Flags | None = None) -> CutPieces:
        """Some of the pieces, with some of their leaves."""
        pairs = which[self.piece] if kept is None else which[self.piece] & kept
        counts = np.bincount(self.piece[pairs], minlength=len(self))[which]
        return replace(
            self,
            lower=self.lower[:, which],
            upper=self.upper[:, which],
            owner=self.owner[which],
            signs=self.signs[which],
            start=starts(counts),
            leaf=self.leaf[pairs],
            gradient=self.gradient[:, :, pairs],
            axis=self.axis[which],
            proved=self.proved[which],
        )

    def halved(self) -> CutPieces:
        """The parts of each when all its sides are halved."""
        dimension, parts = len(self.lower), 1 << len(self.lower)
        corner = np.indices((2,) * dimension).reshape(dimension, 1, parts)
        middle = (self.lower / 2 + self.upper / 2)[:, :, None]
        lower = np.where(corner == 0, self.lower[:, :, None], middle).reshape(dimension, -1)
        upper = np.where(corner == 0, middle, self.upper[:, :, None]).reshape(dimension, -1)
        counts = np.repeat(np.diff(self.start), parts)
        pairs = span(np.repeat(self.start[:-1], parts), counts)
        return CutPieces(
            lower,
            upper,
            np.repeat(self.owner, parts),
            np.repeat(self.signs, parts, axis=0),
            starts(counts),
            self.leaf[pairs],
            np.empty((dimension, 2, 0)),
            np.repeat(self.axis, parts),
            np.repeat(self.proved, parts),
        )


def pieces_together(pieces: Sequence[CutPieces]) -> CutPieces:
    """Pieces, one after the other."""
    first, *others = pieces
    if not others:
        return first
    parts: Any = {
        name: np.concatenate([getattr(one, name) for one in pieces], axis=-1)
        for name in ("lower", "upper", "owner", "leaf", "gradient", "axis", "proved")
    }
    counts = np.concatenate([np.diff(one.start) for one in pieces])
    return CutPieces(signs=np.concatenate([one.signs for one in pieces]), start=starts(counts), **parts)


def together_at_once(found: Sequence[CutPieces]) -> Iterator[CutPieces]:
    """Pieces of several levels together, so that what is done for them is done once, but not too many."""
    some: list[CutPieces] = []
    for pieces in found:
        if some and sum(map(len, some)) + len(pieces) > PIECES_AT_ONCE:
            yield pieces_together(some)
            some = []
        if len(pieces):
            some.append(pieces)
    if some:
        yield pieces_together(some)


def starts(counts: Ints) -> Ints:
    """Where each of so many things begins, and the end."""
    return np.concatenate([[0], np.cumsum(counts)]).astype(np.int64)


def span(first: Ints, counts: Ints) -> Ints:
    """The numbers first[k], first[k] + 1, ... so many for each k, in a row."""
    begin = starts(counts)
    found: Ints = np.repeat(first - begin[:-1], counts) + np.arange(begin[-1])
    return found


def undivided(lower: Floats, upper: Floats, owner: Ints, leaves: int) -> CutPieces:
    """Whole cells, of which nothing is known."""
    count, dimension = len(owner), len(lower)
    return CutPieces(
        lower,
        upper,
        owner,
        np.zeros((count, leaves), np.int8),
        np.arange(count + 1) * leaves,
        np.tile(np.arange(leaves), count),
        np.empty((dimension, 2, 0)),
        np.full(count, -1),
        np.ones(count, bool),
    )


@dataclass(frozen=True)
class Divided:
    """What cells were divided into.

    Attributes
    ----------
    lower, upper, owner : (dim, n), (dim, n), (n,)
        Parts wholly inside.
    cut : list of CutPieces
        Those that the boundary may cross, with a height.
    whole : (m,)
        The cells that are inside, undivided.
    """

    lower: Floats
    upper: Floats
    owner: Ints
    whole: Ints
    cut: list[CutPieces]


@dataclass(frozen=True)
class Limits:
    """How far cells are divided.

    usual, deepest : so many levels where more than `most` parts of a cell are left open at one, as along a curve on
        which gradients vanish, and where fewer are.
    uneven : by this factor the slope of a leaf along the height may change in a cell. On a torus 2 takes twice the
        points of 3 and gains two digits; in the plane it takes a tenth more.
    steepest : a leaf that climbs more than so many times as fast over an axis across has lengths that are differences
        of nearly equal places: it is divided until no leaf that is nearly flat along the other axis is beside it.
    """

    usual: int
    deepest: int
    uneven: float
    most: int
    steepest: float = np.inf
    turning: float = np.inf


def divide(functions: BoundedFunctions, cells: CutPieces, limits: Limits, near: Grading | None = None) -> Divided:
    """Divide cells; those close to one of the points `near` are divided towards it."""
    levels = np.empty(0, np.int64) if near is None else near.levels
    inside = [(cells.lower[:, :0], cells.upper[:, :0], cells.owner[:0])]
    whole = np.empty(0, np.int64)
    cut: list[CutPieces] = []
    pieces = cells
    for level in range(max(limits.deepest, *levels.tolist(), 0) + 1):
        if not len(pieces):
            break
        value, gradient = functions.enclose(pieces.leaf, pieces.lower[:, pieces.piece], pieces.upper[:, pieces.piece])
        side = (pieces.upper - pieces.lower)[:, pieces.piece]
        pieces = replace(pieces, gradient=_flattened(gradient, side, functions.tolerance))
        signs, verdict, kept = functions.judge(pieces, value)
        pieces = replace(pieces, signs=signs)
        towards = np.zeros(len(pieces), bool)
        if near is not None and (level < levels).any():
            towards = close(pieces, near.points[level < levels])
        full = (verdict == INSIDE) & ~towards
        inside.append((pieces.lower[:, full], pieces.upper[:, full], pieces.owner[full]))
        if level == 0:
            whole = pieces.owner[full]
        pieces = pieces.chosen((verdict == OPEN) | ((verdict == INSIDE) & towards), kept)
        towards = towards[(verdict == OPEN) | ((verdict == INSIDE) & towards)]
        axis, proved = np.empty(len(pieces), np.int64), np.empty(len(pieces), bool)
        choose_axes(pieces.start, pieces.gradient, limits.uneven, limits.steepest, limits.turning, axis, proved)
        pieces = replace(pieces, axis=axis, proved=proved)
        going = ~proved & ~towards
        crowd = np.bincount(pieces.owner[going], minlength=1) if going.any() else np.zeros(1, np.int64)
        # Along a curve there are as many more pieces as each takes less of the area, at a point there are not.
        little = 0.0 if near is None else near.enough * 2.0 ** (level * (functions.dimension - 1))
        crowd = crowd[np.minimum(pieces.owner, len(crowd) - 1)]
        last = (level >= limits.usual) & ((crowd > limits.most) | (crowd <= little)) | (level >= limits.deepest)
        done = (proved | last) & ~towards
        cut.append(pieces.chosen(done))
        pieces = pieces.chosen(~done).halved()
    parts = [np.concatenate(p, axis=-1) for p in zip(*inside, strict=True)]
    return Divided(parts[0], parts[1], parts[2], whole, cut)


def _flattened(gradient: Floats, side: Floats, tolerance: float) -> Floats:
    """Gradients (dim, 2, n), 0 along axes on which leaves change by a rounding at most over sides (dim, n) of pieces.

    An edge turned by a rounding runs along an axis: what is left of its slope is no number to divide by.
    """
    most = np.abs(gradient).max(axis=1)
    largest = most.max(axis=0, initial=0.0)
    flat = (most * side <= tolerance * np.minimum(1.0, largest)) & (most <= FLAT * largest)
    return np.where(flat[:, None], 0.0, gradient)


def close(pieces: CutPieces, near: Floats) -> Flags:
    """Which pieces are not small against their distance from one of the points."""
    half = (pieces.upper - pieces.lower) / 2
    found = np.zeros(len(pieces), bool)
    for point in near:
        place = point[:, None]
        found |= ((place >= pieces.lower - half) & (place <= pieces.upper + half)).all(axis=0)
    return found


@loop
def choose_axes(
    start: Any, gradient: Any, uneven: float, steepest: float, turning: float, axis: Any, proved: Any
) -> None:
    """The axis that serves best as the height of each piece, and whether it does."""
    dimension = gradient.shape[0]
    for piece in range(len(axis)):
        best, chosen, good = -1.0, 0, False
        for k in range(dimension):
            score, fits = 1.0, True
            for pair in range(start[piece], start[piece + 1]):
                low, high = gradient[k, 0, pair], gradient[k, 1, pair]
                if low == 0 and high == 0:
                    score = min(score, FLAT_SCORE)
                    continue
                least, most, across, turns = max(low, -high, 0.0), max(-low, high), 0.0, False
                for j in range(dimension):
                    if j != k:
                        one, other = gradient[j, 0, pair], gradient[j, 1, pair]
                        across = max(across, max(-one, other))
                        turns = turns or not other - one <= turning * (STEEP * least + max(one, -other, 0.0))
                gentle = STEEP * least >= across and most <= uneven * least
                even = most <= EVEN * least and steepest * least >= across and not turns
                if not (least > 0 and (gentle or even)):
                    fits = False
                ratio = least / max(most, across)
                score = min(score, ratio) if ratio >= 0 else 0.0
            if (fits and not good) or (fits == good and score > best):
                best, chosen, good = score, k, fits
        axis[piece], proved[piece] = chosen, good
