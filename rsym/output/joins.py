"""A picture of where patches meet: edges and poles coloured by how smooth they are."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from mpl_toolkits.mplot3d import Axes3D

from rsym.output.bodies import show
from rsym.output.ink import INK, Stroke, dots
from rsym.output.paints import MAPS
from rsym.output.patches import Lines, coat_of_patches, shaded, tessellations
from rsym.output.shading import AZIMUTH, ELEVATION
from rsym.output.surfaces import ShadedMesh
from rsym.output.tessellation import pieces
from rsym.reports.render import COLOURS
from rsym.surfaces.joints.continuity import continuity_report
from rsym.surfaces.joints.edge_report import EdgeReport, PatchMeeting, is_settled
from rsym.surfaces.patch import Patch, patches_of

PALE = "#d5d9e0"  # of the surface: the colours of the edges are what is to be seen
WIDTH, FREE_WIDTH, MARK, HIDDEN = 2.6, 0.8, 5.5, 0.35


def plot_continuity(
    surfaces: Patch | Sequence[Patch],
    report: EdgeReport | None = None,
    *,
    ax: Axes3D | None = None,
    colour: str = PALE,
    colour_by: str | None = None,
    lines: Lines = 0,
    resolution: int | None = None,
    elevation: float = ELEVATION,
    azimuth: float = AZIMUTH,
    letters: Mapping[Any, float] | None = None,
) -> ShadedMesh:
    """Draw patches with the edges along which they meet, each coloured by its class: broken, G0, G1 or G2.

    Poles are dots, edges that join nothing thin lines, and the worst place of all that is less than G2 has a dot in
    the colour of its class. What the surface hides shows through, paler.

    Parameters
    ----------
    surfaces : Patch or sequence of Patch
        What is looked at.
    report : EdgeReport, optional
        What `continuity_report` found on the same patches; without it, it is asked. The legend tells what is proved.
    ax : Axes3D, optional
        Where to draw; a new pyplot figure with a legend is made if it is left out. ``artist.parts`` maps the words of
        the legend to colours.
    colour, colour_by, lines, resolution, elevation, azimuth, letters
        As for `plot_patches`: with ``colour_by="zebra"`` the stripes show what the classes mean.

    Returns
    -------
    Artist
        The picture; its figure is ``artist.get_figure()``.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> from rsym.surfaces.parametric import ParametricSurface
    >>> from rsym.surfaces.symbols import u, v
    >>> slopes = [ParametricSurface((u, v, 0)), ParametricSurface((1 + u, v, u))]
    >>> axes = Figure().add_subplot(projection="3d")
    >>> dict(plot_continuity(slopes, ax=axes, resolution=8).parts)
    {'G0: 1': '#e69f00'}
    """
    patches = patches_of(surfaces)
    found = continuity_report(patches, letters=letters) if report is None else report
    parts = tessellations(patches, lines, resolution, letters, curved=colour_by in MAPS)
    coat = replace(coat_of_patches(parts, colour, colour_by), parts=_legend(found))
    return show(shaded(parts, coat, lines, False, _strokes(found)), ax, elevation, azimuth)


def _legend(report: EdgeReport) -> dict[str, str]:
    """The classes that occur, the worst first, with how many edges and poles are of it, and of how many that is proved.

    G2 is proved where it is certified; less than G2 where all of it is proved and the next class refuted.
    """
    counts = Counter(one.continuity for one in report.meetings)
    settled = Counter(one.continuity for one in report.meetings if is_settled(one))
    return {
        f"{name}: {_count(counts[name], settled[name] if report.verdict else 0)}": colour
        for name, colour in COLOURS.items()
        if counts[name]
    }


def _count(all_of_them: int, proved: int) -> str:
    """How many, and how many of them are proved."""
    if not proved:
        return str(all_of_them)
    return f"{all_of_them} proved" if proved == all_of_them else f"{all_of_them}, {proved} proved"


def _strokes(report: EdgeReport) -> list[Stroke]:
    """The smoothest first, so that the worst lies on top."""
    drawn = [Stroke(pieces(one.points), INK, FREE_WIDTH) for one in report.free]
    for edge in sorted(report.edges, key=_rank, reverse=True):
        drawn.append(Stroke(pieces(edge.points), COLOURS[edge.continuity], WIDTH, HIDDEN))
    for pole in sorted(report.poles, key=_rank, reverse=True):
        drawn += dots(np.array([pole.point]), COLOURS[pole.continuity], MARK, HIDDEN)
    if report.defects:
        worst = report.defects[0]
        drawn += dots(np.array([worst.worst.point]), COLOURS[worst.continuity], MARK, HIDDEN)
    return drawn


def _rank(meeting: PatchMeeting) -> int:
    return list(COLOURS).index(meeting.continuity)
