"""Bodies on three-dimensional axes: pictures made anew, at the renderer's own resolution, when they are drawn."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping, Sequence
from typing import Any, TypeVar

import numpy as np
from matplotlib.artist import Artist
from matplotlib.backend_bases import RendererBase
from matplotlib.cm import ScalarMappable
from matplotlib.transforms import Bbox
from mpl_toolkits.mplot3d import Axes3D
from numpy.typing import NDArray

from rsym.arrays import Floats, Ints
from rsym.output import axes3d
from rsym.output.cameras import Camera

FEATURE_WIDTH = 0.7  # points


class Body(Artist):
    """A body that its kind projects and lights; it is known by some of its points, and by what its colours mean."""

    def __init__(
        self,
        points: Floats,
        scale: ScalarMappable | None,
        label: str,
        parts: Mapping[str, str],
        bars: Sequence[axes3d.Bar] = (),
    ) -> None:
        super().__init__()
        self.points = points
        self.low, self.high = points.min(axis=0), points.max(axis=0)
        self.scale, self.scale_label, self.parts, self.bars = scale, label, parts, tuple(bars)
        self._state: object = None
        self._drawn = (np.zeros(2, np.int64), np.zeros((0, 0, 4), np.uint8))
        # Above panes, grid and axis lines, like the collections of mplot3d.
        self.set_zorder(4)

    @abstractmethod
    def _picture(self, axes: Axes3D, scale: float, point: float) -> tuple[Ints, NDArray[np.uint8]]:
        """Return the lower left corner, in image pixels from that of the axes, and the image, lowest row first.

        A point of the page is so many pixels.
        """

    def get_window_extent(self, renderer: RendererBase | None = None) -> Bbox:
        """Return the rectangle that the body covers, in pixels of the figure."""
        axes: Any = self.axes
        screen = axes3d.project(axes, self.points)[:, :2]
        body = Bbox([screen.min(axis=0), screen.max(axis=0)])
        return Bbox.intersection(body, axes.bbox) or Bbox.null()

    def draw(self, renderer: RendererBase) -> None:
        """Draw the body as one image."""
        axes: Any = self.axes
        if axes is None or not self.get_visible():
            return
        scale = renderer.get_image_magnification()
        point = float(np.asarray(renderer.points_to_pixels(1.0))) * scale
        # A picture saved with bbox_inches="tight" is drawn twice, the second time only moved.
        state = (axes.get_proj().tobytes(), tuple(np.round(axes.bbox.size, 6)), scale, point)
        if state != self._state:
            self._state, self._drawn = state, self._picture(axes, scale, point)
        corner, image = self._drawn
        if image.size:
            left, bottom = axes.bbox.min + corner / scale
            context = renderer.new_gc()
            context.set_clip_rectangle(axes.bbox)
            renderer.draw_image(context, left, bottom, image)
            context.restore()
        self.stale = False


B = TypeVar("B", bound=Body)


def show(artist: B, ax: Axes3D | None, elevation: float, azimuth: float, camera: Camera | None = None) -> B:
    """Put a body on axes that fit it and say what its colours mean; without axes on a new pyplot figure."""
    if ax is None:
        axes = axes3d.new_axes(artist.low, artist.high, elevation, azimuth, camera)
    else:
        axes = axes3d.require_axes3d(ax)
    shown: list[Body] = [artist, *(other for other in axes.artists if isinstance(other, Body))]
    low = np.min([one.low for one in shown], axis=0)
    high = np.max([one.high for one in shown], axis=0)
    axes3d.frame(axes, low, high, elevation, azimuth, camera=camera)
    axes3d.style(axes)
    axes.add_artist(artist)
    if ax is None:
        explain(artist)
    return artist


def explain(artist: Body) -> None:
    """Put a colour bar or a legend beside a body that has a figure of its own."""
    axes: Any = artist.axes
    if artist.scale is not None:
        axes3d.colour_bar(axes, axes3d.Bar(artist.scale, artist.scale_label))
    for bar in artist.bars:
        axes3d.colour_bar(axes, bar)
    if artist.parts:
        axes3d.legend(axes, artist.parts)
