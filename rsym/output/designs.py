"""Designs as a picture: their boundaries side by side, coloured by curvature on one scale."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure, SubFigure

from rsym.errors import RsymError
from rsym.model.abridging import typeset_name
from rsym.output.fairness import colour_bar, curvature_label, curvature_norm, draw_curvature
from rsym.output.pictures import checked_titles, page, require_report, whole
from rsym.reports.numbers import at_most, number
from rsym.verify.fairness.designs import Design, DesignTable

PANEL = 4.2  # inches, the width of a panel
SHORTEST, TALLEST = 1.0, 4.2
FLAT = 2.2  # width over height above which panels stand in one column
MOST = 3  # panels in a row
MARGIN = 0.05


def plot_designs(
    table: DesignTable,
    *,
    figure: Figure | SubFigure | None = None,
    titles: Sequence[str] | None = None,
    limits: tuple[float, float] | None = None,
) -> Figure:
    """The boundaries of all designs in the same frame, coloured by curvature on one scale, their extrema marked.

    Parameters
    ----------
    table : DesignTable
        What `compare_designs` answered.
    figure : Figure or SubFigure, optional
        Where to draw, in the size that it has; without it a new pyplot figure is made.
    titles : sequence of str, optional
        One for each design, instead of its name, letters and verdict.
    limits : pair of numbers, optional
        The ends of the colours of the curvature; by default those of all designs.

    Returns
    -------
    Figure
        The whole figure, also where a part of it was given.

    Raises
    ------
    RsymError
        For bodies that are not of revolution.

    Examples
    --------
    >>> import rsym, sympy as sp
    >>> from rsym import x, y
    >>> from rsym.verify.fairness.designs import compare_designs
    >>> a = sp.Symbol("a", real=True)
    >>> oval = rsym.Shape(1 - x**2 / a**2 - y**2, (x, y), letters={a: 2}, bounds=((-4, 4), (-2, 2)))
    >>> figure = plot_designs(compare_designs(oval, {"round": {"a": 1.25}, "long": {"a": 3}}, tolerance=0.1))
    >>> [ax.get_title().partition(":")[0] for ax in figure.axes[:2]]
    ['round', 'long']
    """
    require_report(table, DesignTable, "rsym.compare_designs(shape, designs)")
    reports = [design.report for design in table.designs]
    if not all(report.profiles for report in reports):
        raise RsymError(
            "a body that is not one of revolution has no meridian to draw", code="dimension", remedy="leave out -o"
        )
    points = np.concatenate([profile.points for report in reports for profile in report.profiles])
    if reports[0].kind != "curve":
        points = np.concatenate([points, points * [1.0, -1.0]])
    wide, high = np.ptp(points, axis=0)
    columns = 1 if wide > FLAT * high else min(MOST, len(reports))
    rows = math.ceil(len(reports) / columns)
    width = PANEL * (1.8 if columns == 1 else columns)
    height = float(np.clip(width / columns * high / wide, SHORTEST, TALLEST)) + 0.5
    drawn = page(figure, size=(width + 1.0, rows * height + 0.4), layout="constrained")
    axes = drawn.subplots(rows, columns, squeeze=False, sharex=True, sharey=True)
    norm = curvature_norm(reports, limits)
    headings = checked_titles(titles, [_title(table, design) for design in table.designs])
    margin = MARGIN * max(wide, high)
    low, top = points.min(axis=0) - margin, points.max(axis=0) + margin
    for ax, design, heading in zip(axes.flat, table.designs, headings, strict=False):
        lines = draw_curvature(ax, design.report, norm, numbered=False)
        ax.set(xlim=(low[0], top[0]), ylim=(low[1], top[1]))
        ax.set_title(heading, fontsize=9)
        ax.label_outer()
    for ax in axes.flat[len(reports) :]:
        ax.set_axis_off()
    colour_bar(drawn, lines, list(axes.flat), "right", curvature_label(reports[0]))
    return whole(drawn)


def _title(table: DesignTable, design: Design) -> str:
    letters = ", ".join(f"${typeset_name(name)} = {number(design.letters[name])}$" for name in table.differing)
    bound = design.peak("size").bound
    size = rf", $|\kappa| \leq {at_most(bound)}$" if math.isfinite(bound) else ""
    return f"{design.name}: {letters + ', ' if letters else ''}{design.report.verdict}{size}"
