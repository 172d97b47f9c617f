"""Rules on cut pieces in space: a plane rule on the base whose parts know every edge, then along the height.

The base is parted by what the heights of leaves do over it: where a leaf meets an end of the piece, where two leaves
have the same height, and where an upright leaf stands. On each part every root is a smooth function of the base. The
height of a leaf goes on beyond the ends with a constant slope of the leaf, so that it is a function on all of the base.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from rsym.arrays import Flags, Floats, Ints
from rsym.sampling.rules.bases import BOTH, PlaneBases
from rsym.sampling.rules.columns import CellRule, Columns, LeftOpen, rules_together, tensor_rules
from rsym.sampling.rules.curves import Risers, across, along, coincide, heights_between, placed, smooth_values
from rsym.sampling.rules.deadlines import require_time
from rsym.sampling.rules.division import (
    INSIDE,
    LEAST,
    OPEN,
    BoundedFunctions,
    CutPieces,
    Divided,
    Limits,
    divide,
    starts,
    together_at_once,
)
from rsym.sampling.rules.lines import beyond
from rsym.sampling.rules.walks import BETWEEN, LAST, SAME

LIMITS = Limits(4, 40, 3.0, 64)
FACE, GAP = 0, 1
STEPS, INTO = 3, 5  # of Newton to a height, and of secants into a valley
SMALL = 0.3  # of the base of a piece: a quarter


@dataclass(frozen=True)
class SpaceBases:
    """The bases of pieces in space with a height, parted: what is the same for rules of any order.

    Attributes
    ----------
    base : BaseFunctions
        What parts them.
    found : Divided
        The parts.
    planes : list of (CutPieces, PlaneBases)
        Those that a function crosses, and what a plane rule on them is made of.
    unresolved : LeftOpen
        What is not resolved over parts of the bases.
    falling : float
        So many points less along each direction over a part of half the size.
    """

    base: BaseFunctions
    found: Divided
    planes: list[tuple[CutPieces, PlaneBases]]
    unresolved: LeftOpen
    falling: float

    @classmethod
    def of(cls, functions: BoundedFunctions, pieces: CutPieces, falling: float, until: float) -> SpaceBases:
        """Of pieces; `until` a time of the monotonic clock."""
        columns = Columns.of(functions, pieces)
        base = BaseFunctions.of(columns, until)
        found = divide(base, base.cells, LIMITS)
        tall, unresolved, planes = columns.height[1] - columns.height[0], LeftOpen(), []
        for parts in together_at_once(found.cut):
            planes.append((parts, PlaneBases.of(base, parts)))
            some = ~parts.proved
            width, own = (parts.upper - parts.lower)[:, some], parts.owner[some]
            area = np.prod(width, axis=0)
            walled = width.max(axis=0, initial=0.0) * np.bincount(parts.piece, base.walls[parts.leaf], len(parts))[some]
            unresolved += LeftOpen(float(area @ tall[own]), float(BOTH * area.sum() + walled @ tall[own]))
        return cls(base, found, planes, unresolved, falling)

    def rule(self, orders: Ints) -> tuple[CellRule, LeftOpen]:
        """The rule of so many points (pieces,) along each direction, and what of it is not resolved."""
        base, columns = self.base, self.base.columns

        def lower_orders(part: CutPieces | Divided) -> Ints:
            halvings = np.log2((base.cells.upper - base.cells.lower)[0, part.owner] / (part.upper - part.lower)[0])
            least = np.minimum(orders[part.owner], LEAST)
            lower: Ints = np.maximum(np.ceil(orders[part.owner] - self.falling * np.maximum(halvings - 1, 0)), least)
            return lower.astype(np.int64)

        rules = tensor_rules(self.found.lower, self.found.upper, self.found.owner, lower_orders(self.found))
        rules += [bases.rule(lower_orders(parts))[0] for parts, bases in self.planes]
        flat = rules_together(rules)
        require_time(base.until)
        lines = columns.lines(flat.owner, flat.points)
        walls = columns.lines(flat.edge_owner, flat.edge_points, standing=True)
        kind = np.where(flat.edge_leaf < 0, LAST, BETWEEN)
        leaf = base.leaf[0, np.where(flat.edge_leaf < 0, ~flat.edge_leaf, flat.edge_leaf)]
        left, right = _sides(columns, flat, leaf, kind == LAST)
        along_walls = walls.walked_upright(kind, left, right, flat.edge_weights)
        rule, unresolved = columns.rule(lines, flat.weights, walls, along_walls, orders)
        return rule, unresolved + LeftOpen(shared=BOTH * columns.touching(lines, flat.weights))


def _sides(columns: Columns, flat: CellRule, leaf: Ints, last: Flags) -> tuple[Any, Any]:
    """The signs (n, leaves) of upright leaves on both sides of the curves of leaves, first on the positive one.

    At the `last` place of a piece the other side is beyond its end. Leaves that touch zero are looked at beside it.
    """
    functions, pieces = columns.functions, columns.pieces
    piece = flat.edge_owner
    line, pair = columns.pairs(piece)
    line, pair = line[columns.upright[pair]], pair[columns.upright[pair]]
    own, other = piece[line], pieces.leaf[pair]
    points = placed(pieces.axis[own], flat.edge_points[:, line], columns.height[0, own])
    size = np.ptp(columns.height[:, own], axis=0)
    value, gradient = smooth_values(functions, other, points, size)
    _, normal = smooth_values(functions, leaf[line], points, size)
    same = np.where((gradient * normal).sum(axis=0) >= 0, 1, -1)
    zero = (np.abs(value) <= SAME * functions.tolerance) | (other == leaf[line])
    step = (normal / np.linalg.norm(normal, axis=0) * size).T

    def at(which: Ints, places: Floats) -> Floats:
        return functions.evaluate(other[which], places.T)[0]

    sign = np.where(value > 0, 1, -1)
    signs = []
    for way, asked in ((1, zero & ~last[line]), (-1, zero)):
        found = beyond(at, points.T, way * step, asked, functions.tolerance)
        side = pieces.signs[piece]
        side[line, other] = np.where(zero, np.where(found == 0, way * same, found), sign)
        signs.append(side)
    return signs[0], signs[1]


@dataclass(frozen=True)
class BaseFunctions:
    """What parts the bases of pieces in space, as functions on them: leaves on faces, and gaps between heights.

    Attributes
    ----------
    cells : CutPieces
        The bases, and which functions are theirs.
    kind, piece : (n,)
        A face or a gap, and of which piece.
    leaf : (2, n)
        The leaf of a face, twice; the two of a gap.
    height : (n,)
        Of a face.
    steep : (2, n)
        A slope of each leaf along the height, beyond the ends of the piece.
    walls : (n,)
        Which are faces of upright leaves.
    until : float
        A time of the monotonic clock.
    """

    columns: Columns
    cells: CutPieces
    kind: Ints
    piece: Ints
    leaf: Ints
    height: Floats
    steep: Floats
    walls: Flags
    until: float
    gates: None = None
    dimension: int = 2
    faint: float = 0.0
    domain_ends: None = None
    folds: None = None

    @property
    def tolerance(self) -> float:
        """Of values and of heights."""
        return self.columns.functions.tolerance

    @classmethod
    def of(cls, columns: Columns, until: float) -> BaseFunctions:
        """Of the pieces of columns."""
        pieces, upright = columns.pieces, columns.upright
        base = [across(end, pieces.axis) for end in (pieces.lower, pieces.upper)]
        every, rises = np.arange(len(pieces.leaf)), np.flatnonzero(~upright)
        one, other = [every, rises], [every, rises]
        for apart in range(1, int(np.bincount(pieces.piece[rises]).max(initial=1))):
            same = np.flatnonzero(pieces.piece[rises[apart:]] == pieces.piece[rises[:-apart]])
            pair = np.stack([rises[same], rises[same + apart]])
            own = pieces.piece[pair[0]]
            ends = np.stack([end[:, own] for end in base])
            ones = coincide(columns.functions, pieces.leaf[pair], pieces.axis[own], columns.height[:, own], ends)
            one.append(pair[0, ~ones])
            other.append(pair[1, ~ones])
        pair = np.stack([np.concatenate(one), np.concatenate(other)])
        piece = pieces.piece[pair[0]]
        number = np.arange(len(piece))
        order = np.argsort(piece, kind="stable")
        pair, piece, number = pair[:, order], piece[order], number[order]
        top = number >= len(every)
        low, high = along(pieces.gradient, pieces.axis[pieces.piece])
        count = len(pieces)
        cells = CutPieces(
            base[0],
            base[1],
            np.arange(count),
            np.empty((count, 0), np.int8),
            starts(np.bincount(piece, minlength=count)),
            np.arange(len(piece)),
            np.empty((2, 2, 0)),
            np.full(count, -1),
            np.ones(count, bool),
        )
        return cls(
            columns,
            cells,
            np.where(number < len(every) + len(rises), FACE, GAP),
            piece,
            pieces.leaf[pair],
            np.where(top, columns.height[1, piece], columns.height[0, piece]),
            (low / 2 + high / 2)[pair],
            upright[pair[0]],
            until,
        )

    def judge(self, pieces: CutPieces, value: Floats) -> tuple[Any, Ints, Flags]:
        """Which functions may change their sign in a part; without any it is whole. To touch zero is not to change it.

        A wall may stand at the end of a part in which it is positive.
        """
        low, high = value
        kept = (low < np.where(self.walls[pieces.leaf], self.tolerance, -self.tolerance)) & (high > self.tolerance)
        some = np.bincount(pieces.piece[kept], minlength=len(pieces)) > 0
        return pieces.signs, np.where(some, OPEN, INSIDE), kept

    def evaluate(self, leaf: Ints, points: Floats) -> tuple[Floats, Floats]:
        """Values (n,) and gradients (2, n) of functions at points (2, n) of the bases of their pieces."""
        value, gradient = np.empty(len(leaf)), np.empty((2, len(leaf)))
        face, gap = (np.flatnonzero(self.kind[leaf] == kind) for kind in (FACE, GAP))
        if len(face):
            which = leaf[face]
            axis = self.columns.pieces.axis[self.piece[which]]
            places = placed(axis, points[:, face], self.height[which])
            value[face], slopes = self.columns.functions.evaluate(self.leaf[0, which], places)
            gradient[:, face] = across(slopes, axis)
        if len(gap):
            one, other = (self._heights(k, leaf[gap], points[:, gap]) for k in (0, 1))
            value[gap], gradient[:, gap] = one[0] - other[0], one[1] - other[1]
        return value, gradient

    def _heights(self, number: int, which: Ints, base: Floats) -> tuple[Floats, Floats]:
        """Heights of the leaves of gaps over places of the base, and their gradients."""
        functions, own = self.columns.functions, self.piece[which]
        axis, leaf, steep = self.columns.pieces.axis[own], self.leaf[number, which], self.steep[number, which]
        lower, upper = self.columns.height[:, own]
        curves, every = Risers(functions, leaf, axis, base), np.arange(len(which))
        below, _ = curves.evaluate(every, lower)
        above, _ = curves.evaluate(every, upper)
        height = heights_between(curves, lower, upper, below, above)
        _, slopes = functions.evaluate(leaf, placed(axis, base, height))
        beyond = (below > 0) == (above > 0)
        value = np.where(np.abs(below) <= np.abs(above), below, above)
        rise = np.where(beyond, steep, along(slopes, axis))
        return np.where(beyond, height - value / steep, height), -across(slopes, axis) / rise

    def enclose(self, leaf: Ints, lower: Floats, upper: Floats) -> tuple[Floats, Floats]:
        """Bounds (2, n) of functions over boxes (2, n) of the bases, and (2, 2, n) of their gradients."""
        require_time(self.until)
        value, gradient = np.empty((2, len(leaf))), np.empty((2, 2, len(leaf)))
        face, gap = (np.flatnonzero(self.kind[leaf] == kind) for kind in (FACE, GAP))
        if len(face):
            which = leaf[face]
            axis, height = self.columns.pieces.axis[self.piece[which]], self.height[which]
            ends = placed(axis, lower[:, face], height), placed(axis, upper[:, face], height)
            value[:, face], slopes = self.columns.functions.enclose(self.leaf[0, which], *ends)
            gradient[:, :, face] = across(slopes, axis)
        if len(gap):
            low, high = lower[:, gap], upper[:, gap]
            middle, half = low / 2 + high / 2, (high - low) / 2
            (one, absent), (other, missing) = (self._climbs(k, leaf[gap], low, high, half) for k in (0, 1))
            bounds = np.stack([one[:, 0] - other[:, 1], one[:, 1] - other[:, 0]], axis=1)
            between, slope = self.evaluate(leaf[gap], middle)
            reach = (np.abs(bounds).max(axis=1) * half).sum(axis=0)
            small = 2 * half.max(axis=0) < SMALL * self._size(leaf[gap])
            value[:, gap] = self._beside(leaf[gap], middle, half, between, slope, reach, small)
            some = np.flatnonzero((value[0, gap] < -self.tolerance) & (value[1, gap] > self.tolerance) & small)
            with np.errstate(all="ignore"):
                above, below = self._touching(leaf[gap[some]], middle[:, some], half[:, some])
                value[0, gap[some[above]]], value[1, gap[some[below]]] = 0.0, 0.0
            value[:, gap[(absent | missing) & small]] = np.inf  # what is not in the piece meets nothing there
            gradient[:, :, gap] = bounds
        return value, gradient

    def _size(self, which: Ints) -> Floats:
        """The longer side of the base of the piece of each."""
        found: Floats = (self.cells.upper - self.cells.lower)[:, self.piece[which]].max(axis=0)
        return found

    def _beside(
        self, which: Ints, middle: Floats, half: Floats, value: Floats, slope: Floats, reach: Floats, small: Flags
    ) -> Floats:
        """Bounds (2, n) of gaps over boxes: by bounds of their slopes, or an estimate for leaves that run side by side.

        Bounds of both slopes know nothing of each other, so in a small part of a piece the slopes in the middle and at
        the corners stand for them, differences taken twice: thin shells would be parted for ever.
        """
        found = np.stack([value - reach, value + reach])
        open_ones = (found[0] < self.tolerance) & (found[1] > self.tolerance) & small
        some = np.flatnonzero(open_ones & (np.abs(value) > 2 * (np.abs(slope) * half).sum(axis=0)))
        if len(some):
            corner = np.array([[-1, -1, 1, 1], [-1, 1, -1, 1]])[:, :, None] * half[:, None, some]
            places = (middle[:, None, some] + corner).reshape(2, -1)
            _, slopes = self.evaluate(np.tile(which[some], 4), places)
            turned = np.abs(slopes.reshape(2, 4, -1) - slope[:, None, some]).max(axis=1)
            least = ((np.abs(slope[:, some]) + turned) * half[:, some]).sum(axis=0)
            found[:, some] = value[some] - np.minimum(reach[some], least), value[some] + np.minimum(reach[some], least)
        return found

    def _touching(self, which: Ints, middle: Floats, half: Floats) -> tuple[Flags, Flags]:
        """Of which gaps over boxes it is seen that they are not below 0, or not above it, though they may reach it.

        Where leaves touch along a curve a gap is a valley whose bottom is at 0. The way there is along the larger
        curvature, which is a difference of slopes; it is gone from three places, beyond the ends of the piece too.
        """
        corner = np.array([[-1, -1, 1, 1], [-1, 1, -1, 1]])[:, :, None] * half[:, None]
        start = np.stack([self._heights(k, which, middle)[0] for k in (0, 1)])
        around, turned = self._followed(np.tile(which, 4), (middle[:, None] + corner).reshape(2, -1), np.tile(start, 4))
        gap, turned = (around[0] - around[1]).reshape(4, -1), (turned[:, 0] - turned[:, 1]).reshape(2, 4, -1)
        sign = np.where(gap.sum(axis=0) > 0, 1.0, -1.0)
        known = SAME * self.tolerance * np.maximum(1 / np.abs(self.steep[:, which]).min(axis=0), 1.0)
        first, second = turned[:, 2:] - turned[:, :2], turned[:, 1::2] - turned[:, ::2]
        bends = sign * np.stack([first.mean(axis=1) / (2 * half[0]), second.mean(axis=1) / (2 * half[1])], axis=1)
        mean, apart, mixed = bends[0, 0] + bends[1, 1], bends[0, 0] - bends[1, 1], bends[0, 1] + bends[1, 0]
        bend, angle = (mean + np.hypot(apart, mixed)) / 2, np.arctan2(mixed, apart) / 2
        into, reach = np.stack([np.cos(angle), np.sin(angle)]), half.max(axis=0)
        touch = (sign * gap >= -known).all(axis=0) & (np.abs(gap).max(axis=0) <= 8 * bend * reach**2)
        some = np.flatnonzero(touch)
        if len(some):
            every = np.tile(some, 3)
            down, far = into[:, every], reach[every]
            at = middle[:, every] + np.repeat([-0.5, 0.0, 0.5], len(some)) * far * np.stack([-down[1], down[0]])
            height, slopes = self._followed(which[every], at, start[:, every])
            slide, steep = sign[every] * ((slopes[:, 0] - slopes[:, 1]) * down).sum(axis=0), bend[every]
            for _ in range(INTO):
                step = np.clip(slide / steep, -2 * far, 2 * far)
                at = at - step * down
                height, slopes = self._followed(which[every], at, height)
                before, slide = slide, sign[every] * ((slopes[:, 0] - slopes[:, 1]) * down).sum(axis=0)
                steep = np.where((before - slide) / step > 0, (before - slide) / step, steep)
            depth = np.abs(height[0] - height[1]).reshape(3, -1)
            touch[some] = (depth <= known[some]).all(axis=0)
        return touch & (sign > 0), touch & (sign < 0)

    def _followed(self, which: Ints, base: Floats, height: Floats) -> tuple[Floats, Floats]:
        """The heights (2, n) of both leaves of gaps over places of the base, from some nearby, and slopes (2, 2, n)."""
        axis, leaf, base = (
            np.tile(self.columns.pieces.axis[self.piece[which]], 2),
            self.leaf[:, which].ravel(),
            np.tile(base, 2),
        )
        at = height.ravel()
        for _ in range(STEPS):
            value, gradient = self.columns.functions.evaluate(leaf, placed(axis, base, at))
            at = at - value / along(gradient, axis)
        slopes = -across(gradient, axis) / along(gradient, axis)
        return at.reshape(2, -1), slopes.reshape(2, 2, -1)

    def _climbs(self, number: int, which: Ints, lower: Floats, upper: Floats, half: Floats) -> tuple[Floats, Flags]:
        """Bounds (2, 2, n) of the gradients of the heights of the leaves of gaps over boxes, and which are not there.

        First anywhere in the piece, then at the heights that the leaf can have over the box by these bounds.
        """
        bottom, top = self.columns.height[:, self.piece[which]]
        rough = self._climbs_between(number, which, lower, upper, bottom, top)
        at, _ = self._heights(number, which, lower / 2 + upper / 2)
        reach = (np.abs(rough).max(axis=1) * half).sum(axis=0)
        absent = (at + reach < bottom - self.tolerance) | (at - reach > top + self.tolerance)
        return self._climbs_between(number, which, lower, upper, at - reach, at + reach), absent

    def _climbs_between(
        self, number: int, which: Ints, lower: Floats, upper: Floats, least: Floats, most: Floats
    ) -> Floats:
        """The same where heights are between these; beyond the ends of the piece the leaf has its constant slope."""
        own = self.piece[which]
        axis, steep = self.columns.pieces.axis[own], self.steep[number, which]
        bottom, top = self.columns.height[:, own]
        heights = np.clip(least, bottom, top), np.clip(most, bottom, top)
        _, slopes = self.columns.functions.enclose(
            self.leaf[number, which], *(placed(axis, *end) for end in zip((lower, upper), heights, strict=True))
        )
        low, high = along(slopes, axis)
        beyond = (least <= bottom) | (most >= top)
        low, high = np.where(beyond, np.minimum(low, steep), low), np.where(beyond, np.maximum(high, steep), high)
        with np.errstate(all="ignore"):
            ratios = np.stack([-across(slopes, axis) / end for end in (low, high)])
        known = (low > 0) | (high < 0)
        steepest = ratios.min(axis=(0, 2)), ratios.max(axis=(0, 2))
        return np.stack([np.where(known, steepest[0], -np.inf), np.where(known, steepest[1], np.inf)], axis=1)
