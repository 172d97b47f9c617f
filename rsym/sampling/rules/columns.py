"""Rules on cut pieces in the plane: Gauss along the base between breaks, roots along the height, Gauss between roots.

Breaks of the base are where a leaf that matters meets the ends of the piece, where two of them meet inside, and where
one stands upright. Between breaks every root is a smooth function of the base. On each line the form's sign is that of
its gates, from the signs of leaves below and above each root.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

from rsym.arrays import Flags, Floats, Ints
from rsym.sampling.rules.curves import EndCurves, Gaps, Risers, along, gap_bounds, heights_between, placed
from rsym.sampling.rules.division import BoundedFunctions, CutPieces, starts
from rsym.sampling.rules.isolation import isolate, roots
from rsym.sampling.rules.lines import Lines, Panels
from rsym.sampling.rules.segments import Segments
from rsym.sampling.rules.walks import BETWEEN, FIRST, LAST

SAME = 4.0  # tolerances; breaks and roots so close are one


@cache
def gauss(order: int) -> tuple[Floats, Floats]:
    """Points and weights on [0, 1]."""
    x, w = np.polynomial.legendre.leggauss(order)
    return (x + 1) / 2, w / 2


@dataclass(frozen=True)
class PlaneRule:
    """Points and weights inside, and on the boundary with leaf; `owner` are the cells."""

    points: Floats  # (2, n)
    weights: Floats
    owner: Ints
    edge_points: Floats  # (2, m)
    edge_weights: Floats
    edge_leaf: Ints
    edge_owner: Ints


def cut_rule(functions: BoundedFunctions, pieces: CutPieces, order: int) -> PlaneRule:
    """The rule on pieces with a height."""
    columns = _Columns.of(functions, pieces)
    segments = columns.segments()
    return columns.rule(segments, order)


def span(first: Ints, counts: Ints) -> Ints:
    """The numbers first[k], first[k] + 1, ... so many for each k, in a row."""
    begin = starts(counts)
    found: Ints = np.repeat(first - begin[:-1], counts) + np.arange(begin[-1])
    return found


@dataclass(frozen=True)
class _Columns:
    """CutPieces as columns: ends of base and height, which leaves of a piece stand upright."""

    functions: BoundedFunctions
    pieces: CutPieces
    base: Floats  # (2, n): lower and upper end
    height: Floats
    upright: Flags  # (m,), of the pairs of piece and leaf

    @classmethod
    def of(cls, functions: BoundedFunctions, pieces: CutPieces) -> _Columns:
        axis = pieces.axis
        ends = np.stack([pieces.lower, pieces.upper], axis=1)
        height = along(pieces.gradient, axis[pieces.piece])
        return cls(functions, pieces, along(ends, 1 - axis), along(ends, axis), (height == 0).all(axis=0))

    def segments(self) -> Segments:
        """The parts of the bases between breaks."""
        count = len(self.pieces)
        piece, place, stands = self._ends()
        all_pieces = np.concatenate([np.arange(count), np.arange(count), piece])
        all_places = np.concatenate([self.base[0], self.base[1], place])
        rough = self._parted(all_pieces, all_places)
        crossing = self._crossings(*rough)
        rough = self._parted(np.concatenate([all_pieces, crossing[0]]), np.concatenate([all_places, crossing[1]]))
        return Segments.of(*rough, piece[stands], place[stands])

    def _ends(self) -> tuple[Ints, Floats, Flags]:
        """Where leaves meet the ends of their piece: piece, place, and whether the leaf stands upright."""
        pieces = self.pieces
        which = np.concatenate([np.flatnonzero(~self.upright), np.arange(len(pieces.leaf))])
        top = np.arange(len(which)) < (~self.upright).sum()
        piece = pieces.piece[which]
        axis, height = pieces.axis[piece], np.where(top, self.height[1, piece], self.height[0, piece])
        curves = EndCurves(self.functions, pieces.leaf[which], axis, height)
        lower, upper = self.base[:, piece]
        every = np.arange(len(which))
        below, _ = curves.evaluate(every, lower)
        above, _ = curves.evaluate(every, upper)
        least, most = along(pieces.gradient[:, :, which], 1 - axis)
        brackets, double, middle = isolate(curves, lower, upper, below, above, least, most)
        found = np.concatenate([brackets.which, double])
        places = np.concatenate([roots(curves, brackets), middle])
        return piece[found], places, self.upright[which[found]]

    def _parted(self, piece: Ints, place: Floats) -> tuple[Ints, Floats, Floats]:
        """CutPieces cut at places: piece, lower and upper end of each part."""
        order = np.lexsort((place, piece))
        piece, place = piece[order], place[order]
        # A break next to the one before is the same; the last one of a piece is its end.
        wide = place[1:] - place[:-1] > SAME * self.functions.tolerance
        part = np.flatnonzero((piece[1:] == piece[:-1]) & wide)
        return piece[part], place[part], place[part + 1]

    def _crossings(self, piece: Ints, lower: Floats, upper: Floats) -> tuple[Ints, Floats]:
        """Where two leaves meet inside of parts."""
        pieces, functions = self.pieces, self.functions
        counts = np.diff(pieces.start)[piece]
        part = np.repeat(np.arange(len(piece)), counts)
        pair = span(pieces.start[:-1][piece], counts)
        rises = ~self.upright[pair]
        several = np.bincount(part[rises], minlength=len(piece))[part] > 1
        part, pair = part[rises & several], pair[rises & several]
        if not len(part):
            return np.empty(0, np.int64), np.empty(0)
        own = piece[part]
        middle = (lower / 2 + upper / 2)[part]
        ends = [
            functions.evaluate(pieces.leaf[pair], placed(pieces.axis[own], middle, self.height[k, own]))[0] > 0
            for k in (0, 1)
        ]
        present = ends[0] != ends[1]
        part, pair = part[present], pair[present]
        one, other = [np.empty(0, np.int64)], [np.empty(0, np.int64)]
        for apart in range(1, int(np.bincount(part).max(initial=1))):
            same = np.flatnonzero(part[apart:] == part[:-apart])
            one.append(same)
            other.append(same + apart)
        first, second = np.concatenate(one), np.concatenate(other)
        if not len(first):
            return np.empty(0, np.int64), np.empty(0)
        own = piece[part[first]]
        axis = pieces.axis[own]
        leaves = pieces.leaf[np.stack([pair[first], pair[second]])]
        curves = Gaps(functions, leaves, axis, self.height[0, own], self.height[1, own])
        least, most = gap_bounds(pieces.gradient[:, :, pair[first]], pieces.gradient[:, :, pair[second]], axis)
        left, right = lower[part[first]], upper[part[first]]
        every = np.arange(len(first))
        below, _ = curves.evaluate(every, left)
        above, _ = curves.evaluate(every, right)
        brackets, double, middles = isolate(curves, left, right, below, above, least, most)
        found = np.concatenate([brackets.which, double])
        return own[found], np.concatenate([roots(curves, brackets), middles])

    def rule(self, segments: Segments, order: int) -> PlaneRule:
        """The points on lines across segments, and on upright leaves."""
        x, w = gauss(order)
        width = segments.upper - segments.lower
        base = (segments.lower[:, None] + x * width[:, None]).ravel()
        lines = self._lines(np.repeat(segments.piece, order), base)
        panels, edges = lines.walked((w * width[:, None]).ravel(), self.pieces.signs[lines.piece])
        stands = self._lines(segments.stand_piece, segments.stand_place)
        kind = np.where(segments.before < 0, FIRST, np.where(segments.after < 0, LAST, BETWEEN))
        walls = stands.walked_upright(kind, *self._sides(segments))
        inner = self._spread(lines, panels, order)
        outer = self._spread(stands, walls, order)
        axis, own, leaf = self.pieces.axis, lines.piece[edges.line], edges.leaf
        edge_points = placed(axis[own], lines.base[edges.line], edges.lower)
        _, gradient = self.functions.evaluate(leaf, edge_points)
        with np.errstate(all="ignore"):
            longer = np.sqrt((gradient**2).sum(axis=0)) / np.abs(along(gradient, axis[own]))
        return PlaneRule(
            *inner[:3],
            np.concatenate([edge_points, outer[0]], axis=1),
            np.concatenate([edges.weight * longer, outer[1]]),
            np.concatenate([leaf, outer[3]]),
            np.concatenate([self.pieces.owner[own], outer[2]]),
        )

    def _lines(self, piece: Ints, base: Floats) -> Lines:
        """The lines of pieces above places of their bases."""
        pieces = self.pieces
        counts = np.diff(pieces.start)[piece]
        line, pair = np.repeat(np.arange(len(piece)), counts), span(pieces.start[:-1][piece], counts)
        leaf, own = pieces.leaf[pair], piece[line]
        curves = Risers(self.functions, leaf, pieces.axis[own], base[line])
        lower, upper = self.height[:, own]
        below, _ = curves.evaluate(np.arange(len(line)), lower)
        above, rising = below.copy(), np.flatnonzero(~self.upright[pair])
        above[rising] = curves.evaluate(rising, upper[rising])[0]
        root = heights_between(curves, lower, upper, below, above)
        upright = self.upright[pair]
        return Lines(
            self.functions, piece, base, self.height[:, piece], starts(counts), leaf, upright, below, above, root
        )

    def _spread(self, lines: Lines, panels: Panels, order: int) -> tuple[Floats, Floats, Ints, Ints]:
        """Points, weights, cells and leaves of a Gauss rule on intervals of lines."""
        x, w = gauss(order)
        tall = panels.upper - panels.lower
        line = np.repeat(panels.line, order)
        height = (panels.lower[:, None] + x * tall[:, None]).ravel()
        points = placed(self.pieces.axis[lines.piece[line]], lines.base[line], height)
        weights = (w * (tall * panels.weight)[:, None]).ravel()
        return points, weights, self.pieces.owner[lines.piece[line]], np.repeat(panels.leaf, order)

    def _sides(self, segments: Segments) -> tuple[Any, Any]:
        """For each place where leaves stand, the signs (n, leaves) to the left and to the right, of upright ones too.

        Beyond an end of the piece a leaf that is zero there has the other sign.
        """
        pieces, functions, tolerance = self.pieces, self.functions, SAME * self.functions.tolerance
        piece, before, after = segments.stand_piece, segments.before, segments.after
        left, right = pieces.signs[piece], pieces.signs[piece]
        counts = np.diff(pieces.start)[piece]
        line, pair = np.repeat(np.arange(len(piece)), counts), span(pieces.start[:-1][piece], counts)
        line, pair = line[self.upright[pair]], pair[self.upright[pair]]
        own = piece[line]
        axis, height, leaf = pieces.axis[own], self.height[0, own], pieces.leaf[pair]
        middle = segments.lower / 2 + segments.upper / 2

        def at(base: Floats) -> Floats:
            return functions.evaluate(leaf, placed(axis, base[line], height))[0]

        zero = np.abs(at(segments.stand_place)) <= tolerance
        one, other = (np.where(at(middle[number]) > 0, 1, -1) for number in (before, after))
        left[line, leaf] = np.where(before[line] >= 0, one, np.where(zero, -other, other))
        right[line, leaf] = np.where(after[line] >= 0, other, np.where(zero, -one, one))
        return left, right
