"""An atlas of two letters as a figure: what is certified by its greatest curvature, what is refuted, and the line."""

from __future__ import annotations

import math
from collections.abc import Sequence

import matplotlib.patheffects
import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.collections import PolyCollection
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import FixedLocator, FuncFormatter, NullLocator

from rsym.arrays import Floats
from rsym.errors import RsymError
from rsym.model.abridging import typeset_name
from rsym.output.certificates import DEFECT
from rsym.output.paints import checked_limits, checked_map
from rsym.output.pictures import figure_of, require_axes, require_report
from rsym.reports.document import CERTIFIED, DEGENERATE, REFUTED, UNDECIDED
from rsym.verify.atlas.greatest import FEWEST, round_levels
from rsym.verify.atlas.report import SmoothnessAtlas

SIZE = (6.4, 5.0)  # inches: the width of a page of text
COLOUR_MAP = "viridis_r"  # dark where the boundary is sharp
# Outside this share of the values the colours say no more: beside a threshold the curvature grows without bound.
ROBUST = 0.97
FLAT = 1.1  # a map whose values differ by less has one colour
LOOKS = {
    CERTIFIED: ("#dce9d5", "#b7cdaa", ""),
    REFUTED: ("#f6e3d8", "#dcae94", "////"),
    DEGENERATE: ("#ededed", "#c0c0c0", "...."),
    UNDECIDED: ("#ffffff", "#8a8a8a", ""),
}
LABELS = {
    CERTIFIED: "certified: curvature continuous, proved",
    REFUTED: "refuted: not continuous, proved",
    DEGENERATE: "no boundary, proved",
    UNDECIDED: "undecided",
}
INK = "#1a1a1a"


def plot_atlas(
    atlas: SmoothnessAtlas,
    *,
    ax: Axes | None = None,
    rectangles: bool = True,
    levels: Sequence[float] | None = None,
    limits: tuple[float, float] | None = None,
    colour_map: str = COLOUR_MAP,
) -> Figure:
    """The plane of two letters: certified in the colours of the greatest curvature, refuted hatched, the threshold.

    Colours and level lines are those of the greatest curvature found, which are numerical; where certified ends and
    refuted begins is proved.

    Parameters
    ----------
    atlas : SmoothnessAtlas
        What `smoothness_atlas` answered.
    ax : matplotlib axes, optional
        Draw there; without it a new figure is made.
    rectangles : bool
        Whether to draw the outlines of the rectangles of the proof.
    levels : sequence of float, optional
        Greatest curvatures whose level lines are drawn; by default 1, 2, 5, 10, ... as far as they occur.
    limits : pair of positive numbers, optional
        The curvatures at the ends of the colours.
    colour_map : str
        A name that matplotlib knows.

    Returns
    -------
    Figure
        The whole figure, also where axes were given.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> ellipse = rsym.Shape(1 - (x / 2) ** 2 - y**2, (x, y), bounds=((-3, 3), (-2, 2)))
    >>> round_ = rsym.Shape(4 - x**2 - y**2, (x, y), letters={"a": 1, "b": 2}, bounds=((-3, 3), (-3, 3)))
    >>> figure = plot_atlas(rsym.smoothness_atlas(round_, "a", "b"))
    >>> figure.axes[0].get_xlabel(), figure.axes[0].get_ylabel()
    ('$a$', '$b$')
    """
    require_report(atlas, SmoothnessAtlas, "rsym.smoothness_atlas(shape, letter_a, letter_b)")
    alone = ax is None
    if ax is None:
        import matplotlib.pyplot

        _, ax = matplotlib.pyplot.subplots(figsize=SIZE, layout="constrained")
    require_axes(ax)
    _draw_parts(ax, atlas, outlines=rectangles)
    colours = _draw_curvature(ax, atlas, levels, limits, str(checked_map(colour_map)))
    for curve in atlas.thresholds:
        for line in curve.middle:
            ax.plot(*line.T, color=DEFECT, linewidth=1.8, zorder=6, solid_capstyle="butt")
    (a, b), (c, d) = atlas.region
    u, v = atlas.defaults
    shown = a <= u <= b and c <= v <= d
    if shown:
        ax.plot(u, v, "o", markersize=6.5, color=INK, markeredgecolor="white", markeredgewidth=1.2, zorder=7)
    ax.set(xlim=(a, b), ylim=(c, d))
    ax.set_xlabel(f"${typeset_name(atlas.letters[0])}$", fontsize=12)
    ax.set_ylabel(f"${typeset_name(atlas.letters[1])}$", fontsize=12)
    ax.tick_params(labelsize=9)
    figure = figure_of(ax)
    if colours is not None:
        _colour_bar(figure, ax, colours)
    if alone:
        figure.legend(
            handles=_legend(atlas, shown, colour_map), loc="outside lower center", ncols=2, fontsize=8, frameon=False
        )
    return figure


