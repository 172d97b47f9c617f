"""Several bodies in one figure, in rows and columns, without ticks, each row as high as its bodies need."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure
from mpl_toolkits.mplot3d import Axes3D
from numpy.typing import NDArray

from rsym.output import axes3d
from rsym.output.surfaces import ShadedMesh

Floats = NDArray[np.float64]

MARGIN = 6.0  # points round a body
TITLE = 0.32  # inches above the bodies of a row that has titles
BAR_WIDTH, BAR_ROOM = 0.14, 0.95  # inches


class Gallery:
    """Axes for bodies in a figure of some width in inches; draw into `axes`, then `arrange`.

    Examples
    --------
    >>> from rsym.output.surfaces import plot_mesh
    >>> from rsym.sampling.mesh import Mesh
    >>> slab = Mesh(np.array([[0.0, 0, 0], [4, 0, 0], [0, 1, 0]]), np.array([[0, 1, 2]]))
    >>> gallery = Gallery(Figure(), 1, 2, width=6)
    >>> for ax in gallery.axes[0]:
    ...     artist = plot_mesh(slab, ax=ax)
    >>> gallery.arrange([["one", "other"]])
    >>> width, height = gallery.figure.get_size_inches()
    >>> float(width), bool(height < 2)
    (6.0, True)
    """

    def __init__(self, figure: Figure, rows: int, columns: int, *, width: float = 9.0) -> None:
        self.figure = figure
        self.side = width / columns
        figure.set_size_inches(width, rows * self.side)
        places = [[(j / columns, i / rows, 1 / columns, 1 / rows) for j in range(columns)] for i in range(rows)]
        self.axes: list[list[Axes3D]] = [[axes3d.add_axes(figure, place) for place in row] for row in places]

    def arrange(self, titles: Sequence[Sequence[str]] = ((),)) -> None:
        """Move the bodies together, put titles above those of the first rows, and a colour bar beside each row."""
        extents = [[self._fit(ax) for ax in row] for row in self.axes]
        above = [TITLE if k < len(titles) and any(titles[k]) else 0.0 for k in range(len(self.axes))]
        heights = [max(float(np.ptp(one, axis=0)[1]) for one in row) for row in extents]
        scales = [self._scale(row) for row in self.axes]
        width = self.side * len(self.axes[0])
        page = np.array([width + (BAR_ROOM if any(scales) else 0.0), sum(heights) + sum(above)])
        self.figure.set_size_inches(*page)
        top = page[1]
        for k, (row, height) in enumerate(zip(self.axes, heights, strict=True)):
            for j, ax in enumerate(row):
                if above[k]:
                    place = (j + 0.5) * self.side / page[0], (top - TITLE / 2) / page[1]
                    self.figure.text(*place, titles[k][j], ha="center", va="center", fontsize=11)
                low = top - above[k] - height / 2 - extents[k][j].mean(axis=0)[1]
                ax.set_position((j * self.side / page[0], low / page[1], self.side / page[0], self.side / page[1]))
            top -= above[k] + height
            if (body := scales[k]) is not None and body.scale is not None:
                place = ((width + 0.1) / page[0], (top + 0.12 * height) / page[1])
                bar_axes = self.figure.add_axes((*place, BAR_WIDTH / page[0], 0.76 * height / page[1]))
                self.figure.colorbar(body.scale, cax=bar_axes, extend="both").set_label(body.scale_label, size=9)
                bar_axes.tick_params(labelsize=8, length=2)

    def _fit(self, ax: Axes3D) -> Floats:
        """Fill the square of the axes; return the lowest and highest place of the bodies in it, in inches."""
        ax.set_axis_off()
        bodies = _bodies(ax)
        low = np.min([body.low for body in bodies], axis=0)
        high = np.max([body.high for body in bodies], axis=0)
        axes3d.frame(ax, low, high, ax.elev, ax.azim, margin=MARGIN)
        boxes = [body.get_window_extent() for body in bodies]
        room = MARGIN * self.figure.dpi / 72
        lowest = np.min([box.min for box in boxes], axis=0) - ax.bbox.min - room
        highest = np.max([box.max for box in boxes], axis=0) - ax.bbox.min + room
        return np.stack([lowest, highest]) / self.figure.dpi

    @staticmethod
    def _scale(row: Sequence[Axes3D]) -> ShadedMesh | None:
        found = [body for ax in row for body in _bodies(ax) if body.scale is not None]
        return found[0] if found else None


def _bodies(ax: Axes3D) -> list[ShadedMesh]:
    return [artist for artist in ax.artists if isinstance(artist, ShadedMesh)]
