"""Fairness of a general body: its principal curvatures are bounded by the verdict; the rest is numerical.

Their gradients along the surface come from the third derivatives of omega. With unit tangent vectors u, v, w, the
normal N = grad F/g that points inwards and II(u, v) = -F_uv/g, the derivative of the second fundamental form is

    C(u, v, w) = -(F_uvw + II(u, v) F_wN + II(v, w) F_uN + II(w, u) F_vN)/g,

symmetric by Codazzi's equations, and the derivative of a principal curvature k with the direction e along v is
C(e, e, v).
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Mapping
from dataclasses import dataclass
from itertools import combinations_with_replacement
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from rsym.arrays import Floats
from rsym.backends.kernel import run_in_blocks
from rsym.backends.registry import make_function
from rsym.errors import RsymWarning
from rsym.model.shape import Shape
from rsym.program.expansion import expand
from rsym.program.program import FLOAT64
from rsym.sampling.mesh import Mesh
from rsym.sampling.meshing import mesh
from rsym.verify.answers.body_report import BodyReport
from rsym.verify.boxes.local import Interval, Model
from rsym.verify.fairness.report import Bands, CurvatureBounds, Extremum, FairnessReport, Measure, Peak

QUANTITIES = ("smaller principal curvature", "larger principal curvature", "mean curvature")
RESOLUTION = 96  # cells along the extent of the mesh; one of half as many tells the error of the measures
ROUNDING = 1e-12  # what is left of a variation that is zero, of the bending energy by area
STEPS = 4  # of Newton's method from the middle of a triangle to the surface
ON_SURFACE = 1e-6  # of a triangle: farther from the surface, as next to an edge, the curvature is that of another one
NAME = "principal curvature"
Place: TypeAlias = tuple[float, tuple[float, ...]]
NOWHERE: Place = (math.nan, ())
# Extrema of curvatures on a surface: found among the vertices of a mesh, refined by Newton's method, not proved.
MOST = 200  # candidates for one quantity, those farthest from the mean first
NEWTON_STEPS = 30
DIFFERENCE = 1e-5  # of the extent: central differences of an exact gradient are right to about 1e-9 of it
CONVERGED = 1e-11  # of the extent, the last step
CONSTANT = 1e-9  # of the largest curvature: a quantity that varies less is constant for floating point
# Second derivatives along the surface whose sizes differ more than this belong to extrema that fill a curve.
ISOLATED = 1e-4
# Of the extent: extrema closer are one; how far one may be from its place. Of the largest curvature: its value.
DISTINCT, RADIUS, ERROR = 1e-7, 1e-9, 1e-12


def body_fairness(shape: Shape, smoothness: BodyReport, values: Mapping[str, Interval]) -> FairnessReport:
    """The report on a body that `verify_smoothness` has judged by boxes in space."""
    surface = CurvedSurface(Model(shape, values))
    letters = {name: float(low) for name, (low, _) in values.items()}
    bounds = tuple((float(low), float(high)) for low, high in smoothness.cover.bounds)
    extent = max(high - low for low, high in bounds)
    with warnings.catch_warnings(record=True) as unresolved:
        warnings.simplefilter("always", RsymWarning)
        fine, coarse = (mesh(shape, cells, bounds=bounds, letters=letters) for cells in (RESOLUTION, RESOLUTION // 2))
    smooth = _smooth_vertices(fine, smoothness, extent / RESOLUTION)
    bent = surface(fine.vertices)
    smooth &= np.isfinite(bent.values).all(axis=1) & np.isfinite(bent.gradients).all(axis=(1, 2))
    found = summits(surface, fine, smooth, extent)
    return FairnessReport(
        kind="body",
        coordinates=tuple(symbol.name for symbol in shape.coordinates),
        smoothness=smoothness,
        curvatures=(_bounds(smoothness, fine, bent, smooth, found),),
        extrema=found.extrema,
        inflections=(),
        complete=False,
        constant=(False,),
        measures=_measures(surface, fine, coarse),
        profiles=(),
        bands=Bands(np.empty((0, 3, 2)), np.empty((0, 1, 2))),
        statements=_statements(smoothness, found, bool(unresolved)),
    )


def _smooth_vertices(body: Mesh, smoothness: BodyReport, rim: float) -> NDArray[np.bool_]:
    """The vertices that lie in no box, and not next to one, in which sheets meet or nothing is proved."""
    marked = np.ones(len(body.vertices), bool)
    for box in np.concatenate([smoothness.cover.joined, smoothness.cover.undecided]):
        inside = (body.vertices >= box[:, 0] - rim) & (body.vertices <= box[:, 1] + rim)
        marked &= ~inside.all(axis=1)
    return marked


def _bounds(
    smoothness: BodyReport, body: Mesh, bent: SurfaceBending, smooth: NDArray[np.bool_], found: Summits
) -> CurvatureBounds:
    """The bounds that are proved, with what is attained at a vertex or an extremum."""
    low, high = smoothness.curvatures
    values, points = bent.values[smooth, :2], body.vertices[smooth]
    variation = np.linalg.norm(bent.gradients[smooth, :2], axis=2).max(axis=1, initial=0.0)
    least = greatest = NOWHERE
    if len(points):
        least = min([_at(values[:, 0], points, int(values[:, 0].argmin())), *_own(found, "smaller")])
        greatest = max([_at(values[:, 1], points, int(values[:, 1].argmax())), *_own(found, "larger")])
    steep = _at(variation, points, int(variation.argmax())) if len(points) else NOWHERE
    return CurvatureBounds(
        NAME,
        Peak(low, *least, proved=math.isfinite(low)),
        Peak(high, *greatest, proved=math.isfinite(high)),
        Peak(math.inf, *steep, proved=False),
    )


def _at(values: Floats, points: Floats, index: int) -> Place:
    return float(values[index]), tuple(map(float, points[index]))


def _own(found: Summits, word: str) -> list[Place]:
    return [(one.curvature, one.point) for one in found.extrema if one.quantity.startswith(word)]


def _measures(surface: CurvedSurface, fine: Mesh, coarse: Mesh) -> dict[str, Measure]:
    """Over the triangles, which err by the square of their size: two meshes tell the error and take most of it away."""
    better, worse = (_sums(surface, body) for body in (fine, coarse))
    names = ("area", "bending_energy", "variation_energy", "volume")
    count = 4 if fine.status.closed and coarse.status.closed else 3
    found = {}
    for name, a, b in list(zip(names, better, worse, strict=True))[:count]:
        found[name] = Measure(a + (a - b) / 3, abs(a - b) / 3 + ROUNDING * better[1] / better[0])
    return found


def _sums(surface: CurvedSurface, body: Mesh) -> tuple[float, float, float, float]:
    """With the curvatures below the middles of the triangles: a vertex may lie on an edge of the body."""
    corners = body.vertices[body.faces]
    areas = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1) / 2
    points = corners.mean(axis=1)
    reach = np.linalg.norm(corners[:, 1] - corners[:, 0], axis=1)
    for _ in range(STEPS):
        near = surface(points)
        offset = np.clip(np.nan_to_num(near.offset), -reach, reach)
        points = points - offset[:, None] * np.nan_to_num(near.normal)
    with np.errstate(all="ignore"):
        bent = surface(points)
        energies = [np.square(bent.values[:, :2]).sum(axis=1), np.square(bent.gradients[:, :2]).sum(axis=(1, 2))]
        areas_on = np.where(np.abs(bent.offset) < ON_SURFACE * reach, areas, 0.0)
    bending, variation = (float(np.nansum(areas_on * part)) for part in energies)
    return float(areas.sum()), bending, variation, float(body.status.volume)


def _statements(smoothness: BodyReport, found: Summits, unresolved: bool) -> tuple[tuple[str, bool], ...]:
    result = []
    if all(map(math.isfinite, smoothness.curvatures)):
        result.append(("no principal curvature lies outside the bounds where the boundary is regular", True))
    result.append(("the variation and the extrema are those found on a mesh", False))
    if unresolved:
        result.append(("what is finer than the mesh has no part in them", False))
    for name in found.constant:
        result.append((f"the {name} is constant to nine digits", False))
    for name in found.ridges:
        result.append((f"extrema of the {name} that fill curves are not listed", False))
    return tuple(result)


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


def summits(surface: CurvedSurface, mesh: Mesh, marked: NDArray[np.bool_], extent: float) -> Summits:
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
        first = mesh.vertices[mesh.faces[:, 1]] - mesh.vertices[mesh.faces[:, 0]]
        reach = 4 * float(np.linalg.norm(first, axis=1).max())
        points, isolated = _refined(surface, mesh.vertices[candidates], number, _Scale(extent, size), reach)
        if not isolated.all():
            ridges.append(name)
        extrema += _classified(surface, points[isolated], number, _Scale(extent, size))
    return Summits(tuple(extrema), tuple(constant), tuple(ridges))


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
    surface: CurvedSurface, points: Floats, number: int, scale: _Scale, reach: float
) -> tuple[Floats, NDArray[np.bool_]]:
    """Zeros of offset*normal + gradient near the points; whether each is isolated."""
    start, step = points, np.full_like(points, np.inf)
    for _ in range(NEWTON_STEPS):
        residual, jacobian = _system(surface, points, number, scale)
        step = np.einsum("nij,nj->ni", np.linalg.pinv(jacobian, rcond=1e-9), residual)
        length = np.linalg.norm(step, axis=1, keepdims=True)
        points = points - step * np.minimum(1.0, reach / 4 / np.maximum(length, 1e-300))
    _, jacobian = _system(surface, points, number, scale)
    good = (np.linalg.norm(step, axis=1) < CONVERGED * scale.extent) & (np.linalg.norm(points - start, axis=1) < reach)
    points, jacobian = points[good], jacobian[good]
    sizes = np.abs(_bent(surface, points, jacobian))
    return points, np.asarray(sizes.min(axis=1, initial=np.inf) > ISOLATED * sizes.max(axis=1, initial=0.0))


def _system(surface: CurvedSurface, points: Floats, number: int, scale: _Scale) -> tuple[Floats, Floats]:
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


def _bent(surface: CurvedSurface, points: Floats, jacobian: Floats) -> Floats:
    """The second derivatives of the quantity along the surface, in two directions (n, 2)."""
    frame = surface(points).directions
    form = np.einsum("nai,nij,nbj->nab", frame, jacobian, frame)
    values: Floats = np.linalg.eigvalsh((form + form.transpose(0, 2, 1)) / 2)
    return values


def _classified(surface: CurvedSurface, points: Floats, number: int, scale: _Scale) -> list[Extremum]:
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


class CurvedSurface:
    """The surface omega = 0 with what bends it, at any points near it."""

    def __init__(self, model: Model) -> None:
        self._places = [index for order in range(4) for index in combinations_with_replacement(range(3), order)]
        nodes = {}
        for index in self._places:
            node = model.root
            for axis in index:
                node = model.gradient(node)[axis]
            nodes[str(index)] = node
        program = model.builder.program(nodes)
        self._function = make_function(expand(program), "numpy", FLOAT64)
        self._letters = [float(model.letters[name][0]) for name in program.letters]

    def __call__(self, points: Floats) -> SurfaceBending:
        """What is known at points (n, 3)."""
        out = np.empty((len(self._places), len(points)))
        with np.errstate(all="ignore"):
            run_in_blocks(self._function, list(points.T), self._letters, out, 1)
            return SurfaceBending(dict(zip(self._places, out, strict=True)), len(points))


class SurfaceBending:
    """Offset from the surface, normal, the three `QUANTITIES` (n, 3) and their gradients along it (n, 3, 3)."""

    def __init__(self, partials: dict[tuple[int, ...], Floats], count: int) -> None:
        def tensor(order: int) -> Floats:
            indices = np.ndindex(*(3,) * order)
            rows = [partials[tuple(sorted(index))] for index in indices]
            return np.stack(rows, axis=-1).reshape(count, *(3,) * order)

        gradient, hessian, third = tensor(1), tensor(2), tensor(3)
        slope = np.linalg.norm(gradient, axis=1)
        self.normal = gradient / slope[:, None]
        self.offset = partials[()] / slope
        frame = _frame(self.normal)
        form = -np.einsum("nai,nij,nbj->nab", frame, hessian, frame) / slope[:, None, None]
        good = np.isfinite(form).all(axis=(1, 2))
        values, vectors = np.linalg.eigh(np.where(good[:, None, None], form, 0.0))
        self.directions = np.einsum("nab,nai->nbi", vectors, frame)
        mixed = np.einsum("nai,nij,nj->na", self.directions, hessian, self.normal)
        slopes = np.empty((count, 2, 2))
        for k in range(2):
            for along in range(2):
                e, v = self.directions[:, k], self.directions[:, along]
                bent = np.einsum("nijk,ni,nj,nk->n", third, e, e, v) + values[:, k] * mixed[:, along]
                if k == along:
                    bent += 2 * values[:, k] * mixed[:, k]
                slopes[:, k, along] = -bent / slope
        gradients = np.einsum("nka,nai->nki", slopes, self.directions)
        self.values = np.concatenate([values, values.mean(axis=1, keepdims=True)], axis=1)
        self.gradients = np.concatenate([gradients, gradients.mean(axis=1, keepdims=True)], axis=1)
        self.values[~good] = np.nan


def _frame(normal: Floats) -> Floats:
    """Two unit vectors (n, 2, 3) across each normal."""
    least = np.eye(3)[np.abs(np.nan_to_num(normal)).argmin(axis=1)]
    first = np.cross(normal, least)
    first /= np.linalg.norm(first, axis=1, keepdims=True)
    return np.stack([first, np.cross(normal, first)], axis=1)
