"""Pictures of fields: filled level lines, the boundary emphasised."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, TypeAlias

import matplotlib.ticker
import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.colorbar import Colorbar
from matplotlib.contour import QuadContourSet
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from numpy.typing import NDArray

from rsym.codegen.fields import SIX, checked_fields
from rsym.errors import RsymError
from rsym.model.shape import Shape
from rsym.sampling.contours import level_lines
from rsym.sampling.plane import PlaneSampler, plane_sampler

Progress: TypeAlias = Callable[[int, int], Any]

TITLES = {
    "value": r"$\omega$",
    "normalised": r"$\omega_n$",
    "gradient_squared": r"$(\nabla\omega)^2$",
    "normalised_gradient_squared": r"$(\nabla\omega_n)^2$",
    "laplacian": r"$\Delta\omega$",
    "normalised_laplacian": r"$\Delta\omega_n$",
}
COLOUR_MAP = "viridis"
# Singular spots reach any height; the colours span what lies between these shares of all samples.
ROBUST_RANGE = (0.02, 0.98)
LEVEL_COUNT = 14


def plot_field(
    shape: Shape,
    field: str = "value",
    *,
    ax: Axes | None = None,
    levels: Sequence[float] | None = None,
    resolution: int | Sequence[int] = 400,
    bounds: Any = None,
    letters: Mapping[Any, float] | None = None,
    section: Mapping[Any, float] | None = None,
    colour_map: str = COLOUR_MAP,
) -> QuadContourSet:
    r"""Filled level lines of one field, the boundary omega = 0 as a heavy line.

    Levels are evenly spaced over a robust range, so that a singular spot does not
    flatten the picture; what lies beyond has the colour of the end. Where the
    field is undefined the ground is hatched.

    Parameters
    ----------
    shape : Shape
        A shape in the plane, or one in space with ``section={z: 1.0}``.
    field : str
        A scalar field of `compile`.
    ax : matplotlib axes, optional
        Where to draw; without it a new figure with a colour bar is made.
    levels : sequence of float, optional
        Two or more increasing levels.

    Returns
    -------
    matplotlib.contour.QuadContourSet
        The filled contours, fit for a colour bar.

    Examples
    --------
    >>> import matplotlib.figure, rsym
    >>> from rsym import x, y
    >>> disc = rsym.Shape((1 - x**2 - y**2) / 2, (x, y), bounds=((-2, 2), (-2, 2)))
    >>> ax = matplotlib.figure.Figure().add_subplot()
    >>> artist = rsym.plot_field(disc, ax=ax, levels=[-1, 0, 0.5], resolution=32)
    >>> print(ax.get_title())
    $\omega$
    """
    sampler = plane_sampler(shape, field, resolution=resolution, bounds=bounds, letters=letters, section=section)
    values = sampler.values()
    chosen = _checked_levels(levels) if levels is not None else robust_levels(values)
    alone = ax is None
    if ax is None:
        import matplotlib.pyplot

        _, ax = matplotlib.pyplot.subplots(layout="compressed")
    boundary = level_lines(shape, resolution=resolution, bounds=bounds, letters=letters, section=section)
    artist = draw_levels(ax, sampler, values, chosen, boundary, colour_map)
    dress(ax, sampler, TITLES[field])
    if alone:
        colour_bar(artist, ax)
    return artist


def plot_fields(
    shape: Shape,
    fields: Sequence[str] = SIX,
    *,
    resolution: int | Sequence[int] = 400,
    bounds: Any = None,
    letters: Mapping[Any, float] | None = None,
    section: Mapping[Any, float] | None = None,
    colour_map: str = COLOUR_MAP,
    progress: Progress | None = None,
) -> Figure:
    r"""The sheet: level lines of several fields, by default the six of the source's Fig. 11.

    Panels are filled row by row, in two columns if the bounds are wide and three if they are tall.
    ``progress(done, total)`` is called before each; returning False cancels with an RsymError.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> disc = rsym.Shape((1 - x**2 - y**2) / 2, (x, y), bounds=((-2, 2), (-2, 2)))
    >>> figure = rsym.plot_fields(disc, ("value", "normalised"), resolution=32)
    >>> print(*(ax.get_title() for ax in figure.axes[:2]))
    $\omega$ $\omega_n$
    """
    import matplotlib.pyplot

    names = checked_fields(fields)
    sampler = plane_sampler(shape, names[0], resolution=16, bounds=bounds, letters=letters, section=section)
    rows, columns, size = sheet_size(sampler, len(names))
    figure: Figure
    figure, axes = matplotlib.pyplot.subplots(
        rows, columns, figsize=size, squeeze=False, sharex=True, sharey=True, layout="compressed"
    )
    for done, (ax, field) in enumerate(zip(axes.flat, names, strict=False)):
        report(progress, done, len(names))
        artist = plot_field(
            shape,
            field,
            ax=ax,
            resolution=resolution,
            bounds=bounds,
            letters=letters,
            section=section,
            colour_map=colour_map,
        )
        colour_bar(artist, ax)
        ax.label_outer()
    for ax in axes.flat[len(names) :]:
        ax.set_axis_off()
    report(progress, len(names), len(names))
    return figure


def report(progress: Progress | None, done: int, total: int) -> None:
    """Say how far a drawing is; an answer of False cancels it."""
    if progress is not None and progress(done, total) is False:
        raise RsymError("the drawing was cancelled", code="cancelled")


def sheet_size(sampler: PlaneSampler, count: int) -> tuple[int, int, tuple[float, float]]:
    """Rows, columns and inches of a sheet of panels, each with a colour bar."""
    width, height = (sampler.lattice.spacing[k] * sampler.lattice.counts[k] for k in (0, 1))
    columns = min(2 if height <= 1.2 * width else 3, count)
    rows = -(-count // columns)
    panel = min(8.4 / columns, 5.0 * width / height)
    return rows, columns, (columns * (panel + 0.9), rows * (max(panel * height / width, 1.6) + 0.45))


def robust_levels(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """About fourteen round levels between low and high quantiles of the finite values.

    Examples
    --------
    >>> import numpy as np
    >>> robust_levels(np.append(np.linspace(0, 1, 1000), 1e9)).max() <= 1.1
    np.True_
    """
    finite = values[np.isfinite(values)]
    if not finite.size:
        raise RsymError("the field is undefined in all of the bounds", code="undefined", remedy="choose other bounds")
    low, high = np.quantile(finite, ROBUST_RANGE)
    if high - low <= 1e-12 * max(abs(low), abs(high)):
        margin = max(abs(low), 1.0) * 0.5
        low, high = low - margin, high + margin
    return np.asarray(matplotlib.ticker.MaxNLocator(LEVEL_COUNT).tick_values(low, high))


def _checked_levels(levels: Sequence[float]) -> NDArray[np.float64]:
    chosen = np.asarray(levels, np.float64)
    if chosen.ndim != 1 or len(chosen) < 2 or not (np.diff(chosen) > 0).all():
        raise RsymError(f"levels must be two or more increasing numbers, got {levels!r}", code="levels")
    return chosen


def draw_levels(
    ax: Axes,
    sampler: PlaneSampler,
    values: NDArray[np.float64],
    levels: NDArray[np.float64],
    boundary: Iterable[NDArray[np.float64]],
    colour_map: str = COLOUR_MAP,
) -> QuadContourSet:
    """Filled level lines of sampled values, hatched where there are none, and the boundary as a heavy line."""
    u, v = sampler.lattice.axis(0), sampler.lattice.axis(1)
    shown = np.ma.masked_invalid(values.T)
    if shown.mask.any():
        box = Rectangle((u[0], v[0]), u[-1] - u[0], v[-1] - v[0], facecolor="0.92", edgecolor="0.6", hatch="////")
        box.set(linewidth=0, zorder=0)
        ax.add_patch(box)
    artist = ax.contourf(u, v, shown, levels=levels, cmap=colour_map, extend="both")
    ax.contour(u, v, shown, levels=levels, colors="black", linewidths=0.35, linestyles="solid", alpha=0.55)
    ax.add_collection(LineCollection(list(boundary), colors="black", linewidths=1.8, zorder=3), autolim=False)
    return artist


def colour_bar(artist: QuadContourSet, *axes: Axes, rows: int = 1) -> Colorbar:
    """As tall as the panels, which stand in so many rows; every second or third level labelled, 0 among them."""
    levels = np.asarray(artist.levels)
    step = -(-len(levels) // 7)
    ticks = levels[np.abs(levels).argmin() % step :: step]
    (left, right), (low, high) = axes[0].get_xlim(), axes[0].get_ylim()
    slender = 20 * max(1.0, rows * (high - low) / (right - left))
    bar = axes[0].figure.colorbar(artist, ax=axes, pad=0.02, fraction=0.05, aspect=slender, ticks=ticks)
    bar.ax.tick_params(labelsize=7, length=2)
    return bar


def dress(ax: Axes, sampler: PlaneSampler, title: str) -> None:
    """Equal scales, the lattice as limits, names of the axes, a title."""
    u, v = sampler.lattice.axis(0), sampler.lattice.axis(1)
    ax.set(
        xlim=(u[1], u[-2]),
        ylim=(v[1], v[-2]),
        aspect="equal",
        xlabel=f"${sampler.names[0]}$",
        ylabel=f"${sampler.names[1]}$",
    )
    ax.set_title(title, fontsize=12)
    ax.tick_params(labelsize=8)
