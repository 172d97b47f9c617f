"""Portraits: one small picture of any shape, in the plane or in space, signed or not."""

from __future__ import annotations

import warnings
from typing import Any, TypeAlias

import numpy as np
from matplotlib.artist import Artist
from matplotlib.figure import Figure, SubFigure

from rsym.backends.kernel import compile
from rsym.errors import RsymWarning, warn
from rsym.model.shape import Bounds, Shape
from rsym.output import axes3d
from rsym.output.looks import PLAIN, Look
from rsym.output.panels import draw_levels
from rsym.output.shading import AZIMUTH, ELEVATION
from rsym.output.surfaces import ShadedMesh, plot_mesh
from rsym.sampling.blanks import missing_boundary
from rsym.sampling.contours import trace
from rsym.sampling.extent import bounds_or_extent
from rsym.sampling.lattice import lattice_over
from rsym.sampling.meshing import mesh
from rsym.sampling.plane import plane_sampler

Place: TypeAlias = tuple[float, float, float, float]

LEVEL_CELLS = 160  # along the longest side of a plane picture; a few milliseconds
MARGIN = 5.0  # points round a body
ROOM = 0.1  # of the longest side, seen round the bounds of a plane shape
PROBES = 24  # along the longest side, to see whether a field is negative anywhere
# Half the width of a curve drawn as a stroke, and the radius of one drawn as a tube, as shares of the longest side.
STROKE, TUBE = 0.01, 0.02


def draw_portrait(
    shape: Shape,
    figure: Figure | SubFigure,
    place: Place = (0.0, 0.0, 1.0, 1.0),
    *,
    resolution: int = 120,
    bounds: Any = None,
    elevation: float = ELEVATION,
    azimuth: float = AZIMUTH,
    look: Look = PLAIN,
) -> Artist:
    """Draw a shape into a part of a figure: level lines in the plane, a shaded body in space.

    The boundary in the plane is a heavy line. A field that is nowhere negative has no inside: the curve on which it
    is zero is drawn as a stroke, in space as a thin tube. What leaves the bounds ends there.

    Parameters
    ----------
    place : four numbers
        Left, bottom, width and height as shares of the figure.
    resolution : int
        Cells along the longest side of a body.
    bounds : optional
        Instead of those of the shape; without either its extent is found.
    elevation, azimuth : float
        As for `plot_mesh`.
    look : Look
        Of level lines.

    Examples
    --------
    >>> import matplotlib.figure, rsym
    >>> from rsym import x, y
    >>> disc = rsym.Shape(1 - x**2 - y**2, (x, y), bounds=((-2, 2), (-2, 2)))
    >>> type(draw_portrait(disc, matplotlib.figure.Figure())).__name__
    'QuadContourSet'
    """
    box = bounds_or_extent(shape, bounds)
    if shape.dimension == 2:
        return _draw_levels(shape, box, figure, place, look)
    axes = axes3d.add_axes(figure, place)
    with warnings.catch_warnings():
        # Bodies without end are cut on purpose, and a small picture shows no more than its cells do.
        warnings.simplefilter("ignore", RsymWarning)
        body = mesh(_thickened(shape, box), resolution)
    artist = plot_mesh(body, ax=axes, elevation=elevation, azimuth=azimuth)
    axes.set_axis_off()
    fill(figure, artist, place)
    return artist


def fill(figure: Figure | SubFigure, artist: ShadedMesh, place: Place) -> None:
    """Enlarge the axes about the body until it fills the place."""
    axes: Any = artist.axes
    page = np.tile(figure.bbox.size, 2)
    left, bottom, width, height = np.array(place) * page
    body = artist.get_window_extent()
    room = 2 * MARGIN * figure.dpi / 72
    growth = min((width - room) / body.width, (height - room) / body.height)
    middle = np.array([left + width / 2, bottom + height / 2])
    corner = middle - growth * (np.array([body.x0 + body.x1, body.y0 + body.y1]) / 2 - axes.bbox.min)
    axes.set_position(np.concatenate([corner, growth * axes.bbox.size]) / page)


def _draw_levels(shape: Shape, box: Bounds, figure: Figure | SubFigure, place: Place, look: Look) -> Artist:
    """Level lines that fill the place."""
    width, height = np.array(place[2:]) * figure.bbox.size
    sampler = plane_sampler(shape, "value", resolution=LEVEL_CELLS, bounds=_view(box, width / height))
    values = sampler.values()
    unsigned = np.nanmin(values) >= 0
    boundary = () if unsigned else trace(sampler, 0.0, values=values)
    if remark := missing_boundary(shape, sampler, values, boundary):
        warn(remark)
    ax = figure.add_axes(place)
    artist = draw_levels(ax, sampler, values, look.levels_of(values, "value"), boundary, look)
    u, v = sampler.lattice.axis(0), sampler.lattice.axis(1)
    if unsigned:
        ax.contourf(u, v, values.T, levels=[-1.0, STROKE * _longest(box)], colors="black")
    ax.set(xlim=(u[1], u[-2]), ylim=(v[1], v[-2]), aspect="equal")
    ax.set_axis_off()
    return artist


def _view(box: Bounds, proportion: float) -> Bounds:
    """A box of this width over height round another, with some room."""
    middle = [(low + high) / 2 for low, high in box]
    sides = [high - low + 2 * ROOM * _longest(box) for low, high in box]
    width = max(sides[0], sides[1] * proportion)
    halves = (width / 2, width / proportion / 2)
    return tuple((place - half, place + half) for place, half in zip(middle, halves, strict=True))


def _thickened(shape: Shape, box: Bounds) -> Shape:
    """The shape; a tube round the curve where it is nowhere negative."""
    values = compile(shape)(*lattice_over(box, PROBES).open_axes())["value"]
    if np.nanmin(values) < 0:
        return shape.replace(bounds=box)
    radius = TUBE * _longest(box)
    wider = tuple((low - 2 * radius, high + 2 * radius) for low, high in box)
    return shape.replace(expression=radius - shape.expression, bounds=wider)


def _longest(box: Bounds) -> float:
    return max(high - low for low, high in box)
