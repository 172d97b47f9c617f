"""Layers: lines in a plane under names, in true scale as SVG or DXF, for a mill, a laser or another program."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from xml.sax.saxutils import escape, quoteattr

import numpy as np

from rsym.arrays import Floats
from rsym.atomic import write_atomically
from rsym.errors import RsymError, warn
from rsym.model.letters import real_number
from rsym.model.requirements import file_path
from rsym.model.shape import Shape
from rsym.output.dxf import layer_name, layers_dxf
from rsym.output.looks import Look
from rsym.output.units import UNITS
from rsym.sampling.level_lines import level_lines, trace
from rsym.sampling.plane import GIVEN, GivenField, plane_sampler

LAYERS = (".svg", ".dxf")
DIGITS = 9  # significant digits of coordinates in SVG; a metre to a nanometre
RESOLUTION, COARSE = 512, 160  # of lines, and to choose levels by


@dataclass(frozen=True)
class Layer:
    """Lines (n, 2) under a name; in a drawing in space they lie at a height."""

    name: str
    lines: Sequence[Floats]
    height: float = 0.0


@dataclass(frozen=True)
class Layers:
    """Layers in a plane of two coordinates, and what they are.

    Examples
    --------
    >>> line = np.array([[0.0, 0.0], [2.0, 1.0]])
    >>> layers = Layers("Lines", ("x", "y"), (Layer("u=-0.5", [line]),))
    >>> svg(layers, "mm", 10).count("<g "), dxf(layers, "mm", 10).count(b"U_-0P5")
    (2, 5)
    """

    title: str
    coordinates: tuple[str, str]
    each: Sequence[Layer]


def level_layers(of: Shape | GivenField, levels: Any, resolution: int | Sequence[int] | None) -> Layers:
    """The outline of a shape in the plane, and level lines of omega or of what was solved on it, a layer for each.

    Without levels those of a solution are round ones as `plot_field` chooses, and a shape has its outline alone.

    Examples
    --------
    >>> import rsym
    >>> u = rsym.solve(rsym.disc(1), "-laplacian(u) = 4", 0, cells=8)
    >>> [layer.name for layer in level_layers(u, [0.25, 0.5], 32).each]
    ['outline', 'u=0.25', 'u=0.5']
    >>> [layer.name for layer in level_layers(rsym.disc(1), [0, 0.25], 32).each]
    ['outline', 'omega=0.25']
    """
    shape, solved = (of.shape, True) if isinstance(of, GivenField) else (of, False)
    if shape.dimension != 2:
        raise RsymError(
            f"{' and '.join(LAYERS)} hold lines in the plane, and this is in space",
            code="section",
            remedy="end the name with .vtu"
            if solved
            else "rsym.write_sections(rsym.sections(shape, [0.0]), path), or end the name with .html",
        )
    fine: Any = {"resolution": RESOLUTION if resolution is None else resolution}
    sampler = plane_sampler(shape, "value", **fine)
    outline = trace(sampler, 0.0, bounds=sampler.bounds)
    if not outline.lines:
        raise RsymError(
            "the shape has no outline in its bounds", code="no-surface", remedy="widen them, or a larger resolution="
        )
    chosen = _round_levels(of) if levels is None and isinstance(of, GivenField) else _numbers(levels)
    # The level 0 of omega is the outline, with its corners.
    wanted = [one for one in chosen if solved or one != 0]
    lines = level_lines(of, wanted, **fine) if wanted else ()
    name = GIVEN if solved else "omega"
    missed = [f"{one.level:g}" for one in lines if not one.lines]
    if missed and levels is not None:
        warn(f"{name} has no lines at {', '.join(missed)}; remedy: levels between its least and greatest value")
    found = [Layer(layer_of(name, one.level), one.lines) for one in lines if one.lines]
    title = f"Level lines of {name}" if found else "Outline"
    return Layers(title, sampler.names, (Layer("outline", outline.lines), *found))


def _round_levels(of: GivenField) -> list[float]:
    inside = plane_sampler(of.shape, "value", resolution=COARSE).values() > 0
    values = plane_sampler(of, "value", resolution=COARSE).values()
    found: list[float] = Look(outside="mask").levels_of(values, GIVEN, inside).tolist()
    return found


def _numbers(levels: Any) -> list[float]:
    several = isinstance(levels, Sequence | np.ndarray) and not isinstance(levels, str)
    given = levels if several else [] if levels is None else [levels]
    return [float(real_number(one, "a level")) for one in given]


def layer_of(name: str, value: float) -> str:
    """What the layer is called where something has a value: z=0.5."""
    return f"{name}={value:.{DIGITS}g}"


def checked_suffix(path: str | os.PathLike[str], what: str) -> Path:
    """A path that a drawing can be written to."""
    path = file_path(path)
    if path.suffix.lower() not in LAYERS:
        raise RsymError(
            f"{what} are written as {' or '.join(LAYERS)}, got {str(path)!r}",
            code="suffix",
            remedy=f"end the name with {' or '.join(LAYERS)}",
        )
    return path


def longest_side(layers: Layers) -> float:
    """Of the box of all lines."""
    points = np.concatenate([line for layer in layers.each for line in layer.lines])
    return float(np.ptp(points, axis=0).max())


def write_layers(layers: Layers, path: Path, unit: str, scale: float) -> Path:
    """Write layers in a unit, of which one of the model becomes so many."""
    if path.suffix.lower() == ".dxf":
        return write_atomically(path, dxf(layers, unit, scale))
    if unit == "m":  # which SVG does not know
        unit, scale = "mm", scale * UNITS["m"].metres / UNITS["mm"].metres
    return write_atomically(path, svg(layers, unit, scale).encode())


def dxf(layers: Layers, unit: str, scale: float) -> bytes:
    """Layers as DXF, a polyline for each line, at the height of its layer."""
    lines = [
        (layer_name(layer.name), scale * np.insert(line, 2, layer.height, axis=1))
        for layer in layers.each
        for line in layer.lines
    ]
    return layers_dxf(lines, unit, flat=True)


def svg(layers: Layers, unit: str, scale: float) -> str:
    """Layers as SVG text; the second coordinate points up, as in the model."""
    points = np.concatenate([line for layer in layers.each for line in layer.lines])
    low, high = points.min(axis=0) * scale, points.max(axis=0) * scale
    width, height = (_number(length) for length in high - low)
    groups = "\n".join(_layer(layer, scale) for layer in layers.each)
    first, second = (escape(name) for name in layers.coordinates)
    return f"""<?xml version="1.0" encoding="UTF-8"?>
