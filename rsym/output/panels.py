"""One panel of level lines: its levels, its drawing, its colour bar, its axes."""

from __future__ import annotations

from collections.abc import Iterable

import matplotlib.ticker
import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.colorbar import Colorbar
from matplotlib.contour import QuadContourSet
from matplotlib.patches import Rectangle
from numpy.typing import NDArray

from rsym.errors import RsymError
from rsym.sampling.plane import PlaneSampler

TITLES = {
    "value": r"$\omega$",
    "normalised": r"$\omega_n$",
    "gradient_squared": r"$(\nabla\omega)^2$",
    "normalised_gradient_squared": r"$(\nabla\omega_n)^2$",
    "laplacian": r"$\Delta\omega$",
    "normalised_laplacian": r"$\Delta\omega_n$",
    "normalised_2": r"$\omega_{n,2}$",
    "normalised_2_gradient_squared": r"$(\nabla\omega_{n,2})^2$",
    "normalised_2_laplacian": r"$\Delta\omega_{n,2}$",
    "normalised_3": r"$\omega_{n,3}$",
    "normalised_3_gradient_squared": r"$(\nabla\omega_{n,3})^2$",
    "normalised_3_laplacian": r"$\Delta\omega_{n,3}$",
    "curvature": r"curvature $\kappa$",
    "mean_curvature": "mean curvature $H$",
    "gaussian_curvature": "Gaussian curvature $K$",
}
COLOUR_MAP = "viridis"
# Singular spots reach any height; the colours span what lies between these shares of all samples.
ROBUST_RANGE = (0.02, 0.98)
LEVEL_COUNT = 14


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


def colour_bar(artist: QuadContourSet, *axes: Axes, rows: int = 1, place: Axes | None = None) -> Colorbar:
    """As tall as the panels, which stand in so many rows; every second or third level labelled, 0 among them.

    In `place`, the axes of an older colour bar, if it is given.
    """
    levels = np.asarray(artist.levels)
    step = -(-len(levels) // 7)
    ticks = levels[np.abs(levels).argmin() % step :: step]
    (left, right), (low, high) = axes[0].get_xlim(), axes[0].get_ylim()
    slender = 20 * max(1.0, rows * (high - low) / (right - left))
    if place is None:
        bar = axes[0].figure.colorbar(artist, ax=axes, pad=0.02, fraction=0.05, aspect=slender, ticks=ticks)
    else:
        place.clear()
        # A second locator would take the room for the arrows of the bar once more.
        place.set_axes_locator(None)  # type: ignore[arg-type]
        bar = axes[0].figure.colorbar(artist, cax=place, ticks=ticks)
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
