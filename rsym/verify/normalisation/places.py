"""Points of a boundary where a deviation is largest, found in float64 and then enclosed; and where normals break."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from rsym.bounds.balls import arb, ctx
from rsym.verify.boxes.generators import generators
from rsym.verify.boxes.local import Box, Local
from rsym.verify.normalisation.derivatives import NormalDerivatives
from rsym.verify.normalisation.report import NormalDerivative

PRECISION = 160  # bits: 30 digits are left after three derivatives and a division
HALF_SEGMENT = 2.0**-90  # half the length of the segment on which the boundary is enclosed, of the extent
NEWTON_STEPS = 8
ON_BOUNDARY = 1e-9  # of a cell: as near as the last step of Newton's method must come
ZOOMS, ZOOM = 5, 6  # five times six-fold: to 1e-4 of a cell, where a smooth maximum is flat to 1e-8
BROKEN = 45.0  # degrees between neighbouring normals from which a break is looked for
STAYS = 10.0  # degrees that stay when the neighbours have become one: else the boundary is only strongly curved
APPROACHES, APPROACH = 10, 0.1  # ten times ten times nearer


def onto_boundary(
    derivatives: NormalDerivatives, points: NDArray[np.float64], cell: float
) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    """The points moved along the gradient onto omega = 0, and which arrived within a cell."""
    moved = points.copy()
    length = np.full(len(points), np.inf)
    with np.errstate(all="ignore"):
        for _ in range(NEWTON_STEPS):
            found = derivatives.at(moved)
            squared = np.einsum("ij,ij->i", found.gradient, found.gradient)
            step = (found.value / squared)[:, None] * found.gradient
            step[found.value == 0] = 0.0  # at a corner there is no gradient
            length = np.linalg.norm(step, axis=1)
            moved = moved - step * np.minimum(1, cell / np.maximum(length, 1e-300))[:, None]
    return moved, (length <= ON_BOUNDARY * cell) & (np.linalg.norm(moved - points, axis=1) <= 2 * cell)


def zoomed(
    derivatives: NormalDerivatives, start: NDArray[np.float64], k: int, cell: float, bounds: Box
) -> NDArray[np.float64]:
    """A point of the boundary near `start` at which the deviation of order k + 1 is larger, by ever finer samples."""
    best, radius = start, cell
    grid = np.linspace(-1, 1, 33 if len(start) == 2 else 9)
    offsets = np.stack(np.meshgrid(*[grid] * (len(start) - 1), indexing="ij"), axis=-1).reshape(-1, len(start) - 1)
    for _ in range(ZOOMS):
        normal = derivatives.at(best[None]).normals[0]
        tangents = np.linalg.svd(normal[None])[2][1:]
        moved, arrived = onto_boundary(derivatives, best + radius * offsets @ tangents, cell)
        moved = np.vstack([best, moved[arrived & inside(moved, bounds)]])
        found = derivatives.at(moved)
        sizes = np.where(found.regular, np.abs(found.deviations[:, k]), -np.inf)
        best, radius = moved[int(np.argmax(sizes))], radius / ZOOM
    return best


def inside(points: NDArray[np.float64], bounds: Box) -> NDArray[np.bool_]:
    """Which points lie within the bounds and not on their edge."""
    box = np.array(bounds)
    edge = ON_BOUNDARY * (box[:, 1] - box[:, 0])
    found: NDArray[np.bool_] = ((points > box[:, 0] + edge) & (points < box[:, 1] - edge)).all(axis=1)
    return found


def enclosed(derivatives: NormalDerivatives, point: Sequence[float], k: int, bounds: Box) -> NormalDerivative:
    """The deviation of order k + 1 at a point of the boundary near `point`, with high precision.

    It is proved where omega is analytic on a small box within the bounds and certainly changes its sign along a
    segment in it: by the intermediate value theorem there is a point of the boundary on the segment, and the ball
    of the deviation over the box holds the value there.
    """
    model = derivatives.model
    extent = max(high - low for low, high in bounds)
    with ctx.workprec(PRECISION):
        middle = _refined(derivatives, [arb(float(c)) for c in point])
        normal = _gradient(derivatives, model.on(middle))
        size = sum((c * c for c in normal), arb(0)).sqrt()
        reach = [(c / size).mid() * arb(HALF_SEGMENT * extent) for c in normal]
        inner = [c + step for c, step in zip(middle, reach, strict=True)]
        outer = [c - step for c, step in zip(middle, reach, strict=True)]
        box = model.on([a.union(b) for a, b in zip(inner, outer, strict=True)])
        crosses = model.on(inner).sign(model.root) > 0 > model.on(outer).sign(model.root)
        within = all(low <= edge <= high for edge, (low, high) in zip(box.sides, bounds, strict=True))
        proved = within and crosses and generators(box, model.root).analytic and box.sign(derivatives.squared) > 0
        value = box.value(derivatives.deviations[k])
        if value is None or not value.is_finite():
            value, proved = arb(float(derivatives.at(np.array([point])).deviations[0, k])), False
        place = tuple(float(c.mid()) for c in middle)
        return NormalDerivative(
            k + 1, float(value.mid()), float(arb(value.rad()).upper()) + _rounding(value), place, proved
        )


def _rounding(value: arb) -> float:
    """What writing the middle of a ball as a float may change."""
    return float(abs(value - arb(float(value.mid()))).upper())


def _refined(derivatives: NormalDerivatives, middle: list[arb]) -> list[arb]:
    """Newton's method along the gradient on middles of balls."""
    for _ in range(4):
        local = derivatives.model.on(middle)
        value, gradient = local.value(derivatives.model.root), _gradient(derivatives, local)
        squared = sum((c * c for c in gradient), arb(0))
        if value is None or not squared > 0:
            break
        moved = [(c - value * slope / squared).mid() for c, slope in zip(middle, gradient, strict=True)]
        if not all(c.is_finite() for c in moved):
            break
        middle = moved
    return middle


