"""The figures of the source paper as recipes: what to draw, from which letters."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import lru_cache

from matplotlib.artist import Artist
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from rsym.errors import RsymWarning
from rsym.model.letters import Letter
from rsym.model.motions import revolve
from rsym.model.shape import Shape
from rsym.output.fields import plot_fields
from rsym.output.surfaces import plot_mesh
from rsym.paper.models import car, skeleton_body
from rsym.sampling.mesh import Mesh
from rsym.sampling.meshing import mesh

# 10 million samples; the source had 3.4 and 15.6 million (27 and 125 sub-boxes of 125 000 points).
RESOLUTION = 360
# The headlights of the whole car cut the bonnet at a grazing angle: more samples, most along z, keep their rims clean.
FINE = (240, 480, 420)
FRONT, REAR = 48.0, -52.0
# Fig. 12: a = a2 = 5 and p2 = 0.1 are printed; the pairs (a1, p1) are ours.
BODIES = ((8, 40), (8, 20), (6, 40), (10, 40), (10, 60), (12, 80))
SHEET = (12.0, 4.4)
BODY_BOX = ((-6.0, 8.0), (-2.4, 2.4), (-2.4, 2.4))


@dataclass(frozen=True)
class Drawing:
    """A finished figure and what it was made of."""

    figure: Figure
    letters: str
    triangles: int
    remark: str


@dataclass(frozen=True)
class Recipe:
    """One figure of the paper: its file name, its title, the seconds the paper gives, how to draw it."""

    name: str
    title: str
    published: str
    draw: Callable[[], Drawing]


def _car_recipe(
    name: str, title: str, published: str, stage: str, variant: str = "a", azimuth: float = FRONT
) -> Recipe:
    return Recipe(name, title, published, lambda: _draw_car(stage, variant, azimuth))


@lru_cache(maxsize=1)  # Fig. 9 shows one mesh from two sides
def _car_mesh(stage: str, variant: str) -> Mesh:
    return _told(car(variant, stage), FINE if stage == "W" else RESOLUTION)


def _told(shape: Shape, resolution: int | tuple[int, int, int]) -> Mesh:
    """A mesh whose warnings need no repeating: its status stands under the figure."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RsymWarning)
        return mesh(shape, resolution)


def _draw_car(stage: str, variant: str, azimuth: float) -> Drawing:
    shape, body = car(variant, stage), _car_mesh(stage, variant)
    figure = _figure_of(plot_mesh(body, azimuth=azimuth))
    return Drawing(figure, letters_text(shape.letters), body.status.triangles, str(body.status))


def _draw_triangulation() -> Drawing:
    """125 000 points, as the source: 50 along each axis."""
    shape = car()
    body = _told(shape, (50, 50, 50))
    figure = _figure_of(plot_mesh(body, azimuth=FRONT, edges=True))
    return Drawing(figure, letters_text(shape.letters), body.status.triangles, str(body.status))


def _figure_of(artist: Artist) -> Figure:
    figure = artist.get_figure()
    assert isinstance(figure, Figure)
    return figure


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
        result = mesh(solid, 200, bounds=BODY_BOX, letters={"a1": a1, "p1": p1})
        row, column = divmod(position, 3)
        # mplot3d draws into squares; slender bodies need only the middle of theirs, so the rows overlap.
        side = width / 3 / height
        ax = figure.add_axes((column / 3, 0.75 - row / 2 - side / 2, 1 / 3, side), projection="3d")
        ax.patch.set_visible(False)
        ax.set_in_layout(False)
        plot_mesh(result, ax=ax, elevation=16.0, azimuth=-68.0)
        figure.text((column + 0.5) / 3, 0.92 - row / 2, f"$a_1 = {a1}$, $p_1 = {p1}$", ha="center", fontsize=11)
        triangles += result.status.triangles
    # A trimmed picture is then the whole figure, not the squares that hang out of it.
    figure.add_artist(Rectangle((0, 0), 1, 1, transform=figure.transFigure, alpha=0))
    pairs = ", ".join(f"({a1}, {p1})" for a1, p1 in BODIES)
    printed = letters_text({name: letter for name, letter in body.letters.items() if name not in {"a1", "p1"}})
    remark = "the source does not print the pairs (a1, p1)"
    return Drawing(figure, f"{printed}, (a1, p1) = {pairs}", triangles, remark)


def letters_text(letters: Mapping[str, Letter]) -> str:
    """The letters as `name = value`, decimals short."""
    return ", ".join(f"{name} = {float(letter.default):g}" for name, letter in letters.items())


RECIPES: tuple[Recipe, ...] = (
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
    Recipe("fig10", "Triangulation of the car from 125 000 points", "", _draw_triangulation),
    Recipe("fig11", "Level lines of the six fields of the skeleton body", "", _draw_sheet),
    Recipe("fig12", "Bodies of revolution", "", _draw_bodies),
)
