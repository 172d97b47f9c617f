"""Bodies with their verdicts, from the car to what is smooth; the gallery, a body or more for each family of pieces."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction

import numpy as np
from matplotlib.figure import Figure

from rsym.language.loading import load
from rsym.model.blends.fillets import fillet
from rsym.model.constructions import revolve
from rsym.model.primitives.space import box, capsule, half_space
from rsym.model.shape import Shape
from rsym.output.axes3d import add_axes
from rsym.output.body_verdicts import draw_body_verdict
from rsym.output.cards import Place, fill, plot_gallery
from rsym.output.singular import Limits, angle_limits, jump_limits, mark_curves
from rsym.paper.drawing import Drawing, Table, letters_text, triangles_in
from rsym.paper.models import car, model_path, skeleton_body
from rsym.reports.numbers import interval, share
from rsym.verify.answers.body_report import COLUMNS as PARTS
from rsym.verify.answers.body_report import BodyReport
from rsym.verify.answers.singular import kinds_text
from rsym.verify.smoothness import verify_smoothness

GALLERY_COLUMNS = 4
GALLERY_REMARK = "ours; rsym show prints the formulas of each, rsym mesh makes a mesh of it"
# A name, the model, one of its definitions, and what the body is there to show.
BODIES = (
    ("torus", "solids", "torus_body", "a primitive"),
    ("cone", "solids", "cone_body", "a primitive: the exact distance from its mantle"),
    ("helicoid", "solids", "helicoid_body", "a sheet about a ruled surface"),
    ("coil", "solids", "coil_body", "a tube about a helix"),
    ("gear", "gear", "omega", "cyclic symmetry, the flanks exact involutes"),
    ("spring", "spring", "omega", "screw symmetry"),
    ("bracket", "bracket", "omega", "fillets"),
    ("gyroid", "gyroid", "omega", "a periodic surface"),
    ("bone", "bone", "omega", "blending on a skeleton"),
    ("vase", "vase", "omega", "a profile swept with changing letters"),
    ("snowflake", "snowflake", "omega", "six mirrors through an axis"),
    ("clip", "clip", "omega", "segments and arcs in space"),
    ("jack", "jack", "omega", "motions"),
    ("spanner", "spanner", "omega", "plane shapes, extruded"),
    ("lattice", "lattice", "omega", "a grid"),
    ("capsule", "solids", "capsule_body", "a primitive"),
)
SIZE = (9.6, 10.6)  # inches
WIDE = 0.9  # of the width, for the bodies; the rest is for the bars
CAR, COLUMNS, ROWS = 0.4, 3, 2  # of the height, for the car; rows and columns of the others
TITLE = 0.04  # of the height, for a title and what is said below it
CELLS = 160  # along the longest side of a mesh
ROUND = ((-1.7, 1.7), (-1.2, 1.2), (-1.2, 1.2))  # the bounds of bodies
ROOM = ((-0.4, 1.2), (-0.8, 0.8), (-0.4, 1.2))  # about the fillets, with a little of both faces
NOSE = ((-6.5, -4.0), (-0.8, 0.8), (-0.8, 0.8))
REMARK = (
    "Each body is judged as a general one, by boxes in space, and the verdicts are found anew in each run. Edges have "
    "the colour of the dihedral angle, measured through the inside: below 180 degrees they are convex. Dashed: the "
    "tangent plane is continuous, the curvature is not. The stripes of a zebra break at an edge and kink where the "
    "curvature jumps."
)


@dataclass(frozen=True)
class Judged:
    """A body, how it is shown, and its verdict."""

    name: str
    shape: Shape
    report: BodyReport
    colour_by: str | None
    azimuth: float

    @property
    def summary(self) -> str:
        """What was found, in a few words."""
        report = self.report
        told = [kinds_text((*report.curves, *report.points))] if report.curves or report.points else []
        if not told and np.isfinite(report.curvatures).all():
            told = [f"curvatures in {interval(*report.curvatures)}"]
        return ", ".join([*told, *([f"{share(report.undecided_share)} undecided"] if len(report.undecided) else [])])


def bodies() -> list[tuple[str, Shape, str | None, float]]:
    """Names, shapes, what they are coloured by, and from where they are seen."""
    floor, wall = half_space((0, 0, -1)), half_space((-1, 0, 0))
    rounded, cubic = (fillet(floor, wall, Fraction(1, 2), kind).replace(bounds=ROOM) for kind in ("G1", "G2"))
    body = skeleton_body()
    pointed, smooth = (revolve(body.with_letters({"a2": value})).replace(bounds=NOSE) for value in (5.3, 6))
    return [
        ("The car", car(), None, 48.0),
        ("A box", box(2, Fraction(8, 5), Fraction(6, 5)).replace(bounds=ROUND), None, -55.0),
        ("A capsule of radius ½", capsule((-1, 0, 0), (1, 0, 0), Fraction(1, 2)).replace(bounds=ROUND), "zebra", -55.0),
        ("Fig. 12, a₂ = 5.3", pointed, None, -150.0),
        ("A fillet of radius ½", rounded, "zebra", -55.0),
        ("A cubic fillet", cubic, "zebra", -55.0),
        ("Fig. 12, a₂ = 6", smooth, None, -150.0),
    ]


def judge() -> list[Judged]:
    """The verdicts, found anew."""
    judged = []
    for name, shape, colour_by, azimuth in bodies():
        report = verify_smoothness(shape, method="space")
        assert isinstance(report, BodyReport)
        judged.append(Judged(name, shape, report, colour_by, azimuth))
    return judged


def draw_verdicts() -> Drawing:
    """The car above, other bodies below in rows; every group of curves and points in the table."""
    judged = judge()
    curves = [curve for one in judged for curve in one.report.curves]
    angles, jumps = angle_limits(curves), jump_limits(curves)
    figure = Figure(figsize=SIZE)
    for one, place in zip(judged, _places(), strict=False):
        _draw(figure, one, place, angles, jumps)
    for bar, bottom in zip(mark_curves(curves, 1.0, angles, jumps).bars, (0.65, 0.15), strict=False):
        axes = figure.add_axes((WIDE + 0.01, bottom, 0.014, 0.3))
        drawn = figure.colorbar(bar.scale, cax=axes, ticks=bar.ticks)
        drawn.set_label(bar.label, fontsize=9)
        axes.tick_params(labelsize=8)
    table = Table(("body", "verdict", *PARTS), tuple(row for one in judged for row in _rows(one)))
    return Drawing(figure, letters_text(car().letters), triangles_in(figure), REMARK, table)


def _places() -> list[Place]:
    """The car on top, the others in rows."""
    width, height = WIDE / COLUMNS, (1 - CAR) / ROWS
    below = [(k * width, (ROWS - 1 - row) * height, width, height) for row in range(ROWS) for k in range(COLUMNS)]
    return [(0.0, 1 - CAR, WIDE, CAR), *below]


def _draw(figure: Figure, one: Judged, place: Place, angles: Limits, jumps: Limits) -> None:
    left, bottom, width, height = place
    axes = add_axes(figure, place)
    artist = draw_body_verdict(
        one.report,
        one.shape,
        ax=axes,
        colour_by=one.colour_by,
        resolution=CELLS,
        azimuth=one.azimuth,
        angles=angles,
        jumps=jumps,
    )
    axes.set_axis_off()
    axes.set_title("")
    fill(figure, artist, (left, bottom, width, height - TITLE))
    title = f"{one.name}: {one.report.verdict}, {one.report.continuity}"
    figure.text(left + width / 2, bottom + height - 0.012, title, ha="center", va="center", fontsize=10)
    figure.text(left + width / 2, bottom + height - 0.03, one.summary, ha="center", va="center", fontsize=8)


def _rows(one: Judged) -> Iterator[tuple[str, ...]]:
    """The verdict, then what is below G2 and what is not."""
    yield one.name, one.report.verdict, *("",) * 4, one.summary, one.report.continuity, "", ""
    yield from (("", "", *entry.cells) for entry in one.report.document().entries)


def draw_gallery() -> Drawing:
    """All bodies under their names, and what each shows."""
    shapes = {name: load(model_path(model), shape=shape) for name, model, shape, _ in BODIES}
    figure = plot_gallery(shapes, columns=GALLERY_COLUMNS)
    table = Table(("body", "model file", "what it shows"), tuple((n, f"{m}.rf", shows) for n, m, _, shows in BODIES))
    return Drawing(figure, "as in the model files", triangles_in(figure), GALLERY_REMARK, table)