def _gradient(derivatives: NormalDerivatives, local: Local) -> list[arb]:
    found = [local.value(node) for node in derivatives.gradient]
    return [arb(0, float("inf")) if value is None else value for value in found]


def breaks(
    derivatives: NormalDerivatives, starts: NDArray[np.float64], ends: NDArray[np.float64], cell: float
) -> NDArray[np.float64]:
    """Where the normal jumps between neighbouring points of the boundary: (n, dim), a point for each few cells.

    The tangents at both points meet near the break; from there each point is replaced by one on its own side,
    nearer to the break, until the two are one point with two normals.
    """
    wide = _turns(derivatives, starts, ends) > BROKEN
    starts, ends = starts[wide], ends[wide]
    places = (starts + ends) / 2
    for _ in range(APPROACHES if len(starts) else 0):
        centres = _crossings(derivatives, starts, ends)
        near = np.linalg.norm(centres - places, axis=1) <= 4 * cell
        centres = np.where(near[:, None], centres, (starts + ends) / 2)
        starts, first = onto_boundary(derivatives, centres + APPROACH * (starts - centres), cell)
        ends, second = onto_boundary(derivatives, centres + APPROACH * (ends - centres), cell)
        places = np.where((near & first & second)[:, None], (starts + ends) / 2, places)
    return thinned(places[_turns(derivatives, starts, ends) > STAYS], 4 * cell)


def _crossings(
    derivatives: NormalDerivatives, starts: NDArray[np.float64], ends: NDArray[np.float64]
) -> NDArray[np.float64]:
    """The points nearest to the middles at which the tangents (tangent planes) at both points meet."""
    normals = np.stack([derivatives.at(starts).normals, derivatives.at(ends).normals], axis=1)
    offsets = np.einsum("nij,nij->ni", normals, np.stack([starts, ends], axis=1))
    middles = (starts + ends) / 2
    rest = offsets - np.einsum("nij,nj->ni", normals, middles)
    found: NDArray[np.float64] = middles + np.einsum("nij,nj->ni", np.linalg.pinv(np.nan_to_num(normals)), rest)
    return found


def _turns(
    derivatives: NormalDerivatives, starts: NDArray[np.float64], ends: NDArray[np.float64]
) -> NDArray[np.float64]:
    """The angles between normals in degrees, 0 where there is none."""
    cosine = np.einsum("ij,ij->i", derivatives.at(starts).normals, derivatives.at(ends).normals)
    angles: NDArray[np.float64] = np.degrees(np.arccos(np.clip(np.nan_to_num(cosine, nan=1.0), -1, 1)))
    return angles


def thinned(points: NDArray[np.float64], distance: float) -> NDArray[np.float64]:
    """A point for each group of points nearer to each other than the distance."""
    kept: list[NDArray[np.float64]] = []
    for point in points:
        if not any(np.linalg.norm(point - other) <= distance for other in kept):
            kept.append(point)
    return np.array(kept, np.float64).reshape(len(kept), points.shape[1])
