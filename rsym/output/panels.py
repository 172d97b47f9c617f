"""One panel of level lines: its levels, its drawing, its colour bar, its axes."""

from __future__ import annotations

import math
import warnings
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.colorbar import Colorbar
from matplotlib.contour import QuadContourSet
from matplotlib.patches import Rectangle
from matplotlib.path import Path
from matplotlib.ticker import StrMethodFormatter
from matplotlib.transforms import Affine2D
from numpy.typing import NDArray

from rsym.errors import RsymError, RsymWarning, warn
from rsym.output.looks import PLAIN, Look, snapped
from rsym.program.calculus import SCALARS, title_of
from rsym.sampling.plane import PlaneSampler, PlaneView

TITLES = {field: title_of(field) for field in SCALARS}

PLAIN_DIGITS = 6  # of numbers beside colours, more where they would not tell two levels apart
# A line may be this share of a cell beside itself when it is drawn; matplotlib allows itself so many pixels.
STRAIGHT, SIMPLIFIED = 0.1, 1 / 9
LARGEST = 1e249  # matplotlib fills up to 1e250


def draw_levels(
    ax: Axes,
    sampler: PlaneSampler,
    values: NDArray[np.float64],
    levels: NDArray[np.float64],
    boundary: Iterable[NDArray[np.float64]],
    look: Look = PLAIN,
    omega: NDArray[np.float64] | None = None,
    *,
    lined: bool = True,
    extend: str | None = None,
) -> QuadContourSet:
    """Filled level lines of sampled values, hatched where there are none, and the boundary as a heavy line.

    Fills are pixels in a file of lines, which would be megabytes of polygons. A look that hides the outside needs the
    samples of omega. `lined`: whether the levels have lines too. `extend`: at which ends of the levels there are values
    in this picture, or in others with the same colours.
    """
    extend = extend or look.beyond(levels, values, omega)
    u, v = sampler.lattice.axis(0), sampler.lattice.axis(1)
    shown = np.ma.masked_invalid(snapped(levels, values, extend).T)
    if shown.mask.any():
        box = Rectangle((u[0], v[0]), u[-1] - u[0], v[-1] - v[0], facecolor="0.92", edgecolor="0.6", hatch="////")
        box.set(linewidth=0, zorder=0)
        ax.add_patch(box)
    if np.abs(levels).max() > LARGEST:
        raise RsymError(
            f"levels up to {np.abs(levels).max():.2g} cannot be drawn, {LARGEST:g} is the most",
            code="levels",
            remedy="limits=(-1, 1) for values about 0, or scale the formula",
        )
    colours, scale = look.colours(levels)
    artist = ax.contourf(u, v, shown, levels=levels, cmap=colours, norm=scale, extend=extend)
    artist.set(rasterized=True)
    thin_out(artist, min(sampler.lattice.spacing))
    if lined:
        lines = ax.contour(u, v, shown, levels=levels, colors="black", linewidths=0.35, linestyles="solid", alpha=0.55)
        thin_out(lines, min(sampler.lattice.spacing))
    if look.veil and omega is not None and np.nanmin(omega) < 0:
        outside = [2 * float(np.nanmin(omega)), 0.0]
        veil = ax.contourf(u, v, np.ma.masked_invalid(omega.T), levels=outside, colors="white", alpha=look.veil)
        veil.set(rasterized=True, zorder=2.5)
    ax.add_collection(LineCollection(list(boundary), colors="black", linewidths=1.8, zorder=3), autolim=False)
    return artist


def thin_out(lines: QuadContourSet, cell: float) -> None:
    """Leave out vertices where a line is straight to a share of a cell: most of them, and of a file of lines."""
    finer = Affine2D().scale(SIMPLIFIED / (STRAIGHT * cell))
    paths: Any = lines.get_paths()
    back, kept = finer.inverted(), []
    for path in paths:
        thin = path.cleaned(transform=finer, simplify=True)
        # The last vertex only says that it is the last; a level that is not reached has no path.
        kept.append(back.transform_path(Path(thin.vertices[:-1], thin.codes[:-1])) if len(path.vertices) else path)
    lines.set_paths(kept)


def colour_bar(artist: QuadContourSet, *axes: Axes, rows: int = 1, place: Axes | None = None) -> Colorbar:
    """As tall as the panels, which stand in so many rows; every second or third level labelled, 0 among them.

    In `place`, the axes of an older colour bar, if it is given.
    """
    levels = np.asarray(artist.levels)
    step = -(-len(levels) // 7)
    ticks = levels[np.abs(levels).argmin() % step :: step]
    apart = float(np.abs(levels).max() / np.diff(levels).min())
    numbers = StrMethodFormatter(f"{{x:.{max(PLAIN_DIGITS, math.ceil(math.log10(apart)) + 1)}g}}")
    (left, right), (low, high) = axes[0].get_xlim(), axes[0].get_ylim()
    slender = 20 * max(1.0, rows * (high - low) / (right - left))
    if place is None:
        bar = axes[0].figure.colorbar(
            artist, ax=axes, pad=0.02, fraction=0.05, aspect=slender, ticks=ticks, format=numbers
        )
    else:
        place.clear()
        # A second locator would take the room for the arrows of the bar once more.
        place.set_axes_locator(None)  # type: ignore[arg-type]
        bar = axes[0].figure.colorbar(artist, cax=place, ticks=ticks, format=numbers)
    bar.ax.tick_params(labelsize=7, length=2)
    return bar


def columns_of(count: int) -> int:
    """How many columns so many panels stand in: three, but four are a square.

    Examples
    --------
    >>> [columns_of(count) for count in (1, 2, 3, 4, 5)]
    [1, 2, 3, 2, 3]
    """
    return 2 if count == 4 else min(count, 3)


def dress(ax: Axes, sampler: PlaneSampler | PlaneView, title: str) -> None:
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


@contextmanager
def named(label: str) -> Iterator[None]:
    """Say of which panel what could not be drawn, or only with a warning, is one.

    Examples
    --------
    >>> with named("a = 2"):
    ...     raise RsymError("no boundary", code="empty")
    Traceback (most recent call last):
        ...
    rsym.errors.RsymError: a = 2: no boundary
    """
    try:
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always", RsymWarning)
            yield
    except RsymError as error:
        where = label + (f", {error.where}" if error.where else "")
        raise RsymError(error.message, code=error.code, where=where, remedy=error.remedy) from error
    for one in caught:
        warn(f"{label}: {one.message}")
