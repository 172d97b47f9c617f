"""Cards: every shape of a collection with its portrait, its formula and its contract."""

from __future__ import annotations

import base64
import html
import io
import warnings
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, TypeAlias

import numpy as np
from matplotlib.artist import Artist
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure, SubFigure

from rsym.backends.kernel import compile
from rsym.errors import RsymError, RsymWarning, warn
from rsym.model.nodes import Composition
from rsym.model.requirements import require_mapping, require_shape
from rsym.model.shape import Bounds, Shape
from rsym.model.showing import latex
from rsym.model.symbols import rebuild
from rsym.output import axes3d
from rsym.output.bodies import Body
from rsym.output.looks import PLAIN, Look
from rsym.output.panels import draw_levels, named
from rsym.output.pictures import checked_titles, page, whole
from rsym.output.shading import AZIMUTH, ELEVATION
from rsym.output.surfaces import plot_mesh
from rsym.sampling.blanks import missing_boundary
from rsym.sampling.lattice import lattice_over
from rsym.sampling.level_lines import trace
from rsym.sampling.meshing import mesh
from rsym.sampling.plane import GivenField, plane_sampler
from rsym.sampling.windows import bounds_or_extent

Place: TypeAlias = tuple[float, float, float, float]
LEVEL_CELLS = 160  # along the longest side of a plane picture; a few milliseconds
MARGIN = 5.0  # points round a body
ROOM = 0.1  # of the longest side, seen round the bounds of a plane shape
PROBES = 24  # along the longest side, to see whether a field is negative anywhere
# Half the width of a curve drawn as a stroke, and the radius of one drawn as a tube, as shares of the longest side.
STROKE, TUBE = 0.01, 0.02
SIZE = (2.5, 2.0)  # inches of a picture
DPI = 144  # as sharp as fine screens are
QUALITY = 80  # of WebP: a third of what the same picture takes as a PNG
TITLE = 0.28  # inches for the name above a picture
LONG, LONGEST = 700, 6000  # characters of LaTeX: what is longer is folded, and what nobody would read is left out


@dataclass(frozen=True)
class Card:
    """A shape with its name and its picture, in the format WebP."""

    name: str
    shape: Shape = field(repr=False)
    picture: bytes = field(repr=False)

    def _repr_html_(self) -> str:
        name, contract = html.escape(self.name), self.shape.contract()
        image = base64.b64encode(self.picture).decode()
        lines = (
            f"<b>{name}</b>",
            f'<img style="width: 100%" alt="{name}" src="data:image/webp;base64,{image}">',
            *_formulas(self.shape),
            _folded(str(contract).partition("\n")[0].replace("omega", "ω"), contract._repr_html_()),
        )
        return "".join(f'<div style="overflow-x: auto; margin: 2px">{line}</div>' for line in lines)


@dataclass(frozen=True)
class Cards:
    """Cards that a notebook shows in so many columns."""

    cards: tuple[Card, ...]
    columns: int

    def _repr_html_(self) -> str:
        style = f"display: grid; grid-template-columns: repeat({self.columns}, minmax(0, 1fr)); gap: 1.2em"
        return f'<div style="{style}">{"".join(f"<div>{card._repr_html_()}</div>" for card in self.cards)}</div>'


def cards(
    shapes: Mapping[str, Shape], *, columns: int = 3, resolution: int | None = None, reach: float | None = None
) -> Cards:
    """Cards of shapes for a notebook: name, picture, formula and contract of each.

    Parameters
    ----------
    shapes : mapping
        The shapes by name, in the plane or in space.
    resolution : int, optional
        Cells along the longest side of a mesh; without it bodies are drawn by rays cast at their equations.
    reach : float, optional
        What is seen of shapes without bounds: each coordinate from -reach to reach. Without it, their extent.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> shown = cards({"disc": rsym.Shape((1 - x**2 - y**2) / 2, (x, y))})
    >>> shown.cards[0].picture[8:12]
    b'WEBP'
    """
    _check(shapes)
    return Cards(
        tuple(Card(name, shape, _picture(shape, resolution, reach)) for name, shape in shapes.items()), columns
    )


