"""Fairness of a general body: its principal curvatures are bounded by the verdict; the rest is numerical."""

from __future__ import annotations

import math
import warnings
from collections.abc import Mapping
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from rsym.errors import RsymWarning
from rsym.model.shape import Shape
from rsym.sampling.mesh import Mesh
from rsym.sampling.meshing import mesh
from rsym.verify.bodies.report import BodyReport
from rsym.verify.bodies.singular import Array
from rsym.verify.fairness.report import Bands, CurvatureBounds, FairnessReport, Measure, Peak
from rsym.verify.fairness.summits import Summits, summits
from rsym.verify.fairness.surfaces import Bent, Floats, Surface
from rsym.verify.local import Interval, Model

RESOLUTION = 96  # cells along the extent of the mesh; one of half as many tells the error of the measures
ROUNDING = 1e-12  # what is left of a variation that is zero, of the bending energy by area
STEPS = 4  # of Newton's method from the middle of a triangle to the surface
ON_SURFACE = 1e-6  # of a triangle: farther from the surface, as next to an edge, the curvature is that of another one
NAME = "principal curvature"
Place: TypeAlias = tuple[float, tuple[float, ...]]
NOWHERE: Place = (math.nan, ())


def body_fairness(shape: Shape, smoothness: BodyReport, values: Mapping[str, Interval]) -> FairnessReport:
    """The report on a body that `verify_smoothness` has judged by boxes in space."""
    surface = Surface(Model(shape, values))
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
    smoothness: BodyReport, body: Mesh, bent: Bent, smooth: NDArray[np.bool_], found: Summits
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


def _at(values: Floats, points: Array, index: int) -> Place:
    return float(values[index]), tuple(map(float, points[index]))


def _own(found: Summits, word: str) -> list[Place]:
    return [(one.curvature, one.point) for one in found.extrema if one.quantity.startswith(word)]


def _measures(surface: Surface, fine: Mesh, coarse: Mesh) -> dict[str, Measure]:
    """Over the triangles, which err by the square of their size: two meshes tell the error and take most of it away."""
    better, worse = (_sums(surface, body) for body in (fine, coarse))
    names = ("area", "bending_energy", "variation_energy", "volume")
    count = 4 if fine.status.closed and coarse.status.closed else 3
    found = {}
    for name, a, b in list(zip(names, better, worse, strict=True))[:count]:
        found[name] = Measure(a + (a - b) / 3, abs(a - b) / 3 + ROUNDING * better[1] / better[0])
    return found


def _sums(surface: Surface, body: Mesh) -> tuple[float, float, float, float]:
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
