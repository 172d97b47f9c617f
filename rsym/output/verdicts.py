"""A verdict as a figure: the boundary by certificate, its curvature as a comb, and the worst defects magnified."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from rsym.arrays import Floats
from rsym.errors import RsymError
from rsym.model.shape import Shape
from rsym.output.axes3d import require_axes3d
from rsym.output.body_verdicts import draw_body_verdict
from rsym.output.certificates import (
    CERTIFICATES,
    DEFECT,
    JudgedShape,
    both_sides,
    certificates_of,
    draw_boundary,
    draw_cover,
    draw_magnified,
    subject,
)
from rsym.output.combs import plot_curvature_comb
from rsym.output.pictures import figure_of, require_axes
from rsym.output.shading import AZIMUTH, ELEVATION
from rsym.reports.words import plural
from rsym.verify.answers.body_report import BodyReport
from rsym.verify.answers.report import SmoothnessReport

CELLS, BODY_CELLS = 600, 160  # along the longer side
WIDTH = 8.0  # inches
TALLEST, FLATTEST = 0.62, 0.25  # height of the main panel as a share of its width
WINDOW = 2.7  # inches, the widest
MARGIN = 0.07
TEETH = 240
COMB = "0.62"
# Boxes of suspects are far smaller than a pixel: one mark stands for all within this share of the width.
CROWD = 0.04
NUMBER = 12.0  # points from a defect to its number
DIRECTIONS = np.exp(2j * np.pi * np.arange(16) / 16)


def plot_verdict(
    report: SmoothnessReport | BodyReport,
    shape: Shape,
    *,
    ax: Axes | None = None,
    magnified: int = 4,
    comb: bool = True,
    colour_by: str | None = None,
    resolution: int | None = None,
    elevation: float = ELEVATION,
    azimuth: float = AZIMUTH,
) -> Figure:
    """The boundary that a report is about, coloured by what is proved of it, its defects marked and magnified.

    Behind it stand the boxes of the proof, on it the curvature as a comb. A body of revolution is shown as its
    meridian with the mirror image. Any other body is shown in space: edges in colours of the dihedral angle, jumps of
    the curvature dashed, points as dots, undecided boxes as outlines. Letters that were intervals are taken in their
    middle.

    Parameters
    ----------
    report : SmoothnessReport or BodyReport
        What `verify_smoothness` answered.
    shape : Shape
        The shape it was asked about.
    ax : matplotlib axes, optional
        Draw the main panel alone there; without it a new figure is made. For a body in space 3D axes.
    magnified : int
        How many defects in the plane get a window of their own, the worst first.
    comb : bool
        Whether to draw the curvature in the plane.
    colour_by, elevation, azimuth
        Of a body in space, as for `plot_mesh`: with ``colour_by="zebra"`` the stripes show what the classes mean.
    resolution : int, optional
        Cells along the longer side: 600 in the plane, 160 in space.

    Returns
    -------
    Figure
        The whole figure, also where axes were given.

    Examples
    --------
    >>> import math, rsym
    >>> from rsym import x, y
    >>> from rsym.verify.answers.report import Cover
    >>> disc = rsym.Shape(1 - x**2 - y**2, (x, y), bounds=((-2, 2), (-2, 2)))
    >>> none = np.empty((0, 2, 2))
    >>> report = SmoothnessReport("UNDECIDED", "G0", (), (), math.inf, Cover(disc.bounds, none, none, none, 0), {})
    >>> print(plot_verdict(report, disc, resolution=32).axes[0].get_title().partition(":")[0])
    UNDECIDED
    """
    if not isinstance(report, SmoothnessReport | BodyReport):
        raise RsymError(
            f"expected what verify_smoothness answers, got {type(report).__name__}",
            code="report",
            remedy="plot_verdict(verify_smoothness(shape), shape)",
        )
    if isinstance(report, BodyReport):
        axes = None if ax is None else require_axes3d(ax)
        cells = resolution or BODY_CELLS
        return figure_of(
            draw_body_verdict(
                report, shape, ax=axes, colour_by=colour_by, resolution=cells, elevation=elevation, azimuth=azimuth
            )
        )
    about = subject(report, shape)
    lines = about.lines(about.bounds, resolution or CELLS)
    windows = 0 if ax is not None else min(max(0, magnified), len(report.defects))
    if ax is not None:
        figure, main, rest = figure_of(require_axes(ax)), ax, list[Axes]()
    else:
        figure, main, rest = _page(lines, report, windows)
    handles = _draw_main(main, report, about, lines, windows, comb)
    extent = float(np.diff(main.get_xlim())[0])
    for number, (window, joint) in enumerate(zip(rest, report.defects, strict=False), 1):
        draw_magnified(window, report, about, joint, label=str(number), extent=extent)
    if ax is None and handles:
        figure.legend(handles=handles, loc="outside lower center", ncols=3, fontsize=8)
    return figure


def _page(lines: Sequence[Floats], report: SmoothnessReport, windows: int) -> tuple[Figure, Axes, list[Axes]]:
    """A figure with a main panel and a row of square windows under it."""
    import matplotlib.pyplot

    points = np.concatenate([np.array(report.cover.bounds).T] if not lines else lines)
    width, height = np.ptp(points, axis=0)
    # Comb, margin and labels make a body rounder than it is.
    main = WIDTH * float(np.clip(1.3 * height / max(width, 1e-9 * height), FLATTEST, TALLEST))
    side = min(WIDTH / max(windows, 1), WINDOW)
    rows = [main, side] if windows else [main]
    figure: Figure = matplotlib.pyplot.figure(figsize=(WIDTH, sum(rows) + 1.2), layout="constrained")
    grid = figure.add_gridspec(len(rows), max(windows, 1), height_ratios=rows)
    return figure, figure.add_subplot(grid[0, :]), [figure.add_subplot(grid[1, k]) for k in range(windows)]


def _draw_main(
    ax: Axes, report: SmoothnessReport, about: JudgedShape, lines: Sequence[Floats], numbered: int, comb: bool
) -> list[Artist]:
    """The whole boundary; what a legend needs."""
    draw_cover(ax, report)
    handles = _legend(report, lines)
    shown = [*lines, np.reshape([joint.point for joint in report.defects], (-1, 2))]
    if comb and lines:
        envelopes, largest = _draw_comb(ax, about)
        shown += envelopes
        handles.append(Line2D([], [], color=COMB, linewidth=1.0, label=f"curvature, here up to {largest:.3g}"))
    if report.body:
        ax.axhline(0.0, color="0.4", linewidth=0.8, dashes=(10, 3, 2, 3), zorder=2)
    draw_boundary(ax, lines, report)
    _mark_undecided(ax, report, about)
    _mark_defects(ax, report, lines, numbered)
    _dress(ax, report, about, np.concatenate(shown))
    return handles


def _dress(ax: Axes, report: SmoothnessReport, about: JudgedShape, shown: Floats) -> None:
    if len(shown) < 2:
        shown = np.array(about.bounds).T
    low, high = shown.min(axis=0), shown.max(axis=0)
    margin = MARGIN * (high - low).max()
    u, v = (symbol.name for symbol in about.shape.coordinates)
    ax.set(xlim=(low[0] - margin, high[0] + margin), ylim=(low[1] - margin, high[1] + margin))
    ax.set(aspect="equal", xlabel=f"${u}$", ylabel=f"${v}$")
    ax.set_title(_title(report), fontsize=10)
    ax.tick_params(labelsize=8)


def _draw_comb(ax: Axes, about: JudgedShape) -> tuple[list[Floats], float]:
    """Grey, so that colours belong to the verdict; the envelopes and the largest curvature."""
    teeth = plot_curvature_comb(about.shape, ax=ax, teeth=TEETH, bounds=about.bounds, letters=about.letters)
    largest = float(np.abs(np.asarray(teeth.get_array())).max(initial=0.0))
    teeth.lines.remove()
    teeth.set_array(None)
    teeth.set(color=COMB, linewidth=0.5)
    teeth.envelopes.set(color=COMB, linewidth=0.6)
    return [np.asarray(run) for run in teeth.envelopes.get_segments()], largest


def _mark_undecided(ax: Axes, report: SmoothnessReport, about: JudgedShape) -> None:
    """A hollow square wherever nothing is proved: the boxes themselves may be too small to see."""
    boxes = both_sides(report.undecided, body=report.body)
    if len(boxes):
        middles = boxes.mean(axis=2)
        crowd = CROWD * float(np.diff(about.bounds, axis=1).max())
        _, first = np.unique(np.floor(middles / crowd), axis=0, return_index=True)
        colour = CERTIFICATES["undecided"].colour
        ax.plot(*middles[first].T, "s", markersize=9, markerfacecolor="none", color=colour, zorder=4)


def _mark_defects(ax: Axes, report: SmoothnessReport, lines: Sequence[Floats], numbered: int) -> None:
    """A disc on every defect; those that are magnified have a number, on the side where there is most room."""
    for joint in report.defects:
        mirrored = [(joint.point[0], -joint.point[1])] if report.body and joint.point[1] > joint.radius else []
        for u, v in [joint.point, *mirrored]:
            ax.plot(u, v, "o", markersize=6, color=DEFECT, markeredgecolor="white", zorder=5)
    points = np.concatenate([np.empty((0, 2)), *lines])
    boundary = points[:, 0] + 1j * points[:, 1]
    reach = CROWD * max(np.ptp(points, axis=0)) if len(points) else 1.0
    for number, joint in enumerate(report.defects[:numbered], 1):
        here = complex(*joint.point)
        room = [np.abs(boundary - here - reach * way).min(initial=math.inf) for way in DIRECTIONS]
        way = NUMBER * DIRECTIONS[int(np.argmax(room))]
        place, offset = (here.real, here.imag), (float(way.real), float(way.imag))
        text = ax.annotate(str(number), place, offset, textcoords="offset points", color=DEFECT, zorder=6)
        text.set(fontsize=10, fontweight="bold", ha="center", va="center")


def _title(report: SmoothnessReport) -> str:
    """The verdict and what it says, in one line."""
    kinds = " and ".join(dict.fromkeys(joint.kind for joint in report.defects))
    answers = {
        "CERTIFIED": f"{report.continuity}, proved",
        "REFUTED": f"{report.continuity}, not G2, proved",
        "DEGENERATE": kinds or "no boundary to speak of",
    }
    answer = answers.get(report.verdict, f"in {plural(len(report.undecided), 'box', 'boxes')} nothing is proved")
    ranges = [f"{name} in [{low:g}, {high:g}]" for name, (low, high) in report.letters.items() if low < high]
    return f"{report.verdict}: {answer}{', for every ' if ranges else ''}{' and '.join(ranges)}"


def _legend(report: SmoothnessReport, lines: Sequence[Floats]) -> list[Artist]:
    """What is in the picture, and nothing that is not."""
    names = [certificates_of((line[1:] + line[:-1]) / 2, report.cover, body=report.body) for line in lines]
    present = set(np.concatenate([np.empty(0, "U9"), *names])) | ({"undecided"} if len(report.undecided) else set())
    handles: list[Artist] = [
        Line2D([], [], color=look.colour, linewidth=look.width, linestyle=look.dashes, label=look.label)
        for name, look in CERTIFICATES.items()
        if name in present
    ]
    if len(report.cover.certified):
        handles.append(Patch(color=CERTIFICATES["certified"].colour, alpha=0.16, label="boxes of the proof"))
    if report.defects:
        handles.append(Line2D([], [], marker="o", color=DEFECT, linestyle="", label="defect"))
    return handles