def plot_gallery(
    shapes: Mapping[str, Shape | GivenField],
    *,
    columns: int = 4,
    resolution: int | None = None,
    reach: float | None = None,
    figure: Figure | SubFigure | None = None,
    titles: Sequence[str] | None = None,
    limits: tuple[float, float] | None = None,
    colour_map: str | None = None,
) -> Figure:
    """Pictures of shapes in rows and columns, each under its name.

    Parameters
    ----------
    shapes, columns, resolution, reach
        As for `cards`; solutions in the plane, too, what is outside of them white.
    figure : Figure or SubFigure, optional
        Where to draw, in the size that it has; without it a new pyplot figure is made.
    titles : sequence of str, optional
        Instead of the names.
    limits, colour_map
        Of omega in the plane, as for `plot_field`: with limits all pictures share one scale.

    Returns
    -------
    Figure
        The whole figure, also where a part of it was given.

    Warns
    -----
    RsymWarning
        For a shape in the plane without a boundary in what is seen of it.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> figure = plot_gallery({"line": rsym.Shape(x, (x, y)), "disc": rsym.Shape(1 - x**2 - y**2, (x, y))}, reach=2)
    >>> [text.get_text() for text in figure.texts]
    ['line', 'disc']
    """
    _check({name: one.shape if isinstance(one, GivenField) else one for name, one in _named(shapes).items()})
    look, headings = Look(None, limits, colour_map), checked_titles(titles, list(shapes))
    across = min(columns, len(shapes))
    rows = -(-len(shapes) // across)
    height = (SIZE[1] + TITLE) * rows
    drawn = page(figure, size=(SIZE[0] * across, height))
    for position, (name, shape) in enumerate(shapes.items()):
        row, column = divmod(position, across)
        left, top = column / across, 1 - row / rows
        place = (left, top - 1 / rows, 1 / across, SIZE[1] / height)
        with named(name):
            draw_portrait(shape, drawn, place, resolution=resolution, bounds=_seen(shape, reach), look=look)
        drawn.text(left + 0.5 / across, top - TITLE / 2 / height, headings[position], ha="center", va="center")
    return whole(drawn)


def _formulas(shape: Shape) -> Iterator[str]:
    """The formula; then its compositions, which have names in it, written out."""
    text = latex(shape)
    yield _typeset(text) if len(text) < LONG else _folded("formula", _typeset(text))
    whole = rebuild(shape.expression, lambda part: part.composition() if isinstance(part, Composition) else None)
    if whole != shape.expression and len(text := latex(shape.replace(expression=whole))) < LONGEST:
        yield _folded("written out", _typeset(text))


def _typeset(text: str) -> str:
    return f"${html.escape(text)}$"


def _folded(summary: str, page: str) -> str:
    return f"<details><summary>{html.escape(summary)}</summary><small>{page}</small></details>"


def _picture(shape: Shape, resolution: int | None, reach: float | None) -> bytes:
    figure = Figure(SIZE, dpi=DPI)
    draw_portrait(shape, figure, resolution=resolution, bounds=_seen(shape, reach))
    data = io.BytesIO()
    FigureCanvasAgg(figure).print_webp(data, pil_kwargs={"quality": QUALITY})
    return data.getvalue()


def _seen(shape: Shape | GivenField, reach: float | None) -> Bounds | None:
    if isinstance(shape, GivenField):
        return None
    return None if shape.box or reach is None else ((-reach, reach),) * shape.dimension


def _named(shapes: Any) -> Mapping[str, Any]:
    return require_mapping(shapes, "shape", 'for example {"disc": rsym.disc()}')


def _check(shapes: Mapping[str, Shape]) -> None:
    for shape in _named(shapes).values():
        require_shape(shape)
    if not shapes:
        raise RsymError("a gallery needs a shape at least", code="empty", remedy='for example {"disc": rsym.disc()}')


def draw_portrait(
    shape: Shape | GivenField,
    figure: Figure | SubFigure,
    place: Place = (0.0, 0.0, 1.0, 1.0),
    *,
    resolution: int | None = None,
    bounds: Any = None,
    elevation: float = ELEVATION,
    azimuth: float = AZIMUTH,
    look: Look = PLAIN,
) -> Artist:
    """Draw a shape into a part of a figure: level lines in the plane, a shaded body in space.

    The boundary in the plane is a heavy line. A field that is nowhere negative has no inside: the curve on which it
    is zero is drawn as a stroke, in space as a thin tube. What leaves the bounds ends there.

    Parameters
    ----------
    place : four numbers
        Left, bottom, width and height as shares of the figure.
    resolution : int, optional
        Cells along the longest side of a mesh; without it a body is drawn by rays cast at its equation.
    bounds : optional
        Instead of those of the shape; without either its extent is found.
    elevation, azimuth : float
        As for `plot_mesh`.
    look : Look
        Of level lines.

    Examples
    --------
    >>> import matplotlib.figure, rsym
    >>> from rsym import x, y
    >>> disc = rsym.Shape(1 - x**2 - y**2, (x, y), bounds=((-2, 2), (-2, 2)))
    >>> type(draw_portrait(disc, matplotlib.figure.Figure())).__name__
    'QuadContourSet'
    """
    if isinstance(shape, GivenField):
        if shape.shape.dimension == 3:
            raise RsymError(
                "a solution in space has no portrait", code="dimension",
                remedy="plot_field(solution, section={z: 0}), or its shape, solution.shape",
            )  # fmt: skip
        box = bounds_or_extent(shape.shape, bounds)
        return _draw_levels(shape, box, figure, place, replace(look, outside=look.outside or "mask"))
    box = bounds_or_extent(shape, bounds)
    if shape.dimension == 2:
        return _draw_levels(shape, box, figure, place, look)
    axes = axes3d.add_axes(figure, place)
    with warnings.catch_warnings():
        # Bodies without end are cut on purpose, and a small picture shows no more than its cells do.
        warnings.simplefilter("ignore", RsymWarning)
        body = _thickened(shape, box)
        shown = body if resolution is None else mesh(body, resolution)
    artist = plot_mesh(shown, ax=axes, elevation=elevation, azimuth=azimuth)
    axes.set_axis_off()
    fill(figure, artist, place)
    return artist


def fill(figure: Figure | SubFigure, artist: Body, place: Place) -> None:
    """Enlarge the axes about the body until it fills the place."""
    axes: Any = artist.axes
    page = np.tile(figure.bbox.size, 2)
    left, bottom, width, height = np.array(place) * page
    body = artist.get_window_extent()
    room = 2 * MARGIN * figure.dpi / 72
    growth = min((width - room) / body.width, (height - room) / body.height)
    middle = np.array([left + width / 2, bottom + height / 2])
    corner = middle - growth * (np.array([body.x0 + body.x1, body.y0 + body.y1]) / 2 - axes.bbox.min)
    axes.set_position(np.concatenate([corner, growth * axes.bbox.size]) / page)


def _draw_levels(
    shape: Shape | GivenField, box: Bounds, figure: Figure | SubFigure, place: Place, look: Look
) -> Artist:
    """Level lines that fill the place."""
    width, height = np.array(place[2:]) * figure.bbox.size
    options: Any = {"resolution": LEVEL_CELLS, "bounds": _view(box, width / height)}
    sampler = omega = plane_sampler(shape, "value", **options)
    values = logic = sampler.values()
    if isinstance(shape, GivenField):
        shape = shape.shape
        omega = plane_sampler(shape, "value", **options)
        logic = omega.values()
    unsigned = np.nanmin(logic) >= 0
    boundary = () if unsigned else trace(omega, 0.0, values=logic)
    if remark := missing_boundary(shape, omega, logic, boundary):
        warn(remark)
    ax = figure.add_axes(place)
    artist = draw_levels(ax, sampler, values, look.levels_of(values, sampler.field, logic > 0), boundary, look, logic)
    u, v = sampler.lattice.axis(0), sampler.lattice.axis(1)
    if unsigned:
        ax.contourf(u, v, values.T, levels=[-1.0, STROKE * _longest(box)], colors="black")
    ax.set(xlim=(u[1], u[-2]), ylim=(v[1], v[-2]), aspect="equal")
    ax.set_axis_off()
    return artist


def _view(box: Bounds, proportion: float) -> Bounds:
    """A box of this width over height round another, with some room."""
    middle = [(low + high) / 2 for low, high in box]
    sides = [high - low + 2 * ROOM * _longest(box) for low, high in box]
    width = max(sides[0], sides[1] * proportion)
    halves = (width / 2, width / proportion / 2)
    return tuple((place - half, place + half) for place, half in zip(middle, halves, strict=True))


def _thickened(shape: Shape, box: Bounds) -> Shape:
    """The shape; a tube round the curve where it is nowhere negative."""
    values = compile(shape)(*lattice_over(box, PROBES).open_axes())["value"]
    if np.nanmin(values) < 0:
        return shape.replace(bounds=box)
    radius = TUBE * _longest(box)
    wider = tuple((low - 2 * radius, high + 2 * radius) for low, high in box)
    return shape.replace(expression=radius - shape.expression, bounds=wider)


def _longest(box: Bounds) -> float:
    return max(high - low for low, high in box)
