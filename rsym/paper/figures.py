"""The figures as recipes: what to draw, from which letters; those of the source stand here."""

from __future__ import annotations

from functools import lru_cache

from matplotlib.figure import Figure

from rsym.model.constructions import revolve
from rsym.output.axes3d import add_axes
from rsym.output.fields import plot_fields
from rsym.output.surfaces import plot_mesh
from rsym.paper import claims, coons, curves, data, fields, growth, studies, verdicts
from rsym.paper.drawing import Drawing, Recipe, drawing_of, figure_of, letters_text, mesh_quietly
from rsym.paper.models import BODIES, car, model_path, skeleton_body, streamlined, valve
from rsym.sampling.mesh import Mesh
from rsym.sampling.sections import sections

VALVE_RESOLUTION = (200, 200, 555)  # 22 million points; the source needed more than 15 million
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
RESTORED = "roof and boot restored"
# 3.4 million samples, as the source in 27 sub-boxes of 125 000 points; in 125 it had 15.6 million.
RESOLUTION = 252
FRONT, REAR = 48.0, -52.0
SHEET = (12.0, 4.4)
BODY_BOX = ((-6.0, 8.0), (-2.4, 2.4), (-2.4, 2.4))
COARSE = (35, 73, 43)  # 37*75*45 points, 125 000 as in Fig. 10, more along the car than across it
STREAMLINED_RESOLUTION = (160, 330, 205)
NORMALISED = r"\omega_{n} = \frac{\omega}{\sqrt{\omega^{2} + \left(\nabla\omega\right)^{2}}}"
REVOLVED = r"\omega_{n}\left(x,\, \sqrt{y^{2} + z^{2}}\right) = 0"


def draw_valve() -> Drawing:
    """Fig. 1: the valve from above and from below."""
    shape = valve()
    body = mesh_quietly(shape, VALVE_RESOLUTION)
    figure = Figure(figsize=(8.0, 7.4))
    for position, (elevation, azimuth) in enumerate(VIEWS):
        axes = add_axes(figure, (0.5 * position - 0.25, -0.04, 1.0, 1.08))
        plot_mesh(body, ax=axes, elevation=elevation, azimuth=azimuth)
    return drawing_of(figure, shape, body, OURS)


def draw_listing() -> Drawing:
    """Fig. 2: the formulas of the model file, and the meridian section that they make."""
    shape = valve()
    figure = Figure(figsize=(9.6, 5.6))
    listing = model_path("valve").read_text(encoding="utf-8")
    formulas = listing[listing.index("rho =") :].rstrip()
    text = figure.text(0.01, 0.97, formulas, family="monospace", fontsize=9.5, va="top", linespacing=1.32)
    text.set_parse_math(False)
    ax = figure.add_axes((0.72, 0.06, 0.27, 0.90))
    (cut,) = sections(shape, [0.0], axis="y", resolution=600)
    for line in cut.lines:
        ax.fill(*line.T, facecolor="#dfe6f0", edgecolor="black", linewidth=1.1)
    for name, place, height in NAMES:
        arrow = {"arrowstyle": "-", "linewidth": 0.6, "color": "0.35", "shrinkB": 0}
        at = (NAMES_AT, height)
        ax.annotate(name, place, at, family="monospace", fontsize=9, va="center", arrowprops=arrow)
    ax.set(aspect="equal", xlabel="$x$", ylabel="$z$", xlim=(-19, 38), ylim=(-6, 104))
    ax.set_title("the plane $y = 0$", fontsize=10)
    ax.spines[["top", "right"]].set_visible(False)
    ax.set_xticks([-10, 0, 10])
    return Drawing(
        figure, letters_text(shape.letters), 0, f"{OURS}; the formulas of valve.rf and the section that they make"
    )


def _car_recipe(
    name: str, title: str, published: str, stage: str, variant: str = "a", azimuth: float = FRONT
) -> Recipe:
    return Recipe(name, title, published, lambda: _draw_car(stage, variant, azimuth), model=("car", stage))


