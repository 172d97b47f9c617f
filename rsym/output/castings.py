"""A shape on three-dimensional axes, without a mesh: rays are cast at it by the axes' own projection."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from mpl_toolkits.mplot3d import Axes3D
from numpy.typing import NDArray

from rsym.arrays import Floats, Ints
from rsym.errors import RsymError
from rsym.model.shape import Shape
from rsym.output import axes3d
from rsym.output.bodies import FEATURE_WIDTH, Body
from rsym.output.brushes import Brush, brush_of, checked_colouring
from rsym.output.cameras import Viewport
from rsym.output.rendering import Scene, require_body, told_unseen
from rsym.output.shading import developed, unit
from rsym.output.sights import Probe, corners_of
from rsym.sampling.rays import Caster


class ShadedShape(Body):
    """A shape that rays are cast at anew, at the renderer's own resolution, whenever it is drawn."""

    def __init__(self, caster: Caster, points: Floats, brush: Brush, lines: bool) -> None:
        super().__init__(points, brush.scale, brush.label, brush.parts)
        self.caster, self.brush, self.lines = caster, brush, lines

    def _picture(self, axes: Axes3D, scale: float, point: float) -> tuple[Ints, NDArray[np.uint8]]:
        width = FEATURE_WIDTH * point * self.lines
        places = (axes3d.project(axes, self.points)[:, :2] - axes.bbox.min) * scale
        low = np.maximum(np.floor(places.min(axis=0) - width), 0).astype(np.int64)
        high = np.minimum(np.ceil(places.max(axis=0) + width), np.ceil(axes.bbox.size * scale)).astype(np.int64)
        columns, rows = np.maximum(high - low, 0).tolist()
        if not columns or not rows:
            return low, np.zeros((0, 0, 4), np.uint8)
        view = view_of(axes, corners_of(self.caster.bounds), (columns, rows), low, scale)
        scene = Scene(self.caster, view, ())
        sight, between = scene.shown(scene.seen())
        told_unseen(sight, between)
        canvas = scene.painted(sight, self.brush, width, between=between.pixels)
        return low, developed(canvas, None).reshape(rows, columns, 4)[::-1]


def view_of(axes: Axes3D, whole: Floats, size: tuple[int, int], low: Ints, scale: float) -> Viewport:
    """The projection of axes as a view of so many pixels, `scale` to one of the figure, from a corner of the axes on.

    Parallel rays begin before all points of the `whole`. The scales of the axes are taken for equal.
    """
    turn, _ = axes3d.camera(axes)
    directions = unit(turn)
    limits = np.array([axes.get_xlim(), axes.get_ylim(), axes.get_zlim()])
    middle = limits.mean(axis=1)
    step = float(np.ptp(limits, axis=1).max())
    # Straight lines across the line of sight have one scale, in perspective too.
    places = axes3d.project(axes, np.stack([middle, middle + step * directions[0]]))[:, :2]
    places = (places - axes.bbox.min) * scale - low - 0.5
    away = axes.get_proj()[3]
    length = float(np.linalg.norm(away[:3]))
    distance = float(away[:3] @ middle + away[3]) / length if length > 1e-12 * abs(away[3]) else None
    front = float(((whole - middle) @ directions[2]).max()) + 0.01 * step if distance is None else 0.0
    column, row = places[0].tolist()
    return Viewport(
        size,
        directions,
        middle,
        step / float(np.linalg.norm(places[1] - places[0])),
        distance,
        front,
        (column, size[1] - 1 - row),
    )


def shaded_shape(
    shape: Shape,
    colour: str,
    colour_by: Any,
    letters: Mapping[Any, float] | None,
    limits: tuple[float, float] | None,
    colour_map: str | None,
    *,
    lines: bool = True,
) -> ShadedShape:
    """A shape in space as an artist for three-dimensional axes."""
    require_body(shape)
    caster = Caster(shape, letters)
    probe = Probe.of(caster)
    if not any(len(sight.met) for sight in probe.sights):
        raise RsymError(
            "the body has no surface in its bounds", code="no-surface", remedy="look where it lies: rsym.extent"
        )
    name = checked_colouring(colour_by)
    brush = brush_of(name, probe.sights, lambda: probe, colour, limits, colour_map)
    return ShadedShape(caster, probe.around, brush, lines)
