"""Cut pieces as columns over their bases: the lines along the height, and Gauss rules between roots on them.

On each line the form's sign is that of its gates, from the signs of leaves below and above each root.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache, partial
from typing import Any

import numpy as np

from rsym.arrays import Flags, Floats, Ints
from rsym.sampling.rules.curves import Risers, across, along, coincide, heights_between, placed
from rsym.sampling.rules.division import BoundedFunctions, CutPieces, span, starts
from rsym.sampling.rules.lines import Lines, Panels, beyond
from rsym.sampling.rules.walks import SAME


@cache
def gauss(order: int) -> tuple[Floats, Floats]:
    """Points and weights on [0, 1]."""
    x, w = np.polynomial.legendre.leggauss(order)
    return (x + 1) / 2, w / 2


def gauss_on(orders: Ints) -> tuple[Ints, Floats, Floats]:
    """Of the points of Gauss rules of such orders which rule each is of, its place and weight on [0, 1].

    Examples
    --------
    >>> which, x, w = gauss_on(np.array([2, 1]))
    >>> which.tolist(), x.round(3).tolist(), w.tolist()
    ([0, 0, 1], [0.211, 0.789, 0.5], [0.5, 0.5, 1.0])
    """
    known, number = np.unique(orders, return_inverse=True)
    tables = np.concatenate([np.empty((2, 0)), *(gauss(int(order)) for order in known)], axis=1)
    x, w = tables[:, span(starts(known)[number], orders)]
    return np.repeat(np.arange(len(orders)), orders), x, w


@dataclass(frozen=True)
class CellRule:
    """Points (dim, n) and weights inside, and on the boundary with leaf; `owner` are the cells."""

    points: Floats
    weights: Floats
    owner: Ints
    edge_points: Floats
    edge_weights: Floats
    edge_leaf: Ints
    edge_owner: Ints


@dataclass(frozen=True)
class LeftOpen:
    """How much of the measures of inside and of boundary a rule may be wrong by, where nothing is proved.

    shared : of the boundary, where leaves touch closer than rounding: it may be of either.
    """

    content: float = 0.0
    boundary: float = 0.0
    shared: float = 0.0

    def __add__(self, other: LeftOpen) -> LeftOpen:
        return LeftOpen(self.content + other.content, self.boundary + other.boundary, self.shared + other.shared)


def rules_joined(rules: Sequence[CellRule]) -> CellRule:
    """Rules as one, one after the other."""
    if len(rules) == 1:
        return rules[0]
    names = CellRule.__dataclass_fields__
    parts: Any = [np.concatenate([getattr(rule, name) for rule in rules], axis=-1) for name in names]
    return CellRule(*parts)


def rules_together(rules: Sequence[CellRule]) -> CellRule:
    """Rules as one, by cell."""
    joined = rules_joined(rules)
    inner, edge = np.argsort(joined.owner, kind="stable"), np.argsort(joined.edge_owner, kind="stable")
    return CellRule(
        joined.points[:, inner],
        joined.weights[inner],
        joined.owner[inner],
        joined.edge_points[:, edge],
        joined.edge_weights[edge],
        joined.edge_leaf[edge],
        joined.edge_owner[edge],
    )


def tensor_rules(lower: Floats, upper: Floats, owner: Ints, orders: Ints) -> list[CellRule]:
    """The plain Gauss rules on boxes (dim, n), of so many points along each direction."""
    found = []
    for order in np.unique(orders).tolist() or [1]:
        own = orders == order
        found.append(tensor_rule(lower[:, own], upper[:, own], owner[own], order))
    return found


def tensor_rule(lower: Floats, upper: Floats, owner: Ints, order: int) -> CellRule:
    """The plain Gauss rule on boxes (dim, n)."""
    x, w = gauss(order)
    dimension = len(lower)
    place = np.stack(np.meshgrid(*[x] * dimension, indexing="ij")).reshape(dimension, 1, -1)
    weight = np.prod(np.stack(np.meshgrid(*[w] * dimension, indexing="ij")).reshape(dimension, -1), axis=0)
    side = upper - lower
    points = (lower[:, :, None] + side[:, :, None] * place).reshape(dimension, -1)
    weights = (np.prod(side, axis=0)[:, None] * weight).ravel()
    none = np.empty((dimension, 0)), np.empty(0), np.empty(0, np.int64), np.empty(0, np.int64)
    return CellRule(points, weights, np.repeat(owner, len(weight)), *none)


def _faces(sides: Floats) -> Floats:
    """The measure of a side across each axis, together, of boxes with sides (dim, n)."""
    others = [np.prod(np.delete(sides, axis, axis=0), axis=0) for axis in range(len(sides))]
    found: Floats = np.sum(others, axis=0)
    return found


@dataclass(frozen=True)
class Columns:
    """Pieces with the ends (2, n) of their heights, and which (m,) of the leaves that matter in them stand upright."""

    functions: BoundedFunctions
    pieces: CutPieces
    height: Floats
    upright: Flags

    @classmethod
    def of(cls, functions: BoundedFunctions, pieces: CutPieces) -> Columns:
        """Of pieces that have a height."""
        ends = np.stack([pieces.lower, pieces.upper], axis=1)
        slopes = along(pieces.gradient, pieces.axis[pieces.piece])
        return cls(functions, pieces, along(ends, pieces.axis), (slopes == 0).all(axis=0))

    def lines(self, piece: Ints, base: Floats, standing: bool = False) -> Lines:
        """The lines of pieces above places (..., n) of their bases; `standing` ones are on upright leaves."""
        pieces = self.pieces
        line, pair = self.pairs(piece)
        leaf, own = pieces.leaf[pair], piece[line]
        curves = Risers(self.functions, leaf, pieces.axis[own], base[..., line])
        lower, upper = self.height[:, own]
        below = curves.distances(np.arange(len(line)), lower)
        above, rising = below.copy(), np.flatnonzero(~self.upright[pair])
        above[rising] = curves.distances(rising, upper[rising])
        root = heights_between(curves, lower, upper, below, above)
        begin = starts(np.diff(pieces.start)[piece])
        ends, upright = self.height[:, piece], self.upright[pair]
        tall, tolerance = upper - lower, self.functions.tolerance
        past = [
            beyond(curves.distances, at, way, (np.abs(value) <= tolerance) & ~upright, tolerance)
            for at, way, value in ((lower, -tall, below), (upper, tall, above))
        ]
        zero = upright & (np.abs(below) <= tolerance) & (not standing)
        for axis, place in enumerate(np.atleast_2d(curves.base)):  # beside the line, where nothing is seen along it
            zero &= past[0] * past[1] == 0
            for sides, way in zip(past, (tall, -tall), strict=True):
                beside = beyond(partial(_beside, curves, lower, axis), place, way, zero, tolerance)
                sides[zero] = beside[zero]
        return Lines(self.functions, piece, base, ends, begin, leaf, upright, below, above, root, np.stack(past))

    def touching(self, lines: Lines, weight: Floats) -> float:
        """The weight of lines that meet two surfaces closer together than it is known where it meets each."""
        functions, pieces = self.functions, self.pieces
        line, pair, gap = neighbouring(lines, float(np.sqrt(functions.tolerance)))
        own = lines.piece[line]
        axis, base = pieces.axis[own], lines.base[..., line]
        known = np.zeros(len(gap))
        with np.errstate(divide="ignore"):
            for one in pair:
                _, gradient = functions.evaluate(lines.leaf[one], placed(axis, base, lines.root[one]))
                known += SAME * functions.tolerance * np.maximum(1 / np.abs(along(gradient, axis)), 1.0)
        line, pair, own = line[gap <= known], pair[:, gap <= known], own[gap <= known]
        if not len(own):
            return 0.0
        ends = np.stack([across(end, pieces.axis) for end in (pieces.lower, pieces.upper)])
        return float(weight[np.unique(line[~self.one_surface(own, lines.leaf[pair], ends)])].sum())

    def one_surface(self, piece: Ints, leaf: Ints, base: Floats) -> Flags:
        """Whether two leaves (2, n) have one surface in pieces (n,), given the ends (2, ..., pieces) of all bases."""
        key = np.stack([piece, *np.sort(leaf, axis=0)])
        (own, *leaves), back = np.unique(key, axis=1, return_inverse=True)
        ends = self.pieces.axis[own], self.height[:, own], base[..., own]
        same: Flags = coincide(self.functions, np.stack(leaves), *ends)[back.ravel()]
        return same

    def pairs(self, piece: Ints) -> tuple[Ints, Ints]:
        """For pieces in any order, the leaves that matter in each: the number in the order, and of piece and leaf."""
        counts = np.diff(self.pieces.start)[piece]
        return np.repeat(np.arange(len(piece)), counts), span(self.pieces.start[:-1][piece], counts)

    def rule(
        self, lines: Lines, weight: Floats, walls: Lines, along_walls: Panels, orders: Ints
    ) -> tuple[CellRule, LeftOpen]:
        """The rule on lines of such weights, and on intervals of the lines on upright leaves; orders of all pieces.

        In pieces that are not proved to have a height all may be wrong: what they hold, and the boundary found there.
        """
        panels, edges = lines.walked(weight, self.pieces.signs[lines.piece])
        points, weights, owner, _ = self._spread(lines, panels, orders)
        wall_points, wall_weights, wall_owner, wall_leaf = self._spread(walls, along_walls, orders)
        own, leaf = lines.piece[edges.line], edges.leaf
        edge_points = placed(self.pieces.axis[own], lines.base[..., edges.line], edges.lower)
        _, gradient = self.functions.evaluate(np.where(leaf < 0, ~leaf, leaf), edge_points)
        with np.errstate(all="ignore"):
            longer = np.sqrt((gradient**2).sum(axis=0)) / np.abs(along(gradient, self.pieces.axis[own]))
        # At a node or cusp the last pieces, as small as they become, hold boundary with hardly a slope, or without: not
        # more than their sides, as leaves rise or fall there.
        proved, sides = self.pieces.proved[own], (self.pieces.upper - self.pieces.lower)[:, own]
        kept = np.isfinite(longer) | proved
        most = np.where(proved, _faces(sides), sides.max(axis=0, initial=0.0) ** (len(edge_points) - 1))
        share = edges.weight * longer
        unsure = ~proved | ~(share <= most)
        share = np.fmin(share, most)
        wide = np.prod(self.pieces.upper - self.pieces.lower, axis=0)[~self.pieces.proved]
        unresolved = LeftOpen(float(wide.sum()), float(share[kept & unsure].sum()))
        unresolved += self._doubtful(wall_points, wall_weights, wall_leaf)
        made = CellRule(
            points,
            weights,
            owner,
            np.concatenate([edge_points[:, kept], wall_points], axis=1),
            np.concatenate([share[kept], wall_weights]),
            np.concatenate([leaf[kept], wall_leaf]),
            np.concatenate([self.pieces.owner[own[kept]], wall_owner]),
        )
        return made, unresolved

    def _doubtful(self, points: Floats, weights: Floats, leaf: Ints) -> LeftOpen:
        """What walls may be wrong by that hardly slope: a double zero and its rounding look like two of them."""
        functions = self.functions
        if not functions.faint:
            return LeftOpen()
        _, gradient = functions.evaluate(np.where(leaf < 0, ~leaf, leaf), points)
        steep = np.sqrt((gradient**2).sum(axis=0))
        faint = steep <= functions.faint
        off = functions.tolerance / np.maximum(steep[faint], np.sqrt(functions.tolerance))
        return LeftOpen(float(weights[faint] @ off), float(weights[faint].sum()))

    def _spread(self, lines: Lines, panels: Panels, orders: Ints) -> tuple[Floats, Floats, Ints, Ints]:
        """Points, weights, cells and leaves of a Gauss rule on intervals of lines."""
        which, x, w = gauss_on(orders[lines.piece[panels.line]])
        tall = panels.upper - panels.lower
        line = panels.line[which]
        height = panels.lower[which] + x * tall[which]
        points = placed(self.pieces.axis[lines.piece[line]], lines.base[..., line], height)
        weights = w * (tall * panels.weight)[which]
        return points, weights, self.pieces.owner[lines.piece[line]], panels.leaf[which]


def _beside(curves: Risers, height: Floats, axis: int, which: Ints, at: Floats) -> Floats:
    """Leaves at a height of lines that are moved to other places along one axis of the base."""
    base = np.atleast_2d(curves.base)[:, which]
    base[axis] = at
    moved = replace(curves, leaf=curves.leaf[which], axis=curves.axis[which], base=base)
    return moved.distances(np.arange(len(which)), height[which])


def neighbouring(lines: Lines, most: float) -> tuple[Ints, Ints, Floats]:
    """Crossings next to each other on a line, not farther apart than so much: the line, both (2, n), how far apart."""
    line = np.repeat(np.arange(len(lines.piece)), np.diff(lines.begin))
    some = np.flatnonzero((lines.below > 0) != (lines.above > 0))
    some = some[np.lexsort((lines.root[some], line[some]))]
    pair = np.stack([some[:-1], some[1:]])
    gap = lines.root[pair[1]] - lines.root[pair[0]]
    near = (line[pair[0]] == line[pair[1]]) & (gap <= most)
    return line[pair[0, near]], pair[:, near], gap[near]