@lru_cache(maxsize=1)  # Fig. 9 shows one mesh from two sides
def _car_mesh(stage: str, variant: str) -> Mesh:
    return mesh_quietly(car(variant, stage), studies.FINE if stage == "W" else RESOLUTION)


def _draw_car(stage: str, variant: str, azimuth: float) -> Drawing:
    shape, body = car(variant, stage), _car_mesh(stage, variant)
    return drawing_of(figure_of(plot_mesh(body, azimuth=azimuth)), shape, body, RESTORED)


def _draw_triangulation() -> Drawing:
    """125 000 points, as the source: 50 along each axis."""
    shape = car()
    body = mesh_quietly(shape, (50, 50, 50))
    return drawing_of(figure_of(plot_mesh(body, azimuth=FRONT, edges=True)), shape, body, RESTORED)


def _draw_sheet() -> Drawing:
    shape = skeleton_body()
    return Drawing(plot_fields(shape), letters_text(shape.letters), 0, "six fields, the boundary as a heavy line")


def _draw_bodies() -> Drawing:
    body = skeleton_body().with_letters({"a2": 5})
    solid = revolve(body)
    width, height = SHEET
    figure = Figure(figsize=SHEET)
    triangles = 0
    for position, (a1, p1) in enumerate(BODIES):
        result = mesh_quietly(solid, 200, bounds=BODY_BOX, letters={"a1": a1, "p1": p1})
        row, column = divmod(position, 3)
        # mplot3d draws into squares; slender bodies need only the middle of theirs, so the rows overlap.
        side = width / 3 / height
        axes = add_axes(figure, (column / 3, 0.75 - row / 2 - side / 2, 1 / 3, side))
        plot_mesh(result, ax=axes, elevation=16.0, azimuth=-68.0)
        figure.text((column + 0.5) / 3, 0.92 - row / 2, f"$a_1 = {a1}$, $p_1 = {p1}$", ha="center", fontsize=11)
        triangles += result.status.triangles
    pairs = ", ".join(f"({a1}, {p1})" for a1, p1 in BODIES)
    printed = letters_text({name: letter for name, letter in body.letters.items() if name not in {"a1", "p1"}})
    remark = "the pairs (a1, p1) are ours: the source does not print them"
    return Drawing(figure, f"{printed}, (a1, p1) = {pairs}", triangles, remark)


def _draw_streamlined() -> Drawing:
    """From the front and from the rear."""
    shape = streamlined()
    body = mesh_quietly(shape, STREAMLINED_RESOLUTION)
    figure = Figure(figsize=(7.0, 7.0))
    for bottom, elevation, azimuth in ((0.26, 20.0, 42.0), (-0.19, 24.0, -130.0)):
        plot_mesh(body, ax=add_axes(figure, (0.0, bottom, 1.0, 1.0)), elevation=elevation, azimuth=azimuth)
    return drawing_of(figure, shape, body, "ours")


def _draw_streamlined_triangulation() -> Drawing:
    shape = streamlined()
    body = mesh_quietly(shape, COARSE)
    return drawing_of(figure_of(plot_mesh(body, elevation=20.0, azimuth=42.0, edges=True)), shape, body, "ours")


# Those of parametric surfaces.
SURFACES: tuple[Recipe, ...] = (
    Recipe(
        "paraboloid",
        "A bicubic Coons patch beside the plane of its corners",
        "",
        coons.draw_paraboloid,
        equations=coons.PARABOLOID_EQUATIONS,
    ),
    Recipe("twists", "What the twists at the corners do", "", coons.draw_twists),
    Recipe("torus", "The torus from exact patches", "", coons.draw_torus, equations=coons.TORUS_EQUATIONS),
    Recipe("joints", "Two patches that meet, joined G1, and joined G2", "", coons.draw_joints),
    Recipe("hull", "A hull through sections", "", curves.draw_hull),
    Recipe("network", "A surface through a network of curves", "", curves.draw_network, equations=(curves.EQUATION,)),
    Recipe("fitting", "A B-spline surface with fewer vertices than data", "", curves.draw_fitting),
)


