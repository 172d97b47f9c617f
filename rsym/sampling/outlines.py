"""Outlines: the boundary of a body in a plane, every vertex and every corner exact.

The signs of omega on the lattice decide how the vertices connect. Each vertex is
the zero of the sign form on its edge of the lattice; where two neighbours lie on
different leaves, the point that both leaves have in common goes between them.
"""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from rsym.arrays import Flags, Floats, Ints
from rsym.errors import RsymError, warn
from rsym.sampling.contours import ON_LEVEL, LevelLines, LevelLinesStatus, bends, cropped
from rsym.sampling.cut_cells import edges_of
from rsym.sampling.isolines import index_lines
from rsym.sampling.plane import PlaneSampler
from rsym.sampling.plane_leaves import NEWTON_STEPS, REACH, PlaneLeaves, leaves_of, level_leaves
from rsym.sampling.roots import bracketed_roots
from rsym.sampling.unseen import seen_lines

# Leaves that meet at an angle below this, in radians, have no corner to lose.
SMOOTH_JOINT = 1e-2
SAME_CORNER = 1e-6  # of a cell
AT_HAND = 2.0  # cells from a line that runs back to its corner to those of a third leaf


def outline(sampler: PlaneSampler, leaves: PlaneLeaves, signs: Floats | None = None) -> LevelLines:
    """The lines omega = 0 of a prepared plane; what is thinner than a cell is looked for."""
    signs, leaves = _defined(sampler.signs() if signs is None else signs), leaves.unfolded
    seen = seen_lines(sampler.lattice, signs, leaves)
    found, _, missed = _on_leaves(sampler, leaves, signs, seen.lines)
    if len(missed) and seen.examined:  # where leaves only touch, say: they are parted below a cell
        seen = seen_lines(sampler.lattice, signs, leaves, missed)
        found, _, _ = _on_leaves(sampler, leaves, signs, seen.lines)
    told = {name: getattr(seen, name) for name in ("unseen", "places", "finer", "examined")}
    return replace(found, status=replace(found.status, **told))


def known_outline(sampler: PlaneSampler, *, cut: bool) -> LevelLines:
    """The lines omega = 0 of what has no value somewhere or jumps, with ends at the ends of domains."""
    leaves = leaves_of(sampler.shape, sampler.free, sampler.fixed, sampler.letters, sampler.bounds)
    found = (outline_within if cut else outline)(sampler, leaves)
    if not leaves.form.traced:
        warn(
            "the boundary jumps with a floor or a Mod: there lines are right at their vertices, and cut corners; "
            "remedy: write the pieces that lie in the bounds as a union, or as a Piecewise of conditions"
        )
    return replace(found, status=replace(found.status, undefined_samples=int(np.isnan(sampler.values()).sum())))


def outline_within(sampler: PlaneSampler, leaves: PlaneLeaves, signs: Floats | None = None) -> LevelLines:
    """The same cut off at the bounds of the plane; new ends slide along the border onto the leaf beside them."""
    found = outline(sampler, leaves, signs)
    lines, ends = cropped(found, sampler.bounds)
    if not ends:
        return found
    places = np.array([lines[line][vertex] for line, vertex, _ in ends])
    at, along = np.arange(len(ends)), np.array([1 - axis for _, _, axis in ends])
    points, leaf = places.copy(), leaves.distance(places)[1]
    with np.errstate(all="ignore"):
        for _ in range(NEWTON_STEPS):
            ((value, gradient),) = leaves.of(points, leaf)
            points[at, along] -= value / gradient[at, along]
    low, high = np.array(sampler.bounds, float).T
    chord = np.array(
        [
            np.abs(np.diff(lines[line][[vertex, 1 if vertex == 0 else vertex - 1]], axis=0)).max()
            for line, vertex, _ in ends
        ]
    )
    good = ((points >= low) & (points <= high)).all(axis=1) & (np.abs(points - places).max(axis=1) <= chord)
    for (line, vertex, _), place in zip(ends, np.where(good[:, None], points, places), strict=True):
        lines[line][vertex] = place
    closed = sum(bool((line[0] == line[-1]).all()) for line in lines)
    status = replace(found.status, vertices=sum(map(len, lines)), closed=closed, open=len(lines) - closed)
    return replace(found, lines=tuple(lines), status=status)


