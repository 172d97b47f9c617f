"""The boundary of a shape in a plane, each named part of it in a colour of its own."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import pairwise
from types import MappingProxyType
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.transforms import ScaledTranslation

from rsym.arrays import Floats
from rsym.sampling.labels import Labeller
from rsym.sampling.outlines import outline
from rsym.sampling.plane import PlaneSampler
from rsym.sampling.plane_leaves import leaves_of

# Okabe and Ito's colours without those that are pale beside fills of every kind; what has no name is black.
PART_COLOURS = ("#d55e00", "#0072b2", "#cc79a7", "#009e73", "#e69f00", "#56b4e9")
WIDTH = 2.6
MOST_NAMED = 8
BELOW = 30  # points from the axes to their legend: the numbers and the name of the coordinate lie between
IN_A_ROW = 4
LEGEND: Mapping[str, Any] = MappingProxyType({"fontsize": 8, "frameon": False, "handlelength": 1.6})


def part_lines(omega: PlaneSampler) -> dict[str, list[Floats]]:
    """The boundary in pieces (n, 2), corners exact, by the names of parts, in the order of the leaves; "" has none.

    Examples
    --------
    >>> import rsym
    >>> from rsym.sampling.plane import plane_sampler
    >>> half = rsym.disc(1).named("rim") & rsym.half_plane((0, 1), 0).named("edge")
    >>> lines = part_lines(plane_sampler(half, "value", resolution=32))
    >>> [(name, len(pieces)) for name, pieces in lines.items()]
    [('rim', 1), ('edge', 1)]
    """
    leaves = leaves_of(omega.shape, omega.free, omega.fixed, omega.letters, omega.bounds)
    given = {name for name, _ in omega.shape.parts}
    label = Labeller(omega.shape, omega.letters)
    found: dict[str, list[Floats]] = {}
    order: dict[str, None] = {}
    for line in outline(omega, leaves):
        # A joint of two parts may be a corner: the middle of a piece between two vertices is of one of them.
        middles = (line[:-1] + line[1:]) / 2
        labels = label(leaves.placed(middles), leaves.distance(middles)[1])
        names = ["" if {*parts} - given else name for name, parts in zip(labels.names, labels.parts, strict=True)]
        order.update(dict.fromkeys(names))
        for name, piece in _runs(line, [names[number] for number in labels.number]):
            found.setdefault(name, []).append(piece)
    return {name: found[name] for name in order if name in found}


def _runs(line: Floats, names: list[str]) -> Iterator[tuple[str, Floats]]:
    """The pieces of a line along which the name is the same; that of a closed one over its first vertex is whole."""
    changes = [k for k in range(len(names)) if names[k] != names[k - 1]]
    if changes and (line[0] == line[-1]).all():
        line, names = (
            np.concatenate([line[changes[0] : -1], line[: changes[0] + 1]]),
            names[changes[0] :] + names[: changes[0]],
        )
    starts = [0, *(k for k in range(1, len(names)) if names[k] != names[k - 1]), len(names)]
    for first, last in pairwise(starts):
        yield names[first], line[first : last + 1]


def draw_parts(ax: Axes, omega: PlaneSampler, *, legend: bool = True) -> list[LineCollection]:
    """The named parts of the boundary in colours, with a legend below, where there are several of them."""
    lines = part_lines(omega)
    if not 2 <= len(lines) <= MOST_NAMED:
        return []
    drawn, number = [], 0
    for name, pieces in lines.items():
        colour = "black"
        if name:
            colour, number = PART_COLOURS[number % len(PART_COLOURS)], number + 1
        artist = LineCollection(pieces, colors=colour, linewidths=WIDTH, zorder=3.5, label=name, capstyle="butt")
        ax.add_collection(artist, autolim=False)
        drawn.append(artist)
    shown = [artist for artist, name in zip(drawn, lines, strict=True) if name]
    if not legend:
        return shown
    ax.legend(
        handles=shown,
        loc="upper center",
        bbox_to_anchor=(0.5, 0.0),
        bbox_transform=ax.transAxes + ScaledTranslation(0.0, -BELOW / 72, ax.figure.dpi_scale_trans),
        ncols=min(len(shown), IN_A_ROW),
        **LEGEND,
    )
    return shown
