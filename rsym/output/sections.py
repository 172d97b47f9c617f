"""Stacks of sections: a picture in axonometric view, and layers in true scale as SVG or DXF."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.collections import PathCollection
from matplotlib.colors import Normalize
from matplotlib.path import Path as Outline

from rsym.arrays import Floats
from rsym.errors import RsymError, warn
from rsym.model.requirements import several
from rsym.output.cameras import Camera
from rsym.output.layers import Layer, Layers, checked_suffix, layer_of, write_layers
from rsym.output.paints import checked_limits, checked_map
from rsym.output.pictures import require_axes
from rsym.output.shading import AZIMUTH
from rsym.output.units import check_unit
from rsym.sampling.sections import Section

COLOUR_MAP = "viridis"
LIGHTEST = 0.92  # the bright end of a map is too pale for thin lines on white paper
FILL = 0.22  # the share of a layer's colour in its fill; the rest is white


def plot_sections(
    sections: Sequence[Section],
    *,
    ax: Axes | None = None,
    elevation: float = 28.0,
    azimuth: float = AZIMUTH,
    limits: tuple[float, float] | None = None,
    colour_map: str = COLOUR_MAP,
) -> PathCollection:
    """Draw sections as a stack in axonometric view, each coloured by its place.

    Parallel projection, so that equal lengths stay equal from layer to layer;
    nearer layers cover those behind them.

    Parameters
    ----------
    sections : sequence of Section
        What `sections` returned.
    ax : matplotlib axes, optional
        Where to draw, in the plane; without it a new figure with a colour bar is made.
    elevation, azimuth : float
        The direction of the eye in degrees, as for `plot_mesh`.
    limits : pair of numbers, optional
        The values of the ends of the colours, so that several stacks share them; without it those of the stack.
    colour_map : str
        A name that matplotlib knows.

    Returns
    -------
    matplotlib.collections.PathCollection
        The stack, fit for a colour bar: one path for each section that has lines, the farthest first, and one for
        each of its lines that end.

    Raises
    ------
    RsymError
        If no section has a line.

    Examples
    --------
    >>> import matplotlib.figure, rsym
    >>> from rsym import x, y, z
    >>> ball = rsym.Shape(1 - x**2 - y**2 - z**2, (x, y, z), bounds=((-2, 2),) * 3)
    >>> stack = rsym.sections(ball, [-0.5, 0, 0.5], resolution=32)
    >>> len(rsym.plot_sections(stack, ax=matplotlib.figure.Figure().add_subplot()).get_paths())
    3
    """
    shown = _with_lines(sections)
    alone = ax is None
    if ax is None:
        import matplotlib.pyplot

        _, ax = matplotlib.pyplot.subplots(figsize=(8, 6), layout="constrained")
    require_axes(ax)
    screen = Camera(elevation, azimuth).axes
    low, high = (shown[0].value, shown[-1].value) if limits is None else checked_limits(limits)
    margin = (high - low or 1.0) * (1 / LIGHTEST - 1)
    colours = ScalarMappable(Normalize(low, high + margin), colormaps[str(checked_map(colour_map))])
    toward = screen[2, shown[0].normal]
    drawn = [
        one
        for section in sorted(shown, key=lambda section: section.value * toward)
        for one in _outlines(section, screen[:2], colours.to_rgba(np.array([section.value]))[0])
    ]
    outlines, fills, strokes = zip(*drawn, strict=True)
    stack = PathCollection(outlines, facecolors=fills, edgecolors=strokes, linewidths=0.9)
    stack.set(norm=colours.norm, cmap=colours.get_cmap())
    ax.add_collection(stack)
    ax.set_aspect("equal")
    ax.autoscale_view()
    ax.set_axis_off()
    if alone:
        bar = ax.figure.colorbar(colours, ax=ax, shrink=0.6, pad=0.02)
        bar.set_label(f"${shown[0].axis}$")
        bar.ax.set_ylim(shown[0].value, shown[-1].value) if len(shown) > 1 else None
    return stack


def _with_lines(sections: Sequence[Section]) -> list[Section]:
    """Return the sections that meet the body, in the order of their values."""
    given = several(Section, sections, "section")
    shown = sorted((section for section in given if len(section.lines)), key=lambda section: section.value)
    if not shown:
        raise RsymError(
            "none of the planes meets the body", code="no-surface", remedy="choose values inside the bounds"
        )
    missed = [f"{section.axis} = {section.value:.6g}" for section in given if not len(section.lines)]
    if missed:
        met = dict.fromkeys(f"{section.value:.6g}" for section in (shown[0], shown[-1]))
        within = f"{shown[0].axis} = {' to '.join(met)}"
        warn(f"no boundary in the sections {', '.join(missed)}; remedy: values about those that meet one, {within}")
    return shown


def _outlines(section: Section, screen: Floats, colour: Floats) -> Iterator[tuple[Outline, Floats, Floats]]:
    """The closed lines with their fill (holes stay open: they run the other way round), then those that end."""
    lines = [section.in_space(line) @ screen.T for line in section.lines]
    closed = [line for line in lines if (line[0] == line[-1]).all()]
    outline = Outline.make_compound_path(*(Outline(line, closed=True) for line in closed)) if closed else None
    yield outline or Outline(np.empty((0, 2))), np.append(1 - FILL * (1 - colour[:3]), 1.0), colour
    for line in lines:
        if not (line[0] == line[-1]).all():
            yield Outline(line), np.zeros(4), colour


def write_sections(
    sections: Sequence[Section], path: str | os.PathLike[str], *, unit: str = "mm", scale: float = 1.0
) -> Path:
    """Write sections as layers of one SVG or DXF file in true scale, for a mill or a laser.

    In SVG a group for each section, named ``z=0.5``; in DXF (release 12, ASCII) a layer ``Z_0P5``
    of polylines at the height of the section, closed where the lines are, to the last digit.
    The same length of the model has the same length on every layer and along both axes.
    The file appears whole or not at all, and the same sections give the same bytes.

    Parameters
    ----------
    sections : sequence of Section
        What `sections` returned, all along one axis.
    path : str or path-like
        Where to; the name ends in ``.svg`` or ``.dxf``.
    unit : {"mm", "cm", "m", "in"}
        The unit of the file.
    scale : float
        How many units one unit of the model becomes.

    Raises
    ------
    RsymError
        For another suffix or unit, a scale that is not positive, sections along several axes, or none with a line.

    Examples
    --------
    >>> import tempfile, rsym
    >>> from rsym import x, y, z
    >>> ball = rsym.Shape(1 - x**2 - y**2 - z**2, (x, y, z), bounds=((-2, 2),) * 3)
    >>> stack = rsym.sections(ball, [0, 0.5], resolution=32)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     text = rsym.write_sections(stack, folder + "/ball.svg", scale=10).read_text()
    >>> text.count("<g "), "1 unit of the model is 10 mm" in text
    (3, True)
    """
    path = checked_suffix(path, "sections")
    check_unit(unit, scale)
    shown = _with_lines(sections)
    if len({section.axis for section in shown}) != 1:
        raise RsymError("layers of one file must have one axis", code="section", remedy="write a file for each axis")
    return write_layers(layers_of(shown), path, unit, scale)


def layers_of(shown: Sequence[Section]) -> Layers:
    """Sections along one axis as layers, each at its height.

    Examples
    --------
    >>> import rsym
    >>> (layer,) = layers_of(rsym.sections(rsym.sphere(1), [-0.5], resolution=16)).each
    >>> layer.name, layer.height, len(layer.lines)
    ('z=-0.5', -0.5, 1)
    """
    each = [Layer(layer_of(one.axis, one.value), one.lines, one.value) for one in shown]
    return Layers(f"Sections {shown[0].axis} = constant", shown[0].coordinates, each)