def level_outline(sampler: PlaneSampler, level: float, values: Floats, *, cut: bool) -> LevelLines | None:
    """The lines omega = level of a value that is a min and max of leaves, corners and all; of another value None."""
    leaves = level_leaves(sampler.shape, sampler.free, sampler.fixed, sampler.letters, level, sampler.bounds)
    if leaves is None:
        return None
    signs = np.where(np.isnan(values), np.nan, np.where(values >= level, 1.0, -1.0))
    found = (outline_within if cut else outline)(sampler, leaves, signs)
    return replace(found, level=level)


def outline_on_edges(
    sampler: PlaneSampler, leaves: PlaneLeaves, signs: Floats
) -> tuple[LevelLines, tuple[Floats, ...]]:
    """The lines omega = 0, and of each the indices (n, 2) of the middles of the edges it crosses; NaN at corners.

    What is thinner than a cell is not looked for: all edges are of the lattice.
    """
    # Signs alone: then every vertex lies in the middle of its edge, and its edge is known.
    return _on_leaves(sampler, leaves.unfolded, signs, [line[::-1] for line in index_lines(_defined(signs), 0.0)])[:2]


def _defined(signs: Floats) -> Floats:
    if np.isnan(signs).all():
        raise RsymError("omega is undefined in all of the plane", code="undefined", remedy="choose other bounds")
    return signs


def _on_leaves(
    sampler: PlaneSampler, leaves: PlaneLeaves, signs: Floats, found: Sequence[Floats]
) -> tuple[LevelLines, tuple[Floats, ...], Floats]:
    """Lines by the middles of the edges that they cross, each vertex on its leaf, and corners where leaves meet.

    And in indices where between neighbours on two leaves no corner was found.
    """
    cell = min(sampler.lattice.spacing)
    index = np.concatenate([*found, np.empty((0, 2))])
    points = _on_edges(sampler, leaves, index)
    value, gradient, leaf = leaves.of_active(points)
    with np.errstate(all="ignore"):
        distance = np.abs(value) / np.linalg.norm(gradient, axis=1)
    starts = np.cumsum([0, *map(len, found)])
    neighbours = np.setdiff1d(np.arange(1, len(points)), starts)
    same, turned = np.diff(leaf)[neighbours - 1] == 0, bends(gradient)[neighbours - 1]
    # On one leaf that turns, too, another may end the boundary in between: that of the end of a strip.
    own = neighbours[same & turned] - 1
    ended = ~np.logical_and(*_bounds(leaves, [points[own], points[own + 1]], [leaf[own]], cell))
    joints = np.sort(np.concatenate([neighbours[~same] - 1, own[ended]]))
    bent = turned & np.isin(leaf, leaves.kinked)[neighbours]
    corners = _corners(leaves, Joints(points[joints], points[joints + 1], leaf[joints], leaf[joints + 1]), cell)
    places = joints[corners.joint] + 1
    ends = starts + np.searchsorted(places, starts)
    lines, edges = (
        tuple(np.split(np.insert(rows, places, new, axis=0), ends[1:-1])) if found else ()
        for rows, new in ((points, corners.points), (index, np.full(corners.points.shape, np.nan)))
    )
    labels = np.split(np.insert(leaf, places, -1), ends[1:-1]) if found else []
    once = _once(lines, labels, cell)
    lines, edges = (tuple(rows[k] for k in once) for rows in (lines, edges))
    if len(leaves.walls):
        lines, edges = _off_walls(lines, edges, [np.isin(labels[k], leaves.walls) for k in once])
    lines, edges = _without_beads(lines, edges, cell)
    closed = sum(bool((line[0] == line[-1]).all()) for line in lines)
    status = LevelLinesStatus(
        vertices=sum(map(len, lines)),
        kept=int(np.count_nonzero(~(distance <= ON_LEVEL * cell) & ~np.isin(leaf, leaves.walls))),
        undefined_samples=int(np.isnan(signs).sum()),
        closed=closed,
        open=len(lines) - closed,
        unresolved_corners=len(corners.missed) + int(np.count_nonzero(bent & ~np.isin(neighbours - 1, joints))),
    )
    missed = joints[corners.missed]
    return LevelLines(lines, 0.0, "value", status), edges, (index[missed] + index[missed + 1]) / 2


