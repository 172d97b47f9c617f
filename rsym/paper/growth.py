"""How time and memory grow with leaves, cells and letters: figures measured once, stored in `growth.json`.

Each row of the file was measured in a process of its own by `tests/benchmarks/bench_growth.py`, which writes it:
seconds are those of the processor, in all threads; bytes are the peak of the process above what it held before the
shape was made.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from importlib.resources import files
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullLocator

from rsym.errors import RsymError
from rsym.paper.drawing import Drawing, Table
from rsym.paper.studies import spaced

STORED = "growth.json"
# A law is fitted to sizes from such a share of the largest on: below, what is always there counts, as of few leaves, or
# what comes with coarse meshes, as the folds of the car below 256 cells, which take longer than all else.
REACH = {"cells": 8.0}
USUAL_REACH = 30.0
DENSE = "llvm"  # one function of the whole form
SIZE = (12.6, 8.4)
PLACES = {"left": 0.06, "right": 0.98, "bottom": 0.13, "top": 0.96, "wspace": 0.34, "hspace": 0.62}
COLOURS = {"balls": "#24598f", "gyroids": "#2a8c6e", "text": "#c58a1b", "cells": "#24598f", "letters": "#24598f"}
DENSE_COLOUR, LATTICE_COLOUR = "#c0392b", "0.45"
MARKERS = {"balls": "o", "gyroids": "^", "text": "s", "cells": "o", "letters": "o"}
NAMES = {"balls": "balls", "gyroids": "gyroid lattice", "text": "text", "cells": "regions", "letters": "regions"}
LEAVES = ("balls", "gyroids", "text")
CORES = {1: "one core", 2: "two cores"}


@dataclass(frozen=True)
class PowerLaw:
    """The law ``factor * size**exponent``."""

    factor: float
    exponent: float

    def at(self, size: float) -> float:
        """Its value."""
        return self.factor * float(size**self.exponent)


def power_law(sizes: Sequence[float], values: Sequence[float]) -> PowerLaw:
    """The power law nearest to some values, in the mean square of the logarithms.

    log(value) = log(factor) + exponent*log(size)

    Raises
    ------
    RsymError
        For fewer than two sizes, or numbers that are not positive.

    Examples
    --------
    >>> law = power_law([1, 10, 100], [3, 30, 300])
    >>> round(law.factor, 9), round(law.exponent, 9)
    (3.0, 1.0)
    """
    points = np.array([sizes, values], dtype=float)
    if len(set(sizes)) < 2 or not (points > 0).all():
        raise RsymError(
            "a power law is fitted to two sizes or more, and to positive values",
            code="power-law",
            remedy="leave out what is zero, and measure at one more size",
        )
    across, up = np.log(points)
    middle = across.mean()
    exponent = ((across - middle) @ up) / ((across - middle) @ (across - middle))
    return PowerLaw(float(np.exp(up.mean() - exponent * middle)), float(exponent))


@dataclass(frozen=True)
class Series:
    """What one work took, by one way, at growing sizes."""

    work: str
    backend: str
    sizes: tuple[float, ...]
    values: tuple[float, ...]

    @property
    def fitted(self) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """The sizes that a law is fitted to, and the values there."""
        reach = REACH.get(self.work, USUAL_REACH)
        kept = [k for k, size in enumerate(self.sizes) if size * reach >= max(self.sizes)]
        return tuple(self.sizes[k] for k in kept), tuple(self.values[k] for k in kept)

    @property
    def law(self) -> PowerLaw:
        """The power law of the larger sizes."""
        return power_law(*self.fitted)


def stored() -> dict[str, Any]:
    """What was measured: `about` says of what versions and how many cores, `rows` are the figures.

    Examples
    --------
    >>> sorted(stored())
    ['about', 'rows']
    """
    found: dict[str, Any] = json.loads(files("rsym.paper").joinpath(STORED).read_text(encoding="utf-8"))
    return found


def series(rows: Sequence[dict[str, Any]], work: str, backend: str, quantity: str) -> Series:
    """A quantity of one work by one way against its size, or against its leaves where these are what grows.

    `quantity` is a name in the rows, or two with a slash for their quotient; what is not positive is left out.

    Examples
    --------
    >>> rows = [{"work": "balls", "backend": "tape", "size": n, "leaves": n, "mesh": 0.1 * n} for n in (1, 10)]
    >>> series(rows, "balls", "tape", "mesh").values
    (0.1, 1.0)
    """
    name, _, divisor = quantity.partition("/")
    against = "leaves" if work in LEAVES else "size"
    found = [
        (float(row[against]), row[name] / (row[divisor] if divisor else 1))
        for row in rows
        if row["work"] == work and row["backend"] == backend
    ]
    points = sorted(point for point in found if point[1] > 0)
    return Series(work, backend, tuple(size for size, _ in points), tuple(value for _, value in points))


def draw_growth() -> Drawing:
    """Six panels: building, meshing and memory against leaves; meshing and memory against cells; a letter moved."""
    known = stored()
    rows = known["rows"]
    figure = Figure(figsize=SIZE)
    above, below = figure.subplots(2, 3, gridspec_kw=PLACES)
    told: list[tuple[str, ...]] = []
    for ax, panel in zip((*above, *below), PANELS, strict=True):
        lines = [series(rows, work, way, panel.quantity) for work, way in panel.parts]
        _draw_panel(ax, lines, panel.unit)
        ax.set_title(panel.title, fontsize=11)
        ax.set(xlabel=panel.across, ylabel=panel.unit.name)
        told += [_told(panel, line) for line in lines]
    told += [_told(SHARE, series(rows, work, way, SHARE.quantity)) for work, way in SHARE.parts]
    return Drawing(figure, "", 0, _remark(known["about"]), Table(_HEADER, tuple(told)))


class PanelUnit(NamedTuple):
    """What numbers are shown in, how many of those stored it is, and its sign."""

    name: str
    size: float
    sign: str


class Panel(NamedTuple):
    """What is shown of which works, each by one way."""

    title: str
    quantity: str
    unit: PanelUnit
    across: str
    parts: tuple[tuple[str, str], ...]


_SECONDS, _MICROSECONDS, _MEGABYTES = (
    PanelUnit("seconds", 1.0, "s"),
    PanelUnit("", 1e-6, "µs"),
    PanelUnit("megabytes", 1e6, "MB"),
)
_OF_LEAVES = tuple((work, way) for way in ("tape", DENSE) for work in LEAVES)
_OF_CELLS = tuple(("cells", way) for way in ("tape", DENSE, "lattice"))
_OF_LETTERS = (("letters", "tape"), ("letters", DENSE))
_CELLS = "cells along the longest side"
PANELS = (
    Panel("Building a mesher", "build", _SECONDS, "leaves", _OF_LEAVES),
    Panel("A mesh, again", "mesh", _SECONDS, "leaves", _OF_LEAVES),
    Panel("Memory for both", "bytes", _MEGABYTES, "leaves", _OF_LEAVES),
    Panel("A mesh of the car, again", "mesh", _SECONDS, _CELLS, _OF_CELLS),
    Panel("Memory for the car", "bytes", _MEGABYTES, _CELLS, _OF_CELLS),
    Panel("A mesh of 300 balls, a letter moved", "mesh", _SECONDS, "letters", _OF_LETTERS),
)
SHARE = Panel("A mesh, again, for a triangle", "mesh/triangles", _MICROSECONDS, "leaves", _OF_LEAVES)
_HEADER = ("what", "of", "by", "against", "from", "to", "there", "exponent", "fitted from")
_WAYS = {"tape": "regions", DENSE: "one compiled function", "lattice": "every point"}
_BODIES = {"cells": "the car", "letters": "300 balls"}


def _told(panel: Panel, line: Series) -> tuple[str, ...]:
    """One row of the table."""
    (least, *_), last = line.fitted[0], line.values[-1] / panel.unit.size
    return (
        panel.title,
        _BODIES.get(line.work, NAMES[line.work]),
        _WAYS[line.backend],
        panel.across,
        f"{line.sizes[0]:g}",
        f"{line.sizes[-1]:g}",
        f"{spaced(round(last)) if last >= 100 else f'{last:.3g}'} {panel.unit.sign}",
        _exponent(line.law).replace("-", "−"),
        f"{least:g}",
    )


def _draw_panel(ax: Axes, lines: Sequence[Series], unit: PanelUnit) -> None:
    """Points, with the fitted law as a line as far as it was fitted, its exponent in the legend."""
    for line in lines:
        colour = {DENSE: DENSE_COLOUR, "lattice": LATTICE_COLOUR}.get(line.backend, COLOURS[line.work])
        face = colour if line.backend == "tape" else "white"
        fitted, _ = line.fitted
        ends = [min(fitted), max(fitted)]
        law = line.law
        ax.plot(ends, [law.at(end) / unit.size for end in ends], color=colour, linewidth=1.3, alpha=0.65)
        marks: dict[str, Any] = {"color": colour, "markerfacecolor": face, "markersize": 5, "linestyle": "none"}
        label = rf"{_name(line)} $\propto n^{{{_exponent(law)}}}$"
        ax.plot(line.sizes, np.array(line.values) / unit.size, marker=MARKERS[line.work], label=label, **marks)
    ax.set(xscale="log", yscale="log")
    for axis in (ax.xaxis, ax.yaxis):
        axis.set_major_locator(LogLocator(10.0, numticks=12))
        axis.set_major_formatter(FuncFormatter(lambda value, _: spaced(round(value)) if value >= 1 else f"{value:g}"))
        axis.set_minor_locator(NullLocator())
    low, high = ax.get_xlim()
    if high / low < 100:  # cells: powers of two
        ax.set_xticks([64, 128, 256, 512, 1024, 2048])
    ax.grid(color="0.91", linewidth=0.6)
    ax.set_axisbelow(True)
    ax.spines[["top", "right"]].set_visible(False)
    low, high = ax.get_ylim()
    ax.set_ylim(10.0 ** min(np.floor(np.log10(low)), np.ceil(np.log10(high)) - 2), 10.0 ** np.ceil(np.log10(high)))
    ax.legend(
        loc="upper center",
        bbox_to_anchor=(0.5, -0.17),
        ncols=2 if len(lines) > 3 else 1,
        fontsize=9,
        frameon=False,
        handletextpad=0.2,
        columnspacing=1.2,
    )


def _exponent(law: PowerLaw) -> str:
    return f"{round(law.exponent, 2) + 0.0:.2f}"  # the sum makes -0 to 0


def _name(line: Series) -> str:
    if line.work in LEAVES:
        return NAMES[line.work] + (", compiled" if line.backend == DENSE else "")
    return {"tape": "regions", DENSE: "compiled", "lattice": "every point of the lattice"}[line.backend]


def _remark(about: dict[str, Any]) -> str:
    cores = CORES.get(about["cores"], f"{about['cores']} cores")
    return (
        f"Measured once, on {cores}, each in a process of its own; nothing was measured in this run. Seconds are those "
        "of the processor, in all threads, of meshes the least of several calls after the first. Memory is the peak of "
        "the process above what it held before the shape was made, in megabytes of 10⁶ bytes. Regions evaluate what "
        "matters in a box and compile nothing for the model; the dense way beside it, red, compiles the whole model to "
        "one function by LLVM. Every point of the lattice, grey: values there and marching cubes. Balls and gyroid "
        "lattices have 128 cells along a side, texts 256. Surfaces grow with the leaves of these models, so the last "
        "rows of the table tell the time for one triangle. Laws are fitted to the larger sizes only: from those that "
        "the table names on."
    )
