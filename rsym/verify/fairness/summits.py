"""Extrema of curvatures on a surface: found among the vertices of a mesh, refined by Newton's method, not proved."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rsym.sampling.mesh import Mesh
from rsym.verify.fairness.report import Extremum
from rsym.verify.fairness.surfaces import QUANTITIES, Floats, Surface

MOST = 200  # candidates for one quantity, those farthest from the mean first
STEPS = 30
DIFFERENCE = 1e-5  # of the extent: central differences of an exact gradient are right to about 1e-9 of it
CONVERGED = 1e-11  # of the extent, the last step
CONSTANT = 1e-9  # of the largest curvature: a quantity that varies less is constant for floating point
# Second derivatives along the surface whose sizes differ more than this belong to extrema that fill a curve.
ISOLATED = 1e-4


# Of the extent: extrema closer are one; how far one may be from its place. Of the largest curvature: its value.
DISTINCT, RADIUS, ERROR = 1e-7, 1e-9, 1e-12


@dataclass(frozen=True)
class _Scale:
    """The size of the whole and the largest curvature."""

    extent: float
    curvature: float


@dataclass(frozen=True)
class Summits:
    """The extrema found, the quantities that look constant, and those with extrema that fill a curve."""

    extrema: tuple[Extremum, ...]
    constant: tuple[str, ...]
    ridges: tuple[str, ...]


def summits(surface: Surface, mesh: Mesh, marked: NDArray[np.bool_], extent: float) -> Summits:
    """The maxima and minima of the three quantities; `marked` are vertices at which the surface is smooth."""
    found = surface(mesh.vertices)
    marked = marked & np.isfinite(found.values).all(axis=1)
    if not marked.any():
        return Summits((), (), ())
    size = float(np.abs(found.values[marked]).max())
    extrema: list[Extremum] = []
    constant, ridges = [], []
    for number, name in enumerate(QUANTITIES):
        values = found.values[:, number]
        if np.ptp(values[marked]) <= CONSTANT * size:
            constant.append(name)
            continue
        candidates = _candidates(mesh, values, marked)
        reach = 4 * _spacing(mesh)
        points, isolated = _refined(surface, mesh.vertices[candidates], number, _Scale(extent, size), reach)
        if not isolated.all():
            ridges.append(name)
        extrema += _classified(surface, points[isolated], number, _Scale(extent, size))
    return Summits(tuple(extrema), tuple(constant), tuple(ridges))


def _spacing(mesh: Mesh) -> float:
    first = mesh.vertices[mesh.faces[:, 1]] - mesh.vertices[mesh.faces[:, 0]]
    return float(np.linalg.norm(first, axis=1).max())


def _candidates(mesh: Mesh, values: Floats, marked: NDArray[np.bool_]) -> NDArray[np.intp]:
    """Vertices whose value no neighbour exceeds, or none falls below; neighbours on an edge of the body count not."""
    ends = np.concatenate([mesh.faces[:, [0, 1]], mesh.faces[:, [1, 2]], mesh.faces[:, [2, 0]]])
    ends = np.concatenate([ends, ends[:, ::-1]])
    ends = ends[marked[ends].all(axis=1)]
    high, low = np.full(len(values), -np.inf), np.full(len(values), np.inf)
    np.maximum.at(high, ends[:, 0], values[ends[:, 1]])
    np.minimum.at(low, ends[:, 0], values[ends[:, 1]])
    (found,) = np.nonzero(marked & np.isfinite(high) & ((values >= high) | (values <= low)))
    away = np.abs(values[found] - np.mean(values[marked]))
    return np.asarray(found[np.argsort(-away, kind="stable")[:MOST]])


def _refined(
    surface: Surface, points: Floats, number: int, scale: _Scale, reach: float
) -> tuple[Floats, NDArray[np.bool_]]:
    """Zeros of offset*normal + gradient near the points; whether each is isolated."""
    start, step = points, np.full_like(points, np.inf)
    for _ in range(STEPS):
        residual, jacobian = _system(surface, points, number, scale)
        step = np.einsum("nij,nj->ni", np.linalg.pinv(jacobian, rcond=1e-9), residual)
        length = np.linalg.norm(step, axis=1, keepdims=True)
        points = points - step * np.minimum(1.0, reach / 4 / np.maximum(length, 1e-300))
    _, jacobian = _system(surface, points, number, scale)
    good = (np.linalg.norm(step, axis=1) < CONVERGED * scale.extent) & (np.linalg.norm(points - start, axis=1) < reach)
    points, jacobian = points[good], jacobian[good]
    sizes = np.abs(_bent(surface, points, jacobian))
    return points, np.asarray(sizes.min(axis=1, initial=np.inf) > ISOLATED * sizes.max(axis=1, initial=0.0))


def _system(surface: Surface, points: Floats, number: int, scale: _Scale) -> tuple[Floats, Floats]:
    """offset*k**3*normal + gradient of the quantity, of one unit, and its Jacobian by central differences.

    With the largest curvature k the offset outweighs the turn of the gradient, so that steps first lead to the surface.
    """

    def residual(at: Floats) -> Floats:
        found = surface(at)
        away = (found.offset * scale.curvature**3)[:, None] * found.normal
        result: Floats = np.nan_to_num(away + found.gradients[:, number], posinf=0.0, neginf=0.0)
        return result

    h = DIFFERENCE * scale.extent
    columns = [(residual(points + h * axis) - residual(points - h * axis)) / (2 * h) for axis in np.eye(3)]
    return residual(points), np.stack(columns, axis=-1)


def _bent(surface: Surface, points: Floats, jacobian: Floats) -> Floats:
    """The second derivatives of the quantity along the surface, in two directions (n, 2)."""
    frame = surface(points).directions
    form = np.einsum("nai,nij,nbj->nab", frame, jacobian, frame)
    values: Floats = np.linalg.eigvalsh((form + form.transpose(0, 2, 1)) / 2)
    return values


def _classified(surface: Surface, points: Floats, number: int, scale: _Scale) -> list[Extremum]:
    """The points that are distinct, with kind and value."""
    values = surface(points).values[:, number]
    curved = _bent(surface, points, _system(surface, points, number, scale)[1])
    result: list[Extremum] = []
    for point, value, (low, high) in zip(points, values, curved, strict=True):
        known = any(np.linalg.norm(point - other.point) < DISTINCT * scale.extent for other in result)
        if known or low <= 0 <= high:  # of saddles the mesh shows but some
            continue
        kind, place = "maximum" if high < 0 else "minimum", tuple(map(float, point))
        errors = RADIUS * scale.extent, ERROR * scale.curvature
        result.append(Extremum(kind, QUANTITIES[number], place, errors[0], float(value), errors[1], False))
    return result
