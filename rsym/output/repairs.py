"""A repair as a figure: the boundary as it is, and under the magnifying glass before and after each candidate."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure, SubFigure
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

from rsym.arrays import Floats
from rsym.errors import RsymError
from rsym.model.shape import Shape
from rsym.output.certificates import CERTIFICATES, DEFECT
from rsym.output.pictures import checked_titles, page, require_report, whole
from rsym.output.verdicts import plot_verdict
from rsym.sampling.boundaries import Boundary, boundary, distances_to
from rsym.sampling.plane import plane_section
from rsym.sampling.windows import bounds_or_extent
from rsym.verify.answers.report import SmoothnessReport
from rsym.verify.answers.singular import SingularCurve
from rsym.verify.repair.anatomy import Verdict
from rsym.verify.repair.report import Candidate, RepairReport
from rsym.verify.revolution import meridian

Box = tuple[tuple[float, float], ...]

COLUMNS = 3
WIDTH = 9.0  # inches
WINDOW, MAIN = 3.5, 3.0  # inches, heights with titles and captions
CELLS, WHOLE = 120, 256  # of a window, of the whole
# A window shows so many times the distance that the boundary moves at the defect, between shares of the extent.
SHOWN = 5.0
LEAST, MOST = 1 / 4000, 1 / 6
LINE = 44  # letters in a row of a caption
BEFORE, AFTER = DEFECT, CERTIFICATES["certified"].colour


@dataclass(frozen=True)
class ShownPlane:
    """The plane in which shapes are shown, theirs, that of their meridians or a section, and the place to look at."""

    point: tuple[float, float]
    names: tuple[str, str]
    bounds: Box
    body: bool
    section: Mapping[str, float]

    def plane(self, shape: Shape) -> Shape:
        """A shape as it is seen there."""
        if self.body:
            return meridian(shape)[0]
        return plane_section(shape, self.section)[0] if self.section else shape

    def boundary(self, shape: Shape, box: Box, cells: int) -> Boundary:
        """The boundary of a shape as it is seen there, within a box."""
        return boundary(self.plane(shape), box, cells)


def plot_repair(
    report: RepairReport,
    *,
    shown: int = 6,
    figure: Figure | SubFigure | None = None,
    titles: Sequence[str] | None = None,
) -> Figure:
    """The boundary as it is, and a window at its worst defect for each candidate: before, after, and the price.

    Parameters
    ----------
    report : RepairReport
        What `repair` answered.
    shown : int
        The greatest number of candidates to show, the least moved first.
    figure : Figure or SubFigure, optional
        Where to draw, in the size that it has; without it a new pyplot figure is made.
    titles : sequence of str, optional
        One for each candidate that is shown, instead of its number and change.

    Returns
    -------
    Figure
        The whole figure, also where a part of it was given.

    Raises
    ------
    RsymError
        If there is no candidate.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> roof = rsym.Shape(1 - abs(x) - y, (x, y), bounds=((-2, 2), (-2, 2)))
    >>> figure = plot_repair(rsym.repair(roof, moves=["round"], radius=0.1))
    >>> figure.axes[1].get_title()
    '1   |x| rounded by 0.1'
    """
    require_report(report, RepairReport, "rsym.repair(shape)")
    candidates = report.candidates[:shown]
    if not candidates:
        raise RsymError("there is no candidate to show", code="no-candidate", remedy="print the report: it says why")
    columns = min(COLUMNS, len(candidates))
    rows = math.ceil(len(candidates) / columns)
    named = [textwrap.fill(f"{number}   {one.change}", LINE) for number, one in enumerate(candidates, 1)]
    headings = checked_titles(titles, named)
    drawn = page(figure, size=(WIDTH, MAIN + WINDOW * rows), layout="constrained")
    grid = drawn.add_gridspec(1 + rows, columns, height_ratios=[MAIN] + [WINDOW] * rows)
    view = view_of(report)
    before = view.boundary(report.shape, view.bounds, WHOLE)
    _draw_whole(drawn.add_subplot(grid[0, :]), report, view, before)
    for number, candidate in enumerate(candidates, 1):
        ax = drawn.add_subplot(grid[1 + (number - 1) // columns, (number - 1) % columns])
        _draw_window(ax, report.shape, candidate, view)
        ax.set_title(headings[number - 1], fontsize=8)
    handles = [
        Line2D([], [], color=BEFORE, dashes=(4, 2), linewidth=1.3, label="before"),
        Line2D([], [], color=AFTER, linewidth=1.8, label="after, proved to be of continuous curvature"),
    ]
    drawn.legend(handles=handles, loc="outside lower center", ncols=2, fontsize=8)
    return whole(drawn)


def view_of(report: RepairReport) -> ShownPlane:
    """The plane in which the worst defect is seen: in space the section across its curve."""
    shape, before = report.shape, report.before
    body = isinstance(before, SmoothnessReport) and before.body
    plane = meridian(shape)[0] if body else shape
    point, axis = _worst(before)
    free = [k for k in range(plane.dimension) if plane.dimension == 2 or k != axis]
    box = bounds_or_extent(plane, None)
    return ShownPlane(
        point=(point[free[0]], point[free[1]]),
        names=(plane.coordinates[free[0]].name, plane.coordinates[free[1]].name),
        bounds=(box[free[0]], box[free[1]]),
        body=body,
        section={} if plane.dimension == 2 else {plane.coordinates[axis].name: point[axis]},
    )


def _worst(before: Verdict) -> tuple[Sequence[float], int]:
    """The worst defect, of a curve its middle, and the coordinate along which it runs."""
    if not before.defects:
        boxes = before.undecided if len(before.undecided) else np.array([before.cover.bounds])
        return [float(c) for c in boxes[0].mean(axis=1)], 2
    worst = before.defects[0]
    if not isinstance(worst, SingularCurve):
        return worst.point, 2
    middle = len(worst.points) // 2
    along = np.ptp(worst.points[max(0, middle - 1) : middle + 1], axis=0)
    return [float(c) for c in worst.points[middle]], int(np.argmax(along))


def _draw_whole(ax: Axes, report: RepairReport, view: ShownPlane, before: Boundary) -> None:
    if isinstance(report.before, SmoothnessReport):
        plot_verdict(report.before, report.shape, ax=ax, comb=False)
        return
    _stroke(ax, before.lines, "before", (0.0, 0.0))
    ax.plot(*view.point, "o", markersize=6, color=DEFECT, markeredgecolor="white", zorder=5)
    cut = ", ".join(f"{name} = {value:.4g}" for name, value in view.section.items())
    ax.set(aspect="equal", xlabel=f"${view.names[0]}$", ylabel=f"${view.names[1]}$")
    ax.set_title(f"{report.before.verdict}: {report.before.continuity}, the section {cut}", fontsize=10)


def _draw_window(ax: Axes, shape: Shape, candidate: Candidate, view: ShownPlane) -> None:
    """Both boundaries about the worst defect; coordinates are counted from it."""
    extent = max(high - low for low, high in view.bounds)
    whole = view.boundary(candidate.shape, view.bounds, WHOLE)
    moved = float(distances_to(np.array([view.point]), whole)[0]) if whole.lines else math.inf
    size = min(max(SHOWN * moved, LEAST * extent), MOST * extent)
    box = tuple((middle - size, middle + size) for middle in view.point)
    for name, one in (("before", shape), ("after", candidate.shape)):
        _stroke(ax, view.boundary(one, box, CELLS).lines, name, view.point)
    ax.set(xlim=(-size, size), ylim=(-size, size), aspect="equal")
    for ticks in (ax.xaxis, ax.yaxis):
        ticks.set_major_locator(MaxNLocator(3, symmetric=True, prune="both"))
    ax.tick_params(labelsize=7)
    u, v = view.names
    distance, volume, curvature, normalisation = candidate.price.words
    price = f"{distance}, {volume}\n{curvature}, proved\n{normalisation}"
    ax.set_xlabel(f"${u} - {u}_1$\n{price}", fontsize=8)
    ax.set_ylabel(f"${v} - {v}_1$", fontsize=8)


def _stroke(ax: Axes, lines: Sequence[Floats], name: str, origin: Sequence[float]) -> None:
    """Lines counted from an origin; the dashes of what was lie on top."""
    artist = LineCollection([line - np.asarray(origin) for line in lines])
    if name == "before":
        artist.set(color=BEFORE, linewidth=1.3, linestyle=(0, (4, 2)), zorder=4)
    else:
        artist.set(color=AFTER, linewidth=1.8, zorder=3)
    ax.add_collection(artist, autolim=True)
    ax.autoscale_view()
