"""Sweeps: one letter as a strip of small multiples, all drawn alike."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from matplotlib.figure import Figure, SubFigure
from mpl_toolkits.mplot3d import Axes3D
from numpy.typing import NDArray

from rsym.errors import RsymError, warn
from rsym.model.abridging import typeset_name
from rsym.model.letters import Letter
from rsym.model.requirements import require_shape
from rsym.model.shape import Shape
from rsym.output import axes3d
from rsym.output.boundaries import LEGEND, draw_parts
from rsym.output.looks import Look
from rsym.output.panels import colour_bar, columns_of, draw_levels, dress, named
from rsym.output.pictures import checked_titles, page, whole
from rsym.output.shading import AZIMUTH, ELEVATION
from rsym.output.surfaces import plot_mesh
from rsym.sampling.blanks import missing_boundary
from rsym.sampling.level_lines import trace
from rsym.sampling.mesh import Mesh
from rsym.sampling.meshing import mesh
from rsym.sampling.plane import GivenField, PlaneSampler, plane_sampler
from rsym.sampling.progress import Progress, report

PLANE_RESOLUTION, SPACE_RESOLUTION = 300, 192
PANEL = 3.2  # inches, the longer side of a panel in the plane
BODY = 4.2  # inches, the width of a panel with a body
TITLE = 0.3  # inches


@dataclass(frozen=True)
class _Panel:
    """One value: all letters, and how the picture and an error speak of the one that changes."""

    letters: Mapping[str, float]
    title: str
    label: str


def plot_sweep(
    shape: Shape | GivenField,
    letter: Any,
    values: Sequence[float],
    *,
    columns: int | None = None,
    resolution: int | Sequence[int] | None = None,
    bounds: Any = None,
    letters: Mapping[Any, float] | None = None,
    section: Mapping[Any, float] | None = None,
    figure: Figure | SubFigure | None = None,
    levels: Sequence[float] | None = None,
    limits: tuple[float, float] | None = None,
    titles: Sequence[str] | None = None,
    colour_map: str | None = None,
    outside: str | None = None,
    elevation: float = ELEVATION,
    azimuth: float = AZIMUTH,
    progress: Progress | None = None,
    force: bool = False,
) -> Figure:
    r"""The same shape at several values of one letter, side by side.

    A shape in the plane, or a section, is drawn by the level lines of omega, with
    the boundary heavy and with the same levels and colours in all panels; a shape
    in space as shaded bodies in the same box, seen by the same camera. A solution is
    found anew for each value, with nothing compiled, and drawn on its shape there.

    Parameters
    ----------
    shape : Shape, Solution or Torsion
        What to draw; `revolve` a plane shape first to see bodies. A solution in space needs a section.
    letter : str or symbol
        The letter that changes.
    values : sequence of float
        Its values, one for each panel, row by row.
    columns : int, optional
        Panels in a row.
    resolution : int or sequence of int, optional
        Cells along the longest side: 300 in the plane, 192 in space.
    bounds, letters, section
        As for `plot_field` and `mesh`; `letters` sets the others.
    figure : Figure or SubFigure, optional
        Where to draw, in the size that it has; without it a new pyplot figure is made.
    levels, limits, colour_map, outside
        Of pictures in the plane, all alike, as for `plot_field`.
    titles : sequence of str, optional
        One for each panel, instead of the letter and its value.
    elevation, azimuth : float
        The camera of bodies, as for `plot_mesh`.
    progress : callable, optional
        ``progress(done, total)``; returning False cancels with an RsymError.
    force : bool
        Whether to go on where the estimate says that there is not memory enough.

    Returns
    -------
    Figure
        The whole figure, also where a part of it was given.

    Raises
    ------
    RsymError
        For an unknown letter, a value outside its range, a shape that cannot be drawn at one of the values, a cancel.

    Examples
    --------
    >>> import rsym
    >>> figure = rsym.plot_sweep(rsym.paper.skeleton_body(), "p1", [20, 40], resolution=32)
    >>> print(*(ax.get_title() for ax in figure.axes[:2]))
    $p_{1} = 20$ $p_{1} = 40$
    >>> import sympy
    >>> r = sympy.Symbol("r")
    >>> u = rsym.solve(rsym.disc(r, letters={r: 1}), "-laplacian(u) = 1", 0, cells=8)
    >>> figure = rsym.plot_sweep(u, r, [1, 2], resolution=32)
    >>> print(*(ax.get_title() for ax in figure.axes[:2]))
    $r = 1$ $r = 2$
    """
    field_on = shape
    if isinstance(shape, GivenField):
        shape, outside = shape.shape, outside or "mask"
    require_shape(shape)
    name = str(letter)
    look = Look(levels, limits, colour_map, outside)
    panels = [_panel(shape, name, {**(letters or {}), name: value}) for value in values]
    if not panels:
        raise RsymError("a sweep needs at least one value", code="values", remedy="for example [20, 40, 80]")
    headings = checked_titles(titles, [panel.title for panel in panels])
    panels = [replace(panel, title=title) for panel, title in zip(panels, headings, strict=True)]
    count = _columns(columns, len(panels))
    if shape.dimension == 2 or section or isinstance(field_on, GivenField):
        cells = PLANE_RESOLUTION if resolution is None else resolution
        options: Any = {"resolution": cells, "section": section, "held": len(panels), "force": force}
        if isinstance(field_on, GivenField):
            pairs = _solved(field_on, panels, bounds, options, progress)
        else:
            sampler = plane_sampler(shape, "value", bounds=bounds, **options)
            pairs = [(one, one) for one in (sampler.at(panel.letters) for panel in panels)]
        return _plane(pairs, panels, count, look, figure, progress)
    cells = SPACE_RESOLUTION if resolution is None else resolution
    bodies = []
    for done, panel in enumerate(panels):
        report(progress, done, len(panels))
        with named(panel.label):
            bodies.append(mesh(shape, cells, bounds=bounds, letters=panel.letters, force=force))
    report(progress, len(panels), len(panels))
    return _space(bodies, panels, count, elevation, azimuth, figure)


def letter_title(name: str, letter: Letter, value: float) -> str:
    """A letter and its value for a title: name, number, unit.

    Examples
    --------
    >>> letter_title("p1", Letter(20, unit="mm"), 40.0)
    '$p_{1} = 40$ mm'
    """
    return f"${typeset_name(name)} = {value:.6g}$ {letter.unit}".strip()


def _panel(shape: Shape, name: str, letters: Mapping[Any, float]) -> _Panel:
    values = shape.letters.values_with(letters)
    return _Panel(values, letter_title(name, shape.letters[name], values[name]), f"{name} = {values[name]:.6g}")


def _columns(columns: int | None, count: int) -> int:
    if columns is None:
        return columns_of(count)
    if isinstance(columns, bool) or not isinstance(columns, int) or columns < 1:
        raise RsymError(f"columns must be a positive integer, got {columns!r}", code="columns")
    return min(columns, count)


def _solved(
    field_on: GivenField, panels: Sequence[_Panel], bounds: Any, options: Any, progress: Progress | None
) -> list[tuple[PlaneSampler, PlaneSampler]]:
    """The solution and omega of its shape at the letters of each panel, within bounds that hold all of them."""
    found = []
    for panel in panels:
        report(progress, 0, len(panels))
        with named(panel.label):
            found.append(field_on.with_letters(panel.letters))
    if bounds is None:
        views = [plane_sampler(one.shape, "value", **options).bounds for one in (field_on, *found)]
        low, high = np.array(views)[..., 0].min(axis=0), np.array(views)[..., 1].max(axis=0)
        bounds = tuple(zip(low.tolist(), high.tolist(), strict=True))
    options = {**options, "bounds": bounds}
    return [(plane_sampler(one, "value", **options), plane_sampler(one.shape, "value", **options)) for one in found]


def _plane(
    pairs: Sequence[tuple[PlaneSampler, PlaneSampler]],
    panels: Sequence[_Panel],
    columns: int,
    look: Look,
    figure: Figure | SubFigure | None,
    progress: Progress | None,
) -> Figure:
    """What is drawn, and omega, in panels with the same levels."""
    sampler = pairs[0][0]
    samples = [one.values() for one, _ in pairs]
    logics = [values if omega is one else omega.values() for values, (one, omega) in zip(samples, pairs, strict=True)]
    levels = look.levels_of(np.concatenate(samples), sampler.field, np.concatenate(logics) > 0)
    extend = look.beyond(levels, np.stack(samples), np.stack(logics))
    rows = -(-len(panels) // columns)
    sides = np.array(sampler.lattice.spacing) * sampler.lattice.counts
    width, height = PANEL * sides / sides.max()
    size = (columns * (width + 0.4) + 0.8, rows * (height + 0.55))
    drawn = page(figure, layout="compressed", size=size)
    axes = drawn.subplots(rows, columns, squeeze=False, sharex=True, sharey=True)
    parts: dict[str, Any] = {}
    for done, (ax, (one, omega), values, logic, panel) in enumerate(
        zip(axes.flat, pairs, samples, logics, panels, strict=False)
    ):
        report(progress, done, len(panels))
        with named(panel.label):
            boundary = trace(omega, 0.0, values=logic)
            artist = draw_levels(ax, one, values, levels, boundary, look, logic, extend=extend)
            remark = missing_boundary(omega.shape, omega, logic, boundary)
            if remark:
                warn(remark)
            if omega is not one:
                parts |= {str(artist.get_label()): artist for artist in draw_parts(ax, omega, legend=False)}
        dress(ax, one, panel.title)
        ax.label_outer()
    for ax in axes.flat[len(panels) :]:
        ax.set_axis_off()
    colour_bar(artist, *axes.flat, rows=rows)
    if parts:
        drawn.legend(handles=list(parts.values()), loc="outside lower center", ncols=len(parts), **LEGEND)
    report(progress, len(panels), len(panels))
    return whole(drawn)


def _space(
    bodies: Sequence[Mesh],
    panels: Sequence[_Panel],
    columns: int,
    elevation: float,
    azimuth: float,
    figure: Figure | SubFigure | None,
) -> Figure:
    corners = np.concatenate([body.vertices[np.unique(body.faces)] for body in bodies])
    low, high = corners.min(axis=0), corners.max(axis=0)
    drawn, cells = _cells(low, high, len(bodies), columns, elevation, azimuth, figure)
    for body, panel, (heading, axes) in zip(bodies, panels, cells, strict=True):
        heading.text(0.5, 0.4, panel.title, ha="center", va="center", fontsize=12)
        plot_mesh(body, ax=axes)
        axes3d.frame(axes, low, high, elevation, azimuth)
        axes3d.style(axes)
    return whole(drawn)


def _cells(
    low: NDArray[np.float64],
    high: NDArray[np.float64],
    count: int,
    columns: int,
    elevation: float,
    azimuth: float,
    figure: Figure | SubFigure | None,
) -> tuple[Figure | SubFigure, list[tuple[SubFigure, Axes3D]]]:
    """A figure with a heading and axes for each body, placed as `page_axes` places them on a page of their own."""
    alone = Figure()
    place = axes3d.page_axes(alone, low, high, elevation, azimuth).get_position(original=True)
    width, height = alone.get_size_inches()
    rows, body = -(-count // columns), BODY * height / width
    drawn: Any = page(figure, size=(columns * BODY, rows * (TITLE + body)))
    parts = drawn.subfigures(2 * rows, columns, squeeze=False, height_ratios=[TITLE, body] * rows)
    cells = []
    for number in range(count):
        row, column = divmod(number, columns)
        cells.append((parts[2 * row, column], axes3d.add_axes(parts[2 * row + 1, column], place)))
    return drawn, cells