def _on_edges(sampler: PlaneSampler, leaves: PlaneLeaves, index: Floats) -> Floats:
    """The zero of the form on the edge of each vertex; `index` holds the middles of edges."""
    low, high = edges_of(index)
    along = high - low
    start, end = (leaves.active(sampler.lattice.points(end))[0] for end in (low, high))

    def at(t: Floats, which: Ints) -> Floats:
        return leaves.active(sampler.lattice.points(low[which] + t[:, None] * along[which]))[0]

    return sampler.lattice.points(low + bracketed_roots(at, start, end)[:, None] * along)


def _once(lines: Sequence[Floats], labels: Sequence[Ints], cell: float) -> list[int]:
    """Of lines from corner to corner along the same leaves the longest, where samples see one in pieces; -1: corners.

    Examples
    --------
    >>> corners = np.array([[0.0, 0.0], [1.0, 0.0]])
    >>> one, other = (np.insert(corners, 1, [at, 0.2], axis=0)[[0, 1, 2, 0]] for at in (0.3, 0.6))
    >>> _once([one, other, one], [np.array([-1, leaf, -1, -1]) for leaf in (4, 4, 5)], 1.0)
    [0, 2]
    """
    kept: dict[Hashable, list[tuple[int, dict[Hashable, int]]]] = {}
    for number, (line, label) in enumerate(zip(lines, labels, strict=True)):
        corner = np.flatnonzero(label[:-1] < 0)
        if len(corner) < 2 or (line[0] != line[-1]).any():
            kept[number] = [(number, {})]
            continue
        places = [*map(tuple, np.rint(line[corner] / (SAME_CORNER * cell)).astype(np.int64).tolist())]
        ways = zip(places, [*places[1:], places[0]], strict=True)
        arcs: dict[Hashable, int] = dict(zip(ways, label[corner + 1].tolist(), strict=True))
        found = kept.setdefault(frozenset(arcs), [])
        for place, (other, known) in enumerate(found):
            if all(arcs[arc] == leaf or -1 in (arcs[arc], leaf) for arc, leaf in known.items()):
                found[place] = (number, arcs) if len(line) > len(lines[other]) else (other, known)
                break
        else:
            found.append((number, arcs))
    return sorted(number for found in kept.values() for number, _ in found)


def _without_beads(
    lines: Sequence[Floats], edges: Sequence[Floats], cell: float
) -> tuple[tuple[Floats, ...], tuple[Floats, ...]]:
    """Lines without those that samples cut off a sharp tip: all ends have one corner, that of a line that stays."""
    marks = [np.isnan(edge[:, 0]) for edge in edges]
    beads = [_is_bead(line, mark, cell) for line, mark in zip(lines, marks, strict=True)]
    corners = [line[mark] for line, mark, bead in zip(lines, marks, beads, strict=True) if not bead]
    others = np.concatenate([np.empty((0, 2)), *corners])
    kept = [
        number
        for number, (line, mark, bead) in enumerate(zip(lines, marks, beads, strict=True))
        if not bead or np.abs(line[mark][0] - others).max(axis=1).min(initial=np.inf) > ON_LEVEL * cell
    ]
    return tuple(lines[k] for k in kept), tuple(edges[k] for k in kept)


