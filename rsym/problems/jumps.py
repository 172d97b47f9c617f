"""Values that jump where two parts meet: near the corner the solution is as the angle between them.

At a corner of the angle alpha, u is a on one edge and b on the other. Whatever k is, if it is smooth and alike in all
directions, u = a + (b - a) theta/alpha + what is smoother, theta being the angle from the first edge: its gradient
grows like 1/r, and what flows through the edges has no bound. That function is part of the lift, within some distance
of the corner; beyond it values are shared by distance. Where edges are curved the angle is that of their leaves.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
import sympy as sp

from rsym.analysis.transfinite import OnPart, inverse_distances
from rsym.model.symbols import substitute, symbols_of
from rsym.problems.corners.corners import PlaneCorner, surveyed_corners
from rsym.problems.parts import Parts
from rsym.program.raising import raised

NO_JUMP = 1e-9  # of the largest value: data that agree but for rounding
POWER = 6  # how smoothly the angle ends
FLAT = 2  # (r/R)**(2*FLAT) is what is left of the shares by distance near a corner
BEYOND = sp.Rational(1, 2**30)  # of the angle between the edges: further out a point has the value on an edge
REACH = 0.9  # of the distance to other edges


class ValueJump(NamedTuple):
    """A corner, and the values on its first and second edge."""

    corner: PlaneCorner
    values: tuple[float, float]


def jumps_of(parts: Parts, own: Mapping[int, sp.Expr]) -> tuple[ValueJump, ...]:
    """The corners where the values of leaves, by their numbers, jump."""
    if parts.shape.dimension != 2 or len({*own.values()}) < 2:
        return ()
    corners, _ = surveyed_corners(parts.shape)
    found, most = [], 0.0
    for corner in corners:
        if not all(leaf in own for leaf in corner.leaves) or corner.is_cusp:
            continue
        values = tuple(_at(parts, own[leaf], corner.point) for leaf in corner.leaves)
        if all(map(math.isfinite, values)):
            most = max(most, *map(abs, values))
            found.append(ValueJump(corner, (values[0], values[1])))
    return tuple(jump for jump in found if abs(jump.values[1] - jump.values[0]) > NO_JUMP * most)


def _at(parts: Parts, value: sp.Expr, point: Sequence[float]) -> float:
    letters = parts.shape.letters.values_with(None)
    places = dict(zip(parts.shape.coordinates, point, strict=True))
    known = {symbol: letters[symbol.name] for symbol in symbols_of(value) if symbol.name in letters}
    found = sp.N(value.subs({**places, **known}))
    return float(found) if found.is_real else math.nan


def with_jumps(
    parts: Parts, own: Mapping[int, sp.Expr], jumps: Sequence[ValueJump]
) -> tuple[sp.Expr, dict[int, sp.Expr]]:
    """A function with the jumps of values, and what is left of the values of each leaf, which agrees at corners."""
    flat = {leaf: _flat(parts, leaf, value) for leaf, value in own.items()}
    groups: dict[sp.Expr, list[int]] = {}
    for leaf, value in flat.items():
        groups.setdefault(value, []).append(leaf)
    weights = parts.smooth_weights()
    shared = inverse_distances([OnPart(value, weights.of(leaves)) for value, leaves in groups.items()], 1)
    near, angular = [], []
    points = np.array([jump.corner.point for jump in jumps])
    for jump in jumps:
        apart = np.hypot(*(points - jump.corner.point).T)
        radius = REACH * min([jump.corner.reach, *(apart[apart > 0] / 2)])
        x, y = _straightened(parts, jump.corner)
        ends = sp.Max(0, 1 - ((x**2 + y**2) / sp.Float(radius) ** 2) ** FLAT) ** POWER
        first, second = (flat[leaf] for leaf in jump.corner.leaves)
        near.append(ends)
        angular.append(ends * (first + (second - first) * _share(jump.corner, x, y)))
    function = shared * (1 - sp.Add(*near)) + sp.Add(*angular)
    return function, {leaf: value - flat[leaf] for leaf, value in own.items()}


def _flat(parts: Parts, leaf: int, value: sp.Expr) -> sp.Expr:
    """A value at all corners of a leaf as one function that has no slope there."""
    coordinates = parts.shape.coordinates
    if not {*symbols_of(value)} & {*coordinates}:
        return value
    corners, _ = surveyed_corners(parts.shape)
    places = [corner.point for corner in corners if leaf in corner.leaves]
    squares = [sum((one - sp.Float(at)) ** 2 for one, at in zip(coordinates, place, strict=True)) for place in places]
    shares = [sp.Mul(*(other for k, other in enumerate(squares) if k != number)) for number in range(len(places))]
    there = [substitute(value, dict(zip(coordinates, map(sp.Float, place), strict=True))) for place in places]
    return sp.Add(*(share * at for share, at in zip(shares, there, strict=True))) / sp.Add(*shares)


def _straightened(parts: Parts, corner: PlaneCorner) -> tuple[sp.Expr, sp.Expr]:
    """Coordinates about a corner in which both edges are straight."""
    nodes, coordinates = parts.form.builder.nodes, parts.shape.coordinates
    own = []
    for leaf, line, slope in zip(corner.leaves, corner.lines, corner.gradients, strict=True):
        if line is None:
            own.append(raised(nodes, parts.form.leaves[leaf]))
        else:
            own.append(
                sp.Add(
                    *(
                        sp.Float(along) * (one - sp.Float(at))
                        for along, one, at in zip(slope, coordinates, corner.point, strict=True)
                    )
                )
            )
    (a, b), (c, d) = np.linalg.inv(np.array(corner.gradients)).tolist()
    first, second = own
    return sp.Float(a) * first + sp.Float(b) * second, sp.Float(c) * first + sp.Float(d) * second


def _share(corner: PlaneCorner, x: sp.Expr, y: sp.Expr) -> sp.Expr:
    """The angle from the first edge as a share of that between both."""
    way = math.atan2(corner.edges[0, 1], corner.edges[0, 0]) + corner.angle / 2
    c, s = sp.Float(math.cos(way)), sp.Float(math.sin(way))
    turn = sp.atan2(c * y - s * x, c * x + s * y) / sp.Float(corner.angle)
    half = sp.Rational(1, 2) + BEYOND  # a point of the boundary may lie outside, by rounding, at any angle
    return sp.Rational(1, 2) + sp.Min(half, sp.Max(-half, turn))
