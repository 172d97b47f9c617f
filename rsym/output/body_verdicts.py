"""The verdict on a body as a picture of it: its edges coloured, what else is singular marked."""

from __future__ import annotations

import warnings
from collections.abc import Mapping

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patheffects import withStroke
from mpl_toolkits.mplot3d import Axes3D

from rsym.errors import RsymError, RsymWarning
from rsym.model.shape import Shape
from rsym.output import axes3d
from rsym.output.bodies import show
from rsym.output.ink import Stroke
from rsym.output.joins import PALE
from rsym.output.paints import coat_of
from rsym.output.shading import AZIMUTH, ELEVATION
from rsym.output.singular import Limits, Marks, labelled, mark_boxes, mark_curves, mark_points, outlines
from rsym.output.surfaces import ShadedMesh
from rsym.reports.numbers import share
from rsym.sampling.mesh import Mesh
from rsym.sampling.meshing import mesh
from rsym.verify.answers.body_report import BodyReport
from rsym.verify.answers.singular import kinds_text

FRAME = "#aaaaaa"
TITLE, ROW = 0.5, 0.3  # inches, for the title and for a row of a legend


def draw_body_verdict(
    report: BodyReport,
    shape: Shape,
    *,
    ax: Axes3D | None = None,
    colour: str = PALE,
    colour_by: str | None = None,
    resolution: int,
    elevation: float = ELEVATION,
    azimuth: float = AZIMUTH,
    angles: Limits | None = None,
    jumps: Limits | None = None,
) -> ShadedMesh:
    """The body that a report is about, with what is singular on it, a title and, on a new figure, a legend.

    `angles` and `jumps` are the ends of the scales of colours, for pictures that share them.

    Examples
    --------
    >>> from rsym import x, y, z
    >>> from rsym.verify.answers.body_report import BodyCover
    >>> ball = Shape(1 - x**2 - y**2 - z**2, (x, y, z), bounds=((-2, 2),) * 3)
    >>> none, nothing = np.empty((0, 3, 2)), (float("nan"),) * 2
    >>> cover = BodyCover(ball.bounds, none, none, none, 0)
    >>> report = BodyReport("CERTIFIED", "analytic", (), (), nothing, nothing, cover, {})
    >>> draw_body_verdict(report, ball, resolution=16).axes.figure.get_suptitle()
    'CERTIFIED: analytic, proved'
    """
    letters = {name: (low + high) / 2 for name, (low, high) in report.letters.items() if name in shape.letters}
    body = _mesh(shape, report, resolution, letters)
    coat = coat_of(body, body.normals, colour, colour_by, shape, letters)
    size = float(np.ptp(body.vertices, axis=0).max())
    marks = mark_curves(report.curves, size, angles, jumps) + mark_boxes(report.undecided, size)
    marks += mark_points(report.points)
    frame = [] if len(body.faces) > 1 else [Stroke(outlines(np.array([report.cover.bounds])), FRAME, 0.6)]
    artist = ShadedMesh(body, coat, features=False, strokes=[*frame, *marks.strokes], bars=marks.bars)
    show(artist, ax, elevation, azimuth)
    _explain(artist, report, marks, whole=ax is None)
    return artist


def _mesh(shape: Shape, report: BodyReport, resolution: int, letters: Mapping[str, float]) -> Mesh:
    """Open where it leaves the bounds, for the verdict does not speak of caps; its status is no part of it either.

    Without a surface, one triangle that is seen from no side, across the bounds.
    """
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RsymWarning)
        try:
            return mesh(shape, resolution, bounds=report.cover.bounds, letters=letters, cap=False)
        except RsymError as error:
            if error.code != "no-surface":
                raise
            return Mesh(np.array(report.cover.bounds).T, np.array([[0, 1, 0]]))


def _explain(artist: ShadedMesh, report: BodyReport, marks: Marks, *, whole: bool) -> None:
    """A title; on a figure of its own a legend below, and room for both."""
    axes = artist.axes
    assert isinstance(axes, Axes3D)
    for point in labelled(report.points):
        label = axes.text(*point.point, f"   {point.kind}", fontsize=9, zorder=6)
        label.set_path_effects([withStroke(linewidth=2.5, foreground="white")])
    if not whole:
        axes.set_title(verdict_title(report), fontsize=10)
        return
    figure: Figure = axes.figure
    columns = 3
    rows = -(-len(marks.handles) // columns)
    axes3d.add_room(axes, below=ROW * rows, above=TITLE)
    height = figure.get_size_inches()[1]
    figure.suptitle(verdict_title(report), fontsize=11, y=1 - 0.2 / height, va="center")
    if rows:
        figure.legend(handles=marks.handles, loc="lower center", ncols=columns, fontsize=8, frameon=False)


def verdict_title(report: BodyReport) -> str:
    """The verdict and what it rests on, in one line.

    Examples
    --------
    >>> from rsym.verify.answers.body_report import BodyCover
    >>> from rsym.verify.answers.singular import SingularPoint
    >>> none, nothing = np.empty((0, 3, 2)), (float("nan"),) * 2
    >>> cover, tip = BodyCover((), none, none, none, 0), SingularPoint((0.0, 0.0, 1.0), 0.0, "cone tip", "G0")
    >>> verdict_title(BodyReport("REFUTED", "G0", (), (tip,), nothing, nothing, cover, {"a": (1, 2)}))
    'REFUTED: G0, not G2, proved: 1 cone tip, for some a in [1, 2]'
    """
    kinds = kinds_text(report.defects)
    answers = {
        "CERTIFIED": f"{report.continuity}, proved",
        "REFUTED": f"{report.continuity}, not G2, proved: {kinds}",
        "DEGENERATE": kinds or "no boundary to speak of",
    }
    undecided = f"on {share(report.undecided_share)} of the boundary nothing is proved"
    ranges = [f"{name} in [{low:g}, {high:g}]" for name, (low, high) in report.letters.items() if low < high]
    which = "every" if report.verdict in {"CERTIFIED", "UNDECIDED"} else "some"
    letters = f", for {which} {' and '.join(ranges)}" if ranges else ""
    return f"{report.verdict}: {answers.get(report.verdict, undecided)}{letters}"
