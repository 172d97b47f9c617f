"""Figs 1 and 2: the valve, and the function that describes it."""

from __future__ import annotations

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from rsym.output.axes3d import add_axes
from rsym.output.surfaces import plot_mesh
from rsym.paper.drawing import Drawing, letters_text, mesh_quietly
from rsym.paper.models import model_path, valve
from rsym.sampling.sections import sections

RESOLUTION = (200, 200, 555)  # 22 million points; the source needed more than 15 million
OURS = "ours, for the equation of the source's valve is lost"
VIEWS = ((18.0, -58.0), (-24.0, -58.0))  # elevation and azimuth: from above, and the face with its slot
# Beside the section: a definition, where its surface is, and how high its name stands.
NAMES = (
    ("chamfer", (3.1, 99.6), 99.6),
    ("groove", (2.4, 93.0), 93.0),
    ("stem", (3.5, 60.0), 60.0),
    ("fillet", (6.1, 8.1), 16.5),
    ("back", (12.5, 4.6), 11.5),
    ("seat", (15.8, 2.7), 6.5),
    ("rim", (17.0, 0.75), 1.5),
    ("slot", (1.0, 0.9), -3.5),
)
NAMES_AT = 22.0


def draw_valve() -> Drawing:
    """Fig. 1: the valve from above and from below."""
    shape = valve()
    body = mesh_quietly(shape, RESOLUTION)
    figure = Figure(figsize=(8.0, 7.4))
    for position, (elevation, azimuth) in enumerate(VIEWS):
        axes = add_axes(figure, (0.5 * position - 0.25, -0.04, 1.0, 1.08))
        plot_mesh(body, ax=axes, elevation=elevation, azimuth=azimuth)
    return Drawing(figure, letters_text(shape.letters), body.status.triangles, f"{OURS}; {body.status}")


def draw_listing() -> Drawing:
    """Fig. 2: the formulas of the model file, and the meridian section that they make."""
    shape = valve()
    figure = Figure(figsize=(9.6, 5.6))
    text = figure.text(0.01, 0.97, _formulas(), family="monospace", fontsize=9.5, va="top", linespacing=1.32)
    text.set_parse_math(False)
    ax = figure.add_axes((0.72, 0.06, 0.27, 0.90))
    (cut,) = sections(shape, [0.0], axis="y", resolution=600)
    for line in cut.lines:
        ax.fill(*line.T, facecolor="#dfe6f0", edgecolor="black", linewidth=1.1)
    _name_parts(ax)
    ax.set(aspect="equal", xlabel="$x$", ylabel="$z$", xlim=(-19, 38), ylim=(-6, 104))
    ax.set_title("the plane $y = 0$", fontsize=10)
    ax.spines[["top", "right"]].set_visible(False)
    ax.set_xticks([-10, 0, 10])
    return Drawing(
        figure, letters_text(shape.letters), 0, f"{OURS}; the formulas of valve.rf and the section that they make"
    )


def _formulas() -> str:
    """The part of the file that follows the letters."""
    text = model_path("valve").read_text(encoding="utf-8")
    return text[text.index("rho =") :].rstrip()


def _name_parts(ax: Axes) -> None:
    for name, place, height in NAMES:
        arrow = {"arrowstyle": "-", "linewidth": 0.6, "color": "0.35", "shrinkB": 0}
        at = (NAMES_AT, height)
        ax.annotate(name, place, at, family="monospace", fontsize=9, va="center", arrowprops=arrow)
