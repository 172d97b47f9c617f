"""Rules on cut pieces in the plane: Gauss along the base between breaks, then along the height.

Breaks of the base are where a leaf that matters meets the ends of the piece, where two of them meet inside, and where
one stands upright. Between breaks every root is a smooth function of the base.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from rsym.arrays import Flags, Floats, Ints
from rsym.sampling.rules.columns import CellRule, Columns, LeftOpen, gauss_on, neighbouring
from rsym.sampling.rules.curves import EndCurves, Gaps, along, coincide, gap_bounds, meetings, placed
from rsym.sampling.rules.division import BoundedFunctions, CutPieces
from rsym.sampling.rules.isolation import isolate, roots
from rsym.sampling.rules.lines import Lines, beyond, signs_at
from rsym.sampling.rules.segments import Segments
from rsym.sampling.rules.walks import BETWEEN, FIRST, LAST, SAME

NARROW = 16.0  # roots of tolerances: where two leaves touch, closer than rounding, a segment is no wider
ROOT = math.sqrt(8 * np.finfo(np.float64).eps)  # of a tolerance, which is a length, over that of the bounds
ROUNDED = 0.125  # of tolerances: a place is that unsharp
BOTH = 5.0  # of the base: two leaves that climb no steeper than 2


@dataclass(frozen=True)
class PlaneBases:
    """The bases of plane pieces with a height, between breaks: what is the same for rules of any order.

    Attributes
    ----------
    columns : Columns
    base : (2, n)
        The ends of the bases.
    segments : Segments
        Their parts between breaks.
    unresolved : LeftOpen
        A bound of the length of boundary between breaks that are one.
    """

    columns: Columns
    base: Floats
    segments: Segments
    unresolved: LeftOpen

    @classmethod
    def of(cls, functions: BoundedFunctions, pieces: CutPieces) -> PlaneBases:
        """Of pieces."""
        ends = along(np.stack([pieces.lower, pieces.upper], axis=1), 1 - pieces.axis)
        breaks = _Breaks(Columns.of(functions, pieces), ends)
        segments, lost = breaks.segments()
        return cls(breaks.columns, ends, segments, LeftOpen(boundary=lost))

    def rule(self, orders: Ints) -> tuple[CellRule, LeftOpen]:
        """The rule of so many points (pieces,) along each direction, and what of it is not resolved."""
        segments = self.segments
        which, x, w = gauss_on(orders[segments.piece])
        width = segments.upper - segments.lower
        lines = self.columns.lines(segments.piece[which], segments.lower[which] + x * width[which])
        walls = self.columns.lines(segments.stand_piece, segments.stand_place, standing=True)
        kind = np.where(segments.before < 0, FIRST, np.where(segments.after < 0, LAST, BETWEEN))
        weight = np.ones(len(kind))
        if self.columns.functions.gates is None:
            standing, leaf = self._walls(walls, kind)
            walls = walls.chosen(standing)
            parts, _ = walls.walked(weight[standing], None)
            along_walls = replace(parts, leaf=leaf[parts.line])
        else:
            along_walls = walls.walked_upright(kind, *self._sides(), weight)
        rule, unresolved = self.columns.rule(lines, w * width[which], walls, along_walls, orders)
        touching = self._touching(lines, width, which)
        return rule, unresolved + LeftOpen(touching**2, touching)

    def _touching(self, lines: Lines, width: Floats, which: Ints) -> float:
        """A bound of the lengths of both leaves over segments in which crossings are taken for one."""
        tolerance = self.columns.functions.tolerance
        line, pair, _ = neighbouring(lines, SAME * tolerance)
        # Wider segments may be of leaves that have one surface, as they may be of such that touch so closely.
        wide = np.flatnonzero(width[which[line]] > NARROW * np.sqrt(tolerance))
        if len(wide):
            same = self.columns.one_surface(lines.piece[line[wide]], lines.leaf[pair[:, wide]], self.base)
            line = np.delete(line, wide[same])
        share = np.bincount(which[np.unique(line)], minlength=len(width)) / np.maximum(np.bincount(which), 1)
        return float(BOTH * width @ np.minimum(2 * share, 1))

    def _walls(self, lines: Lines, kind: Ints) -> tuple[Ints, Ints]:
        """Lines on which a wall stands, and a leaf that is it; at an end of the piece it is positive within."""
        functions, pieces, segments = self.columns.functions, self.columns.pieces, self.segments
        line, pair = self.columns.pairs(segments.stand_piece)
        some = lines.upright & functions.walls[lines.leaf] & (np.abs(lines.below) <= SAME * functions.tolerance)
        line, pair = line[some], pair[some]
        inner = np.where(kind == FIRST, segments.after, segments.before)[line]
        middle = (segments.lower / 2 + segments.upper / 2)[inner]
        own, leaf = segments.stand_piece[line], pieces.leaf[pair]
        value, _ = functions.evaluate(leaf, placed(pieces.axis[own], middle, self.columns.height[0, own]))
        fits = (kind[line] == BETWEEN) | (value > 0)
        which, first = np.unique(line[fits], return_index=True)
        leaf = leaf[fits][first]
        return which, np.where(kind[which] == BETWEEN, leaf, ~leaf)

    def _sides(self) -> tuple[Any, Any]:
        """For each place where leaves stand, the signs (n, leaves) to the left and to the right, of upright ones too.

        Beyond an end of the piece a leaf that is zero there has the other sign as a rule, as `beyond` sees it.
        """
        pieces, functions, segments = self.columns.pieces, self.columns.functions, self.segments
        tolerance = SAME * functions.tolerance
        piece, before, after = segments.stand_piece, segments.before, segments.after
        left, right = pieces.signs[piece], pieces.signs[piece]
        line, pair = self.columns.pairs(piece)
        line, pair = line[self.columns.upright[pair]], pair[self.columns.upright[pair]]
        own = piece[line]
        axis, height, leaf = pieces.axis[own], self.columns.height[0, own], pieces.leaf[pair]
        middle = segments.lower / 2 + segments.upper / 2

        def at(which: Ints, base: Floats) -> Floats:
            return functions.evaluate(leaf[which], placed(axis[which], base, height[which]))[0]

        every, place = np.arange(len(leaf)), segments.stand_place[line]
        zero = np.abs(at(every, place)) <= tolerance
        width = segments.upper - segments.lower
        one, other = (
            signs_at(at, middle[number[line]], width[number[line]], functions.tolerance) for number in (before, after)
        )
        first, last = before[line] < 0, after[line] < 0
        wide = width[np.maximum(before, after)[line]]
        past = beyond(at, place, np.where(first, -wide, wide), zero & (first | last), functions.tolerance)
        inner = np.where(first, other, one)
        outer = np.where(past != 0, past, np.where(zero, -inner, inner))
        left[line, leaf], right[line, leaf] = np.where(first, outer, one), np.where(last, outer, other)
        return left, right


@dataclass(frozen=True)
class _Breaks:
    """Columns in the plane, and the ends (2, n) of their bases, which are parted."""

    columns: Columns
    base: Floats

    def segments(self) -> tuple[Segments, float]:
        """The parts of the bases between breaks, and a bound of the length of boundary between breaks that are one."""
        count = len(self.columns.pieces)
        piece, place, stands = self._ends()
        all_pieces = np.concatenate([np.arange(count), np.arange(count), piece])
        all_places = np.concatenate([self.base[0], self.base[1], place])
        rough, _ = self._parted(all_pieces, all_places)
        *crossing, unsharp = self._crossings(*rough)
        rough, lost = self._parted(np.concatenate([all_pieces, crossing[0]]), np.concatenate([all_places, crossing[1]]))
        return Segments.of(*rough, piece[stands], place[stands]), lost + unsharp

    def _ends(self) -> tuple[Ints, Floats, Flags]:
        """Where leaves meet the ends of their piece: piece, place, and whether the leaf stands upright."""
        pieces = self.columns.pieces
        which = np.concatenate([np.flatnonzero(~self.columns.upright), np.arange(len(pieces.leaf))])
        top = np.arange(len(which)) < (~self.columns.upright).sum()
        piece = pieces.piece[which]
        axis, height = pieces.axis[piece], np.where(top, self.columns.height[1, piece], self.columns.height[0, piece])
        curves = EndCurves(self.columns.functions, pieces.leaf[which], axis, height)
        lower, upper = self.base[:, piece]
        every = np.arange(len(which))
        below, _ = curves.evaluate(every, lower)
        above, _ = curves.evaluate(every, upper)
        least, most = along(pieces.gradient[:, :, which], 1 - axis)
        brackets, double, middle = isolate(curves, lower, upper, below, above, least, most)
        found = np.concatenate([brackets.which, double])
        places = self._touched(curves, found, np.concatenate([roots(curves, brackets), middle]), lower, upper)
        return piece[found], places, self.columns.upright[which[found]]

    def _touched(self, curves: EndCurves, found: Ints, places: Floats, lower: Floats, upper: Floats) -> Floats:
        """Places where functions are zero; where one touches an end of its piece, that very place.

        Rounding makes two of it, or one beside an end of the base, and others in the piece on the other side: between
        them it would decide which of both pieces has the boundary.
        """
        tolerance, places = curves.tolerance, places.copy()
        axis = curves.axis[found]
        _, gradient = curves.functions.evaluate(curves.leaf[found], placed(axis, places, curves.height[found]))
        some = np.flatnonzero(np.abs(along(gradient, 1 - axis)) <= NARROW * ROOT * np.abs(along(gradient, axis)))
        near = NARROW * tolerance / ROOT
        some = some[np.lexsort((places[some], found[some]))]
        apart = (np.diff(found[some]) != 0) | (np.diff(places[some]) > near)
        heap = np.concatenate([[0], np.cumsum(apart)])[: len(some)]
        middle = np.bincount(heap, places[some]) / np.bincount(heap) if len(some) else places[some]
        for one in (middle[heap], lower[found[some]], upper[found[some]]):
            value, _ = curves.evaluate(found[some], one)
            touched = (np.abs(value) <= tolerance) & (np.abs(one - places[some]) <= near)
            places[some[touched]] = one[touched]
        return places

    def _parted(self, piece: Ints, place: Floats) -> tuple[tuple[Ints, Floats, Floats], float]:
        """CutPieces cut at places: piece, lower and upper end of each part; the length that leaves have between."""
        order = np.lexsort((place, piece))
        piece, place = piece[order], place[order]
        # A break next to the one before is the same; the last one of a piece is its end.
        wide = place[1:] - place[:-1] > SAME * self.columns.functions.tolerance
        same = piece[1:] == piece[:-1]
        part, left = np.flatnonzero(same & wide), np.flatnonzero(same & ~wide & (place[1:] > place[:-1]))
        return (piece[part], place[part], place[part + 1]), self._length(piece[left], (place[1:] - place[:-1])[left])

    def _length(self, piece: Ints, width: Floats) -> float:
        """The most that leaves may climb over so much of the bases of pieces: much next to a cusp."""
        pieces, tall = self.columns.pieces, self.columns.height[1] - self.columns.height[0]
        line, pair = self.columns.pairs(piece)
        rises = ~self.columns.upright[pair]
        line, pair = line[rises], pair[rises]
        gradient, axis = pieces.gradient[:, :, pair], pieces.axis[piece[line]]
        low, high = along(gradient, axis)
        flattest, across = np.maximum(low, -high), np.abs(along(gradient, 1 - axis)).max(axis=0)
        with np.errstate(all="ignore"):
            climbs = np.where(flattest > 0, across / flattest * width[line], np.inf)
        # Twice: next to a cusp there are two branches.
        return float(2 * np.minimum(climbs, tall[piece[line]]).sum())

    def _crossings(self, piece: Ints, lower: Floats, upper: Floats) -> tuple[Ints, Floats, float]:
        """Where two leaves meet inside of parts: piece and place, and how much length rounding may take or give there.

        The flatter two leaves cross the less it is known where.
        """
        pieces, functions = self.columns.pieces, self.columns.functions
        part, pair = self.columns.pairs(piece)
        rises = ~self.columns.upright[pair]
        several = np.bincount(part[rises], minlength=len(piece))[part] > 1
        part, pair = part[rises & several], pair[rises & several]
        if not len(part):
            return np.empty(0, np.int64), np.empty(0), 0.0
        own = piece[part]
        middle = (lower / 2 + upper / 2)[part]
        ends = [
            functions.evaluate(pieces.leaf[pair], placed(pieces.axis[own], middle, self.columns.height[k, own]))[0] > 0
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
        own = piece[part[first]]
        leaves = pieces.leaf[np.stack([pair[first], pair[second]])]
        ends_of_bases = np.stack([lower, upper])[:, part[first]]
        two = ~coincide(functions, leaves, pieces.axis[own], self.columns.height[:, own], ends_of_bases)
        first, second, own, leaves = first[two], second[two], own[two], leaves[:, two]
        if not len(first):
            return np.empty(0, np.int64), np.empty(0), 0.0
        axis = pieces.axis[own]
        curves = Gaps(functions, leaves, axis, self.columns.height[0, own], self.columns.height[1, own])
        least, most = gap_bounds(pieces.gradient[:, :, pair[first]], pieces.gradient[:, :, pair[second]], axis)
        left, right = lower[part[first]], upper[part[first]]
        every = np.arange(len(first))
        below, _ = curves.evaluate(every, left)
        above, _ = curves.evaluate(every, right)
        brackets, double, middles = isolate(curves, left, right, below, above, least, most)
        found = np.concatenate([brackets.which, double])
        places = np.concatenate([meetings(curves, brackets), middles])
        unsharp = 0.0
        if functions.gates is not None:
            gap, slopes = curves.evaluate(found, places)
            slopes = slopes[np.abs(gap) <= SAME * functions.tolerance]  # of what only came close nothing is lost
            with np.errstate(divide="ignore"):
                unsharp += float(
                    np.fmin(ROUNDED * functions.tolerance / np.abs(slopes), np.sqrt(functions.tolerance)).sum()
                )
        return own[found], places, unsharp