def _is_bead(line: Floats, mark: Flags, cell: float) -> bool:
    """Whether each part between corners, all at one place, goes out along its leaf and is cut off there.

    A loop that only begins and ends at one place comes back by itself: the farthest vertex of it has some before and
    behind.
    """
    if np.count_nonzero(mark) < 2 or np.ptp(line[mark], axis=0).max() > ON_LEVEL * cell:
        return False
    first = int(np.argmax(mark))
    rows, cuts = (np.concatenate([part[first:-1], part[:first]]) for part in (line, mark))
    parts = np.split(rows, np.flatnonzero(cuts)[1:])
    far = [int(np.hypot(*(part - part[0]).T).argmax()) for part in parts]
    one_way = all(number <= 1 or number == len(part) - 1 for number, part in zip(far, parts, strict=True))
    return one_way and bool(np.ptp(line, axis=0).max() <= 2 * REACH * cell)


def _off_walls(
    lines: Sequence[Floats], edges: Sequence[Floats], walls: Sequence[Flags]
) -> tuple[tuple[Floats, ...], tuple[Floats, ...]]:
    """Lines, and the edges of their vertices, without what lies on walls; corners there are ends of what is left."""
    kept: list[tuple[Floats, Floats]] = []
    for line, edge, wall in zip(lines, edges, walls, strict=True):
        if not wall.any():
            kept.append((line, edge))
            continue
        if (line[0] == line[-1]).all():
            start = int(np.argmax(wall))
            line, edge = (np.roll(rows[:-1], -start, axis=0) for rows in (line, edge))
            wall = np.roll(wall[:-1], -start)
        cuts = np.flatnonzero(np.diff(wall)) + 1
        for part, along, ends in zip(np.split(line, cuts), np.split(edge, cuts), np.split(wall, cuts), strict=True):
            if not ends[0] and len(part) > 1:
                kept.append((part, along))
    return tuple(line for line, _ in kept), tuple(edge for _, edge in kept)


class Joints(NamedTuple):
    """Neighbours on different leaves: points (k, 2) before and after, and their leaves."""

    before: Floats
    after: Floats
    one: Ints
    other: Ints

    def take(self, which: Ints) -> Joints:
        """Some of them, as often as they are named."""
        return Joints(self.before[which], self.after[which], self.one[which], self.other[which])


class _Corners(NamedTuple):
    """Which joint each corner belongs to, in order; where it is; and which joints that turn have none that holds."""

    joint: Ints
    points: Floats
    missed: Ints


def _corners(leaves: PlaneLeaves, joints: Joints, cell: float) -> _Corners:
    """The common zero of both leaves of a joint, or those of both with a third leaf.

    A corner holds if each leaf is the boundary all the way to it, with the inside to its left. If there is none at hand
    the line may run back to the corner that it came from: it is cut off a tip (`_without_beads`).
    """
    point, holds, back = _one_corner(leaves, joints, cell)
    # The third leaf, of a step or a chamfer smaller than a cell, is looked for among all.
    rest = np.repeat(np.flatnonzero(~holds), leaves.count)
    third = np.tile(np.arange(leaves.count), np.count_nonzero(~holds))
    pair, two = _two_corners(leaves, joints.take(rest), third, cell)
    two[two] = ~back[rest[two]] | (
        np.abs(pair[two] - joints.before[rest[two], None]).max(axis=(1, 2)) <= AT_HAND * cell
    )
    found, first = np.unique(rest[two], return_index=True)
    holds |= back & ~np.isin(np.arange(len(back)), found)
    joint = np.concatenate([np.flatnonzero(holds), np.repeat(found, 2)])
    points = np.concatenate([point[holds], pair[two][first].reshape(-1, 2)])
    order = np.argsort(joint, kind="stable")
    missed = np.setdiff1d(np.arange(len(holds)), joint)
    missed = missed[_turn(leaves, joints.take(missed)) > SMOOTH_JOINT]
    return _Corners(joint[order], points[order], missed)


