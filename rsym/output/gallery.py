"""Several bodies in one figure, in rows and columns, without ticks, each row as high as its bodies need."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure
from mpl_toolkits.mplot3d import Axes3D

from rsym.arrays import Floats
from rsym.output import axes3d
from rsym.output.bodies import Body
from rsym.output.paints import EXTENSIONS

MARGIN = 6.0  # points round a body
TITLE = 0.32  # inches above the bodies of a row that has titles
BAR_WIDTH, BAR_ROOM = 0.14, 0.95  # inches


class Gallery:
    """Axes for bodies in a figure of some width in inches; draw into `axes`, then `arrange`.

    All bodies of a row are drawn to one scale.

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
        """Move the bodies together, put titles above those of the first rows, and what colours mean beside each row."""
        ends = [self._fit(row) for row in self.axes]
        above = [TITLE if k < len(titles) and any(titles[k]) else 0.0 for k in range(len(self.axes))]
        meaning = [[body for ax in row for body in _bodies(ax) if body.scale or body.parts] for row in self.axes]
        width = self.side * len(self.axes[0])
        page = np.array(
            [width + (BAR_ROOM if any(meaning) else 0.0), sum(above) + sum(high - low for low, high in ends)]
        )
        self.figure.set_size_inches(*page)
        top = page[1]
        for k, row in enumerate(self.axes):
            low, high = ends[k]
            for j, ax in enumerate(row):
                if above[k]:
                    across, up = np.array([(j + 0.5) * self.side, top - TITLE / 2]) / page
                    self.figure.text(across, up, titles[k][j], ha="center", va="center", fontsize=11)
                ax.set_position((*(np.array([j * self.side, top - above[k] - high]) / page), *(self.side / page)))
            top -= above[k] + high - low
            self._explain(meaning[k], np.array([width, top]), high - low, page)

    def _fit(self, row: Sequence[Axes3D]) -> tuple[float, float]:
        """Show one box in all axes of a row; return between which heights bodies lie in any of them, in inches."""
        bodies = [body for ax in row for body in _bodies(ax)]
        low, high = np.min([body.low for body in bodies], axis=0), np.max([body.high for body in bodies], axis=0)
        lowest, highest = np.inf, -np.inf
        for ax in row:
            ax.set_axis_off()
            axes3d.frame(ax, low, high, ax.elev, ax.azim, margin=MARGIN)
            boxes = [body.get_window_extent() for body in _bodies(ax)]
            lowest = min(lowest, *(box.y0 - ax.bbox.y0 for box in boxes))
            highest = max(highest, *(box.y1 - ax.bbox.y0 for box in boxes))
        room = MARGIN / 72
        return lowest / self.figure.dpi - room, highest / self.figure.dpi + room

    def _explain(self, bodies: Sequence[Body], corner: Floats, height: float, page: Floats) -> None:
        """Put a legend of all parts, or a colour bar, beside a row whose lower right corner is so many inches away."""
        parts = {name: colour for body in bodies for name, colour in body.parts.items()}
        if parts:
            key = axes3d.named_colours(self.figure, parts)
            key.set_bbox_to_anchor(tuple((corner + np.array([0.0, height / 2])) / page))
        scales = [(body.scale_label, body.scale) for body in bodies if body.scale is not None]
        ends = {str(scale.get_cmap().colorbar_extend) for _, scale in scales}
        # Where one of the bodies has values beyond an end.
        extend = EXTENSIONS[bool(ends & {"min", "both"}), bool(ends & {"max", "both"})]
        for label, scale in scales[:1]:
            place = (corner + np.array([0.1, 0.08 * height])) / page
            bar_axes = self.figure.add_axes((*place, *(np.array([BAR_WIDTH, 0.84 * height]) / page)))
            self.figure.colorbar(scale, cax=bar_axes, extend=extend).set_label(label, size=9)
            bar_axes.tick_params(labelsize=8, length=2)


def _bodies(ax: Axes3D) -> list[Body]:
    return [artist for artist in ax.artists if isinstance(artist, Body)]
