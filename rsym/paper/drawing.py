"""What a recipe makes: a finished figure and what it was made of."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from matplotlib.artist import Artist
from matplotlib.figure import Figure

from rsym.errors import RsymWarning
from rsym.model.letters import Letter
from rsym.model.shape import Shape
from rsym.output.surfaces import ShadedMesh
from rsym.sampling.mesh import Mesh
from rsym.sampling.meshing import mesh


@dataclass(frozen=True)
class Table:
    """Rows of text under a header."""

    header: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]


@dataclass(frozen=True)
class Drawing:
    """A finished figure and what it was made of; `files` are written beside it, by name."""

    figure: Figure
    letters: str
    triangles: int
    remark: str
    table: Table | None = None
    files: Mapping[str, bytes] = field(default_factory=dict)


@dataclass(frozen=True)
class Recipe:
    """One figure: its file name, its title, the seconds the source gives, how to draw it.

    `model` is a shipped model and one of its formulas, whose definitions the page shows;
    `equations` are further ones, in LaTeX.
    """

    name: str
    title: str
    published: str
    draw: Callable[[], Drawing]
    model: tuple[str, str] | None = None
    equations: tuple[str, ...] = ()


@dataclass(frozen=True)
class Reproduced:
    """One figure on disk and how it came about; `seconds` covers model, mesh and picture."""

    name: str
    title: str
    path: Path
    letters: str
    triangles: int
    seconds: float
    published: str
    remark: str
    table: Table | None = None
    files: tuple[str, ...] = ()
    model: tuple[str, str] | None = None
    equations: tuple[str, ...] = ()


def figure_of(artist: Artist) -> Figure:
    """The figure that an artist is in."""
    figure = artist.get_figure()
    assert isinstance(figure, Figure)
    return figure


def drawing_of(figure: Figure, shape: Shape, body: Mesh, remark: str) -> Drawing:
    """The drawing of one mesh of a shape; its status stands behind the remark."""
    return Drawing(figure, letters_text(shape.letters), body.status.triangles, f"{remark}; {body.status}")


def triangles_in(figure: Figure) -> int:
    """The triangles of all bodies that a figure shows."""
    bodies = [artist for ax in figure.axes for artist in ax.artists if isinstance(artist, ShadedMesh)]
    return sum(len(body.mesh.faces) for body in bodies)


def letters_text(letters: Mapping[str, Letter]) -> str:
    """The letters as `name = value`, decimals short."""
    return ", ".join(f"{name} = {float(letter.default):g}" for name, letter in letters.items())


def mesh_quietly(
    shape: Shape, resolution: int | Sequence[int], *, method: str = "sharp", bounds: Any = None, letters: Any = None
) -> Mesh:
    """A mesh whose warnings need no repeating: its status stands under the figure, or its box is clipped on purpose."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RsymWarning)
        return mesh(shape, resolution, method=method, bounds=bounds, letters=letters)
