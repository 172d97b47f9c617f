"""Fairness as a picture: the curve coloured by its curvature, its extrema marked, and the curvature over arc length."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Any, TypeAlias

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PatchCollection
from matplotlib.colors import AsinhNorm, Normalize
from matplotlib.figure import Figure, SubFigure
from matplotlib.patches import Rectangle
from numpy.typing import NDArray

from rsym.arrays import Floats
from rsym.errors import RsymError
from rsym.model.shape import Shape
from rsym.output.paints import checked_limits
from rsym.output.pictures import page, require_report, whole
from rsym.verify.fairness.fairness import fairness
from rsym.verify.fairness.report import Extremum, FairnessReport, Profile

Place: TypeAlias = tuple[int, tuple[float, float]]

MAP = "viridis"
MARKS = {"maximum": "^", "minimum": "v", "inflection": "o"}
COLOURS = ("#0072b2", "#d55e00")  # Okabe and Ito's, for the curvatures along and across a meridian
WIDTH = 9.5  # inches
SHORTEST, TALLEST = 2.6, 5.2
FLAT = 2.2  # width over height of a curve above which the graph is drawn below it
STACKED, GRAPH = 8.0, 2.6  # inches: the width of both then, and the height of the graph
TICKS = 5
LABEL = 9.0  # points from a place to its number
CROWD = 0.035  # of the width: places closer than this share one label
MARGIN = 0.1


def plot_fairness(
    subject: FairnessReport | Shape,
    *,
    figure: Figure | SubFigure | None = None,
    limits: tuple[float, float] | None = None,
) -> Figure:
    """The boundary coloured by its curvature with its extrema, and the curvature over arc length with its proved band.

    Of a body of revolution the meridian is coloured by the curvature along it, and both curvatures are drawn over its
    arc length. Numbers are those of the places in the text of the report; colours are spread where most curvatures are.

    Parameters
    ----------
    subject : FairnessReport or Shape
        What `fairness` answered, or the shape to ask about.
    figure : Figure or SubFigure, optional
        Where to draw, in the size that it has; without it a new pyplot figure is made.
    limits : pair of numbers, optional
        The ends of the colours of the curvature; by default they are spread where most curvatures are.

    Returns
    -------
    Figure
        The whole figure, also where a part of it was given.

    Raises
    ------
    RsymError
        For a report on a body that is not one of revolution, which has no arc length.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> oval = rsym.Shape(1 - x**2 / 4 - y**2, (x, y), bounds=((-3, 3), (-2, 2)))
    >>> figure = plot_fairness(oval)
    >>> [ax.get_xlabel() for ax in figure.axes[:2]]
    ['$x$', 'arc length']
    """
    report = fairness(subject) if isinstance(subject, Shape) else subject
    require_report(report, FairnessReport, "rsym.fairness(shape)")
    if not report.profiles:
        raise RsymError(
            "a body that is not one of revolution has no meridian to draw",
            code="dimension",
            remedy="draw a section, or rsym.plot_mesh with colour_by='mean_curvature'",
        )
    drawn, curve, graph, place = _page(report, figure)
    norm = curvature_norm([report], limits)
    lines = draw_curvature(curve, report, norm)
    colour_bar(drawn, lines, curve, place, curvature_label(report))
    draw_graph(graph, report)
    return whole(drawn)


def _page(report: FairnessReport, figure: Figure | SubFigure | None) -> tuple[Figure | SubFigure, Axes, Axes, str]:
    """A figure, the curve, the graph beside it or, if the curve is flat, below it, and where the colour bar goes."""
    points = np.concatenate([profile.points for profile in report.profiles])
    # Of a meridian its mirror image too.
    shown = points if report.kind == "curve" else np.concatenate([points, points * [1.0, -1.0]])
    wide, high = np.ptp(shown, axis=0)
    if wide > FLAT * high:
        upper = float(np.clip(STACKED * high / wide, 0.8, STACKED / 2)) + 0.8
        drawn = page(figure, size=(STACKED, upper + GRAPH), layout="constrained")
        curve, graph = drawn.subplots(2, 1, height_ratios=(upper, GRAPH))
        return drawn, curve, graph, "right"
    height = float(np.clip(0.5 * WIDTH * high / wide, SHORTEST, TALLEST)) + 0.5
    drawn = page(figure, size=(WIDTH, height), layout="constrained")
    curve, graph = drawn.subplots(1, 2, width_ratios=(1.15, 1))
    return drawn, curve, graph, "bottom"


def colour_bar(figure: Figure | SubFigure, lines: LineCollection, axes: Any, place: str, label: str) -> None:
    """A colour bar with few plain numbers, evenly spaced in colour."""
    bar = figure.colorbar(
        lines, ax=axes, location=place, shrink=0.9, aspect=40 if place == "bottom" else 20, label=label
    )
    norm: Any = lines.norm
    ticks: list[float] = norm.inverse(np.linspace(0.0, 1.0, TICKS)).tolist()
    size = max(map(abs, ticks))
    bar.set_ticks(ticks, labels=[f"{0.0 if abs(tick) < 1e-9 * size else tick:.2g}" for tick in ticks])
    bar.ax.minorticks_off()


def curvature_label(report: FairnessReport) -> str:
    """What the colours say."""
    return r"curvature $\kappa$" if report.kind == "curve" else r"curvature $\kappa_1$ of the meridian"


def curvature_norm(reports: Sequence[FairnessReport], limits: tuple[float, float] | None = None) -> Normalize:
    """One scale for all, linear up to the usual curvature and logarithmic beyond, between limits if there are some."""
    values = np.concatenate([profile.curvature[:, 0] for report in reports for profile in report.profiles])
    values = values[np.isfinite(values)]
    ends = [(report.curvatures[0].least.attained, report.curvatures[0].greatest.attained) for report in reports]
    low, high = checked_limits(limits) if limits is not None else (float(np.min(ends)), float(np.max(ends)))
    usual = float(np.median(np.abs(values)))
    if not high - low > 1e-9 * max(abs(low), abs(high)):
        low, high = low - 0.5 * (abs(low) or 1.0), high + 0.5 * (abs(high) or 1.0)
    return AsinhNorm(linear_width=max(usual, 1e-3 * (high - low)), vmin=low, vmax=high)


def draw_curvature(ax: Axes, report: FairnessReport, norm: Normalize, *, numbered: bool = True) -> LineCollection:
    """The boundary coloured by its curvature, extrema and inflections as marks; fit for a colour bar."""
    halves = ([1.0, 1.0],) if report.kind == "curve" else ([1.0, 1.0], [1.0, -1.0])
    points = [one.points * half for one in report.profiles for half in halves]
    values = [one.curvature[:, 0] for one in report.profiles for _ in range(1 if report.kind == "curve" else 2)]
    segments = np.concatenate([np.stack([line[:-1], line[1:]], axis=1) for line in points])
    means = np.concatenate([(value[1:] + value[:-1]) / 2 for value in values])
    lines = LineCollection(list(segments), array=means, cmap=MAP, norm=norm, linewidths=3.0, capstyle="round", zorder=2)
    ax.add_collection(lines)
    low, high = segments.min(axis=(0, 1)), segments.max(axis=(0, 1))
    if report.kind != "curve":
        ax.axhline(0.0, color="0.4", linewidth=0.8, dashes=(10, 3, 2, 3), zorder=1)
    _mark_curve(ax, report, CROWD * float(high[0] - low[0]), numbered)
    _mark_defects(ax, report)
    _dress(ax, report, low, high)
    return lines


def _mark_curve(ax: Axes, report: FairnessReport, reach: float, numbered: bool) -> None:
    """Extrema of the curvature by which the curve is coloured."""
    own = report.curvatures[0].name
    places = [(n, one) for n, one in enumerate((*report.extrema, *report.inflections), 1) if one.quantity == own]
    for _, one in places:
        ax.plot(*one.point, MARKS[one.kind], color="white", markeredgecolor="black", markersize=6, zorder=4)
    numbers = [(n, (one.point[0], one.point[1])) for n, one in places] if numbered else []
    for label, at in _labels(numbers, (reach, reach)):
        away = at - _centre(report, at)
        away = LABEL * away / (np.hypot(*away) or 1.0)
        _annotate(ax, label, at, (float(away[0]), float(away[1])), "black")


def _centre(report: FairnessReport, at: Floats) -> Floats:
    """The middle of the line next to a place."""
    lines = [profile.points for profile in report.profiles]
    nearest = min(lines, key=lambda line: float(np.hypot(*(line - at).T).min()))
    middle: Floats = (nearest.min(axis=0) + nearest.max(axis=0)) / 2
    return middle


def _labels(
    places: Sequence[tuple[int, tuple[float, float]]], reach: tuple[float, float]
) -> Iterator[tuple[str, Floats]]:
    """Numbers with their places; those in a crowd share one label at its middle."""
    crowds: list[list[tuple[int, tuple[float, float]]]] = []
    for number, point in places:
        near = (c for c in crowds if any((np.abs(np.subtract(point, other)) < reach).all() for _, other in c))
        crowd = next(near, None)
        if crowd is None:
            crowds.append([(number, point)])
        else:
            crowd.append((number, point))
    for crowd in crowds:
        yield ", ".join(str(number) for number, _ in crowd), np.mean([point for _, point in crowd], axis=0)


def _annotate(ax: Axes, label: str, at: Floats, offset: tuple[float, float], colour: str) -> None:
    ax.annotate(
        label,
        (float(at[0]), float(at[1])),
        xytext=offset,
        textcoords="offset points",
        ha="left" if offset[0] > LABEL / 2 else "right" if offset[0] < -LABEL / 2 else "center",
        va="center",
        fontsize=8,
        color=colour,
        zorder=5,
    )


def _mark_defects(ax: Axes, report: FairnessReport) -> None:
    """A cross where the boundary is not G2."""
    points = np.reshape([defect.point for defect in report.smoothness.defects], (-1, 2))  # type: ignore[union-attr]
    if len(points):
        ax.plot(*points.T, "x", color="black", markersize=8, markeredgewidth=2, zorder=4, linestyle="none")


def _dress(ax: Axes, report: FairnessReport, low: Floats, high: Floats) -> None:
    margin = MARGIN * (high - low).max()
    ax.set(xlim=(low[0] - margin, high[0] + margin), ylim=(low[1] - margin, high[1] + margin), aspect="equal")
    across = report.coordinates[1]
    ax.set(xlabel=f"${report.coordinates[0]}$", ylabel=f"${across}$" if report.kind == "curve" else across)
    ax.tick_params(labelsize=8)


def draw_graph(ax: Axes, report: FairnessReport) -> None:
    """The curvatures over arc length, line after line, in the bands that are proved piece by piece."""
    start = 0.0
    for profile in report.profiles:
        for number, bounds in enumerate(report.curvatures):
            colour, label = COLOURS[number], None if start else bounds.name
            band = PatchCollection(list(_bands(report, profile, number, start)), facecolor=colour, alpha=0.25, zorder=1)
            ax.add_collection(band)
            ax.plot(start + profile.length, profile.curvature[:, number], color=colour, linewidth=1.2, label=label)
        start += float(profile.length[-1])
        if profile is not report.profiles[-1]:
            ax.axvline(start, color="0.6", linewidth=0.8)
    ax.axhline(0.0, color="0.6", linewidth=0.8, zorder=0)
    ax.set(xlabel="arc length", ylabel=r"curvature $\kappa$", xlim=(0.0, start))
    ax.margins(y=0.12)
    ax.autoscale_view(scalex=False)
    ax.tick_params(labelsize=8)
    _mark_graph(ax, report)
    if len(report.curvatures) > 1:
        ax.legend(fontsize=8, frameon=False)


def _bands(report: FairnessReport, profile: Profile, number: int, start: float) -> Iterator[Rectangle]:
    """One rectangle for each piece: the arc length of the line in its box, and the curvatures proved there."""
    points = profile.points
    for box, ranges in zip(report.bands.boxes, report.bands.ranges, strict=True):
        low, high = ranges[number]
        if not math.isfinite(high - low):
            continue
        for first, last in _runs(((points >= box[:, 0]) & (points <= box[:, 1])).all(axis=1)):
            left = profile.length[max(first - 1, 0)]
            right = profile.length[min(last + 1, len(points) - 1)]
            yield Rectangle((start + left, low), right - left, high - low)


def _runs(marked: NDArray[np.bool_]) -> Iterator[tuple[int, int]]:
    """The first and the last of neighbours that are marked."""
    (found,) = np.nonzero(marked)
    if len(found):
        cuts = np.flatnonzero(np.diff(found) > 1)
        yield from zip(
            found[np.append(0, cuts + 1)].tolist(), found[np.append(cuts, len(found) - 1)].tolist(), strict=True
        )


def _mark_graph(ax: Axes, report: FairnessReport) -> None:
    """The extrema of each curvature where they lie on the lines."""
    low, high = ax.get_ylim()
    width = float(ax.get_xlim()[1])
    for bounds, colour in zip(report.curvatures, COLOURS if len(report.curvatures) > 1 else ("black",), strict=True):
        for kind, mark in MARKS.items():
            places = []
            for number, one in enumerate((*report.extrema, *report.inflections), 1):
                if one.quantity == bounds.name and one.kind == kind:
                    place = (arc_length_at(report, one), one.curvature)
                    places.append((number, place))
                    ax.plot(*place, mark, color="white", mec=colour, markersize=5, zorder=4, clip_on=False)
            for label, at in _labels(places, (CROWD * width, CROWD * (high - low))):
                _annotate(ax, label, at, (0.0, -LABEL if kind == "minimum" else LABEL), colour)


def arc_length_at(report: FairnessReport, one: Extremum) -> float:
    """The arc length up to a place, all lines one after the other."""
    start, best = 0.0, (math.inf, math.nan)
    for profile in report.profiles:
        distance = np.hypot(*(profile.points - one.point).T)
        nearest = int(distance.argmin())
        best = min(best, (float(distance[nearest]), start + float(profile.length[nearest])))
        start += float(profile.length[-1])
    return best[1]