def _one_corner(leaves: PlaneLeaves, joints: Joints, cell: float) -> tuple[Floats, Flags, Flags]:
    """Common zeros, which hold, and which do but for the way there."""
    corner = leaves.common((joints.before + joints.after) / 2, joints.one, joints.other)
    if len(leaves.walls):  # a line may end upright at a wall
        ends = np.isin(joints.one, leaves.walls) | np.isin(joints.other, leaves.walls)
        holds, back = _near(joints, corner, cell), np.zeros(len(ends), np.bool_)
        holds[ends] &= leaves.meet(corner[ends], joints.one[ends], joints.other[ends], cell)
        rest = np.flatnonzero(~ends)
        holds[rest], back[rest] = _holds(leaves, joints.take(rest), corner[rest], cell)
        return corner, holds, back
    return corner, *_holds(leaves, joints, corner, cell)


def _holds(leaves: PlaneLeaves, joints: Joints, corner: Floats, cell: float) -> tuple[Flags, Flags]:
    holds, back = _near(joints, corner, cell), np.zeros(len(corner), np.bool_)
    near = np.flatnonzero(holds)
    some, here = joints.take(near), corner[near]
    bounds, forth = _bounds(leaves, [some.before, here, some.after], [some.one, some.other], cell)
    bounds &= leaves.meet(here, some.one, some.other, cell)
    holds[near], back[near] = bounds & forth, bounds & ~forth
    return holds, back


def _two_corners(leaves: PlaneLeaves, joints: Joints, third: Ints, cell: float) -> tuple[Floats, Flags]:
    middle = (joints.before + joints.after) / 2
    ones, others = np.concatenate([joints.one, third]), np.concatenate([third, joints.other])
    first, second = np.split(leaves.common(np.tile(middle, (2, 1)), ones, others), 2)
    holds = _near(joints, first, cell) & _near(joints, second, cell)
    # Leaves that coincide have a corner with a third one anywhere, and a line would run there and back.
    holds[holds] = np.linalg.norm(first[holds] - second[holds], axis=1) > ON_LEVEL * cell
    near = np.flatnonzero(holds)
    some, one, two, third = joints.take(near), first[near], second[near], third[near]
    bounds, forth = _bounds(leaves, [some.before, one, two, some.after], [some.one, third, some.other], cell)
    meet = leaves.meet(one, some.one, third, cell) & leaves.meet(two, third, some.other, cell)
    holds[near] = bounds & forth & meet
    return np.stack([first, second], axis=1), holds


def _near(joints: Joints, points: Floats, cell: float) -> Flags:
    with np.errstate(all="ignore"):  # Newton's method may have gone anywhere
        return np.asarray(np.linalg.norm(points - joints.before, axis=1) <= REACH * cell)


def _bounds(leaves: PlaneLeaves, ends: Sequence[Floats], along: Sequence[Ints], cell: float) -> tuple[Flags, Flags]:
    """Whether between ends (k + 1, n, 2) the leaves (k, n) are the boundary, and the inside is to the left.

    At each end and at two places before.
    """
    start, end = np.array(ends[:-1]), np.array(ends[1:])
    places = np.array([start + share * (end - start) for share in (1 / 3, 2 / 3, 1.0)])
    leaf, way = np.tile(np.ravel(along), len(places)), np.tile((end - start).reshape(-1, 2), (len(places), 1))
    on = leaves.slide(places.reshape(-1, 2), leaf)
    ((_, slope),) = leaves.of(on, leaf)
    with np.errstate(all="ignore"):  # where a leaf is singular
        back = (way[:, 1] * slope[:, 0] - way[:, 0] * slope[:, 1]) / np.hypot(*slope.T) > ON_LEVEL * cell
    told = (leaves.distance(on)[0] <= ON_LEVEL * cell, ~back)
    on_boundary, forth = (one.reshape(len(places) * len(start), -1).all(axis=0) for one in told)
    return np.asarray(on_boundary), np.asarray(forth)


def _turn(leaves: PlaneLeaves, joints: Joints) -> Floats:
    """The angle by which the boundary turns at a joint."""
    ((_, before),), ((_, after),) = leaves.of(joints.before, joints.one), leaves.of(joints.after, joints.other)
    (p, q), (u, v) = before.T, after.T
    with np.errstate(all="ignore"):
        turn: Floats = np.arctan2(np.abs(p * v - q * u), p * u + q * v)
    return turn