<svg xmlns="http://www.w3.org/2000/svg" xmlns:inkscape="http://www.inkscape.org/namespaces/inkscape"
 width="{width}{unit}" height="{height}{unit}" viewBox="{_number(low[0])} {_number(-high[1])} {width} {height}">
<desc>{escape(layers.title)}; {first} to the right, {second} up; 1 unit of the model is \
{_number(scale)} {unit}.</desc>
<g transform="scale(1 -1)" fill="none" stroke="black" stroke-width="{_number(1e-3 * float(np.max(high - low)))}">
{groups}
</g>
</svg>
"""


def _layer(layer: Layer, scale: float) -> str:
    name = quoteattr(layer.name)
    paths = "\n".join(f'<path d="{_path(line * scale)}"/>' for line in layer.lines)
    return f'<g id={name} inkscape:groupmode="layer" inkscape:label={name}>\n{paths}\n</g>'


def _path(line: Floats) -> str:
    closed = bool((line[0] == line[-1]).all())
    corners = line[:-1] if closed else line
    return "M" + " L".join(f"{_number(u)} {_number(v)}" for u, v in corners) + (" Z" if closed else "")


def _number(value: float) -> str:
    """A number without negative zero, which two equal drawings could differ in."""
    return f"{value:.{DIGITS}g}" if abs(value) > 1e-12 else "0"