def _draw_parts(ax: Axes, atlas: SmoothnessAtlas, *, outlines: bool) -> None:
    for verdict, (face, edge, hatch) in LOOKS.items():
        corners = [[(a, c), (b, c), (b, d), (a, d)] for (a, b), (c, d) in atlas.parts(verdict)]
        if not corners:
            continue
        # Hatching by part would be cut anew in each: it lies over all of them, the outlines over it.
        ax.add_collection(PolyCollection(corners, facecolors=face, edgecolors="none", zorder=1), autolim=False)
        if hatch:
            marks = PolyCollection(corners, facecolors="none", edgecolors=edge, linewidths=0, hatch=hatch, zorder=2)
            ax.add_collection(marks, autolim=False)
        if outlines:
            lines = PolyCollection(corners, facecolors="none", edgecolors=INK, linewidths=0.25, alpha=0.35, zorder=4)
            ax.add_collection(lines, autolim=False)


def _draw_curvature(
    ax: Axes,
    atlas: SmoothnessAtlas,
    levels: Sequence[float] | None,
    limits: tuple[float, float] | None,
    colour_map: str,
) -> ScalarMappable | None:
    """The map of the greatest curvature and its level lines, labelled."""
    if not _is_mapped(atlas):
        return None
    u, v = atlas.curvature.lattice()
    shown = np.ma.masked_invalid(atlas.curvature.on((u, v)).T)
    low, high = float(shown.min()), float(np.quantile(shown.compressed(), ROBUST))
    if limits is not None:
        low, high = checked_limits(limits)
        if low <= 0:
            message = f"limits of curvatures are positive, got {limits!r}"
            raise RsymError(message, code="limits", remedy="limits=(1, 10)")
    norm = LogNorm(low, high, clip=True)
    artist = ax.pcolormesh(u, v, shown, cmap=colour_map, norm=norm, shading="nearest", rasterized=True, zorder=3)
    wanted = [level for level in round_levels(low, high) if level < high] if levels is None else levels
    if len(wanted):
        _draw_levels(ax, u, v, shown, wanted)
    return artist


def _is_mapped(atlas: SmoothnessAtlas) -> bool:
    """Whether there is a map of the greatest curvature, and more than one colour in it."""
    values = atlas.curvature.values
    return len(values) >= FEWEST and values.max() > FLAT * values.min()


def _draw_levels(ax: Axes, u: Floats, v: Floats, shown: Floats, levels: Sequence[float]) -> None:
    drawn = ax.contour(u, v, np.log(shown), levels=np.log(levels), colors="white", linewidths=0.9, zorder=5)
    names = {math.log(level): f"{level:g}" for level in levels}
    texts = ax.clabel(drawn, fmt=lambda value: names[min(names, key=lambda known: abs(known - value))], fontsize=8)
    for text in texts:
        text.set_color("white")
        text.set_path_effects([matplotlib.patheffects.withStroke(linewidth=1.6, foreground="#303030")])
        text.set_zorder(6)


def _colour_bar(figure: Figure, ax: Axes, artist: ScalarMappable) -> None:
    bar = figure.colorbar(artist, ax=ax, pad=0.02, fraction=0.05, aspect=25, extend="max")
    low, high = artist.get_clim()
    assert low is not None
    assert high is not None
    bar.ax.yaxis.set_major_locator(FixedLocator(round_levels(low, high)))
    bar.ax.yaxis.set_minor_locator(NullLocator())
    bar.ax.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    bar.ax.tick_params(labelsize=8, length=2)
    bar.set_label(r"greatest curvature found, $\max|\kappa|$", fontsize=9)


def _legend(atlas: SmoothnessAtlas, shown: bool, colour_map: str) -> list[Patch | Line2D]:
    """What is in the picture, and nothing that is not."""
    handles: list[Patch | Line2D] = [
        Patch(facecolor=face, edgecolor=edge, hatch=hatch, linewidth=0.6, label=LABELS[verdict])
        for verdict, (face, edge, hatch) in LOOKS.items()
        if len(atlas.parts(verdict))
    ]
    if _is_mapped(atlas):
        handles[0].set(facecolor=colormaps[colour_map](0.25), edgecolor="none")
    if atlas.thresholds:
        handles.append(Line2D([], [], color=DEFECT, linewidth=1.8, label="threshold, enclosed by the undecided strip"))
    if shown:
        handles.append(Line2D([], [], marker="o", linestyle="", color=INK, label="the letters of the model"))
    return handles
