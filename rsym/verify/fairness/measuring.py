"""Measures of a plane boundary or a meridian by quadrature: length, area, the energies of bending and of its variation.

Between neighbouring points of the line the arc is a graph over the chord; Gauss's nodes on the chord are moved onto it
across the chord. Two rules of different order tell the error, which is an estimate and no bound.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from rsym.arrays import Floats
from rsym.backends.kernel import run_in_blocks
from rsym.backends.registry import make_function
from rsym.program.expansion import expand
from rsym.program.program import FLOAT64
from rsym.sampling.combs import Comb
from rsym.verify.boxes.joints import BoundaryArc
from rsym.verify.fairness.bending import Arcs
from rsym.verify.fairness.pieces import ArcPiece
from rsym.verify.fairness.report import Measure, Profile

NODES = (8, 5)  # of Gauss's rules: the second tells the error of the first
NEWTON_STEPS = 8
NEAR = 0.02  # of the usual step: points so close to a joint may lie on either side of it
ROUNDING = 1e-14  # of a measure, what float64 loses


class Sampler:
    """Evaluates the curvatures of a boundary in float64, each point on the arc of the nearest piece."""

    def __init__(self, arcs: Arcs, pieces: Sequence[ArcPiece]) -> None:
        self.model = arcs.model
        groups: dict[tuple[BoundaryArc, bool], dict[tuple[tuple[float, float], ...], None]] = {}
        for piece in pieces:
            groups.setdefault((piece.arc, piece.joined), {})[piece.whole] = None
        self._boxes = [np.array(list(boxes)) for boxes in groups.values()]
        self._functions = [self._function(arcs, arc, joined) for arc, joined in groups]

    def _function(self, arcs: Arcs, arc: BoundaryArc, joined: bool) -> Callable[[Floats], Floats]:
        """value, gradient, side, then the curvatures, then their derivatives at points (n, 2), one row each."""
        quantities = arcs.quantities(arc.function)
        nodes = [arc.function, *self.model.gradient(arc.function)]
        nodes.append(arc.side if joined else self.model.builder.const(1))
        nodes += [quantity.value for quantity in quantities] + [quantity.first for quantity in quantities]
        program = self.model.builder.program({str(k): node for k, node in enumerate(nodes)})
        compiled = make_function(expand(program), "numpy", FLOAT64)
        letters = [float(self.model.letters[name][0]) for name in program.letters]

        def evaluate(points: Floats) -> Floats:
            out = np.empty((len(nodes), len(points)))
            with np.errstate(all="ignore"):
                run_in_blocks(compiled, list(points.T), letters, out, 1)
            return out

        return evaluate

    def __call__(self, points: Floats) -> Floats:
        """The rows of the arc to which each point belongs; of a body the mirror image of a point counts."""
        upper = points * [1.0, np.nan] if self.model.body else points
        if self.model.body:
            upper[:, 1] = np.abs(points[:, 1])
        nearest = np.full(len(points), np.inf)
        result = np.full((4 + 2 * (2 if self.model.body else 1), len(points)), np.nan)
        for boxes, function in zip(self._boxes, self._functions, strict=True):
            distance = _distances(upper, boxes)
            (close,) = np.nonzero(distance < nearest)
            rows = function(upper[close])
            with np.errstate(all="ignore"):
                # Near a joint a point lies in the boxes of both arcs: it belongs to the one that it is closer to.
                distance = distance[close] + np.abs(rows[0]) / np.hypot(rows[1], rows[2])
            own = (rows[3] >= 0) & (distance < nearest[close])
            result[:, close[own]] = rows[:, own]
            nearest[close[own]] = distance[own]
        if self.model.body:
            result[2] *= np.where(points[:, 1] < 0, -1.0, 1.0)
        return result


def _distances(points: Floats, boxes: Floats) -> Floats:
    """From each point to the nearest of some boxes (n, 2, 2), along the axis where it is farther."""
    outside = np.full(len(points), np.inf)
    for (left, right), (low, high) in boxes:
        x = np.maximum(left - points[:, 0], points[:, 0] - right)
        y = np.maximum(low - points[:, 1], points[:, 1] - high)
        outside = np.minimum(outside, np.maximum(np.maximum(x, y), 0.0))
    return outside


def measures(
    sampler: Sampler, combs: Sequence[Comb], joints: Sequence[Sequence[float]]
) -> tuple[dict[str, Measure], tuple[Profile, ...]]:
    """The measures of all lines together, and the curvatures along each; at joints the lines are cut."""
    body = sampler.model.body
    lines = [with_joints(comb.points, joints, body) for comb in combs]
    lines = [with_poles(sampler, points) for points in lines] if body else lines
    totals = []
    for count in NODES:
        nodes, weights = np.polynomial.legendre.leggauss(count)
        totals.append([_integrals(sampler, points, nodes, weights, body) for points in lines])
    result = {}
    for k, name in enumerate(_names(body, all(np.array_equal(line[0], line[-1]) for line in lines))):
        fine, rough = (np.concatenate([part[k] for part in total]) for total in totals)
        value, doubt = float(fine.sum()), float(np.abs(fine - rough).sum())
        result[name] = Measure(value, doubt + ROUNDING * abs(value))
    profiles = [_profile(sampler, points, part[-1]) for points, part in zip(lines, totals[0], strict=True)]
    return result, tuple(half for one in profiles for half in (_upper(one) if body else [one]))


def _names(body: bool, closed: bool) -> Sequence[str]:
    """What `_integrals` gives, in this order; an open line bounds nothing."""
    names = (
        ("area", "bending_energy", "variation_energy", "volume")
        if body
        else (
            "length",
            "bending_energy",
            "variation_energy",
            "area",
        )
    )
    return names if closed else names[:3]


def _integrals(sampler: Sampler, points: Floats, nodes: Floats, weights: Floats, body: bool) -> list[Floats]:
    """The integrals over each step between points of a line; the last is its length."""
    start, chord = points[:-1], np.diff(points, axis=0)
    size = np.hypot(*chord.T)
    across = np.stack([-chord[:, 1], chord[:, 0]], axis=1) / size[:, None]
    at = start[:, None] + chord[:, None] * ((nodes + 1) / 2)[:, None]
    flat, direction = at.reshape(-1, 2), np.repeat(across, len(nodes), axis=0)
    rows = sampler(flat)
    for _ in range(NEWTON_STEPS):
        slope = np.einsum("ij,ji->i", direction, rows[1:3])
        with np.errstate(all="ignore"):
            step = np.clip(-rows[0] / slope, -0.2 * size.repeat(len(nodes)), 0.2 * size.repeat(len(nodes)))
        flat = flat + np.nan_to_num(step)[:, None] * direction
        rows = sampler(flat)
    gradient = rows[1:3] / np.hypot(*rows[1:3])
    with np.errstate(all="ignore"):
        stretch = 1 / np.abs(np.einsum("ij,ji->i", direction, gradient))
    ds = stretch * (size[:, None] / 2 * weights).ravel()
    tangent = np.stack([gradient[1], -gradient[0]])
    count = 2 if body else 1
    bending, variation = (rows[4 : 4 + count] ** 2).sum(axis=0), (rows[4 + count :] ** 2).sum(axis=0)
    x, y = flat.T
    if body:
        ring = np.pi * np.abs(y)
        found = [ring, bending * ring, variation * ring, -ring / 2 * y * tangent[0], np.ones_like(x)]
    else:
        found = [np.ones_like(x), bending, variation, (x * tangent[1] - y * tangent[0]) / 2, np.ones_like(x)]
    return [(part * ds).reshape(-1, len(nodes)).sum(axis=1) for part in found]


def _profile(sampler: Sampler, points: Floats, lengths: Floats) -> Profile:
    count = 2 if sampler.model.body else 1
    rows = sampler(points)
    return Profile(points, np.append(0.0, np.cumsum(lengths)), rows[4 : 4 + count].T, rows[4 + count :].T)


def _upper(profile: Profile) -> list[Profile]:
    """The runs of a meridian with a radius that is not negative; a closed line that crosses the axis begins there."""
    points, length = profile.points, profile.length
    above = points[:, 1] >= 0
    if above.all() or not above.any():
        return [profile] if above.all() else []
    rows = np.concatenate([points, profile.curvature, profile.variation], axis=1)
    if profile.closed:
        start = int(np.flatnonzero(~above)[0])
        rows = np.concatenate([rows[start:], rows[1 : start + 1]])
        length = np.append(0.0, np.cumsum(np.roll(np.diff(length), -start)))
    (found,) = np.nonzero(rows[:, 1] >= 0)
    runs = np.split(found, np.flatnonzero(np.diff(found) > 1) + 1)
    parts = [(rows[run], length[run] - length[run[0]]) for run in runs if len(run) > 1]
    return [Profile(part[:, :2], along, part[:, 2:4], part[:, 4:]) for part, along in parts]


def with_joints(points: Floats, joints: Sequence[Sequence[float]], body: bool) -> Floats:
    """The points of a line, with each joint that lies on it in the place of those next to it."""
    places = [(x, y) for x, y in joints] + [(x, -y) for x, y in joints if body and y != 0]
    for place in places:
        steps, away = np.hypot(*np.diff(points, axis=0).T), np.hypot(*(points - place).T)
        usual = float(np.median(steps))
        near = away < NEAR * usual
        if near[0] and near[-1]:
            points = np.concatenate([[place], points[~near], [place]])
        elif near.any():
            points = np.insert(points[~near], int(near.argmax()), place, axis=0)
        else:  # the tip of a needle may be cut off by a step: the detour over it is the shortest all the same
            detour = away[1:] + away[:-1] - steps
            if detour.min() < 2 * usual:
                points = np.insert(points, int(detour.argmin()) + 1, place, axis=0)
    return points


def with_poles(sampler: Sampler, points: Floats) -> Floats:
    """The points of a meridian, with one wherever it crosses the axis: the measures have a kink there."""
    below = points[:, 1] < 0
    (crossing,) = np.nonzero(below[1:] != below[:-1])
    first, second = points[crossing], points[crossing + 1]
    share = first[:, 1] / (first[:, 1] - second[:, 1])
    poles = np.stack([first[:, 0] + share * (second[:, 0] - first[:, 0]), 0 * share], axis=1)
    for _ in range(NEWTON_STEPS):
        rows = sampler(poles)
        with np.errstate(all="ignore"):
            poles[:, 0] -= np.nan_to_num(rows[0] / rows[1])
    return np.insert(points, crossing + 1, poles, axis=0)
