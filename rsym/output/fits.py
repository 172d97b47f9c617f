"""Pictures of letters and data: points about a fitted boundary by their residuals, the speed of a boundary."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from matplotlib import colormaps
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.collections import LineCollection
from matplotlib.colors import Colormap, Normalize

from rsym.arrays import Floats
from rsym.errors import RsymError
from rsym.model.bounding import hull
from rsym.model.shape import Bounds
from rsym.output.axes3d import Bar
from rsym.output.bodies import show
from rsym.output.ink import dots
from rsym.output.paints import beyond, checked_limits, checked_map, coat_of, one_colour, robust_limits
from rsym.output.pictures import require_axes, require_report
from rsym.output.shading import AZIMUTH, BODY, ELEVATION, decode
from rsym.output.surfaces import ShadedMesh
from rsym.reports.words import listed
from rsym.sampling.fit_report import Fit
from rsym.sampling.level_lines import level_lines
from rsym.sampling.meshing import mesh
from rsym.sampling.sensitivity import Sensitivity
from rsym.sampling.windows import bounds_or_extent

MARGIN = 1 / 8  # of the larger side of the box around the points, shown around it
CELLS = {2: 400, 3: 96}  # along the longest side
DOT, LEFT_OUT = 3.2, "#7a7f87"  # points; the colour of those without a residual
HIDDEN = 0.35  # of the ink of points behind the body
TEETH, LONGEST = 160, 0.12  # of a boundary that moves, and the longest as a share of the picture's diagonal
RESIDUAL = "residual, positive inside"


def plot_fit(
    fit: Fit,
    *,
    ax: Any = None,
    limits: tuple[float, float] | None = None,
    colour_map: str | None = None,
    elevation: float | None = None,
    azimuth: float | None = None,
    resolution: int | None = None,
) -> Artist:
    """The fitted boundary, and the measured points coloured by their residuals; those without one are grey.

    In the plane, or in the plane of a section, the boundary is a line; in space it is a shaded body, and points that
    it hides shine through. A silhouette is looked at from where it was seen.

    Parameters
    ----------
    fit : Fit
        What `fit` has found.
    ax : matplotlib axes, optional
        Where to draw, three-dimensional axes for a body; without it a new figure with a colour bar is made.
    limits : pair of numbers, optional
        The residuals at the ends of the colours; without it those that 2 % of the points are beyond, on both sides.
    colour_map : str, optional
        A name that matplotlib knows; without it ``coolwarm`` for limits about zero.
    elevation, azimuth : float, optional
        The direction of the eye in degrees, as for `plot_mesh`.
    resolution : int, optional
        Cells along the longest side: 400 in the plane, 96 in space.

    Returns
    -------
    Artist
        The points, or the body that they stand on.

    Raises
    ------
    RsymError
        For what is no fit, or axes of another dimension.

    Examples
    --------
    >>> import matplotlib.figure, rsym, sympy as sp
    >>> disc = rsym.disc(sp.Symbol("r"), letters={"r": 1})
    >>> found = rsym.fit(disc, [[2, 0], [0, 2.1], [-1.9, 0], [0, -2]], letters=["r"])
    >>> drawn = plot_fit(found, ax=matplotlib.figure.Figure().add_subplot(), limits=(-0.1, 0.1))
    >>> drawn.get_array().round(2).tolist()
    [-0.0, -0.1, 0.1, -0.0]
    """
    require_report(fit, Fit, "rsym.fit(shape, points, letters)")
    known = np.isfinite(fit.residuals)
    scale = _scale(fit.residuals, limits, colour_map)
    if fit.shape.dimension == 2 or fit.section:
        return _plane_fit(fit, ax, scale, known, resolution or CELLS[2])
    body_bounds = _bounds_of_body(fit)
    points, eye = fit.points, (ELEVATION, AZIMUTH)
    if fit.silhouette is not None:
        direction = np.array(fit.silhouette)
        points = _in_the_middle(points, direction, body_bounds)
        eye = (float(np.degrees(np.arcsin(direction[2]))), float(np.degrees(np.arctan2(direction[1], direction[0]))))
    body = mesh(fit.shape, resolution or CELLS[3], bounds=body_bounds)
    colours: Floats = decode(scale.to_rgba(fit.residuals[known])[:, :3])
    strokes = [*dots(points[known], colours, DOT, HIDDEN), *dots(points[~known], LEFT_OUT, DOT, HIDDEN)]
    artist = ShadedMesh(body, one_colour(BODY), strokes=strokes, bars=[Bar(scale, RESIDUAL)])
    return show(artist, ax, eye[0] if elevation is None else elevation, eye[1] if azimuth is None else azimuth)


def _plane_fit(fit: Fit, ax: Axes | None, scale: ScalarMappable, known: Any, cells: int) -> Artist:
    alone = ax is None
    if ax is None:
        import matplotlib.pyplot

        _, ax = matplotlib.pyplot.subplots(figsize=_page(fit.points), layout="compressed")
    require_axes(ax)
    lines = level_lines(fit.shape, resolution=cells, bounds=_around(fit.points), section=fit.section)
    ax.add_collection(LineCollection(list(lines), colors="black", linewidths=1.4, zorder=2))
    x, y = fit.points.T
    ax.scatter(x[~known], y[~known], s=DOT**2, c=LEFT_OUT, marker="x", zorder=3)
    drawn = ax.scatter(
        x[known],
        y[known],
        c=fit.residuals[known],
        cmap=scale.get_cmap(),
        vmin=scale.get_clim()[0],
        vmax=scale.get_clim()[1],
        s=2 * DOT**2,
        edgecolors="0.3",
        linewidths=0.3,
        zorder=4,
    )
    names = [symbol.name for symbol in fit.shape.coordinates if symbol.name not in (fit.section or {})]
    ax.set(aspect="equal", xlabel=f"${names[0]}$", ylabel=f"${names[1]}$")
    ax.set_title(f"{listed(list(fit.letters))} from {len(fit.points)} points", fontsize=11)
    if alone:
        ax.figure.colorbar(drawn, ax=ax, shrink=0.8).set_label(RESIDUAL)
    return drawn


def plot_sensitivity(
    found: Sensitivity,
    *,
    ax: Any = None,
    limits: tuple[float, float] | None = None,
    colour_map: str | None = None,
    elevation: float = ELEVATION,
    azimuth: float = AZIMUTH,
) -> Artist:
    """The boundary coloured by the speed at which it moves outwards when the letter grows.

    In space the surface is; in the plane teeth stand on the boundary where it goes, as long as it is fast.

    Parameters
    ----------
    found : Sensitivity
        What `sensitivity` has found.
    ax : matplotlib axes, optional
        Where to draw, three-dimensional axes for a body; without it a new figure with a colour bar is made.
    limits : pair of numbers, optional
        The speeds at the ends of the colours.
    colour_map : str, optional
        A name that matplotlib knows; without it ``coolwarm`` for limits about zero, otherwise ``viridis``.
    elevation, azimuth : float
        The direction of the eye in degrees, as for `plot_mesh`.

    Returns
    -------
    Artist
        The teeth, or the body.

    Raises
    ------
    RsymError
        For what is no sensitivity, or axes of another dimension.

    Examples
    --------
    >>> import matplotlib.figure, rsym, sympy as sp
    >>> found = rsym.sensitivity(rsym.disc(sp.Symbol("r"), letters={"r": 2}), "r", resolution=64)
    >>> drawn = plot_sensitivity(found, ax=matplotlib.figure.Figure().add_subplot())
    >>> 150 < len(drawn.get_segments()) < 170
    True
    """
    require_report(found, Sensitivity, "rsym.sensitivity(shape, letter)")
    label = f"speed outwards to a unit of {found.letter}"
    if found.shape.dimension == 3:
        values = np.asarray(found.values)
        coat = coat_of(found.mesh, found.mesh.normals, BODY, values, None, None, limits, colour_map)
        return show(ShadedMesh(found.mesh, replace(coat, label=label)), ax, elevation, azimuth)
    chords = [np.stack([line[:-1], line[1:]], axis=1) for line in found.lines]
    pieces = np.concatenate([np.empty((0, 2, 2)), *chords])
    alone = ax is None
    if ax is None:
        import matplotlib.pyplot

        _, ax = matplotlib.pyplot.subplots(figsize=_page(pieces.reshape(-1, 2)), layout="compressed")
    require_axes(ax)
    speed = np.concatenate([np.empty(0), *(one.mean(axis=1) for one in found.values)])
    scale = _scale(speed, limits, colour_map)
    look: dict[str, Any] = {"cmap": scale.get_cmap(), "norm": scale.norm}
    ax.add_collection(LineCollection(list(pieces), array=speed, linewidths=2.6, capstyle="round", zorder=3, **look))
    teeth = _teeth(pieces, speed)
    drawn = LineCollection(list(teeth[0]), array=teeth[1], linewidths=0.9, zorder=2, **look)
    ax.add_collection(drawn)
    ax.autoscale_view()
    names = [symbol.name for symbol in found.shape.coordinates]
    ax.set(aspect="equal", xlabel=f"${names[0]}$", ylabel=f"${names[1]}$")
    if alone:
        ax.figure.colorbar(drawn, ax=ax, shrink=0.8).set_label(label)
    return drawn


def _teeth(pieces: Floats, speed: Floats) -> tuple[Floats, Floats]:
    """Teeth at even distances along the boundary, from it to where it goes, and their speeds."""
    along = pieces[:, 1] - pieces[:, 0]
    length = np.hypot(*along.T)
    place = np.cumsum(length) - length / 2
    wanted = (np.arange(TEETH) + 0.5) * (length.sum() / TEETH)
    chosen = np.unique(np.searchsorted(place, wanted).clip(max=len(place) - 1)) if len(place) else np.zeros(0, int)
    chosen = chosen[np.isfinite(speed[chosen]) & (length[chosen] > 0)]
    diagonal = float(np.hypot(*np.ptp(pieces.reshape(-1, 2), axis=0))) if len(pieces) else 0.0
    most = float(np.nanmax(np.abs(speed[chosen]), initial=0.0)) or 1.0
    right = np.stack([along[:, 1], -along[:, 0]], axis=1)[chosen] / length[chosen, None]
    start = pieces[chosen].mean(axis=1)
    end = start + (LONGEST * diagonal / most) * speed[chosen, None] * right
    return np.stack([start, end], axis=1), speed[chosen]


def _scale(values: Floats, limits: tuple[float, float] | None, colour_map: str | None) -> ScalarMappable:
    """Colours between limits, of two sides if those are about zero."""
    low, high = checked_limits(limits) if limits is not None else robust_limits(values)
    colours: Colormap = colormaps[checked_map(colour_map) or ("coolwarm" if low == -high else "viridis")].copy()
    colours.colorbar_extend = beyond(values, low, high)  # type: ignore[assignment]
    return ScalarMappable(Normalize(low, high), colours)


def _bounds_of_body(fit: Fit) -> Bounds:
    """The bounds of a body, or the box that it needs, and its points; without an end it is shown around the points."""
    boxes = [] if fit.silhouette is not None else [_around(fit.points)]
    try:
        boxes.append(bounds_or_extent(fit.shape, None))
    except RsymError:
        if not boxes:
            raise
    return hull(boxes) or boxes[0]


def _around(points: Floats) -> Bounds:
    """The box around points, with a margin."""
    low, high = points.min(axis=0), points.max(axis=0)
    margin = MARGIN * (float((high - low).max()) or 1.0)
    return tuple(zip((low - margin).tolist(), (high + margin).tolist(), strict=True))


def _in_the_middle(points: Floats, direction: Floats, bounds: Bounds) -> Floats:
    """Points of an outline on the plane across the view that halves the body, where perspective shows both alike."""
    if points.shape[1] == 2:
        points = np.insert(points, int(np.abs(direction).argmax()), 0.0, axis=1)
    middle = float(np.mean(bounds, axis=1) @ direction)
    return points + (middle - points @ direction)[:, None] * direction


def _page(points: Floats) -> tuple[float, float]:
    """The size of a figure in inches that the box of some points fills."""
    width, height = np.ptp(points, axis=0) if len(points) else (1.0, 1.0)
    return 8.0, float(np.clip(7.0 * height / max(width, 1e-3 * height), 2.2, 8.0)) + 0.6
