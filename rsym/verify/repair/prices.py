"""What a change costs: how far the boundary moves, what is gained or lost inside, curvature, normalisation."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from rsym.backends.kernel import compile as compile_shape
from rsym.errors import RsymError
from rsym.model.shape import Shape
from rsym.reports.numbers import at_most, number
from rsym.sampling.boundaries import Boundary, boundary, distance
from rsym.sampling.distances import distance_to_mesh
from rsym.sampling.mesh import Mesh
from rsym.sampling.meshing import mesh
from rsym.sampling.windows import bounds_or_extent
from rsym.verify.answers.report import SmoothnessReport
from rsym.verify.repair.anatomy import Verdict
from rsym.verify.revolution import meridian

NORMALISED = 1e-3  # the deviation of |grad omega| from 1 that counts as none, that of verify_normalisation
CELLS = 96  # of meshes of bodies that do not turn about an axis


@dataclass(frozen=True)
class Price:
    """What is paid for a repair.

    Attributes
    ----------
    distance : float
        The largest distance between both boundaries, by Hausdorff; numerical.
    volume : float
        The relative change of the volume inside, in the plane of the area; numerical, NaN if the boundary has ends.
    curvature_bound : float
        No curvature of the new boundary is larger in size; proved.
    normalisation : str
        "kept", "lost", "gained" or "none": whether |grad omega| = 1 on the boundary; numerical.
    deviations : pair of float
        The largest | |grad omega| - 1 | found on the boundary before and after; numerical.
    dimension : int
        2 if `volume` is an area.

    Examples
    --------
    >>> print(Price(0.0079, 0.002, 11032.7, "none", (0.32, 0.32), 2))
    moved by up to 0.0079, area +0.2 %, curvature at most 1.104e+04, not normalised before or after
    """

    distance: float
    volume: float
    curvature_bound: float
    normalisation: str
    deviations: tuple[float, float]
    dimension: int

    def __str__(self) -> str:
        return ", ".join(self.words)

    @property
    def words(self) -> tuple[str, str, str, str]:
        """Distance, volume, curvature and normalisation."""
        what = "area" if self.dimension == 2 else "volume"
        normalised = {"none": "not normalised before or after"}.get(self.normalisation, "")
        return (
            "nothing to measure from" if math.isinf(self.distance) else f"moved by up to {number(self.distance, 3)}",
            f"{what} unknown" if math.isnan(self.volume) else f"{what} {100 * self.volume:+.2g} %",
            f"curvature at most {at_most(self.curvature_bound)}",
            normalised or f"normalisation {self.normalisation}",
        )


@dataclass(frozen=True, eq=False)
class Measured:
    """The boundary of a shape, sampled; what it holds, NaN if it has ends; and the deviation of |grad omega| from 1.

    `surface` is None where a body has none.
    """

    surface: Boundary | Mesh | None
    volume: float
    deviation: float
    dimension: int


def measured(shape: Shape, report: Verdict) -> Measured:
    """Sample the boundary of a shape: a body of revolution by its meridian, another one by a mesh."""
    body = isinstance(report, SmoothnessReport) and report.body
    if shape.dimension == 3 and not body:
        return _meshed(shape)
    plane = meridian(shape)[0] if body else shape
    lines = boundary(plane, bounds_or_extent(plane, None))
    volume = lines.volume() if body else lines.area()
    return Measured(lines, volume if lines.closed else math.nan, lines.deviation, shape.dimension)


def _meshed(shape: Shape) -> Measured:
    try:
        surface = mesh(shape, CELLS)
    except RsymError as error:
        if error.code != "no-surface":
            raise
        return Measured(None, math.nan, math.nan, 3)
    gradient = compile_shape(shape, ("gradient",))(*surface.vertices.T)["gradient"]
    deviations = np.abs(np.linalg.norm(gradient, axis=1) - 1)
    deviation = float(np.nanmax(deviations)) if np.isfinite(deviations).any() else math.nan
    status = surface.status
    return Measured(surface, math.nan if status.clipped else status.volume, deviation, 3)


def price(before: Measured, after: Measured, report: Verdict) -> Price:
    """The price of the change from one boundary to another, of which a verdict is given."""
    was, stays = before.deviation <= NORMALISED, after.deviation <= NORMALISED
    words = {(True, True): "kept", (True, False): "lost", (False, True): "gained", (False, False): "none"}
    return Price(
        distance=_distance(before.surface, after.surface),
        volume=after.volume / before.volume - 1 if before.volume > 0 else math.nan,
        curvature_bound=report.curvature_bound,
        normalisation=words[was, stays],
        deviations=(before.deviation, after.deviation),
        dimension=before.dimension,
    )


def _distance(first: Boundary | Mesh | None, second: Boundary | Mesh | None) -> float:
    if first is None or second is None:
        return math.inf
    if isinstance(first, Boundary) and isinstance(second, Boundary):
        return distance(first, second)
    assert isinstance(first, Mesh)
    assert isinstance(second, Mesh)
    there, back = distance_to_mesh(first.vertices, second), distance_to_mesh(second.vertices, first)
    return float(max(there.max(), back.max()))