RECIPES: tuple[Recipe, ...] = (
    Recipe("fig01", "A valve", "", draw_valve),
    Recipe("fig02", "The function of the valve", "", draw_listing, model=("valve", "omega")),
    _car_recipe("fig05a", "Roof, boot and bonnet with arches", "23.32", "test1"),
    _car_recipe("fig05b", "Roof, boot and bonnet with arches, other letters", "23.32", "test1", "b"),
    _car_recipe("fig06a", "Boot and bonnet rounded", "23.35", "test2"),
    _car_recipe("fig06b", "Boot and bonnet rounded, other letters", "23.35", "test2", "b"),
    _car_recipe("fig07a", "The full surface of the body", "23.91", "test3"),
    _car_recipe("fig07b", "The full surface of the body, other letters", "23.91", "test3", "b"),
    _car_recipe("fig08a", "The body with wheels", "23.78", "test4"),
    _car_recipe("fig08b", "The body with wheels and windows", "23.91", "test5"),
    _car_recipe("fig09a", "The car, rear view", "23.86 (27 sub-boxes), 93 (125)", "W", azimuth=REAR),
    _car_recipe("fig09b", "The car, front view", "23.86 (27 sub-boxes), 93 (125)", "W"),
    Recipe("fig10", "Triangulation of the car from 125 000 points", "", _draw_triangulation, model=("car", "W")),
    Recipe(
        "fig11",
        "Level lines of the six fields of the skeleton body",
        "",
        _draw_sheet,
        model=("skeleton", "omega"),
        equations=(NORMALISED,),
    ),
    Recipe("fig12", "Bodies of revolution", "", _draw_bodies, model=("skeleton", "omega"), equations=(REVOLVED,)),
    Recipe("fig13", "A car of unusual shape", "", _draw_streamlined, model=("streamlined", "omega")),
    Recipe("fig14", "Triangulation of the car of unusual shape", "", _draw_streamlined_triangulation),
    Recipe("table1", "The cost of drawing the valve", "", studies.draw_cost),
    Recipe("preference", "Why the normalised function is preferred", "", studies.draw_preference),
    Recipe("parts", "The parts of the car", "", studies.draw_parts),
    Recipe("sections", "Sections of the car at constant z", "", studies.draw_sections),
    Recipe("rendered", "The car straight from its equation", "", studies.draw_rendered),
    Recipe(
        "revolution",
        "Normalising before and after revolving",
        "",
        studies.draw_revolution,
        equations=studies.REVOLUTION_EQUATIONS,
    ),
    Recipe("claims", "What the source claims, and what holds", "", claims.draw_claims, model=("skeleton", "omega")),
    Recipe("atlas", "Where the body of Fig. 11 is smooth", "", claims.draw_atlas, equations=(claims.CONDITION,)),
    Recipe("verdicts", "Bodies with their verdicts", "", verdicts.draw_verdicts),
    Recipe("fitted", "The body of Fig. 11 from noisy points", "", data.draw_fitted, equations=data.EQUATIONS),
    Recipe("solved", "Equations solved on shapes", "", fields.draw_solved, equations=fields.EQUATIONS),
    Recipe("growth", "How time and memory grow with a model", "", growth.draw_growth),
    *SURFACES,
    Recipe("gallery", "A gallery of shapes", "", verdicts.draw_gallery),
)


# Figures in rows that share a mesh or a compiled model, so that one process draws each; the costliest rows first.
# The second one begins without a mesh: on a new machine the first compiles the mesher's loops for both.
ROWS = (
    ("fig09a", "fig09b", "parts", "fig10", "preference", "sections", "rendered", "fig08b", "fig08a"),
    ("fig11", "claims", "atlas", "revolution", "fig12"),
    ("verdicts",),
    ("fig07a", "fig07b", "fig06a", "fig06b", "fig05a", "fig05b"),
    ("gallery",),
    ("table1", "fig01", "fig02"),
    ("fig13", "fig14"),
)
