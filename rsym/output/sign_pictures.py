"""The inside of a shape in one colour: no value is asked for, so shapes of thousands of operations are pictures too."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap
from matplotlib.image import AxesImage

from rsym.errors import RsymError
from rsym.model.shape import Shape
from rsym.output.looks import Look
from rsym.output.panels import dress
from rsym.output.pictures import require_axes
from rsym.sampling.plane import plane_view, signs_of

SIDES = ListedColormap(["#ffffff", "#3b6c9d"])  # outside, inside


def draw_signs(
    shape: Shape,
    ax: Axes | None,
    look: Look,
    title: str | None,
    resolution: Any,
    bounds: Any,
    letters: Mapping[Any, float] | None,
    section: Mapping[Any, float] | None,
) -> AxesImage:
    """A pixel for each point of the lattice; the array of the artist has a row for each, 1 inside and -1 outside."""
    if look.levels is not None or look.limits is not None or look.colour_map is not None or look.outside is not None:
        raise RsymError(
            "a sign has two colours, no levels, limits, colour map or outside",
            code="levels",
            remedy='leave them out, or take field="value"',
        )
    view = plane_view(shape, resolution, bounds, letters, section)
    if ax is None:
        import matplotlib.pyplot

        _, ax = matplotlib.pyplot.subplots(layout="compressed")
    require_axes(ax)
    signs = signs_of(view, letters)
    lattice = view.lattice
    (left, below), (wide, high) = lattice.origin, lattice.spacing
    columns, rows = lattice.counts
    extent = (left - wide / 2, left + wide * (columns - 0.5), below - high / 2, below + high * (rows - 0.5))
    pixels = np.ascontiguousarray(signs.T)
    image = ax.imshow(pixels, cmap=SIDES, vmin=-1, vmax=1, origin="lower", extent=extent, interpolation="nearest")
    dress(ax, view, "sign" if title is None else title)
    return image
